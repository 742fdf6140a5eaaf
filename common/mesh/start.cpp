// Where bodies, plates and walls overlap before anything has moved, and how far away what touches nothing is.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_map>

#include "mesh/mesh.h"
#include "mesh/simplex.h"

namespace fissure::mesh {
namespace {

struct Extent {
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);
  void add(Vec3 const& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
  bool has(Vec3 const& p) const { return (p.array() >= low.array()).all() && (p.array() <= high.array()).all(); }
  Extent common(Extent const& other) const { return {low.cwiseMax(other.low), high.cwiseMin(other.high)}; }
  bool empty() const { return (low.array() > high.array()).any(); }
};

Face face_of(Mesh const& mesh, int use) {
  int const corners = node_count(mesh.kind), first = use - use % corners;
  Face face{use / corners, {-1, -1, -1, -1}};
  int filled = 0;
  for (int const a : face_corners(corners, use % corners)) face.node[filled++] = mesh.cells[first + a];
  return face;
}

/// A body's surface, and points of it that another body must not hold: nodes and middles of its boundary's faces and
/// cells. The middles find bodies that lie exactly on each other.
class Surface {
 public:
  /// `tied`: nodes beside which nothing is looked for; empty: none.
  Surface(Mesh const& mesh, int body, std::vector<char> const& tied = {})
      : mesh_(mesh), body_(body), corners_(node_count(mesh.kind)) {
    auto const counts = [&](std::span<int const> nodes) {
      return tied.empty() || std::ranges::none_of(nodes, [&](int n) { return tied[n] != 0; });
    };
    std::vector<char> on(mesh.body_first_node[body + 1] - mesh.body_first_node[body], 0);
    double edges = 0;
    std::vector<Face> outer = mesh.boundary;
    for (auto const& bonded : mesh.bonded)
      for (int const use : bonded.use) outer.push_back(face_of(mesh, use));
    for (Face const& face : outer) {
      if (face.cell < mesh.body_first_cell[body] || face.cell >= mesh.body_first_cell[body + 1]) continue;
      faces_.push_back(face.node);
      Vec3 middle = Vec3::Zero(), inside = Vec3::Zero();
      for (int a = 0; a < corners_ - 1; ++a) {
        on[face.node[a] - mesh.body_first_node[body]] = 1;
        middle += node(face.node[a]) / (corners_ - 1);
      }
      for (int a = 0; a < corners_; ++a) inside += node(mesh.cells[face.cell * corners_ + a]) / corners_;
      if (counts({face.node.data(), static_cast<std::size_t>(corners_ - 1)}))
        points_.push_back(middle), points_.push_back(inside);
      edges += (node(face.node[0]) - node(face.node[1])).norm();
    }
    for (std::size_t n = 0; n < on.size(); ++n)
      if (int const number = mesh.body_first_node[body] + static_cast<int>(n); on[n] && counts({&number, 1}))
        points_.push_back(node(number));
    for (Vec3 const& p : points_) extent_.add(p);
    edge_ = faces_.empty() ? 0 : edges / static_cast<double>(faces_.size());
  }

  std::vector<Vec3> const& points() const { return points_; }
  Extent const& extent() const { return extent_; }
  double edge() const { return edge_; }  // mean of its surface [m]

  /// The largest depth of those points that lie within the body; 0: none does. [m]
  double depth(std::vector<Vec3> const& points) const {
    Extent about;
    for (Vec3 const& p : points) about.add(p);
    about = about.common(extent_);
    if (about.empty()) return 0;
    // The cells there, in a grid of the size of an edge.
    std::unordered_map<std::uint64_t, std::vector<int>> grid;
    double const pitch = std::max(2 * edge_, (about.high - about.low).maxCoeff() / 1000);
    auto const place = [&](double x, int axis) {
      return static_cast<std::int64_t>(std::clamp(std::floor((x - about.low[axis]) / pitch), 0.0, 2000.0));
    };
    auto const key = [](std::int64_t i, std::int64_t j, std::int64_t k) {
      return static_cast<std::uint64_t>((k * 4096 + j) * 4096 + i);
    };
    for (int c = mesh_.body_first_cell[body_]; c < mesh_.body_first_cell[body_ + 1]; ++c) {
      Extent cell;
      for (int a = 0; a < corners_; ++a) cell.add(node(mesh_.cells[c * corners_ + a]));
      cell = cell.common(about);
      if (cell.empty()) continue;
      for (auto k = place(cell.low[2], 2); k <= place(cell.high[2], 2); ++k)
        for (auto j = place(cell.low[1], 1); j <= place(cell.high[1], 1); ++j)
          for (auto i = place(cell.low[0], 0); i <= place(cell.high[0], 0); ++i) grid[key(i, j, k)].push_back(c);
    }
    double deepest = 0;
    std::size_t near = 0;  // the face that ended the search before: it often ends the next one
    for (Vec3 const& p : points) {
      if (!about.has(p)) continue;
      auto const found = grid.find(key(place(p[0], 0), place(p[1], 1), place(p[2], 2)));
      if (found == grid.end() ||
          std::none_of(found->second.begin(), found->second.end(), [&](int c) { return holds(c, p); }))
        continue;
      double depth = INFINITY;
      std::size_t const first = near;
      for (std::size_t i = 0; i < faces_.size() && depth > deepest; ++i) {
        std::size_t const f = (first + i) % faces_.size();
        if (double const d = distance_to(f, p); d < depth) depth = d, near = f;
      }
      deepest = std::max(deepest, depth);
    }
    return deepest;
  }

