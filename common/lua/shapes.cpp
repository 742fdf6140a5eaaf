// Shapes: box, disc, rod, ball, ring, polygon, revolved, notch, mesh_file, union, difference; moved, turned, mirrored
// and scaled ones; and rigid boxes beside a body.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "lua/reader.h"

namespace fissure::lua {
namespace {

Quantity length() { return positive("m", 1e-7, 1e5); }
Quantity place() { return {"m", -unlimited, unlimited, -1e7, 1e7}; }

int give_shape(Script& script, Form& form, scene::Shape shape, int weight = 1, int depth = 1) {
  if (form.listing()) return 0;
  form.done();
  shape.source = form.source();
  script.push_handle({Kind::shape, script.add_shape({std::move(shape), weight, depth})});
  return 1;
}

/// A flat shape's extent along z: what a 2D model takes as its thickness, and a 3D one must know.
void thickness(Script& script, Form& form, double& to) {
  bool const given = form.number("thickness", to, length(),
                                 "extent along z, centred on z = 0; in 2D only forces know it (default there: 1 m)");
  if (!form.listing() && !given && form.type_of("thickness") == LUA_TNIL && script.dimension == 3)
    form.problem("thickness is missing (a number in m; three dimensions need it)");
}

int box(Script& script, Form& form) {
  scene::Box shape;
  form.extent("size", shape.size, "edge lengths along x, y and z (2D: z is the thickness, and may be left out)");
  form.vector("center", shape.center.data(), place(), "its middle");
  return give_shape(script, form, {shape, {}});
}

int disc(Script& script, Form& form) {
  scene::Disc shape;
  form.number("radius", shape.radius, length(), "radius", Need::required);
  thickness(script, form, shape.thickness);
  form.vector("center", shape.center.data(), place(), "its middle");
  return give_shape(script, form, {shape, {}});
}

int rod(Script& script, Form& form) {
  scene::Rod shape;
  form.number("radius", shape.radius, length(), "radius", Need::required);
  form.number("length", shape.length, length(), "length along y", Need::required);
  std::optional<double> end;
  form.number("end_radius", end, length(), "radius of its upper end, for a tapered rod; left out: as radius");
  shape.end_radius = end.value_or(0);
  form.vector("base", shape.center.data(), place(), "middle of its lower end");
  return give_shape(script, form, {shape, {}});
}

int ball(Script& script, Form& form) {
  scene::Ball shape;
  form.number("radius", shape.radius, length(), "radius", Need::required);
  form.vector("center", shape.center.data(), place(), "its middle");
  return give_shape(script, form, {shape, {}});
}

int ring(Script& script, Form& form) {
  scene::Ring shape;
  bool const inner = form.number("inner", shape.inner, length(), "inner radius", Need::required);
  bool const outer = form.number("outer", shape.outer, length(), "outer radius", Need::required);
  thickness(script, form, shape.thickness);
  form.vector("center", shape.center.data(), place(), "its middle");
  if (inner && outer && shape.inner >= shape.outer)
    form.problem(fmt::format("inner = {} m must be smaller than outer = {} m", shown(shape.inner), shown(shape.outer)),
                 "inner");
  return give_shape(script, form, {shape, {}});
}

using Point = std::array<double, 2>;
double turn(Point const& a, Point const& b, Point const& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Two edges that share no corner cross. Quadratic, so only for outlines drawn by hand; the mesher judges the others.
bool crosses_itself(std::vector<Point> const& p) {
  std::size_t const n = p.size();
  if (n > 1000) return false;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      Point const &a = p[i], &b = p[i + 1], &c = p[j], &d = p[(j + 1) % n];
      if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) return true;
    }
  return false;
}

/// An outline as it is given; it goes on counter-clockwise.
void outline(Form& form, std::vector<Point>& p) {
  if (form.points("points", p, "corners, in order around")) {
    double area = 0, least[2] = {unlimited, unlimited}, most[2] = {-unlimited, -unlimited};
    for (std::size_t i = 0; i < p.size(); ++i) {
      auto const& next = p[(i + 1) % p.size()];
      area += (p[i][0] * next[1] - p[i][1] * next[0]) / 2;
      for (std::size_t c = 0; c < 2; ++c) least[c] = std::min(least[c], p[i][c]), most[c] = std::max(most[c], p[i][c]);
      if (p.size() > 2 && p[i] == next) form.problem(fmt::format("points[{}] stands twice in a row", i + 1), "points");
    }
    if (area < 0) std::reverse(p.begin(), p.end());
    if (p.size() < 3)
      form.problem(fmt::format("points has {} corners, and a polygon has at least 3", p.size()), "points");
    else if (!(std::abs(area) > 1e-12 * (most[0] - least[0]) * (most[1] - least[1])))
      form.problem("points encloses no area", "points");
    else if (crosses_itself(p))
      form.problem("points crosses itself", "points");
  }
}

int polygon(Script& script, Form& form) {
  scene::Polygon shape;
  outline(form, shape.points);
  thickness(script, form, shape.thickness);
  int const weight = static_cast<int>(1 + shape.points.size());
  return give_shape(script, form, {std::move(shape), {}}, weight);
}

int revolved(Script& script, Form& form) {
  scene::Revolved shape;
  outline(form, shape.points);
  for (std::size_t i = 0; i < shape.points.size(); ++i)
    if (shape.points[i][0] < 0) {
      form.problem(fmt::format("points[{}] has x = {} m, beyond the y axis that it turns about; draw the half of the "
                               "section where x >= 0",
                               i + 1, shown(shape.points[i][0])),
                   "points");
      break;
    }
  int const weight = static_cast<int>(1 + shape.points.size());
  return give_shape(script, form, {std::move(shape), {}}, weight);
}

int notch(Script& script, Form& form) {
  scene::Notch shape;
  bool const from = form.point("from", shape.from, "start of its middle line");
  bool const to = form.point("to", shape.to, "end of its middle line");
  form.number("width", shape.width, length(), "width", Need::required);
  if (from && to && shape.from == shape.to) form.problem("from and to are the same point", "to");
  return give_shape(script, form, {shape, {}});
}

int mesh_file(Script& script, Form& form) {
  scene::MeshFile shape;
  if (form.text("[]", shape.path,
                "file beside the scene (or in a folder there), from Gmsh; physical groups become names",
                Need::required)) {
    // A scene from a stranger reads meshes, nothing else.
    bool const inside = shape.path[0] != '/' && shape.path.find("..") == std::string::npos &&
                        shape.path.find('\\') == std::string::npos;
    bool const mesh = shape.path.size() > 4 && shape.path.ends_with(".msh");
    if (!mesh)
      form.problem(fmt::format("{} is no .msh file", in_quotes(shape.path)));
    else if (!inside)
      form.problem(fmt::format("{} must stand beside the scene or in a folder there", in_quotes(shape.path)));
    auto const slash = script.scene.file.rfind('/');
    if (slash != std::string::npos) shape.path = script.scene.file.substr(0, slash + 1) + shape.path;
  }
  return give_shape(script, form, {shape, {}});
}

template <class Combined>
int combine(Script& script, Form& form, char const* sentence) {
  Combined shape;
  auto const indices = form.handles(Kind::shape, sentence);
  int weight = 1, depth = 0;
  for (int const index : indices) {
    auto const& part = script.shapes[static_cast<std::size_t>(index)];
    weight += part.weight;
    depth = std::max(depth, part.depth);
    if (weight > 1000000) throw std::runtime_error("a shape has more than 1000000 parts");
    shape.parts.push_back(part.shape);
  }
  if (!form.listing() && shape.parts.size() < 2) form.problem("needs at least two shapes");
  return give_shape(script, form, {std::move(shape), {}}, weight, depth + 1);
}

int make_union(Script& script, Form& form) { return combine<scene::Union>(script, form, "shapes that become one"); }
int make_difference(Script& script, Form& form) {
  return combine<scene::Difference>(script, form, "a shape, then those that are taken away from it");
}

scene::Notch placed_notch(Form& form, scene::Notch notch, scene::Placed const& placed) {
  bool const scaled = placed.how == scene::Placed::How::scaled;
  if (std::abs(placed.map().col(2).normalized()[2]) < 1 - 1e-12)
    form.problem("a notch goes through the whole thickness along z; it can only be turned about z");
  if (scaled && placed.by[0] != placed.by[1])
    form.problem("a notch has one width; scale it alike along x and y", "factor");
  for (auto* const end : {&notch.from, &notch.to}) {
    Vec3 const x = placed(Vec3((*end)[0], (*end)[1], 0));
    *end = {x[0], x[1]};
  }
  if (scaled) notch.width *= placed.by[0];
  return notch;
}

/// A shape at another place. Where what it is stays the same it is that at once: a box that is moved or scaled may be a
/// plate, and have a regular grid.
int give_placed(Script& script, Form& form, scene::Placed placed, int index) {
  if (form.listing()) return 0;
  if (index < 0) {
    form.done();
    return give_shape(script, form, {scene::Box{{0, 0, 0}, {1, 1, 1}}, {}});
  }
  auto const known = script.shapes[static_cast<std::size_t>(index)];
  scene::Shape shape;
  std::visit(
      [&](auto part) {
        if constexpr (std::is_same_v<decltype(part), scene::Notch>) {
          shape.is = placed_notch(form, part, placed);
        } else {
          if constexpr (requires { part.center; })
            if (placed.how == scene::Placed::How::moved) {
              part.center += placed.by;
              shape.is = part;
              return;
            }
          if constexpr (std::is_same_v<decltype(part), scene::Box>)
            if (placed.how == scene::Placed::How::scaled) {
              shape.is = scene::Box{placed(part.center), part.size.cwiseProduct(placed.by)};
              return;
            }
          placed.part = {known.shape};
          shape.is = placed;
        }
      },
      known.shape.is);
  return give_shape(script, form, std::move(shape), known.weight, known.depth + 1);
}

int moved(Script& script, Form& form) {
  scene::Placed placed;
  int shape = -1;
  form.handle("[]", Kind::shape, shape, "the shape");
  form.vector("by", placed.by.data(), place(), "how far", Need::required);
  return give_placed(script, form, placed, shape);
}

int turned(Script& script, Form& form) {
  scene::Placed placed;
  placed.how = scene::Placed::How::turned;
  int shape = -1;
  std::string axis = "z";
  form.handle("[]", Kind::shape, shape, "the shape");
  form.number("angle", placed.angle, {"rad", -unlimited, unlimited, -6.2832, 6.2832},
              "how far, from x to y where the axis is z", Need::required);
  form.word("axis", axis, {"x", "y", "z"}, "it is turned about a line along this axis (2D: z)");
  form.vector("about", placed.about.data(), place(), "a point of that line");
  if (!form.listing() && script.dimension == 2 && axis != "z")
    form.problem(fmt::format("turns about {}, out of the plane of two dimensions; there the axis is z", axis), "axis");
  placed.by = Vec3::Unit(axis[0] - 'x');
  return give_placed(script, form, placed, shape);
}

int mirrored(Script& script, Form& form) {
  scene::Placed placed;
  placed.how = scene::Placed::How::mirrored, placed.by = {1, 0, 0};
  int shape = -1;
  form.handle("[]", Kind::shape, shape, "the shape");
  form.vector("normal", placed.by.data(), any_number(""), "of the plane that it is mirrored in (2D: of the line)");
  form.vector("point", placed.about.data(), place(), "a point of that plane");
  if (!form.listing() && !(placed.by.norm() > 0)) {
    form.problem("normal has no direction (all zero)", "normal");
    placed.by = {1, 0, 0};
  }
  placed.by.normalize();
  return give_placed(script, form, placed, shape);
}

int scaled(Script& script, Form& form) {
  scene::Placed placed;
  placed.how = scene::Placed::How::scaled, placed.by = {1, 1, 1};
  int shape = -1;
  form.handle("[]", Kind::shape, shape, "the shape");
  form.factors(
      "factor", placed.by,
      "how many times as large; alike in all directions (the thickness as well), or along x, y and z; z is 1 where "
      "it is left out, and 2D takes it for the thickness");
  form.vector("about", placed.about.data(), place(), "a point that stays");
  return give_placed(script, form, placed, shape);
}

/// A rigid box that touches the bounding box of a body or shape on one side of axis 0 (x) or 1 (y).
template <int axis, int side>
int beside(Script& script, Form& form) {
  double thickness = 0, cover = 1.2;
  form.declare("[]", "body or shape", {}, "required", "what it touches");
  bool const given = form.number("thickness", thickness, length(), "of the box (default: a tenth of the body)");
  form.number("cover", cover, positive("", 0.01, 100), "its width as a share of the body's");
  if (form.listing()) return 0;
  int body = -1, shape = -1;
  Handle const* const handle =
      script.handle_at(lua_istable(script.state(), 1) ? (lua_rawgeti(script.state(), 1, 1), -1) : 1);
  bool const is_shape = handle && handle->kind == Kind::shape;
  if (is_shape ? !form.handle("[]", Kind::shape, shape, "") : !form.handle("[]", Kind::body, body, "")) {
    form.done();
    return give_shape(script, form, {scene::Box{{0, 0, 0}, {1, 1, 1}}, {}});
  }
  scene::Shape const& target = is_shape ? script.shapes[static_cast<std::size_t>(shape)].shape
                                        : script.scene.bodies[static_cast<std::size_t>(body)].shape;
  auto const [low, high] = extent_of(target);
  Vec3 const size = high - low;
  if (!given) thickness = size.head<2>().maxCoeff() / 10;
  scene::Box box;
  box.center = (low + high) / 2;
  box.size = cover * size;
  box.size[axis] = thickness;
  box.center[axis] = side > 0 ? high[axis] + thickness / 2 : low[axis] - thickness / 2;
  return give_shape(script, form, {box, {}});
}

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

/// Largest x.direction of all points x of a shape [m], its support function: of a placed one that of its part along the
/// direction turned back.
double reach(scene::Shape const& shape, Vec3 const& direction) {
  double const dx = direction[0], dy = direction[1], dz = direction[2];
  auto const most = [&](std::vector<Point> const& points, auto const& along) {
    double reach = -unlimited;
    for (auto const& point : points) reach = std::max(reach, along(point));
    return reach;
  };
  auto const cylinder = [&](Vec3 const& c, double radius, double thickness) {
    return c.dot(direction) + radius * std::hypot(dx, dy) + thickness / 2 * std::abs(dz);
  };
  return std::visit(
      Overloaded{
          [&](scene::Box const& b) { return b.center.dot(direction) + b.size.dot(direction.cwiseAbs()) / 2; },
          [&](scene::Disc const& d) { return cylinder(d.center, d.radius, d.thickness); },
          [&](scene::Rod const& r) {
            double const end = r.end_radius > 0 ? r.end_radius : r.radius, out = std::hypot(dx, dz);
            return r.center.dot(direction) + std::max(r.radius * out, end * out + r.length * dy);
          },
          [&](scene::Ball const& b) { return b.center.dot(direction) + b.radius * direction.norm(); },
          [&](scene::Ring const& r) { return cylinder(r.center, r.outer, r.thickness); },
          [&](scene::Polygon const& p) {
            if (p.points.empty()) throw std::runtime_error("a polygon without points has no extent");
            return most(p.points, [&](Point const& x) { return x[0] * dx + x[1] * dy; }) +
                   p.thickness / 2 * std::abs(dz);
          },
          [&](scene::Revolved const& r) {
            if (r.points.empty()) throw std::runtime_error("a section without points has no extent");
            return most(r.points, [&](Point const& x) { return x[0] * std::hypot(dx, dz) + x[1] * dy; });
          },
          [&](scene::Notch const&) -> double {
            throw std::runtime_error("a notch is nothing that can be touched; take it away from a shape");
          },
          [&](scene::MeshFile const&) -> double {
            throw std::runtime_error(
                "the extent of a mesh file is not known while the scene is read; give the plate a box{ size, center }");
          },
          [&](scene::Union const& u) {
            if (u.parts.empty()) throw std::runtime_error("a union without parts has no extent");
            double furthest = -unlimited;
            for (auto const& part : u.parts) furthest = std::max(furthest, reach(part, direction));
            return furthest;
          },
          [&](scene::Difference const& d) {
            if (d.parts.empty()) throw std::runtime_error("a difference without parts has no extent");
            return reach(d.parts[0], direction);
          },
          [&](scene::Placed const& p) {
            return reach(p.part.at(0), p.map().transpose() * direction) + p(Vec3(0, 0, 0)).dot(direction);
          }},
      shape.is);
}

}  // namespace

