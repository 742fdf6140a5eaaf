#include "lua/script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "lua/reader.h"

namespace fissure::lua {
namespace {

constexpr std::size_t most_problems = 100;
constexpr int most_calls = 100000, most_weight = 2000000, most_depth = 32;
int const metatable_keys[kind_count] = {};  // their addresses are registry keys

Script& script_of(lua_State* L) { return static_cast<Script&>(Sandbox::of(L)); }

// verb{...}: everything of C++ happens inside guarded(), so that lua_error leaves nothing behind.
int call_verb(lua_State* L) {
  int const results = Sandbox::of(L).guarded([&]() -> int {
    Script& script = script_of(L);
    auto const& verb = verbs()[static_cast<std::size_t>(lua_tointeger(L, lua_upvalueindex(1)))];
    if (!script.declaring)
      throw std::runtime_error(
          fmt::format("{} cannot be used inside a function; a scene is said before it runs", verb.name));
    if (++script.said[verb.name] > most_calls)
      throw std::runtime_error(
          fmt::format("{} was used more than {} times (a loop that never ends?)", verb.name, most_calls));
    if (script.problems.size() > most_problems) throw std::runtime_error("too many problems to go on");
    Form form(script, verb.name, {script.file_now(), script.line_now()});
    return verb.run(script, form);
  });
  return results < 0 ? lua_error(L) : results;
}

int read_property(lua_State* L) {
  int const results = Sandbox::of(L).guarded([&]() -> int {
    Script& script = script_of(L);
    Handle const* const handle = script.handle_at(1);
    if (!handle || lua_type(L, 2) != LUA_TSTRING)
      throw std::runtime_error("a property is asked for by its name, as in disc.radius");
    std::string const name = std::string(lua_tostring(L, 2)).substr(0, 100);
    if (handle->kind == Kind::now) {
      push_now_property(script, name);
      return 1;
    }
    auto const index = static_cast<std::size_t>(handle->index);
    std::vector<std::pair<std::string, double>> properties;
    if (handle->kind == Kind::shape) properties = properties_of(script.shapes[index].shape);
    if (handle->kind == Kind::body) properties = properties_of(script.scene.bodies[index].shape);
    if (handle->kind == Kind::plate) properties = properties_of({script.scene.plates[index].box, {}});
    if (handle->kind == Kind::material) {
      auto const& material = script.scene.materials[index];
      properties.emplace_back("density", material.density);
      auto add = [&](auto const& law) {
        for (auto const& p : law.parameters()) properties.emplace_back(p.key, law.*(p.member));
      };
      std::visit(add, material.bulk);
      if (material.joint) std::visit(add, *material.joint);
      if (material.contact) properties.emplace_back("friction", material.contact->friction);
    }
    std::vector<std::string> known;
    for (auto const& [key, value] : properties) {
      if (key == name) {
        lua_pushnumber(L, value);
        return 1;
      }
      known.push_back(key);
    }
    throw std::runtime_error(
        fmt::format("a {} has no property {}{}", kind_name(handle->kind), in_quotes(name), suggestion(name, known)));
  });
  return results < 0 ? lua_error(L) : results;
}

int write_property(lua_State* L) {
  lua_pushliteral(L, "what a verb returned cannot be changed; change the verb's own table");
  return lua_error(L);
}

std::string read_text(std::string const& path) {
  std::error_code failed;
  if (!std::filesystem::exists(path, failed)) throw Error(path + ": no such file");
  if (!std::filesystem::is_regular_file(path, failed)) throw Error(path + ": not a file");
  std::ifstream file(path, std::ios::binary);
  std::string text(text_limit + 1, '\0');
  if (!file || (!file.read(text.data(), static_cast<std::streamsize>(text.size())) && !file.eof()))
    throw Error(path + ": cannot be read (permission?)");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > text_limit) throw Error(fmt::format("{}: the file is larger than {} MiB", path, text_limit >> 20));
  return text;
}

/// What `require` could have found: the library, and what stands beside the scene.
std::vector<std::string> module_names(std::filesystem::path const& folder) {
  std::vector<std::string> names = library_names();
  std::error_code failed;
  for (std::filesystem::directory_iterator at(folder.empty() ? "." : folder, failed), end; !failed && at != end;
       at.increment(failed))
    if (at->path().extension() == ".lua") names.push_back(at->path().stem().string());
  return names;
}

// require "name": the built-in library, or name.lua beside the scene. Leaves the module, or its chunk and the name.
int find_module(lua_State* L) {
  Script& script = script_of(L);
  if (lua_type(L, 1) != LUA_TSTRING) throw std::runtime_error("require needs a name: require \"materials\"");
  std::string const name = std::string(lua_tostring(L, 1)).substr(0, 100);
  for (char const c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-')
      throw std::runtime_error(
          fmt::format("require {} (only letters, digits, _ and -: modules stand beside the scene)", in_quotes(name)));
  if (!script.declaring)
    throw std::runtime_error("require cannot be used inside a function; a scene is said before it runs");
  lua_getfield(L, lua_upvalueindex(1), name.c_str());
  if (lua_isboolean(L, -1)) throw std::runtime_error(fmt::format("module {} requires itself", in_quotes(name)));
  if (!lua_isnil(L, -1)) return 1;
  lua_pop(L, 1);

  auto const folder = std::filesystem::path(script.scene.file).parent_path();
  scene::Scene::Module module;
  char const* const built_in = library(name);
  std::string const beside = (folder / (name + ".lua")).string();
  std::error_code failed;
  if (!built_in)
    module.file = beside;
  else if (std::filesystem::is_regular_file(beside, failed))
    throw std::runtime_error(fmt::format("{} is a module of the library, and {} has its name; call that file otherwise",
                                         in_quotes(name), beside));
  if (auto const stored = script.stored.find(name); stored != script.stored.end())
    module.text = stored->second.text;
  else if (built_in)
    module.text = built_in;
  else if (std::filesystem::is_regular_file(module.file, failed))
    module.text = read_text(module.file);
  else
    throw std::runtime_error(fmt::format("no module {} (looked for {} and in the built-in library: {}){}",
                                         in_quotes(name), module.file, fmt::join(library_names(), ", "),
                                         suggestion(name, module_names(folder))));
  lua_pushboolean(L, 1);
  lua_setfield(L, lua_upvalueindex(1), name.c_str());
  std::string const error = script.load(module.text, built_in ? "=" + name : "@" + module.file);
  if (!error.empty()) throw std::runtime_error(error);
  script.scene.modules[name] = module;
  lua_pushboolean(L, built_in != nullptr);
  return 2;  // the chunk and whether it is the library's are on the stack
}

// suggestion(word, known): what the library says when it is asked for something that it does not know.
int suggest(lua_State* L) {
  int const results = Sandbox::of(L).guarded([&]() -> int {
    std::vector<std::string> known;
    for (lua_Integer i = 1; lua_type(L, 2) == LUA_TTABLE && lua_rawgeti(L, 2, i) == LUA_TSTRING; ++i, lua_pop(L, 1))
      known.emplace_back(lua_tostring(L, -1));
    std::string const word = lua_type(L, 1) == LUA_TSTRING ? std::string(lua_tostring(L, 1)).substr(0, 100) : "";
    std::string const text = suggestion(word, known);
    lua_pushlstring(L, text.data(), text.size());
    return 1;
  });
  return results < 0 ? lua_error(L) : results;
}

// materials.granit: what a module of the library does not have is no nil.
int miss_member(lua_State* L) {
  int const results = Sandbox::of(L).guarded([&]() -> int {
    std::vector<std::string> known;
    for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1))
      if (lua_type(L, -2) == LUA_TSTRING) known.emplace_back(lua_tostring(L, -2));
    std::sort(known.begin(), known.end());
    std::string const word = lua_type(L, 2) == LUA_TSTRING ? std::string(lua_tostring(L, 2)).substr(0, 100) : "?";
    std::string const near = suggestion(word, known);
    throw std::runtime_error(fmt::format("{} has no {}{}", lua_tostring(L, lua_upvalueindex(1)), in_quotes(word),
                                         near.empty() ? fmt::format(" (it has {})", fmt::join(known, ", ")) : near));
  });
  return results < 0 ? lua_error(L) : results;
}

