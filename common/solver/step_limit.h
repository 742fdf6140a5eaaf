// The stable time step of the explicit scheme, at rest and as bodies change: the whole story
// (docs/theory/time_step.md).
//   bound     omega^2 <= max over vertices of  sum_e(lambda_e m_ea)/m_a + 2 sum_joints(k A/d)/m_a,
//             lambda_e = E' V sum_a |grad N_a|^2/m_ea: rigorous for any lumped mass while moduli are those at rest.
//   measured  the top eigenvalue of M^-1 K, K the tangent of the force kernels themselves at this moment (Lanczos);
//             likewise of viscosity.
//   watched   what the tangent depends on: shape now and stretch. It is measured again when they have changed.
//   contact   what may press counts as beds of springs below the faces, measured with the rest; what has come since by
//             its bound.
// With damping c = 2 mu/E' omega_b^2 + alpha:  dt = safety (sqrt(c^2 + 4 omega^2) - c)/omega^2.
#pragma once
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "contact/spring_bed.h"
#include "model/model.h"
#include "model/state.h"
#include "solver/element_launch.h"
#include "solver/simulation.h"

namespace fissure {

/// Said where a number was lost in single precision.
inline constexpr char const* advice_for_single =
    "numbers of this size may leave the range of single precision: take --precision double";

/// Squared frequencies [1/s^2] of the stiffest vertex and what they belong to.
struct FrequencyBound {
  double total = 0;      // largest sum of bulk and joints at one vertex
  double viscosity = 0;  // top eigenvalue of its matrix over the mass [1/s]
  std::string owner;
  std::vector<double> of_vertex;  // the sums
};

/// Largest stable step [s] for the squared frequency and damping eigenvalue given, without safety.
inline double stable_step(double omega_squared, double damping) {
  return (std::sqrt(damping * damping + 4 * omega_squared) - damping) / omega_squared;
}

template <int D, class Real>
class StableStep {
 public:
  using Model = model::Model<D, Real>;
  static constexpr int C = D + 1;

  /// What the rest of the solver knows of the moment that a step begins at.
  struct Moment {
    long step = 0;
    double time = 0, end = 0;  // [s]; no step goes past the end
    SpringBeds<D> const& contact;
    double excess = 0;     // largest squared frequency that touched vertices have beyond that [1/s^2]
    bool cracked = false;  // there are fragments
  };

  /// `number_of_cell`: what messages call the cell of a head.
  StableStep(Device& device, scene::Scene const& scene, Model& model, std::vector<Index> const& number_of_cell);

  void start(Moment const& now);         // the first step, of bodies at rest
  void follow(Moment const& now);        // looks, where a look is due, whether bodies have changed
  void heed_contact(Moment const& now);  // contact is more than what the step has room for: it shrinks at once
  void choose(Moment const& now);        // the user's own or the automatic one; the last ends when the run does

  StepLimit const& limit() const { return limit_; }
  double mass_damping() const;  // the largest of a run [1/s]

  /// Top eigenvalue of M^-1 K [1/s^2] of bulk and joints at this moment, by the force kernels, and beds: a Ritz value
  /// plus its residual, which ends the iteration when it is less than `tolerance` of the value.
  double top_eigenvalue(SpringBeds<D> const& beds = {}, int most_iterations = 80, double tolerance = 0.01);
  /// The same of viscosity [1/s].
  double top_viscosity(int most_iterations = 80, double tolerance = 0.01);

  void save(State& state) const;
  void restore(State const& state);

 private:
  /// What save and restore keep.
  template <class Step>
  static auto numbers_of(Step& s) {
    return std::array{&s.limit_.dt,
                      &s.limit_.automatic,
                      &s.limit_.stable,
                      &s.limit_.bound,
                      &s.bound_.total,
                      &s.bound_.viscosity,
                      &s.share_,
                      &s.body_share_,
                      &s.viscous_share_,
                      &s.measured_at_.gradients,
                      &s.measured_at_.frequency,
                      &s.measured_at_.stretch,
                      &s.measured_at_.squeeze,
                      &s.room_,
                      &s.excess_,
                      &s.bounce_,
                      &s.alone_,
                      &s.before_,
                      &s.first_,
                      &s.lost_,
                      &s.cost_};
  }
  struct OfSprings {
    double total = 0, damping = 0;  // squared frequency [1/s^2]; eigenvalue of damping [1/s]
  };
  OfSprings of_springs() const;
  FrequencyBound frequency_bound() const;
  std::vector<double> joint_rows() const;
  std::string owner(FrequencyBound const& bound, Index e, bool joints) const;
  std::span<Real const> vertex_forces(ElementRun const& run);
  std::span<Real const> summed_forces();
  template <class Apply>
  double lanczos(Apply&& apply, int most_iterations, double tolerance);
  void look_again(Moment const& now, double rate);
  bool touched_anew(Moment const& now, bool regular) const;
  void measure(Moment const& now, bool bodies = true);
  std::vector<double> know(SpringBeds<D> const& beds, std::size_t joined = 0);
  double squared_frequency() const;
  double room_for(std::vector<double> const& rows) const;
  void set(Moment const& now);

  Device& device_;
  scene::Scene const& scene_;
  Model& model_;
  std::vector<Index> const& number_of_cell_;
  std::vector<char> on_axis_;      // by vertex: it cannot leave the axis
  std::vector<Index> node_;        // by vertex: of the mesh
  std::vector<double> node_mass_;  // of all vertices there [kg]
  std::vector<Index> vertex_;      // itself
  StepLimit limit_;
  OfSprings springs_;
  FrequencyBound bound_;
  double share_ = 1, body_share_ = 1, viscous_share_ = 1;  // measured over bound: with beds; of bodies alone
  Deformation measured_at_;                                // when the share was measured
  std::vector<double> measured_rows_;                      // of the beds then, by vertex [1/s^2]
  // omega^2 for beds that have come since, and for contacts stiffer than their beds [1/s^2]
  double room_ = 0, excess_ = 0;
  double bounce_ = 0, alone_ = 0;  // squared frequencies of contact alone: of a node, of a vertex [1/s^2]
  double before_ = 0;              // the step that last shrank [s], in step
  long shrunk_ = -2;
  long known_list_ = 0, measured_list_ = 0;  // of beds
  // What bounds of contacts that are not measured have taken of the run since the last measurement, and what a
  // measurement takes [steps]: it is made when it has been lost.
  double lost_ = 0, cost_ = 0;
  double first_ = 0;             // the first step [s]; 0: not started
  long look_ = 0, refresh_ = 0;  // steps at which bodies are looked at, and the bound in any case
  long looked_ = 0;              // the last such step
  std::vector<Real> forces_;     // where the host cannot read them
  bool warned_of_dt_ = false;
};

}  // namespace fissure
