#include "base/error.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace fissure {

std::string Source::prefix() const { return file.empty() ? "" : file + ":" + std::to_string(line) + ": "; }

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      int const change = diagonal + (std::tolower(a[i - 1]) == std::tolower(b[j - 1]) ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({change, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

std::string nearest_word(std::string_view word, std::vector<std::string> const& known) {
  std::string best;
  int least = 1 + static_cast<int>(word.size() + 1) / 3;
  for (auto const& candidate : known) {
    int const distance = edit_distance(word, candidate);
    if (distance < least) least = distance, best = candidate;
  }
  return best;
}

std::string suggestion(std::string_view word, std::vector<std::string> const& known) {
  std::string const near = nearest_word(word, known);
  return near.empty() ? "" : "; did you mean \"" + near + "\"?";
}

}  // namespace fissure
