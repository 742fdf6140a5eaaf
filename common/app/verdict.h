// How far the numbers of a run can be trusted, and why not further (docs/verdict.md has the limits and where they come
// from).
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "output/json.h"
#include "scene/scene.h"
#include "solver/simulation.h"

namespace fissure::app {

struct Experiment;

enum class Grade { ok, look_again, do_not_trust };

struct Finding {
  Grade grade = Grade::look_again;
  std::string what;  // a few words: "process zone"
  std::string why;   // a sentence, with its place and what mends it
  int body = -1;     // whose joints it is about, after the last body: bonds; -1: of no joints
};

using Findings = std::vector<Finding>;

/// The worst of the findings decides.
struct Verdict {
  Findings findings;

  Grade grade() const;
  /// "look again: process zone, joints too soft".
  std::string line() const;
  output::Json json() const;
};

/// What speaks against the run before it has begun.
Findings foreseen(Experiment const& experiment);

/// The fastest that plates and the holds of a body are told to move, asked a thousand times in the run; between two of
/// them the speed from side to side [m/s].
double loading_speed(scene::Scene const& scene, int body);

/// What bodies hold when every place is off by its rounding in double precision [J]: of an experiment that turned over
/// less nothing is known. In single precision more would be hidden than is known.
double rounding_energy(Experiment const& experiment);

/// Whether joints are meant to slide at all: those that must not are given a strength far beyond their tension.
template <class Joint>
bool may_slide(Joint const& joint) {
  return joint.shear < 1e3 * joint.tension && joint.friction_angle < 1.5;
}
/// Mohr-Coulomb's strength of a slender specimen in compression [Pa].
template <class Joint>
double compressive_strength(Joint const& joint) {
  return 2 * joint.shear * std::cos(joint.friction_angle) / (1 - std::sin(joint.friction_angle));
}

/// What a run shows while it goes on, looked at with every sample of its history.
class Watch {
 public:
  void look(Experiment const& experiment);
  /// What it says against the run at its end. `turned_over`: largest change of any energy [J].
  Findings findings(Experiment const& experiment, double turned_over) const;

  /// For a restart.
  std::vector<double> numbers() const;
  void restore(std::vector<double> const& numbers);

 private:
  void judge_steps(Experiment const& experiment, Findings& found) const;
  void judge_shares(Experiment const& experiment, double turned_over, Findings& found) const;
  void judge_strains(Experiment const& experiment, Findings& found) const;
  void judge_jumps(Experiment const& experiment, Findings& found) const;
  void judge_flying(Experiment const& experiment, Findings& found) const;

  struct {
    double hourglass = 0;  // largest by springs against hourglass modes [J]
    double inside = 0;     // by these, elastically and in flow [J]
    double stored = 0;     // in bodies and joints [J]
    double inertia = 0;    // at that moment in motion and its damping [J]
    double spent = 0;      // and in fracture and flow [J]
    double kinetic = 0;    // largest [J]
    double step = 0;       // over the limit of stability [-]
    double drive = -1;     // largest speed at the start [m/s]; below 0: not asked yet
    double jumped = 0;     // elastic energy when jumps of stress were asked for [J]
    double strained = 0;   // and when elastic strain was [J]
    double given = 0;      // by inserted joints that were unloaded again [J]
  } most_;
  std::vector<double> strain_;  // [body]: largest elastic shear strain of those whose flow takes it to be small [-]
  std::vector<double> jumps_;   // [body]: of stress between neighbouring simplices, squared, over stress squared [-]
  std::vector<int> across_;     // mesh::neighbours()
};

}  // namespace fissure::app
