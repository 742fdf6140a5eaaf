// Springs between points, as a stage of the step: bolts, anchors, ropes.
#pragma once
#include <vector>

#include "model/model.h"
#include "model/state.h"
#include "solver/ledger.h"

namespace fissure {

/// Few: the host reckons them, end by end.
template <int D, class Real>
class SpringStage {
 public:
  SpringStage(Device& device, scene::Scene const& scene, model::Model<D, Real>& model, Ledger& ledger);

  /// Adds their forces at time t; books dampers over the second half of the step that led here, and what breaks.
  void add_forces(double t, double last_dt);
  /// Books dampers over `share` of the step of dt that begins, with the velocities after it.
  void finish_step(double dt, double share);

  /// What it pulls its ends together with now; below 0 it pushes them apart [N].
  double pull(int spring) const { return now_.at(spring).pull; }
  double stored() const;  // [J]
  bool broken(int spring) const { return broken_.at(spring) != 0; }
  Vec3 end(int spring, int which) const;  // where it is now [m]

  void save(State& state) const { state["springs"] = state_bytes(broken_); }
  void restore(State const& state) { broken_ = state_values<char>(state, "springs", broken_.size()); }

 private:
  using Set = model::SpringSet<D, Real>;
  struct Now {
    double pull = 0, drag = 0, held = 0;  // with its damper, of that alone [N]; energy [J]
    Vec<double, D> along = Vec<double, D>::Zero();
  };
  Vec<double, D> mean(Set const& set, int which, Buffer<Real> const& of) const;
  Vec<double, D> between(Set const& set) const;
  double rate(Set const& set, Vec<double, D> const& along) const;  // of its length [m/s]
  bool adrift(Set const& set) const;

  scene::Scene const& scene_;
  model::Model<D, Real>& model_;
  Ledger& ledger_;
  std::vector<double> length_;  // without force [m]
  std::vector<char> broken_;
  std::vector<Now> now_;
};

}  // namespace fissure
