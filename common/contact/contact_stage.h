// Everything that touches: pairs of elements, plates, walls, and the faces of broken joints until they have come apart.
#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "contact/bonds.h"
#include "contact/broad_phase.h"
#include "contact/broken_joint.h"
#include "contact/candidates.h"
#include "contact/contact_laws.h"
#include "contact/counts.h"
#include "contact/force_slots.h"
#include "contact/groups.h"
#include "contact/list_age.h"
#include "contact/near_pairs.h"
#include "contact/pressing_pairs.h"
#include "contact/rigid_bodies.h"
#include "contact/skin.h"
#include "contact/spring_bed.h"
#include "kernels/contact_sums.h"
#include "kernels/crack_faces.h"
#include "kernels/rigid_contact.h"
#include "model/model.h"
#include "model/state.h"

namespace fissure {

/// What the corners of a broken joint's face bring along.
template <int D, class Real>
struct CrackPoints {
  Real stiffness = 0;                // [Pa/m]
  std::array<Real, D> area, offset;  // [m^2]; of an insertion under pressure [m]
  std::array<std::array<Real, laws::joint_numbers>, D> history;
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
class PressedFaces;

template <int D, class Real>
class ContactStage {
 public:
  static constexpr int C = D + 1;

  ContactStage(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh, model::Model<D, Real>& model);

  /// Adds contact forces to vertices at time t; `last_dt` is the step that led here (0 at the start), `dt` the one that
  /// would follow without new contacts.
  void add_forces(double t, double last_dt, double dt);
  ContactCounts counts() const;
  /// What contacts with another body push and rub a body with, as added last; 2D: times thickness [N].
  Vec3 force_between(int body, int other) const;
  scene::Touch touch(int body, int other) const;
  /// Books what overlaps hold at the start, after the first forces.
  void begin();
  /// Work of a share (of half, but in the first step) of a step of dt, with the velocities after it; then plates move.
  void finish_step(double t, double dt, double share);
  /// After all forces: plates with a servo get their next velocity, where its time has come.
  void serve(double t, scene::Now const& now) { rigid_.serve(t, now); }
  /// A joint that broke in this step; its elements have already used its traction. Returns the share of mode III in its
  /// slip.
  double add_broken(model::BreakingView<Real> const& now, BrokenJoint const& joint, CrackPoints<D, Real> const& points,
                    laws::AnyJoint const& law);

  /// Elements, ascending, leave the run after this step, and their contacts end with the next; returns what these hold,
  /// which is taken from what contact has stored [J].
  double let_go(std::vector<Index> const& leaving);

  /// The joint on a face holds no neighbourhood together any more.
  void loosen(FaceId face);

  /// What touches or may touch before the list of candidates changes, and by how much the stiffest touched vertex is
  /// stiffer than that, over its mass [1/s^2].
  SpringBeds<D> const& beds() const { return beds_; }
  double excess() const { return excess_ + light_plate_; }
  double largest_penetration() const { return deepest_; }  // largest potential seen so far
  ContactWork const& work() const { return work_; }
  RigidBodies<D, Real> const& rigid() const { return rigid_; }
  Bonds<D, Real> const& bonds() const { return bonds_; }

  long candidates() const { return static_cast<long>(near_.all().size()) + plate_.count + wall_.count; }
  long rebuilds() const { return age_.lists(); }
  long active_elements() const { return static_cast<long>(active_.size()); }

  void save(State& state) const;
  void restore(State const& state);

  /// Test hook: every element may touch, not only those with a corner at a bare face.
  void activate_everything() {
    bonds_.expose_everything();
    stale_ = true;
  }

 private:
  using Bounds = std::vector<contact::Bounds<D>>;

