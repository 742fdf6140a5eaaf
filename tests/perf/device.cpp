// Steps of a scene on a device, as one line of JSON: time, launches, copies, kernels, memory. scripts/gpu_check makes
// its tables of it.
//
//   device_bench_3d SCENE.lua --set size=24 --steps 500 --backend cuda --precision single
//   device_bench_3d --card --backend cuda       # what the device could do at best
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>

#include "../unit/backend_kernels.h"
#include "app/run.h"
#include "backend/buffer.h"
#include "dim.h"
#include "model/plan.h"
#include "output/json.h"
#include "shapes.h"

namespace fissure {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Seconds that `run` takes on average, after one run that is not timed.
template <class F>
double mean_time(Device& device, int times, F const& run) {
  run();
  device.wait();
  double const start = now();
  for (int i = 0; i < times; ++i) run();
  device.wait();
  return (now() - start) / times;
}

/// Bytes read and written per second by b = 2 a over arrays far larger than caches [B/s].
double copy_rate(Device& device) {
  Index const n = device.backend() == Backend::cuda ? 1 << 27 : 1 << 24;
  Buffer<double> a(device, "a", n), b(device, "b", n);
  double const time = mean_time(device, 10, [&] {
    for_each(device, 0, n, test::Scale<double>{a.data(), b.data(), 2});
  });
  return 16.0 * n / time;
}

int card(std::string const& backend, int gpu) {
  Device device = Device::select(backend, 1, gpu);
  device.watch(false);
  Buffer<Index> few(device, "few", 64);
  Buffer<double> values(device, "values", 64);
  double const launch = mean_time(device, 1000, [&] { for_each(device, 0, 64, test::Number{few.data()}); });
  double const sum = mean_time(device, 1000, [&] { sum_over<2>(device, 0, 64, test::Moments{values.data()}); });
  double const copy = mean_time(device, 1000, [&] { few.download_one(0); });
  output::Json result;
  result["device"] = device.describe();
  result["room_GB"] = device.room() * 1e-9;
  result["copy_GB_per_s"] = copy_rate(device) * 1e-9;
  result["launch_us"] = launch * 1e6;
  result["sum_us"] = sum * 1e6;
  result["small_copy_us"] = copy * 1e6;
  fmt::print("{}\n", result.text());
  return 0;
}

int steps_of(app::Program const& program, app::Options const& options, int steps) {
  double const begin = now();
  app::Experiment experiment = app::prepare(program, options);
  Device& device = experiment.device;
  bool const watched = device.watched();
  std::size_t const real = options.precision == "double" ? 8 : 4;
  double const rate = copy_rate(device);
  experiment.simulation =
      program.make_simulation(device, experiment.scene, experiment.mesh, app::precision_of(options.precision));
  auto& simulation = *experiment.simulation;
  double const cells = static_cast<double>(simulation.element_count()), setup = now() - begin;
  auto const step = [&] { simulation.evaluate(), simulation.advance(); };
  step();  // loads kernels and makes lists
  device.wait();
  long launches = 0;
  for (auto const& [kernel, n] : device.launches()) launches -= n;
  long const copies = device.copies();
  std::size_t const bytes = device.copied_bytes();
  double const start = now();
  double longest = 0;
  for (int i = 0; i < steps; ++i) {
    double const before = now();
    step();
    longest = std::max(longest, now() - before);
  }
  device.wait();
  double const time = (now() - start) / steps;
  for (auto const& [kernel, n] : device.launches()) launches += n;
  constexpr double least[2][2] = {{230, 124}, {426, 226}};  // bytes of an element-step: docs/performance.md
  double const floor = least[FISSURE_D == 3][real == 4] * cells / rate;
  output::Json result;
  result["device"] = device.describe();
  result["precision"] = options.precision;
  result["cells"] = cells;
  result["steps"] = steps;
  result["setup_s"] = setup;
  result["ms_per_step"] = time * 1e3;
  result["longest_ms"] = longest * 1e3;
  result["launches_per_step"] = static_cast<double>(launches) / steps;
  result["copies_per_step"] = static_cast<double>(device.copies() - copies) / steps;
  result["copied_bytes_per_step"] = static_cast<double>(device.copied_bytes() - bytes) / steps;
  result["bytes_per_cell"] = static_cast<double>(device.bytes()) / cells;
  result["foreseen_bytes_per_cell"] =
      static_cast<double>(model::bytes_foreseen(experiment.scene, experiment.mesh, real)) / cells;
  result["copy_GB_per_s"] = rate * 1e-9;
  result["floor_ms"] = floor * 1e3;
  result["share_of_floor"] = floor / time;
  result["broken_joints"] = static_cast<double>(simulation.now().broken_joints());
  // Once more, waiting for each kernel, for the share of each.
  auto const launched = device.launches();
  auto const timed = device.times();
  device.watch(true);
  int const more = std::min(steps, 50);
  for (int i = 0; i < more; ++i) step();
  device.watch(watched);
  for (auto const& [kernel, seconds] : device.times()) {
    double const before = timed.count(kernel) ? timed.at(kernel) : 0;
    long const n = device.launches().at(kernel) - (launched.count(kernel) ? launched.at(kernel) : 0);
    if (n == 0) continue;
    output::Json& of = result["kernels"][kernel];
    of["launches_per_step"] = static_cast<double>(n) / more;
    of["us_with_wait"] = (seconds - before) / static_cast<double>(n) * 1e6;
  }
  fmt::print("{}\n", result.text());
  return 0;
}

lua::Setting setting_of(std::string const& text) {
  std::size_t const equals = text.find('=');
  return {text.substr(0, equals), std::stod(text.substr(equals + 1))};
}

}  // namespace
}  // namespace fissure

int main(int argc, char** argv) {
  using namespace fissure;
  app::Program const program{fmt::format("fissure{}d", FISSURE_D), FISSURE_D, &mesh::FISSURE_MESHER(),
                             &make_simulation<FISSURE_D>};
  app::Options options;
  options.threads = 1;
  std::vector<std::string> settings;
  int steps = 500;
  bool only_card = false;
  CLI::App app("Time, launches, copies and memory of a scene's steps on a device");
  app.add_option("scene", options.scene, "scene file (Lua)");
  app.add_option("--set", settings, "name=value");
  app.add_option("--steps", steps, "how many are timed")->check(CLI::PositiveNumber);
  app.add_option("--backend", options.backend, "auto, cpu or cuda");
  app.add_option("--device", options.gpu, "which GPU");
  app.add_option("--threads", options.threads, "CPU threads");
  app.add_option("--precision", options.precision, "double or single");
  app.add_flag("--card", only_card, "only what the device could do at best");
  CLI11_PARSE(app, argc, argv);
  try {
    for (auto const& text : settings) options.settings.push_back(setting_of(text));
    return only_card ? card(options.backend, options.gpu) : steps_of(program, options, steps);
  } catch (std::exception const& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
