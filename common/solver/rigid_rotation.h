// One step of a free rotation.
#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <optional>

namespace fissure {

/// What a body of this inertia I [kg m^2], as it stands, turns by in a step: the unit quaternion (w, s) with
///   2 (w I s + s x I s) = momentum * dt,
/// the angular momentum sum m x_n cross (x_n+1 - x_n) of its points over the step [kg m^2/s times s]. That is the
/// central difference with lengths that stay (J. Moser, A. P. Veselov 1991, doi 10.1007/BF02352494): momentum is kept
/// exactly, energy does not drift. Nothing where the body would turn by more than some 60 degrees in the step.
inline std::optional<Eigen::Quaterniond> step_rotation(Eigen::Matrix3d const& inertia, Eigen::Vector3d const& turned) {
  Eigen::LDLT<Eigen::Matrix3d> const solve(inertia);
  Eigen::Vector3d s = solve.solve(turned) / 2;
  // Each round gains a factor |s|; the sum of 60 is below rounding for the largest s allowed.
  for (int round = 0; round < 60 && s.squaredNorm() < 0.25; ++round) {
    double const w = std::sqrt(1 - s.squaredNorm());
    Eigen::Vector3d const next = solve.solve(turned / 2 - s.cross(inertia * s)) / w;
    double const change = (next - s).norm();
    s = next;
    if (change <= 1e-16 * s.norm()) break;
  }
  if (!(s.squaredNorm() < 0.25)) return std::nullopt;
  return Eigen::Quaterniond(std::sqrt(1 - s.squaredNorm()), s[0], s[1], s[2]);
}

}  // namespace fissure
