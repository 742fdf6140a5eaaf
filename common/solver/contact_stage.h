// Everything that touches: pairs of elements, plates, walls, and the faces of broken joints until they have come apart.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kernels/contact.h"
#include "kernels/contact_sums.h"
#include "kernels/crack_faces.h"
#include "model/model.h"
#include "solver/bonds.h"
#include "solver/broad_phase.h"
#include "solver/broken_joint.h"
#include "solver/force_slots.h"
#include "solver/rigid_bodies.h"
#include "solver/simulation.h"
#include "solver/spring_bed.h"
#include "solver/state.h"

namespace fissure {

/// What the corners of a broken joint's face bring along.
template <int D, class Real>
struct CrackPoints {
  Real stiffness = 0;                // [Pa/m]
  std::array<Real, D> area, offset;  // [m^2]; of an insertion under pressure [m]
  std::array<laws::JointHistory<Real>, D> history;
  std::array<Vec<Real, D>, D> stretch;  // of friction springs [m]
};

/// Energies of contact [J], totals since the start.
struct ContactWork {
  double on_vertices = 0;  // work of contact forces on vertices
  double by_plates = 0;    // work of plates on bodies
  double friction = 0;     // taken by sliders
  // held without work: by overlaps at the start, by broken joints when they became crack faces
  double given = 0;
  double began_with = 0;  // held by the pressure that joints were inserted under, which no work was done for
  /// What contacts hold now, less what they began with.
  double stored() const { return given + by_plates - on_vertices - friction; }
};

template <int D, class Real>
class ContactStage {
 public:
  static constexpr int C = D + 1;

  ContactStage(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh, model::Model<D, Real>& model);

  /// Adds contact forces to vertices at time t; `dt` is the step that led here (0 at the start), `next` the one
  /// that would follow without new contacts.
  void add_forces(double t, double dt, double next);
  ContactCounts counts() const;
  /// Books what overlaps hold at the start, after the first forces.
  void begin();
  /// Work of a share (of half, but in the first step) of a step of dt, with the velocities after it; then plates move.
  void finish_step(double t, double dt, double share);
  /// A joint that broke in this step; its elements have already used its traction. Returns the share of mode III in its
  /// slip.
  double add_broken(model::BreakingView<Real> const& now, BrokenJoint const& joint, CrackPoints<D, Real> const& points,
                    laws::AnyJoint const& law);

  /// The joint on a face has begun to soften.
  void loosen(FaceId face);

  /// What touches or may touch before the list of candidates changes, and by how much the stiffest touched vertex is
  /// stiffer than that, over its mass [1/s^2].
  SpringBeds<D> const& beds() const { return beds_; }
  double excess() const { return excess_; }
  double largest_penetration() const { return deepest_; }  // largest potential seen so far
  ContactWork const& work() const { return work_; }
  RigidBodies<D, Real> const& rigid() const { return rigid_; }
  Bonds<D, Real> const& bonds() const { return bonds_; }

  long candidates() const {
    return static_cast<long>(pairs_.size() + plate_candidates_.size() + wall_candidates_.size());
  }
  long rebuilds() const { return rebuilds_; }
  long active_elements() const { return static_cast<long>(active_.size()); }

  void save(State& state) const;
  void restore(State const& state);

  /// Test hook: every element may touch, not only those with a corner at a bare face.
  void activate_everything() {
    bonds_.expose_everything();
    stale_ = true;
  }

 private:
  /// One kind of candidate: its arrays, and where its slots begin.
  struct Candidates {
    Index count = 0, first_slot = 0;
    Buffer<Index> list;
    Buffer<Real> spring, reaction, work, penetration, held;
    Buffer<double> wake;
    Buffer<std::uint8_t> axis;
  };

  kernels::ContactTable table(Buffer<laws::ContactLaw> const& between) const;
  void press_pairs(double dt);
  template <class Body>
  void press_on(Candidates& kind, Body const* body, Buffer<laws::ContactLaw> const& between, double dt);
  void press_cracks(double dt);
  void book(double t, double dt);
  bool list_is_stale(double t, double dt, double next);
  void rebuild(bool everything);
  void extend_drift(std::vector<Index> const& vertices, std::span<Real const> u);
  void place_slots();
  void group_slots();
  void place_groups();
  bool may_touch(Index a, Index b) const;
  /// The two cells that a crack lies between, the lower first.
  std::pair<Index, Index> cells_of(kernels::CrackFace<D, Real> const& crack) const {
    return std::minmax(model_.cell_head(crack.element), model_.cell_head(crack.other));
  }
  void release_cracks();
  void place_beds();
  void expect();
  void prepare(Candidates& kind, std::vector<solver::ElementPair> const& pairs, std::vector<Real> const& springs,
               bool rigid);

  Device& device_;
  scene::Scene const& scene_;
  model::Model<D, Real>& model_;
  static constexpr double steps_per_list = 400, least_buffer = 0.05;  // [steps]; share of `reach_`
  double reach_ = 0, buffer_ = 0;                                     // largest buffer; that of the list [m]
  Bonds<D, Real> bonds_;
  RigidBodies<D, Real> rigid_;
  std::vector<Index> active_;  // elements that may touch, ascending
  // of elements; (element, plate); (element, wall)
  std::vector<solver::ElementPair> pairs_, plate_candidates_, wall_candidates_;
  Candidates pair_, plate_, wall_;
  std::vector<kernels::CrackFace<D, Real>> new_cracks_;
  Buffer<kernels::CrackFace<D, Real>> cracks_;
  Buffer<Real> crack_work_;
  Index crack_slot_ = 0;
  ForceSlots<D, Real> slots_;
  SpringBeds<D> beds_;
  bool rubs_ = false;                 // pairs have friction
  std::vector<Index> group_of_slot_;  // of pairs: the corner's node, and the piece that touches it
  Buffer<Index> group_, group_first_, group_slot_;
  Buffer<Real> group_force_, pair_weight_;
  Buffer<Index> drifting_;
  Buffer<Real> drift_start_;
  std::vector<Real> u_copy_;                 // displacements, where the host cannot read them
  std::vector<Vec3> displacement_at_build_;  // of plates
  Buffer<kernels::ContactTable::Number> law_;
  Buffer<laws::ContactLaw> between_, plate_between_, wall_between_;
  Buffer<int> news_;
  std::vector<std::pair<Index, Index>> facing_;  // cells on both sides of cracks that still press as joints
  bool stale_ = true;                            // an element has changed
  bool slots_are_stale_ = false;                 // candidates or cracks have changed
  long rebuilds_ = 0, since_build_ = 0, since_extension_ = 0;
  std::array<double, D> middle_drift_{};  // since the list was built [m]
  // most that anything will move relative to anything in the next step [m]
  double ahead_ = 0;
  // longest way of anything relative to anything since the build [m]
  double path_ = 0;
  double excess_ = 0, deepest_ = 0;
  ContactWork work_;
};

}  // namespace fissure
