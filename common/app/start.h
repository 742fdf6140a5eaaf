// Starting scenes: what `new` writes for an exercise of one's own. They lie in examples/start and become part of the
// program.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace fissure::app {

struct Start {
  std::string_view kind;  // "bend"
  std::string_view text;  // the scene
};

/// By kind in alphabetical order. Written when the build is configured.
std::vector<Start> const& starts();

/// A line for each kind: its name, and what its scene says of itself first.
std::string list_starts();

/// Writes the scene of a kind into a file (default: the kind's name); one that is there already stays.
int write_start(std::string const& program, std::string const& kind, std::string file);

}  // namespace fissure::app
