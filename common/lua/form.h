// A form is what a verb of the scene language accepts. Each key is declared by one call, which reads it from a table of
// the script, checks it and says what is wrong. Without a script the same calls list the keys for the reference page.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/parameter.h"
#include "lua/sandbox.h"
#include "scene/scene.h"

namespace fissure::lua {

class Script;

/// What a verb returns: number `index` of the script's things of this kind.
enum class Kind { shape, material, body, plate, wall, hold, spring, tie, now };
inline constexpr int kind_count = 9;
char const* kind_name(Kind kind);
struct Handle {
  Kind kind;
  int index;
};

/// What a number may be; the `usual` range only warns.
struct Quantity {
  std::string unit;
  double least = -unlimited, most = unlimited;
  double usual_least = -unlimited, usual_most = unlimited;
  bool least_excluded = false, most_excluded = false;
};
Quantity any_number(char const* unit);
Quantity positive(char const* unit, double usual_least = 0, double usual_most = unlimited);
Quantity not_negative(char const* unit, double usual_most = unlimited);

enum class Need { required, optional };

/// One declared key, for the reference page.
struct KeyEntry {
  std::string key, type, unit, bounds, fallback, sentence;
  std::vector<std::string> laws;  // the laws that have it; empty: always
  std::vector<KeyEntry> part;     // keys of a nested table
};

/// A function of the script, kept in Lua's registry.
struct Callee {
  int reference = LUA_NOREF;
  Source source;
  std::string what;  // "measure "force"", for messages
};

/// Pairs { x, y } that belong to one value of a third quantity.
struct Curve {
  double at = 0;
  std::vector<std::array<double, 2>> points;
};

inline constexpr std::size_t longest_list = 1'000'000;  // that a table of a scene may be

class Form {
 public:
  /// Lists keys.
  explicit Form(Script& script) : script_(script) {}
  /// Reads the call's arguments: a single table, or a plain list of values.
  Form(Script& script, std::string verb, Source source);

  bool listing() const { return !reading_; }
  Source const& source() const { return source_; }
  std::string const& subject() const { return subject_; }
  std::vector<KeyEntry> const& entries() const { return entries_; }

  /// The name in front: `verb{ "name", ... }`; absent: "plate 2", or a problem when required.
  void name(std::string& to, std::size_t count, Need need, char const* sentence);
  /// Whether the next entry without a key is a text.
  bool next_is_text();

  // Keys. A key "[]" is the next entry without a key. Each returns whether it was given and right.
  bool number(std::string const& key, double& to, Quantity const& q, std::string const& sentence,
              Need need = Need::optional);
  bool number(std::string const& key, std::optional<double>& to, Quantity const& q, std::string const& sentence);
  bool boolean(std::string const& key, bool& to, std::string const& sentence);
  bool word(std::string const& key, std::string& to, std::vector<std::string> const& choices,
            std::string const& sentence, Need need = Need::optional);
  bool text(std::string const& key, std::string& to, std::string const& sentence, Need need);
  /// A list of some of the choices; without choices, of any texts.
  bool words(std::string const& key, std::vector<std::string>& to, std::vector<std::string> const& choices,
             std::string const& sentence);
  /// A place or direction: 2 or 3 numbers; z must be 0 (or absent) where there is no z.
  bool vector(std::string const& key, double* to, Quantity const& q, std::string const& sentence,
              Need need = Need::optional);
  /// A direction in space, in either dimension: three numbers, not all zero; it becomes one of length 1.
  bool axis(std::string const& key, Vec3& to, std::string const& sentence);
  /// An extent: as many positive numbers as there are dimensions; a third one in 2D is the thickness.
  bool extent(std::string const& key, Vec3& to, std::string const& sentence);
  /// One positive number for all, or two or three, in either dimension; a third one left out stays as it is.
  bool factors(std::string const& key, Vec3& to, std::string const& sentence);
  bool points(std::string const& key, std::vector<std::array<double, 2>>& to, std::string const& sentence);
  bool points(std::string const& key, std::vector<std::array<double, 3>>& to, std::string const& sentence, Need need);
  /// A number, a list of { x, y }, or a list of such lists, each with `name` = its value of the third quantity.
  bool curves(std::string const& key, std::string const& name, std::vector<Curve>& to, Quantity const& q,
              std::string const& sentence);
  bool point(std::string const& key, std::array<double, 2>& to, std::string const& sentence);
  bool interval(std::string const& key, double& least, double& most, std::string const& sentence);
  bool time_function(std::string const& key, scene::TimeFunction& to, char const* unit, std::string const& sentence,
                     Need need = Need::required);
  bool directions(std::string const& key, scene::Directions& to, char const* unit, std::string const& sentence,
                  Need need);
  bool region(std::string const& key, scene::Region& to, std::string const& sentence);
  /// function(x, y, z) that says true or false [m]; may be left out.
  bool predicate(std::string const& key, std::function<bool(double, double, double)>& to, std::string const& sentence,
                 std::string const& left_out);
  bool function(std::string const& key, Callee& to, char const* signature, std::string const& sentence, Need need);
  bool handle(std::string const& key, Kind kind, int& index, std::string const& sentence, Need need = Need::required);
  /// All entries without a key that are left, each of the kind.
  std::vector<int> handles(Kind kind, std::string const& sentence);