int require_module(lua_State* L) {
  int const results = Sandbox::of(L).guarded([&] { return find_module(L); });
  if (results < 0) return lua_error(L);
  if (results == 1) return 1;
  bool const built_in = lua_toboolean(L, -1);
  lua_pop(L, 1);
  lua_pushcfunction(L, suggest);
  lua_call(L, 1, 1);
  if (lua_isnil(L, -1) || lua_isboolean(L, -1)) {
    lua_pop(L, 1);
    lua_newtable(L);
  }
  if (built_in) {
    lua_newtable(L);
    lua_pushvalue(L, 1);
    lua_pushcclosure(L, miss_member, 1);
    lua_setfield(L, -2, "__index");
    lua_setmetatable(L, -2);
  }
  lua_pushvalue(L, 1);
  lua_pushvalue(L, -2);
  lua_rawset(L, lua_upvalueindex(1));
  return 1;
}

// print: to the error stream, one line, nothing that could steer a terminal.
constexpr int most_words = 100'000;  // that a finish{} may print

int print_line(lua_State* L) {
  std::string* const to = script_of(L).said_to;
  auto const put = [&](char c) { to ? to->push_back(c) : void(std::fputc(c, stderr)); };
  int const n = lua_gettop(L);
  for (int i = 1; i <= n; ++i) {
    if (to && to->size() > most_words) return luaL_error(L, "prints more than %d characters", most_words);
    std::size_t length = 0;
    char const* const text = luaL_tolstring(L, i, &length);
    for (std::size_t k = 0; k < length; ++k)
      put(static_cast<unsigned char>(text[k]) < 32 || text[k] == 127 ? ' ' : text[k]);
    put(i < n ? ' ' : '\n');
    lua_pop(L, 1);
  }
  return 0;
}

