// The loop around a simulation: sampling, frames, checkpoints, stopping, and the record that stays behind.
#include "app/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>

#include "app/record.h"
#include "app/summary.h"
#include "output/checkpoint.h"
#include "output/history_file.h"
#include "output/progress.h"
#include "output/result_file.h"
#include "output/run_folder.h"

namespace fissure::app {

namespace {

std::atomic<std::time_t> interrupted = 0;  // when [s]; 0: not yet

/// Ctrl-C ends a run after the step it is in; another one, two seconds later, ends the program at once: shells,
/// schedulers and `timeout` may send the same signal twice, to the program and to its group.
class InterruptGuard {
 public:
  InterruptGuard() {
    interrupted = 0;
    for (int signal : {SIGINT, SIGTERM})
      std::signal(signal, [](int s) {
        std::time_t const now = std::time(nullptr), first = interrupted;
        if (first != 0 && now - first >= 2) {
          std::signal(s, SIG_DFL);
          std::raise(s);
        }
        if (first == 0) interrupted = now;
      });
  }
  ~InterruptGuard() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
  }
};

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// What --set said, a line for each.
std::string settings_text(Options const& options) {
  std::string text;
  for (auto const& setting : options.settings) text += setting.name + "=" + setting.text + "\n";
  return text;
}

std::string scene_hash(Experiment const& experiment) {
  std::uint64_t hash = 1469598103934665603ull;  // FNV-1a
  auto const add = [&](std::string const& text) {
    for (unsigned char c : text) hash = (hash ^ c) * 1099511628211ull;
  };
  add(experiment.scene.text);
  for (auto const& [name, module] : experiment.scene.modules) add(name + "=" + module.text);
  add(settings_text(experiment.options));
  auto const add_array = [&]<class T>(std::vector<T> const& values) {
    for (T const& value : values) {
      char bytes[sizeof(T)];
      std::memcpy(bytes, &value, sizeof(T));
      add(std::string(bytes, sizeof(T)));
    }
  };
  // What mesh files made of it.
  for (auto const& x : experiment.mesh.nodes) add_array(std::vector<double>{x[0], x[1], x[2]});
  add_array(experiment.mesh.cells);
  for (auto const& parameter : experiment.scene.parameters)
    add(fmt::format("{}={:.17g};", parameter.name, parameter.value));
  return fmt::format("{:016x}", hash);
}

std::vector<output::HistoryFile::Column> history_columns(scene::Scene const& scene) {
  std::vector<output::HistoryFile::Column> columns;
  for (auto const& measure : scene.measures) columns.push_back({measure.name, measure.unit});
  for (auto const& [name, unit] : scene::standard_columns()) columns.push_back({name, unit});
  return columns;
}

/// Moves the next moment of an event that comes at every interval past the time. An interval far below the step means
/// every step.
void move_past(double time, double every, double& next) {
  if (time - next > 1000 * every) next = time;
  while (next <= time && next + every > next) next += every;
  if (next <= time) next = std::nextafter(time, INFINITY);
}

/// One experiment with its files.
class Runner {
 public:
  Runner(Program const& program, Experiment& experiment, std::string folder)
      : program_(program),
        experiment_(experiment),
        scene_(experiment.scene),
        simulation_(*experiment.simulation),
        folder_(std::move(folder)),
        plate_touched_(scene_.plates.size()),
        wall_touched_(scene_.walls.size()) {}

  int start() {
    output::make_run_folder(folder_);
    lock_ = output::RunLock(folder_);
    output::remove_earlier_run(folder_);
    results_ = std::make_unique<output::ResultFile>(output::ResultFile::create(folder_, simulation_.topology()));
    history_ = std::make_unique<output::HistoryFile>(output::HistoryFile::create(folder_, history_columns(scene_)));
    write_record("running");
    return loop(true);
  }

