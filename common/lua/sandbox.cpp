#include "lua/sandbox.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "base/error.h"

namespace fissure::lua {
namespace {

int const globals_key = 0, environment_key = 0;  // their addresses are registry keys

// What scripts get instead of Lua's own. pairs goes through keys in a fixed order, so that a scene is the same scene in
// every run; random numbers are repeatable; what loops over a list is bounded, because nothing can interrupt it.
char const* const prelude = R"lua(
local next, type, error, sort, seed = next, type, error, table.sort, math.randomseed
local function bound(name, most)
  local f = table[name]
  table[name] = function(list, ...)
    if type(list) == "table" and #list > most then
      error("table." .. name .. " is for lists of at most " .. most .. " entries", 2)
    end
    return f(list, ...)
  end
end
bound("sort", 100000)
bound("insert", 1000000)
bound("remove", 1000000)
local rep = string.rep
function string.rep(s, n, between)  -- of nothing: Lua's own counts to n
  if s == "" and (between == nil or between == "") then return "" end
  return rep(s, n, between)
end
local order = { number = 1, string = 2 }
local function before(a, b)
  local p, q = order[type(a)] or 3, order[type(b)] or 3
  if p ~= q then return p < q end
  return p < 3 and a < b
end
function pairs(t)
  if type(t) ~= "table" then error("pairs needs a table, not a " .. type(t), 2) end
  local keys = {}
  for key in next, t do keys[#keys + 1] = key end
  if #keys > 100000 then error("pairs is for tables of at most 100000 entries", 2) end
  sort(keys, before)
  local i = 0
  return function()
    i = i + 1
    local key = keys[i]
    if key ~= nil then return key, t[key] end
  end
end
function math.randomseed(n)
  if type(n) ~= "number" then error("math.randomseed needs a number: a scene must be the same in every run", 2) end
  seed(n)
end
seed(1)
)lua";

// The innermost place in a user's file; the sandbox's own chunks start with "=" and do not count. Lua finds a level by
// walking to it: what has called itself a thousand times is looked at no further.
bool user_code(lua_State* L, lua_Debug& at) {
  for (int level = 0; level < 1000 && lua_getstack(L, level, &at); ++level)
    if (lua_getinfo(L, "Sl", &at) && at.currentline > 0 && at.source[0] == '@') return true;
  return false;
}

// Reading a name: only what exists. Written without C++ objects because it raises.
int read_global(lua_State* L) {
  lua_rawgetp(L, LUA_REGISTRYINDEX, &globals_key);
  lua_pushvalue(L, 2);
  if (lua_rawget(L, -2) != LUA_TNIL) return 1;
  int const results = Sandbox::of(L).guarded([&]() -> int {
    char const* const text = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "?";
    std::string const word = std::string(text).substr(0, 60);
    std::vector<std::string> known;
    lua_rawgetp(L, LUA_REGISTRYINDEX, &globals_key);
    for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1))
      if (lua_type(L, -2) == LUA_TSTRING) known.emplace_back(lua_tostring(L, -2));
    std::sort(known.begin(), known.end());
    Sandbox const& sandbox = Sandbox::of(L);
    lua_Debug at;
    int const later = user_code(L, at) ? sandbox.declared_after(at.source + 1, at.currentline, word) : 0;
    throw std::runtime_error("unknown name \"" + word + "\"" +
                             (later ? fmt::format("; it is declared below, in line {}: move that line up", later)
                                    : suggestion(word, known)));
  });
  return results < 0 ? lua_error(L) : results;
}

int write_global(lua_State* L) {
  int const results = Sandbox::of(L).guarded([&]() -> int {
    std::string const word = lua_type(L, 2) == LUA_TSTRING ? std::string(lua_tostring(L, 2)).substr(0, 60) : "x";
    lua_rawgetp(L, LUA_REGISTRYINDEX, &globals_key);
    lua_pushstring(L, word.c_str());
    int const there = lua_rawget(L, -2);
    if (there == LUA_TFUNCTION)
      throw std::runtime_error("\"" + word + "\" is a verb, which is used without =; write " + word + "{ ... }");
    if (there != LUA_TNIL) throw std::runtime_error("\"" + word + "\" means something already; choose another name");
    throw std::runtime_error("\"" + word + "\" would be a global variable; write \"local " + word + "\"");
  });
  return results < 0 ? lua_error(L) : results;
}

