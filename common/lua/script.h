// From a scene file in Lua to a validated scene::Scene, and the pages that describe the language.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace fissure::lua {

/// --set name=value on the command line.
struct Setting {
  std::string name;
  double value = 0;
};

/// Reads a scene file. `dimension` (2 or 3) is what scripts see as `dim` and how many numbers a vector needs.
/// Throws fissure::Error with everything that is wrong, one problem per line.
scene::Scene read_scene(std::string const& path, int dimension, std::vector<Setting> const& settings = {});

/// The same for a text; `name` stands in error messages and its folder is where `require` looks.
scene::Scene read_scene_text(std::string const& text, std::string const& name, int dimension,
                             std::vector<Setting> const& settings = {});

/// docs/reference/scene.md and scripts/lua/fissure.lua (LuaLS), both from the declarations that check a scene.
std::string reference_page();
std::string annotations();

}  // namespace fissure::lua