  /// A nested table: `read(form)` declares its keys. An absent key is not read: what it stands for stays left out.
  template <class Read>
  bool part(std::string const& key, std::string const& sentence, Read read, Need need = Need::optional) {
    std::size_t const entry = declare(key, "table", {}, need == Need::required ? "required" : "left out", sentence);
    if (listing()) {
      Form inner(script_);
      inner.laws_ = laws_;
      read(inner);
      entries_[entry].part = inner.entries_;
      return false;
    }
    if (!push(key, need, "table", sentence)) return false;
    bool const right = expect_type(key, LUA_TTABLE, "a table");
    if (right) {
      Form inner(*this, key, lua_gettop(state()));
      read(inner);
      inner.done();
      ok_ = ok_ && inner.ok_;
    }
    pop();
    return right;
  }

  /// A nested table or a list of them, each read by `read(form)`. Returns how many were read.
  template <class Read>
  int parts(std::string const& key, std::string const& sentence, Read read) {
    std::size_t const entry = declare(key, "table or list of tables", {}, "left out", sentence);
    if (listing()) {
      Form inner(script_);
      read(inner);
      entries_[entry].part = inner.entries_;
      return 0;
    }
    if (!push(key, Need::optional, "table", sentence)) return 0;
    int count = 0;
    if (expect_type(key, LUA_TTABLE, "a table or a list of tables")) {
      int const list = lua_gettop(state());
      auto const read_one = [&](int table) {
        Form inner(*this, key, table);
        read(inner);
        inner.done();
        ok_ = ok_ && inner.ok_;
        ++count;
      };
      lua_rawgeti(state(), list, 1);
      bool const many = lua_type(state(), -1) == LUA_TTABLE;
      pop();
      if (!many) read_one(list);
      if (many && !only_a_list(list))
        problem(
            label(key) + " is a list of tables, and has something else beside them; put that into a table of its own",
            key);
      for (int i = 1; many && lua_rawgeti(state(), list, i) != LUA_TNIL; ++i, pop())
        if (expect_type(key, LUA_TTABLE, "a list of tables")) read_one(lua_gettop(state()));
      if (many) pop();
    }
    pop();
    return count;
  }

  /// One of several laws: its name under "law", its numbers beside it, all from the law's own declaration; more(law)
  /// reads what is no plain number.
  template <class Variant, class More>
  void law(Variant& to, std::string const& sentence, More&& more) {
    choose_law<Variant>(to, sentence, more, std::make_index_sequence<std::variant_size_v<Variant>>{});
  }
  template <class Variant>
  void law(Variant& to, std::string const& sentence) {
    law(to, sentence, [](auto&) {});
  }
  template <class Law>
  void parameters(Law& law) {
    for (auto const& p : Law::parameters()) {
      if (p.fallback) law.*(p.member) = *p.fallback;
      number(p.key, law.*(p.member),
             {p.unit, p.least, p.most, p.usual_least, p.usual_most, p.least_excluded, p.most_excluded}, p.sentence,
             p.fallback ? Need::optional : Need::required);
    }
  }

