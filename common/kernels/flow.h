// One step of the memory of elements that flow.
#pragma once
#include <limits>

#include "backend/for_each.h"
#include "kernels/views.h"
#include "laws/plastic.h"

namespace fissure::kernels {

/// Where the numbers of a symmetric tensor stand: xx yy zz xy yz zx; a flat model has the first four.
FISSURE_HD constexpr int tensor_row(int k) { return k % 3; }
FISSURE_HD constexpr int tensor_column(int k) { return k < 3 ? k : (k + 1) % 3; }

/// What elements of a body that flows remember (laws::Memory says which numbers), and what flow took.
template <class Real>
struct MemoryView {
  Real* numbers = nullptr;         // blocked from the body's first element on
  Index first = 0;                 // that element
  double* plastic_work = nullptr;  // per element [J]
};

/// Access to memory, and its step; the same for all joint laws, so it stands by itself.
template <int D, class Real>
struct Flow {
  laws::Plastic const& law;
  MemoryView<Real> const& memory;

  /// Number k of element e and of those beside it: the numbers of a block stand layout_width apart.
  FISSURE_HD Real* slot(Index e, int k) const {
    return memory.numbers + blocked(e - memory.first, 0, law.memory.numbers) + k * layout_width;
  }
  template <class S>
  FISSURE_HD S number(Index e, int k) const {
    return k < 0 ? S(0) : load<S>(slot(e, k));
  }
  template <class S>
  FISSURE_HD Mat<S, 3> tensor(Index e, int from) const {
    Real const* const at = slot(e, from);
    Mat<S, 3> t = Mat<S, 3>::Constant(S(0));
    FISSURE_UNROLL
    for (int k = 0; k < Dim<D>::stresses; ++k)
      t(tensor_row(k), tensor_column(k)) = t(tensor_column(k), tensor_row(k)) = load<S>(at + k * layout_width);
    return t;
  }

  /// tau [Pa] at the end of a step with the increment G, and the new memory (unless the law is frozen). What is no
  /// number is not remembered, but for the rate, which says so to the host.
  template <class S, class Law>
  FISSURE_CALL Mat<S, 3> step(Law const& flow, Index e, Mat<S, 3> const& G, S const& j, S const& volume, double dt,
                              int* fault) const {
    auto const& m = law.memory;
    laws::FlowPoint<S, Law::has_back> point;
    point.stress = tensor<S>(e, 0);
    point.strain = number<S>(e, m.strain);
    point.rate = number<S>(e, m.rate);
    point.rise = number<S>(e, m.rise);
    if constexpr (Law::has_back) point.back = tensor<S>(e, m.back);
    S thickness = number<S>(e, m.thickness);
    auto const slow = point.rate;
    S const dissipated = law.template step<S>(flow, point, G, j, thickness, dt > 0 ? 1 / dt : 0);
    if (law.frozen) return point.stress;

    S const sum = point.stress.sum() + point.strain + thickness;
    auto const good = j > as<S>(-1) && sum - sum == S(0);
    bool const all_good = all_lanes(good);
    if (!all_good) {
      raise(fault);
      point.rate = select(good, point.rate, as<S>(std::numeric_limits<double>::quiet_NaN()));
    }
    auto const keep = [&](int k, S const& value) {
      if (k >= 0) store(all_good ? value : select(good, value, number<S>(e, k)), slot(e, k));
    };
    FISSURE_UNROLL
    for (int k = 0; k < Dim<D>::stresses; ++k) {
      keep(k, point.stress(tensor_row(k), tensor_column(k)));
      if constexpr (Law::has_back) keep(m.back + k, point.back(tensor_row(k), tensor_column(k)));
    }
    keep(m.thickness, thickness);
    bool const flowed = any_lane(point.rate > S(0));
    if (flowed || !all_good || any_lane(slow > S(0))) store(point.rate, slot(e, m.rate));
    if (!flowed) return point.stress;
    keep(m.strain, point.strain);
    keep(m.rise, point.rise);
    S const work = volume * dissipated;
    for (int l = 0; l < lane_width<S>; ++l) memory.plastic_work[e + l] += static_cast<double>(lane(work, l));
    return point.stress;
  }
};

}  // namespace fissure::kernels