  int go_on(output::Checkpoint const& checkpoint, output::RunLock lock) {
    lock_ = std::move(lock);
    State state;
    for (auto const& [name, blob] : checkpoint.blobs)
      if (name.rfind("state ", 0) == 0) {
        auto const* const raw = reinterpret_cast<std::uint8_t const*>(blob.data());
        state[name.substr(6)].assign(raw, raw + blob.size());
      }
    simulation_.restore(state);
    auto const numbers = checkpoint.get<double>("runner");
    auto const some = [](double n) { return n >= 0 && n < 1e9; };  // of rows and frames
    if (numbers.size() != 6 || !some(numbers[4]) || !some(numbers[5]) ||
        !std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); }))
      throw Error("the checkpoint's \"runner\" is damaged");
    next_sample_ = numbers.at(0), next_frame_ = numbers.at(1), next_checkpoint_ = numbers.at(2);
    balance_.restore(checkpoint.get<double>("energies at the start"), numbers.at(3));
    watch_.restore(checkpoint.get<double>("watch"));
    // A checkpoint is taken before the sample of its time, so that sample and frame come again.
    double const before = std::nextafter(simulation_.time(), -1.0);
    results_ = std::make_unique<output::ResultFile>(
        output::ResultFile::reopen(folder_, simulation_.topology(), before, static_cast<int>(numbers.at(5))));
    auto const columns = history_columns(scene_);
    auto const recorded = [&](std::vector<double> const& row) {
      simulation_.recorded.begin_row(row[0]);
      for (std::size_t k = 0; k < columns.size(); ++k)
        if (k < scene_.measures.size() || columns[k].name == "energy kinetic")
          simulation_.recorded.add(columns[k].name, row[k + 1]);
    };
    history_ = std::make_unique<output::HistoryFile>(output::HistoryFile::reopen(folder_, columns, before, recorded));
    auto const tell = [&](double written, double left, char const* what) {
      if (left < written)
        fmt::print(stderr, "warning: {}: {:.0f} of the {:.0f} {} written before the checkpoint are missing\n", folder_,
                   written - left, written, what);
    };
    tell(numbers.at(4), static_cast<double>(history_->rows()), "rows of the history");
    tell(numbers.at(5), results_->frames(), "frames");
    return loop(false);
  }

 private:
  int loop(bool fresh) {
    InterruptGuard const guard;
    double const end = experiment_.options.until > 0 ? experiment_.options.until : scene_.run.time;
    double const sample_every = scene_.output.measure_every > 0 ? scene_.output.measure_every : scene_.run.time / 1000;
    bool const may_stop = scene_.run.stop && experiment_.options.until <= 0;
    // the stop condition; the run ends one step later, with a checkpoint, which is taken before forces are evaluated
    bool met = false;
    simulation_.end_at(end);
    first_step_ = simulation_.step();
    began_ = seconds();
    output::Progress progress(simulation_.time(), end, simulation_.step(),
                              static_cast<double>(simulation_.element_count()),
                              experiment_.options.quiet ? nullptr : stderr);
    std::string reason;
    try {
      if (fresh && !simulation_.settle([] { return interrupted == 0; }))
        throw Error("interrupted while bodies settled, before the start: nothing is recorded of that, run it again");
      for (;;) {
        bool const finished = simulation_.time() >= end * (1 - 1e-12);
        // asked once a turn: a signal in mid-turn waits for the next, which takes the checkpoint
        bool const stopping = interrupted != 0;
        bool const last = finished || stopping || met;
        if (last || (scene_.output.checkpoint_every > 0 && simulation_.time() >= next_checkpoint_)) {
          if (scene_.output.checkpoint_every > 0)
            move_past(simulation_.time(), scene_.output.checkpoint_every, next_checkpoint_);
          save_checkpoint();
        }
        simulation_.time_stages = simulation_.step() % 16 == 0;  // a clock costs, too
        timed_ += simulation_.time_stages;
        simulation_.evaluate();
        note_touches();
        bool stop = false;
        if (last || simulation_.time() >= next_sample_) {
          move_past(simulation_.time(), sample_every, next_sample_);
          sample();
          stop = !last && may_stop && scene_.run.stop(simulation_.now());
        }
        if (last || simulation_.time() >= next_frame_) {
          move_past(simulation_.time(), scene_.output.every > 0 ? scene_.output.every : 2 * end, next_frame_);
          results_->append(simulation_.frame(scene_.output.fields));
        }
        if (finished)
          reason = "end of time";
        else if (met)
          reason = "stop condition";
        else if (stopping)
          reason = "interrupted";
        if (!reason.empty()) break;
        met = stop;
        simulation_.advance();
        progress.update(simulation_.time(), simulation_.step());
      }
    } catch (std::exception const& error) {
      progress.clear();
      say_warnings(stderr);  // they may be why
      finish_files_after(error);
      throw;
    }
    progress.clear();
    return finish(reason);
  }

  void sample() {
    std::vector<double> row;
    simulation_.recorded.begin_row(simulation_.time());
    for (auto const& measure : scene_.measures) {
      double const value = measure.value(simulation_.now());
      auto& sampled = simulation_.sampled[measure.name];
      sampled.latest = value;
      if (!sampled.any || value > sampled.peak) sampled.peak = value, sampled.peak_time = simulation_.time();
      sampled.any = true;
      simulation_.recorded.add(measure.name, value);
      row.push_back(value);
    }
    for (auto const& name : scene::energy_names()) row.push_back(simulation_.now().energy(name));
    simulation_.recorded.add("energy kinetic", simulation_.now().energy("kinetic"));
    balance_.look();
    row.push_back(simulation_.step_limit().dt);
    row.push_back(static_cast<double>(simulation_.now().broken_joints()));
    history_->append(simulation_.time(), row);
    watch_.look(experiment_);
    contact_cost_.look(simulation_);
  }

  void save_checkpoint() {
    output::Checkpoint checkpoint;
    checkpoint.program = program_.name, checkpoint.version = FISSURE_VERSION;
    checkpoint.scene_hash = hash_, checkpoint.precision = experiment_.options.precision;
    checkpoint.dimension = program_.dimension;
    checkpoint.step = simulation_.step(), checkpoint.time = simulation_.time();
    for (auto const& [name, bytes] : simulation_.save()) checkpoint.put("state " + name, bytes);
    checkpoint.put("runner",
                   std::vector<double>{next_sample_, next_frame_, next_checkpoint_, balance_.turned_over(),
                                       static_cast<double>(history_->rows()), static_cast<double>(results_->frames())});
    checkpoint.put("energies at the start", balance_.start());
    checkpoint.put("watch", watch_.numbers());
    auto const put_text = [&](char const* name, std::string const& text) {
      checkpoint.put(name, std::vector<char>(text.begin(), text.end()));
    };
    put_text("scene text", scene_.text);
    // restart may be said anywhere
    put_text("scene file", std::filesystem::absolute(experiment_.options.scene).string());
    put_text("settings", settings_text(experiment_.options));
    for (auto const& [name, module] : scene_.modules) put_text(("module " + name).c_str(), module.text);
    output::save(output::checkpoint_path(folder_), checkpoint);
  }

  /// The run failed: what was written stays, and the last configuration that was good is added.
  void finish_files_after(std::exception const& error) {
    try {
      simulation_.step_back();
      results_->append(simulation_.frame(scene_.output.fields));
    } catch (std::exception const&) {
      // The disk may be what failed; the frames before are whole.
    }
    try {
      verdict_.findings = foreseen(experiment_);
      verdict_.findings.push_back({Grade::do_not_trust, "it failed", error.what()});
      fmt::print("verdict: {}\n", verdict_.line());
      std::fflush(stdout);
      results_->finish();
      history_->write_hdf5();
      write_record(std::string("failed: ") + error.what());
    } catch (std::exception const&) {
    }
  }

  int finish(std::string const& reason) {
    results_->finish();
    history_->write_hdf5();
    bool const complete = reason != "interrupted";
    if (complete) look_back();
    judge();
    write_record(reason);
    double const wall = seconds() - began_;
    long const steps = simulation_.step() - first_step_;
    fmt::print(
        "{}: {:.6g} s after {} steps of {} ({:.1f} s, {:.1f} ns per element and step)\n", reason, simulation_.time(),
        simulation_.step(), output::short_time(simulation_.step_limit().dt), wall,
        steps > 0 ? wall * 1e9 / static_cast<double>(steps) / static_cast<double>(simulation_.element_count()) : 0);
    fmt::print("{}{}", energy_table(simulation_.now(), balance_), contact_cost_.line(simulation_, timed_));
    say_warnings(stdout);
    for (auto const& doubt : doubts_) fmt::print("warning: {}\n", doubt);
    if (!checked_.empty()) fmt::print("expectations\n{}", checked_);
    fmt::print("{}", told_);
    fmt::print("verdict: {}{}\n", verdict_.line(),
               failed_ > 0 ? fmt::format("; but {} of {} expectations FAILED", failed_, scene_.expects.size()) : "");
    fmt::print("results in {}\n", folder_);
    if (reason != "end of time")
      fmt::print("go on with: {} restart {}{}\n", program_.name, folder_, complete ? " --time SECONDS" : "");
    std::fflush(stdout);
    if (!std::isfinite(balance_.off())) {
      fmt::print(stderr, "error: {}the balance of energy is not a number: a result of this run cannot be trusted\n",
                 scene_.run.source.prefix());
      return 2;
    }
    for (auto const& error : errors_) fmt::print(stderr, "error: {}\n", error);
    if (!errors_.empty()) return 2;
    return !complete ? 130 : failed_ > 0 || verdict_.grade() == Grade::do_not_trust ? 1 : 0;
  }

  /// What the scene expects and says of the finished run. A function of the script that fails now loses nothing else.
  void look_back() {
    for (auto const& expect : scene_.expects) {
      double value = std::numeric_limits<double>::quiet_NaN();
      try {
        value = expect.value(simulation_.now());
      } catch (Error const& error) {
        errors_.push_back(error.what());
      }
      bool const passed = value >= expect.least && value <= expect.most;
      failed_ += !passed;
      checked_ +=
          fmt::format("  {} {} = {:.6g} (expected {:.6g} to {:.6g}{})\n", passed ? "ok    " : "FAILED", expect.name,
                      value, expect.least, expect.most, expect.why.empty() ? "" : "; " + expect.why);
      output::Json expectation = output::Json::object();
      expectation["name"] = expect.name, expectation["value"] = value, expectation["least"] = expect.least,
      expectation["most"] = expect.most;
      expectation["passed"] = passed, expectation["why"] = expect.why;
      expectations_.push(expectation);
    }
    for (auto const& words : scene_.finishes) try {
        words(simulation_.now(), told_);
      } catch (Error const& error) {
        errors_.push_back(error.what());
        if (!told_.empty() && told_.back() != '\n') told_ += '\n';  // it may break off within a line
      }
  }

  /// What was found during the run.
  void say_warnings(std::FILE* to) const {
    auto const known = simulation_.warnings();
    for (std::size_t k = announced_; k < known.size(); ++k) fmt::print(to, "warning: {}\n", known[k]);
  }

  /// Which plates and walls have been touched so far.
  void note_touches() {
    for (std::size_t p = 0; p < plate_touched_.size(); ++p)
      plate_touched_[p] = plate_touched_[p] || !simulation_.now().plate_force(static_cast<int>(p)).isZero(0);
    for (std::size_t w = 0; w < wall_touched_.size(); ++w)
      wall_touched_[w] = wall_touched_[w] || !simulation_.now().wall_force(static_cast<int>(w)).isZero(0);
  }

  std::string imbalance_advice() const {
    for (auto const& body : scene_.bodies) {
      auto const& material = scene_.materials[body.material];
      if (!material.flow && std::holds_alternative<laws::Munjiza>(material.bulk))
        return fmt::format(
            "the law of body \"{}\", munjiza, has no stored energy where strain is large: neo_hookean has; else a "
            "smaller step may mend it",
            body.name);
    }
    return fmt::format("a smaller run{{ {} }} or some damping usually mends it",
                       scene_.run.dt ? "dt = " : "safety = 0.4");
  }

  /// What was foreseen and what the run showed, and what both say of it.
  void judge() {
    auto const softened = simulation_.softened();
    for (auto const& finding : foreseen(experiment_)) {
      bool const of_joints = finding.body >= 0;
      bool const counts = !of_joints || softened[static_cast<std::size_t>(finding.body)].taken > 0;
      if (of_joints && counts) doubts_.push_back(finding.why);
      if (counts && finding.what != "single precision")
        verdict_.findings.push_back(finding);  // of single precision the run shows how far things moved
    }
    for (auto const& finding : experiment_.unresolved_slip)
      if (auto const& joints = softened[static_cast<std::size_t>(finding.body)]; joints.by_slip > 0.1 * joints.taken) {
        doubts_.push_back(finding.why);
        verdict_.findings.push_back(finding);
      }
    auto const lonely = [&](auto const& rigid, std::vector<bool> const& touched, std::vector<bool> const& against,
                            char const* kind) {
      for (std::size_t i = 0; i < touched.size(); ++i)
        if (!touched[i])
          add({Grade::look_again, "never touched",
               fmt::format("{}{} \"{}\" was never {}", rigid[i].source.prefix(), kind, rigid[i].name,
                           against[i] ? "pressed: it only lay against a body at the start" : "touched")});
    };
    if (first_step_ == 0) {
      lonely(scene_.plates, plate_touched_, experiment_.contact.plates, "plate");
      lonely(scene_.walls, wall_touched_, experiment_.contact.walls, "wall");
    }
    if (!experiment_.contact.overlaps.empty() && balance_.at_start("contact") > 0.01 * balance_.turned_over())
      add({Grade::look_again, "overlap at the start", experiment_.contact.overlaps.front()});
    double const off = balance_.off(), allowed = scene_.run.allowed_residual;
    if (!(off < std::min(allowed, 0.025))) {
      if (!(off < allowed))
        doubts_.insert(doubts_.end(), experiment_.contact.overlaps.begin(), experiment_.contact.overlaps.end());
      add({off < allowed ? Grade::look_again : Grade::do_not_trust, "balance of energy",
           fmt::format("the balance of energy is off by {:.2g} % of the {}: {}{}", 100 * off, balance_.scale().second,
                       off < allowed ? "" : "do not trust this run; ", imbalance_advice())});
    }
    judge_removed();
    for (auto const& finding : watch_.findings(experiment_, std::max(balance_.turned_over(), 1e-300))) add(finding);
  }
  /// What crushed pieces took along, in energy or mass.
  void judge_removed() {
    if (simulation_.now().removed_pieces() == 0) return;
    double const energy = simulation_.now().energy("removed") / std::max(balance_.turned_over(), 1e-300),
                 mass = removed_share(simulation_.now()), most = std::max(energy, mass);
    if (most < 0.01) return;
    add({most < 0.05 ? Grade::look_again : Grade::do_not_trust, "crushed pieces",
         fmt::format(
             "{} crushed pieces were removed, with {:.3g} % of the mass and {:.3g} % of the energy turned over: "
             "what they would have done is missing; slower loading, or a law that stiffens as it is pressed "
             "(neo_hookean), crush fewer",
             simulation_.now().removed_pieces(), 100 * mass, 100 * energy)});
  }
  void add(Finding const& finding) {
    verdict_.findings.push_back(finding);
    doubts_.push_back(finding.why);
  }

  output::Json warnings_json() const {
    output::Json warnings = output::Json::array();
    for (auto const& warning : scene_.warnings) warnings.push(warning);
    for (auto const& warning : simulation_.warnings()) warnings.push(warning);
    for (auto const& warning : doubts_)
      if (std::find(scene_.warnings.begin(), scene_.warnings.end(), warning) == scene_.warnings.end())
        warnings.push(warning);
    return warnings;
  }
  void write_record(std::string const& reason) {
    output::Json record = output::Json::object();
    record_experiment(record, program_, experiment_);
    record["time step"]["dt"] = simulation_.step_limit().dt;
    record["time step"]["owner"] = simulation_.step_limit().owner;
    record["steps"] = simulation_.step();
    record["cells"] = simulation_.element_count();
    record["time"] = simulation_.time();
    record["finished"] = reason;
    double const wall = began_ > 0 ? seconds() - began_ : 0;
    record["wall seconds"] = wall;
    record["processor seconds"] = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;  // of all threads, with meshing
    long const steps = simulation_.step() - first_step_;
    if (steps > 0)
      record["ns per element-step"] =
          wall * 1e9 / static_cast<double>(steps) / static_cast<double>(simulation_.element_count());
    if (began_ > 0) record_state(record, simulation_, balance_);
    record["expectations"] = expectations_;
    output::Json errors = output::Json::array();
    if (!told_.empty()) record["told"] = told_;
    for (auto const& error : errors_) errors.push(error);
    if (!errors_.empty()) record["errors"] = errors;
    if (began_ > 0 && reason != "running") record["verdict"] = verdict_.json();
    record["frames"] = results_ ? results_->frames() : 0;
    record["warnings"] = warnings_json();
    output::write_run_json(folder_ + "/run.json", record);
  }

  Program const& program_;
  Experiment& experiment_;
  scene::Scene const& scene_;
  Simulation& simulation_;
  std::string folder_;
  std::unique_ptr<output::ResultFile> results_;
  std::unique_ptr<output::HistoryFile> history_;
  output::Json expectations_ = output::Json::array();
  int failed_ = 0;                   // of them
  std::string checked_, told_;       // as they are said; what the scene says
  std::vector<std::string> errors_;  // of functions that looked back
  Verdict verdict_;
  std::vector<bool> plate_touched_, wall_touched_;
  double next_sample_ = 0, next_frame_ = 0, next_checkpoint_ = 0, began_ = 0;
  EnergyBalance balance_{experiment_};
  ContactCost contact_cost_;
  long timed_ = 0;  // steps whose stages were timed
  long first_step_ = 0;
  std::vector<std::string> doubts_;
  std::size_t announced_ = simulation_.warnings().size();  // said before the first step
  output::RunLock lock_;
  std::string hash_ = scene_hash(experiment_);
  Watch watch_;
};

