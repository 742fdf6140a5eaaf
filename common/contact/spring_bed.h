// What contact may do to the time step, before it does it.
#pragma once
#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "base/lanes.h"

namespace fissure {

/// A face that something may press on, as a bed of springs (Winkler's foundation). Of two bodies that press on each
/// other with k, k (x_a - x_b)^2 <= k (1 + r) x_a^2 + k (1 + 1/r) x_b^2 for any r > 0: so with these stiffnesses below
/// their faces, beds are never softer than the contact. Least is lost where r is the ratio of masses.
template <int D>
struct SpringBed {
  std::array<Index, D> vertex;
  std::array<double, D> normal;  // springs act along it, or, where something rubs,
  bool rubs = false;             // in every direction
  bool at_corners = false;       // springs stand at the corners alone
  double stiffness = 0;          // of all of them [N/m]
  double pressed = 0;            // sum of what kernels count at its corners when all of it is pressed [N/m]
};

/// The faces that candidates and cracks may press on. `list` counts how often they have changed.
template <int D>
struct SpringBeds {
  long list = 0;
  std::size_t joined = 0;  // faces from here on have joined the list before this one, whose others are as they were
  std::vector<SpringBed<D>> faces;

  /// Adds share times K x to y, both [vertex][D].
  void add(std::vector<double> const& x, double share, std::vector<double>& y) const {
    for (auto const& bed : faces) {
      auto const at = [&](int i, int c) { return static_cast<std::size_t>(bed.vertex[i]) * D + c; };
      std::array<double, D> sum{};
      for (int i = 0; i < D && !bed.at_corners; ++i)
        for (int c = 0; c < D; ++c) sum[c] += x[at(i, c)];
      double const k = share * bed.stiffness / (bed.at_corners ? D : D * (D + 1));
      for (int i = 0; i < D; ++i) {
        double along = 0;
        for (int c = 0; c < D; ++c) along += bed.normal[c] * (x[at(i, c)] + sum[c]);
        for (int c = 0; c < D; ++c) y[at(i, c)] += k * (bed.rubs ? x[at(i, c)] + sum[c] : along * bed.normal[c]);
      }
    }
  }
  /// Sum of each vertex's row of K over its mass [1/s^2]: no mode of theirs alone is faster.
  std::vector<double> rows(std::vector<double> const& mass, double SpringBed<D>::*of = &SpringBed<D>::stiffness) const {
    std::vector<double> sums(mass.size(), 0);
    add_rows(mass, of, sums);
    return sums;
  }
  void add_rows(std::vector<double> const& mass, double SpringBed<D>::*of, std::vector<double>& sums) const {
    for (auto const& bed : faces)
      for (Index const vertex : bed.vertex)
        if (mass[vertex] > 0) sums[vertex] += bed.*of / D / mass[vertex];
  }

  /// Squared frequency at which the surface bounces where it is stiffest [1/s^2]: a node along the normal of one of its
  /// faces, by all that look that way; what presses on the others comes from elsewhere. `node` of each vertex, `mass`
  /// of each node. Only nodes of faces from `begin` on are asked.
  double bounce(std::vector<Index> const& node, std::vector<double> const& mass, std::size_t begin = 0) const {
    std::vector<char> asked(mass.size(), 0);
    for (std::size_t k = begin; k < faces.size(); ++k)
      for (Index const vertex : faces[k].vertex) asked[node[vertex]] = 1;
    std::vector<std::size_t> first(mass.size() + 1, 0);  // beds at each node: from here on in `at`
    for (auto const& bed : faces)
      for (Index const vertex : bed.vertex) first[node[vertex] + 1] += asked[node[vertex]];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<SpringBed<D> const*> at(first.back());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (auto const& bed : faces)
      for (Index const vertex : bed.vertex)
        if (asked[node[vertex]]) at[next[node[vertex]]++] = &bed;
    double largest = 0;
    for (std::size_t n = 0; n < mass.size(); ++n)
      for (std::size_t i = first[n]; i < first[n + 1]; ++i) {
        double along = 0;
        for (std::size_t j = first[n]; j < first[n + 1]; ++j) {
          double cosine = 0;
          for (int c = 0; c < D; ++c) cosine += at[i]->normal[c] * at[j]->normal[c];
          if (cosine > 0) along += cosine * cosine * at[j]->stiffness / D;
        }
        largest = std::max(largest, along / mass[n]);
      }
    return largest;
  }

  static constexpr std::size_t numbers_each = 2 * D + 4;  // of a face
  /// As numbers, for a checkpoint.
  std::vector<double> flat() const {
    std::vector<double> numbers;
    for (auto const& bed : faces) {
      numbers.insert(numbers.end(), bed.vertex.begin(), bed.vertex.end());
      numbers.insert(numbers.end(), bed.normal.begin(), bed.normal.end());
      for (double number : {double(bed.rubs), double(bed.at_corners), bed.stiffness, bed.pressed})
        numbers.push_back(number);
    }
    return numbers;
  }
  void set_flat(std::vector<double> const& numbers) {
    faces.resize(numbers.size() / numbers_each);
    auto next = numbers.begin();
    for (auto& bed : faces) {
      for (Index& vertex : bed.vertex) vertex = static_cast<Index>(*next++);
      for (double& number : bed.normal) number = *next++;
      bed.rubs = *next++ != 0, bed.at_corners = *next++ != 0, bed.stiffness = *next++, bed.pressed = *next++;
    }
  }
};

}  // namespace fissure