// string.find without patterns: a bad pattern can run for years and nothing can interrupt it.
int find_plain(lua_State* L) {
  std::size_t n = 0, m = 0;
  char const* const text = luaL_checklstring(L, 1, &n);
  char const* const word = luaL_checklstring(L, 2, &m);
  void const* const found = m == 0 ? text : memmem(text, n, word, m);
  if (!found) return 0;
  auto const start = static_cast<char const*>(found) - text;
  lua_pushinteger(L, start + 1);
  lua_pushinteger(L, start + static_cast<lua_Integer>(m));
  return 2;
}

bool word_char(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// What Lua says about commas that are missing, and about words of other languages, names neither.
std::string with_hint(std::string const& error) {
  static constexpr std::pair<std::string_view, std::string_view> foreign[] = {
      {"near '//'", "a comment begins with --"},
      {"near '!'", "Lua writes ~= for unequal, and not in front of what is denied"},
      {"near '&'", "Lua writes the word: and"},
      {"near '|'", "Lua writes the word: or"},
      {"')' expected near '='", "keys with values stand in braces: name{ key = value }"}};
  for (auto const& [told, hint] : foreign)
    if (error.size() >= told.size() && error.compare(error.size() - told.size(), told.size(), told) == 0)
      return error + "; " + std::string(hint);
  static constexpr std::string_view before = "attempt to call a number value (field '";
  if (auto const at = error.find(before); at != std::string::npos) {
    std::string const field =
        error.substr(at + before.size(), error.find('\'', at + before.size()) - at - before.size());
    return error + "; \"" + field + "\" is a number already: write it without ()";
  }
  auto const expected = error.find("'}' expected"), near = error.rfind(" near '");
  if (expected == std::string::npos || near == std::string::npos || near + 7 >= error.size()) return error;
  char const next = error[near + 7];
  bool const entry = word_char(next) || next == '"' || next == '{' || next == '[';
  return entry ? error + fmt::format("; a comma may be missing before {}", error.substr(near + 6)) : error;
}

void copy_fields(lua_State* L, int from, int to, std::initializer_list<char const*> names) {
  for (char const* name : names) {
    lua_getfield(L, from, name);
    lua_setfield(L, to, name);
  }
}

}  // namespace

void* Sandbox::allocate(void* sandbox, void* block, std::size_t old_size, std::size_t size) {
  auto& s = *static_cast<Sandbox*>(sandbox);
  std::size_t const before = block ? old_size : 0;
  if (size == 0) {
    std::free(block);
    s.used_ -= before;
    return nullptr;
  }
  if (s.limited_ && size > before) {
    if (s.used_ - before + size > memory_limit) return nullptr;
    if ((size > 65536 || ++s.allocations_ % 64 == 0) && s.late()) return nullptr;  // long C functions allocate
  }
  void* const result = std::realloc(block, size);
  if (result) s.used_ += size - before;
  return result;
}

void Sandbox::watch(lua_State* L, lua_Debug*) {
  Sandbox& s = of(L);
  if (s.limited_ && s.late()) {
    lua_pushliteral(L, "out of time");
    lua_error(L);
  }
}

// Message handler: errors get the full name of the file, and a place when they have none.
int Sandbox::place_error(lua_State* L) {
  if (lua_type(L, 1) != LUA_TSTRING) {
    char const* const type = luaL_typename(L, 1);
    lua_pushfstring(L, "the script raised an error that is not a text but a %s", type);
    lua_replace(L, 1);
  }
  lua_Debug at;
  if (!user_code(L, at)) return 1;
  char const* message = lua_tostring(L, 1);
  std::size_t const n = std::strlen(at.short_src);
  if (std::strncmp(message, at.short_src, n) == 0 && message[n] == ':')
    lua_pushfstring(L, "%s%s", at.source + 1, message + n);
  else
    lua_pushfstring(L, "%s:%d: %s", at.source + 1, at.currentline, message);
  return 1;
}

