// From a scene file in Lua to a validated scene::Scene, and the pages that describe the language.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace fissure::lua {

/// --set name=value on the command line: another value of a parameter, or, where the name has dots (run.safety,
/// body.mesh.size), of a key in every table of that verb: a number, true, false, a text, or *0.5, which multiplies what
/// the scene says.
struct Setting {
  std::string name;
  double value = 0;       // of a parameter
  std::string text = {};  // of a key

  bool of_key() const { return name.find('.') != std::string::npos; }
};

/// Reads a scene file. `dimension` (2 or 3) is what scripts see as `dim` and how many numbers a vector needs.
/// Throws fissure::Error with everything that is wrong, one problem per line.
scene::Scene read_scene(std::string const& path, int dimension, std::vector<Setting> const& settings = {});

/// The same for a text; `name` stands in error messages and its folder is where `require` looks, but for modules that
/// are `stored`.
using Modules = std::map<std::string, scene::Scene::Module>;
scene::Scene read_scene_text(std::string const& text, std::string const& name, int dimension,
                             std::vector<Setting> const& settings = {}, Modules const& stored = {});

/// What `require "materials"` has, as a table.
std::string material_list();

/// docs/reference/scene.md and scripts/lua/fissure.lua (LuaLS), both from the declarations that check a scene.
std::string reference_page();
std::string annotations();

}  // namespace fissure::lua
