// material{ fracture = }: how a material breaks, and softening curves of a user's own.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lua/reader.h"

namespace fissure::lua {
namespace {

using Points = std::vector<std::array<double, 2>>;  // { gap beyond the peak [m], traction [Pa] }

/// What one curve must agree with.
struct Mode {
  char const *key, *strength_key, *energy_key;
  double strength, energy;  // [Pa], [J/m2]
};

/// What is wrong with a curve, or "".
std::string fault_of(Points const& curve, Mode const& mode) {
  if (curve.size() < 2) return "needs two points at least";
  if (curve[0][0] != 0)
    return fmt::format("begins at {:g} m; gaps are counted from the peak, so the first one must be 0", curve[0][0]);
  if (std::abs(curve[0][1] / mode.strength - 1) > 0.01)
    return fmt::format("begins at {:g} Pa, and {} is {:g} Pa; they must be the same", curve[0][1], mode.strength_key,
                       mode.strength);
  double area = 0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    auto const &a = curve[i - 1], &b = curve[i];
    if (!(b[0] > a[0])) return fmt::format("has the gap {:g} m after {:g} m; gaps must rise", b[0], a[0]);
    if (!(b[1] <= a[1]))
      return fmt::format("rises from {:g} to {:g} Pa at a gap of {:g} m; it may only fall", a[1], b[1], b[0]);
    area += (a[1] + b[1]) / 2 * (b[0] - a[0]);
  }
  if (curve.back()[1] != 0)
    return fmt::format("ends at {:g} Pa; where nothing holds any more it must be 0", curve.back()[1]);
  if (std::abs(area / mode.energy - 1) > 0.02)
    return fmt::format("encloses {:.4g} J/m2, and {} = {:g} J/m2; they must be the same to 2 %", area, mode.energy_key,
                       mode.energy);
  return "";
}

laws::Softening through(Points curve) {
  while (curve.size() > 2 && curve[curve.size() - 2][1] == 0)
    curve.pop_back();  // it is broken where nothing holds for the first time
  double const end = curve.back()[0], strength = curve[0][1];
  for (auto& [gap, traction] : curve) gap /= end, traction /= strength;
  return laws::Softening::through(curve);
}

constexpr double nothing = 1e-3;  // share of the strength at which a function has ended: an exponential never gets to 0

/// A function of the gap, sampled up to where nothing is left for the first time.
Points sampled(std::function<double(double)> const& traction, Mode const& mode, std::string& fault) {
  double const length = mode.energy / mode.strength, least = nothing * mode.strength;
  double end = 0.1 * length, holds = 0;
  while (traction(end) > least && end < 100 * length) holds = end, end *= 1.2;
  if (traction(end) > least) {
    fault = fmt::format(
        "is still {:g} Pa at a gap of {:.3g} m, a hundred times {}/{}; it must fall to 0.1 % of the strength",
        traction(end), end, mode.energy_key, mode.strength_key);
    return {};
  }
  while (end - holds > 1e-6 * end) (traction(0.5 * (holds + end)) > least ? holds : end) = 0.5 * (holds + end);
  double const top = traction(0);
  auto const curve = laws::Softening::sampled([&](double share) { return traction(share * end) / top; });
  Points points;
  for (int i = 0; i < curve.points; ++i)
    points.push_back({end * static_cast<double>(curve.damage[i]), top * static_cast<double>(curve.share[i])});
  return points;
}

/// A name, a list of points or a function.
bool softening(Script& script, Form& part, Mode const& mode, char const* fallback, laws::Softening& to) {
  part.declare(
      mode.key, "text, list of { gap, traction } or function(gap)", {}, fallback,
      fmt::format(
          "how the strength falls over the gap beyond the peak, to enclose {}: \"munjiza\", \"linear\", \"bilinear\" "
          "or \"exponential\", points (m, Pa) whose shape is taken, or a function that returns a traction",
          mode.energy_key));
  std::string fault;
  Points points;
  int const type = part.type_of(mode.key);
  bool const known = mode.strength > 0 && mode.energy > 0;  // else they have a problem of their own
  if (type == LUA_TFUNCTION) {
    Callee callee;
    if (!part.function(mode.key, callee, "function(gap)", "", Need::required) || !known) return false;
    try {
      points = sampled([&](double gap) { return script.ask_curve(callee, gap, "a gap of {} m", "a traction in Pa"); },
                       mode, fault);
    } catch (Error const& error) {
      script.problem({}, error.what());
      return false;
    }
  } else if (type == LUA_TTABLE) {
    if (!part.points(mode.key, points, "") || !known) return false;
    if (points.size() > laws::Softening::most)
      fault = fmt::format("has {} points; at most {} are kept", points.size(), laws::Softening::most);
  } else if (type != LUA_TNIL && type != LUA_TSTRING) {
    part.problem(fmt::format("{} must be a text, a list of {{ gap, traction }} or a function(gap)", mode.key),
                 mode.key);
    return false;
  } else {
    std::string name = "munjiza";
    bool const given = part.word(mode.key, name, laws::Softening::names(), "");
    if (given) to = laws::Softening::named(name);
    return given;
  }
  if (fault.empty()) fault = fault_of(points, mode);
  if (!fault.empty())
    part.problem(std::string(mode.key) + " " + fault, mode.key);
  else
    to = through(points);
  return true;
}

}  // namespace

