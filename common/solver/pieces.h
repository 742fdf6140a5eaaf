// Fragments: what hangs together by faces.
#pragma once
#include <algorithm>
#include <numeric>
#include <vector>

#include "model/model.h"

namespace fissure {

struct Pieces {
  std::vector<Index> of_element;      // [element] its piece in the list; -1: none
  std::vector<scene::Fragment> list;  // heaviest first
};

/// From sums over vertices: `least`, `most` and centre of each.
inline void finish(scene::Scene const& scene, model::Section const& section, std::vector<Vec3> const& least,
                   std::vector<Vec3> const& most, std::vector<scene::Fragment>& all) {
  for (std::size_t k = 0; k < all.size(); ++k) {
    auto& fragment = all[k];
    if (fragment.mass > 0) fragment.center /= fragment.mass, fragment.velocity /= fragment.mass;
    fragment.mass /= scene.run.mass_scaling;
    for (int c = 0; c < 3; ++c) fragment.size[c] = most[k][c] >= least[k][c] ? most[k][c] - least[k][c] : 0;
    if (!section.axisymmetric()) continue;
    fragment.center[0] = 0;  // a ring
    fragment.size[0] = fragment.size[2] = 2 * most[k][0];
  }
}

/// Fragments of a body alone, or (-1) of all. Cells are united that share a vertex, or a joint that is not broken
/// (union-find, Cormen et al., Introduction to Algorithms, ch. 21); the lowest element stands for its piece.
template <int D, class Real>
Pieces pieces(scene::Scene const& scene, model::Model<D, Real> const& model, int body) {
  constexpr int C = D + 1;
  std::vector<Index> parent(model.elements.count), first(model.vertices.count, -1);
  std::iota(parent.begin(), parent.end(), 0);
  auto const root = [&](Index e) {
    while (parent[e] != e) e = parent[e] = parent[parent[e]];
    return e;
  };
  auto const unite = [&](Index one, Index other) {
    one = root(one), other = root(other);
    parent[std::max(one, other)] = std::min(one, other);
  };
  auto const counts = [&](Index e) { return model.present(e) && (body < 0 || model.elements.body[e] == body); };
  for (Index e = 0; e < model.elements.count; ++e)
    for (int a = 0; a < C && counts(e); ++a) {
      Index& owner = first[model.vertex_of(e, a)];
      if (owner < 0) owner = e;
      unite(owner, e);
      if (!model.plan.joints) continue;
      if (Index const other = model.neighbour({e, a}).element; counts(other)) unite(e, other);
    }

  std::vector<Index> piece(model.elements.count, -1);  // of roots
  std::vector<scene::Fragment> all;
  std::vector<Vec3> least, most;
  auto const u = model.vertices.u.download(), v = model.vertices.v.download();
  for (Index vertex = 0; vertex < model.vertices.count; ++vertex) {
    if (first[vertex] < 0) continue;
    Index& number = piece[root(first[vertex])];
    if (number < 0) {
      number = static_cast<Index>(all.size());
      all.emplace_back();
      least.push_back(Vec3::Constant(INFINITY)), most.push_back(Vec3::Constant(-INFINITY));
    }
    double const mass = model.vertices.mass[vertex];
    all[number].mass += mass;
    for (int c = 0; c < D; ++c) {
      std::size_t const at = static_cast<std::size_t>(vertex) * D + c;
      double const x = model.origin[c] + model.vertices.reference[vertex][c] + static_cast<double>(u[at]);
      all[number].center[c] += mass * x, all[number].velocity[c] += mass * static_cast<double>(v[at]);
      least[number][c] = std::min(least[number][c], x), most[number][c] = std::max(most[number][c], x);
    }
  }
  finish(scene, model.section, least, most, all);
  std::vector<Index> order(all.size()), rank(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return all[a].mass > all[b].mass; });
  Pieces found;
  for (Index const k : order) rank[k] = static_cast<Index>(found.list.size()), found.list.push_back(all[k]);
  found.of_element.assign(model.elements.count, -1);
  for (Index e = 0; e < model.elements.count; ++e)
    if (counts(e)) found.of_element[e] = rank[piece[root(e)]];
  return found;
}

}  // namespace fissure