std::pair<Vec3, Vec3> extent_of(scene::Shape const& shape) {
  Vec3 low, high;
  for (int axis = 0; axis < 3; ++axis)
    low[axis] = -reach(shape, -Vec3::Unit(axis)), high[axis] = reach(shape, Vec3::Unit(axis));
  return {low, high};
}

std::optional<Vec3> point_inside(scene::Shape const& shape) {
  using Point = std::optional<Vec3>;
  return std::visit(
      Overloaded{[](scene::Box const& b) -> Point { return b.center + 0.13 * b.size; },
                 [](scene::Disc const& d) -> Point { return d.center + d.radius * Vec3(0.35, 0.21, 0); },
                 [](scene::Rod const& r) -> Point {
                   return r.center + Vec3(0.35 * (r.end_radius > 0 ? std::min(r.radius, r.end_radius) : r.radius),
                                          0.4 * r.length, 0);
                 },
                 [](scene::Ball const& b) -> Point { return b.center + b.radius * Vec3(0.35, 0.21, 0.11); },
                 [](scene::Ring const& r) -> Point { return r.center + (r.inner + r.outer) / 2 * Vec3(0.8, 0.6, 0); },
                 [](scene::Placed const& p) -> Point {
                   auto const inside = point_inside(p.part.at(0));
                   return inside ? Point(p(*inside)) : std::nullopt;
                 },
                 [](auto const&) -> Point { return std::nullopt; }},
      shape.is);
}

