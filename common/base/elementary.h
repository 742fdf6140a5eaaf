// exp, log and powers over lanes: the same bits for a plain number and for a lane of a pack, on every processor.
#pragma once
#include <cstdint>

#include "base/lanes.h"

namespace fissure {

namespace detail {

template <class T>
struct Format;  // of a floating-point number
template <>
struct Format<double> {
  using Int = std::int64_t;
  static constexpr int mantissa = 52;
  static constexpr Int sqrt_half = 0x3fe6a09e667f3bcd;
  // 1.5 * 2^52: adding it leaves a rounded whole number in the low bits
  static constexpr double round = 6755399441055744.0;
  static constexpr Int round_bits = 0x4338000000000000;
  static constexpr double ln2_high = 0.693147180369123816490, ln2_low = 1.90821492927058770002e-10, most = 709;
  static constexpr int log_terms = 10, exp_terms = 13;
};
template <>
struct Format<float> {
  using Int = std::int32_t;
  static constexpr int mantissa = 23;
  static constexpr Int sqrt_half = 0x3f3504f3;
  static constexpr float round = 12582912.0f;  // 1.5 * 2^23
  static constexpr Int round_bits = 0x4b400000;
  static constexpr float ln2_high = 0.693359375f, ln2_low = -2.12194440e-4f, most = 88;
  static constexpr int log_terms = 4, exp_terms = 7;
};

/// The same bits as another type.
template <class To, class From>
FISSURE_HD To same_bits(From const& from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  __builtin_memcpy(static_cast<void*>(&to), &from, sizeof(To));
  return to;
}

/// The whole numbers beside the lanes of S, as a plain number or a vector of the compiler's own.
template <class S>
struct BitsOf {
  using type = typename Format<S>::Int;
  FISSURE_HD static S number(type k) { return static_cast<S>(k); }
};
#if !defined(__CUDACC__)
template <class T, class Abi>
struct BitsOf<stdx::simd<T, Abi>> {
  using S = stdx::simd<T, Abi>;
  typedef typename Format<T>::Int type __attribute__((vector_size(sizeof(S))));
  typedef T Values __attribute__((vector_size(sizeof(S))));
  FISSURE_HD static S number(type const& k) { return same_bits<S>(__builtin_convertvector(k, Values)); }
};
#endif

}  // namespace detail

/// ln x of normal x > 0: x = 2^k m with m about 1, ln m = 2 artanh((m - 1)/(m + 1)) as a series.
template <class S>
FISSURE_HD S log_of(S x) {
  using F = detail::Format<ScalarOf<S>>;
  using Bits = typename detail::BitsOf<S>::type;
  Bits const bits = detail::same_bits<Bits>(x), k = (bits - F::sqrt_half) >> F::mantissa;
  S const m = detail::same_bits<S>(Bits(bits - (k << F::mantissa)));
  S const f = (m - S(1)) / (m + S(1)), g = f * f;
  S sum = as<S>(1.0 / (2 * F::log_terms + 1));
  for (int i = F::log_terms - 1; i >= 0; --i) sum = sum * g + as<S>(1.0 / (2 * i + 1));
  S const e = detail::BitsOf<S>::number(k);
  return e * S(F::ln2_high) + (S(2) * f * sum + e * S(F::ln2_low));
}

/// x - ln(1 + x) for x > -1, without loss of digits near x = 0: ln(1 + x) = 2 artanh s, s = x/(2 + x), as a series.
template <class S>
FISSURE_HD S excess_over_log(S const& x) {
  using F = detail::Format<ScalarOf<S>>;
  S const s = x / (S(2) + x), g = s * s;
  S sum = as<S>(1.0 / (2 * F::log_terms + 1));
  for (int i = F::log_terms - 1; i >= 1; --i) sum = sum * g + as<S>(1.0 / (2 * i + 1));
  return select(g < as<S>(0.03), s * x - S(2) * s * g * sum, x - log_of(S(S(1) + x)));
}

/// e^x, x held between the ends of the number range: x = k ln 2 + r, e^r as its series.
template <class S>
FISSURE_HD S exp_of(S x) {
  using F = detail::Format<ScalarOf<S>>;
  using Bits = typename detail::BitsOf<S>::type;
  x = larger(S(-F::most), smaller(S(F::most), x));
  S const rounded = x * as<S>(1.44269504088896340736) + S(F::round);
  S const k = rounded - S(F::round);
  S const r = (x - k * S(F::ln2_high)) - k * S(F::ln2_low);
  S sum = S(1);
  for (int i = F::exp_terms; i > 0; --i) sum = S(1) + sum * r * as<S>(1.0 / i);
  Bits const steps = detail::same_bits<Bits>(rounded) - F::round_bits;
  return detail::same_bits<S>(Bits(detail::same_bits<Bits>(sum) + (steps << F::mantissa)));
}

/// x^n for x > 0.
template <class S>
FISSURE_HD S power(S x, double n) {
  return exp_of(as<S>(n) * log_of(x));
}

}  // namespace fissure
