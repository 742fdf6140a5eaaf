// Loads as a stage of the step: tractions, pressures and forces.
#pragma once
#include <array>

#include "model/model.h"
#include "solver/ledger.h"

namespace fissure {

template <int D, class Real>
class LoadStage {
 public:
  LoadStage(Device& device, model::Model<D, Real>& model, Ledger& ledger)
      : device_(device), model_(model), ledger_(ledger) {}

  /// Adds forces at time t [s], and books their work over the second half of the step that led here.
  void add_forces(double t, double last_dt);
  /// Books their work over `share` of the step of dt that begins at t, with the velocities after it.
  void finish_step(double t, double dt, double share);

 private:
  static std::array<double, D> value(model::LoadSet<D, Real> const& set, double t);
  double work(model::LoadSet<D, Real> const& set, std::array<double, D> const& value, double share_of_dt);

  Device& device_;
  model::Model<D, Real>& model_;
  Ledger& ledger_;
};

}  // namespace fissure