int describe_handle(lua_State* L) {
  Handle const* const handle = script_of(L).handle_at(1);
  lua_pushfstring(L, "%s %d", handle ? kind_name(handle->kind) : "thing", handle ? handle->index + 1 : 0);
  return 1;
}

}  // namespace

std::vector<Verb> const& verbs() {
  static std::vector<Verb> const all = [] {
    std::vector<Verb> list;
    for (auto const& group : {material_verbs(), shape_verbs(), load_verbs(), look_verbs()})
      list.insert(list.end(), group.begin(), group.end());
    return list;
  }();
  return all;
}

std::vector<Unit> const& units() {
  static std::vector<Unit> const all{{"m", 1, "metre"},
                                     {"mm", 1e-3, "millimetre"},
                                     {"um", 1e-6, "micrometre"},
                                     {"cm", 1e-2, "centimetre"},
                                     {"km", 1e3, "kilometre"},
                                     {"m2", 1, "square metre"},
                                     {"mm2", 1e-6, "square millimetre"},
                                     {"cm2", 1e-4, "square centimetre"},
                                     {"m3", 1, "cubic metre"},
                                     {"mm3", 1e-9, "cubic millimetre"},
                                     {"cm3", 1e-6, "cubic centimetre"},
                                     {"s", 1, "second"},
                                     {"ms", 1e-3, "millisecond"},
                                     {"us", 1e-6, "microsecond"},
                                     {"ns", 1e-9, "nanosecond"},
                                     {"kg", 1, "kilogram"},
                                     {"g", 1e-3, "gram"},
                                     {"t", 1e3, "tonne"},
                                     {"N", 1, "newton"},
                                     {"kN", 1e3, "kilonewton"},
                                     {"MN", 1e6, "meganewton"},
                                     {"Pa", 1, "pascal"},
                                     {"kPa", 1e3, "kilopascal"},
                                     {"MPa", 1e6, "megapascal"},
                                     {"GPa", 1e9, "gigapascal"},
                                     {"J", 1, "joule"},
                                     {"kJ", 1e3, "kilojoule"},
                                     {"mJ", 1e-3, "millijoule"},
                                     {"Hz", 1, "hertz"},
                                     {"kHz", 1e3, "kilohertz"},
                                     {"K", 1, "kelvin"},
                                     {"deg", std::numbers::pi / 180, "degree"}};
  return all;
}

