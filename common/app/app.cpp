#include "app/app.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <new>
#include <optional>

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
  double const whole = experiment.scene.run.time + simulation.settling_time();
  double const steps = std::ceil(whole / simulation.step_limit().dt);
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
  double const total = per_step * whole / simulation.step_limit().dt;
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

namespace {

/// The program's commands with their options, and what the one that was given does.
class CommandLine {
 public:
  explicit CommandLine(Program const& program)
      : program_(program),
        app_("Fissure: combined finite-discrete elements in " + std::to_string(program.dimension) + "D", program.name) {
    app_.require_subcommand(1);
    app_.set_version_flag("--version", build_facts(program.name));
    add_runs();
    add_looks();
    add_pages();
    std::string statuses;
    for (auto const& [status, what] : exit_statuses) statuses += fmt::format("\n  {:<5}{}", status, what);
    app_.footer(
        fmt::format("Begin with\n  {0} new                 starting scenes: {0} new bend writes bend.lua\n"
                    "  {0} check bend.lua      what would be computed, and how long it would take\n"
                    "  {0} run bend.lua        computes it\n\nExit status{1}",
                    program.name, statuses));
  }

  /// The exit status where it ends the program (help, or words that are wrong).
  std::optional<int> read(int argc, char** argv) {
    try {
      app_.parse(argc, argv);
      return std::nullopt;
    } catch (CLI::ParseError const& error) {
      if (argc < 2)
        fmt::print(stderr, "{}", app_.help());
      else if (error.get_exit_code() == 0)
        return app_.exit(error);  // --help, --version
      else
        fmt::print(stderr, "{}: {}\n", program_.name, complaint(app_, argv[1], error));
      return 2;
    }
  }
  int act() {
    for (auto const& text : settings_) options_.settings.push_back(setting_of(text));
    return action_();
  }

 private:
  template <class Action>
  CLI::App* add(char const* name, char const* what, Action action) {
    CLI::App* const command = app_.add_subcommand(name, what);
    command->callback([this, action] { action_ = action; });
    return command;
  }
  CLI::App* with_scene(CLI::App* command) {
    command->add_option("scene", options_.scene, "scene file (Lua)")->required();
    command
        ->add_option("--set", settings_,
                     "give a parameter another value: name=value; or a key of all tables of a verb: run.safety=0.4, "
                     "body.mesh.size=*0.5")
        ->type_name("NAME=VALUE");
    return command;
  }
  CLI::App* with_device(CLI::App* command) {
    command->add_option("--backend", options_.backend, "auto, cpu or cuda")->type_name("NAME");
    command->add_option("--threads", options_.threads, "CPU threads; 0: all")
        ->type_name("N")
        ->check(CLI::Range(0, 1024));
    command->add_option("--device", options_.gpu, "which GPU, as nvidia-smi counts them")
        ->type_name("N")
        ->check(CLI::Range(0, 1024));
    return command;
  }
  void with_precision(CLI::App* command) {
    command->add_option("--precision", options_.precision, "double or single")->type_name("NAME");
  }

  void add_runs() {
    auto* const run_command =
        with_device(with_scene(add("run", "run a scene", [this] { return run(program_, options_); })));
    with_precision(run_command);
    run_command
        ->add_option("--out", options_.out, "folder for the results (default: the scene's name and this program's)")
        ->type_name("FOLDER");
    run_command->add_flag("--quiet", options_.quiet, "say only how it ended");
    with_precision(with_device(
        with_scene(add("check", "say what would be modelled, with mesh, time step, memory and time; run nothing",
                       [this] { return check(program_, options_); }))));
    with_scene(add("params", "list a scene's parameters", [this] { return params(program_, options_); }));
    auto* const new_command = add("new", "write a starting scene; without a kind: list them",
                                  [this] { return write_start(program_.name, kind_, file_); });
    new_command->add_option("kind", kind_, "what kind of experiment");
    new_command->add_option("file", file_, "the scene's file (default: the kind's name); one that is there stays");
    auto* const restart_command = with_device(add("restart", "go on from the checkpoint in a run's folder",
                                                  [this] { return restart(program_, folder_, options_); }));
    restart_command->add_option("folder", folder_, "the run's folder")->required();
    restart_command
        ->add_option("--time", options_.until, "go on to this time [s], past the scene's own end and stop condition")
        ->type_name("SECONDS")
        ->check([](std::string const& text) -> std::string {
          double const time = std::strtod(text.c_str(), nullptr);
          return time > 0 && std::isfinite(time) ? "" : text + " is no time after 0 [s]";
        });
  }
  void add_looks() {
    add("compare",
        "run a scene in 2D and in 3D and say how far they agree: a script, scripts/compare or fissure-compare",
        []() -> int { throw Error("compare runs both programs, so it is a script: scripts/compare SCENE.lua"); })
        ->prefix_command();
    add("materials", "list the materials of `require \"materials\"`", [] { return say(lua::material_list()); });
    add("info", "build and devices", [this] { return info(program_); });
  }
  void add_pages() {
    auto* const pages_command = add("reference", "print the reference page of the scene language", [this] {
      return say(annotations_ ? lua::annotations()
                 : for_man_   ? manual(app_)
                 : for_bash_  ? bash_completion(app_)
                              : lua::reference_page());
    });
    pages_command->add_flag("--annotations", annotations_, "the annotation file for editors instead");
    pages_command->add_flag("--manual", for_man_, "the manual page for man(1) instead");
    pages_command->add_flag("--completion", for_bash_, "completion for bash instead");
  }
  static int say(std::string const& text) {
    fmt::print("{}", text);
    return 0;
  }

  Program const& program_;
  CLI::App app_;
  Options options_;
  std::vector<std::string> settings_;
  std::string folder_, kind_, file_;
  bool annotations_ = false, for_man_ = false, for_bash_ = false;
  std::function<int()> action_;
};

}  // namespace

int main(Program const& program, int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is an error of writing, not the end of the program
  CommandLine line(program);
  if (auto const status = line.read(argc, argv)) return *status;
  try {
    int const status = line.act();
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
      throw Error("cannot write to standard output (is it closed, or the disk full?)");
    return status;
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
