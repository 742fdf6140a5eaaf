// The outer faces of a body, and how much of them something presses on.
#pragma once
#include <array>
#include <map>
#include <vector>

#include "model/model.h"

namespace fissure {

/// Who is on the other side of each face of a body's elements; asked for when somebody wants to know an area.
template <int D, class Real>
class Skin {
 public:
  using Model = model::Model<D, Real>;
  static constexpr int C = D + 1;

  Skin(Model const& model, int body) : model_(model), first_(model.groups.at(body).first) {
    auto const& group = model.groups[body];
    beyond_.assign(static_cast<std::size_t>(group.count) * C, -1);
    std::map<std::array<int, D>, FaceId> seen;
    for (Index e = group.first; e < group.first + group.count; ++e)
      for (int a = 0; a < C && model.elements.cell[e] >= 0; ++a) {
        std::array<int, D> nodes;  // ascending, as all corners are
        for (int i = 0; i < D; ++i)
          nodes[i] = model.elements.node[static_cast<std::size_t>(e) * C + FaceId{e, a}.corner(i)];
        auto const [other, alone] = seen.insert({nodes, FaceId{e, a}});
        if (alone) continue;
        at({e, a}) = other->second.element, at(other->second) = e;
        seen.erase(other);
      }
  }

  /// Nothing is there, what was has left, or the joint between has broken.
  bool outer(FaceId face) const {
    Index const other = at(face);
    if (other < 0 || model_.removed(other)) return true;
    if (model_.block_of(other) >= 0 && model_.block_of(other) == model_.block_of(face.element)) return false;
    return model_.groups[model_.elements.body[other]].split && model_.neighbour(face).element == face.element;
  }

  /// Of these elements, each with the force on it [N]: the outer face of each that looks most against the force (within
  /// 60 degrees: what lies below an edge alone has none), its area
  /// as it is now, and that share of the force which is along its normal.
  scene::Touch pressed(std::map<Index, Vec<double, D>> const& pushed, std::vector<Real> const& u) const {
    scene::Touch all;
    for (auto const& [e, force] : pushed) {
      scene::Touch most;
      for (int a = 0; a < C; ++a) {
        if (!outer({e, a})) continue;
        Vec<double, D> x[D], centre = Vec<double, D>::Zero(), inside = place(e, a, u);
        for (int i = 0; i < D; ++i) x[i] = place(e, FaceId{e, a}.corner(i), u), centre += x[i] / D;
        Vec<double, D> normal = Dim<D>::face_normal(x);
        if (normal.dot(centre - inside) < 0) normal = -normal;
        double const size = normal.norm(), push = size > 0 ? -normal.dot(force) / size : 0;
        if (push > std::max(most.push, 0.5 * force.norm())) most = {size * model_.section.reach(centre[0]), push};
      }
      all.area += most.area, all.push += most.push;
    }
    return all;
  }

 private:
  Index& at(FaceId face) { return beyond_[static_cast<std::size_t>(face.element - first_) * C + face.face]; }
  Index at(FaceId face) const { return beyond_[static_cast<std::size_t>(face.element - first_) * C + face.face]; }
  Vec<double, D> place(Index e, int corner, std::vector<Real> const& u) const {
    Index const vertex = model_.vertex_of(e, corner);
    Vec<double, D> x;
    for (int c = 0; c < D; ++c)
      x[c] = model_.vertices.reference[vertex][c] + static_cast<double>(u[static_cast<std::size_t>(vertex) * D + c]);
    return x;
  }
  Model const& model_;
  Index first_;
  std::vector<Index> beyond_;  // per face; -1: nothing
};

}  // namespace fissure
