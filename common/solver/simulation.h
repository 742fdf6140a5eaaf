// A running experiment, whatever its dimension and precision: what the program drives and what measures ask.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "contact/counts.h"
#include "mesh/mesh.h"
#include "model/plan.h"
#include "model/state.h"
#include "output/results.h"
#include "scene/scene.h"
#include "solver/recorded.h"

namespace fissure {

class Device;

/// The stable step and what limits it.
struct StepLimit {
  double dt = 0;         // [s], safety included
  double automatic = 0;  // [s], what the program chooses, safety included
  double stable = 0;     // [s], the largest that does not blow up: measured, without safety
  double bound = 0;      // [s], the same of bodies alone, by the bound
  std::string owner;     // "joint of element 10233, penalty 1000 E"
};

/// What softening took of joints.
struct Softened {
  double taken = 0, by_slip = 0;  // [J]
};

/// Wall-clock seconds by stage, filled when asked for.
struct StageTimes {
  double elements = 0, contact = 0, loads = 0, advance = 0;
};

class Simulation {
 public:
  virtual ~Simulation() = default;

  /// Forces and energies at the current time; then measures may look.
  virtual void evaluate() = 0;
  /// One step in time, from what evaluate() found.
  virtual void advance() = 0;

  /// Back to the positions before the last step: after a failure, the last configuration that was good.
  virtual void step_back() = 0;
  /// No step goes past this time [s]; at first the scene's run.time.
  virtual void end_at(double time) = 0;
  virtual double settling_time() const = 0;  // before the start [s]
  /// Before the first step of a scene that settles: until it has, or until goes_on(), asked after every step, says no;
  /// then false.
  virtual bool settle(std::function<bool()> const& goes_on) = 0;

  virtual double time() const = 0;  // [s]
  virtual long step() const = 0;
  /// What may be asked of it, after evaluate().
  virtual scene::Now const& now() const = 0;

  virtual StepLimit const& step_limit() const = 0;
  virtual double mass_scaled_share() const = 0;  // added mass over true mass
  virtual model::Plan const& plan() const = 0;
  virtual Device& device() = 0;
  virtual long element_count() const = 0;  // real ones
  virtual std::vector<std::string> const& warnings() const = 0;
  virtual ContactCounts contact_counts() const = 0;
  virtual double largest_penetration() const = 0;      // potential of the deepest contact, 0..1
  virtual std::vector<Softened> softened() const = 0;  // joints inside each body and, last, those of all bonds

  virtual output::Topology topology() const = 0;
  virtual output::Frame frame(std::vector<std::string> const& fields) const = 0;

  /// The whole state, by name, as bytes; restore() continues to the last bit.
  virtual State save() const = 0;
  virtual void restore(State const& state) = 0;

  StageTimes stage_times;
  bool time_stages = false;
  /// Measures' latest and largest values, kept by the program that samples them.
  struct Sampled {
    double latest = 0, peak = 0, peak_time = 0;
    bool any = false;
  };
  std::map<std::string, Sampled> sampled;
  Recorded recorded;  // measures and "energy kinetic", likewise
};

enum class Precision { double_, single };

/// `scene` must outlive the simulation. Defined by src2d and src3d.
template <int D>
std::unique_ptr<Simulation> make_simulation(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh,
                                            Precision precision);

}  // namespace fissure