double Script::ask_curve(Callee const& callee, double x, char const* at, char const* what) {
  lua_State* const L = state();
  return ask(
      callee, [&] { return lua_pushnumber(L, x), 1; },
      [&] {
        std::string const where = fmt::format(fmt::runtime(at), shown(x));
        if (lua_type(L, -1) != LUA_TNUMBER)
          throw Error(callee.source, fmt::format("{} returned a {} at {}; it must return {}", callee.what,
                                                 luaL_typename(L, -1), where, what));
        double const value = lua_tonumber(L, -1);
        if (!std::isfinite(value))
          throw Error(callee.source, fmt::format("{} returned {} at {}", callee.what,
                                                 std::isnan(value) ? "nan" : shown(value), where));
        return value;
      });
}

namespace {

/// What is wrong with factors over speeds, or "".
std::string fault_of_rates(Points const& curve) {
  if (curve.size() < 2) return "needs two points at least";
  if (curve[0][0] != 0 || std::abs(curve[0][1] - 1) > 1e-6)
    return fmt::format(
        "begins with a factor of {:g} at {:g} m/s; it must be 1 at 0 m/s, where the material's strengths hold",
        curve[0][1], curve[0][0]);
  for (std::size_t i = 1; i < curve.size(); ++i) {
    if (!(curve[i][0] > curve[i - 1][0]))
      return fmt::format("has the speed {:g} m/s after {:g} m/s; speeds must rise", curve[i][0], curve[i - 1][0]);
    if (!(curve[i][1] >= curve[i - 1][1]))
      return fmt::format("falls from {:g} to {:g} at {:g} m/s; strength may only grow with the speed", curve[i - 1][1],
                         curve[i][1], curve[i][0]);
  }
  if (curve.back()[1] > 100)
    return fmt::format("reaches a factor of {:g} at {:g} m/s; at most 100 is allowed", curve.back()[1],
                       curve.back()[0]);
  return "";
}

/// Points or a function.
void read_rate(Script& script, Form& part, laws::RateFactor& to) {
  part.declare("rate", "list of { speed, factor } or function(speed)", {}, "left out",
               "how many times as strong a joint is whose gap grows at a speed (m/s): points from { 0, 1 } on, or a "
               "function, sampled from 1e-4 to 1e3 m/s; fracture energies are its square times those at rest");
  int const type = part.type_of("rate");
  Points points;
  std::string fault;
  if (type == LUA_TNIL) return;
  if (type == LUA_TFUNCTION) {
    Callee callee;
    if (!part.function("rate", callee, "function(speed)", "", Need::required)) return;
    try {
      auto const at = [&](double speed) {
        points.push_back({speed, script.ask_curve(callee, speed, "a speed of {} m/s", "a factor")});
      };
      at(0);
      for (int i = 0; i <= 7 * 8; ++i) at(std::pow(10.0, -4 + i / 8.0));
    } catch (Error const& error) {
      return script.problem({}, error.what());
    }
  } else if (type != LUA_TTABLE) {
    return part.problem("rate must be a list of { speed, factor } or a function(speed)", "rate");
  } else if (!part.points("rate", points, "")) {
    return;
  }
  fault = points.size() > laws::RateFactor::most
              ? fmt::format("has {} points; at most {} are kept", points.size(), laws::RateFactor::most)
              : fault_of_rates(points);
  if (!fault.empty()) return part.problem("rate " + fault, "rate");
  to = laws::RateFactor::through(points);
}

void read_scatter(Form& part, std::optional<scene::Scatter>& to) {
  scene::Scatter scatter;
  double seed = 0;
  if (!part.part("scatter",
                 "Weibull's scatter of strengths: every joint has s times the strengths and s^2 times the fracture "
                 "energies, s of mean 1; left out: all joints are alike",
                 [&](Form& form) {
                   form.number("modulus", scatter.modulus, {"", 1, 1e4, 2, 200},
                               "Weibull's modulus m; a tenth of scatter is about m = 12", Need::required);
                   form.number("area", scatter.area, positive("m2"),
                               "of a face that has the material's strengths on average: others have (area of "
                               "face/area)^(-1/m) times as much; left out: any face");
                   form.number("seed", seed, {"", 0, 4294967295.0}, "another number, other strengths");
                   if (!form.listing() && seed != std::floor(seed))
                     form.problem("scatter.seed must be a whole number", "seed");
                 }))
    return;
  scatter.seed = static_cast<unsigned>(seed);
  to = scatter;
}

}  // namespace

