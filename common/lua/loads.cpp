// What is done to the bodies: plates, walls, prescribed motion, loads, absorbing boundaries, gravity; and what is
// assumed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "lua/reader.h"

namespace fissure::lua {
namespace {

void contact(Form& form, std::optional<laws::ContactLaw>& to) {
  laws::ContactLaw law;
  if (form.part("contact", "how it touches; left out: as the body that touches it",
                [&](Form& part) { part.parameters(law); }))
    to = law;
}

void once(Script& script, Form& form, char const* verb) {
  if (!form.listing() && script.said[verb] > 1) form.problem("is said a second time; a scene has one");
}

bool is_rigid(Script const& script, int body) {
  return body >= 0 && script.scene.bodies[static_cast<std::size_t>(body)].rigid;
}

int plate(Script& script, Form& form) {
  scene::Plate plate;
  form.name(plate.name, script.scene.plates.size(), Need::optional, "its name");
  int shape = -1;
  bool given = false;
  if (form.listing()) {
    form.declare("[]", "shape", {}, "required, or box",
                 "a rigid box: above(body), below(body), left_of(body), right_of(body)");
    form.declare("box", "shape", {}, "required, or the second entry", "a rigid box: box{ size = ..., center = ... }");
  } else if (form.type_of("box") != LUA_TNIL) {
    given = form.handle("box", Kind::shape, shape, "a rigid box");
  } else {
    form.declare("box", "shape", {}, "", "");
    given = form.handle("[]", Kind::shape, shape, "its box: above(body), below(body), ... or box{}");
  }
  form.directions("velocity", plate.velocity, "m/s", "how it moves; a component left out stands still", Need::optional);
  form.directions("force", plate.force, "N",
                  "what drives it instead; nil leaves a component as velocity says, 0 lets it slide freely. 2D: on the "
                  "scene's thickness, or once around the axis",
                  Need::optional);
  bool const heavy = form.number("mass", plate.mass, positive("kg"), "of a plate that a force drives");
  form.part(
      "servo", "what finds its velocity while the run goes on, along directions that neither velocity nor force names",
      [&](Form& part) {
        scene::Servo servo;
        Callee callee;
        part.number("every", servo.every, positive("s"), "how often it is asked; in between nothing changes",
                    Need::required);
        part.function("velocity", callee, "function(now)", "returns { x, y } or { x, y, z } [m/s]", Need::required);
        if (part.listing()) return;
        servo.velocity = [&script, callee](scene::Now const& now) { return script.ask_servo(callee, now); };
        plate.servo = servo;
        script.rehearse(servo.velocity);
      });
  contact(form, plate.contact);
  if (form.listing()) return 0;
  if (given) {
    auto const& given_shape = script.shapes[static_cast<std::size_t>(shape)].shape.is;
    if (auto const* const box = std::get_if<scene::Box>(&given_shape))
      plate.box = *box;
    else if (std::holds_alternative<scene::Placed>(given_shape))
      form.problem(
          "a plate is a box whose edges lie along x, y and z: moved{ box{...} } is one, turned{ box{...} } is none; "
          "for "
          "a sloping support write wall{ normal = ... } or a body with hold{ at = \"all\" }");
    else
      form.problem("a plate is a box; write box{ size = ..., center = ... }");
  }
  bool pushed = false;
  for (std::size_t c = 0; c < 3; ++c) {
    pushed = pushed || plate.force[c];
    if (plate.force[c] && plate.velocity[c])
      form.problem(
          fmt::format("has a velocity and a force along {}; one of them drives it, the other is nil", "xyz"[c]),
          "force");
  }
  bool driven = true;
  for (std::size_t c = 0; c < static_cast<std::size_t>(script.dimension); ++c)
    driven = driven && (plate.force[c] || plate.velocity[c]);
  if (plate.servo && driven)
    form.problem("has a servo that finds nothing to drive: velocity and force name every direction", "servo");
  if (pushed && !heavy && form.type_of("mass") == LUA_TNIL)
    form.problem("mass is missing (a number in kg): it says how fast the force moves the plate");
  if (!pushed && heavy)
    form.problem("mass is of a plate that a force drives; give it a force, or leave mass out", "mass");
  form.claim(plate.name);
  form.done();
  plate.source = form.source();
  script.scene.plates.push_back(plate);
  script.push_handle({Kind::plate, static_cast<int>(script.scene.plates.size()) - 1});
  return 1;
}

int wall(Script& script, Form& form) {
  scene::Wall wall;
  form.name(wall.name, script.scene.walls.size(), Need::optional, "its name");
  form.vector("point", wall.point.data(), any_number("m"), "a point of it");
  form.vector("normal", wall.normal.data(), any_number(""), "points to the side where everything must stay");
  contact(form, wall.contact);
  if (form.listing()) return 0;
  if (wall.normal.norm() > 0)
    wall.normal.normalize();
  else
    form.problem("normal has no direction (all zero)", "normal");
  form.claim(wall.name);
  form.done();
  wall.source = form.source();
  script.scene.walls.push_back(wall);
  script.push_handle({Kind::wall, static_cast<int>(script.scene.walls.size()) - 1});
  return 1;
}

/// The body and the part of it that a load acts on; names are the mesher's. A flat model has an empty front and back,
/// so that one scene can hold them in both dimensions.
template <class Load>
void where(Script& script, Form& form, Load& load, std::string const& or_else = "") {
  std::vector<std::string> known{"left", "right", "bottom", "top", "front", "back", "surface"};
  if constexpr (std::is_same_v<Load, scene::Hold>) known.emplace_back("all");
  std::string all;
  for (auto const& name : known) all += (all.empty() ? "" : ", ") + in_quotes(name);
  form.handle("[]", Kind::body, load.body, "the body");
  form.region("at", load.where,
              "part of it: " + all +
                  " (what is furthest that way, wherever the shape was turned), a physical group of its mesh file, or "
                  "function(x, y, z) that says true there" +
                  or_else);
  if (form.listing() || load.body < 0 || load.where.name.empty()) return;
  auto const& shape = script.scene.bodies[static_cast<std::size_t>(load.body)].shape;
  if (shape.mesh_file()) return;
  if (std::find(known.begin(), known.end(), load.where.name) == known.end())
    form.problem(fmt::format("at = {} is no part of this body (it has {}){}", in_quotes(load.where.name), all,
                             suggestion(load.where.name, known)),
                 "at");
}

int hold(Script& script, Form& form) {
  scene::Hold hold;
  where(script, form, hold);
  form.directions("velocity", hold.velocity, "m/s",
                  "prescribed velocity; nil leaves a component free, 0 holds it (a roller); two holds may not move one "
                  "vertex differently. Required without around",
                  Need::optional);
  scene::Around around;
  if (form.part("around",
                "instead: about an axis that stands still; what is held moves in no other way, along the axis neither",
                [&](Form& part) {
                  part.time_function("turning", around.turning, "rad/s", "how fast, by the right hand", Need::optional);
                  part.time_function("outward", around.outward, "m/s", "away from the axis", Need::optional);
                  part.vector("through", around.through.data(), any_number("m"), "a point of the axis");
                  part.axis("axis", around.axis, "its direction, required in 3D; in 2D it is z");
                  if (part.listing()) return;
                  if (script.dimension == 3 && part.type_of("axis") == LUA_TNIL)
                    part.problem("axis is missing; a rod along y turns about axis = { 0, 1, 0 }");
                  if (script.dimension == 2 && std::hypot(around.axis[0], around.axis[1]) > 1e-12)
                    part.problem("axis must be { 0, 0, 1 } in two dimensions, where everything turns about z", "axis");
                  if (part.type_of("turning") == LUA_TNIL && part.type_of("outward") == LUA_TNIL)
                    part.problem("around moves nothing; write turning = ... or outward = ...");
                }))
    hold.around = around;
  if (form.listing()) return 0;
  if (hold.around && is_rigid(script, hold.body) && (hold.around->outward.function || hold.around->outward.number != 0))
    form.problem("the body is rigid and cannot move away from an axis on all sides; leave around.outward out",
                 "around");
  if (hold.around && form.type_of("velocity") != LUA_TNIL)
    form.problem("has both velocity and around; what is held moves in one way", "velocity");
  if (form.type_of("velocity") == LUA_TNIL && form.type_of("around") == LUA_TNIL)
    form.problem("says not how it moves; write velocity = { x, y } (0 holds, nil leaves free) or around = { ... }");
  if (hold.around)
    script.checks.push_back([&script, at = form.source()] {
      if (script.dimension == 2 && script.scene.two_d == "axisymmetric")
        script.problem(at,
                       "hold: around has no meaning in axisymmetry: outward is velocity = { x, nil }, and nothing "
                       "turns");
    });
  form.done();
  hold.source = form.source();
  script.scene.holds.push_back(hold);
  script.push_handle({Kind::hold, static_cast<int>(script.scene.holds.size()) - 1});
  return 1;
}

int traction(Script& script, Form& form) {
  scene::Traction traction;
  where(script, form, traction);
  form.directions("value", traction.value, "Pa", "force per reference area", Need::required);
  if (form.listing()) return 0;
  form.done();
  traction.source = form.source();
  script.scene.tractions.push_back(traction);
  return 0;
}

int pressure(Script& script, Form& form) {
  scene::Pressure pressure;
  where(script, form, pressure);
  form.time_function("value", pressure.value, "Pa", "pressure, inward when positive");
  form.boolean(
      "follows", pressure.follows,
      "true: it acts on the surface as it stands, as a fluid does; false: on its area and along its normal at rest");
  if (form.listing()) return 0;
  form.done();
  pressure.source = form.source();
  script.scene.pressures.push_back(pressure);
  return 0;
}

int force(Script& script, Form& form) {
  scene::Force force;
  bool const at_point = !form.listing() && form.type_of("at") == LUA_TTABLE;
  if (at_point) {
    form.handle("[]", Kind::body, force.body, "the body");
    Vec3 point(0, 0, 0);
    form.vector("at", point.data(), any_number("m"), "a point", Need::required);
    force.point = point;
  } else {
    where(script, form, force, ", or a point { x, y }, of which the nearest vertex is taken");
  }
  form.directions("value", force.value, "N",
                  "on all of it together, spread evenly; 2D: on the scene's thickness, or once around the axis",
                  Need::required);
  if (form.listing()) return 0;
  form.done();
  force.source = form.source();
  script.scene.forces.push_back(force);
  return 0;
}

int spring(Script& script, Form& form) {
  scene::Spring spring;
  form.name(spring.name, script.scene.springs.size(), Need::optional, "its name");
  auto const bodies =
      form.handles(Kind::body,
                   "the body at `from`, then the one at `to` (the same twice: inside it); one alone: `to` "
                   "is a place that stands still");
  bool const ends = form.vector("from", spring.at[0].data(), any_number("m"),
                                "its first end, on the cell that this point lies in", Need::required) &
                    form.vector("to", spring.at[1].data(), any_number("m"), "its second end", Need::required);
  form.number("stiffness", spring.stiffness, positive("N/m"),
              "force per change of length; 2D: on the scene's thickness, or once around the axis", Need::required);
  form.number("length", spring.length, not_negative("m"), "without force; a shorter one is taut from the start");
  form.number("damping", spring.damping, not_negative("N s/m"), "force per rate of length, of a damper beside it");
  form.number("strength", spring.strength, positive("N"),
              "pulled harder than this, its damper not counted, it breaks; left out: never");
  form.boolean("slack", spring.slack, "true: it only pulls and never pushes, as a rope does");
  if (form.listing()) return 0;
  if (bodies.empty() || bodies.size() > 2)
    form.problem(
        fmt::format("has {} bodies; it has two ends: write spring{{ body, from = ..., to = ... }} or spring{{ "
                    "body, other, from = ..., to = ... }}",
                    bodies.size()));
  for (std::size_t k = 0; k < std::min<std::size_t>(bodies.size(), 2); ++k) spring.bodies[k] = bodies[k];
  if (script.dimension == 2) spring.at[0][2] = spring.at[1][2] = 0;
  if (ends && (spring.at[0] - spring.at[1]).norm() == 0)
    form.problem("from and to are one place: a spring of no length pulls in no direction", "to");
  form.claim(spring.name);
  form.done();
  spring.source = form.source();
  script.scene.springs.push_back(spring);
  script.push_handle({Kind::spring, static_cast<int>(script.scene.springs.size()) - 1});
  return 1;
}

int body_force(Script& script, Form& form) {
  scene::BodyForce force;
  form.handle("[]", Kind::body, force.body, "the body");
  if (form.type_of("value") == LUA_TFUNCTION) {
    Callee callee;
    form.function("value", callee, "", "", Need::required);
    force.value_at = [&script, callee](double x, double y, double z) { return script.ask_vector(callee, x, y, z); };
  } else if (form.listing()) {
    form.declare("value", "{ x, y }, { x, y, z } or function(x, y, z)", {"N/m3"}, "required",
                 "force per volume at rest; a function of the place at rest returns { x, y } or { x, y, z }");
  } else {
    form.vector("value", force.value.data(), any_number("N/m3"), "force per volume", Need::required);
  }
  form.time_function("times", force.times, "", "how many times that, by time", Need::optional);
  if (form.listing()) return 0;
  form.done();
  force.source = form.source();
  script.scene.body_forces.push_back(force);
  return 0;
}

int excavate(Script& script, Form& form) {
  scene::Excavation excavation;
  form.handle("[]", Kind::body, excavation.body, "the body");
  form.number("time", excavation.time, not_negative("s"), "when it leaves: with the first step from then on",
              Need::required);
  form.predicate("within", excavation.within,
                 "says true of the middles, at rest, of those cells that leave; the body's cells must have corners of "
                 "their own (joints that are there from the start, insertion = \"intrinsic\"); else make what leaves a "
                 "body of its own and bond{} both",
                 "all of it");
  if (form.listing()) return 0;
  if (excavation.within && is_rigid(script, excavation.body))
    form.problem("a rigid body leaves altogether or not at all; leave within out", "within");
  form.done();
  excavation.source = form.source();
  script.scene.excavations.push_back(excavation);
  return 0;
}

int absorb(Script& script, Form& form) {
  scene::Absorb absorb;
  where(script, form, absorb);
  if (form.listing()) return 0;
  if (is_rigid(script, absorb.body)) form.problem("the body is rigid: no waves reach its surface");
  form.done();
  absorb.source = form.source();
  script.scene.absorbers.push_back(absorb);
  return 0;
}

int gravity(Script& script, Form& form) {
  double g[3] = {0, 0, 0};
  bool right = form.number("[]", g[0], {"m/s2", -unlimited, unlimited, -1e5, 1e5}, "along x", Need::required);
  right = form.number("[]", g[1], {"m/s2", -unlimited, unlimited, -1e5, 1e5}, "along y", Need::required) && right;
  form.number("[]", g[2], {"m/s2", -unlimited, unlimited, -1e5, 1e5}, "along z (3D)");
  if (form.listing()) return 0;
  if (right && script.dimension == 2 && g[2] != 0)
    form.problem("has a z component, and there is no z in two dimensions");
  once(script, form, "gravity");
  if (g[0] != 0)
    script.checks.push_back([&script, at = form.source()] {
      if (script.dimension == 2 && script.scene.two_d == "axisymmetric")
        script.problem(
            at,
            "gravity has an x component, and with two_d = \"axisymmetric\" x is the radius; only y is along the axis");
    });
  form.done();
  script.scene.gravity = {g[0], g[1], g[2]};
  return 0;
}

int settle(Script& script, Form& form) {
  scene::Settling settling;
  form.number("time", settling.time, positive("s"),
              "how long; left out: ten times as long as a wave takes through the scene and back, twice");
  form.number(
      "damping", settling.damping, positive("1/s"),
      "alpha of the damping force alpha m v in that time; left out: what calms the slowest vibration of a scene "
      "of this size soonest");
  if (form.listing()) return 0;
  once(script, form, "settle");
  form.done();
  settling.source = form.source();
  script.scene.settling = settling;
  return 0;
}

int assume(Script& script, Form& form) {
  form.word("two_d", script.scene.two_d, {"plane strain", "plane stress", "axisymmetric"},
            "how a 2D program reads the scene; axisymmetric: x is the radius, y the axis, all is per full revolution");
  form.boolean("contact", script.scene.contact,
               "false: bodies and fragments go through each other; only plates and walls stop them");
  if (form.listing())
    form.declare("thickness", "number", positive("m"), "the bodies'",
                 "out of plane, in 2D: forces are those of such a slice");
  else
    form.number("thickness", script.two_d_thickness, positive("m", 1e-7, 1e4), "out of plane, in 2D");
  if (form.listing()) return 0;
  if (script.scene.two_d == "axisymmetric" && script.two_d_thickness > 0)
    form.problem("thickness has no meaning with two_d = \"axisymmetric\" (all is per full revolution); leave it out",
                 "thickness");
  once(script, form, "assume");
  form.done();
  return 0;
}

/// The time function of a ramp: a cycloid, whose first and second derivatives are 0 at both ends, so that it starts few
/// vibrations.
int ramp_at(lua_State* L) {
  auto const bound = [&](int i) { return lua_tonumber(L, lua_upvalueindex(i)); };
  double const from = bound(1), to = bound(2),
               share = std::clamp((luaL_checknumber(L, 1) - bound(4)) / bound(3), 0.0, 1.0);
  lua_pushnumber(L, from + (to - from) * (share - std::sin(2 * std::numbers::pi * share) / (2 * std::numbers::pi)));
  return 1;
}

int ramp(Script& script, Form& form) {
  double from = 0, to = 0, over = 0, start = 0;
  form.number("to", to, any_number(""), "where it ends, in the unit of what is ramped", Need::required);
  form.number("over", over, positive("s"), "how long it takes", Need::required);
  form.number("from", from, any_number(""), "where it begins");
  form.number("start", start, any_number("s"), "when it begins");
  if (form.listing()) return 0;
  form.done();
  lua_State* const L = script.state();
  for (double const bound : {from, to, over, start}) lua_pushnumber(L, bound);
  lua_pushcclosure(L, ramp_at, 4);
  return 1;
}

}  // namespace

std::vector<Verb> load_verbs() {
  return {
      {"plate", "A rigid box that moves as told; now.force(plate) is what the bodies push it with.",
       "local top = plate{ above(disc), velocity = { 0, -0.05 } }", "fissure.plate", plate},
      {"wall", "A rigid half-space: everything behind a plane.", "wall{ point = {0, 0}, normal = {0, 1} }",
       "fissure.wall", wall},
      {"hold", "Prescribed motion of a part of a body.",
       "local foot = hold{ bar, at = \"bottom\", velocity = { nil, 0 } }", "fissure.hold", hold},
      {"traction", "A force per area on a part of a body's surface.",
       "traction{ bar, at = \"top\", value = { 0, 1*MPa } }", "", traction},
      {"pressure", "A pressure on a part of a body's surface.",
       "pressure{ ring, at = function(x, y, z) return x^2 + y^2 < 0.01 end, value = function(t) return 1e9*t end }", "",
       pressure},
      {"force", "A force on a part of a body's surface, or at a point.",
       "force{ beam, at = { 0, 50*mm }, value = { 0, ramp{ to = -2*kN, over = 1*ms } } }", "", force},
      {"spring", "A spring between two points: a bolt, an anchor, a rope.",
       "local bolt = spring{ \"bolt\", roof, from = { 0, 0 }, to = { 0, 2 }, stiffness = 2e8, strength = 100*kN }",
       "fissure.spring", spring},
      {"body_force", "A force on every part of a body, by place and time.",
       "body_force{ rotor, value = function(x, y) return { 7800*om^2*x, 7800*om^2*y } end }", "", body_force},
      {"excavate",
       "A body, or a part of one, leaves the run with its mass and all that it holds: a tunnel, a prop that is struck "
       "away. Whole cells leave; questions about them are answered by 0.",
       "excavate{ rock, time = 2*ms, within = function(x, y) return x^2 + y^2 < 4 end }", "", excavate},
      {"absorb",
       "A part of a body's surface that takes up the waves that reach it, as if the body went on: dashpots of its wave "
       "impedances (Lysmer & Kuhlemeyer 1969). It carries nothing at rest.",
       "absorb{ ground, at = \"bottom\" }", "", absorb},
      {"ramp",
       "A function of time that goes smoothly from one value to another: velocities and loads that start few "
       "vibrations.",
       "local push = plate{ above(disc), velocity = { 0, ramp{ to = -0.05, over = 1*ms } } }", "fun(t: number): number",
       ramp},
      {"settle",
       "Before the start bodies come to rest under weight, loads and stresses as they are at t = 0, while holds and "
       "plates stand still; at t = 0 they begin with their velocities. What they moved by stays in displacements.",
       "settle{}", "", settle},
      {"gravity",
       "Acceleration of everything, always. One that changes by place or time is a body_force{}: density times it.",
       "gravity{ 0, -9.81 }", "", gravity},
      {"assume", "How the world is simplified.", "assume{ two_d = \"plane stress\" }", "", assume},
  };
}

}  // namespace fissure::lua
