// material{ plastic = }: how a material flows, and yield stresses as tables.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lua/reader.h"

namespace fissure::lua {
namespace {

/// Curves as laws::Curves reads them: rising strains, logarithms of rising rates, yield stresses rate by rate.
struct Table {
  std::vector<double> strains, ln_rates;
  std::vector<std::vector<double>> stresses;

  std::vector<double> numbers() const {
    std::vector<double> all = strains;
    all.insert(all.end(), ln_rates.begin(), ln_rates.end());
    for (auto const& curve : stresses) all.insert(all.end(), curve.begin(), curve.end());
    return all;
  }
};

double along(std::vector<std::array<double, 2>> const& points, double x) {
  auto const next =
      std::upper_bound(points.begin(), points.end(), x, [](double at, auto const& p) { return at < p[0]; });
  if (next == points.begin()) return points.front()[1];
  if (next == points.end()) return points.back()[1];
  auto const& a = *(next - 1);
  auto const& b = *next;
  return a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]);
}

/// What is wrong with a curve, or "".
std::string fault_of(Curve const& curve) {
  auto const& p = curve.points;
  if (p[0][0] != 0) return fmt::format("begins at a plastic strain of {:g}; the first one must be 0", p[0][0]);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!(p[i][1] > 0))
      return fmt::format("has a yield stress of {:g} Pa at a plastic strain of {:g}; it must lie above 0", p[i][1],
                         p[i][0]);
    if (i == 0) continue;
    if (!(p[i][0] > p[i - 1][0]))
      return fmt::format("has the plastic strain {:g} after {:g}; strains must rise", p[i][0], p[i - 1][0]);
    if (p[i][1] < p[i - 1][1])
      return fmt::format(
          "falls from {:g} to {:g} Pa at a plastic strain of {:g}; a yield stress may not fall (softening is the part "
          "of fracture)",
          p[i - 1][1], p[i][1], p[i][0]);
  }
  return "";
}

/// All curves over the strains of all of them: no point is lost, they stay straight between their own.
Table joined(std::vector<Curve> const& curves) {
  Table table;
  for (auto const& curve : curves)
    for (auto const& p : curve.points) table.strains.push_back(p[0]);
  std::sort(table.strains.begin(), table.strains.end());
  table.strains.erase(std::unique(table.strains.begin(), table.strains.end()), table.strains.end());
  for (auto const& curve : curves) {
    table.ln_rates.push_back(curve.at > 0 ? std::log(curve.at) : -700);
    auto& stresses = table.stresses.emplace_back();
    for (double strain : table.strains) stresses.push_back(along(curve.points, strain));
  }
  return table;
}

/// A function sampled so that straight lines between its samples are right to `tolerance` of its value.
class Sampler {
 public:
  static constexpr double slowest = -9.210340371976182, fastest = 18.420680743952367;  // ln of 1e-4 and 1e8 per second
  static constexpr std::size_t most = 4000;

  Sampler(std::function<double(double, double)> f, double tolerance, double strain_to)
      : f_(std::move(f)), tolerance_(tolerance), strain_to_(strain_to) {}

  Table table() {
    Table t;
    t.ln_rates = {slowest};
    if (knows_rates()) {
      t.ln_rates = refined(slowest, fastest, 1e-3, [&](double ln_rate) {
        std::vector<double> values;
        for (double strain : {0.0, 0.01, 0.1, 1.0}) values.push_back(at(strain * strain_to_, ln_rate));
        return values;
      });
    }
    t.strains = refined(0, strain_to_, 1e-9 * strain_to_, [&](double strain) {
      std::vector<double> values;
      for (std::size_t k = 0; k < t.ln_rates.size(); k += std::max<std::size_t>(1, t.ln_rates.size() / 3))
        values.push_back(at(strain, t.ln_rates[k]));
      return values;
    });
    for (double ln_rate : t.ln_rates) {
      auto& curve = t.stresses.emplace_back();
      for (double strain : t.strains) curve.push_back(at(strain, ln_rate));
    }
    return t;
  }