Sandbox::Sandbox() {
  state_ = lua_newstate(&Sandbox::allocate, this);
  if (!state_) throw Error("no memory for a Lua interpreter");
  *static_cast<Sandbox**>(lua_getextraspace(state_)) = this;
  open_libraries();
  lua_sethook(state_, &Sandbox::watch, LUA_MASKCALL | LUA_MASKCOUNT, 100);
}

Sandbox::~Sandbox() { lua_close(state_); }

void Sandbox::open_libraries() {
  lua_State* const L = state_;
  luaL_requiref(L, LUA_GNAME, luaopen_base, 1);
  luaL_requiref(L, LUA_MATHLIBNAME, luaopen_math, 1);
  luaL_requiref(L, LUA_TABLIBNAME, luaopen_table, 1);
  luaL_requiref(L, LUA_STRLIBNAME, luaopen_string, 1);
  lua_settop(L, 0);
  if (luaL_loadbufferx(L, prelude, std::strlen(prelude), "=prelude", "t") != LUA_OK || lua_pcall(L, 0, 0, 0) != LUA_OK)
    throw Error(std::string("the sandbox does not start: ") + lua_tostring(L, -1));

  lua_newtable(L);         // 1: what scripts may name
  lua_pushglobaltable(L);  // 2
  copy_fields(L, 2, 1, {"assert", "error", "ipairs", "pairs", "select", "tonumber", "tostring", "type"});
  lua_getfield(L, 2, "math");
  lua_setfield(L, 1, "math");
  lua_newtable(L);              // 3
  lua_getfield(L, 2, "table");  // 4
  copy_fields(L, 4, 3, {"concat", "insert", "pack", "remove", "sort", "unpack"});
  lua_pop(L, 1);
  lua_setfield(L, 1, "table");
  lua_newtable(L);               // 3
  lua_getfield(L, 2, "string");  // 4
  copy_fields(L, 4, 3, {"byte", "char", "format", "len", "lower", "rep", "reverse", "sub", "upper"});
  lua_pop(L, 1);
  lua_pushcfunction(L, find_plain);
  lua_setfield(L, 3, "find");
  lua_pushliteral(L, "");  // 4
  lua_getmetatable(L, 4);  // 5: ("text"):upper() must find no more than string.upper
  lua_pushvalue(L, 3);
  lua_setfield(L, 5, "__index");
  lua_settop(L, 3);
  lua_setfield(L, 1, "string");
  lua_settop(L, 1);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &globals_key);

  // Scripts see an empty table whose metatable looks names up: so every unknown name and every new global is noticed.
  lua_newtable(L);
  lua_newtable(L);
  lua_pushcfunction(L, read_global);
  lua_setfield(L, -2, "__index");
  lua_pushcfunction(L, write_global);
  lua_setfield(L, -2, "__newindex");
  lua_setmetatable(L, -2);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &environment_key);

  lua_pushnil(L);  // nothing of the full library stays within reach
  lua_setfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
}

void Sandbox::set_global(char const* name) {
  lua_rawgetp(state_, LUA_REGISTRYINDEX, &globals_key);
  lua_insert(state_, -2);
  lua_setfield(state_, -2, name);
  lua_pop(state_, 1);
}

namespace {

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

Sandbox::Deadline Sandbox::in(double seconds) {
  using Clock = std::chrono::steady_clock;
  return {Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)),
          processor_seconds() + seconds};
}

bool Sandbox::late() const {
  return std::chrono::steady_clock::now() > deadline_.clock && processor_seconds() > deadline_.processor;
}

void Sandbox::limit_time(double seconds) {
  seconds_ = seconds;
  deadline_ = seconds > 0 ? in(seconds) : Deadline{};
}

