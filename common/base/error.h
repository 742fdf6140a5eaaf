// Errors in one grammar: where: problem (why); suggestion?
#pragma once
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace fissure {

/// Where in a user's file something was said. An empty file means "no place".
struct Source {
  std::string file;
  int line = 0;

  /// "scene.lua:12: " or "" when there is no place.
  std::string prefix() const;
};

/// Everything a user can get wrong ends here: the text is complete and needs no stack trace.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  Error(Source const& at, std::string const& text) : std::runtime_error(at.prefix() + text) {}
};

/// Levenshtein distance: insertions, deletions and substitutions that turn a into b.
int edit_distance(std::string_view a, std::string_view b);

/// The known word nearest to `word`, or "" when none is near enough (more than a third of its letters differ).
std::string nearest_word(std::string_view word, std::vector<std::string> const& known);

/// "; did you mean "young"?" or "" when no known word is near.
std::string suggestion(std::string_view word, std::vector<std::string> const& known);

}  // namespace fissure
