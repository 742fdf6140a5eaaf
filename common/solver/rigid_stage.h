// Bodies that do not deform, as a stage of the step: central differences for their centres and their rotations.
#pragma once
#include <array>
#include <vector>

#include "kernels/advance.h"
#include "model/model.h"
#include "model/state.h"

namespace fissure {

/// Those that are free in some direction; what holds move altogether is no concern of this stage.
template <int D, class Real>
class RigidStage {
 public:
  RigidStage(Device& device, scene::Scene const& scene, model::Model<D, Real>& model);

  /// After all forces but the reactions of holds: every vertex gets the force that takes it along with its body.
  void react(kernels::VertexView<D, Real> const& vertices, long step);
  /// Bodies go on with the momentum that their vertices' velocities now have.
  void take_velocities();
  /// All vertices move with their bodies.
  void move();

  void save(State& state) const;
  void restore(State const& state);

 private:
  /// All it needs to go on; a direction that two dimensions do not have stays 0.
  struct Motion {
    Vec3 moved = Vec3::Zero();     // of the centre of mass [m]
    Vec3 velocity = Vec3::Zero();  // over the step that led here [m/s]
    Vec3 momentum = Vec3::Zero();  // angular, over that step, about the centre of mass [kg m^2/s]
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    Mat<double, 3> spin = Mat<double, 3>::Zero();  // (R - R before) / dt [1/s]
  };
  using Body = model::RigidBody<D, Real>;
  Motion with_velocities(Body const& body, Motion motion) const;
  Motion stepped(Body& body, Motion const& from, kernels::VertexView<D, Real> const& vertices, long step);
  bool here(Body const& body) const { return !model_.removed(body.first_element); }

  Device& device_;
  scene::Scene const& scene_;
  model::Model<D, Real>& model_;
  std::vector<Motion> now_, next_;
};

}  // namespace fissure
