// The explicit solver: bulk, joints, contact, loads, advance (architecture: one step).
#pragma once
#include <vector>

#include "kernels/advance.h"
#include "model/model.h"
#include "solver/contact_stage.h"
#include "solver/element_launch.h"
#include "solver/insertion_stage.h"
#include "solver/simulation.h"
#include "solver/step_limit.h"

namespace fissure {

namespace solver {
/// What hangs together by faces.
struct Pieces {
  std::vector<Index> of_element;      // [element] its piece in the list; -1: none
  std::vector<scene::Fragment> list;  // heaviest first
};
}  // namespace solver

/// Energies [J] at the time of the last evaluate(); work terms are totals since the start.
struct Ledger {
  double kinetic = 0, elastic = 0, hourglass = 0, plastic = 0, joint = 0, fracture = 0, viscous = 0, mass_damping = 0,
         contact = 0, friction = 0, gravity = 0;
  double external = 0;  // work of loads and prescribed motion
  double plates = 0;    // work of plates
  double start = 0;     // kinetic + elastic + hourglass + joint + contact + gravity at t = 0

  /// What came in minus what is there and what was taken: 0 but for errors of the method.
  double residual() const {
    return start + external + plates - (kinetic + elastic + hourglass + joint + gravity + contact) -
           (plastic + fracture + viscous + mass_damping + friction);
  }
};

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

  // What may be asked (scene::Now).
  double time() const override { return time_; }
  long step() const override { return step_; }
  Vec3 plate_force(int plate) const override;
  Vec3 plate_displacement(int plate) const override;
  Vec3 wall_force(int wall) const override;
  double energy(std::string const& name) const override;
  Vec3 displacement(int body, Vec3 const& point) const override;
  Vec3 velocity(int body, Vec3 const& point) const override;
  std::array<double, 6> stress(int body, Vec3 const& point) const override;
  Vec3 mean_velocity(int body) const override;
  Vec3 reaction(int hold) const override;
  double crack_area() const override;
  double crack_energy() const override;
  long broken_joints() const override;
  std::vector<scene::Fragment> fragments(int body) const override;
  ContactCounts contact_counts() const override { return contact_.counts(); }
  double field(std::string const& field, int body, Vec3 const& point) const override;
  std::array<Vec3, 2> bounds(int body) const override;
  double extreme(std::string const& field) const override;
  std::optional<double> latest(std::string const& measure) const override;
  std::optional<double> peak(std::string const& measure) const override;
  std::optional<double> peak_time(std::string const& measure) const override;

  StepLimit const& step_limit() const override { return stable_step_.limit(); }
  /// Gravity over the mass that moves [m/s^2]: mass that scaling adds weighs nothing.
  double weight_per_mass(int c) const { return scene_.gravity[c] / scene_.run.mass_scaling; }
  double mass_scaled_share() const override { return scene_.run.mass_scaling - 1; }
  model::Plan const& plan() const override { return model_.plan; }
  Device& device() override { return device_; }
  long element_count() const override { return static_cast<long>(cells_shown_.size()); }
  std::vector<std::string> const& warnings() const override { return model_.warnings; }
  double largest_penetration() const override { return contact_.largest_penetration(); }
  std::vector<bool> softened() const override;

  output::Topology topology() const override;
  output::Frame frame(std::vector<std::string> const& fields) const override;
  State save() const override;
  void restore(State const& state) override;

  StableStep<D, Real>& stable_step() { return stable_step_; }
  Model& model() { return model_; }
  ContactStage<D, Real>& contact() { return contact_; }
  Ledger const& ledger() const { return ledger_; }
  double dt() const { return stable_step_.limit().dt; }

 private:
  solver::Pieces pieces(int body) const;  // of a body alone, -1: of all
  typename StableStep<D, Real>::Moment moment() const {
    return {step_, time_, end_, contact_.beds(), contact_.excess(), !contact_.broken().empty()};
  }
  void add_loads();
  void stay_on_axis();
  void hold_before();
  void hold_after();
  void book();
  void follow_joints();
  void check_elements();
  void refuse_flow();
  laws::FlowPoint<double, true> flow_point(std::vector<Real> const& memory, Index e) const;
  Index nearest_element(int body, Vec3 const& point) const;
  std::array<double, D> load_value(model::LoadSet<D, Real> const& set, double t) const;
  kernels::VertexView<D, Real> vertices();
  Index nearest_corner(int body, Vec3 const& point) const;
  void refuse_outside(int body, Vec3 const& point, double distance) const;
  std::vector<double> element_stresses() const;
  void refresh_ledger();
  void number_shown();
  Index shown_vertex(Index vertex) const { return shown_number_[vertex]; }
  void add_cracks(std::vector<Real> const& u, output::Cracks& cracks) const;
  std::vector<double> rigid_corners() const;
  template <class F>
  void for_each_stored(F&& f);

  Device& device_;
  scene::Scene const& scene_;
  mesh::Mesh const& mesh_;
  Model model_;
  ContactStage<D, Real> contact_;
  StableStep<D, Real> stable_step_;
  InsertionStage<D, Real> insertion_;
  Ledger ledger_;
  double time_ = 0;
  std::vector<int> notices_ = {0, 0, 0};  // the model's flags after the elements' forces
  double last_dt_ = 0;                    // of the step that led here; 0 at the start [s]
  long step_ = 0;
  bool started_ = false;
  bool patches_stale_ = false;       // joints broke about patches of averaged pressure
  double end_ = scene_.run.time;     // no step goes past it [s]
  std::vector<Vec3> hold_reaction_;  // by hold [N]
  std::array<double, D> momentum_{};
  long booked_step_ = -1;
  // heads of the cells that output shows, body by body; and each head's place among them
  std::vector<Index> cells_shown_, number_of_cell_;
  std::vector<Index> shown_, shown_number_;  // vertices that output shows, and each vertex's place among them
  // corner nearest to a point that was asked for
  mutable std::map<std::pair<int, std::array<double, 3>>, Index> nearest_;
};

}  // namespace fissure
