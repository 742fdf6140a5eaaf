// The explicit solver: the step as a list of stages (architecture: one step).
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "contact/contact_stage.h"
#include "kernels/advance.h"
#include "model/model.h"
#include "solver/absorb_stage.h"
#include "solver/element_launch.h"
#include "solver/fracture_stage.h"
#include "solver/frames.h"
#include "solver/insertion_stage.h"
#include "solver/ledger.h"
#include "solver/load_stage.h"
#include "solver/motion_stage.h"
#include "solver/probe.h"
#include "solver/removal_stage.h"
#include "solver/rigid_stage.h"
#include "solver/shown.h"
#include "solver/simulation.h"
#include "solver/spring_stage.h"
#include "solver/step_limit.h"
#include "solver/tie_stage.h"

namespace fissure {

template <int D, class Real>
class Solver : public Simulation {
 public:
  using Model = model::Model<D, Real>;
  static constexpr int C = D + 1;

  Solver(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh);

  void evaluate() override;
  void advance() override;
  void step_back() override;
  void end_at(double time) override { end_ = time; }
  double settling_time() const override;
  bool settle(std::function<bool()> const& goes_on) override;

  double time() const override { return time_; }
  long step() const override { return step_ - settled_; }
  scene::Now const& now() const override { return probe_; }

  StepLimit const& step_limit() const override { return stable_step_.limit(); }
  double mass_scaled_share() const override { return scene_.run.mass_scaling - 1; }
  model::Plan const& plan() const override { return model_.plan; }
  Device& device() override { return device_; }
  long element_count() const override { return static_cast<long>(shown_.cells.size()); }
  std::vector<std::string> const& warnings() const override { return model_.warnings; }
  ContactCounts contact_counts() const override { return contact_.counts(); }
  double largest_penetration() const override { return contact_.largest_penetration(); }
  std::vector<Softened> softened() const override { return fracture_.softened(shown_.cells); }

  output::Topology topology() const override { return frames_.topology(); }
  output::Frame frame(std::vector<std::string> const& fields) const override { return frames_.frame(fields); }
  State save() const override;
  void restore(State const& state) override;

  scene::Scene const& scene() const { return scene_; }
  Shown const& shown() const { return shown_; }
  Model& model() { return model_; }
  Model const& model() const { return model_; }
  ContactStage<D, Real>& contact() { return contact_; }
  FractureStage<D, Real> const& fracture() const { return fracture_; }
  MotionStage<D, Real> const& motion() const { return motion_; }
  RemovalStage<D, Real> const& removal() const { return removal_; }
  SpringStage<D, Real> const& springs() const { return springs_; }
  StableStep<D, Real>& stable_step() { return stable_step_; }
  TieStage<D, Real> const& ties() const { return ties_; }
  double dt() const { return stable_step_.limit().dt; }
  /// At this moment, booked once per step however often they are asked for.
  Ledger const& energies();
  /// Cauchy stress of all elements [element][6] now [Pa].
  std::vector<double> stresses();

 private:
  typename StableStep<D, Real>::Moment moment() const {
    return {step_, time_, end_, contact_.beds(), contact_.excess(), !fracture_.broken().empty()};
  }
  void add_bulk_forces();
  double mass_damping() const { return time_ < 0 ? calming_ : scene_.run.mass_damping; }
  void book();
  bool begins_pushed() const;  // by a stress at the start, or by springs
  double half_pushed(std::vector<Real> const& internal);
  void check_elements(int fault);
  void refuse_flow();
  void warn_of_yield();
  kernels::VertexView<D, Real> vertices();
  /// f(name, buffer) for every array of the model that a checkpoint keeps.
  template <class AnyModel, class F>
  static void for_each_stored(AnyModel& model, F&& f);

  Device& device_;
  scene::Scene const& scene_;
  Model model_;
  Shown shown_;
  Ledger ledger_;
  ContactStage<D, Real> contact_;
  FractureStage<D, Real> fracture_;
  InsertionStage<D, Real> insertion_;
  LoadStage<D, Real> loads_;
  AbsorbStage<D, Real> absorb_;
  MotionStage<D, Real> motion_;
  RigidStage<D, Real> rigid_;
  SpringStage<D, Real> springs_;
  TieStage<D, Real> ties_;
  RemovalStage<D, Real> removal_;
  StableStep<D, Real> stable_step_;
  Probe<D, Real> probe_;
  Frames<D, Real> frames_;
  double time_ = 0, last_dt_ = 0;  // [s]; the step that led here, 0 at the start
  double end_;                     // no step goes past it [s]
  long step_ = 0, booked_step_ = -1;
  long settled_ = 0;                  // steps before the start
  double calming_ = 0;                // mass damping while bodies settle [1/s]
  bool begins_ = false;               // they have settled, and the ledger counts from here
  std::array<int, 2> told_ = {0, 0};  // by joints of elements and of blocks, in this step
  bool started_ = false;
  double start_gives_ = 0;      // in the first step, as half_pushed() [J]
  double weight_held_ = 0;      // by displacements at the start, from which gravity does not count [J]
  bool patches_stale_ = false;  // joints broke about patches of averaged pressure
};

}  // namespace fissure
