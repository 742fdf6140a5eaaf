// now: what measures, stop conditions and expectations may ask a running experiment.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "lua/reader.h"

namespace fissure::lua {
namespace {

Script& script_of(lua_State* L) { return static_cast<Script&>(Sandbox::of(L)); }

scene::Now const& current(Script const& script) {
  if (!script.now) throw std::runtime_error("now can only be asked while a measure is taken");
  return *script.now;
}

int index_of(Script const& script, int argument, Kind kind, char const* name) {
  Handle const* const handle = script.handle_at(argument);
  if (!handle || handle->kind != kind)
    throw std::runtime_error(fmt::format("now.{}: value {} must be a {}, not a {}", name, argument, kind_name(kind),
                                         handle ? kind_name(handle->kind) : luaL_typename(script.state(), argument)));
  return handle->index;
}

Vec3 point_at(Script const& script, int argument, char const* name) {
  lua_State* const L = script.state();
  Vec3 point(0, 0, 0);
  bool right = lua_istable(L, argument);
  for (int i = 0; right && i < 3; ++i) {
    lua_rawgeti(L, argument, i + 1);
    right = lua_type(L, -1) == LUA_TNUMBER ? std::isfinite(lua_tonumber(L, -1)) : lua_isnil(L, -1) && i == 2;
    point[i] = lua_tonumber(L, -1);
    lua_pop(L, 1);
  }
  if (!right)
    throw std::runtime_error(
        fmt::format("now.{}: value {} must be a point {{ x, y }} or {{ x, y, z }}", name, argument));
  return point;
}

std::string word_at(Script const& script, int argument, char const* name, std::vector<std::string> const& known) {
  lua_State* const L = script.state();
  std::string const word =
      lua_type(L, argument) == LUA_TSTRING ? std::string(lua_tostring(L, argument)).substr(0, 200) : "";
  for (auto const& one : known)
    if (one == word) return word;
  throw std::runtime_error(fmt::format("now.{}: {} is unknown{}", name, in_quotes(word), suggestion(word, known)));
}

std::vector<std::string> measures(Script const& script) {
  std::vector<std::string> names;
  for (auto const& measure : script.scene.measures) names.push_back(measure.name);
  return names;
}

int give(Script& script, double value) { return lua_pushnumber(script.state(), value), 1; }

int give(Script& script, Vec3 const& v) {
  lua_State* const L = script.state();
  lua_createtable(L, 0, 3);
  char const* const names[3] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) lua_pushnumber(L, v[i]), lua_setfield(L, -2, names[i]);
  return 1;
}

int give(Script& script, std::optional<double> const& value, std::string const& measure) {
  if (!value)
    throw std::runtime_error(fmt::format(
        "measure {} has no value yet (measures are taken in the order in which they stand)", in_quotes(measure)));
  return give(script, *value);
}

/// Along y, or along the axis named by `argument`.
double component(Script& script, Vec3 const& force, int argument, char const* name) {
  std::string const axis =
      lua_isnoneornil(script.state(), argument) ? "y" : word_at(script, argument, name, {"x", "y", "z"});
  return force[axis[0] - 'x'];
}
int along_axis(Script& script, Vec3 const& force, int argument, char const* name) {
  return give(script, std::abs(component(script, force, argument, name)));
}

int force(Script& s) { return along_axis(s, current(s).plate_force(index_of(s, 1, Kind::plate, "force")), 2, "force"); }
int wall_force(Script& s) {
  return along_axis(s, current(s).wall_force(index_of(s, 1, Kind::wall, "wall_force")), 2, "wall_force");
}
int reaction(Script& s) {
  return along_axis(s, current(s).reaction(index_of(s, 1, Kind::hold, "reaction")), 2, "reaction");
}
int torque(Script& s) {
  int const hold = index_of(s, 1, Kind::hold, "torque");
  if (!s.scene.holds[static_cast<std::size_t>(hold)].around)
    throw std::runtime_error(
        "now.torque: this hold has no axis; give it around = { ... }, turning = 0 where it stands");
  return give(s, current(s).torque(hold));
}
int contact_force(Script& s) {
  int const body = index_of(s, 1, Kind::body, "contact_force"), other = index_of(s, 2, Kind::body, "contact_force");
  if (body == other) throw std::runtime_error("now.contact_force: values 1 and 2 are the same body");
  return along_axis(s, current(s).contact_force(body, other), 3, "contact_force");
}
scene::Touch touch(Script& s, std::string const& question) {
  int const body = index_of(s, 1, Kind::body, question.c_str()), other = index_of(s, 2, Kind::body, question.c_str());
  if (body == other) throw std::runtime_error("now." + question + ": values 1 and 2 are the same body");
  return current(s).touch(body, other);
}
int contact_area(Script& s) { return give(s, touch(s, "contact_area").area); }
int contact_pressure(Script& s) {
  auto const found = touch(s, "contact_pressure");
  return give(s, found.area > 0 ? found.push / found.area : 0);
}
int spring_force(Script& s) { return give(s, current(s).pull(index_of(s, 1, Kind::spring, "spring_force"))); }
int tie_force(Script& s) {
  return give(s, component(s, current(s).tie_force(index_of(s, 1, Kind::tie, "tie_force")), 2, "tie_force"));
}
int displacement(Script& s) {
  Handle const* const handle = s.handle_at(1);
  if (handle && handle->kind == Kind::plate) return give(s, current(s).plate_displacement(handle->index));
  return give(s, current(s).displacement(index_of(s, 1, Kind::body, "displacement"), point_at(s, 2, "displacement")));
}
int velocity(Script& s) {
  int const body = index_of(s, 1, Kind::body, "velocity");
  return give(s, lua_isnoneornil(s.state(), 2) ? current(s).mean_velocity(body)
                                               : current(s).velocity(body, point_at(s, 2, "velocity")));
}
int stress(Script& s) {
  auto const values = current(s).stress(index_of(s, 1, Kind::body, "stress"), point_at(s, 2, "stress"));
  lua_State* const L = s.state();
  lua_createtable(L, 0, 6);
  char const* const names[6] = {"xx", "yy", "zz", "xy", "yz", "zx"};
  for (std::size_t i = 0; i < 6; ++i) lua_pushnumber(L, values[i]), lua_setfield(L, -2, names[i]);
  return 1;
}
int energy(Script& s) { return give(s, current(s).energy(word_at(s, 1, "energy", scene::energy_names()))); }
/// Refuses a value for a question that takes none: what is asked of one body would be answered for all.
void of_all(Script& s, char const* name) {
  if (lua_gettop(s.state()) > 0)
    throw std::runtime_error(fmt::format("now.{}() takes no value: it is of all bodies together", name));
}
int crack_area(Script& s) { return of_all(s, "crack_area"), give(s, current(s).crack_area()); }
int crack_energy(Script& s) { return of_all(s, "crack_energy"), give(s, current(s).crack_energy()); }
int removed_pieces(Script& s) {
  of_all(s, "removed_pieces");
  return lua_pushinteger(s.state(), current(s).removed_pieces()), 1;
}
int broken_joints(Script& s) {
  of_all(s, "broken_joints");
  return lua_pushinteger(s.state(), current(s).broken_joints()), 1;
}
int fragments(Script& s) {
  lua_State* const L = s.state();
  auto const list = current(s).fragments(lua_gettop(L) == 0 ? -1 : index_of(s, 1, Kind::body, "fragments"));
  lua_createtable(L, static_cast<int>(list.size()), 0);
  for (std::size_t k = 0; k < list.size(); ++k) {
    lua_createtable(L, 0, 4);
    give(s, list[k].mass), lua_setfield(L, -2, "mass");
    give(s, list[k].center), lua_setfield(L, -2, "center");
    give(s, list[k].velocity), lua_setfield(L, -2, "velocity");
    give(s, list[k].size), lua_setfield(L, -2, "size");
    lua_rawseti(L, -2, static_cast<lua_Integer>(k) + 1);
  }
  return 1;
}
int largest(Script& s) { return give(s, current(s).extreme(word_at(s, 1, "largest", scene::output_fields()))); }
int field(Script& s) {
  std::vector<std::string> known = scene::output_fields();
  auto const& components = scene::stress_components();
  known.insert(known.end(), components.begin(), components.end());
  std::string const name = word_at(s, 1, "field", known);
  if (auto const found = std::find(components.begin(), components.end(), name); found != components.end())
    return give(s, current(s).stress(index_of(s, 2, Kind::body, "field"),
                                     point_at(s, 3, "field"))[static_cast<std::size_t>(found - components.begin())]);
  if (name == "displacement" || name == "velocity" || name == "stress")
    throw std::runtime_error(
        fmt::format("now.field: \"{}\" has several components; now.{}(body, point) gives them all", name, name));
  return give(s, current(s).field(name, index_of(s, 2, Kind::body, "field"), point_at(s, 3, "field")));
}
/// Of cells where a function of the script says true; without one of all.
int average(Script& s) {
  lua_State* const L = s.state();
  std::vector<std::string> known = scene::stress_components();
  for (auto const& name : scene::output_fields())
    if (name != "displacement" && name != "velocity" && name != "stress") known.push_back(name);
  std::string const name = word_at(s, 1, "average", known);
  int const body = index_of(s, 2, Kind::body, "average");
  if (lua_isnoneornil(L, 3)) return give(s, current(s).average(name, body, {}));
  if (!lua_isfunction(L, 3))
    throw std::runtime_error(
        fmt::format("now.average: value 3 must be a function(x, y, z) that says true where it is taken, not a {}",
                    luaL_typename(L, 3)));
  return give(s, current(s).average(name, body, [L](double x, double y, double z) {
    lua_pushvalue(L, 3);
    for (double const coordinate : {x, y, z}) lua_pushnumber(L, coordinate);
    if (lua_pcall(L, 3, 1, 0) != LUA_OK) {
      std::string const what = lua_tostring(L, -1) ? lua_tostring(L, -1) : "it failed";
      lua_pop(L, 1);
      throw std::runtime_error("now.average: " + what);
    }
    bool const inside = lua_toboolean(L, -1) != 0;
    lua_pop(L, 1);
    return inside;
  }));
}
int size(Script& s) {
  auto const [least, largest] = current(s).bounds(index_of(s, 1, Kind::body, "size"));
  return give(s, Vec3(largest - least));
}
int peak(Script& s) {
  auto const name = word_at(s, 1, "peak", measures(s));
  return give(s, current(s).peak(name), name);
}
int peak_time(Script& s) {
  auto const name = word_at(s, 1, "peak_time", measures(s));
  return give(s, current(s).peak_time(name), name);
}
/// A number above 0 among the values of a question; `fallback` where it is left out.
double positive_at(Script const& s, int argument, char const* name, std::optional<double> fallback, char const* what) {
  lua_State* const L = s.state();
  if (fallback && lua_isnoneornil(L, argument)) return *fallback;
  double const value = lua_type(L, argument) == LUA_TNUMBER ? lua_tonumber(L, argument) : 0;
  if (!(value > 0) || !std::isfinite(value))
    throw std::runtime_error(fmt::format("now.{}: value {} must be {} above 0", name, argument, what));
  return value;
}
int mean(Script& s) {
  auto const name = word_at(s, 1, "mean", measures(s));
  return give(s, current(s).mean(name, positive_at(s, 2, "mean", {}, "a time (s)")), name);
}
int at_rest(Script& s) {
  bool const rests = current(s).at_rest(positive_at(s, 1, "at_rest", 1e-4, "a share"));
  return lua_pushboolean(s.state(), rests), 1;
}

// no answer: a plain number
struct Question {
  NowEntry entry;
  int (*answer)(Script&);
};

std::vector<Question> const& questions() {
  static std::vector<Question> const all{
      {{"time", "", "number", "simulated time [s]"}, nullptr},
      {{"step", "", "integer", "number of steps done"}, nullptr},
      {{"force", "plate, axis", "number",
        "size of the force on a plate along \"y\" (or \"x\", \"z\") [N]; 2D: for the scene's thickness, or once around "
        "the axis"},
       force},
      {{"wall_force", "wall, axis", "number", "the same for a wall [N]"}, wall_force},
      {{"reaction", "hold, axis", "number",
        "the same for a prescribed motion [N]; what two holds share counts for the first"},
       reaction},
      {{"torque", "hold", "number",
        "moment that a hold with around needs, about its axis by the right hand [N m]; 2D: for the scene's thickness"},
       torque},
      {{"contact_force", "body, other, axis", "number",
        "the same for what two bodies push and rub each other with where they touch [N], either way round; not what a "
        "bond between them carries"},
       contact_force},
      {{"contact_area", "body, other", "number",
        "area of the first body's surface that the other presses on, in whole faces of its cells as they are now (a "
        "contact of few faces is no finer than they are) [m^2]; "
        "2D: for the scene's thickness, or once around the axis"},
       contact_area},
      {{"contact_pressure", "body, other", "number",
        "what presses there along the surface's normals, over that area [Pa]; 0: they do not touch"},
       contact_pressure},
      {{"spring_force", "spring", "number",
        "what a spring pulls its ends together with [N]; below 0 it pushes; broken: 0"},
       spring_force},
      {{"tie_force", "tie, axis", "number",
        "what the first body of a tie pulls the second with, along \"y\" (or \"x\", \"z\") and with that sign: below 0 "
        "it points against the axis [N]"},
       tie_force},
      {{"displacement", "body, point", "table",
        "x, y, z of the node nearest to a point { x, y } at rest, on the point's side of a crack; for a plate, its own "
        "[m]"},
       displacement},
      {{"velocity", "body, point", "table",
        "x, y, z of the node nearest to a point at rest, on its side of a crack; without a point, the body's mean "
        "[m/s]"},
       velocity},
      {{"stress", "body, point", "table",
        "xx, yy, zz, xy, yz, zx of the element at a point at rest, tension positive [Pa]"},
       stress},
      {{"field", "name, body, point", "number",
        "an output field with one component, or a component of stress (\"xx\", ... \"zx\"), at the element nearest to "
        "a "
        "point at rest"},
       field},
      {{"average", "name, body, inside", "number",
        "mean by volume at rest of an output field with one component, or of a component of stress (\"xx\", \"yy\", "
        "\"zz\", \"xy\", \"yz\", \"zx\"), over the cells of a body; with function(x, y, z) over those whose middle at "
        "rest it says true of"},
       average},
      {{"size", "body", "table",
        "x, y, z: how far a body reaches now along each axis [m]; axisymmetric: x is its diameter"},
       size},
      {{"energy", "name", "number", "a term of the energy balance [J]"}, energy},
      {{"crack_area", "", "number", "area of broken joints [m2]; 2D: length times thickness, or once around the axis"},
       crack_area},
      {{"crack_energy", "", "number",
        "what damage took of joints that are broken [J]; the rest of energy(\"fracture\") is of joints that softened "
        "and hold on, and friction in them"},
       crack_energy},
      {{"broken_joints", "", "integer", "how many joints are broken"}, broken_joints},
      {{"removed_pieces", "", "integer",
        "how many crushed pieces have left the run, where `run{ crushed = \"remove\" }` is given"},
       removed_pieces},
      {{"fragments", "body", "list",
        "pieces that hang together by faces, heaviest first, of a body or of all: tables of mass [kg], center [m], "
        "velocity [m/s] and size [m], the last three with x, y, z; # of it is how many there are"},
       fragments},
      {{"largest", "field", "number", "largest value of an output field in all bodies"}, largest},
      {{"peak", "measure", "number", "largest value of a measure so far"}, peak},
      {{"peak_time", "measure", "number", "when that was [s]"}, peak_time},
      {{"mean", "measure, duration", "number",
        "mean over time of a measure, of the last so many seconds that were recorded, the latest value included"},
       mean},
      {{"at_rest", "share", "boolean",
        "whether in the last tenth of the time (ten samples at least) no sample had more kinetic energy than this "
        "share (left out: 1e-4) of the most there was: `stop = function(now) return now.at_rest() end`. Without "
        "damping "
        "little ever rests; a force still wavers then, so take its mean"},
       at_rest},
  };
  return all;
}

int answer(lua_State* L) {
  int const results = Sandbox::of(L).guarded([&]() -> int {
    return questions()[static_cast<std::size_t>(lua_tointeger(L, lua_upvalueindex(1)))].answer(script_of(L));
  });
  return results < 0 ? lua_error(L) : results;
}

}  // namespace