Script::Script(int dimension) : dimension(dimension) {
  lua_State* const L = state();
  for (int kind = 0; kind < kind_count; ++kind) {
    lua_newtable(L);
    lua_pushstring(L, kind_name(static_cast<Kind>(kind)));
    lua_setfield(L, -2, "__name");
    lua_pushcfunction(L, read_property);
    lua_setfield(L, -2, "__index");
    lua_pushcfunction(L, write_property);
    lua_setfield(L, -2, "__newindex");
    lua_pushcfunction(L, describe_handle);
    lua_setfield(L, -2, "__tostring");
    lua_rawsetp(L, LUA_REGISTRYINDEX, &metatable_keys[kind]);
  }
  for (std::size_t i = 0; i < verbs().size(); ++i) {
    lua_pushinteger(L, static_cast<lua_Integer>(i));
    lua_pushcclosure(L, call_verb, 1);
    set_global(verbs()[i].name);
  }
  for (auto const& unit : units()) {
    lua_pushnumber(L, unit.value);
    set_global(unit.name);
  }
  lua_pushinteger(L, dimension);
  set_global("dim");
  lua_newtable(L);
  lua_pushcclosure(L, require_module, 1);
  set_global("require");
  lua_pushcfunction(L, print_line);
  set_global("print");
}

void Script::push_handle(Handle handle) {
  lua_State* const L = state();
  *static_cast<Handle*>(lua_newuserdatauv(L, sizeof(Handle), 0)) = handle;
  lua_rawgetp(L, LUA_REGISTRYINDEX, &metatable_keys[static_cast<int>(handle.kind)]);
  lua_setmetatable(L, -2);
}

Handle const* Script::handle_at(int index) const {
  // Handles are the only userdata there are.
  return lua_type(state(), index) == LUA_TUSERDATA ? static_cast<Handle const*>(lua_touserdata(state(), index))
                                                   : nullptr;
}

void Script::problem(Source const& at, std::string const& text) {
  std::string const line = at.prefix() + text;
  if (problems.size() > most_problems || std::find(problems.begin(), problems.end(), line) != problems.end()) return;
  problems.push_back(problems.size() < most_problems ? line : "... and more");
}

void Script::weigh(int weight) {
  weight_ += weight;
  if (weight_ > most_weight)
    throw std::runtime_error(
        fmt::format("the shapes have more than {} parts; a body can also be read from a mesh file", most_weight));
}

int Script::add_shape(KnownShape shape) {
  if (shape.depth > most_depth)
    throw std::runtime_error(fmt::format("shapes are nested more than {} deep", most_depth));
  weigh(shape.weight);
  shapes.push_back(std::move(shape));
  return static_cast<int>(shapes.size()) - 1;
}

int Script::line_of(Source const& at, std::string const& verb, std::vector<std::string> const& path) const {
  auto const found = texts().find(at.file);
  if (found == texts().end()) return at.line;
  std::string const& text = found->second;
  std::size_t i = 0;
  int line = 1;
  for (; line < at.line && i < text.size(); ++i) line += text[i] == '\n';

  auto word_char = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  int depth = -1;  // -1: the verb has not been seen; 0: its bracket has not
  std::size_t reached = 0;
  for (; i < text.size(); ++i) {
    char const c = text[i];
    if (c == '\n') {
      if (depth < 0) break;  // the verb was said elsewhere: by the library, or under another name
      ++line;
    } else if (c == '-' && text.compare(i, 2, "--") == 0) {
      while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
    } else if (c == '"' || c == '\'') {
      for (++i; i < text.size() && text[i] != c && text[i] != '\n'; ++i) i += text[i] == '\\';
    } else if (word_char(c)) {
      std::size_t const start = i;
      while (i + 1 < text.size() && word_char(text[i + 1])) ++i;
      std::string_view const word(text.data() + start, i + 1 - start);
      std::size_t next = i + 1;
      while (next < text.size() && text[next] == ' ') ++next;
      char const follows = next < text.size() ? text[next] : '\0',
                 then = next + 1 < text.size() ? text[next + 1] : '\0';
      if (depth < 0) {
        if (word == verb && (follows == '{' || follows == '(')) depth = 0;
      } else if (depth == static_cast<int>(reached) + 1 && word == path[reached] && follows == '=' && then != '=') {
        if (++reached == path.size()) return line;
      }
    } else if (depth >= 0 && (c == '{' || c == '(')) {
      ++depth;
    } else if (depth >= 0 && (c == '}' || c == ')')) {
      if (--depth <= static_cast<int>(reached)) break;
    }
  }
  return at.line;
}