  /// How far a point lies from the surface [m].
  double distance_from(Vec3 const& p) const {
    double least = INFINITY;
    for (std::size_t f = 0; f < faces_.size(); ++f) least = std::min(least, distance_to(f, p));
    return least;
  }

 private:
  Vec3 const& node(int n) const { return mesh_.nodes[n]; }
  double distance_to(std::size_t face, Vec3 const& p) const {
    auto const& n = faces_[face];
    return corners_ == 3 ? distance(p, node(n[0]), node(n[1])) : distance(p, node(n[0]), node(n[1]), node(n[2]));
  }
  bool holds(int cell, Vec3 const& p) const {
    auto const corner = [&](int a) -> Vec3 const& { return node(mesh_.cells[cell * corners_ + a]); };
    Vec3 const from = p - corner(0);
    if (corners_ == 3) {
      Vec3 const u = corner(1) - corner(0), v = corner(2) - corner(0);
      double const whole = u[0] * v[1] - u[1] * v[0], s = (from[0] * v[1] - from[1] * v[0]) / whole,
                   t = (u[0] * from[1] - u[1] * from[0]) / whole;
      return s >= 0 && t >= 0 && s + t <= 1;
    }
    Vec3 const u = corner(1) - corner(0), v = corner(2) - corner(0), w = corner(3) - corner(0);
    double const whole = u.cross(v).dot(w), r = from.cross(v).dot(w) / whole, s = u.cross(from).dot(w) / whole,
                 t = u.cross(v).dot(from) / whole;
    return r >= 0 && s >= 0 && t >= 0 && r + s + t <= 1;
  }

  Mesh const& mesh_;
  int body_, corners_;
  std::vector<std::array<int, 4>> faces_;
  std::vector<Vec3> points_;
  Extent extent_;
  double edge_ = 0;
};

/// A plate's box, flat in 2D.
struct PlateBox {
  Vec3 low, high;

  PlateBox(scene::Box const& box, int dimension) : low(box.center - box.size / 2), high(box.center + box.size / 2) {
    for (int axis = dimension; axis < 3; ++axis) low[axis] = high[axis] = 0;
  }
  /// Distance of a point outside; below 0: its depth inside.
  double distance_of(Vec3 const& p, int dimension) const {
    double inside = -INFINITY, outside = 0;
    for (int axis = 0; axis < dimension; ++axis) {
      double const beyond = std::max(low[axis] - p[axis], p[axis] - high[axis]);
      inside = std::max(inside, beyond), outside += std::pow(std::max(beyond, 0.0), 2);
    }
    return inside <= 0 ? inside : std::sqrt(outside);
  }
  std::vector<Vec3> corners_and_middle() const {
    std::vector<Vec3> points{(low + high) / 2};
    for (int i = 0; i < 8; ++i)
      points.push_back({i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]});
    return points;
  }
};

/// Of a plate from a body; below 0: how deep one reaches into the other [m].
double distance(PlateBox const& box, Surface const& body, int dimension) {
  double least = INFINITY;
  for (Vec3 const& p : body.points()) least = std::min(least, box.distance_of(p, dimension));
  // A plate smaller than a face of the body.
  auto const own = box.corners_and_middle();
  double const depth = body.depth(own);
  if (depth > 0) return std::min(least, -depth);
  if (least > 0)
    for (Vec3 const& p : own) least = std::min(least, body.distance_from(p));
  return least;
}

}  // namespace

