// What sizes of shapes are refused, in both dimensions.
#include "mesh/mesher.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/plane.h"

namespace fissure::mesh {
namespace {

using Point = std::array<double, 2>;

double turn(Point const& a, Point const& b, Point const& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool between(Point const& a, Point const& b, Point const& p) {
  return turn(a, b, p) == 0 && std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) &&
         std::min(a[1], b[1]) <= p[1] && p[1] <= std::max(a[1], b[1]);
}

/// Whether segments ab and cd have a point in common.
bool meet(Point const& a, Point const& b, Point const& c, Point const& d) {
  bool const crossing = (turn(a, b, c) > 0) != (turn(a, b, d) > 0) && (turn(c, d, a) > 0) != (turn(c, d, b) > 0);
  return (crossing && turn(a, b, c) != 0 && turn(a, b, d) != 0) || between(a, b, c) || between(a, b, d) ||
         between(c, d, a) || between(c, d, b);
}

}  // namespace

void require_positive(double value, char const* shape, char const* what, Source const& at) {
  if (std::isfinite(value) && value > 0) return;
  throw Error(at, fmt::format("{}: {} must be a number above 0 (it is {:g})", shape, what, value));
}

void require_finite(Vec3 const& point, char const* shape, Source const& at) {
  if (!point.allFinite()) throw Error(at, fmt::format("{}: a coordinate is not a finite number", shape));
}

void require_ring(scene::Ring const& ring, Source const& at) {
  require_finite(ring.center, "ring", at);
  require_positive(ring.inner, "ring", "inner", at);
  require_positive(ring.outer, "ring", "outer", at);
  if (!(ring.inner < ring.outer))
    throw Error(at, fmt::format("ring: inner must be below outer (inner is {:g}, outer {:g})", ring.inner, ring.outer));
}

std::array<Point, 4> notch_corners(scene::Notch const& notch, Source const& at) {
  require_finite({notch.from[0], notch.from[1], notch.to[0]}, "notch", at);
  require_finite({notch.to[1], 0, 0}, "notch", at);
  require_positive(notch.width, "notch", "width", at);
  double const dx = notch.to[0] - notch.from[0], dy = notch.to[1] - notch.from[1], length = std::hypot(dx, dy);
  if (!(length > 0)) throw Error(at, "notch: from and to are the same point (a notch needs a length)");
  double const nx = -dy / length * notch.width / 2, ny = dx / length * notch.width / 2;
  return {{{notch.from[0] - nx, notch.from[1] - ny},
           {notch.to[0] - nx, notch.to[1] - ny},
           {notch.to[0] + nx, notch.to[1] + ny},
           {notch.from[0] + nx, notch.from[1] + ny}}};
}

std::vector<Point> polygon_corners(scene::Polygon const& polygon, Source const& at, char const* shape) {
  std::vector<Point> corners = polygon.points;
  for (Point const& p : corners) require_finite({p[0], p[1], 0}, shape, at);
  if (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
  int const n = static_cast<int>(corners.size());
  if (n < 3) throw Error(at, fmt::format("{}: needs at least three corners (it has {})", shape, n));
  double area = 0;
  for (int i = 0; i < n; ++i) {
    Point const &p = corners[i], &q = corners[(i + 1) % n], &r = corners[(i + 2) % n];
    area += turn(corners[0], p, q) / 2;
    bool const back = turn(p, q, r) == 0 && (p[0] - q[0]) * (r[0] - q[0]) + (p[1] - q[1]) * (r[1] - q[1]) >= 0;
    if (p == q || back)
      throw Error(at, fmt::format("{}: sides {} and {} lie on each other", shape, i + 1, (i + 1) % n + 1));
  }
  // Only sides that share some x can meet.
  auto const left = [&](int i) { return std::min(corners[i][0], corners[(i + 1) % n][0]); };
  auto const right = [&](int i) { return std::max(corners[i][0], corners[(i + 1) % n][0]); };
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) { return std::pair(left(i), i) < std::pair(left(j), j); });
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n && left(order[b]) <= right(order[a]); ++b) {
      auto const [i, j] = std::minmax(order[a], order[b]);
      bool const neighbours = j == i + 1 || (j + 1) % n == i;
      if (!neighbours && meet(corners[i], corners[i + 1], corners[j], corners[(j + 1) % n]))
        throw Error(at, fmt::format("{}: sides {} and {} cross or touch", shape, i + 1, j + 1));
    }
  if (!(area > 0))
    throw Error(at,
                fmt::format("{}: corners must go counter-clockwise (they go clockwise); reverse their order", shape));
  return corners;
}

std::vector<Point> section_corners(scene::Revolved const& revolved, Source const& at) {
  for (Point const& p : revolved.points)
    if (p[0] < 0)
      throw Error(at, fmt::format("revolved: a corner lies at x = {:g} m, beyond the axis of revolution; draw the half "
                                  "of the section where x >= 0",
                                  p[0]));
  scene::Polygon outline;
  outline.points = revolved.points;
  auto const corners = polygon_corners(outline, at, "revolved");
  std::size_t const n = corners.size();
  for (std::size_t i = 0; i < n; ++i)
    if (corners[i][0] == 0 && corners[(i + 1) % n][0] > 0 && corners[(i + n - 1) % n][0] > 0)
      throw Error(at,
                  fmt::format("revolved: corner {} touches the axis in a point alone, where the solid would not hang "
                              "together; give it a side on the axis, or a little distance",
                              i + 1));
  return corners;
}

void require_seam(scene::Seam const& seam, Source const& at) {
  require_finite({seam.from[0], seam.from[1], seam.to[0]}, "seam", at);
  require_finite({seam.to[1], 0, 0}, "seam", at);
  if (seam.corners.empty()) {
    if (seam.from == seam.to) throw Error(at, "seam: from and to are the same point (a seam needs a length)");
    return;
  }
  for (auto const& [x, y, z] : seam.corners) require_finite({x, y, z}, "seam", at);
  Plane const plane(seam.corners);
  if (!plane.encloses()) throw Error(at, "seam: its corners enclose no area (at least three are needed, not in a row)");
  for (auto const& corner : seam.corners)
    if (double const off = plane.off(Vec3(corner.data())); off > 1e-6 * plane.size())
      throw Error(at, fmt::format("seam: its corners lie in no plane (one is {:.3g} m off it)", off));
  scene::Polygon outline;
  outline.points = plane.outline();
  polygon_corners(outline, at);
}

}  // namespace fissure::mesh
