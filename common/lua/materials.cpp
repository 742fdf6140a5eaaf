// param, material and body: what a scene is made of. The keys of laws come from the laws themselves.
#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "lua/reader.h"

namespace fissure::lua {
namespace {

Quantity density() { return positive("kg/m3", 25, 25000); }

int param(Script& script, Form& form) {
  scene::ScriptParameter parameter;
  form.name(parameter.name, 0, Need::required, "how --set calls it");
  bool const given =
      form.number("[]", parameter.value, any_number(""), "its value when nothing is set", Need::required);
  form.text("[]", parameter.help, "what it is, for `params`", Need::optional);
  form.number("least", parameter.least, any_number(""), "smallest value that makes sense");
  form.number("most", parameter.most, any_number(""), "largest value that makes sense");
  if (form.listing()) return 0;
  form.claim(parameter.name);
  for (char const c : parameter.name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') {
      form.problem("the name can only have letters, digits, _ and - (--set name=value must find it)");
      break;
    }
  parameter.fallback = parameter.value;
  parameter.source = form.source();
  for (auto const& setting : script.settings)
    if (setting.name == parameter.name) parameter.value = setting.value;
  if (given && !std::isfinite(parameter.value)) form.problem("is set to a value that is not a finite number");
  if (given && ((parameter.least && parameter.value < *parameter.least) ||
                (parameter.most && parameter.value > *parameter.most)))
    form.problem(fmt::format("= {} is not allowed (it must lie between {} and {})", shown(parameter.value),
                             parameter.least ? shown(*parameter.least) : "-infinity",
                             parameter.most ? shown(*parameter.most) : "infinity"));
  form.done();
  script.scene.parameters.push_back(parameter);
  lua_pushnumber(script.state(), parameter.value);
  return 1;
}

/// damping = "critical", a viscosity, or { share = }.
void damping(Form& form, scene::Material& material) {
  form.declare("damping", "number, \"critical\" or { share = number }", not_negative("Pa s"), "0",
               "viscosity mu of the stress 2 mu D; \"critical\" is 2 h sqrt(E density) with the element size h, and "
               "costs a smaller time step; a share of it costs less");
  int const type = form.type_of("damping");
  if (type == LUA_TSTRING) {
    std::string word;
    if (form.word("damping", word, {"critical"}, "")) material.critical_share = 1;
  } else if (type == LUA_TTABLE) {
    form.part("damping", "", [&](Form& part) {
      part.number("share", material.critical_share, not_negative("", 1), "share of the critical viscosity",
                  Need::required);
    });
  } else if (type != LUA_TNIL) {
    form.number("damping", material.viscosity, not_negative("Pa s", 1e9), "");
  }
}

int material(Script& script, Form& form) {
  scene::Material material;
  form.name(material.name, script.scene.materials.size(), Need::optional, "its name");
  std::string source;  // for readers of the scene
  form.text("source", source, "where its numbers come from; a run takes no notice", Need::optional);
  form.number("density", material.density, density(), "mass per volume", Need::required);
  bool names_law = false;
  form.part(
      "elastic", "how it deforms",
      [&](Form& part) {
        names_law = part.type_of("law") != LUA_TNIL;
        part.law(material.bulk, "elastic law");
        damping(part, material);
      },
      Need::required);
  scene::Flow flow;
  if (form.part("plastic", "how it flows; left out: it stays elastic",
                [&](Form& part) { read_flow(script, part, flow); })) {
    material.flow = flow;
    if (names_law)
      form.problem(
          "elastic.law has no meaning beside plastic (what flows is linear in the strain that plastic.strain names); "
          "leave it out",
          "elastic");
  }
  laws::CohesiveJoint joint;
  if (form.part("fracture", "how it breaks; left out: it cannot break",
                [&](Form& part) { read_fracture(script, part, joint, material.scatter); }))
    material.joint = joint;
  laws::ContactLaw contact;
  if (form.part("contact", "how it touches; left out: a penalty of lambda + 2 mu and no friction",
                [&](Form& part) { part.parameters(contact); }))
    material.contact = contact;
  if (form.listing()) return 0;
  // A broken joint slides like any other contact.
  auto finish_joint = [&](auto& law) {
    if constexpr (requires { law.residual; }) law.residual = material.contact ? material.contact->friction : 0;
    if constexpr (requires { law.prepare(); }) law.prepare();
  };
  if (material.joint) std::visit(finish_joint, *material.joint);
  std::visit(
      [](auto& law) {
        if constexpr (requires { law.prepare(); }) law.prepare();
      },
      material.bulk);
  form.claim(material.name);
  form.done();
  material.source = form.source();
  script.scene.materials.push_back(material);
  script.push_handle({Kind::material, static_cast<int>(script.scene.materials.size()) - 1});
  return 1;
}

/// A line in the plane, or a polygon in space; `needed`: one of both must be given. Returns whether one was.
bool line_or_polygon(Script& script, Form& form, scene::Seam& seam, std::string const& from, std::string const& to,
                     bool needed) {
  bool const polygon = form.type_of("corners") != LUA_TNIL,
             line = form.type_of("from") != LUA_TNIL || form.type_of("to") != LUA_TNIL;
  bool const in_space = polygon && script.dimension == 3;
  form.declare("from", "{ x, y }", {"m"}, needed ? "required" : "left out", from);
  form.declare("to", "{ x, y }", {"m"}, needed ? "required" : "required with from", to);
  if (!form.listing() && polygon && !in_space && !line) {
    form.problem("corners are those of a polygon in space; in two dimensions from and to are needed, too", "corners");
  } else if (line || (needed && !in_space)) {
    bool const starts = form.point("from", seam.from, from), ends = form.point("to", seam.to, to);
    if (starts && ends && seam.from == seam.to) form.problem("from and to are the same point", "to");
  }
  form.points("corners", seam.corners, "3D: of a flat polygon instead of the line, in order around (2D takes the line)",
              Need::optional);
  return line || in_space;
}

void mesh(Script& script, Form& part, scene::Body& body, bool from_file) {
  part.number("size", body.mesh.size, positive("m", 1e-7, 1e4),
              "length of an element's edges; shorter near an outline of many points",
              from_file ? Need::optional : Need::required);
  part.word("cells", body.mesh.cells, {"simplex", "block", "tri", "quad", "tet", "hex"},
            "kind of elements; \"simplex\" (tri or tet) and \"block\" (quad or hex) are right in both dimensions");
  part.word(
      "integration", body.mesh.integration, {"one_point", "full", "b_bar", "assumed_strain"},
      "of blocks: \"one_point\" is fast, \"b_bar\" right in plastic flow, \"assumed_strain\" in bending of thin parts");
  part.boolean("structured", body.mesh.structured, "a regular grid, for simplices cut into them (boxes only)");
  part.number(
      "irregular", body.mesh.irregular, {"", 0, 0.4},
      "inner nodes are moved at random by up to this share of their shortest edge, so that cracks find no lattice");
  double seed = 0;
  part.number("seed", seed, {"", 0, 4294967295.0}, "another number, another unstructured mesh of the same size");
  body.mesh.seed = static_cast<unsigned>(seed);
  part.parts(
      "seam",
      "straight line (3D: plane along z, or flat polygon) on which the mesh has faces, so that a crack can follow it",
      [&](Form& place) {
        scene::Seam seam;
        line_or_polygon(script, place, seam, "start of the line", "end of the line", true);
        if (!place.listing()) body.mesh.seams.push_back(seam);
      });
  part.parts(
      "near",
      "smaller elements about a line or a point: those within `radius` have edges of `size`, from there on they grow "
      "by 0.3 per length",
      [&](Form& place) {
        scene::Near near;
        place.point("from", near.from, "start of the line, or the point (3D: along z)");
        near.to = near.from;
        place.declare("to", "{ x, y }", any_number("m"), "left out", "end of the line; left out: a point");
        if (place.type_of("to") != LUA_TNIL) place.point("to", near.to, "");
        place.number("radius", near.radius, not_negative("m"), "of the place about the line", Need::required);
        bool const given = place.number("size", near.size, positive("m", 1e-7, 1e4), "of edges there", Need::required);
        if (place.listing()) return;
        if (given && near.size >= body.mesh.size && body.mesh.size > 0)
          place.problem(
              fmt::format(
                  "mesh.near.size = {} is no smaller than mesh.size = {}; near is for places with smaller elements",
                  shown(near.size), shown(body.mesh.size)),
              "size");
        body.mesh.near.push_back(near);
      });
  if (part.listing()) return;
  if (seed != body.mesh.seed) part.problem("mesh.seed must be a whole number", "seed");
  bool const flat = script.dimension == 2;
  if (body.mesh.cells == (flat ? "tet" : "tri") || body.mesh.cells == (flat ? "hex" : "quad"))
    part.problem(fmt::format("mesh.cells = \"{}\" makes no sense in {} dimensions; \"{}\" is right in both",
                             body.mesh.cells, flat ? "two" : "three", body.mesh.blocks() ? "block" : "simplex"),
                 "cells");
  if (body.mesh.integration != "one_point" && !body.mesh.blocks() && !from_file)
    part.problem(fmt::format("mesh.integration = \"{}\" is for blocks (cells are \"{}\"); write cells = \"block\"",
                             body.mesh.integration, body.mesh.cells),
                 "integration");
  if (body.mesh.structured && !std::holds_alternative<scene::Box>(body.shape.is) && body.shape.source.line > 0)
    part.problem("mesh.structured is for a box only", "structured");
}

/// The temperature that a body begins with.
void temperature(Script& script, Form& form, scene::Body& body) {
  form.number("temperature", body.temperature, positive("K", 70, 3000),
              "at the start, of a material with plastic = { heat = }; left out: its heat.start");
  if (form.listing() || !body.temperature || body.material < 0) return;
  auto const& material = script.scene.materials[static_cast<std::size_t>(body.material)];
  if (!material.flow || !material.flow->heat.on())
    form.problem("temperature is of no use without heat: give the material plastic = { heat = { capacity = } }",
                 "temperature");
  else if (auto const* law = std::get_if<laws::JohnsonCookFlow>(&material.flow->law);
           law && law->m > 0 && law->melting <= *body.temperature)
    form.problem(fmt::format("temperature = {:g} K is not below the material's melting = {:g} K", *body.temperature,
                             law->melting),
                 "temperature");
}

/// Number of what a rigid body of this material is made of: its mass, and what it pushes with where it touches.
int without_forces(Script& script, int of) {
  auto& materials = script.scene.materials;
  auto rigid = materials[static_cast<std::size_t>(of)];
  rigid.name += " (rigid)";
  rigid.flow.reset(), rigid.joint.reset(), rigid.scatter.reset();
  rigid.viscosity = rigid.critical_share = 0;
  rigid.rigid = true;
  auto const same = [&](scene::Material const& one) { return one.rigid && one.name == rigid.name; };
  auto const found = std::find_if(materials.begin(), materials.end(), same);
  if (found != materials.end()) return static_cast<int>(found - materials.begin());
  materials.push_back(rigid);
  return static_cast<int>(materials.size()) - 1;
}

/// Why a body has no joints, if it has none.
std::optional<std::string> without_joints(Script const& script, int number) {
  auto const& body = script.scene.bodies[static_cast<std::size_t>(number)];
  if (body.material < 0 || script.scene.materials[static_cast<std::size_t>(body.material)].joint) return {};
  return fmt::format("body {} has no joints: {}", in_quotes(body.name),
                     body.rigid ? "it is rigid" : "its material says nothing of fracture");
}

int body(Script& script, Form& form) {
  scene::Body body;
  form.name(body.name, script.scene.bodies.size(), Need::optional, "its name");
  int shape = -1;
  if (form.handle("shape", Kind::shape, shape, "where it is: box{}, disc{}, ...")) {
    auto const& known = script.shapes[static_cast<std::size_t>(shape)];
    script.weigh(known.weight);
    body.shape = known.shape;
    if (std::holds_alternative<scene::Notch>(body.shape.is))
      form.problem("a notch is no body (it is taken away from one); write difference{ shape, notch{...} }", "shape");
  }
  bool const from_file = body.shape.mesh_file();
  form.part(
      "mesh", "how it is cut into elements", [&](Form& part) { mesh(script, part, body, from_file); },
      from_file ? Need::optional : Need::required);
  form.handle("material", Kind::material, body.material, "what it is made of");
  if (form.type_of("velocity") == LUA_TFUNCTION) {
    Callee callee;
    form.function("velocity", callee, "", "", Need::optional);
    body.velocity_at = [&script, callee](double x, double y, double z) { return script.ask_vector(callee, x, y, z); };
    try {  // where the body has no simple point the mesh will ask
      if (auto const p = point_inside(body.shape))
        body.velocity_at((*p)[0], (*p)[1], script.dimension == 3 ? (*p)[2] : 0);
    } catch (Error const& error) {
      script.problem({}, error.what());
    }
  } else {
    form.declare("velocity", "{ x, y }, { x, y, z } or function(x, y, z)", {"m/s"}, "{ 0, 0, 0 }",
                 "initial velocity; a function returns { x, y } or { x, y, z }");
    form.vector("velocity", body.velocity.data(), {"m/s", -unlimited, unlimited, -2e4, 2e4}, "initial velocity");
  }
  if (form.type_of("stress") == LUA_TFUNCTION) {
    Callee callee;
    form.function("stress", callee, "", "", Need::optional);
    body.stress_at = [&script, callee](double x, double y, double z) { return script.ask_stress(callee, x, y, z); };
  } else {
    std::array<double, 6> stress{};
    auto const& components = scene::stress_components();
    if (form.part("stress",
                  "that it begins with, in the place where it is drawn, tension positive; or a function(x, y, z) that "
                  "returns such a table, linear in place unless the material flows. In plane strain zz follows from "
                  "the others, but "
                  "for what flows; around an axis it equals xx, and all are alike at all radii. What keeps it in "
                  "balance (pressures, holds, weight) is the scene's: where nothing does, as on a free slope, the body "
                  "settles as if it had been cut free at the start",
                  [&](Form& part) {
                    for (std::size_t k = 0; k < 6; ++k)
                      part.number(components[k], stress[k], any_number("Pa"), "component of the stress");
                    if (!part.listing() && script.dimension == 2 && (stress[4] != 0 || stress[5] != 0))
                      part.problem("stress has yz or zx, which pull out of the plane of two dimensions; leave them out",
                                   stress[4] != 0 ? "yz" : "zx");
                  }))
      body.stress_at = [stress](double, double, double) { return stress; };
  }
  form.boolean("rigid", body.rigid,
               "true: it moves and turns as one piece that never deforms, pushed by what it touches, by loads and by "
               "its weight; of its material it takes the density and what contact needs. A hold moves all of it");
  if (body.rigid && body.stress_at)
    form.problem("a rigid body has no stress, and cannot begin with one; leave stress or rigid out", "stress");
  if (body.rigid && body.material >= 0) body.material = without_forces(script, body.material);
  temperature(script, form, body);
  if (form.listing()) return 0;
  form.claim(body.name);
  form.done();
  body.source = form.source();
  script.scene.bodies.push_back(body);
  script.push_handle({Kind::body, static_cast<int>(script.scene.bodies.size()) - 1});
  return 1;
}

/// Joints of a body that are not like the others.
int joints(Script& script, Form& form) {
  scene::JointSet set;
  form.name(set.name, script.scene.joint_sets.size(), Need::optional, "its name");
  form.handle("[]", Kind::body, set.body, "the body");
  if (!form.listing() && form.type_of("[]") != LUA_TNIL)
    form.problem(
        "are those inside one body; between bodies there are none, unless bond{ a, b, fracture = ... } makes them");
  form.number("strength", set.strength, {"", 0, 1e3, 0, 10},
              "their strengths over those of the material; their fracture energies are its square times those; 0: "
              "broken from the start",
              Need::required);
  bool const by_place = form.type_of("at") != LUA_TNIL, by_direction = form.type_of("facing") != LUA_TNIL;
  scene::Seam seam;
  bool const on_seam =
      line_or_polygon(script, form, seam, "faces on the line (3D: plane along z) from here; mesh.seam puts faces there",
                      "to here", false);
  if (on_seam) set.seam = seam;
  Callee callee;
  if (form.function("at", callee, "function(x, y, z)", "says true for the middles of its faces", Need::optional) &&
      by_place) {
    set.inside = [&script, callee](double x, double y, double z) { return script.ask_inside(callee, x, y, z); };
    try {
      set.inside(0, 0, 0);
    } catch (Error const& error) {
      script.problem({}, error.what());
    }
  }
  Vec3 facing = Vec3::Zero();
  form.declare("facing", "{ x, y } or { x, y, z }", {}, "left out",
               "faces whose normal is within an angle of it, either way");
  form.vector("facing", facing.data(), any_number(""), "faces whose normal is within an angle of it, either way",
              Need::optional);
  form.number("within", set.within, {"rad", 0, 1.5707963267948966}, "that angle");
  if (form.listing()) return 0;
  if (by_direction) set.facing = facing;
  if (by_direction && !(facing.norm() > 0)) form.problem("facing has no direction (all zero)", "facing");
  if (by_direction && form.type_of("within") == LUA_TNIL)
    form.problem("facing needs within, an angle (facing = { 0, 1 }, within = 20*deg)", "facing");
  if (form.type_of("within") != LUA_TNIL && !by_direction)
    form.problem("within has no meaning without facing", "within");
  if (!on_seam && !by_place && !by_direction)
    form.problem(
        "says of no joint where it is; write from = and to =, corners =, at = function(x, y, z), or facing = and "
        "within =");
  if (auto const why = set.body >= 0 ? without_joints(script, set.body) : std::nullopt) form.problem(*why);
  form.claim(set.name);
  form.done();
  set.source = form.source();
  script.scene.joint_sets.push_back(set);
  return 0;
}

/// An optional `at`, asked once so that what is wrong with it is told at once.
void inside_function(Script& script, Form& form, char const* meaning,
                     std::function<bool(double, double, double)>& inside) {
  Callee callee;
  if (!form.function("at", callee, "function(x, y, z)", meaning, Need::optional) || form.type_of("at") == LUA_TNIL)
    return;
  inside = [&script, callee](double x, double y, double z) { return script.ask_inside(callee, x, y, z); };
  try {
    inside(0, 0, 0);
  } catch (Error const& error) {
    script.problem({}, error.what());
  }
}

bool joins(scene::Bond const& bond, scene::Tie const& tie) {
  return std::ranges::all_of(tie.bodies, [&](int b) { return std::ranges::count(bond.bodies, b) > 0; });
}

/// Joints between bodies.
int bond(Script& script, Form& form) {
  scene::Bond bond;
  form.name(bond.name, script.scene.bonds.size(), Need::optional, "its name");
  bond.bodies = form.handles(Kind::body, "the bodies: any two of them that touch are joined, face to face");
  form.part(
      "fracture",
      "how the bond breaks, as that of a material; a bond is a plane of its own and begins by the traction on it, "
      "whatever criterion says",
      [&](Form& part) { read_fracture(script, part, bond.joint, bond.scatter); }, Need::required);
  inside_function(script, form,
                  "says true for the middles of faces that are joined; left out: all where the bodies meet; others "
                  "are cracks from the start",
                  bond.inside);
  if (form.listing()) return 0;
  if (bond.joint.inserted)
    form.problem("fracture.insertion = \"adaptive\" is for materials: a bond's joints are there from the start",
                 "fracture");
  if (bond.bodies.size() < 2) form.problem("joins bodies, two at least: bond{ \"glue\", one, other, fracture = ... }");
  for (std::size_t i = 0; i < bond.bodies.size(); ++i) {
    auto const& body = script.scene.bodies[static_cast<std::size_t>(bond.bodies[i])];
    if (std::count(bond.bodies.begin(), bond.bodies.begin() + static_cast<long>(i), bond.bodies[i]) > 0)
      form.problem(fmt::format("body {} is said twice", in_quotes(body.name)));
    if (auto const why = without_joints(script, bond.bodies[i]))
      form.problem(*why + (body.rigid ? "" : "; one that must not break gets strengths that are never reached"));
  }
  for (auto const& tie : script.scene.ties)
    if (joins(bond, tie))
      form.problem(fmt::format("two of its bodies hang together already, by tie {}", in_quotes(tie.name)));
  form.claim(bond.name);
  form.done();
  bond.source = form.source();
  script.scene.bonds.push_back(bond);
  return 0;
}

/// Two bodies that hang together.
int tie(Script& script, Form& form) {
  scene::Tie tie;
  form.name(tie.name, script.scene.ties.size(), Need::optional, "its name");
  auto const bodies =
      form.handles(Kind::body, "the two bodies; the one with the smaller cells where they meet hangs on the other");
  form.number("within", tie.within, positive("m"),
              "nodes nearer than this to a surface of the other body that faces them hang on it; left out: a fifth of "
              "that one's edges there");
  inside_function(script, form, "says true for nodes that are tied; left out: all that are near enough", tie.inside);
  if (form.listing()) return 0;
  if (bodies.size() != 2) form.problem(fmt::format("has {} bodies; write tie{{ one, other }}", bodies.size()));
  for (std::size_t i = 0; i < std::min<std::size_t>(bodies.size(), 2); ++i) {
    auto const& body = script.scene.bodies[static_cast<std::size_t>(bodies[i])];
    tie.bodies[i] = bodies[i];
    if (body.rigid)
      form.problem(fmt::format("body {} is rigid: ties are between bodies that deform; hold{{}} moves a surface as one",
                               in_quotes(body.name)));
    if (body.stress_at)
      form.problem(
          fmt::format("body {} has a stress at the start, which ties cannot balance; settle{{}} brings tied "
                      "bodies to rest under gravity and loads",
                      in_quotes(body.name)));
  }
  if (tie.bodies[0] == tie.bodies[1] && tie.bodies[0] >= 0) form.problem("ties a body to itself");
  for (auto const& bond : script.scene.bonds)
    if (joins(bond, tie))
      form.problem(fmt::format("its bodies are of bond {} already, which joins their meshes", in_quotes(bond.name)));
  form.claim(tie.name);
  form.done();
  tie.source = form.source();
  script.scene.ties.push_back(tie);
  script.push_handle({Kind::tie, static_cast<int>(script.scene.ties.size()) - 1});
  return 1;
}

}  // namespace

std::vector<Verb> material_verbs() {
  return {
      {"param", "A number that --set can change.", "local v = param(\"speed\", 2, \"speed of each plate (m/s)\")",
       "number", param},
      {"material", "What bodies are made of. Leaving a part out leaves its model out.",
       "local rock = material{ \"rock\", density = 2700, elastic = { young = 50*GPa, poisson = 0.25 } }",
       "fissure.material", material},
      {"body", "Something that deforms, moves and can break.",
       "local disc = body{ \"disc\", shape = disc{ radius = 25*mm, thickness = 25*mm }, mesh = { size = 3*mm }, "
       "material = rock }",
       "fissure.body", body},
      {"joints",
       "Joints of a body with strengths of their own: weak planes, joint sets, cracks that are there from the start. "
       "Of from and to, at and facing all that are given must hold. A face belongs to one set at most.",
       "joints{ \"bedding\", block, facing = { 0, 1 }, within = 20*deg, strength = 0.3 }", "", joints},
      {"bond",
       "Joints between bodies that touch: glue, mortar, the skin of an inclusion. The bodies are meshed together, so "
       "that their faces match; where the bond is broken they touch like others. They keep their materials, names and "
       "places, must be able to crack and have cells that are simplices.",
       "bond{ \"mortar\", brick, wall, fracture = { tension = 0.5*MPa, shear = 1*MPa, G1 = 10*J/m2, G2 = 40*J/m2, "
       "penalty = 100*GPa } }",
       "", bond},
      {"tie",
       "Two bodies that hang together where their surfaces meet, whatever their meshes: a fine region in a coarse "
       "one, a specimen glued to its platens. A tie never breaks, costs no time step and does no work.",
       "local glue = tie{ platen, specimen }", "fissure.tie", tie},
  };
}

std::string material_list() {
  static constexpr char const* rows = R"lua(
local function row(...) return string.format("%-16s %13s %8s %8s %14s  %-22s %s\n", ...) end
local function number(x) return string.format("%.4g", x) end
local function law(flow, crack)
  return (flow and flow.law or "") .. (flow and crack and ", " or "") .. (crack and "joints" or "")
end
local text = row("name", "density kg/m3", "E GPa", "Poisson", "strength MPa", "law", "source")
for name, m in pairs(require "materials") do
  local flow, crack = m.plastic, m.fracture
  local strength = crack and crack.tension or flow.A or flow.yield[1][2]
  text = text .. row(name, number(m.density), number(m.elastic.young/GPa), number(m.elastic.poisson),
                     number(strength/MPa), law(flow, crack), m.source)
end
return text .. "strength: where joints open in tension, or else where flow begins (johnson_cook: A)\n"
)lua";
  Script script(2);
  script.declaring = true;
  std::string error = script.load(rows, "=list");
  if (error.empty()) error = script.call(0, 1, reading_limit);
  if (!error.empty()) throw Error(error);
  return lua_tostring(script.state(), -1);
}

}  // namespace fissure::lua
