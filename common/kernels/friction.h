// Coulomb friction on a spring with a slider (Cundall & Strack 1979, doi 10.1680/geot.1979.29.1.47), of contacts, of
// broken joints and of the damaged share of softening joints. Its force derives from the energy k |stretch|^2/2 and is
// work-conjugate to the slip, whatever normal it is given and however that turns; all else that happens to the spring
// takes energy from it:
//   turning   its projection onto the current tangent plane;
//   pressing  where k grows the force stays, where it falls the stretch stays (after Walton & Braun 1986,
//             doi 10.1122/1.549893);
//   slipping  the stretch is cut where k |stretch| exceeds mu |normal|.
// What is booked is the work of the mean of the forces before and after, as the work of contacts on vertices is, less
// the growth of the stored energy: the ledger then closes to the order of the step.
#pragma once
#include "kernels/views.h"

namespace fissure::kernels {

/// Takes from the spring what lies along the unit normal n, and what exceeds `most` [m].
template <int D, class S>
FISSURE_HD void hold_within(Vec<S, D> const& n, S most, Vec<S, D>& stretch) {
  stretch -= n * n.dot(stretch);
  S const length = root(stretch.squaredNorm());
  stretch *= select(length > most, S(most / length), S(1));
}

/// The force that opposes the slip of the body pressed by the normal force `size` [N] along the unit normal n, no more
/// than `most` [N] (ContactLaw::most()). k: stiffness [N/m], the upper end of Mindlin's range (2/3..1) where it is the
/// contact's normal stiffness; spring: stretch [m] (D numbers) and the stiffness that carried it. `work` [J] is what
/// slider and spring lost in this step, never negative: a slip that turns back past the slider within one step would
/// ask for the contrary, and shows in the residual.
template <int D, class Real>
FISSURE_HD Vec<Real, D> friction(Vec<Real, D> const& n, Real size, Vec<Real, D> const& velocity, Real dt, Real k,
                                 Real most, Real* spring, Real& work) {
  Vec<Real, D> stretch;
  for (int c = 0; c < D; ++c) stretch[c] = spring[c];
  Vec<Real, D> const slip = velocity * dt, before = stretch * spring[D];
  Real const held = before.dot(stretch) / 2;
  if (size > 0 && k > 0) {
    if (k > spring[D]) stretch *= spring[D] / k;
    stretch += slip;
    hold_within<D, Real>(n, most / k, stretch);
  } else {
    stretch.setZero();
    k = 0;
  }
  Vec<Real, D> const after = stretch * k;
  work = positive((before + after).dot(slip) / 2 + held - after.dot(stretch) / 2);
  for (int c = 0; c < D; ++c) spring[c] = stretch[c];
  spring[D] = k;
  return -after;
}

/// Friction of the damaged share of a joint, 0 to 1, per area: k [Pa/m] times that share is its stiffness. Where the
/// share grows, what joins carries `joining` [m]; its energy must be less than what the joint releases there. Adds to
/// `lost` [J/m^2] what friction takes less what is handed to it. Returns the traction along the stretch [Pa].
template <int D, class S>
FISSURE_HD Vec<S, D> damaged_friction(Vec<S, D> const& n, Vec<S, D> const& slip, S k, S share_before, S share, S most,
                                      Vec<S, D> const& joining, Vec<S, D>& stretch, S& lost) {
  Vec<S, D> const before = stretch * (k * share_before);
  S const held = before.dot(stretch) / S(2);
  stretch += slip;
  S const grown = select(share > share_before, S((share - share_before) / share), S(0));
  stretch = stretch * (S(1) - grown) + joining * grown;
  hold_within<D, S>(n, most, stretch);
  Vec<S, D> const after = stretch * (k * share);
  lost += (before + after).dot(slip) / S(2) + held - after.dot(stretch) / S(2);
  return after;
}

}  // namespace fissure::kernels
