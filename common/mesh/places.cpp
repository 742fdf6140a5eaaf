// Places of a body by name: its sides by the direction they face, and the physical groups of its file.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/faces.h"
#include "mesh/part.h"
#include "mesh/simplex.h"

namespace fissure::mesh {
namespace {

/// Names the places of the mesh's last body.
class Places {
 public:
  explicit Places(Mesh& mesh)
      : mesh_(mesh), axes_(node_count(mesh.kind) - 1), first_node_(mesh.body_first_node[mesh.n_bodies() - 1]) {
    int const first_cell = mesh.body_first_cell[mesh.n_bodies() - 1];
    auto const first = std::partition_point(mesh.boundary.begin(), mesh.boundary.end(),
                                            [&](Face const& face) { return face.cell < first_cell; });
    surface_.resize(mesh.boundary.end() - first);
    std::iota(surface_.begin(), surface_.end(), static_cast<int>(first - mesh.boundary.begin()));
    low_ = high_ = mesh.nodes[first_node_];
    for (std::size_t n = first_node_; n < mesh.nodes.size(); ++n) {
      low_ = low_.cwiseMin(mesh.nodes[n]);
      high_ = high_.cwiseMax(mesh.nodes[n]);
    }
  }

  void name_whole() {
    auto& all = nodes_of("all");
    all.resize(mesh_.nodes.size() - first_node_);
    std::iota(all.begin(), all.end(), first_node_);
    name_faces("surface", surface_);
  }

  void name_sides() {
    char const* const side[3][2] = {{"left", "right"}, {"bottom", "top"}, {"back", "front"}};
    double const flat = 1e-6 * (high_ - low_).maxCoeff(), edge = mean_edge();
    for (int axis = 0; axis < axes_; ++axis) {
      // s away from the top, a circle of diameter d has gone down by s^2 / d.
      double const round = std::pow(1.5 * edge, 2) / (high_ - low_)[axis];
      for (bool far : {false, true}) {
        std::vector<int> faces = faces_towards(axis, far, flat);
        if (faces.empty()) faces = faces_towards(axis, far, round);
        if (!faces.empty()) {
          name_faces(side[axis][far], faces);
          continue;
        }
        for (int n = first_node_; n < static_cast<int>(mesh_.nodes.size()); ++n)
          if (depth(mesh_.nodes[n], axis, far) <= flat) nodes_of(side[axis][far]).push_back(n);
      }
    }
  }

  /// A group wins over a place of the same name. Its faces that no cell has, or two, name only their nodes.
  void name_groups(Part const& part) {
    for (auto const& [name, group] : part.group_nodes) {
      faces().erase(name);
      auto& nodes = nodes_of(name) = group;
      for (int& n : nodes) n += first_node_;
    }
    if (part.group_faces.empty()) return;
    std::vector<std::pair<std::array<int, 3>, int>> outer;
    for (int f : surface_) {
      std::array<int, 3> nodes{-1, -1, -1};
      for (int i = 0; i < axes_; ++i) nodes[i] = mesh_.boundary[f].node[i] - first_node_;
      outer.push_back({sorted(nodes), f});
    }
    std::sort(outer.begin(), outer.end());
    for (auto const& [name, group] : part.group_faces) {
      std::vector<int> found;
      for (auto const& face : group) {
        auto const it = std::lower_bound(outer.begin(), outer.end(), std::pair(sorted(face), 0));
        if (it != outer.end() && it->first == sorted(face)) found.push_back(it->second);
      }
      sort_unique(found);
      if (!found.empty()) faces()[name] = std::move(found);
    }
  }

 private:
  static void sort_unique(std::vector<int>& numbers) {
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  }

  std::map<std::string, std::vector<int>>& faces() { return mesh_.named_faces.back(); }
  std::vector<int>& nodes_of(std::string const& name) { return mesh_.named_nodes.back()[name]; }

  /// A place made of faces, with their nodes.
  void name_faces(std::string const& name, std::vector<int> const& chosen) {
    auto& nodes = nodes_of(name);
    for (int f : chosen)
      for (int i = 0; i < axes_; ++i) nodes.push_back(mesh_.boundary[f].node[i]);
    sort_unique(nodes);
    faces()[name] = chosen;
  }

  Vec3 const& node(int f, int i) const { return mesh_.nodes[mesh_.boundary[f].node[i]]; }

  double mean_edge() const {
    double sum = 0;
    for (int f : surface_)
      for (int i = 0; i < axes_; ++i) sum += (node(f, (i + 1) % axes_) - node(f, i)).norm();
    return sum / (double(axes_) * static_cast<double>(surface_.size()));
  }

  double depth(Vec3 const& p, int axis, bool far) const { return far ? high_[axis] - p[axis] : p[axis] - low_[axis]; }

  /// Boundary faces whose normal is within 20 degrees of the axis and whose nodes lie no deeper than `most`.
  std::vector<int> faces_towards(int axis, bool far, double most) const {
    double const cosine = std::cos(std::acos(-1.0) / 9);
    std::vector<int> found;
    for (int f : surface_) {
      bool in = true;
      for (int i = 0; i < axes_; ++i) in = in && depth(node(f, i), axis, far) <= most;
      if (in && outward(f)[axis] * (far ? 1 : -1) >= cosine) found.push_back(f);
    }
    return found;
  }

  Vec3 outward(int f) const {
    Face const& face = mesh_.boundary[f];
    std::span<int const> const cell = std::span(mesh_.cells).subspan(std::size_t(face.cell) * (axes_ + 1), axes_ + 1);
    int a = 0;  // the corner that is not on the face
    while (std::find(face.node.begin(), face.node.end(), cell[a]) != face.node.end()) ++a;
    return Simplex(cell, mesh_.nodes).face_vector(a).normalized();
  }

  Mesh& mesh_;
  int axes_, first_node_;
  std::vector<int> surface_;  // indices into boundary
  Vec3 low_, high_;
};

}  // namespace

void name_places(Mesh& mesh, Part const& part) {
  mesh.named_nodes.emplace_back();
  mesh.named_faces.emplace_back();
  Places places(mesh);
  places.name_whole();
  places.name_sides();
  places.name_groups(part);
}

}  // namespace fissure::mesh
