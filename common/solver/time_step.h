// The stable time step of the explicit scheme (docs/theory/time_step.md).
//   omega^2 <= max over vertices of  sum_e(lambda_e m_ea)/m_a + 2 sum_joints(k A/d)/m_a  (+ contact),
//   lambda_e = (D+1) c^2 sum |grad N|^2, c^2 = E'/rho: rigorous for any lumped mass (Weyl, Gershgorin), one pass.
//   Power iteration on the operator itself tightens it. With damping c_v = 2 mu/E' omega_b^2 + alpha:
//   dt = safety (sqrt(c_v^2 + 4 omega^2) - c_v)/omega^2.
#pragma once
#include <cmath>
#include <string>

namespace fissure {

/// Squared frequencies [1/s^2] of the stiffest vertex and what they belong to.
struct FrequencyBound {
  double bulk = 0;         // largest over vertices
  double total = 0;        // largest sum of bulk and joints at one vertex
  double damping = 0;      // top eigenvalue of the damping matrix over the mass [1/s]
  std::string owner;
};

/// Largest stable step [s] for the squared frequency and damping eigenvalue given, without safety.
inline double stable_step(double omega_squared, double damping) {
  return (std::sqrt(damping * damping + 4 * omega_squared) - damping) / omega_squared;
}

}  // namespace fissure
