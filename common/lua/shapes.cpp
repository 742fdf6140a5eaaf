// Shapes: box, disc, rod, ball, ring, polygon, notch, mesh_file, union, difference; and rigid boxes beside a body.
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

int polygon(Script& script, Form& form) {
  scene::Polygon shape;
  bool const given = form.points("points", shape.points, "corners, in order around");
  thickness(script, form, shape.thickness);
  if (given) {
    auto& p = shape.points;
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

}  // namespace

std::pair<Vec3, Vec3> extent_of(scene::Shape const& shape) {
  using Extent = std::pair<Vec3, Vec3>;
  auto around = [](Vec3 const& center, double x, double y, double z) {
    return Extent{center - Vec3(x, y, z), center + Vec3(x, y, z)};
  };
  return std::visit(
      Overloaded{
          [&](scene::Box const& b) { return around(b.center, b.size[0] / 2, b.size[1] / 2, b.size[2] / 2); },
          [&](scene::Disc const& d) { return around(d.center, d.radius, d.radius, d.thickness / 2); },
          [&](scene::Rod const& r) {
            double const wide = std::max(r.radius, r.end_radius);
            return Extent{r.center - Vec3(wide, 0, wide), r.center + Vec3(wide, r.length, wide)};
          },
          [&](scene::Ball const& b) { return around(b.center, b.radius, b.radius, b.radius); },
          [&](scene::Ring const& r) { return around(r.center, r.outer, r.outer, r.thickness / 2); },
          [&](scene::Polygon const& p) {
            Extent e{{unlimited, unlimited, -p.thickness / 2}, {-unlimited, -unlimited, p.thickness / 2}};
            for (auto const& point : p.points)
              for (int c = 0; c < 2; ++c) {
                double const x = point[static_cast<std::size_t>(c)];
                e.first[c] = std::min(e.first[c], x), e.second[c] = std::max(e.second[c], x);
              }
            if (p.points.empty()) throw std::runtime_error("a polygon without points has no extent");
            return e;
          },
          [&](scene::Notch const&) -> Extent {
            throw std::runtime_error("a notch is nothing that can be touched; take it away from a shape");
          },
          [&](scene::MeshFile const&) -> Extent {
            throw std::runtime_error(
                "the extent of a mesh file is not known while the scene is read; give the plate a box{ size, center }");
          },
          [&](scene::Union const& u) {
            if (u.parts.empty()) throw std::runtime_error("a union without parts has no extent");
            Extent e = extent_of(u.parts[0]);
            for (auto const& part : u.parts) {
              Extent const other = extent_of(part);
              e.first = e.first.cwiseMin(other.first), e.second = e.second.cwiseMax(other.second);
            }
            return e;
          },
          [&](scene::Difference const& d) {
            if (d.parts.empty()) throw std::runtime_error("a difference without parts has no extent");
            return extent_of(d.parts[0]);
          }},
      shape.is);
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
                 [](auto const&) -> Point { return std::nullopt; }},
      shape.is);
}

double thickness_of(scene::Shape const& shape) {
  return std::visit(
      Overloaded{[](scene::Box const& b) { return b.size[2]; }, [](scene::Disc const& d) { return d.thickness; },
                 [](scene::Ring const& r) { return r.thickness; }, [](scene::Polygon const& p) { return p.thickness; },
                 [](scene::Union const& u) { return u.parts.empty() ? 0 : thickness_of(u.parts[0]); },
                 [](scene::Difference const& d) { return d.parts.empty() ? 0 : thickness_of(d.parts[0]); },
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
  if (std::get_if<scene::MeshFile>(&shape.is)) return all;
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
      {"notch", "A slot through the whole thickness, to be taken away from a shape.",
       "difference{ plate_shape, notch{ from = {0, 0}, to = {50*mm, 0}, width = 0.3*mm } }", "fissure.shape", notch},
      {"mesh_file", "A mesh from Gmsh as a body's shape.", "mesh_file{ \"part.msh\" }", "fissure.shape", mesh_file},
      {"union", "Shapes that become one; they may overlap, touch or lie apart.", "union{ box{...}, disc{...} }",
       "fissure.shape", make_union},
      {"difference", "The first shape without all others.", "difference{ box{...}, disc{...} }", "fissure.shape",
       make_difference},
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