std::string Sandbox::call(int arguments, int results, double seconds) {
  int const base = lua_gettop(state_) - arguments;
  lua_pushcfunction(state_, place_error);
  lua_insert(state_, base);

  auto const outer_deadline = deadline_;
  double const outer_seconds = seconds_;
  bool const outer_limited = limited_;
  Deadline const mine = in(seconds);
  if (mine.processor < deadline_.processor) deadline_ = mine, seconds_ = seconds;
  limited_ = true;
  int const status = lua_pcall(state_, arguments, results, base);
  limited_ = outer_limited;

  std::string error;
  if (status != LUA_OK) {
    char const* const text = lua_type(state_, -1) == LUA_TSTRING ? lua_tostring(state_, -1) : "an error without a text";
    if (late()) {
      std::string const message = text;
      auto const tail = message.rfind(": out of time");
      error = (tail == std::string::npos ? "" : message.substr(0, tail) + ": ") +
              fmt::format("the script ran for more than {:g} s (a loop that never ends?)", seconds_);
    } else if (status == LUA_ERRMEM) {
      error = fmt::format("the script needs more than {} MiB of memory (a loop that never ends?)", memory_limit >> 20);
    } else if (status == LUA_ERRERR) {
      error = "the script calls itself too deeply (a function that never returns?)";
    } else {
      error = with_hint(text);
    }
    lua_settop(state_, base - 1);
  } else {
    lua_remove(state_, base);
  }
  deadline_ = outer_deadline;
  seconds_ = outer_seconds;
  return error;
}

std::string Sandbox::load(std::string const& text, std::string const& name) {
  std::size_t start = text.rfind("\xEF\xBB\xBF", 0) == 0 ? 3 : 0;
  if (text.rfind("\xFF\xFE", 0) == 0 || text.rfind("\xFE\xFF", 0) == 0)
    return name.substr(1) + ": the text is in UTF-16 (only UTF-8 and ASCII are read); save it as UTF-8";
  // its end counts as a line
  if (text.compare(start, 1, "#") == 0) start = std::min(text.find('\n', start), text.size());
  if (text.compare(start, std::strlen(LUA_SIGNATURE), LUA_SIGNATURE) == 0)
    return name.substr(1) + ": a compiled Lua program (only text is read)";
  texts_[name.substr(1)] = text;
  bool const before = limited_;
  limited_ = true;  // lua_load is protected by itself
  int const status = luaL_loadbufferx(state_, text.data() + start, text.size() - start, name.c_str(), "t");
  limited_ = before;
  if (status == LUA_OK) {
    lua_rawgetp(state_, LUA_REGISTRYINDEX, &environment_key);
    lua_setupvalue(state_, -2, 1);
    return "";
  }
  std::string error = lua_type(state_, -1) == LUA_TSTRING ? lua_tostring(state_, -1) : "an error without a text";
  if (status == LUA_ERRMEM)
    error = late() ? fmt::format("the script takes more than {:g} s to read", seconds_)
                   : fmt::format("the script needs more than {} MiB of memory to read", memory_limit >> 20);
  lua_pop(state_, 1);
  // Lua shortens long file names to their tail.
  std::string const tail = name.size() >= LUA_IDSIZE ? "..." + name.substr(name.size() - (LUA_IDSIZE - 4)) : "";
  if (!tail.empty() && error.rfind(tail, 0) == 0) error = name.substr(1) + error.substr(tail.size());
  return with_hint(error.rfind(name.substr(1) + ":", 0) == 0 ? error : name.substr(1) + ": " + error);
}

int Sandbox::declared_after(std::string const& file, int line, std::string const& word) const {
  auto const found = texts_.find(file);
  if (found == texts_.end() || word.empty()) return 0;
  std::string const& text = found->second;
  std::size_t at = 0;
  int now = 1;
  for (; now <= line && at < text.size(); ++at) now += text[at] == '\n';
  for (; at < text.size(); ++now) {
    std::string const one = text.substr(at, text.find('\n', at) - at);
    std::size_t const local = one.find("local "), end = one.find('=');
    for (std::size_t i = local; i < one.size() && (i = one.find(word, i)) < std::min(end, one.size()); ++i)
      if (!word_char(one[i - 1]) && (i + word.size() == one.size() || !word_char(one[i + word.size()]))) return now;
    at += one.size() + 1;
  }
  return 0;
}

std::string Sandbox::file_now() const {
  lua_Debug at;
  return user_code(state_, at) ? at.source + 1 : "";
}

int Sandbox::line_now() const {
  lua_Debug at;
  return user_code(state_, at) ? at.currentline : 0;
}

}  // namespace fissure::lua
