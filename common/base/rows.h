// Rows of numbers in memory, one per lane: how kernels read and write what belongs to a vertex or an element.
#pragma once
#include "base/lanes.h"

#if !defined(__CUDACC__)
#include <bit>
#include <utility>
#endif

namespace fissure {

/// n numbers that stand in a row in memory, one row per lane: number[k] has from(l)[k] in lane l; and back to to(l)[k].
template <int n, class S, class F, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD void load_rows(S* number, F&& from) {
  for (int k = 0; k < n; ++k) number[k] = from(0)[k];
}
template <int n, class S, class F, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD void store_rows(S const* number, F&& to) {
  for (int k = 0; k < n; ++k) to(0)[k] = number[k];
}

/// Lane l of pack k of n gets number (k width + l)/n of `a`: what n numbers in a row have in common, once for each.
template <int n, class S, std::enable_if_t<std::is_floating_point_v<S>, int> = 0>
FISSURE_HD S repeat_lanes(S a, int) {
  return a;
}

#if !defined(__CUDACC__)
namespace rows {
template <class T, int n>
struct RegisterOf {
  typedef T type __attribute__((vector_size(n * sizeof(T))));
};
}  // namespace rows

/// Rows of a power of two of numbers to lanes and back: whole rows are read side by side into registers, which are then
/// transposed by exchanging blocks of 1, 2, 4 .. numbers (Eklundh, "A fast computer method for matrix transposing",
/// IEEE Trans. Comput. C-21, 1972). A register is as wide as a pack; it holds `width / length` rows.
template <class T, int width, int length>
struct RowTranspose {
  template <int n>
  using Register = typename rows::RegisterOf<T, n>::type;
  using Full = Register<width>;

  /// Lane l = first + i * length for i in [0, rows): their rows side by side.
  template <int rows = width / length, class F>
  FISSURE_HD static Register<rows * length> read(int first, F&& from) {
    if constexpr (rows == 1) {
      Register<length> row;
      __builtin_memcpy(&row, from(first), sizeof row);
      return row;
    } else {
      return beside(read<rows / 2>(first, from), read<rows / 2>(first + rows / 2 * length, from),
                    std::make_index_sequence<rows * length>());
    }
  }
  template <int rows = width / length, class F>
  FISSURE_HD static void write(Register<rows * length> const& full, int first, F&& to) {
    if constexpr (rows == 1) {
      __builtin_memcpy(to(first), &full, sizeof full);
    } else {
      std::make_index_sequence<rows * length / 2> const half;
      write<rows / 2>(part<0>(full, half), first, to);
      write<rows / 2>(part<rows * length / 2>(full, half), first + rows / 2 * length, to);
    }
  }

  /// Within every block of length x length: number k of row l becomes number l of row k.
  template <int step = 1>
  FISSURE_HD static void transpose(Full (&r)[length]) {
    if constexpr (step < length) {
      std::make_index_sequence<width> const all;
      for (int i = 0; i < length; ++i)
        if ((i & step) == 0) {
          Full const a = r[i], b = r[i + step];
          r[i] = even<step>(a, b, all);
          r[i + step] = odd<step>(a, b, all);
        }
      transpose<2 * step>(r);
    }
  }

 private:
  template <class V, std::size_t... i>
  FISSURE_HD static auto beside(V const& a, V const& b, std::index_sequence<i...>) {
    return __builtin_shufflevector(a, b, static_cast<int>(i)...);
  }
  template <int from, class V, std::size_t... i>
  FISSURE_HD static auto part(V const& a, std::index_sequence<i...>) {
    return __builtin_shufflevector(a, a, (from + static_cast<int>(i))...);
  }
  template <int step, std::size_t... i>
  FISSURE_HD static Full even(Full const& a, Full const& b, std::index_sequence<i...>) {
    return __builtin_shufflevector(a, b, static_cast<int>((i & step) ? width + i - step : i)...);
  }
  template <int step, std::size_t... i>
  FISSURE_HD static Full odd(Full const& a, Full const& b, std::index_sequence<i...>) {
    return __builtin_shufflevector(a, b, static_cast<int>((i & step) ? width + i : i + step)...);
  }
};

/// The longest piece in which rows of n numbers are moved by packs of `width`.
constexpr int row_piece(int n, int width) {
  int piece = 1;
  while (2 * piece <= n && 2 * piece <= width) piece *= 2;
  return piece;
}

template <int n, class S, std::enable_if_t<stdx::is_simd_v<S>, int> = 0>
FISSURE_HD S repeat_lanes(S const& a, int k) {
  return S([&](auto l) { return lane(a, (k * lane_width<S> + static_cast<int>(l)) / n); });
}

template <int n, class S, class F, std::enable_if_t<stdx::is_simd_v<S>, int> = 0>
FISSURE_HD void load_rows(S* number, F&& from) {
  constexpr int width = lane_width<S>, length = row_piece(n, width);
  if constexpr (length == 1) {
    number[0] = generate<S>([&](int l) { return from(l)[0]; });
  } else {
    using Rows = RowTranspose<ScalarOf<S>, width, length>;
    typename Rows::Full r[length];
    for (int i = 0; i < length; ++i) r[i] = Rows::read(i, from);
    Rows::transpose(r);
    for (int i = 0; i < length; ++i) number[i] = std::bit_cast<S>(r[i]);
  }
  if constexpr (n > length) load_rows<n - length>(number + length, [&](int l) { return from(l) + length; });
}
template <int n, class S, class F, std::enable_if_t<stdx::is_simd_v<S>, int> = 0>
FISSURE_HD void store_rows(S const* number, F&& to) {
  constexpr int width = lane_width<S>, length = row_piece(n, width);
  if constexpr (length == 1) {
    for (int l = 0; l < width; ++l) to(l)[0] = lane(number[0], l);
  } else {
    using Rows = RowTranspose<ScalarOf<S>, width, length>;
    typename Rows::Full r[length];
    for (int i = 0; i < length; ++i) r[i] = std::bit_cast<typename Rows::Full>(number[i]);
    Rows::transpose(r);
    for (int i = 0; i < length; ++i) Rows::write(r[i], i, to);
  }
  if constexpr (n > length) store_rows<n - length>(number + length, [&](int l) { return to(l) + length; });
}
#endif

}  // namespace fissure
