#include "app/app.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <new>

#include "app/facts.h"
#include "app/pages.h"
#include "app/run.h"
#include "app/start.h"

namespace fissure::app {

lua::Setting setting_of(std::string const& text) {
  std::size_t const equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw Error("--set " + text + ": expected name=value");
  if (lua::Setting const of_key{text.substr(0, equals), 0, text.substr(equals + 1)}; of_key.of_key()) return of_key;
  char const* const begin = text.c_str() + equals + 1;
  char* end = nullptr;
  double const value = std::strtod(begin, &end);
  if (end == begin || *end != '\0')
    throw Error("--set " + text + ": \"" + begin + "\" is not a number (SI units, no names: 3e-3, not 3*mm)");
  return {text.substr(0, equals), value, text.substr(equals + 1)};
}

namespace {

int check(Program const& program, Options const& options) {
  Experiment experiment = prepare(program, options);
  experiment.simulation =
      program.make_simulation(experiment.device, experiment.scene, experiment.mesh, precision_of(options.precision));
  Verdict const verdict = foresee(experiment);
  for (auto const& warning : experiment.scene.warnings) fmt::print("warning: {}\n", warning);
  for (auto const& warning : experiment.simulation->warnings()) fmt::print("warning: {}\n", warning);
  fmt::print("{}", describe(program, experiment));
  // A few steps tell what the whole will take.
  auto& simulation = *experiment.simulation;
  double const steps = std::ceil(experiment.scene.run.time / simulation.step_limit().dt);
  auto const now = [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  };
  double per_step = 0;
  try {
    per_step = typical_step([&] { simulation.evaluate(), simulation.advance(); }, now, steps);
  } catch (Error const& error) {
    fmt::print("; the first of them fail\nverdict as far as it can be foreseen: do not trust: it fails\n");
    throw;
  }
  double const total = per_step * experiment.scene.run.time / simulation.step_limit().dt;
  bool const may_break = simulation.plan().joints && simulation.plan().pairs;
  fmt::print(", {:.3g} ms each as measured now on this machine: about {:.3g} {}{}\n", per_step * 1e3,
             total < 120    ? total
             : total < 7200 ? total / 60
                            : total / 3600,
             total < 120    ? "s"
             : total < 7200 ? "minutes"
                            : "hours",
             may_break
                 ? " while bodies are whole (steps among fragments cost many times more, how many are not foreseen)"
                 : "");
  fmt::print("verdict as far as it can be foreseen: {}\n", verdict.line());
  return 0;
}

/// What is wrong with the command line, and the nearest right word.
std::string complaint(CLI::App const& app, std::string const& first, CLI::ParseError const& error) {
  std::vector<std::string> commands, options;
  for (auto const* command : app.get_subcommands({})) commands.push_back(command->get_name());
  bool const command = std::find(commands.begin(), commands.end(), first) != commands.end();
  if (!command && first[0] != '-')
    return fmt::format("unknown command \"{}\" (known: {}){}", first, fmt::join(commands, ", "),
                       first.ends_with(".lua") ? "; did you mean \"run " + first + "\"?" : suggestion(first, commands));
  return fmt::format("{}; {} {}--help lists what there is", error.what(), app.get_name(), command ? first + " " : "");
}

int params(Program const& program, Options const& options) {
  auto const scene = lua::read_scene(options.scene, program.dimension, options.settings);
  if (scene.parameters.empty()) fmt::print("{} has no parameters\n", options.scene);
  for (auto const& parameter : scene.parameters)
    fmt::print("{:<12} {:<12.6g} (default {:.6g}) {}\n", parameter.name, parameter.value, parameter.fallback,
               parameter.help);
  if (scene.study) {
    auto const quoted = [](std::string const& word) {  // for a shell
      std::string text = "'";
      for (char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
      return text + "'";
    };
    auto const& study = *scene.study;
    fmt::print("study:");
    for (auto const& axis : study.vary) fmt::print(" --vary={}", quoted(axis));
    fmt::print(" --measure={} --reference={} --tolerance={:g}\n", quoted(study.measure + ":" + study.of),
               quoted(study.reference), study.tolerance);
  }
  return 0;
}

int info(Program const& program) {
  fmt::print("{}", build_facts(program.name));
  std::string const obstacle = cuda::why_not(0);
  fmt::print("this cpu   {}\n", Device::select("cpu").describe());
  fmt::print("this gpu   {}\n", obstacle.empty() ? cuda::device_name() : "not usable (" + obstacle + ")");
  return 0;
}

}  // namespace

double typical_step(std::function<void()> const& step, std::function<double()> const& now, double most_steps) {
  std::vector<double> timings;
  double const start = now();
  for (double done = 0; done < most_steps && timings.size() < 16 && (timings.size() < 4 || now() - start < 5);) {
    double const began = now();
    double steps = 0, took = 0;
    do step(), ++steps, took = now() - began;
    while (took < 5e-3 && done + steps < most_steps);
    done += steps;
    timings.push_back(took / steps);
  }
  if (timings.size() > 1) timings.erase(timings.begin());
  auto const middle = timings.begin() + static_cast<std::ptrdiff_t>(timings.size() / 2);
  std::nth_element(timings.begin(), middle, timings.end());
  return timings.empty() ? 0 : *middle;
}

int main(Program const& program, int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is an error of writing, not the end of the program
  CLI::App app{"Fissure: combined finite-discrete elements in " + std::to_string(program.dimension) + "D",
               program.name};
  app.require_subcommand(1);
  app.set_version_flag("--version", build_facts(program.name));
  Options options;
  std::vector<std::string> settings;
  std::string folder;
  auto const with_scene = [&](CLI::App* command) {
    command->add_option("scene", options.scene, "scene file (Lua)")->required();
    command
        ->add_option("--set", settings,
                     "give a parameter another value: name=value; or a key of all tables of a verb: run.safety=0.4, "
                     "body.mesh.size=*0.5")
        ->type_name("NAME=VALUE");
    return command;
  };
  auto const with_device = [&](CLI::App* command) {
    command->add_option("--backend", options.backend, "auto, cpu or cuda")->type_name("NAME");
    command->add_option("--threads", options.threads, "CPU threads; 0: all")
        ->type_name("N")
        ->check(CLI::Range(0, 1024));
    command->add_option("--device", options.gpu, "which GPU, as nvidia-smi counts them")
        ->type_name("N")
        ->check(CLI::Range(0, 1024));
    return command;
  };
  auto* const run_command = with_device(with_scene(app.add_subcommand("run", "run a scene")));
  run_command->add_option("--precision", options.precision, "double or single")->type_name("NAME");
  run_command->add_option("--out", options.out, "folder for the results (default: the scene's name and this program's)")
      ->type_name("FOLDER");
  run_command->add_flag("--quiet", options.quiet, "say only how it ended");
  auto* const check_command = with_device(with_scene(
      app.add_subcommand("check", "say what would be modelled, with mesh, time step, memory and time; run nothing")));
  check_command->add_option("--precision", options.precision, "double or single")->type_name("NAME");
  auto* const params_command = with_scene(app.add_subcommand("params", "list a scene's parameters"));
  std::string kind, file;
  auto* const new_command = app.add_subcommand("new", "write a starting scene; without a kind: list them");
  new_command->add_option("kind", kind, "what kind of experiment");
  new_command->add_option("file", file, "the scene's file (default: the kind's name); one that is there stays");
  auto* const restart_command =
      with_device(app.add_subcommand("restart", "go on from the checkpoint in a run's folder"));
  restart_command->add_option("folder", folder, "the run's folder")->required();
  restart_command
      ->add_option("--time", options.until, "go on to this time [s], past the scene's own end and stop condition")
      ->type_name("SECONDS")
      ->check([](std::string const& text) -> std::string {
        double const time = std::strtod(text.c_str(), nullptr);
        return time > 0 && std::isfinite(time) ? "" : text + " is no time after 0 [s]";
      });
  auto* const compare_command =
      app.add_subcommand(
             "compare",
             "run a scene in 2D and in 3D and say how far they agree: a script, scripts/compare or fissure-compare")
          ->prefix_command();
  auto* const materials_command = app.add_subcommand("materials", "list the materials of `require \"materials\"`");
  auto* const info_command = app.add_subcommand("info", "build and devices");
  auto* const pages_command = app.add_subcommand("reference", "print the reference page of the scene language");
  bool annotations = false;
  pages_command->add_flag("--annotations", annotations, "the annotation file for editors instead");
  bool for_man = false, for_bash = false;
  pages_command->add_flag("--manual", for_man, "the manual page for man(1) instead");
  pages_command->add_flag("--completion", for_bash, "completion for bash instead");
  std::string statuses;
  for (auto const& [status, what] : exit_statuses) statuses += fmt::format("\n  {:<5}{}", status, what);
  app.footer(
      fmt::format("Begin with\n  {0} new                 starting scenes: {0} new bend writes bend.lua\n"
                  "  {0} check bend.lua      what would be computed, and how long it would take\n"
                  "  {0} run bend.lua        computes it\n\nExit status{1}",
                  program.name, statuses));
  try {
    app.parse(argc, argv);
  } catch (CLI::ParseError const& error) {
    if (argc < 2)
      fmt::print(stderr, "{}", app.help());
    else if (error.get_exit_code() == 0)
      return app.exit(error);  // --help, --version
    else
      fmt::print(stderr, "{}: {}\n", program.name, complaint(app, argv[1], error));
    return 2;
  }

  try {
    for (auto const& text : settings) options.settings.push_back(setting_of(text));
    if (*run_command) return run(program, options);
    if (*check_command) return check(program, options);
    if (*params_command) return params(program, options);
    if (*restart_command) return restart(program, folder, options);
    if (*compare_command) throw Error("compare runs both programs, so it is a script: scripts/compare SCENE.lua");
    if (*info_command) return info(program);
    if (*materials_command) fmt::print("{}", lua::material_list());
    if (*new_command) return write_start(program.name, kind, file);
    if (*pages_command)
      fmt::print("{}", annotations ? lua::annotations()
                       : for_man   ? manual(app)
                       : for_bash  ? bash_completion(app)
                                   : lua::reference_page());
    return 0;
  } catch (Error const& error) {
    fmt::print(stderr, "{}\n", error.what());
  } catch (std::bad_alloc const&) {
    fmt::print(stderr, "not enough memory; use a coarser mesh?\n");
  } catch (std::exception const& error) {
    fmt::print(stderr, "{}: unexpected failure ({}); please report it with the scene\n", program.name, error.what());
  }
  return 2;
}

}  // namespace fissure::app
