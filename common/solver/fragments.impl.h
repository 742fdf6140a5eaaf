// Fragments: what hangs together by faces; a part of probe.impl.h.
#pragma once
#include <algorithm>
#include <numeric>

#include "solver/solver.impl.h"

namespace fissure {

/// Cells are united that share a vertex, or a joint that is not broken (union-find, Cormen et al., Introduction to
/// Algorithms, ch. 21); the lowest element stands for its piece.
template <int D, class Real>
solver::Pieces Solver<D, Real>::pieces(int body) const {
  std::vector<Index> parent(model_.n_elements), first(model_.n_vertices, -1);
  std::iota(parent.begin(), parent.end(), 0);
  auto const root = [&](Index e) {
    while (parent[e] != e) e = parent[e] = parent[parent[e]];
    return e;
  };
  auto const unite = [&](Index one, Index other) {
    one = root(one), other = root(other);
    parent[std::max(one, other)] = std::min(one, other);
  };
  auto const counts = [&](Index e) {
    return model_.cell_of_element[e] >= 0 && (body < 0 || model_.body_of_element[e] == body);
  };
  for (Index e = 0; e < model_.n_elements; ++e)
    for (int a = 0; a < C && counts(e); ++a) {
      Index& owner = first[model_.vertex_of(e, a)];
      if (owner < 0) owner = e;
      unite(owner, e);
      if (!model_.plan.joints) continue;
      if (Index const other = model_.host_link[kernels::blocked(e, a, C)] >> 2; counts(other)) unite(e, other);
    }

  std::vector<Index> piece(model_.n_elements, -1);  // of roots
  std::vector<scene::Fragment> all;
  std::vector<Vec3> least, most;
  auto const u = model_.u.download(), v = model_.v.download();
  for (Index vertex = 0; vertex < model_.n_vertices; ++vertex) {
    if (first[vertex] < 0) continue;
    Index& number = piece[root(first[vertex])];
    if (number < 0) {
      number = static_cast<Index>(all.size());
      all.emplace_back();
      least.push_back(Vec3::Constant(INFINITY)), most.push_back(Vec3::Constant(-INFINITY));
    }
    double const mass = model_.mass[vertex];
    all[number].mass += mass;
    for (int c = 0; c < D; ++c) {
      std::size_t const at = static_cast<std::size_t>(vertex) * D + c;
      double const x = model_.origin[c] + model_.reference[vertex][c] + static_cast<double>(u[at]);
      all[number].center[c] += mass * x, all[number].velocity[c] += mass * static_cast<double>(v[at]);
      least[number][c] = std::min(least[number][c], x), most[number][c] = std::max(most[number][c], x);
    }
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    auto& fragment = all[k];
    if (fragment.mass > 0) fragment.center /= fragment.mass, fragment.velocity /= fragment.mass;
    fragment.mass /= scene_.run.mass_scaling;
    for (int c = 0; c < D; ++c) fragment.size[c] = most[k][c] - least[k][c];
    if (!model_.axisymmetric) continue;
    fragment.center[0] = 0;  // a ring
    fragment.size[0] = fragment.size[2] = 2 * most[k][0];
  }

  std::vector<Index> order(all.size()), rank(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return all[a].mass > all[b].mass; });
  solver::Pieces pieces;
  for (Index const k : order) rank[k] = static_cast<Index>(pieces.list.size()), pieces.list.push_back(all[k]);
  pieces.of_element.assign(model_.n_elements, -1);
  for (Index e = 0; e < model_.n_elements; ++e)
    if (counts(e)) pieces.of_element[e] = rank[piece[root(e)]];
  return pieces;
}

template <int D, class Real>
std::vector<scene::Fragment> Solver<D, Real>::fragments(int body) const {
  return pieces(body).list;
}

}  // namespace fissure