double Script::ask_number(Callee const& callee, double t) {
  lua_State* const L = state();
  return ask(
      callee, [&] { return lua_pushnumber(L, t), 1; },
      [&] {
        if (lua_type(L, -1) != LUA_TNUMBER)
          throw Error(callee.source, fmt::format("{} returned a {} at t = {} s; it must return a number", callee.what,
                                                 luaL_typename(L, -1), shown(t)));
        double const value = lua_tonumber(L, -1);
        if (!std::isfinite(value))
          throw Error(callee.source, fmt::format("{} returned {} at t = {} s", callee.what,
                                                 std::isnan(value) ? "nan" : "infinity", shown(t)));
        return value;
      });
}

bool Script::ask_inside(Callee const& callee, double x, double y, double z) {
  lua_State* const L = state();
  return ask(
      callee, [&] { return lua_pushnumber(L, x), lua_pushnumber(L, y), lua_pushnumber(L, z), 3; },
      [&] {
        if (!lua_isboolean(L, -1))
          throw Error(callee.source,
                      fmt::format("{} returned a {}; it must return true or false", callee.what, luaL_typename(L, -1)));
        return lua_toboolean(L, -1) != 0;
      });
}

std::array<double, 3> Script::returned_vector(Callee const& callee, std::string const& where) {
  lua_State* const L = state();
  std::array<double, 3> value{0, 0, 0};
  bool right = lua_istable(L, -1);
  for (int i = 0; right && i < 3; ++i) {
    lua_rawgeti(L, -1, i + 1);
    right = lua_type(L, -1) == LUA_TNUMBER ? std::isfinite(lua_tonumber(L, -1)) : lua_isnil(L, -1) && i == 2;
    value[static_cast<std::size_t>(i)] = lua_tonumber(L, -1);
    lua_pop(L, 1);
  }
  if (!right)
    throw Error(callee.source,
                fmt::format("{} must return finite numbers {{ x, y }} or {{ x, y, z }}, and at {} does not",
                            callee.what, where));
  if (dimension == 2) value[2] = 0;
  return value;
}

std::array<double, 3> Script::ask_vector(Callee const& callee, double x, double y, double z) {
  lua_State* const L = state();
  return ask(
      callee, [&] { return lua_pushnumber(L, x), lua_pushnumber(L, y), lua_pushnumber(L, z), 3; },
      [&] { return returned_vector(callee, fmt::format("{{ {}, {}, {} }}", shown(x), shown(y), shown(z))); });
}

std::array<double, 6> Script::ask_stress(Callee const& callee, double x, double y, double z) {
  lua_State* const L = state();
  return ask(
      callee, [&] { return lua_pushnumber(L, x), lua_pushnumber(L, y), lua_pushnumber(L, z), 3; },
      [&] {
        auto const& names = scene::stress_components();
        std::array<double, 6> value{};
        bool right = lua_istable(L, -1);
        for (lua_pushnil(L); right && lua_next(L, -2); lua_pop(L, 1)) {
          auto const name =
              lua_type(L, -2) == LUA_TSTRING ? std::find(names.begin(), names.end(), lua_tostring(L, -2)) : names.end();
          right = name != names.end() && lua_type(L, -1) == LUA_TNUMBER && std::isfinite(lua_tonumber(L, -1));
          if (right) value[static_cast<std::size_t>(name - names.begin())] = lua_tonumber(L, -1);
        }
        if (!right)
          throw Error(callee.source, fmt::format("{} must return finite numbers {{ xx = ..., yy = ..., xy = ... }} (or "
                                                 "zz, yz, zx), and at {{ {}, {}, {} }} does not",
                                                 callee.what, shown(x), shown(y), shown(z)));
        return value;
      });
}