double thickness_of(scene::Shape const& shape) {
  return std::visit(
      Overloaded{[](scene::Box const& b) { return b.size[2]; }, [](scene::Disc const& d) { return d.thickness; },
                 [](scene::Ring const& r) { return r.thickness; }, [](scene::Polygon const& p) { return p.thickness; },
                 [](scene::Union const& u) { return u.parts.empty() ? 0 : thickness_of(u.parts[0]); },
                 [](scene::Difference const& d) { return d.parts.empty() ? 0 : thickness_of(d.parts[0]); },
                 [](scene::Placed const& p) {  // of what stays flat
                   Vec3 const deep = p.map().col(2);
                   return deep.head<2>().norm() < 1e-9 * deep.norm() ? deep.norm() * thickness_of(p.part.at(0)) : 0;
                 },
                 [](auto const&) { return 0.0; }},
      shape.is);
}

std::vector<std::pair<std::string, double>> properties_of(scene::Shape const& shape) {
  std::vector<std::pair<std::string, double>> all;
  if (auto const* d = std::get_if<scene::Disc>(&shape.is)) all = {{"radius", d->radius}, {"diameter", 2 * d->radius}};
  if (auto const* r = std::get_if<scene::Rod>(&shape.is))
    all = {{"radius", r->radius}, {"diameter", 2 * r->radius}, {"length", r->length}};
  if (auto const* b = std::get_if<scene::Ball>(&shape.is)) all = {{"radius", b->radius}, {"diameter", 2 * b->radius}};
  if (auto const* r = std::get_if<scene::Ring>(&shape.is)) all = {{"inner", r->inner}, {"outer", r->outer}};
  if (auto const* n = std::get_if<scene::Notch>(&shape.is))
    return {{"width", n->width}, {"length", std::hypot(n->to[0] - n->from[0], n->to[1] - n->from[1])}};
  if (shape.mesh_file()) return all;
  if (double const t = thickness_of(shape); t > 0) all.emplace_back("thickness", t);
  auto const [low, high] = extent_of(shape);
  all.insert(all.end(), {{"left", low[0]},
                         {"right", high[0]},
                         {"bottom", low[1]},
                         {"top", high[1]},
                         {"width", high[0] - low[0]},
                         {"height", high[1] - low[1]}});
  return all;
}

