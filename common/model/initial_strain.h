// A stress at the start: the body was strained into the place where the scene has it.
#pragma once
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/algebra.h"
#include "laws/laws.h"
#include "model/section.h"
#include "scene/scene.h"

namespace fissure::model {

/// The displacement u(x) from the place without stress to the place x, of a stress that is linear in place: strain is
/// then linear, too, so that it is that of a displacement, whatever the stress,
///   u_i = E_ij r_j + C_ijk r_j r_k/2,   C_ijk = G_ijk + G_ikj - G_jki,   G_ijk the strain's slope along k,
/// r from a place that all bodies share (Cesaro's integral of a strain, Rend. Accad. Napoli 12, 1906). Small strains:
/// stress is off by a share of about their size. A flat section is the plane z = 0 of a solid whose zz is what the
/// section makes it.
class InitialStrain {
 public:
  /// `low`, `high`: between them lies the body [m]; `origin`: where r is 0. Throws Error at the body where the stress
  /// is not linear between them, or does not fit around an axis of revolution.
  InitialStrain(scene::Body const& body, laws::ElasticConstants const& elastic, Section const& section, bool flat,
                Vec3 const& low, Vec3 const& high, Vec3 const& origin)
      : body_(body), section_(section), flat_(flat), poisson_(elastic.poisson), origin_(origin) {
    middle_ = (low + high) / 2, half_ = (high - low) / 2;
    at_middle_ = stress(middle_);
    for (int k = 0; k < 3; ++k) {
      if (!(half_[k] > 0)) continue;
      Vec3 const step = half_[k] * Vec3::Unit(k);
      slope_[k] = (stress(middle_ + step) - stress(middle_ - step)) / (2 * half_[k]);
    }
    auto const strain = [&](Mat<double, 3> const& sigma) {
      return Mat<double, 3>(
          ((1 + elastic.poisson) * sigma - elastic.poisson * sigma.trace() * Mat<double, 3>::Identity()) /
          elastic.young);
    };
    E_ = strain(at_middle_);
    for (int k = 0; k < 3; ++k) {
      G_[k] = strain(slope_[k]);
      E_ += (origin - middle_)[k] * G_[k];
    }
  }

  Vec3 operator()(Vec3 const& x) const {
    refuse_curved(x);
    if (section_.axisymmetric()) refuse_hoops(x);
    Vec3 const r = x - origin_;
    Mat<double, 3> slope = Mat<double, 3>::Zero();  // C_ijk r_k
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) slope(i, j) += (G_[k](i, j) + G_[j](i, k) - G_[i](j, k)) * r[k];
    refuse_turned(x, E_ + slope);
    return E_ * r + slope * r / 2;
  }
  /// Whether both give every place the same displacement.
  bool like(InitialStrain const& other) const {
    double off = (E_ - other.E_).norm(), whole = E_.norm() + other.E_.norm();
    for (int k = 0; k < 3; ++k) {
      double const reach = (middle_ - origin_).norm() + (other.middle_ - origin_).norm();
      off += reach * (G_[k] - other.G_[k]).norm();
    }
    return off <= 1e-9 * whole;
  }

 private:
  /// A stress that changes along the body bends it: what it is turned by, squared, must be little beside the strain.
  void refuse_turned(Vec3 const& x, Mat<double, 3> const& gradient) const {
    Mat<double, 3> const turn = (gradient - gradient.transpose()) / 2;
    double most = E_.norm();
    for (int k = 0; k < 3; ++k) most = std::max(most, half_[k] * G_[k].norm());
    double const share = turn.squaredNorm() / 2 / most;
    if (!(share > 0.01)) return;
    throw Error(
        body_.source,
        fmt::format("body \"{}\": its stress bends it by {:.2g} rad at {{ {:g}, {:g}, {:g} }}, and would be off by "
                    "{:.2g} of itself (strains must be small); a body that is less wide, a stiffer one, or under "
                    "weight xx = zz = nu/(1 - nu) yy, which bends nothing, can begin so",
                    body_.name, std::sqrt(turn.squaredNorm() / 2), x[0], x[1], x[2], share));
  }
  Mat<double, 3> stress(Vec3 const& x) const {
    auto s = body_.stress_at(x[0], x[1], x[2]);
    if (flat_ && !section_.axisymmetric()) s[2] = section_.plane_stress() ? 0 : poisson_ * (s[0] + s[1]);
    Mat<double, 3> sigma;
    sigma << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    return sigma;
  }
  double size_at(Mat<double, 3> const& found) const {
    double whole = found.norm() + at_middle_.norm();
    for (int k = 0; k < 3; ++k) whole += half_[k] * slope_[k].norm();
    return whole;
  }
  void refuse_curved(Vec3 const& x) const {
    Mat<double, 3> linear = at_middle_;
    for (int k = 0; k < 3; ++k) linear += (x - middle_)[k] * slope_[k];
    Mat<double, 3> const found = stress(x);
    if ((found - linear).norm() <= 1e-6 * size_at(found)) return;
    throw Error(
        body_.source,
        fmt::format("body \"{}\": its stress at {{ {:g}, {:g}, {:g} }} is no linear function of the place; only such "
                    "a stress fits together from the start (as that of weight does)",
                    body_.name, x[0], x[1], x[2]));
  }
  /// Around an axis only what is alike in all directions across it, and at all radii, is linear in place.
  void refuse_hoops(Vec3 const& x) const {
    Mat<double, 3> const s = stress(x);
    double const most = 1e-6 * size_at(s);
    if (std::abs(s(0, 0) - s(2, 2)) <= most && std::abs(s(0, 1)) <= most && half_[0] * slope_[0].norm() <= most) return;
    throw Error(
        body_.source,
        fmt::format("body \"{}\": around an axis a stress at the start has zz (the hoops) equal to xx, no xy, and "
                    "is the same at all radii; at {{ {:g}, {:g} }} it has xx = {:g}, zz = {:g}, xy = {:g} Pa",
                    body_.name, x[0], x[1], s(0, 0), s(2, 2), s(0, 1)));
  }

  scene::Body const& body_;
  Section const& section_;
  bool flat_;
  double poisson_;
  Vec3 origin_, middle_{0, 0, 0}, half_{0, 0, 0};
  Mat<double, 3> at_middle_ = Mat<double, 3>::Zero(), E_ = Mat<double, 3>::Zero();
  std::array<Mat<double, 3>, 3> slope_ = zeros(), G_ = zeros();

  static std::array<Mat<double, 3>, 3> zeros() {
    std::array<Mat<double, 3>, 3> all;
    all.fill(Mat<double, 3>::Zero());
    return all;
  }
};

}  // namespace fissure::model
