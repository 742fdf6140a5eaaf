// Softening curves z(D): the share of its strength that a joint still carries at damage D. Each gives z and its integral over [0,1].
#pragma once
#include "base/lanes.h"

namespace fissure::laws {

/// Munjiza, Andrews & White (1999), doi 10.1002/(SICI)1097-0207(19990110)44:1<41::AID-NME487>3.0.CO;2-A, fitted to concrete:
/// z = [1 - (a+b-1)/(a+b) exp(D (a + c b)/((a+b)(1-a-b)))] [a(1-D) + b(1-D)^c].
struct MunjizaSoftening {
  static constexpr double a = 0.63, b = 1.8, c = 6.0;
  static constexpr double integral = 0.3863072947439421;  // of z over D in [0, 1], by Gauss-Legendre quadrature

  template <class T>
  FISSURE_HD static T value(T damage) {
    T const left = T(1) - damage;
    T const cube = left * left * left;
    T const curve = T(a) * left + T(b) * cube * cube;  // c = 6
    return (T(1) - T((a + b - 1) / (a + b)) * std::exp(damage * T((a + c * b) / ((a + b) * (1 - a - b))))) * curve;
  }
};

/// z = 1 - D.
struct LinearSoftening {
  static constexpr double integral = 0.5;

  template <class T>
  FISSURE_HD static T value(T damage) { return T(1) - damage; }
};

}  // namespace fissure::laws