void announce(Program const& program, Experiment& experiment) {
  foresee(experiment);
  for (auto const& warning : experiment.scene.warnings) fmt::print(stderr, "warning: {}\n", warning);
  for (auto const& warning : experiment.simulation->warnings()) fmt::print(stderr, "warning: {}\n", warning);
  if (!experiment.options.quiet) fmt::print("{}\n", describe(program, experiment));
  std::fflush(stdout);
}

}  // namespace

int run(Program const& program, Options const& options) {
  Experiment experiment = prepare(program, options);
  experiment.simulation =
      program.make_simulation(experiment.device, experiment.scene, experiment.mesh, precision_of(options.precision));
  announce(program, experiment);
  std::string const stem = std::filesystem::path(options.scene).stem().string();
  return Runner(program, experiment, options.out.empty() ? stem + "-" + program.name : options.out).start();
}

int restart(Program const& program, std::string const& folder, Options const& options) {
  output::RunLock lock(folder);
  if (std::filesystem::is_directory(folder) && !std::filesystem::exists(output::checkpoint_path(folder)))
    throw Error(folder +
                ": no checkpoint has been written there; output{ checkpoint_every = ... } writes them during a run");
  auto const checkpoint = output::load(output::checkpoint_path(folder));
  if (checkpoint.dimension != program.dimension)
    throw Error(
        fmt::format("{}: the checkpoint was written by {}; restart it with that program?", folder, checkpoint.program));
  auto const text = [&](char const* name) {
    auto const letters = checkpoint.get<char>(name);
    return std::string(letters.begin(), letters.end());
  };
  Options stored = options;
  stored.scene = text("scene file");
  stored.precision = checkpoint.precision;
  stored.settings.clear();
  std::istringstream settings(text("settings"));
  for (std::string line; std::getline(settings, line);) stored.settings.push_back(setting_of(line));
  StoredScene scene{text("scene text"), {}};
  for (auto const& [name, blob] : checkpoint.blobs)
    if (name.rfind("module ", 0) == 0) scene.modules[name.substr(7)].text = text(name.c_str());
  Experiment experiment = prepare(program, stored, scene);
  auto const warn_if_changed = [](std::string const& file, std::string const& began_with) {
    if (std::ifstream now(file); now && std::string(std::istreambuf_iterator<char>(now), {}) != began_with)
      fmt::print(stderr, "warning: {} has changed since; the run goes on with what it was begun with\n", file);
  };
  warn_if_changed(stored.scene, scene.text);
  for (auto const& [name, module] : experiment.scene.modules)
    if (!module.file.empty()) warn_if_changed(module.file, module.text);
  experiment.simulation =
      program.make_simulation(experiment.device, experiment.scene, experiment.mesh, precision_of(stored.precision));
  if (scene_hash(experiment) != checkpoint.scene_hash)
    throw Error(folder +
                ": the checkpoint's scene does not read as it did when the run began (its mesh file has changed?)");
  if (options.until > 0 && options.until <= checkpoint.time)
    throw Error(fmt::format("--time {:.6g}: the run in {} is already at {:.6g} s; give a later time", options.until,
                            folder, checkpoint.time));
  announce(program, experiment);
  fmt::print("goes on from {:.6g} s, step {}\n", checkpoint.time, checkpoint.step);
  return Runner(program, experiment, folder).go_on(checkpoint, std::move(lock));
}

}  // namespace fissure::app
