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
/// stress is off by a share of about their size.
template <int D>
class InitialStrain {
 public:
  /// `low`, `high`: between them lies the body [m]; `origin`: where r is 0. Throws Error at the body where the stress
  /// is not linear between them.
  InitialStrain(scene::Body const& body, laws::ElasticConstants const& elastic, Section const& section, Vec3 const& low,
                Vec3 const& high, Vec3 const& origin)
      : body_(body), origin_(origin), middle_((low + high) / 2) {
    double const shear = elastic.young / (2 * (1 + elastic.poisson));
    double lambda = elastic.confined() - 2 * shear;
    if (section.plane_stress()) lambda *= 2 * shear / (lambda + 2 * shear);
    at_middle_ = stress(middle_);
    half_ = (high - low) / 2;
    for (int k = 0; k < D; ++k) {
      if (!(half_[k] > 0)) continue;
      Vec3 const step = half_[k] * Vec3::Unit(k);
      slope_[k] = (stress(middle_ + step) - stress(middle_ - step)) / (2 * half_[k]);
    }
    auto const strain = [&](Mat<double, D> const& sigma) {
      double const share = lambda / (2 * shear + D * lambda);
      return Mat<double, D>((sigma - share * sigma.trace() * Mat<double, D>::Identity()) / (2 * shear));
    };
    E_ = strain(at_middle_);
    for (int k = 0; k < D; ++k) {
      G_[k] = strain(slope_[k]);
      E_ += (origin - middle_)[k] * G_[k];
    }
  }

  Vec<double, D> operator()(Vec3 const& x) const {
    refuse_curved(x);
    Vec<double, D> r;
    for (int c = 0; c < D; ++c) r[c] = x[c] - origin_[c];
    Mat<double, D> slope = Mat<double, D>::Zero();  // C_ijk r_k
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j)
        for (int k = 0; k < D; ++k) slope(i, j) += (G_[k](i, j) + G_[j](i, k) - G_[i](j, k)) * r[k];
    refuse_turned(x, E_ + slope);
    return E_ * r + slope * r / 2;
  }
  /// Whether both give every place the same displacement.
  bool like(InitialStrain const& other) const {
    double off = (E_ - other.E_).norm(), whole = E_.norm() + other.E_.norm();
    for (int k = 0; k < D; ++k) {
      double const reach = (middle_ - origin_).norm() + (other.middle_ - origin_).norm();
      off += reach * (G_[k] - other.G_[k]).norm();
    }
    return off <= 1e-9 * whole;
  }

 private:
  /// A stress that changes along the body bends it: what it is turned by, squared, must be little beside the strain.
  void refuse_turned(Vec3 const& x, Mat<double, D> const& gradient) const {
    Mat<double, D> const turn = (gradient - gradient.transpose()) / 2;
    double most = E_.norm();
    for (int k = 0; k < D; ++k) most = std::max(most, half_[k] * G_[k].norm());
    double const share = turn.squaredNorm() / 2 / most;
    if (!(share > 0.01)) return;
    throw Error(
        body_.source,
        fmt::format("body \"{}\": its stress bends it by {:.2g} rad at {{ {:g}, {:g}, {:g} }}, and would be off by "
                    "{:.2g} of itself (strains must be small); a body that is less wide, a stiffer one, or under "
                    "weight xx = zz = nu/(1 - nu) yy, which bends nothing, can begin so",
                    body_.name, std::sqrt(turn.squaredNorm() / 2), x[0], x[1], x[2], share));
  }
  Mat<double, D> stress(Vec3 const& x) const {
    auto const s = body_.stress_at(x[0], x[1], x[2]);
    std::array<int, 9> const place{0, 3, 5, 3, 1, 4, 5, 4, 2};  // of xx yy zz xy yz zx
    Mat<double, D> sigma;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) sigma(i, j) = s[place[3 * i + j]];
    return sigma;
  }
  void refuse_curved(Vec3 const& x) const {
    Mat<double, D> linear = at_middle_;
    for (int k = 0; k < D; ++k) linear += (x - middle_)[k] * slope_[k];
    Mat<double, D> const found = stress(x);
    double whole = found.norm() + at_middle_.norm();
    for (int k = 0; k < D; ++k) whole += half_[k] * slope_[k].norm();
    if ((found - linear).norm() <= 1e-6 * whole) return;
    throw Error(
        body_.source,
        fmt::format("body \"{}\": its stress at {{ {:g}, {:g}, {:g} }} is no linear function of the place; only such "
                    "a stress fits together from the start (as that of weight does)",
                    body_.name, x[0], x[1], x[2]));
  }

  scene::Body const& body_;
  Vec3 origin_, middle_, half_{0, 0, 0};
  Mat<double, D> at_middle_ = Mat<double, D>::Zero(), E_ = Mat<double, D>::Zero();
  std::array<Mat<double, D>, D> slope_ = zeros(), G_ = zeros();

  static std::array<Mat<double, D>, D> zeros() {
    std::array<Mat<double, D>, D> all;
    all.fill(Mat<double, D>::Zero());
    return all;
  }
};

}  // namespace fissure::model