std::vector<NowEntry> now_entries() {
  std::vector<NowEntry> entries;
  for (auto const& question : questions()) entries.push_back(question.entry);
  return entries;
}

void push_now_property(Script& script, std::string const& name) {
  lua_State* const L = script.state();
  scene::Now const& now = current(script);
  std::vector<std::string> known = measures(script);
  for (std::size_t i = 0; i < questions().size(); ++i) {
    if (questions()[i].entry.name == name) {
      if (name == "time")
        give(script, now.time());
      else if (name == "step")
        lua_pushinteger(L, now.step());
      else
        lua_pushinteger(L, static_cast<lua_Integer>(i)), lua_pushcclosure(L, answer, 1);
      return;
    }
    known.emplace_back(questions()[i].entry.name);
  }
  for (auto const& measure : measures(script))
    if (measure == name) {
      give(script, now.latest(name), name);
      return;
    }
  throw std::runtime_error(fmt::format("now.{} is unknown (it is neither a question nor a measure){}", in_quotes(name),
                                       suggestion(name, known)));
}

namespace {

/// Sets something for as long as it lives.
template <class T>
class Meanwhile {
 public:
  Meanwhile(T& what, T value) : what_(what), before_(what) { what = value; }
  ~Meanwhile() { what_ = before_; }
  Meanwhile(Meanwhile const&) = delete;
  Meanwhile& operator=(Meanwhile const&) = delete;