  /// Lists a key by hand, where it may be one of several types.
  std::size_t declare(std::string const& key, std::string const& type, Quantity const& q, std::string const& fallback,
                      std::string const& sentence);
  /// LUA_TNIL when absent.
  int type_of(std::string const& key);

  /// Names stand for one thing only: among plates, bodies, ... a second use is a problem.
  void claim(std::string const& name);

  /// A problem with this call (or with this key of it); reading goes on.
  void problem(std::string const& text, std::string const& key = "");
  void warning(std::string const& text, std::string const& key = "");
  /// Keys that nobody declared are problems. Returns true when the call was read without any, false also when listing.
  bool done();

 private:
  Form(Form const& outer, std::string const& key, int table);
  template <class Variant, class More, std::size_t... I>
  void choose_law(Variant& to, std::string const& sentence, More& more, std::index_sequence<I...>) {
    std::string chosen = std::variant_alternative_t<0, Variant>::name;
    std::string all;
    ((all += std::string(I ? "; " : "") + std::variant_alternative_t<I, Variant>::name + ": " +
             std::variant_alternative_t<I, Variant>::sentence),
     ...);
    word("law", chosen, {std::variant_alternative_t<I, Variant>::name...}, sentence + ". " + all);
    auto read = [&]<class Law>(Law law) {
      if (!listing() && chosen != Law::name) return;
      laws_ = {Law::name};
      parameters(law);
      more(law);
      laws_.clear();
      to = law;
    };
    (read(std::variant_alternative_t<I, Variant>{}), ...);
    for (auto& entry : entries_)
      if (entry.laws.size() == sizeof...(I)) entry.laws.clear();
  }

  lua_State* state() const;
  /// Pushes the key's value and returns true when it was given; says so when it is missing.
  bool push(std::string const& key, Need need, std::string const& type, std::string const& sentence);
  void pop();
  /// What --set says of a key takes the place of what the scene says of it, on top of the stack.
  void replace(std::string const& key);
  bool expect_type(std::string const& key, int type, char const* expected);
  /// Whether the table at a place of the stack has entries 1, 2, ... alone, without a hole.
  bool only_a_list(int table) const;
  bool checked_number(std::string const& key, double& to, Quantity const& q, std::string const& label);
  template <std::size_t N>
  bool list_of_points(std::string const& key, std::vector<std::array<double, N>>& to, std::string const& sentence,
                      Need need);
  bool list_of_numbers(std::string const& key, double* to, int least, int most, Quantity const& q);
  bool take_function(std::string const& key, Callee& to, std::string const& what);
  bool take_predicate(std::string const& key, std::function<bool(double, double, double)>& to);
  bool take_time_function(std::string const& key, scene::TimeFunction& to, Quantity const& q, std::string const& label);
  std::string label(std::string const& key) const;
  Source place_of(std::string const& key) const;

  Script& script_;
  bool reading_ = false, ok_ = true;
  std::string verb_, subject_;     // "material", "material "rock""
  std::vector<std::string> path_;  // keys that lead to this table
  Source source_;
  int table_ = 0;  // stack index; 0: the arguments themselves
  int arguments_ = 0;
  int position_ = 0;  // of the entry without a key that was read last
  std::vector<std::string> laws_;
  std::vector<std::pair<std::string, std::string>> missing_;  // key, what to say about it
  std::vector<KeyEntry> entries_;
};

/// Text of a user in an error message: short, printable, in quotes.
std::string in_quotes(std::string const& text);
/// A number as a person writes it.
std::string shown(double value);

}  // namespace fissure::lua
