// Pages that are made of the command line's own declarations: the manual, and completion for bash.
#pragma once
#include <array>
#include <string>
#include <utility>

namespace CLI {
class App;
}

namespace fissure::app {

/// Numbers and what they mean, a line each.
inline constexpr std::array<std::pair<int, char const*>, 4> exit_statuses{
    {{0, "finished, every expectation met, and the verdict is \"ok\" or \"look again\""},
     {1, "an expectation failed, or the verdict is \"do not trust\""},
     {2, "an error, which standard error explains; or no command"},
     {130, "interrupted"}}};

/// The manual page, for man(1).
std::string manual(CLI::App const& app);

/// What bash completes: commands, options and their values, kinds of starting scenes, scenes, parameters of --set,
/// fields of fissure-plot.
std::string bash_completion(CLI::App const& app);

}  // namespace fissure::app
