// Running a scene: from file to results, and going on from a checkpoint.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/app.h"
#include "app/verdict.h"
#include "lua/script.h"
#include "output/json.h"

namespace fissure::app {

struct Options {
  std::string scene, out, backend = "auto", precision = "double";
  std::vector<lua::Setting> settings;
  int threads = 0, gpu = 0;
  bool quiet = false;
  double until = 0;  // restart --time: where to go on to, past the scene's stop condition; 0: as the scene says [s]
};

/// "name=value" of --set. Throws Error.
lua::Setting setting_of(std::string const& text);

/// A scene on its way: read, meshed and, once prepared, ready to step.
struct Experiment {
  Options options;
  scene::Scene scene;
  mesh::Mesh mesh;
  mesh::StartingContact contact;
  mesh::JointStrengths strengths;  // of joint sets and scatter
  // what joints cannot resolve on this mesh: said again at the end where joints softened
  std::vector<Finding> unresolved;
  std::vector<Finding> unresolved_slip;  // only said at the end, where joints slid
  Device device;
  std::unique_ptr<Simulation> simulation;
};

/// Adds to the warnings what speaks against the run before it has begun, and what is possible but hardly meant, once
/// the step is known.
Verdict foresee(Experiment& experiment);
/// Asks about what is possible but hardly meant, once the time step is known: a line for each.
std::vector<std::string> questions(Experiment const& experiment);

Precision precision_of(std::string const& name);

/// What a run began with, in place of the files that are there now (restart).
struct StoredScene {
  std::string text;
  lua::Modules modules;
};

/// Reads, meshes and builds. Throws Error.
Experiment prepare(Program const& program, Options const& options, std::optional<StoredScene> const& stored = {});

/// The lines that `check` prints and every run begins with.
std::string describe(Program const& program, Experiment const& experiment);

/// Seconds that a step takes by the clock `now`: the median of short timings, at least 50 ms in all where there are so
/// many steps. So neither the first steps (memory, lists, threads that wake) count, nor what else the machine does now
/// and then.
double typical_step(std::function<void()> const& step, std::function<double()> const& now, double most_steps);

/// Runs to the end (or goes on from a checkpoint in the folder); returns the exit status.
int run(Program const& program, Options const& options);
int restart(Program const& program, std::string const& folder, Options const& options);

}  // namespace fissure::app