 private:
  T& what_;
  T before_;
};

}  // namespace

double Script::ask_measure(Callee const& callee, scene::Now const& asked) {
  Meanwhile const meanwhile(now, &asked);
  lua_State* const L = state();
  return ask(
      callee,
      [&] {
        return push_handle({Kind::now, 0}), 1;
      },
      [&] {
        if (lua_type(L, -1) != LUA_TNUMBER)
          throw Error(callee.source,
                      fmt::format("{} returned a {}; it must return a number{}", callee.what, luaL_typename(L, -1),
                                  lua_isnil(L, -1) ? ": is the word return missing?" : ""));
        return static_cast<double>(lua_tonumber(L, -1));
      });
}

std::array<double, 3> Script::ask_servo(Callee const& callee, scene::Now const& asked) {
  Meanwhile const meanwhile(now, &asked);
  return ask(
      callee,
      [&] {
        return push_handle({Kind::now, 0}), 1;
      },
      [&] { return returned_vector(callee, fmt::format("t = {} s", shown(asked.time()))); });
}

void Script::ask_words(Callee const& callee, scene::Now const& asked, std::string& words) {
  Meanwhile const meanwhile(now, &asked);
  Meanwhile const heard(said_to, &words);
  ask(
      callee,
      [&] {
        return push_handle({Kind::now, 0}), 1;
      },
      [] { return 0; });
}

bool Script::ask_stop(Callee const& callee, scene::Now const& asked) {
  Meanwhile const meanwhile(now, &asked);
  lua_State* const L = state();
  return ask(
      callee,
      [&] {
        return push_handle({Kind::now, 0}), 1;
      },
      [&] {
        if (!lua_isboolean(L, -1))
          throw Error(callee.source,
                      fmt::format("{} returned a {}; it must return true or false", callee.what, luaL_typename(L, -1)));
        return lua_toboolean(L, -1) != 0;
      });
}

}  // namespace fissure::lua
