// The reference page and the editor's annotations: what the declarations say, written out.
#include <fmt/format.h>

#include <algorithm>

#include "lua/reader.h"

namespace fissure::lua {
namespace {

struct Declared {
  Verb const* verb;
  std::vector<KeyEntry> entries;
};

std::vector<Declared> declarations() {
  std::vector<Declared> all;
  Script script(3);
  for (auto const& verb : verbs()) {
    Form form(script);
    verb.run(script, form);
    all.push_back({&verb, form.entries()});
  }
  return all;
}

std::string cell(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.replace(i, 1, "\\|");
  return text;
}

void rows(std::string& page, std::vector<KeyEntry> const& entries, std::string const& before) {
  for (auto const& e : entries) {
    std::string laws;
    for (auto const& law : e.laws) laws += (laws.empty() ? "only law = " : " or ") + ('"' + law + '"');
    page += fmt::format("| `{}{}` | {} | {} | {} | {} | {}{} |\n", before, e.key, cell(e.type), e.unit, cell(e.bounds),
                        cell(e.fallback), cell(e.sentence), laws.empty() ? "" : " (" + laws + ")");
    rows(page, e.part, before + e.key + ".");
  }
}

bool positional(KeyEntry const& e) { return e.key.rfind("entry ", 0) == 0; }

/// LuaLS type of a key, from what the reference page calls it.
std::string luals_type(std::string const& cls, KeyEntry const& e) {
  if (!e.part.empty()) return cls + "_" + e.key;
  if (e.type == "number" || e.type == "boolean") return e.type;
  if (e.type == "text") return "string";
  if (e.type == "function(now)") return "fun(now: fissure.now): any";
  if (e.type == "list of texts") return "string[]";
  if (e.type == "text or function(x, y, z)") return "string|fun(x: number, y: number, z: number): boolean";
  if (e.type == "number or function(t)") return "number|fun(t: number): number";
  if (e.type == "number, list or function(strain, rate)")
    return "number|table|fun(strain: number, rate: number): number";
  if (e.type.rfind("number, ", 0) == 0) return "number|string|table";
  if (e.type.find("function(t)") != std::string::npos) return "(number|fun(t: number): number)[]";
  if (e.type.find("function(x") != std::string::npos) return "number[]|fun(x: number, y: number, z: number): number[]";
  if (e.type.rfind("list of {", 0) == 0) return "number[][]";
  if (e.type[0] == '{') return "number[]";
  if (e.type[0] == '"') {
    std::string choices = e.type;
    for (std::size_t i; (i = choices.find(" or ")) != std::string::npos;) choices.replace(i, 4, "|");
    return choices;
  }
  for (int kind = 0; kind < kind_count; ++kind)
    if (e.type == kind_name(static_cast<Kind>(kind))) return "fissure." + e.type;
  return "any";
}

void write_class(std::string& page, std::string const& cls, std::vector<KeyEntry> const& entries) {
  for (auto const& e : entries)
    if (!e.part.empty()) write_class(page, cls + "_" + e.key, e.part);
  page += "---@class " + cls + "\n";
  int position = 0;
  for (auto const& e : entries) {
    bool const needed = e.fallback == "required" && !positional(e);
    std::string const key = positional(e) ? fmt::format("[{}]", ++position) : e.key + (needed ? "" : "?");
    page += fmt::format("---@field {} {} {}{}\n", key, positional(e) ? "any" : luals_type(cls, e), e.sentence,
                        e.unit.empty() ? "" : " [" + e.unit + "]");
  }
  page += "\n";
}

}  // namespace

std::string reference_page() {
  std::string page =
      "# Scene reference\n\n"
      "Every verb, key, unit and question of the scene language. This page is written by the program from the "
      "declarations that check\n"
      "a scene; do not edit it. A scene is a Lua 5.4 file. Numbers are SI; constants give other units: `3*mm`, "
      "`40*GPa`, `5*J/m2`.\n"
      "y is the loading axis and z points out of the plane of a 2D model. `dim` is 2 or 3. Variables are `local`.\n\n"
      "An *entry* is a value without a key, in order: `body{ \"disc\", shape = ... }` has one entry.\n"
      "Bodies, shapes and plates know their measures: `radius`, `diameter`, `length`, `inner`, `outer`, `thickness`, "
      "`width`, `height`,\n"
      "`left`, `right`, `bottom`, `top`; materials their numbers: `rock.young`.\n";
  for (auto const& [verb, entries] : declarations()) {
    page += fmt::format(
        "\n## {}\n\n{}\n\n```lua\n{}\n```\n\n| key | type | unit | bounds | default | meaning "
        "|\n|---|---|---|---|---|---|\n",
        verb->name, verb->sentence, verb->example);
    rows(page, entries, "");
  }
  page +=
      "\n## now\n\nWhat functions of `measure`, `run{ stop = }` and `expect` may ask; `now.<measure>` is the latest "
      "value of a measure.\n\n"
      "| question | answer | meaning |\n|---|---|---|\n";
  for (auto const& e : now_entries()) {
    bool const plain = std::string(e.name) == "time" || std::string(e.name) == "step";
    page += fmt::format("| `now.{}{}` | {} | {} |\n", e.name, plain ? "" : fmt::format("({})", e.signature), e.type,
                        e.sentence);
  }
  page += "\nEnergies:";
  for (auto const& name : scene::energy_names()) page += " `" + name + "`";
  page += ". Fields:";
  for (auto const& name : scene::output_fields()) page += " `" + name + "`";
  page += ".\n\n## Units\n\n| constant | value | unit |\n|---|---|---|\n";
  for (auto const& unit : units()) page += fmt::format("| `{}` | {:g} | {} |\n", unit.name, unit.value, unit.sentence);
  page += fmt::format(
      "\n## Lua\n\nThere are `math`, `table`, `string` (without patterns), `ipairs`, `pairs` (in sorted order), "
      "`select`, `tonumber`,\n"
      "`tostring`, `type`, `assert`, `error`, `print` and `require`. `require \"name\"` reads `name.lua` beside the "
      "scene or the built-in\n"
      "library, `materials` and `lab` ([laboratory](../laboratory.md)). A script has {} s of the processor's time and "
      "{} MiB; each function of time or measure has "
      "{} s. It reaches no files, no\n"
      "processes and no native code.\n",
      reading_limit, memory_limit >> 20, function_limit);
  return page;
}

std::string annotations() {
  std::string page =
      "---@meta\n-- Completion and hover for scenes in editors with the Lua language server (LuaLS). Written by the "
      "program; do not edit it.\n\n";
  for (char const* kind : {"shape", "body", "plate"}) {
    page += fmt::format("---@class fissure.{}\n", kind);
    for (char const* name : {"radius", "diameter", "length", "inner", "outer", "thickness", "left", "right", "bottom",
                             "top", "width", "height"})
      page += fmt::format("---@field {} number [m]\n", name);
    page += "\n";
  }
  page +=
      "---@class fissure.material\n---@field density number [kg/m3]\n---@field young number [Pa]\n---@field poisson "
      "number\n\n";
  page +=
      "---@class fissure.wall\n\n---@class fissure.hold\n\n---@class fissure.spring\n\n---@class "
      "fissure.tie\n\n---@class "
      "fissure.now\n---@field [string] number the latest "
      "value of a measure\n";
  for (auto const& e : now_entries()) {
    std::string const name = e.name;
    std::string parameters = e.signature;
    if (name == "time" || name == "step")
      page += fmt::format("---@field {} {} {}\n", name, e.type, e.sentence);
    else {
      std::string typed;
      for (std::size_t start = 0; start < parameters.size();) {
        std::size_t const end = std::min(parameters.find(", ", start), parameters.size());
        std::string const one = parameters.substr(start, end - start);
        char const* const optional = one == "axis" || one == "point" ? "?" : "";
        std::string const type = one == "plate" || one == "wall" || one == "hold" || one == "spring" || one == "tie"
                                     ? "fissure." + one
                                 : one == "body"  ? "fissure.body|fissure.plate"
                                 : one == "point" ? "number[]"
                                                  : "string";
        typed += fmt::format("{}{}{}: {}", typed.empty() ? "" : ", ", one, optional, type);
        start = end + 2;
      }
      page += fmt::format("---@field {} fun({}): {} {}\n", name, typed, e.type, e.sentence);
    }
  }
  page += "\n---@type integer 2 or 3\ndim = 3\n";
  for (auto const& unit : units()) page += fmt::format("---{}\n{} = {:.17g}\n", unit.sentence, unit.name, unit.value);
  page += "\n";
  for (auto const& [verb, entries] : declarations()) {
    std::string const name = verb->name, cls = "fissure." + name + "_table";
    write_class(page, cls, entries);
    page += fmt::format("---{}\n---\n---`{}`\n", verb->sentence, verb->example);
    // A verb takes one table, or its entries as plain values.
    bool const plain = std::none_of(entries.begin(), entries.end(),
                                    [](KeyEntry const& e) { return e.fallback == "required" && !positional(e); });
    page += plain ? fmt::format("---@param first {}|any\n---@param ... any\n", cls)
                  : fmt::format("---@param first {}\n", cls);
    if (*verb->returns) page += fmt::format("---@return {}\n", verb->returns);
    page += fmt::format("function {}(first{}) end\n\n", name, plain ? ", ..." : "");
  }
  return page;
}

}  // namespace fissure::lua
