// Boundary faces that lie on each other: of one body, what a mesh file can hold and no generator makes, or of two,
// which a bond can join.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "mesh/part.h"

namespace fissure::mesh {
namespace {

using Key = std::array<std::int64_t, 3>;
struct Hash {
  std::size_t operator()(Key const& key) const {
    std::uint64_t sum = 0;
    for (std::int64_t k : key) sum = (sum ^ static_cast<std::uint64_t>(k)) * 0x9E3779B97F4A7C15ull;
    return sum;
  }
};

/// Places in boxes of an edge `size`, found by the box.
class Grid {
 public:
  explicit Grid(double size) : size_(size) {}
  void add(Vec3 const& low, Vec3 const& high, int what) {
    over(low, high, [&](Key const& key) { boxes_[key].push_back(what); });
  }
  template <class F>
  void near(Vec3 const& low, Vec3 const& high, F&& f) const {
    over(low, high, [&](Key const& key) {
      if (auto const found = boxes_.find(key); found != boxes_.end())
        for (int what : found->second) f(what);
    });
  }

 private:
  Key key_of(Vec3 const& p) const {
    Key key;
    for (int i = 0; i < 3; ++i) key[i] = static_cast<std::int64_t>(std::floor(p[i] / size_));
    return key;
  }
  template <class F>
  void over(Vec3 const& low, Vec3 const& high, F&& f) const {
    Key const first = key_of(low), last = key_of(high);
    for (auto x = first[0]; x <= last[0]; ++x)
      for (auto y = first[1]; y <= last[1]; ++y)
        for (auto z = first[2]; z <= last[2]; ++z) f({x, y, z});
  }

  double size_;
  std::unordered_map<Key, std::vector<int>, Hash> boxes_;
};

/// A face of the boundary where it lies.
struct Placed {
  Vec3 centre, normal, low, high;
  std::array<int, 4> node;
  int body, boundary;
};

/// Those of two bodies, and how long the longest is along an axis [m].
std::pair<std::vector<Placed>, double> placed_faces(Mesh const& mesh, int body, int other_body) {
  int const points = node_count(mesh.kind) - 1;
  std::vector<Placed> faces;
  double largest = 0;
  for (int f = 0; f < static_cast<int>(mesh.boundary.size()); ++f) {
    Face const& face = mesh.boundary[f];
    int const owner = mesh.body_of_cell(face.cell);
    if (owner != body && owner != other_body) continue;
    Placed placed{Vec3::Zero(), Vec3::Zero(), mesh.nodes[face.node[0]], mesh.nodes[face.node[0]], face.node, owner, f};
    for (int i = 0; i < points; ++i) {
      Vec3 const& p = mesh.nodes[face.node[i]];
      placed.centre += p / points;
      placed.low = placed.low.cwiseMin(p), placed.high = placed.high.cwiseMax(p);
    }
    Vec3 const edge = mesh.nodes[face.node[1]] - mesh.nodes[face.node[0]];
    placed.normal = (points == 2 ? Vec3(edge.y(), -edge.x(), 0)
                                 : Vec3(edge.cross(mesh.nodes[face.node[2]] - mesh.nodes[face.node[0]])))
                        .normalized();
    largest = std::max(largest, (placed.high - placed.low).maxCoeff());
    faces.push_back(placed);
  }
  return {std::move(faces), largest};
}

}  // namespace

DoubledFaces doubled_faces(Mesh const& mesh, int body) { return doubled_faces(mesh, body, body); }

DoubledFaces doubled_faces(Mesh const& mesh, int body, int other_body) {
  int const points = node_count(mesh.kind) - 1;
  auto const placed = placed_faces(mesh, body, other_body);
  auto const& faces = placed.first;
  double const largest = placed.second;
  DoubledFaces found;
  if (faces.empty()) return found;
  double const close = 1e-6 * largest;
  Vec3 const margin = Vec3::Constant(close);
  Grid places(largest), nodes(largest);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    places.add(faces[f].low - margin, faces[f].high + margin, static_cast<int>(f));
    for (int i = 0; i < points; ++i)
      nodes.add(mesh.nodes[faces[f].node[i]], mesh.nodes[faces[f].node[i]], faces[f].node[i]);
  }
  auto const lies_within = [&](Vec3 const& p, Placed const& face) {
    if (std::abs((p - face.centre).dot(face.normal)) > close) return false;
    for (int i = 0; i < points; ++i) {  // not outside of any of its sides
      Vec3 const &a = mesh.nodes[face.node[i]], &b = mesh.nodes[face.node[(i + 1) % points]];
      Vec3 const inward = points == 2 ? Vec3(b - a) : Vec3(face.normal.cross(b - a));
      if ((p - a).dot(inward) < -close * inward.norm()) return false;
    }
    return true;
  };
  auto const has_twin = [&](int node, Placed const& face) {
    bool twin = false;
    Vec3 const& p = mesh.nodes[node];
    nodes.near(p - margin, p + margin,
               [&](int same) { twin = twin || (same != node && (mesh.nodes[same] - p).norm() < close); });
    places.near(p, p, [&](int g) {  // or it is the end of a crack: a face of the other side has it, too
      auto const& corners = faces[g].node;
      twin = twin || (faces[g].normal.dot(face.normal) < -0.9 &&
                      std::find(corners.begin(), corners.begin() + points, node) != corners.begin() + points);
    });
    return twin;
  };
  auto const meet = [&](Placed const& face, Placed const& other) {  // node for node
    for (int i = 0; i < points; ++i) {
      auto const at = [&](int node) { return (mesh.nodes[node] - mesh.nodes[face.node[i]]).norm() < close; };
      if (std::none_of(other.node.begin(), other.node.begin() + points, at)) return false;
    }
    return true;
  };
  for (Placed const& face : faces) {
    bool doubled = false;
    places.near(face.centre, face.centre, [&](int g) {
      Placed const& other = faces[g];
      if (face.normal.dot(other.normal) > -0.9 || !lies_within(face.centre, other)) return;
      if (body != other_body && face.body == other.body) return;
      if (face.body == body && meet(face, other)) found.pairs.push_back({face.boundary, other.boundary});
      doubled = true;
      for (int i = 0; i < points && !found.unmatched; ++i)
        if (!has_twin(face.node[i], face)) found.unmatched = true, found.place = mesh.nodes[face.node[i]];
    });
    if (doubled && found.count++ == 0 && !found.unmatched) found.place = face.centre;
  }
  return found;
}

void refuse_unmatched_faces(Mesh const& mesh, std::string const& name, Source const& at) {
  auto const found = doubled_faces(mesh, mesh.n_bodies() - 1);
  if (!found.unmatched) return;
  Vec3 const& p = found.place;
  throw Error(at, fmt::format("body \"{}\": faces of its mesh lie on each other near ({:.4g}, {:.4g}, {:.4g}) and "
                              "their nodes do not match; what does not share nodes is not tied: make the mesh fit "
                              "there, or put the pieces into files and bodies of their own, which meet by contact",
                              name, p.x(), p.y(), p.z()));
}

}  // namespace fissure::mesh
