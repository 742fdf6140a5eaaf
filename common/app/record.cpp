// run.json.
#include "app/record.h"

#include <algorithm>

namespace fissure::app {

namespace {

output::Json plots_of(scene::Scene const& scene) {
  output::Json plots = output::Json::array();
  for (auto const& plot : scene.plots) {
    output::Json entry = output::Json::object();
    entry["name"] = plot.name, entry["against"] = plot.against;
    for (auto const& measure : scene.measures)
      if (measure.name == plot.name) entry["unit"] = measure.unit;
    plots.push(entry);
  }
  return plots;
}

output::Json plan_of(Simulation const& simulation) {
  output::Json plan = output::Json::array();
  for (auto const& decision : simulation.plan().decisions) {
    output::Json entry = output::Json::object();
    entry["what"] = decision.what, entry["modelled"] = decision.modelled, entry["why"] = decision.why;
    plan.push(entry);
  }
  return plan;
}

}  // namespace

void record_experiment(output::Json& record, Program const& program, Experiment const& experiment) {
  auto const& scene = experiment.scene;
  record["program"] = program.name, record["version"] = FISSURE_VERSION;
  record["scene"]["file"] = experiment.options.scene;
  record["scene"]["text"] = scene.text;
  for (auto const& [name, module] : scene.modules)
    if (!module.file.empty()) record["scene"]["modules"][name] = module.text;
  for (auto const& parameter : scene.parameters) record["scene"]["parameters"][parameter.name] = parameter.value;
  output::Json settings = output::Json::array();
  for (auto const& setting : experiment.options.settings) settings.push(setting.name + "=" + setting.text);
  record["scene"]["settings"] = settings;
  record["plan"] = plan_of(*experiment.simulation);
  record["device"] = experiment.simulation->device().describe();
  record["precision"] = experiment.options.precision;
  for (auto const& [name, bytes] : experiment.simulation->device().arrays())
    record["memory"][name] = static_cast<long>(bytes);
  auto const quality = mesh::quality(experiment.mesh);
  output::Json meshes = output::Json::array();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    meshes.push(mesh::describe(scene.bodies[b].name, experiment.mesh.kind, quality[b]));
  record["mesh"] = meshes;
  record["plots"] = plots_of(scene);
  record["until"] = scene.run.time;
}

void record_state(output::Json& record, Simulation const& simulation, EnergyBalance const& balance) {
  auto const& now = simulation.now();
  if (simulation.step() > 0)
    for (auto const& name : scene::energy_names()) record["energy"][name] = now.energy(name);
  if (now.broken_joints() > 0) {
    constexpr std::size_t most = 1000;
    auto const pieces = now.fragments(-1);
    output::Json masses = output::Json::array();
    for (std::size_t k = 0; k < std::min(most, pieces.size()); ++k) masses.push(pieces[k].mass);
    record["fragments"]["count"] = static_cast<long>(pieces.size()), record["fragments"]["masses [kg]"] = masses;
  }
  if (now.removed_pieces() > 0) {
    record["removed"]["count"] = now.removed_pieces();
    record["removed"]["mass [kg]"] = now.removed_mass();
    record["removed"]["energy [J]"] = now.energy("removed");
  }
  if (balance.begun())
    record["balance"]["off by"] = balance.off(), record["balance"]["share of"] = balance.scale().second,
    record["balance"]["turned over"] = balance.turned_over();
}

}  // namespace fissure::app
