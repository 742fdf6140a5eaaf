// Prescribed motion as a stage of the step: holds, and the axis of revolution, which stays where it is.
#pragma once
#include <vector>

#include "model/model.h"
#include "solver/ledger.h"

namespace fissure {

template <int D, class Real>
class MotionStage {
 public:
  MotionStage(Device& device, scene::Scene const& scene, model::Model<D, Real>& model, Ledger& ledger)
      : device_(device),
        scene_(scene),
        model_(model),
        ledger_(ledger),
        reaction_(scene.holds.size(), Vec3(0, 0, 0)),
        torque_(scene.holds.size(), 0) {}

  void stay_on_axis();
  /// Reactions that bring held vertices to the velocity asked for at the middle of the step of `dt` that begins at t,
  /// where the leapfrog keeps velocities; `last_dt` led here, `damping` is that of mass [1/s].
  void react(double t, double last_dt, double dt, double damping);
  /// Velocities that a set of held vertices is asked for in that step [listed][D].
  std::vector<double> asked(std::size_t set, double t, double dt);
  /// Held vertices move as they are asked to.
  void move(double t, double dt);

  Vec3 reaction(int hold) const { return reaction_.at(hold); }  // [N]
  double torque(int hold) const { return torque_.at(hold); }    // about the hold's axis [N m]

 private:
  static kernels::HoldTarget<D, Real> target(model::HoldSet<D, Real> const& set, double t, double dt);

  Device& device_;
  scene::Scene const& scene_;
  model::Model<D, Real>& model_;
  Ledger& ledger_;
  std::vector<Vec3> reaction_;  // by hold [N]
  std::vector<double> torque_;  // [N m]
};

}  // namespace fissure
