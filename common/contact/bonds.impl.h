// Instantiated by src2d and src3d.
#pragma once
#include <array>
#include <numeric>

#include "contact/bonds.h"

namespace fissure {

template <int D, class Real>
Bonds<D, Real>::Bonds(mesh::Mesh const& mesh, model::Model<D, Real> const& model) : model_(model) {
  if (!model.plan.contact() && !model.plan.joints) return;
  bare_.assign(static_cast<std::size_t>(model.elements.count) * C, 0);
  std::vector<int> const across = mesh::neighbours(mesh);
  for (std::size_t use = 0; use < across.size(); ++use) {
    auto const first = static_cast<std::size_t>(model.elements.of_cell[use / C]) * C;
    for (int a = 0; a < C && across[use] < 0; ++a)  // elements have their corners in an order of their own
      if (model.elements.node[first + a] == mesh.place(mesh.cells[use])) bare_[first + a] = 1;
  }
  exposed_.assign(model.elements.count, 0);
  changed_.assign(model.elements.count, 0);
  node_first_.assign(mesh.nodes.size() + 1, 0);
  for (int node : model.elements.node)
    if (node >= 0) ++node_first_[node + 1];
  std::partial_sum(node_first_.begin(), node_first_.end(), node_first_.begin());
  node_element_.resize(node_first_.back());
  std::vector<Index> next(node_first_.begin(), node_first_.end() - 1);
  for (std::size_t k = 0; k < model.elements.node.size(); ++k)
    if (int const node = model.elements.node[k]; node >= 0) node_element_[next[node]++] = static_cast<Index>(k / C);
  if (model.plan.joints) {
    loose_.assign(static_cast<std::size_t>(model.elements.count) * C, 0);
    connect_everything();
  }
  for (auto const& face : mesh.boundary) {
    std::array<int, D> nodes;
    std::transform(face.node.begin(), face.node.begin() + D, nodes.begin(), [&](int node) { return mesh.place(node); });
    expose_around(nodes);
  }
  for (std::size_t b = 0; b < model.groups.size(); ++b)
    touches_itself_.push_back(model.groups[b].split || !mesh::convex(mesh, static_cast<int>(b)));
}

/// Every element with a corner at one of the nodes may touch: a face or only a corner of it is bare.
template <int D, class Real>
void Bonds<D, Real>::expose_around(std::span<int const> nodes) {
  for (int node : nodes)
    for (Index k = node_first_[node]; k < node_first_[node + 1]; ++k) {
      Index const e = node_element_[k];
      exposed_[e] = changed_[e] = 1;
    }
}

template <int D, class Real>
void Bonds<D, Real>::expose_everything() {
  for (Index e = 0; e < model_.elements.count; ++e) exposed_[e] = model_.elements.cell[e] >= 0;
  std::fill(changed_.begin(), changed_.end(), 1);
}

template <int D, class Real>
Index Bonds<D, Real>::root_of(Index corner) const {
  while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
  return corner;
}

template <int D, class Real>
void Bonds<D, Real>::connect_everything() {
  parent_.resize(static_cast<std::size_t>(model_.elements.count) * C);
  std::iota(parent_.begin(), parent_.end(), 0);
  loosened_nodes_.resize(node_first_.size() - 1);
  std::iota(loosened_nodes_.begin(), loosened_nodes_.end(), 0);
}

template <int D, class Real>
void Bonds<D, Real>::connect() {
  std::sort(loosened_nodes_.begin(), loosened_nodes_.end());
  loosened_nodes_.erase(std::unique(loosened_nodes_.begin(), loosened_nodes_.end()), loosened_nodes_.end());
  auto const corner_at = [&](Index e, int node) {
    int const* const nodes = &model_.elements.node[static_cast<std::size_t>(e) * C];
    return static_cast<Index>(std::lower_bound(nodes, nodes + C, node) - nodes);
  };
  for (int node : loosened_nodes_) {
    std::span const elements(&node_element_[node_first_[node]],
                             static_cast<std::size_t>(node_first_[node + 1] - node_first_[node]));
    for (Index e : elements) {
      Index const mine = e * C + corner_at(e, node);
      parent_[mine] = mine;
      for (Index f : elements)  // parts of a block share its corner
        if (f < e && model_.cell_head(f) == model_.cell_head(e)) {
          parent_[mine] = root_of(f * C + corner_at(f, node));
          break;
        }
    }
    for (Index e : elements)
      for (Index a = 0, mine = corner_at(e, node); a < C; ++a) {
        Index const other = model_.neighbour({e, a}).element;
        if (a == mine || other <= e || loose({e, a})) continue;
        Index const one = root_of(e * C + mine), two = root_of(other * C + corner_at(other, node));
        parent_[std::max(one, two)] = std::min(one, two);
      }
  }
  loosened_nodes_.clear();
}

template <int D, class Real>
bool Bonds<D, Real>::joined(Index a, Index b) const {
  bool const alike = model_.elements.body[a] == model_.elements.body[b];
  if (!alike && !model_.has_bonds()) return false;
  if (alike && !touches_itself_[model_.elements.body[a]]) return true;
  Index const one = model_.cell_head(a), other = model_.cell_head(b);
  for (Index part = one; model_.groups[model_.elements.body[a]].split && part < one + model_.cell_parts(one); ++part)
    for (int i = 0; i < C; ++i)
      if (Index const across = model_.neighbour({part, i}).element; across != part && model_.cell_head(across) == other)
        return true;
  return hang_together(a, b);
}

template <int D, class Real>
bool Bonds<D, Real>::hang_together(Index a, Index b) const {
  bool const whole = !model_.groups[model_.elements.body[a]].split;
  int const* const mine = &model_.elements.node[static_cast<std::size_t>(a) * C];
  int const* const theirs = &model_.elements.node[static_cast<std::size_t>(b) * C];
  for (int i = 0, j = 0; i < C && j < C;) {
    if (mine[i] == theirs[j]) {
      if (whole || root_of(a * C + i) == root_of(b * C + j)) return true;
      ++i, ++j;
    } else if (mine[i] < theirs[j]) {
      ++i;
    } else {
      ++j;
    }
  }
  return false;
}

template <int D, class Real>
bool Bonds<D, Real>::loosen(FaceId face) {
  char& loose = loose_[at(face)];
  if (loose) return false;
  loose = 1;
  bare_[at(face)] = bare_[at(model_.neighbour(face))] = 1;
  std::array<int, D> nodes;
  for (int i = 0; i < D; ++i)
    nodes[i] = model_.elements.node[static_cast<std::size_t>(face.element) * C + face.corner(i)];
  expose_around(nodes);
  loosened_nodes_.insert(loosened_nodes_.end(), nodes.begin(), nodes.end());
  return true;
}

template <int D, class Real>
void Bonds<D, Real>::save(State& state) const {
  state["exposed"] = state_bytes(exposed_), state["changed"] = state_bytes(changed_);
  state["loose"] = state_bytes(loose_), state["bare"] = state_bytes(bare_);
}

template <int D, class Real>
void Bonds<D, Real>::restore(State const& state) {
  exposed_ = state_values<char>(state, "exposed", exposed_.size());
  changed_ = state_values<char>(state, "changed", changed_.size());
  loose_ = state_values<char>(state, "loose", loose_.size());
  bare_ = state_values<char>(state, "bare", bare_.size());
  if (model_.plan.joints) connect_everything();
}

}  // namespace fissure