  /// Largest relative difference between table and function at places of neither's choice.
  double error(laws::Curves const& curves) {
    std::mt19937 random(1);
    auto const number = [&] { return static_cast<double>(random()) / 4294967296.0; };
    double largest = 0;
    for (int i = 0; i < 300; ++i) {
      double const strain = strain_to_ * std::pow(number(), 4), ln_rate = slowest + number() * (fastest - slowest);
      double const exact = at(strain, ln_rate);
      largest = std::max(largest, std::abs(curves.yield(strain, std::exp(ln_rate), 0.0).stress / exact - 1));
    }
    return largest;
  }

 private:
  double at(double strain, double ln_rate) { return f_(strain, std::exp(ln_rate)); }
  bool knows_rates() {
    for (double strain : {0.0, 0.1, 1.0})
      for (double ln_rate = slowest; ln_rate < fastest; ln_rate += 2.3)
        if (at(strain * strain_to_, ln_rate) != at(strain * strain_to_, slowest)) return true;
    return false;
  }
  template <class Values>
  std::vector<double> refined(double from, double to, double shortest, Values values) {
    std::vector<double> points{from, to};
    std::vector<std::vector<double>> known{values(from), values(to)};
    for (std::size_t i = 0; i + 1 < points.size();) {
      double const middle = 0.5 * (points[i] + points[i + 1]);
      auto const there = values(middle);
      double worst = 0;
      for (std::size_t k = 0; k < there.size(); ++k)
        worst = std::max(worst, std::abs(0.5 * (known[i][k] + known[i + 1][k]) / there[k] - 1));
      bool const coarse = points[i + 1] - points[i] > (to - from) / 8;  // a wave between two samples would not be seen
      if ((worst > 0.5 * tolerance_ || coarse) && points[i + 1] - points[i] > shortest && points.size() < most) {
        points.insert(points.begin() + static_cast<long>(i) + 1, middle);
        known.insert(known.begin() + static_cast<long>(i) + 1, there);
      } else {
        ++i;
      }
    }
    return points;
  }

  std::function<double(double, double)> f_;
  double tolerance_, strain_to_;
};

/// Whether curves by rate may be those of a yield stress; says what is wrong.
bool sound(Form& part, std::vector<Curve> const& given) {
  for (std::size_t k = 0; k < given.size(); ++k) {
    std::string const which = given.size() > 1 ? fmt::format(" at rate {:g}", given[k].at) : "";
    if (std::string const fault = fault_of(given[k]); !fault.empty())
      return part.problem(fmt::format("yield{} {}", which, fault), "yield"), false;
    if (given[k].at < 0 || (given[k].at == 0 && given.size() > 1))
      return part.problem(fmt::format("yield has a rate of {:g}; between rates it is straight in their logarithm, so "
                                      "they must lie above 0",
                                      given[k].at),
                          "yield"),
             false;
    if (double const least = given[k].points[0][1];
        least < 1e3 && part.type_of("yield") != LUA_TNUMBER)  // a number has had its warning
      part.warning(
          fmt::format("yield{} begins at {:g} Pa; usual yield stresses are from 1000 Pa on (in Pa?)", which, least),
          "yield");
    if (k == 0) continue;
    if (!(given[k].at > given[k - 1].at))
      return part.problem(fmt::format("yield has two curves at rate {:g}", given[k].at), "yield"), false;
    for (auto const* curve : {&given[k], &given[k - 1]})
      for (auto const& p : curve->points)
        if (along(given[k].points, p[0]) < along(given[k - 1].points, p[0]) * (1 - 1e-12))
          return part.problem(fmt::format("yield{} lies below that at rate {:g} at a plastic strain of {:g}; it may "
                                          "not fall with the rate",
                                          which, given[k - 1].at, p[0]),
                              "yield"),
                 false;
  }
  return true;
}

