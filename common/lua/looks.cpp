// What is looked at and for how long: measures, plots, output, expectations, the run.
#include <fmt/format.h>

#include <cmath>

#include "lua/reader.h"

namespace fissure::lua {
namespace {

std::vector<std::string> measure_names(Script const& script) {
  std::vector<std::string> names;
  for (auto const& measure : script.scene.measures) names.push_back(measure.name);
  return names;
}

std::string unknown_measure(Script const& script, std::string const& name) {
  return fmt::format("no measure is called {}{}", in_quotes(name), suggestion(name, measure_names(script)));
}

/// Everything is zero and nothing has happened yet: enough to find misspelt names before a run starts.
class Rest final : public scene::Now {
 public:
  double time() const override { return 0; }
  long step() const override { return 0; }
  Vec3 plate_force(int) const override { return Vec3::Zero(); }
  Vec3 plate_displacement(int) const override { return Vec3::Zero(); }
  Vec3 wall_force(int) const override { return Vec3::Zero(); }
  double energy(std::string const&) const override { return 0; }
  Vec3 displacement(int, Vec3 const&) const override { return Vec3::Zero(); }
  Vec3 velocity(int, Vec3 const&) const override { return Vec3::Zero(); }
  std::array<double, 6> stress(int, Vec3 const&) const override { return {}; }
  Vec3 mean_velocity(int) const override { return Vec3::Zero(); }
  Vec3 reaction(int) const override { return Vec3::Zero(); }
  double torque(int) const override { return 0; }
  Vec3 contact_force(int, int) const override { return Vec3::Zero(); }
  scene::Touch touch(int, int) const override { return {}; }
  double pull(int) const override { return 0; }
  Vec3 tie_force(int) const override { return Vec3::Zero(); }
  double crack_area() const override { return 0; }
  double crack_energy() const override { return 0; }
  long broken_joints() const override { return 0; }
  long removed_pieces() const override { return 0; }
  double removed_mass() const override { return 0; }
  std::vector<scene::Fragment> fragments(int) const override { return std::vector<scene::Fragment>(100); }
  double field(std::string const&, int, Vec3 const&) const override { return 0; }
  double average(std::string const&, int, std::function<bool(double, double, double)> const& inside) const override {
    if (inside) inside(0, 0, 0);
    return 0;
  }
  std::array<Vec3, 2> bounds(int) const override { return {Vec3::Zero(), Vec3::Zero()}; }
  double extreme(std::string const&) const override { return 0; }
  std::optional<double> latest(std::string const&) const override { return 0; }
  std::optional<double> peak(std::string const&) const override { return 0; }
  std::optional<double> peak_time(std::string const&) const override { return 0; }
  std::optional<double> mean(std::string const&, double) const override { return 0; }
  bool at_rest(double) const override { return false; }
};

int measure(Script& script, Form& form) {
  scene::Measure measure;
  form.name(measure.name, 0, Need::required,
            "its name: a column of the history, and now.<name>; no question that now answers already");
  Callee callee;
  bool const given = form.function("[]", callee, "function(now)", "returns the number", Need::required);
  form.text("unit", measure.unit, "for the axis of a plot", Need::optional);
  if (form.listing()) return 0;
  for (auto const& word : now_entries())
    if (measure.name == word.name)
      form.problem(fmt::format("now.{} means something already; choose another name", measure.name));
  if (measure.name == ".") form.problem("\".\" is no name that results can be stored under; choose another name");
  // A slash would be a group in history.h5 and becomes a bar there.
  auto const stored = [](std::string name) {
    std::replace(name.begin(), name.end(), '/', '|');
    return name;
  };
  for (auto const& [column, unit] : scene::standard_columns())
    if (stored(measure.name) == column)
      form.problem(fmt::format("the history has a column \"{}\" already; choose another name", column));
  for (auto const& other : script.scene.measures)
    if (measure.name != other.name && stored(measure.name) == stored(other.name))
      form.problem(fmt::format("is stored under the same name as measure \"{}\" ({}); choose another name", other.name,
                               stored(other.name)));
  form.claim(measure.name);
  form.done();
  measure.source = form.source();
  measure.value = [&script, callee](scene::Now const& now) {
    double const value = script.ask_measure(callee, now);
    if (!std::isfinite(value))
      throw Error(callee.source, fmt::format("{} is {} at t = {} s", callee.what,
                                             std::isnan(value) ? "nan" : "infinite", shown(now.time())));
    return value;
  };
  if (given) script.rehearse([&script, callee](scene::Now const& now) { script.ask_measure(callee, now); });
  script.scene.measures.push_back(measure);
  return 0;
}

int plot(Script& script, Form& form) {
  scene::Plot plot;
  plot.against = "time";
  form.name(plot.name, 0, Need::required, "the measure");
  form.text("against", plot.against, "\"time\" (the default) or another measure", Need::optional);
  if (form.listing()) return 0;
  form.done();
  plot.source = form.source();
  script.scene.plots.push_back(plot);
  script.checks.push_back([&script, plot] {
    if (!script.knows("measure", plot.name)) script.problem(plot.source, "plot: " + unknown_measure(script, plot.name));
    if (plot.against != "time" && !script.knows("measure", plot.against))
      script.problem(plot.source,
                     fmt::format("plot {}: against: {}", in_quotes(plot.name), unknown_measure(script, plot.against)));
  });
  return 0;
}

int output(Script& script, Form& form) {
  auto& output = script.scene.output;
  form.number("every", output.every, positive("s"), "time between two frames; 0: the first and the last only");
  form.number("measure_every", output.measure_every, positive("s"),
              "time between two rows of the history; 0: a thousandth of the run");
  form.number("checkpoint_every", output.checkpoint_every, positive("s"),
              "time between two checkpoints; 0: only at the end");
  form.words("fields", output.fields, scene::output_fields(), "what frames hold");
  if (form.listing()) return 0;
  if (script.said["output"] > 1) form.problem("is said a second time; a scene has one");
  form.done();
  return 0;
}

int run(Script& script, Form& form) {
  scene::Run run;
  form.number("time", run.time, positive("s", 1e-9, 1e5), "how long", Need::required);
  form.number("dt", run.dt, positive("s"), "time step; left out: found automatically");
  form.number("safety", run.safety, {"", 0, 1, 0.05, 1, true, false}, "share of the largest stable step");
  Callee stop;
  if (form.function("stop", stop, "function(now)", "true ends the run early", Need::optional)) {
    run.stop = [&script, stop](scene::Now const& now) { return script.ask_stop(stop, now); };
    script.rehearse(run.stop);
  }
  form.number("mass_damping", run.mass_damping, not_negative("1/s"), "alpha of the damping force alpha m v");
  form.number("mass_scaling", run.mass_scaling, {"", 1, unlimited, 1, 1e4},
              "factor on every inertia, not on weights: larger steps, for slow loading only");
  form.number("allowed_residual", run.allowed_residual, {"", 0, unlimited, 0, 1, true, false},
              "energy that may be missing or too much at the end, as a share of the ledger's largest term, or of the "
              "energy turned over where that differs; from it on the exit status is 1");
  std::string crushed = "stop";
  form.word(
      "crushed", crushed, {"stop", "remove"},
      "\"stop\": a cell that turns inside out ends the run; \"remove\": a lone one (a simplex that no joint holds any "
      "more) leaves when it is pressed to a tenth of its volume, with all that it holds, which the ledger's `removed` "
      "books");
  run.remove_crushed = crushed == "remove";
  if (form.listing()) return 0;
  if (script.said["run"] > 1) form.problem("is said a second time; a scene has one");
  form.done();
  run.source = form.source();
  script.scene.run = run;
  return 0;
}

int expect(Script& script, Form& form) {
  scene::Expect expect;
  form.name(expect.name, 0, Need::required, "what is expected; with `of`, a measure");
  Callee callee;
  bool const computed =
      form.function("value", callee, "function(now)", "returns the number, after the run", Need::optional);
  std::string of;
  form.declare("of", "\"peak\" or \"last\"", {}, "left out", "instead of value: the measure's largest or last value");
  bool const measured = form.type_of("of") != LUA_TNIL && form.word("of", of, {"peak", "last"}, "");
  std::optional<double> equals, tolerance;
  form.number("equals", equals, any_number(""), "the number it must be");
  form.number("tolerance", tolerance, not_negative(""), "how far from it may be, in the same unit");
  bool const range = form.interval("within", expect.least, expect.most, "instead of equals: where it must lie");
  form.text("why", expect.why, "where the number comes from", Need::required);
  if (form.listing()) return 0;
  if (form.type_of("value") == LUA_TNIL && form.type_of("of") == LUA_TNIL)
    form.problem("says not what to look at; write of = \"peak\", of = \"last\" or value = function(now)");
  if (computed && measured) form.problem("has both value and of; one is enough");
  if (range && equals) form.problem("has both equals and within; one is enough");
  if (form.type_of("within") == LUA_TNIL && form.type_of("equals") == LUA_TNIL)
    form.problem("says no number; write equals = ..., tolerance = ... or within = { least, most }");
  if (equals && !tolerance && form.type_of("tolerance") == LUA_TNIL)
    form.problem("tolerance is missing (equals needs one)");
  if (equals && tolerance) expect.least = *equals - *tolerance, expect.most = *equals + *tolerance;
  form.done();
  expect.source = form.source();
  if (computed) {
    expect.value = [&script, callee](scene::Now const& now) { return script.ask_measure(callee, now); };
    script.rehearse(expect.value);
  } else {
    expect.value = [expect, peak = of == "peak"](scene::Now const& now) {
      auto const value = peak ? now.peak(expect.name) : now.latest(expect.name);
      if (!value)
        throw Error(expect.source, fmt::format("expect {}: the measure has no value", in_quotes(expect.name)));
      return *value;
    };
  }
  if (measured)
    script.checks.push_back([&script, name = expect.name, at = expect.source] {
      if (!script.knows("measure", name)) script.problem(at, "expect: " + unknown_measure(script, name));
    });
  script.scene.expects.push_back(expect);
  return 0;
}

int finish(Script& script, Form& form) {
  Callee callee;
  bool const given =
      form.function("[]", callee, "function(now)",
                    "what it prints is said at the end of a run, unless that is interrupted", Need::required);
  if (form.listing()) return 0;
  form.done();
  if (!given) return 0;
  auto const told = [&script, callee](scene::Now const& now, std::string& words) {
    script.ask_words(callee, now, words);
  };
  script.checks.push_back([&script, told] {  // what it makes of numbers that do not exist yet is no mistake
    std::string words;
    try {
      told(Rest{}, words);
    } catch (Error const& error) {
      std::string const what = error.what();
      if (what.find(" now.") != std::string::npos || what.find("unknown name") != std::string::npos)
        script.problem({}, what);
    }
  });
  script.scene.finishes.push_back(told);
  return 0;
}

int study(Script& script, Form& form) {
  scene::Study study;
  form.name(study.measure, 0, Need::required, "the measure whose error is asked for");
  form.words("vary", study.vary, {},
             "what is varied, each \"NAME=A,B,C\": a param, a key of all tables of a verb, precision or dimension");
  form.word("of", study.of, {"peak", "last", "mean", "least"}, "which of its values");
  form.declare("reference", "number or text", {}, "\"finest\"",
               "the right answer: a number, \"finest\", \"limit\" or \"NAME=VALUE\"");
  if (double number = 0; form.type_of("reference") == LUA_TNUMBER) {
    if (form.number("reference", number, any_number(""), "")) study.reference = fmt::format("{}", number);
  } else if (form.type_of("reference") != LUA_TNIL) {
    form.text("reference", study.reference, "", Need::optional);
  }
  form.number("tolerance", study.tolerance, {"%", 0, unlimited, 0.01, 20, true, false},
              "what is good enough, in per cent");
  if (form.listing()) return 0;
  if (script.said["study"] > 1) form.problem("is said a second time; a scene has one");
  if (study.vary.empty() && form.type_of("vary") == LUA_TNIL)
    form.problem("says not what to vary; write vary = { \"NAME=A,B,C\" }");
  form.done();
  script.checks.push_back([&script, study, at = form.source()] {
    if (!script.knows("measure", study.measure)) script.problem(at, "study: " + unknown_measure(script, study.measure));
    std::vector<std::string> known{"precision", "dimension"};
    for (auto const& parameter : script.scene.parameters) known.push_back(parameter.name);
    for (auto const& axis : study.vary) {
      std::string const name = axis.substr(0, axis.find('='));
      if (axis.find('=') == std::string::npos || axis.back() == '=')
        script.problem(at, fmt::format("study: vary has {}; write \"NAME=A,B,C\"", in_quotes(axis)));
      else if (name.find('.') == std::string::npos && std::find(known.begin(), known.end(), name) == known.end())
        script.problem(at, fmt::format("study: vary: unknown {} (known: {}, and keys like run.safety){}",
                                       in_quotes(name), fmt::join(known, ", "), suggestion(name, known)));
    }
  });
  script.scene.study = study;
  return 0;
}

}  // namespace

void Script::rehearse(std::function<void(scene::Now const&)> function) {
  checks.push_back([this, function = std::move(function)] {
    try {
      function(Rest{});
    } catch (Error const& error) {
      problem({}, error.what());
    }
  });
}

std::vector<Verb> look_verbs() {
  return {
      {"measure", "A number that is recorded while the experiment runs.",
       "measure{ \"load\", unit = \"N\", function(now) return now.force(top) end }", "", measure},
      {"plot", "A picture of a measure.", "plot{ \"load\", against = \"time\" }", "", plot},
      {"output", "What is written down, and how often.", "output{ every = 20*us, fields = { \"stress\", \"damage\" } }",
       "", output},
      {"expect", "A number that the finished run must show.",
       "expect{ \"load\", of = \"peak\", within = { 4*kN, 6*kN }, why = \"a published test\" }", "", expect},
      {"finish",
       "What is said of a finished run: all that the function prints, on the terminal, in run.json (`told`) and on the "
       "page of the run.",
       "finish{ function(now) print(string.format(\"%.1f kN\", now.peak(\"load\")/kN)) end }", "", finish},
      {"study", "What scripts/study varies and measures when its command line does not say; a run takes no notice.",
       "study{ \"load\", vary = { \"h=4,2,1\", \"precision=double,single\" }, reference = \"limit\" }", "", study},
      {"run", "How long, and how.", "run{ time = 2*ms }", "", run},
  };
}

}  // namespace fissure::lua
