// Lists of numbers, points and curves in a table of a scene.
#include <fmt/format.h>

#include <cmath>

#include "lua/reader.h"

namespace fissure::lua {

bool Form::list_of_numbers(std::string const& key, double* to, int least, int most, Quantity const& q) {
  lua_State* const L = state();
  if (!expect_type(key, LUA_TTABLE,
                   least == most ? (least == 2 ? "two numbers { x, y }" : "three numbers { x, y, z }")
                                 : "numbers { x, y } or { x, y, z }"))
    return false;
  int const list = lua_gettop(L);
  int entries = 0;
  for (lua_pushnil(L); lua_next(L, list); lua_pop(L, 1))
    if (++entries > most) {
      lua_settop(L, list);
      break;
    }
  if (entries < least || entries > most) {
    problem(fmt::format("{} must have {} numbers, not {}", label(key),
                        least == most ? std::to_string(least) : fmt::format("{} or {}", least, most),
                        entries > most ? "more" : std::to_string(entries)),
            key);
    return false;
  }
  bool right = true;
  for (int i = 0; i < entries; ++i) {
    lua_rawgeti(L, list, i + 1);
    right = checked_number(key, to[i], q, fmt::format("{}[{}]", label(key), i + 1)) && right;
    lua_pop(L, 1);
  }
  return right;
}

bool Form::vector(std::string const& key, double* to, Quantity const& q, std::string const& sentence, Need need) {
  declare(key, "{ x, y } or { x, y, z }", q,
          need == Need::required ? "required" : fmt::format("{{ {:g}, {:g}, {:g} }}", to[0], to[1], to[2]), sentence);
  if (!reading_ || !push(key, need, "vector", sentence)) return false;
  double given[3] = {0, 0, 0};
  bool right = list_of_numbers(key, given, 2, 3, q);
  pop();
  if (right && script_.dimension == 2 && given[2] != 0) {
    problem(fmt::format("{} has z = {}, and there is no z in two dimensions; write 0 or leave it out", label(key),
                        shown(given[2])),
            key);
    right = false;
  }
  if (right) std::copy(given, given + 3, to);
  return right;
}

bool Form::axis(std::string const& key, Vec3& to, std::string const& sentence) {
  declare(key, "{ x, y, z }", any_number(""), fmt::format("{{ {:g}, {:g}, {:g} }}", to[0], to[1], to[2]), sentence);
  if (!reading_ || !push(key, Need::optional, "vector", sentence)) return false;
  Vec3 given(0, 0, 0);
  bool right = list_of_numbers(key, given.data(), 3, 3, any_number(""));
  pop();
  if (right && !(given.norm() > 0)) problem(label(key) + " has no direction (all zero)", key), right = false;
  if (right) to = given.normalized();
  return right;
}

bool Form::factors(std::string const& key, Vec3& to, std::string const& sentence) {
  Quantity const q = positive("", 1e-6, 1e6);
  if (reading_ && type_of(key) != LUA_TTABLE) {
    double all = 1;
    bool const right = number(key, all, q, sentence, Need::required);
    if (right) to = Vec3::Constant(all);
    return right;
  }
  declare(key, "number, { x, y } or { x, y, z }", q, "required", sentence);
  if (!reading_ || !push(key, Need::required, "vector", sentence)) return false;
  double given[3] = {to[0], to[1], to[2]};
  bool const right = list_of_numbers(key, given, 2, 3, q);
  pop();
  if (right) to = Vec3(given[0], given[1], given[2]);
  return right;
}

bool Form::extent(std::string const& key, Vec3& to, std::string const& sentence) {
  Quantity const q = positive("m", 1e-7, 1e5);
  declare(key, "{ x, y } or { x, y, z }", q, "required", sentence);
  if (!reading_ || !push(key, Need::required, "vector", sentence)) return false;
  double given[3] = {0, 0, 0};
  bool right = list_of_numbers(key, given, 2, 3, q);
  pop();
  if (right && script_.dimension == 3 && given[2] == 0) {
    problem(fmt::format("{} needs a third number in three dimensions: its extent along z", label(key)), key);
    right = false;
  }
  if (right) to = Vec3(given[0], given[1], given[2]);
  return right;
}

bool Form::point(std::string const& key, std::array<double, 2>& to, std::string const& sentence) {
  declare(key, "{ x, y }", any_number("m"), "required", sentence);
  if (!reading_ || !push(key, Need::required, "point", sentence)) return false;
  bool const right = list_of_numbers(key, to.data(), 2, 2, any_number("m"));
  pop();
  return right;
}

bool Form::only_a_list(int table) const {
  std::size_t entries = 0, in_row = 0;
  for (lua_pushnil(state()); lua_next(state(), table); lua_pop(state(), 1)) ++entries;
  while (lua_rawgeti(state(), table, static_cast<lua_Integer>(in_row + 1)) != LUA_TNIL) ++in_row, lua_pop(state(), 1);
  lua_pop(state(), 1);
  return entries == in_row;
}

template <std::size_t N>
bool Form::list_of_points(std::string const& key, std::vector<std::array<double, N>>& to, std::string const& sentence,
                          Need need) {
  std::string const point = N == 2 ? "{ x, y }" : "{ x, y, z }";
  declare(key, "list of " + point, any_number("m"), need == Need::required ? "required" : "left out", sentence);
  if (!reading_ || !push(key, need, "list", sentence)) return false;
  bool right = expect_type(key, LUA_TTABLE, ("a list of points " + point).c_str());
  if (right) {
    int const list = lua_gettop(state());
    std::size_t const n = lua_rawlen(state(), list);
    if (n > longest_list)
      problem(fmt::format("{} has more than {} points", label(key), longest_list), key), right = false;
    for (std::size_t i = 0; right && i < n; ++i) {
      std::array<double, N> p{};
      lua_rawgeti(state(), list, static_cast<lua_Integer>(i + 1));
      right = list_of_numbers(key, p.data(), N, N, any_number("m"));
      lua_pop(state(), 1);
      to.push_back(p);
    }
  }
  pop();
  return right;
}

bool Form::points(std::string const& key, std::vector<std::array<double, 2>>& to, std::string const& sentence) {
  return list_of_points(key, to, sentence, Need::required);
}

bool Form::points(std::string const& key, std::vector<std::array<double, 3>>& to, std::string const& sentence,
                  Need need) {
  return list_of_points(key, to, sentence, need);
}

bool Form::curves(std::string const& key, std::string const& name, std::vector<Curve>& to, Quantity const& q,
                  std::string const& sentence) {
  declare(key, "number, list or function(strain, rate)", q, "required", sentence);
  if (!reading_ || !push(key, Need::required, "number, a list or a function", sentence)) return false;
  lua_State* const L = state();
  int const given = lua_gettop(L);
  // The pairs of the list at the top of the stack.
  auto const pairs = [&](Curve& curve, bool named) {
    std::size_t const n = lua_rawlen(L, -1);
    bool right = n > 0 && n <= longest_list;
    if (!right)
      problem(fmt::format("{} is a list of {} pairs {{ x, y }}; it needs at least one and at most {}", label(key), n,
                          longest_list),
              key);
    for (std::size_t i = 0; right && i < n; ++i) {
      lua_rawgeti(L, -1, static_cast<lua_Integer>(i + 1));
      right = lua_istable(L, -1);
      if (!right)
        problem(
            fmt::format("{}: entry {} must be a pair {{ x, y }}, not a {}{}", label(key), i + 1, luaL_typename(L, -1),
                        named ? fmt::format(" ({} stands beside the pairs of a list, not in a pair)", name) : ""),
            key);
      if (right && lua_rawlen(L, -1) > 0) {
        right = lua_rawgeti(L, -1, 1) != LUA_TTABLE;
        lua_pop(L, 1);
        if (!right)
          problem(
              fmt::format("{}: entry {} is a list of pairs; each of several lists needs {} =", label(key), i + 1, name),
              key);
      }
      right = right && list_of_numbers(key, curve.points.emplace_back().data(), 2, 2, any_number(q.unit.c_str()));
      lua_pop(L, 1);
    }
    return right;
  };
  bool right = true;
  if (lua_type(L, given) != LUA_TTABLE) {
    to.emplace_back().points.push_back({0, 0});
    right = checked_number(key, to[0].points[0][1], q, label(key));
  } else {
    lua_rawgeti(L, given, 1);  // a list of lists begins with a table that has the name
    bool several = false;
    if (lua_istable(L, -1)) several = lua_getfield(L, -1, name.c_str()) != LUA_TNIL, lua_pop(L, 1);
    lua_pop(L, 1);
    if (!several) right = pairs(to.emplace_back(), false);
    for (std::size_t i = 0; several && right && i < lua_rawlen(L, given); ++i) {
      lua_rawgeti(L, given, static_cast<lua_Integer>(i + 1));
      Curve& curve = to.emplace_back();
      right = expect_type(key, LUA_TTABLE, ("lists with " + name + " =").c_str());
      if (right) {
        lua_getfield(L, -1, name.c_str());
        right = checked_number(key, curve.at, any_number(""), label(key) + fmt::format("[{}].{}", i + 1, name));
        lua_pop(L, 1);
        right = right && pairs(curve, true);
      }
      lua_pop(L, 1);
    }
  }
  pop();
  return right;
}

bool Form::interval(std::string const& key, double& least, double& most, std::string const& sentence) {
  declare(key, "{ least, most }", {}, "left out", sentence);
  if (!reading_ || !push(key, Need::optional, "pair", sentence)) return false;
  double given[2] = {0, 0};
  bool right = list_of_numbers(key, given, 2, 2, {});
  pop();
  if (right && given[0] > given[1])
    problem(fmt::format("{} = {{ {}, {} }} is empty; the smaller number comes first", label(key), shown(given[0]),
                        shown(given[1])),
            key),
        right = false;
  if (right) least = given[0], most = given[1];
  return right;
}

}  // namespace fissure::lua
