// Softening curves z(D): the share of its strength that a joint still carries at damage D, from 1 at 0 to 0 at 1.
// Every curve is a line of straight pieces, through a user's own points or sampled, so that its integral, by which
// fracture energies are exact, is that of what is evaluated.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/lanes.h"

namespace fissure::laws {

struct Softening {
  static constexpr int most = 64;
  static constexpr double tolerance = 2e-4;  // of the strength, by which a sampled curve may differ
  static constexpr double least = 1e-6;      // distance of two points
  int points = 0;
  float damage[most] = {}, share[most] = {};
  static constexpr int bins = 32;
  std::uint8_t piece[bins + 1] = {};  // that holds the beginning of each of as many like parts of [0, 1]
  double integral = 0;                // of z over D in [0, 1]

  /// `at` within [0, 1].
  template <class S>
  FISSURE_HD S value(S at) const {
    if (points == 2) return S(1) - at;  // the same digits, all lanes at once
    return each_lane(at, [&](auto d) { return of_one(d); });
  }
  template <class T>
  FISSURE_HD T of_one(T at) const {
    if (at == T(0)) return T(1);                                           // most joints
    int low = piece[static_cast<int>((at < T(1) ? at : T(1)) * T(bins))];  // not a number: the last
    while (low < points - 2 && !(at < T(damage[low + 1]))) ++low;
    T const a = T(damage[low]), z = T(share[low]);
    return z + (T(share[low + 1]) - z) * ((at - a) / (T(damage[low + 1]) - a));
  }

  /// Straight between points { D, z } that begin at { 0, 1 } and end at { 1, 0 }; at most `most`. Those of a sudden
  /// drop are moved apart, so that single precision can tell them from each other.
  static Softening through(std::vector<std::array<double, 2>> curve) {
    for (std::size_t i = 1; i < curve.size(); ++i) curve[i][0] = std::max(curve[i][0], curve[i - 1][0] + least);
    curve.back()[0] = 1;
    for (std::size_t i = curve.size() - 1; i-- > 1;) curve[i][0] = std::min(curve[i][0], curve[i + 1][0] - least);
    Softening s;
    for (auto const& [at, z] : curve)
      s.damage[s.points] = static_cast<float>(at), s.share[s.points++] = static_cast<float>(z);
    for (int i = 1; i < s.points; ++i)
      s.integral +=
          0.5 * (double(s.share[i]) + double(s.share[i - 1])) * (double(s.damage[i]) - double(s.damage[i - 1]));
    for (int bin = 0, low = 0; bin <= bins; ++bin) {
      while (low < s.points - 2 && s.damage[low + 1] * bins <= static_cast<float>(bin)) ++low;
      s.piece[bin] = static_cast<std::uint8_t>(low);
    }
    return s;
  }

  /// z(D), sampled where it bends most until straight pieces are right to `tolerance`.
  template <class Function>
  static Softening sampled(Function const& z) {
    std::vector<std::array<double, 2>> curve{{0, 1}};
    for (int i = 1; i < 8; ++i) curve.push_back({i / 8.0, z(i / 8.0)});
    curve.push_back({1, 0});
    for (double worst = 1; curve.size() < most && worst > tolerance;) {
      std::size_t where = 0;
      worst = 0;
      auto const middle = [&](std::size_t i) { return 0.5 * (curve[i][0] + curve[i + 1][0]); };
      for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
        if (curve[i + 1][0] - curve[i][0] < 2 * least) continue;  // a sudden drop
        if (double const error = std::abs(z(middle(i)) - 0.5 * (curve[i][1] + curve[i + 1][1])); error > worst)
          worst = error, where = i;
      }
      if (double const at = middle(where); worst > tolerance)
        curve.insert(curve.begin() + static_cast<long>(where) + 1, {at, z(at)});
    }
    return through(curve);
  }

  /// Munjiza, Andrews & White (1999), doi 10.1002/(SICI)1097-0207(19990110)44:1<41::AID-NME487>3.0.CO;2-A, fitted to
  /// concrete: z = [1 - (a+b-1)/(a+b) exp(D (a + c b)/((a+b)(1-a-b)))] [a(1-D) + b(1-D)^c], c = 6.
  static Softening const& munjiza() {
    static Softening const curve = sampled([](double d) {  // once: every joint law begins with it
      constexpr double a = 0.63, b = 1.8, c = 6;
      double const left = 1 - d;
      return (1 - (a + b - 1) / (a + b) * std::exp(d * (a + c * b) / ((a + b) * (1 - a - b)))) *
             (a * left + b * std::pow(left, c));
    });
    return curve;
  }
  bool operator==(Softening const& other) const {
    return points == other.points && std::equal(damage, damage + points, other.damage) &&
           std::equal(share, share + points, other.share);
  }
  static Softening linear() { return through({{0, 1}, {1, 0}}); }
  /// Petersson (1981), Report TVBM-1006, Lund: the kink at a third of the strength and two ninths of the way.
  static Softening bilinear() { return through({{0, 1}, {2.0 / 9, 1.0 / 3}, {1, 0}}); }
  /// exp(-5 D), moved to end at 0.
  static Softening exponential() {
    return sampled([](double d) { return (std::exp(-5 * d) - std::exp(-5.0)) / (1 - std::exp(-5.0)); });
  }
  static std::vector<std::string> const& names() {
    static std::vector<std::string> const all{"munjiza", "linear", "bilinear", "exponential"};
    return all;
  }
  static Softening named(std::string const& name) {
    return name == "linear"        ? linear()
           : name == "bilinear"    ? bilinear()
           : name == "exponential" ? exponential()
                                   : munjiza();
  }
};

}  // namespace fissure::laws
