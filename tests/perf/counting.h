// A scalar that counts what is done with it: run through the same kernels, it gives the flops of an element-step.
#pragma once
#include "base/rows.h"

namespace fissure {

/// What all Counting numbers did since the last reset. Comparisons, choices and changes of sign are free.
struct Counted {
  long flops = 0, divisions = 0, roots = 0;
};

template <class T>
struct Counting {
  T value = 0;
  inline static Counted counted;

  Counting() = default;
  template <class N, std::enable_if_t<std::is_arithmetic_v<N>, int> = 0>
  Counting(N number) : value(static_cast<T>(number)) {}

  static Counting after(long& what, T value) {
    ++what;
    return Counting(value);
  }
  friend Counting operator+(Counting a, Counting b) { return after(counted.flops, a.value + b.value); }
  friend Counting operator-(Counting a, Counting b) { return after(counted.flops, a.value - b.value); }
  friend Counting operator*(Counting a, Counting b) { return after(counted.flops, a.value * b.value); }
  friend Counting operator/(Counting a, Counting b) { return after(counted.divisions, a.value / b.value); }
  Counting operator-() const { return Counting(-value); }
  Counting& operator+=(Counting b) { return *this = *this + b; }
  Counting& operator-=(Counting b) { return *this = *this - b; }
  Counting& operator*=(Counting b) { return *this = *this * b; }
  Counting& operator/=(Counting b) { return *this = *this / b; }
  friend bool operator<(Counting a, Counting b) { return a.value < b.value; }
  friend bool operator>(Counting a, Counting b) { return a.value > b.value; }
  friend bool operator<=(Counting a, Counting b) { return a.value <= b.value; }
  friend bool operator>=(Counting a, Counting b) { return a.value >= b.value; }
  friend bool operator==(Counting a, Counting b) { return a.value == b.value; }
  friend bool operator!=(Counting a, Counting b) { return a.value != b.value; }
};

template <class S>
inline constexpr bool is_counting = false;
template <class T>
inline constexpr bool is_counting<Counting<T>> = true;

template <class T>
struct LaneTraits<Counting<T>> {
  using Scalar = T;
  using Mask = bool;
  static constexpr int width = 1;
};

template <class T>
Counting<T> select(bool mask, Counting<T> a, Counting<T> b) {
  return mask ? a : b;
}
template <class T>
Counting<T> larger(Counting<T> a, Counting<T> b) {
  return a > b ? a : b;
}
template <class T>
Counting<T> smaller(Counting<T> a, Counting<T> b) {
  return a < b ? a : b;
}
template <class T>
Counting<T> root(Counting<T> a) {
  return Counting<T>::after(Counting<T>::counted.roots, std::sqrt(a.value));
}
template <class S, std::enable_if_t<is_counting<S>, int> = 0>
S load(ScalarOf<S> const* from) {
  return S(*from);
}
template <class T>
void store(Counting<T> a, T* to) {
  *to = a.value;
}
template <class T>
T lane(Counting<T> a, int) {
  return a.value;
}
template <class T>
void set_lane(Counting<T>& a, int, T value) {
  a.value = value;
}
template <class S, class F, std::enable_if_t<is_counting<S>, int> = 0>
S generate(F&& f) {
  return S(f(0));
}
template <int n, class S, class F, std::enable_if_t<is_counting<S>, int> = 0>
void load_rows(S* number, F&& from) {
  for (int k = 0; k < n; ++k) number[k] = S(from(0)[k]);
}
template <int n, class S, class F, std::enable_if_t<is_counting<S>, int> = 0>
void store_rows(S const* number, F&& to) {
  for (int k = 0; k < n; ++k) to(0)[k] = number[k].value;
}
template <int n, class S, std::enable_if_t<is_counting<S>, int> = 0>
S repeat_lanes(S a, int) {
  return a;
}

}  // namespace fissure

namespace Eigen {
template <class T>
struct NumTraits<fissure::Counting<T>> : GenericNumTraits<fissure::Counting<T>> {
  using Self = fissure::Counting<T>;
  using Real = Self;
  using NonInteger = Self;
  using Nested = Self;
  using Literal = Self;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};
}  // namespace Eigen