double width(Mesh const& mesh, int body) {
  Extent extent;
  for (int n = mesh.body_first_node[body]; n < mesh.body_first_node[body + 1]; ++n) extent.add(mesh.nodes[n]);
  return (extent.high - extent.low).maxCoeff();
}

StartingContact starting_contact(scene::Scene const& scene, Mesh const& mesh) {
  int const dimension = node_count(mesh.kind) - 1;
  std::vector<Surface> surfaces;
  for (int b = 0; b < mesh.n_bodies(); ++b) surfaces.emplace_back(mesh, b);
  auto const body_name = [&](std::size_t b) { return fmt::format("body \"{}\"", scene.bodies[b].name); };
  // What rounding and the chords of arcs leave is no overlap: a millionth of an edge.
  auto const counts = [](double depth, double edge) { return depth > 1e-6 * edge; };
  /// Deepest of two bodies in each other; not beside a tie, where round surfaces overlap by what cells leave of them.
  auto const depth_of = [&](int a, int b) {
    std::vector<char> tied;
    for (auto const& hung : mesh.hung) {
      auto const pair = std::minmax({mesh.body_of_node(hung.node), mesh.body_of_cell(hung.cell)});
      if (pair != std::minmax({a, b})) continue;
      tied.resize(mesh.nodes.size(), 0);
      tied[hung.node] = 1;
      for (int k = 0; k <= dimension; ++k)
        tied[mesh.cells[static_cast<std::size_t>(hung.cell) * (dimension + 1) + k]] = 1;
    }
    if (tied.empty()) return std::max(surfaces[a].depth(surfaces[b].points()), surfaces[b].depth(surfaces[a].points()));
    Surface const one(mesh, a, tied), other(mesh, b, tied);
    return std::max(surfaces[a].depth(other.points()), surfaces[b].depth(one.points()));
  };
  StartingContact found;
  auto const overlap = [&](Source const& at, std::string const& one, std::string const& other, double depth,
                           double edge) {
    found.deepest = std::max(found.deepest, depth / edge);
    found.overlaps.push_back(
        fmt::format("{}{} and {} overlap by {:.3g} m at the start ({:.2g} of an element's edge): contact will throw "
                    "them apart with the energy that the overlap holds; move one of them",
                    at.prefix(), one, other, depth, depth / edge));
  };
  if (scene.contact)
    for (std::size_t a = 0; a < surfaces.size(); ++a)
      for (std::size_t b = a + 1; b < surfaces.size(); ++b) {
        if (surfaces[a].extent().common(surfaces[b].extent()).empty()) continue;
        double const depth = depth_of(static_cast<int>(a), static_cast<int>(b));
        double const edge = std::min(surfaces[a].edge(), surfaces[b].edge());
        if (counts(depth, edge)) overlap(scene.bodies[b].source, body_name(a), body_name(b), depth, edge);
      }
  /// `distance` of a rigid thing from a body; below 0: how deep the body reaches into it.
  auto const judge = [&](auto const& rigid, std::string const& name, std::vector<bool>& against, auto const& distance) {
    double gap = INFINITY;
    std::size_t nearest = 0;
    for (std::size_t b = 0; b < surfaces.size(); ++b) {
      double const d = distance(surfaces[b]);
      if (d < gap) gap = d, nearest = b;
      if (d < 0 && counts(-d, surfaces[b].edge())) overlap(rigid.source, name, body_name(b), -d, surfaces[b].edge());
    }
    against.push_back(!surfaces.empty() && !counts(gap, surfaces[nearest].edge()));
    if (!surfaces.empty() && !against.back())
      found.gaps.push_back(
          fmt::format("{} touches nothing: {} is nearest, {:.4g} m away", name, body_name(nearest), gap));
  };
  for (auto const& plate : scene.plates) {
    PlateBox const box(plate.box, dimension);
    judge(plate, fmt::format("plate \"{}\"", plate.name), found.plates,
          [&](Surface const& body) { return distance(box, body, dimension); });
  }
  for (auto const& wall : scene.walls) {
    Vec3 normal = wall.normal;
    if (dimension == 2) normal[2] = 0, normal.normalize();
    judge(wall, fmt::format("wall \"{}\"", wall.name), found.walls, [&](Surface const& body) {
      double least = INFINITY;
      for (Vec3 const& p : body.points()) least = std::min(least, (p - wall.point).dot(normal));
      return least;
    });
  }
  return found;
}

}  // namespace fissure::mesh
