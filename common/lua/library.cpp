// The built-in library of scenes, `require "materials"`: part of the program, so that an installed binary finds it.
// CMake makes lua/library.inc of the files in library/: a line { "name", R"lua(text)lua" } for each.

#include "lua/reader.h"

namespace fissure::lua {
namespace {

struct Module {
  char const *name, *text;
};
constexpr Module modules[] = {
#include "lua/library.inc"
};

}  // namespace

char const* library(std::string const& name) {
  for (auto const& module : modules)
    if (name == module.name) return module.text;
  return nullptr;
}

std::vector<std::string> library_names() {
  std::vector<std::string> names;
  for (auto const& module : modules) names.emplace_back(module.name);
  return names;
}

}  // namespace fissure::lua