/// Slope beyond a sampled function's last strain, and how far the table is off.
void say_how_close(Form& part, Sampler sampler, Table const& table, double tolerance, scene::Flow& flow,
                   laws::Curves& curves) {
  auto const& last = table.stresses[0];
  std::size_t const n = last.size();
  curves.beyond = (last[n - 1] - last[n - 2]) / (table.strains[n - 1] - table.strains[n - 2]);
  curves.numbers = flow.curves.data();
  double const off = sampler.error(curves);
  flow.sampled = fmt::format("yield function as {} strains x {} rates, off by at most {:.2g} % at 300 other places",
                             curves.strains, curves.rates, 100 * off);
  curves.numbers = nullptr;  // the material's copy moves
  if (off > tolerance)
    part.warning(fmt::format("yield: {}; the tolerance of {:g} % could not be reached (an infinite slope at 0?)",
                             flow.sampled, 100 * tolerance),
                 "yield");
}

/// yield =: a number (and a slope), a table, tables by rate, or a function.
void yield(Script& script, Form& part, scene::Flow& flow, laws::Curves& curves) {
  double tolerance = 1e-3, strain_to = 2, slope = 0;
  std::vector<Curve> given;
  Table table;
  Callee callee;
  bool const is_function = part.type_of("yield") == LUA_TFUNCTION;
  bool right = false;
  if (is_function)
    right = part.function("yield", callee, "function(strain, rate)", "", Need::required);
  else
    right = part.curves("yield", "rate", given, positive("Pa", 1e3, 1e11),
                        "yield stress (Drucker-Prager: cohesion): a number, a list of { plastic strain, stress }, a "
                        "list of such lists each with rate = (1/s), or a function(strain, rate)");
  bool const has_slope = part.type_of("hardening") != LUA_TNIL;
  part.number("hardening", slope, not_negative("Pa", 1e11),
              "slope of the yield stress over plastic strain, beside a number");
  part.number("tolerance", tolerance, {"", 1e-6, 0.1},
              "how closely a table follows a yield function, share of its value");
  part.number("strain_to", strain_to, positive("", 0.01, 100),
              "largest plastic strain at which a yield function is asked");
  if (part.listing() || !right) return;
  if (has_slope && (is_function || given.size() > 1 || given[0].points.size() > 1))
    return part.problem(
        "hardening is for a yield stress that is a number (a table or function has its own slope); leave one out",
        "hardening");
  auto const ask = [&](double strain, double rate) { return script.ask_yield(callee, strain, rate); };
  if (is_function) {
    Sampler sampler(ask, tolerance, strain_to);
    try {
      table = sampler.table();
    } catch (Error const& error) {
      return script.problem({}, error.what());
    }
    for (std::size_t k = 0; k < table.ln_rates.size(); ++k) {
      Curve& curve = given.emplace_back();
      curve.at = std::exp(table.ln_rates[k]);
      for (std::size_t i = 0; i < table.strains.size(); ++i)
        curve.points.push_back({table.strains[i], table.stresses[k][i]});
    }
  } else {
    std::sort(given.begin(), given.end(), [](auto const& a, auto const& b) { return a.at < b.at; });
    table = {};
  }
  if (!sound(part, given)) return;
  if (!is_function) table = joined(given);
  flow.curves = table.numbers();
  curves.strains = static_cast<int>(table.strains.size());
  curves.rates = static_cast<int>(table.ln_rates.size());
  curves.beyond = slope;
  if (is_function) say_how_close(part, Sampler(ask, tolerance, strain_to), table, tolerance, flow, curves);
}

/// Whether the reference temperature was given.
bool read_heat(Form& heat, laws::Heat& to) {
  heat.number("capacity", to.capacity, positive("J/(kg K)", 50, 5000), "heat capacity per mass", Need::required);
  heat.number("share", to.share, not_negative("", 1),
              "share of the plastic work that becomes heat (Taylor-Quinney), not above 1");
  heat.number("start", to.start, positive("K", 70, 3000), "temperature at the start; a body may have another one");
  std::optional<double> reference;
  heat.number("reference", reference, positive("K", 70, 3000),
              "the T0 of m, up to which nothing softens: room temperature in most tables; left out: as start");
  to.reference = reference.value_or(to.start);
  return reference.has_value();
}

}  // namespace

