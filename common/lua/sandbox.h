// A Lua interpreter for scripts from strangers: no files, no processes, no native code; bounded memory and time.
#pragma once
#include <chrono>
#include <cstddef>
#include <exception>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

extern "C" {
#include <lauxlib.h>
#include <lua.h>
#include <lualib.h>
}

namespace fissure::lua {

inline constexpr std::size_t memory_limit = std::size_t{256} << 20;  // [bytes]
inline constexpr std::size_t text_limit = std::size_t{16} << 20;     // of a scene file [bytes]
inline constexpr double reading_limit = 10, function_limit = 1;      // of the processor's time, not of the clock [s]

/// Lua reports errors by longjmp, which must never cross a C++ object. Two rules see to that: Lua runs only in call(),
/// and what Lua calls does its work inside guarded(), where allocations are not limited and only raw access is used,
/// so that no Lua function can raise. C++ exceptions become Lua errors after the last C++ object is gone.
class Sandbox {
 public:
  Sandbox();
  ~Sandbox();
  Sandbox(Sandbox const&) = delete;
  Sandbox& operator=(Sandbox const&) = delete;

  lua_State* state() const { return state_; }
  static Sandbox& of(lua_State* L) { return **static_cast<Sandbox**>(lua_getextraspace(L)); }

  /// All calls together may take `seconds` from now on; 0: only each its own limit holds.
  void limit_time(double seconds);

  /// Calls the function below the `arguments` on top of the stack. Returns "" or what went wrong, with its place.
  std::string call(int arguments, int results, double seconds);

  /// Pushes the text as a function whose globals are the sandbox's, or returns what is wrong with its syntax. A byte
  /// order mark and a first line that begins with # are skipped, as Lua's own program does.
  std::string load(std::string const& text, std::string const& name);

  /// Makes the value on top of the stack (popped) a global of all scripts.
  void set_global(char const* name);

  /// What was loaded, by file name: the scene and the modules that it requires.
  std::map<std::string, std::string> const& texts() const { return texts_; }
  /// Where a text that was loaded from this file declares a local of this word behind a line; 0: nowhere.
  int declared_after(std::string const& file, int line, std::string const& word) const;

  /// The place in the user's script where Lua stands now: its file and line; "" and 0 outside.
  std::string file_now() const;
  int line_now() const;

  /// body() returns the number of results on the stack; an exception's text is left there and -1 returned.
  template <class Body>
  int guarded(Body body) {
    struct Relief {
      bool& limited;
      bool before;
      ~Relief() { limited = before; }
    } relief{limited_, limited_};
    limited_ = false;
    try {
      if (!lua_checkstack(state_, 64)) throw std::runtime_error("the script calls itself too deeply");
      return body();
    } catch (std::exception const& error) {
      lua_pushstring(state_, error.what());
      return -1;
    }
  }

 private:
  static void* allocate(void* sandbox, void* block, std::size_t old_size, std::size_t size);
  static void watch(lua_State* L, lua_Debug*);
  static int place_error(lua_State* L);
  /// When time is over: by the processor's time of this thread, since a busy machine is no fault of the script. The
  /// clock is asked first, because it costs less and is never behind.
  struct Deadline {
    std::chrono::steady_clock::time_point clock = std::chrono::steady_clock::time_point::max();
    double processor = std::numeric_limits<double>::infinity();  // [s]
  };
  static Deadline in(double seconds);
  bool late() const;
  void open_libraries();

  lua_State* state_ = nullptr;
  std::size_t used_ = 0;  // [bytes]
  unsigned allocations_ = 0;
  bool limited_ = false;  // Lua code is running: limits apply
  Deadline deadline_;
  double seconds_ = 0;
  std::map<std::string, std::string> texts_;
};

}  // namespace fissure::lua