  Sums<2> count_pairs() const;
  void press_pairs(double last_dt);
  template <class Body>
  void press_on(Candidates<D, Real>& kind, Body const* body, kernels::ContactTable const& table, double last_dt);
  void press_cracks(double last_dt);
  template <class Visit>
  void between(int body, int other, Visit&& visit) const;
  void book(double t, double last_dt);
  void make_list(bool everything);
  void watch(double window);
  /// Of the list's buffer: a longer one means more pairs, a shorter one more choosing [m].
  double watch_window() const { return 0.1 * age_.buffer(); }
  double let_go(Candidates<D, Real>& kind, std::vector<Index> const& leaving, std::vector<Index>& slots);
  double held_by(kernels::CrackFace<D, Real> const& crack, std::vector<Real> const& u) const;
  void drop_removed();
  double held_by(contact::ElementPair const& pair, double begins, std::vector<Real> const& u,
                 std::vector<laws::ContactLaw> const& between) const;
  kernels::Simplex<D, double> placed(Index e, std::span<Real const> u) const;
  Bounds bounds_of_active(std::span<Real const> u, double buffer) const;
  std::vector<contact::ElementPair> near_pairs(Bounds const& bounds, std::span<Real const> u, double buffer,
                                               bool everything);
  std::vector<contact::ElementPair> near_plates(Bounds const& bounds, double buffer) const;
  std::vector<contact::ElementPair> near_walls(Bounds const& bounds, double buffer) const;
  std::vector<contact::ElementPair> of_active(std::vector<contact::ElementPair> found) const;
  std::vector<kernels::CrackFace<D, Real>> join_cracks();
  void place_slots();
  void place_cracks();
  void list_slots();
  void list_pressing();
  bool may_touch(Index a, Index b) const;
  /// The two cells that a crack lies between, the lower first.
  std::pair<Index, Index> cells_of(kernels::CrackFace<D, Real> const& crack) const {
    return std::minmax(model_.cell_head(crack.element), model_.cell_head(crack.other));
  }
  void release_cracks();
  void place_beds();
  void add_beds(PressedFaces<D, Real>& faces, std::vector<kernels::CrackFace<D, Real>> const& cracks);
  void add_beds(std::vector<kernels::CrackFace<D, Real>> const& cracks);
  void tell_room();
  void warn_of_light(scene::Plate const& plate);

  Device& device_;
  scene::Scene const& scene_;
  model::Model<D, Real>& model_;
  Bonds<D, Real> bonds_;
  RigidBodies<D, Real> rigid_;
  ContactLaws laws_;
  ListAge<D, Real> age_;
  std::vector<Index> active_;  // elements that may touch, ascending
  NearPairs<D, Real> near_;
  Candidates<D, Real> pair_{false}, plate_{true}, wall_{true};  // pairs: those that are watched
  PressingPairs<D, Real> pressing_;
  ContactGroups<D, Real> groups_;  // of these; empty without friction
  ForceSlots<D, Real> slots_;
  SpringBeds<D> beds_;
  std::vector<double> pressed_rows_;   // nothing but zeros between uses, as
  std::vector<Index> place_of_faces_;  // nothing but -1: whole arrays are long to clear
  std::vector<kernels::CrackFace<D, Real>> new_cracks_;
  Buffer<kernels::CrackFace<D, Real>> cracks_;
  Buffer<Real> crack_work_;
  Buffer<int> news_;  // faces have come apart
  Index crack_slot_ = 0;
  std::vector<std::pair<Index, Index>> facing_;  // cells on both sides of cracks that still press as joints
  std::vector<Real> u_copy_;                     // displacements, where the host cannot read them
  bool stale_ = true;                            // an element has changed
  bool slots_are_stale_ = false;                 // candidates have changed, or cracks have gone
  bool lists_are_stale_ = false;                 // slots have, or another pair presses
  bool beds_are_stale_ = false;                  // the list has changed, or cracks have gone
  bool some_left_ = false;                       // candidates or cracks have cells that were removed
  double excess_ = 0, deepest_ = 0;
  double light_plate_ = 0;  // stiffness of all that a plate may touch over its mass, where a force drives it [1/s^2]
  double last_dt_ = 0;      // that led to the forces [s]
  bool warned_of_light_ = false;
  long looked_at_ = 0;  // pairs in the last step
  ContactWork work_;
  mutable std::map<int, Skin<D, Real>> skins_;  // by body, where somebody asked
};

}  // namespace fissure