void Script::read(std::string const& text, std::string const& name, std::vector<Setting> const& given) {
  scene.file = name;
  scene.text = text;
  settings = given;
  limit_time(reading_limit);
  std::string error = load(text, "@" + name);
  if (error.empty()) {
    declaring = true;
    error = call(0, 0, reading_limit);
    declaring = false;
  }
  if (!error.empty())
    problem({}, error.rfind("the script", 0) == 0 ? name + ": " + error : error);
  else
    finish();
  limit_time(0);
  if (problems.empty()) return;
  std::string all;
  for (auto const& one : problems) all += (all.empty() ? "" : "\n") + one;
  throw Error(all);
}

namespace {

/// Why no table of the scene has a key of that name: a part of it is left out, or there is none such.
std::string why_unknown(std::string const& name, std::set<std::string> const& asked) {
  for (std::size_t dot = name.rfind('.'); dot != std::string::npos && dot > 0; dot = name.rfind('.', dot - 1))
    if (std::string const part = name.substr(0, dot); asked.contains(part) && part.find('.') != std::string::npos)
      if (auto const next = asked.upper_bound(part + "."); next == asked.end() || next->rfind(part + ".", 0) != 0)
        return fmt::format("no {} of the scene has a part {}; only what the scene has can be set",
                           name.substr(0, name.find('.')), part.substr(part.find('.') + 1));
  return "the scene has no table with such a key" +
         suggestion(name, std::vector<std::string>(asked.begin(), asked.end()));
}

}  // namespace

void Script::finish() {
  for (auto const& check : checks)
    if (problems.size() <= most_problems) check();
  for (auto const& setting : settings) {
    if (setting.of_key()) {
      if (!set_keys.contains(setting.name))
        problem({}, fmt::format("--set {}={}: {}", setting.name, setting.text, why_unknown(setting.name, asked_keys)));
      continue;
    }
    std::vector<std::string> known;
    for (auto const& parameter : scene.parameters) known.push_back(parameter.name);
    if (std::find(known.begin(), known.end(), setting.name) != known.end()) continue;
    std::string const nearest = suggestion(setting.name, known);
    problem({}, fmt::format("--set {}={}: the scene has no such parameter{}", setting.name, shown(setting.value),
                            !nearest.empty() ? nearest
                            : known.empty()  ? "; it has none (param{})"
                                             : fmt::format("; it has {}", fmt::join(known, ", "))));
  }
  if (!said["body"])
    problem({}, scene.file +
                    ": there is no body (nothing to compute); add body{ shape = ..., mesh = ..., material = ... }");
  if (!scene.bodies.empty() && std::ranges::all_of(scene.bodies, &scene::Body::rigid))
    problem(scene.bodies.front().source,
            "every body is rigid; one at least must deform, for nothing else sets the time step (what hardly deforms "
            "may be coarse, and costs little)");
  if (!said["run"]) problem({}, scene.file + ": there is no run{} (how long?); add run{ time = ... }");

  if (dimension != 2 || scene.two_d == "axisymmetric" || !problems.empty()) return;
  // A 2D model has one thickness, so that its forces compare with 3D.
  double thickness = two_d_thickness;
  for (auto const& body : scene.bodies) {
    double const own = two_d_thickness > 0 ? 0 : thickness_of(body.shape);
    if (own > 0 && thickness > 0 && std::abs(own - thickness) > 1e-9 * thickness)
      problem(body.source, fmt::format("body {}: its thickness is {} m and another body's is {} m, and a 2D model has "
                                       "one; say which: assume{{ thickness = ... }}",
                                       in_quotes(body.name), shown(own), shown(thickness)));
    if (own > 0) thickness = own;
  }
  scene.out_of_plane = thickness > 0 ? thickness : 1;
}

scene::Scene read_scene_text(std::string const& text, std::string const& name, int dimension,
                             std::vector<Setting> const& settings, Modules const& stored) {
  auto const script = std::make_shared<Script>(dimension);
  script->stored = stored;
  script->read(text, name, settings);
  scene::Scene scene = script->scene;  // a copy: functions go on asking the script for disc.radius
  scene.keeps_alive = script;
  return scene;
}

scene::Scene read_scene(std::string const& path, int dimension, std::vector<Setting> const& settings) {
  return read_scene_text(read_text(path), path, dimension, settings);
}

}  // namespace fissure::lua
