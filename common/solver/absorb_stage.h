// Absorbing boundaries as a stage of the step: what they take is work of the outside, and negative.
#pragma once
#include "kernels/advance.h"
#include "model/model.h"
#include "solver/ledger.h"

namespace fissure {

template <int D, class Real>
class AbsorbStage {
 public:
  AbsorbStage(Device& device, model::Model<D, Real>& model, Ledger& ledger)
      : device_(device), model_(model), ledger_(ledger) {}

  /// After all forces but the reactions of holds, which it needs to know what follows from them.
  void add_forces(kernels::VertexView<D, Real> const& vertices);
  /// Books the other half of their work, with the velocities after the step.
  void finish_step();

 private:
  Device& device_;
  model::Model<D, Real>& model_;
  Ledger& ledger_;
};

}  // namespace fissure
