#include "lua/form.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lua/reader.h"

namespace fissure::lua {
namespace {

constexpr std::size_t longest_text = 200;

std::string joined(std::vector<std::string> const& words, char const* between) {
  std::string all;
  for (auto const& word : words) all += (all.empty() ? "" : between) + ('"' + word + '"');
  return all;
}

std::string bounds_text(Quantity const& q) {
  bool const below = std::isfinite(q.least), above = std::isfinite(q.most);
  std::string const least = (q.least_excluded ? "> " : ">= ") + shown(q.least);
  std::string const most = (q.most_excluded ? "< " : "<= ") + shown(q.most);
  return below && above ? least + ", " + most : below ? least : above ? most : "";
}

bool within(Quantity const& q, double value) {
  return (q.least_excluded ? value > q.least : value >= q.least) &&
         (q.most_excluded ? value < q.most : value <= q.most);
}

std::string with_unit(std::string const& number, std::string const& unit) {
  return unit.empty() ? number : number + " " + unit;
}

}  // namespace

std::string in_quotes(std::string const& text) {
  std::string result = "\"";
  for (char const c : text.substr(0, 60)) result += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
  return result + (text.size() > 60 ? "...\"" : "\"");
}

std::string shown(double value) { return fmt::format("{:g}", value); }

char const* kind_name(Kind kind) {
  static char const* const names[kind_count] = {"shape", "material", "body", "plate", "wall",
                                                "hold",  "spring",   "tie",  "now"};
  return names[static_cast<int>(kind)];
}

Quantity any_number(char const* unit) { return {unit}; }
Quantity positive(char const* unit, double usual_least, double usual_most) {
  return {unit, 0, unlimited, usual_least, usual_most, true, false};
}
Quantity not_negative(char const* unit, double usual_most) { return {unit, 0, unlimited, 0, usual_most, false, false}; }

Form::Form(Script& script, std::string verb, Source source)
    : script_(script), reading_(true), verb_(verb), subject_(std::move(verb)), source_(std::move(source)) {
  arguments_ = lua_gettop(state());
  if (arguments_ == 1 && lua_istable(state(), 1)) table_ = 1;
}

Form::Form(Form const& outer, std::string const& key, int table)
    : script_(outer.script_),
      reading_(true),
      verb_(outer.verb_),
      subject_(outer.subject_),
      path_(outer.path_),
      source_(outer.source_),
      table_(table) {
  path_.push_back(key);
}

lua_State* Form::state() const { return script_.state(); }

std::string Form::label(std::string const& key) const {
  std::string all;
  for (auto const& outer : path_) all += outer + ".";
  return key == "[]" ? all + fmt::format("entry {}", position_) : all + key;
}

Source Form::place_of(std::string const& key) const {
  if (key.empty() || key == "[]") return source_;
  auto path = path_;
  path.push_back(key);
  return {source_.file, script_.line_of(source_, verb_, path)};
}

void Form::problem(std::string const& text, std::string const& key) {
  ok_ = false;
  if (reading_) script_.problem(place_of(key), subject_ + ": " + text);
}

void Form::warning(std::string const& text, std::string const& key) {
  auto& warnings = script_.scene.warnings;
  std::string const line = place_of(key).prefix() + subject_ + ": " + text;
  if (reading_ && warnings.size() < 100 && std::find(warnings.begin(), warnings.end(), line) == warnings.end())
    warnings.push_back(line);
}

void Form::claim(std::string const& name) {
  if (!reading_) return;
  auto const [place, fresh] = script_.names.try_emplace({verb_, name}, source_);
  if (!fresh) problem(fmt::format("there is a {} of this name already (line {})", verb_, place->second.line));
}

std::size_t Form::declare(std::string const& key, std::string const& type, Quantity const& q,
                          std::string const& fallback, std::string const& sentence) {
  std::string const name = key == "[]" ? fmt::format("entry {}", position_ + 1) : key;
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (entries_[i].key == name) {
      if (!laws_.empty() && !entries_[i].laws.empty()) entries_[i].laws.push_back(laws_[0]);
      return i;
    }
  entries_.push_back({name, type, q.unit, bounds_text(q), fallback, sentence, laws_, {}});
  if (key == "[]" && !reading_) ++position_;
  return entries_.size() - 1;
}

bool Form::push(std::string const& key, Need need, std::string const& type, std::string const& sentence) {
  lua_State* const L = state();
  if (key == "[]") {
    ++position_;
    if (table_)
      lua_rawgeti(L, table_, position_);
    else if (position_ <= arguments_)
      lua_pushvalue(L, position_);
    else
      lua_pushnil(L);
  } else if (table_) {
    lua_pushlstring(L, key.data(), key.size());
    lua_rawget(L, table_);
  } else {
    lua_pushnil(L);
  }
  if (key != "[]" && !script_.settings.empty()) replace(key);
  if (!lua_isnil(L, -1)) return true;
  pop();
  if (need == Need::required)
    missing_.emplace_back(key, fmt::format("{} is missing (a {}: {})", label(key), type, sentence));
  return false;
}

void Form::pop() { lua_pop(state(), 1); }

void Form::replace(std::string const& key) {
  std::string const name = verb_ + "." + label(key);
  script_.asked_keys.insert(name);
  for (auto const& setting : script_.settings) {
    if (setting.name != name) continue;
    script_.set_keys.insert(name);
    lua_State* const L = state();
    bool const times = setting.text.rfind('*', 0) == 0;
    char const* const begin = setting.text.c_str() + times;
    char* end = nullptr;
    double const number = std::strtod(begin, &end);
    bool const is_number = end != begin && *end == '\0';
    if (setting.text.empty() || (!is_number && end != begin)) {
      problem(fmt::format("--set {}={}: \"{}\" is not a number (SI units, no names: 3e-3, not 3*mm)", name,
                          setting.text, setting.text),
              key);
      continue;
    }
    if (times && (!is_number || lua_type(L, -1) != LUA_TNUMBER)) {
      problem(fmt::format("--set {}={} multiplies a number of the scene, and {}", name, setting.text,
                          is_number ? "it says none here; give the number itself" : "this is none to multiply with"),
              key);
      continue;
    }
    double const factor = times ? lua_tonumber(L, -1) : 1;
    pop();
    if (is_number)
      lua_pushnumber(L, number * factor);
    else if (setting.text == "true" || setting.text == "false")
      lua_pushboolean(L, setting.text == "true");
    else
      lua_pushlstring(L, setting.text.data(), setting.text.size());
  }
}

int Form::type_of(std::string const& key) {
  if (!reading_) return LUA_TNIL;
  int const before = position_;
  int type = LUA_TNIL;
  if (push(key, Need::optional, "", "")) {
    type = lua_type(state(), -1);
    pop();
  }
  position_ = before;
  return type;
}

bool Form::next_is_text() { return type_of("[]") == LUA_TSTRING; }

bool Form::expect_type(std::string const& key, int type, char const* expected) {
  if (lua_type(state(), -1) == type) return true;
  Handle const* const handle = script_.handle_at(-1);
  problem(fmt::format("{} must be {}, not a {}", label(key), expected,
                      handle ? kind_name(handle->kind) : luaL_typename(state(), -1)),
          key);
  return false;
}

bool Form::checked_number(std::string const& key, double& to, Quantity const& q, std::string const& label) {
  if (lua_type(state(), -1) != LUA_TNUMBER) {
    Handle const* const handle = script_.handle_at(-1);
    problem(fmt::format("{} must be a number{}, not a {}", label, q.unit.empty() ? "" : " in " + q.unit,
                        handle ? kind_name(handle->kind) : luaL_typename(state(), -1)),
            key);
    return false;
  }
  double const value = lua_tonumber(state(), -1);
  if (!std::isfinite(value)) {
    problem(fmt::format("{} is {} (a division by zero?)", label, std::isnan(value) ? "not a number (nan)" : "infinite"),
            key);
    return false;
  }
  if (!within(q, value)) {
    problem(
        fmt::format("{} = {} is not allowed (it must be {}){}", label, with_unit(shown(value), q.unit), bounds_text(q),
                    q.unit == "rad" && value > q.most ? fmt::format("; degrees are written {}*deg", shown(value)) : ""),
        key);
    return false;
  }
  if (value < q.usual_least || value > q.usual_most)
    warning(fmt::format("{} = {} is unusual (seen in practice: {} to {}){}", label, with_unit(shown(value), q.unit),
                        shown(q.usual_least), with_unit(shown(q.usual_most), q.unit),
                        q.unit.empty() ? "" : "; is a unit missing?"),
            key);
  to = value;
  return true;
}

void Form::name(std::string& to, std::size_t count, Need need, char const* sentence) {
  declare("[]", "text", {},
          need == Need::required ? "required"
          : verb_.empty()        ? "by order"
                                 : verb_ + " 1, ...",
          sentence);
  if (!reading_) return;
  to = fmt::format("{} {}", verb_, count + 1);
  if (type_of("[]") != LUA_TSTRING) {
    if (need == Need::required)
      missing_.emplace_back("[]", fmt::format("the name is missing (a text in front: {}{{ \"name\", ... }})", verb_));
    if (need == Need::required && type_of("[]") == LUA_TNIL) ++position_;
    return;
  }
  std::string given;
  if (!text("[]", given, sentence, need)) return;
  subject_ = verb_ + " " + in_quotes(given);
  if (given.empty()) problem("the name is empty");
  to = given;
}

bool Form::number(std::string const& key, double& to, Quantity const& q, std::string const& sentence, Need need) {
  declare(key, "number", q, need == Need::required ? "required" : shown(to), sentence);
  if (!reading_ || !push(key, need, "number", sentence)) return false;
  bool const right = checked_number(key, to, q, label(key));
  pop();
  return right;
}

bool Form::number(std::string const& key, std::optional<double>& to, Quantity const& q, std::string const& sentence) {
  declare(key, "number", q, "left out", sentence);
  double value = 0;
  if (!reading_ || !push(key, Need::optional, "number", sentence)) return false;
  bool const right = checked_number(key, value, q, label(key));
  pop();
  if (right) to = value;
  return right;
}

bool Form::boolean(std::string const& key, bool& to, std::string const& sentence) {
  declare(key, "boolean", {}, to ? "true" : "false", sentence);
  if (!reading_ || !push(key, Need::optional, "boolean", sentence)) return false;
  bool const right = expect_type(key, LUA_TBOOLEAN, "true or false");
  if (right) to = lua_toboolean(state(), -1);
  pop();
  return right;
}

bool Form::text(std::string const& key, std::string& to, std::string const& sentence, Need need) {
  declare(key, "text", {}, need == Need::required ? "required" : "left out", sentence);
  if (!reading_ || !push(key, need, "text", sentence)) return false;
  bool right = expect_type(key, LUA_TSTRING, "a text");
  if (right) {
    std::size_t n = 0;
    char const* const given = lua_tolstring(state(), -1, &n);
    right = n <= longest_text && std::none_of(given, given + n, [](unsigned char c) { return c < 32 || c == 127; });
    if (right)
      to.assign(given, n);
    else
      problem(fmt::format("{} must be at most {} printable characters", label(key), longest_text), key);
  }
  pop();
  return right;
}

bool Form::word(std::string const& key, std::string& to, std::vector<std::string> const& choices,
                std::string const& sentence, Need need) {
  std::string all;
  for (auto const& choice : choices) all += (all.empty() ? "\"" : " or \"") + choice + "\"";
  declare(key, all, {}, need == Need::required ? "required" : '"' + to + '"', sentence);
  std::string given;
  if (!text(key, given, sentence, need)) return false;
  if (std::find(choices.begin(), choices.end(), given) == choices.end()) {
    problem(fmt::format("{} = {} is unknown (it can be {}){}", label(key), in_quotes(given), joined(choices, ", "),
                        suggestion(given, choices)),
            key);
    return false;
  }
  to = given;
  return true;
}

bool Form::words(std::string const& key, std::vector<std::string>& to, std::vector<std::string> const& choices,
                 std::string const& sentence) {
  declare(key, "list of texts", {}, to.empty() ? "{}" : "{ " + joined(to, ", ") + " }",
          choices.empty() ? sentence : sentence + ": " + joined(choices, ", "));
  if (!reading_ || !push(key, Need::optional, "list", sentence)) return false;
  bool right = expect_type(key, LUA_TTABLE, "a list of texts");
  if (right) {
    to.clear();
    int const list = lua_gettop(state());
    for (lua_pushnil(state()); lua_next(state(), list); lua_pop(state(), 1)) {
      std::string const given = lua_type(state(), -1) == LUA_TSTRING ? lua_tostring(state(), -1) : "";
      bool const known =
          lua_type(state(), -2) == LUA_TNUMBER &&
          (choices.empty() ? !given.empty() : std::find(choices.begin(), choices.end(), given) != choices.end());
      bool const twice = std::find(to.begin(), to.end(), given) != to.end();
      if (known && !twice)
        to.push_back(given);
      else {
        if (twice)
          problem(fmt::format("{} has {} twice", label(key), in_quotes(given)), key);
        else if (given.empty())
          problem(fmt::format("{} has an entry that is no text", label(key)), key);
        else
          problem(fmt::format("{} has the unknown {} (it can have {}){}", label(key), in_quotes(given),
                              joined(choices, ", "), suggestion(given.substr(0, 60), choices)),
                  key);
        right = false;
        if (script_.problems.size() > 90) break;
      }
    }
    lua_settop(state(), list);
  }
  pop();
  return right;
}

bool Form::take_function(std::string const& key, Callee& to, std::string const& what) {
  if (!expect_type(key, LUA_TFUNCTION, "a function")) return false;
  lua_pushvalue(state(), -1);
  to = {luaL_ref(state(), LUA_REGISTRYINDEX), place_of(key), what};
  return true;
}

bool Form::take_time_function(std::string const& key, scene::TimeFunction& to, Quantity const& q,
                              std::string const& label) {
  if (lua_type(state(), -1) != LUA_TFUNCTION) return checked_number(key, to.number, q, label);
  Callee callee;
  if (!take_function(key, callee, label + " of " + subject_)) return false;
  to.function = [&script = script_, callee](double t) { return script.ask_number(callee, t); };
  try {
    to.function(0);
  } catch (Error const& error) {
    ok_ = false;
    script_.problem({}, error.what());
    return false;
  }
  return true;
}

bool Form::time_function(std::string const& key, scene::TimeFunction& to, char const* unit, std::string const& sentence,
                         Need need) {
  declare(key, "number or function(t)", any_number(unit),
          need == Need::required ? "required" : fmt::format("{:g}", to.number), sentence);
  if (!reading_ || !push(key, need, "number or a function of time", sentence)) return false;
  bool const right = take_time_function(key, to, any_number(unit), label(key));
  pop();
  return right;
}

bool Form::directions(std::string const& key, scene::Directions& to, char const* unit, std::string const& sentence,
                      Need need) {
  declare(key, "{ x, y, z }, each a number, function(t) or nil", any_number(unit),
          need == Need::required ? "required" : "left out", sentence);
  if (!reading_ || !push(key, need, "vector", sentence)) return false;
  lua_State* const L = state();
  bool right = expect_type(key, LUA_TTABLE, "components { x, y, z }");
  if (right) {
    int const list = lua_gettop(L);
    int given = 0, entries = 0;
    for (int i = 0; i < 3; ++i) {
      std::string const component = fmt::format("{}[{}]", label(key), i + 1);
      if (lua_rawgeti(L, list, i + 1) != LUA_TNIL) {
        ++given;
        scene::TimeFunction f;
        bool const fine = take_time_function(key, f, any_number(unit), component);
        right = right && fine;
        if (i < script_.dimension)
          to[static_cast<std::size_t>(i)] = f;
        else if (fine && (!f.constant() || f.number != 0)) {
          problem(fmt::format("{} is given, and there is no z in two dimensions; write 0 or leave it out", component),
                  key);
          right = false;
        }
      }
      lua_pop(L, 1);
    }
    for (lua_pushnil(L); lua_next(L, list) && entries <= 3; lua_pop(L, 1)) ++entries;
    lua_settop(L, list);
    if (right && entries != given)
      problem(fmt::format("{} can only have the components 1, 2 and 3 (x, y, z)", label(key)), key), right = false;
    if (right && given == 0)
      problem(fmt::format("{} prescribes nothing (every component is nil)", label(key)), key), right = false;
  }
  pop();
  return right;
}

bool Form::region(std::string const& key, scene::Region& to, std::string const& sentence) {
  declare(key, "text or function(x, y, z)", {}, "required", sentence);
  if (!reading_ || !push(key, Need::required, "name or a function(x, y, z)", sentence)) return false;
  pop();
  if (type_of(key) != LUA_TFUNCTION) return text(key, to.name, sentence, Need::required);
  push(key, Need::required, "", "");
  bool const right = take_predicate(key, to.inside);
  pop();
  return right;
}

bool Form::predicate(std::string const& key, std::function<bool(double, double, double)>& to,
                     std::string const& sentence, std::string const& left_out) {
  declare(key, "function(x, y, z)", {}, left_out, sentence);
  if (!reading_ || !push(key, Need::optional, "function(x, y, z)", sentence)) return false;
  bool const right = take_predicate(key, to);
  pop();
  return right;
}

/// From the top of the stack; it is asked once.
bool Form::take_predicate(std::string const& key, std::function<bool(double, double, double)>& to) {
  Callee callee;
  bool right = take_function(key, callee, label(key) + " of " + subject_);
  if (!right) return false;
  to = [&script = script_, callee](double x, double y, double z) { return script.ask_inside(callee, x, y, z); };
  try {
    to(0, 0, 0);
  } catch (Error const& error) {
    script_.problem({}, error.what());
    ok_ = right = false;
  }
  return right;
}

bool Form::function(std::string const& key, Callee& to, char const* signature, std::string const& sentence, Need need) {
  declare(key, signature, {}, need == Need::required ? "required" : "left out", sentence);
  if (!reading_ || !push(key, need, signature, sentence)) return false;
  bool const right = take_function(key, to, key == "[]" ? subject_ : label(key) + " of " + subject_);
  pop();
  return right;
}

bool Form::handle(std::string const& key, Kind kind, int& index, std::string const& sentence, Need need) {
  declare(key, kind_name(kind), {}, need == Need::required ? "required" : "left out", sentence);
  if (!reading_ || !push(key, need, kind_name(kind), sentence)) return false;
  Handle const* const handle = script_.handle_at(-1);
  bool const right = handle && handle->kind == kind;
  if (right)
    index = handle->index;
  else
    problem(fmt::format("{} must be a {}, not a {}", label(key), kind_name(kind),
                        handle ? kind_name(handle->kind) : luaL_typename(state(), -1)),
            key);
  pop();
  return right;
}

std::vector<int> Form::handles(Kind kind, std::string const& sentence) {
  std::vector<int> all;
  declare("[]",
          fmt::format("{}, one after another", kind == Kind::body ? "bodies" : std::string(kind_name(kind)) + "s"), {},
          "required", sentence);
  if (!reading_) return all;
  while (all.size() < longest_list && type_of("[]") != LUA_TNIL) {
    int index = -1;
    if (!handle("[]", kind, index, sentence)) break;
    all.push_back(index);
  }
  return all;
}

bool Form::done() {
  if (!reading_) return false;
  lua_State* const L = state();
  std::vector<std::string> known, unknown;
  for (auto const& entry : entries_)
    if (entry.key.rfind("entry ", 0) != 0) known.push_back(entry.key);
  bool strange = false, number = false;
  if (table_)
    for (lua_pushnil(L); lua_next(L, table_); lua_pop(L, 1)) {
      if (lua_type(L, -2) == LUA_TSTRING) {
        std::size_t n = 0;
        char const* const text = lua_tolstring(L, -2, &n);
        std::string const key(text, n);
        if (std::find(known.begin(), known.end(), key) == known.end() && unknown.size() < 20)
          unknown.push_back(key.substr(0, 100));
      } else {
        strange = strange || lua_type(L, -2) != LUA_TNUMBER || !lua_isinteger(L, -2) || lua_tointeger(L, -2) < 1 ||
                  lua_tointeger(L, -2) > position_;
        number = number || (strange && lua_type(L, -1) == LUA_TNUMBER);
      }
    }
  std::sort(unknown.begin(), unknown.end());
  for (auto const& key : unknown) {
    std::string where;
    for (auto const& outer : path_) where += (where.empty() ? " in " : ".") + outer;
    problem(fmt::format("unknown key {}{}{}", in_quotes(key), where, suggestion(key, known)), key);
    std::erase_if(missing_, [&](auto const& missing) {
      return missing.first == nearest_word(key, known);
    });  // one mistake, said once
  }
  bool const plain = !table_ && arguments_ > position_;
  if (plain && position_ == 0) {  // disc(25*mm, 10*mm): one mistake, said once
    auto const verb = std::find_if(verbs().begin(), verbs().end(), [&](Verb const& one) { return one.name == verb_; });
    problem(fmt::format("takes keys with values in braces{}",
                        verb == verbs().end() ? "" : fmt::format("; write {}", verb->example)));
    return ok_;
  }
  for (auto const& missing : missing_) problem(missing.second);
  if (plain) problem(fmt::format("takes at most {} values, not {}", position_, arguments_));
  if (strange)
    problem(path_.empty() ? fmt::format("has an entry without a key that means nothing here (it takes {}){}",
                                        position_ ? std::to_string(position_) : "none",
                                        number ? "; decimals stand behind a point, not a comma: 25.5" : "")
                          : fmt::format("{} has an entry without a key; write key = value", path_.back()));
  return ok_;
}

}  // namespace fissure::lua