void read_fracture(Script& script, Form& part, laws::CohesiveJoint& joint, std::optional<scene::Scatter>& scatter) {
  part.parameters(joint);
  if (!part.listing()) {  // as it was called up to November 2026
    part.declare("law", "", {}, "", "");
    if (part.type_of("law") != LUA_TNIL)
      part.problem(
          "law is no key of fracture any more: softening says how the strength falls (\"munjiza\", \"linear\", ...)",
          "law");
  }
  std::string mixed = "ellipse";
  part.word("mixed", mixed, {"ellipse", "independent"},
            "opening and slip at once. ellipse: (sigma/tension)^2 + (tau/shear)^2 = 1 at the peak, W1/G1 + W2/G2 = 1 "
            "at separation; independent: each has its full strength, as in the classical combined method; a joint at "
            "45 degrees is then 1.41 times as strong and takes 1.41 times the energy or more");
  std::string criterion = "rankine";
  bool const chosen = part.word(
      "criterion", criterion, {"rankine", "traction"},
      "when a joint begins to open. rankine: where it carries what its face carries when the largest principal stress "
      "beside it is tension, if the face lies within 60 degrees across that, too; it then takes G1 times the area "
      "across the tension. traction: by the traction on its face alone, so that faces askew to a crack make a body too "
      "strong and too tough. With mixed = \"independent\" always traction");
  std::string insertion = "intrinsic";
  part.word("insertion", insertion, {"intrinsic", "adaptive"},
            "when joints are there. intrinsic: from the start, on every face, so that the body is softer by "
            "1/(1 + E/penalty); adaptive: inserted where the stress beside a face reaches its strength, carrying the "
            "traction that is there; until then the body is whole, so that what opens needs no more than 2 E (what "
            "slips under pressure: 20 E) and "
            "steps stay long. A bond's are always there");
  bool const slides = part.type_of("shear_softening") != LUA_TNIL;
  softening(script, part, {"softening", "tension", "G1", joint.tension, joint.G1}, "\"munjiza\"", joint.opens);
  softening(script, part, {"shear_softening", "shear", "G2", joint.shear, joint.G2}, "as softening", joint.slides);
  read_rate(script, part, joint.faster);
  read_scatter(part, scatter);
  if (part.listing()) return;
  if (!slides) joint.slides = joint.opens;
  joint.independent = mixed == "independent";
  joint.inserted = insertion == "adaptive";
  joint.rankine = criterion == "rankine" && !joint.independent;
  if (chosen && criterion == "rankine" && joint.independent)
    part.problem(
        "criterion = \"rankine\" needs mixed = \"ellipse\" (\"independent\" is the classical method, which goes by "
        "tractions)",
        "criterion");
}

}  // namespace fissure::lua
