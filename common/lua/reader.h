// One reading of one scene: the sandbox, what has been said so far, and what was wrong with it.
#pragma once
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lua/form.h"
#include "lua/sandbox.h"
#include "lua/script.h"
#include "scene/scene.h"

namespace fissure::lua {

/// A shape and what it costs to copy: unions of unions grow fast.
struct KnownShape {
  scene::Shape shape;
  int weight = 1, depth = 1;
};

class Script : public Sandbox {
 public:
  explicit Script(int dimension);

  /// Runs the scene; throws Error with all problems.
  void read(std::string const& text, std::string const& name, std::vector<Setting> const& settings);

  /// Calls a function of the script. `push` puts the arguments on the stack and returns their number; `take` reads the
  /// one result at the top. Throws Error with the place in the script.
  template <class Push, class Take>
  auto ask(Callee const& callee, Push push, Take take) {
    lua_State* const L = state();
    struct Restore {
      Script& s;
      lua_State* L;
      int top;
      bool declaring;
      ~Restore() { lua_settop(L, top), s.declaring = declaring; }
    } restore{*this, L, lua_gettop(L), declaring};
    declaring = false;
    if (!lua_checkstack(L, 32)) throw Error(callee.source, callee.what + ": the script calls itself too deeply");
    lua_rawgeti(L, LUA_REGISTRYINDEX, callee.reference);
    int const arguments = push();
    std::string const error = call(arguments, 1, function_limit);
    if (!error.empty())
      throw Error((error.rfind("the script", 0) == 0 ? callee.source.prefix() : "") + error + " (in " + callee.what +
                  ")");
    return take();
  }
  double ask_number(Callee const& callee, double t);
  double ask_yield(Callee const& callee, double strain, double rate);
  /// A curve's number at x: `at` says "a gap of {} m", `what` it must return.
  double ask_curve(Callee const& callee, double x, char const* at, char const* what);
  bool ask_inside(Callee const& callee, double x, double y, double z);
  /// xx yy zz xy yz zx of a table with such keys; one left out is 0.
  std::array<double, 6> ask_stress(Callee const& callee, double x, double y, double z);
  std::array<double, 3> ask_vector(Callee const& callee, double x, double y, double z);
  /// Asks it once before the run, of bodies at rest: enough to find misspelt names.
  void rehearse(std::function<void(scene::Now const&)> function);
  /// What a function has left on the stack: a vector.
  std::array<double, 3> returned_vector(Callee const& callee, std::string const& where);
  double ask_measure(Callee const& callee, scene::Now const& now);
  bool ask_stop(Callee const& callee, scene::Now const& now);
  std::array<double, 3> ask_servo(Callee const& callee, scene::Now const& now);  // a velocity [m/s]
  /// Adds what it prints, also where it fails.
  void ask_words(Callee const& callee, scene::Now const& now, std::string& words);

  void push_handle(Handle handle);
  /// The handle at a stack index, or nullptr.
  Handle const* handle_at(int index) const;

  void problem(Source const& at, std::string const& text);
  /// Line of `path`'s last key in the call that begins at `at`; the call's own line when it cannot be told.
  int line_of(Source const& at, std::string const& verb, std::vector<std::string> const& path) const;

  int add_shape(KnownShape shape);
  /// Shapes are copied, and copies of copies fill any memory: counts their parts and raises.
  void weigh(int weight);
  bool knows(std::string const& verb, std::string const& name) const { return names.count({verb, name}) > 0; }

  int dimension;
  scene::Scene scene;
  std::vector<Setting> settings;
  Modules stored;                              // of a run that goes on: what it required when it began
  std::set<std::string> asked_keys, set_keys;  // "run.safety": what tables were asked for, and what --set gave
  std::vector<std::string> problems;
  std::vector<KnownShape> shapes;
  std::map<std::pair<std::string, std::string>, Source> names;  // verb and name: where it was said first
  std::map<std::string, int> said;                              // how often each verb was used
  std::vector<std::function<void()>> checks;                    // what can be judged only when everything has been said
  bool declaring = false;           // verbs may be used: the script runs, not one of its functions
  double two_d_thickness = 0;       // assume{ thickness = } [m]; 0: the bodies' own
  scene::Now const* now = nullptr;  // while a measure runs
  std::string* said_to = nullptr;   // where `print` writes; null: to the terminal

 private:
  void finish();

  int weight_ = 0;  // of all shapes
};

/// One verb of the language. Its function reads (or lists) the form and returns what scripts get back.
struct Verb {
  char const* name;
  char const* sentence;
  char const* example;
  char const* returns;         // LuaLS type, "" for none
  int (*run)(Script&, Form&);  // number of results pushed
};
std::vector<Verb> const& verbs();
std::vector<Verb> shape_verbs();     // shapes.cpp
std::vector<Verb> material_verbs();  // materials.cpp
std::vector<Verb> load_verbs();      // loads.cpp
std::vector<Verb> look_verbs();      // looks.cpp

/// material{ plastic = { ... } }; flow.cpp.
void read_flow(Script& script, Form& part, scene::Flow& flow);
void read_fracture(Script& script, Form& part, laws::CohesiveJoint& joint, std::optional<scene::Scatter>& scatter);

/// A constant of the language: value in SI units.
struct Unit {
  char const* name;
  double value;
  char const* sentence;
};
std::vector<Unit> const& units();

/// What now.<name> is, for the reference page.
struct NowEntry {
  char const* name;
  char const* signature;
  char const* type;
  char const* sentence;
};
std::vector<NowEntry> now_entries();                              // now.cpp
void push_now_property(Script& script, std::string const& name);  // now.cpp

/// Built-in library: the text of `require "name"`, or nullptr; its names.
char const* library(std::string const& name);  // library.cpp
std::vector<std::string> library_names();

/// Corners of the box around a shape; throws runtime_error where only the mesher knows. [m]
std::pair<Vec3, Vec3> extent_of(scene::Shape const& shape);
/// A point inside the material of a simple shape, away from its middle, where functions of the radius may have no
/// value. [m]
std::optional<Vec3> point_inside(scene::Shape const& shape);
/// What handles show of a shape: disc.radius, disc.left, ...
std::vector<std::pair<std::string, double>> properties_of(scene::Shape const& shape);
/// Out-of-plane thickness that a shape asks for; 0: none. [m]
double thickness_of(scene::Shape const& shape);

}  // namespace fissure::lua
