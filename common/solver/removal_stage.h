// What leaves the run, as a stage of the step: lone cells that are pressed flat, where the scene asks for that, and
// what is excavated.
#pragma once
#include <vector>

#include "contact/contact_stage.h"
#include "kernels/advance.h"
#include "model/model.h"
#include "model/state.h"
#include "solver/insertion_stage.h"
#include "solver/ledger.h"

namespace fissure {

/// A cell that has left, and where.
struct RemovedCell {
  Index element = 0;
  double mass = 0;       // [kg], with its scaling
  double place[3] = {};  // of its middle, from the model's origin [m]
};

/// The last resort against a piece that is crushed between others faster than its law resists: it takes its mass and
/// all the energy that it held out of the run. Only simplices that nothing holds any more, and no hold moves.
template <int D, class Real>
class RemovalStage {
 public:
  RemovalStage(Device& device, scene::Scene const& scene, model::Model<D, Real>& model, ContactStage<D, Real>& contact,
               InsertionStage<D, Real> const& insertion, Ledger& ledger);

  /// Finds crushed cells that may leave, after the bulk's forces; `u` as it is, `last_dt` led here.
  void look(std::vector<Real> const& u, double last_dt);
  /// After all forces: what the scene excavates at this time leaves, and the ledger books what it held. Not at the
  /// start, which the ledger counts from.
  void excavate(kernels::VertexView<D, Real> const& vertices, double t, double dt);
  /// It leaves in this step.
  bool leaves(Index e) const { return std::find(leaving_.begin(), leaving_.end(), e) != leaving_.end(); }
  /// After all forces: what was found leaves, as padding that moves no more, and the ledger books what it held.
  void remove(kernels::VertexView<D, Real> const& vertices, double last_dt, double dt);

  bool excavated(Index e) const;  // it has been
  std::vector<RemovedCell> const& removed() const { return removed_; }
  double mass() const;  // of all that has left [kg]
  /// Displacements as they are drawn: what has left is a point.
  void draw(std::vector<Real>& u) const;

  void save(State& state) const;
  void restore(State const& state);

 private:
  /// Elements of an excavation that is to come, or has been.
  struct Excavated {
    double time = 0;  // [s]
    std::vector<Index> elements;
    bool done = false;
  };
  std::vector<Index> excavated_by(scene::Excavation const& excavation) const;
  bool held(Index vertex) const;
  void end_holds(std::vector<Index> const& corners);
  std::vector<Index> corners_of(std::vector<Index> const& elements) const;
  void cut(Index e);
  void leave(Index e);
  void draw_excavated(std::vector<Real>& u) const;
  bool may_leave(Index e) const;
  double kinetic_and_weight(kernels::VertexView<D, Real> const& vertices) const;
  double take_out(kernels::VertexView<D, Real> const& vertices, std::vector<Index> const& elements, double dt);
  void still(std::vector<Index> const& of);
  void forget_flow(Index e);
  double stored(double dt);

  Device& device_;
  scene::Scene const& scene_;
  model::Model<D, Real>& model_;
  ContactStage<D, Real>& contact_;
  InsertionStage<D, Real> const& insertion_;
  Ledger& ledger_;
  std::vector<Index> leaving_;
  mutable std::vector<char> held_;  // by vertex: a hold moves it; empty: nobody has asked
  std::vector<RemovedCell> removed_;
  std::vector<Excavated> excavations_;
};

}  // namespace fissure