double Script::ask_yield(Callee const& callee, double strain, double rate) {
  lua_State* const L = state();
  return ask(
      callee, [&] { return lua_pushnumber(L, strain), lua_pushnumber(L, rate), 2; },
      [&] {
        if (lua_type(L, -1) != LUA_TNUMBER)
          throw Error(callee.source,
                      fmt::format("{} returned a {} at strain {}, rate {}; it must return a yield stress in Pa",
                                  callee.what, luaL_typename(L, -1), shown(strain), shown(rate)));
        double const value = lua_tonumber(L, -1);
        if (!(std::isfinite(value) && value > 0))
          throw Error(callee.source,
                      fmt::format("{} returned {} at strain {}, rate {}; a yield stress must lie above 0", callee.what,
                                  std::isnan(value) ? "nan" : shown(value), shown(strain), shown(rate)));
        return value;
      });
}

void read_flow(Script& script, Form& part, scene::Flow& flow) {
  part.law(flow.law, "flow law", [&]<class Law>(Law& law) {
    if constexpr (std::is_base_of_v<laws::Curves, Law>) yield(script, part, flow, law);
  });
  std::string strain = "jaumann", solver = "newton", pressure = "element";
  part.word("strain", strain, {"jaumann", "logarithmic"},
            "how stress follows the motion: by the Jaumann rate (fast), or by logarithmic strain (exact in closed "
            "cycles and large elastic shear)");
  part.word("solver", solver, {"newton", "bisection"},
            "how the return mapping is solved; bisection is the slow reference");
  part.word(
      "pressure", pressure, {"element", "averaged"},
      "averaged: over the elements about a node that are still joined, so that flow does not lock (J2 laws only)");
  bool referenced = false;
  part.part("heat", "adiabatic heating by plastic work; left out: no temperature",
            [&](Form& heat) { referenced = read_heat(heat, flow.heat); });
  if (part.listing()) return;
  if (flow.heat.share > 1)
    part.problem(fmt::format("heat.share = {:g}: not more than all plastic work can become heat", flow.heat.share),
                 "heat");
  flow.logarithmic = strain == "logarithmic";
  flow.bisection = solver == "bisection";
  flow.averaged = pressure == "averaged";
  if (flow.averaged && std::holds_alternative<laws::DruckerPrager>(flow.law))
    part.problem(
        "pressure = \"averaged\" is for J2 laws, whose flow keeps the volume; drucker_prager has its own pressure",
        "pressure");
  if (auto const* law = std::get_if<laws::DruckerPrager>(&flow.law); law && law->dilation_angle > law->friction_angle)
    part.problem(
        fmt::format(
            "dilation_angle = {:g} is larger than friction_angle = {:g}: flow under pressure would give energy away",
            law->dilation_angle, law->friction_angle),
        "dilation_angle");
  if (flow.averaged)
    script.checks.push_back([&script, at = part.source()] {
      if (script.dimension == 2 && script.scene.two_d == "plane stress")
        script.problem(at,
                       "plastic.pressure = \"averaged\" has no meaning in plane stress (the thickness is free, nothing "
                       "locks); leave it out");
    });
  if (auto const* law = std::get_if<laws::JohnsonCookFlow>(&flow.law)) {
    if (law->m > 0 && !flow.heat.on())
      part.problem(
          "m softens with temperature, but without heat = { capacity = } nothing warms up; give heat or leave m out",
          "m");
    if (law->m > 0 && flow.heat.on() && !referenced && std::abs(flow.heat.start - 293) > 60)
      part.warning(fmt::format("heat.start = {:g} K is the T0 of m, too, so that nothing is softened at the start; the "
                               "constants of most tables are those of room temperature: heat.reference = 293",
                               flow.heat.start),
                   "heat");
    for (auto const& [key, temperature] : {std::pair{"start", flow.heat.start}, {"reference", flow.heat.reference}})
      if (law->m > 0 && flow.heat.on() && law->melting <= temperature)
        part.problem(fmt::format("melting = {:g} K is not above heat.{} = {:g} K", law->melting, key, temperature),
                     "melting");
  }
}

}  // namespace fissure::lua
