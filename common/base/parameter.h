// A law's parameter, declared once: validation, defaults, the reference page and the echo of a scene all read this.
#pragma once
#include <limits>
#include <optional>
#include <vector>

namespace fissure {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

/// One number of a law. `least..most` is what the law can bear (outside: an error); `usual_least..usual_most` is what
/// the quantity ever is in nature (outside: a warning, for a density of 2.7 or a Young's modulus of 50).
template <class Law>
struct Parameter {
  char const* key;                 // Lua key = member = name in the reference page
  double Law::*member;             // where it is kept
  char const* unit;                // "Pa", "" when it has none
  double least, most;              // hard bounds, both included
  double usual_least, usual_most;  // range seen in practice
  std::optional<double> fallback;  // default; none: the user must give it
  char const* sentence;            // what it is, for the reference page
  bool least_excluded = false;     // true: the value must lie above `least`
  bool most_excluded = false;      // true: the value must lie below `most`
};

}  // namespace fissure
