// Plane stress around any elastic law: the thickness stretch is whatever makes the out-of-plane stress vanish.
#pragma once
#include <limits>

#include "laws/elastic.h"

namespace fissure::laws {

template <class Law>
struct PlaneStress : Law {
  PlaneStress() = default;
  explicit PlaneStress(Law const& law) : Law(law) {}

  /// Thickness strain h with tau_zz(h) = 0 to round-off. H: padded, j = J - 1 in the plane.
  template <class S>
  FISSURE_HD S thickness_strain(Mat<S, 3> const& H, S const& j) const {
    if constexpr (requires { Law::free_thickness(j); })
      return Law::free_thickness(j);
    else
      return searched_thickness(H, j);
  }

  template <class S>
  FISSURE_HD Mat<S, 3> kirchhoff(Mat<S, 3> const& H, S const& j) const {
    S const h = thickness_strain(H, j);
    Mat<S, 3> tau = Law::kirchhoff(thickened(H, h), j + h + j * h);
    tau(2, 2) = S(0);
    return tau;
  }

  /// J with the thickness, where j is that of the plane.
  template <class S>
  FISSURE_HD S volume_ratio(Mat<S, 3> const& H, S const& j) const {
    return (S(1) + j) * (S(1) + thickness_strain(H, j));
  }

  template <class S>
  FISSURE_HD S energy(Mat<S, 3> const& H, S const& j) const {
    S const h = thickness_strain(H, j);
    return Law::energy(thickened(H, h), j + h + j * h);
  }

 private:
  /// By the secant method. A rotation does not change j, unlike H: the first guess, -nu/(1 - nu) times j to first order
  /// and above -1 for any j, follows from j alone.
  template <class S>
  FISSURE_RARE FISSURE_DEVICE S searched_thickness(Mat<S, 3> const& H, S const& j) const {
    S const contraction = as<S>(this->poisson / (1 - this->poisson)) * j;
    S const resolution = root(S(std::numeric_limits<ScalarOf<S>>::epsilon()));
    S h = -contraction / (S(1) + contraction), h0 = h + root(resolution);
    S r0 = out_of_plane(H, j, h0), slope = as<S>(this->confined());
    // A secant is good to half the digits while its step is longer than that; shorter ones would divide noise by noise.
    S const least = resolution * (abs_of(H(0, 0)) + abs_of(H(1, 1)) + abs_of(h));
    for (int i = 0; i < 7; ++i) {
      S const r = out_of_plane(H, j, h), step = h - h0;
      auto const moved = abs_of(step) > least;
      slope = select(moved, (r - r0) / select(moved, step, S(1)), slope);
      h0 = h, r0 = r;
      h = h - r / slope;
    }
    return h;
  }

  template <class S>
  FISSURE_HD static S abs_of(S a) {
    return larger(a, -a);
  }

  template <class S>
  FISSURE_HD static Mat<S, 3> thickened(Mat<S, 3> H, S const& h) {
    H(2, 2) = h;
    return H;
  }

  template <class S>
  FISSURE_HD S out_of_plane(Mat<S, 3> const& H, S const& j, S const& h) const {
    return Law::kirchhoff(thickened(H, h), j + h + j * h)(2, 2);
  }
};

}  // namespace fissure::laws