std::vector<Verb> shape_verbs() {
  return {
      {"box", "A box; in 2D a rectangle.", "box{ size = { 40*mm, 20*mm, 10*mm } }", "fissure.shape", box},
      {"disc", "A disc; in 3D a short cylinder along z.", "disc{ radius = 25*mm, thickness = 25*mm }", "fissure.shape",
       disc},
      {"rod", "A cylinder along y; in 2D its lengthwise section (half of it when axisymmetric).",
       "rod{ radius = 3.2*mm, length = 32.4*mm }", "fissure.shape", rod},
      {"ball", "A ball; in 2D its middle section (half of it when axisymmetric).", "ball{ radius = 5*mm }",
       "fissure.shape", ball},
      {"ring", "A ring; in 3D a hollow cylinder along z.", "ring{ inner = 49*mm, outer = 50*mm, thickness = 1*mm }",
       "fissure.shape", ring},
      {"polygon", "The inside of an outline; in 3D extruded along z.",
       "polygon{ points = { {0, 0}, {2, 0}, {1, 1} }, thickness = 0.1 }", "fissure.shape", polygon},
      {"revolved",
       "A section at x >= 0 turned once about the y axis; in 2D the section and its mirror image (the section alone "
       "when "
       "axisymmetric).",
       "revolved{ points = { {0, 0}, {4*mm, 0}, {1*mm, 9*mm}, {0, 9*mm} } }", "fissure.shape", revolved},
      {"notch", "A slot through the whole thickness, to be taken away from a shape.",
       "difference{ plate_shape, notch{ from = {0, 0}, to = {50*mm, 0}, width = 0.3*mm } }", "fissure.shape", notch},
      {"mesh_file", "A mesh from Gmsh as a body's shape.", "mesh_file{ \"part.msh\" }", "fissure.shape", mesh_file},
      {"union", "Shapes that become one; they may overlap, touch or lie apart.", "union{ box{...}, disc{...} }",
       "fissure.shape", make_union},
      {"difference", "The first shape without all others.", "difference{ box{...}, disc{...} }", "fissure.shape",
       make_difference},
      {"moved", "A shape at another place.", "moved{ ball{ radius = 5*mm }, by = { 0, 12*mm } }", "fissure.shape",
       moved},
      {"turned", "A shape turned about a line.", "turned{ box{ size = { 40*mm, 20*mm, 10*mm } }, angle = 30*deg }",
       "fissure.shape", turned},
      {"mirrored", "A shape mirrored in a plane; union{ half, mirrored{ half } } is both halves.",
       "mirrored{ polygon{...}, normal = { 1, 0 } }", "fissure.shape", mirrored},
      {"scaled", "A shape larger or smaller: an ellipse, or a mesh file in millimetres.",
       "scaled{ disc{ radius = 1*mm, thickness = 1*mm }, factor = { 10, 5 } }", "fissure.shape", scaled},
      {"above", "A rigid box on top of a body, touching it: for plate{}.", "plate{ above(disc), velocity = { 0, -1 } }",
       "fissure.shape", beside<1, 1>},
      {"below", "A rigid box under a body, touching it.", "plate{ below(disc) }", "fissure.shape", beside<1, -1>},
      {"left_of", "A rigid box to the left of a body, touching it.", "plate{ left_of(disc) }", "fissure.shape",
       beside<0, -1>},
      {"right_of", "A rigid box to the right of a body, touching it.", "plate{ right_of(disc) }", "fissure.shape",
       beside<0, 1>},
  };
}

}  // namespace fissure::lua
