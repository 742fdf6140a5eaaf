// Unstructured meshes from Gmsh (C. Geuzaine, J.-F. Remacle, Int. J. Numer. Meth. Engng 79, 2009, 1309-1331).
// One thread and fixed seeds, so that the same scene gives the same mesh.
#include <fmt/format.h>

#include "mesh/mesher.h"
#include "mesh/part.h"
#include "mesh/scaled.h"

#if defined(FISSURE_GMSH)
#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <random>

#include "mesh/block.h"
#include "mesh/simplex.h"

namespace fissure::mesh {
namespace {

using Entities = gmsh::vectorpair;

constexpr double growth = 0.3;  // of edges per length away from a fine outline
// of a shape: OpenCASCADE takes seconds for them, and its time grows by their square
constexpr std::size_t most_parts = 500;

/// An empty Gmsh model for as long as it lives. Gmsh is one per process.
class GmshModel {
 public:
  GmshModel() : lock_(mutex()) {
    static bool const started = (gmsh::initialize(0, nullptr, false), true);
    static_cast<void>(started);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
    gmsh::model::add("body");
  }
  ~GmshModel() {
    try {
      gmsh::model::mesh::removeSizeCallback();
      gmsh::model::remove();
    } catch (...) {  // nothing left to remove
    }
  }
  GmshModel(GmshModel const&) = delete;
  GmshModel& operator=(GmshModel const&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
};

/// Length, area or volume of an entity.
double measure_of(std::pair<int, int> const& entity) {
  double measure = 0;
  gmsh::model::occ::getMass(entity.first, entity.second, measure);
  return measure;
}

/// Where entities begin and end along z.
std::pair<double, double> depth(Entities const& entities) {
  double back = INFINITY, front = -INFINITY;
  for (auto const& [dimension, tag] : entities) {
    double x0, y0, z0, x1, y1, z1;
    gmsh::model::occ::getBoundingBox(dimension, tag, x0, y0, z0, x1, y1, z1);
    back = std::min(back, z0);
    front = std::max(front, z1);
  }
  return {back, front};
}

/// Area or volume that two entities share. Copies are cut: OpenCASCADE misses what entities that came from one another
/// have in common.
double common_measure(std::pair<int, int> const& one, std::pair<int, int> const& other) {
  double least[2][3], most[2][3];
  for (auto const& [entity, i] : {std::pair(one, 0), std::pair(other, 1)})
    gmsh::model::occ::getBoundingBox(entity.first, entity.second, least[i][0], least[i][1], least[i][2], most[i][0],
                                     most[i][1], most[i][2]);
  for (int axis = 0; axis < 3; ++axis)
    if (least[0][axis] > most[1][axis] || least[1][axis] > most[0][axis]) return 0;
  Entities first, second, pieces;
  std::vector<Entities> origin;
  gmsh::model::occ::copy({one}, first);
  gmsh::model::occ::copy({other}, second);
  gmsh::model::occ::fragment(first, second, pieces, origin);
  double together = 0;
  for (auto const& piece : pieces) together += measure_of(piece);
  gmsh::model::occ::remove(pieces, true);
  return measure_of(one) + measure_of(other) - together;
}

/// The union of entities. Gmsh returns parts that it took over unchanged beside the larger one that has swallowed them
/// (a square beside another, a disc inside a box): those are dropped, so that no place is filled twice.
Entities joined(Entities const& first, Entities const& rest) {
  Entities given = first, found, result;
  given.insert(given.end(), rest.begin(), rest.end());
  std::vector<Entities> origin;
  gmsh::model::occ::fuse(first, rest, found, origin, -1, false, false);
  auto const is_given = [&](auto const& entity) {
    return std::find(given.begin(), given.end(), entity) != given.end();
  };
  for (auto const& entity : found) {
    bool const swallowed = is_given(entity) && std::any_of(found.begin(), found.end(), [&](auto const& larger) {
                             return !is_given(larger) && common_measure(entity, larger) > measure_of(entity) / 2;
                           });
    if (!swallowed) result.push_back(entity);
  }
  std::erase_if(given,
                [&](auto const& entity) { return std::find(result.begin(), result.end(), entity) != result.end(); });
  gmsh::model::occ::remove(given, true);
  return result;
}

/// The shape as entities of the current model. `outer` is the place to name where a shape has none of its own.
class Drawing {
 public:
  explicit Drawing(Mesher const& mesher) : mesher_(mesher), dimension_(node_count(mesher.kind()) - 1) {}

  Entities draw(scene::Shape const& shape, Source const& outer) const {
    Source const& at = shape.source.file.empty() ? outer : shape.source;
    if (++drawn_ > most_parts)
      throw Error(at, fmt::format("the shape has more than {} parts (OpenCASCADE would take too long); draw its "
                                  "outline as a polygon or read it with mesh_file",
                                  most_parts));
    return std::visit([&](auto const& s) { return draw_one(s, at); }, shape.is);
  }

 private:
  template <class Primitive>
  Entities draw_one(Primitive const& primitive, Source const& at) const {
    return {{dimension_, mesher_.drawer()->add(primitive, at)}};
  }
  Entities draw_one(scene::Notch const&, Source const& at) const {
    throw Error(at, "a notch is no body of its own (it is a slot to be taken away); write difference{ shape, notch }");
  }
  Entities draw_one(scene::MeshFile const&, Source const& at) const {
    throw Error(at,
                "a mesh file cannot be part of a union or difference (it is already meshed); use it as a body's shape");
  }
  /// In a plane that no axis is assumed for, the section on both sides of it.
  Entities draw_one(scene::Revolved const& revolved, Source const& at) const {
    Entities const half{{dimension_, mesher_.drawer()->add(revolved, at)}};
    if (dimension_ == 3 || mesher_.revolves()) return half;
    Entities const other{{dimension_, mesher_.drawer()->add(revolved, at)}};
    gmsh::model::occ::mirror(other, 1, 0, 0, 0);
    return joined(half, other);
  }
  Entities draw_one(scene::Placed const& placed, Source const& at) const {
    using How = scene::Placed::How;
    if (mesher_.revolves() && !stays_on_axis(placed))
      throw Error(at,
                  "with two_d = \"axisymmetric\" everything turns about y: a shape may be moved along it, mirrored "
                  "across it and scaled from a point of it; give it its place by its own keys");
    Entities const shape = draw(placed.part.at(0), at);
    Vec3 const &by = placed.by, &about = placed.about;
    namespace occ = gmsh::model::occ;
    switch (placed.how) {
      case How::moved:
        occ::translate(shape, by[0], by[1], by[2]);
        break;
      case How::turned:
        occ::rotate(shape, about[0], about[1], about[2], by[0], by[1], by[2], placed.angle);
        break;
      case How::mirrored:
        occ::mirror(shape, by[0], by[1], by[2], -by.dot(about));
        break;
      case How::scaled:
        occ::dilate(shape, about[0], about[1], about[2], by[0], by[1], by[2]);
        break;
    }
    return shape;
  }
  /// Points of the y axis come to lie on it, and those at x > 0 stay there.
  static bool stays_on_axis(scene::Placed const& placed) {
    Vec3 const origin = placed(Vec3(0, 0, 0));
    return origin[0] == 0 && placed(Vec3(0, 1, 0))[0] == 0 && placed(Vec3(1, 0, 0))[0] > 0;
  }
  Entities draw_one(scene::Union const& together, Source const& at) const {
    if (together.parts.empty()) throw Error(at, "union: has no parts");
    Entities first = draw(together.parts[0], at), rest;
    for (std::size_t i = 1; i < together.parts.size(); ++i) {
      Entities const part = draw(together.parts[i], at);
      rest.insert(rest.end(), part.begin(), part.end());
    }
    return rest.empty() ? first : joined(first, rest);
  }
  Entities draw_one(scene::Difference const& difference, Source const& at) const {
    if (difference.parts.empty()) throw Error(at, "difference: has no parts");
    Entities const first = draw(difference.parts[0], at);
    if (difference.parts.size() == 1) return first;
    auto const [back, front] = depth(first);
    Entities tools;
    for (std::size_t i = 1; i < difference.parts.size(); ++i) {
      scene::Shape const& part = difference.parts[i];
      auto const* notch = std::get_if<scene::Notch>(&part.is);
      Source const& place = part.source.file.empty() ? at : part.source;
      Entities const tool =
          notch ? Entities{{dimension_, mesher_.drawer()->add(*notch, back, front, place)}} : draw(part, at);
      tools.insert(tools.end(), tool.begin(), tool.end());
    }
    Entities result;
    std::vector<Entities> origin;
    gmsh::model::occ::cut(first, tools, result, origin);
    if (result.empty()) throw Error(at, "difference: nothing is left of the first shape (the others cover it)");
    return result;
  }

  Mesher const& mesher_;
  int dimension_;
  mutable std::size_t drawn_ = 0;
};

/// Whether a piece of the seam ends inside of an entity, and does not part it.
bool ends_inside(std::pair<int, int> const& piece) {
  Entities whole;
  gmsh::model::getEntities(whole, piece.first + 1);
  return std::any_of(whole.begin(), whole.end(), [&](auto const& entity) {
    Entities embedded;
    gmsh::model::mesh::getEmbedded(entity.first, entity.second, embedded);
    return std::find(embedded.begin(), embedded.end(), piece) != embedded.end();
  });
}

/// Whether a piece of the seam has the body on both its sides: it parts two entities, or ends inside of one.
bool lies_inside(std::pair<int, int> const& piece) {
  std::vector<int> around, below;
  gmsh::model::getAdjacencies(piece.first, piece.second, around, below);
  return around.size() != 1 || ends_inside(piece);
}

/// Bodies that are meshed together, and the entities that each is made of.
struct Drawn {
  std::vector<scene::Body> const& bodies;
  std::vector<Entities> pieces;
};

/// Parts bodies that touch, and each along what of its seams lies inside it; pieces share their nodes where they meet.
void fit_together(Drawn& drawn, Mesher const& mesher) {
  auto const& bodies = drawn.bodies;
  if (bodies.size() == 1 && bodies[0].mesh.seams.empty()) return gmsh::model::occ::synchronize();
  struct Tool {
    std::size_t body, seam;
  };
  Entities shapes, cuts, result;
  std::vector<std::size_t> body_of_shape;
  std::vector<Tool> tools;
  auto const refuse = [&](Tool const& tool, char const* why) {
    auto const& body = bodies[tool.body];
    throw Error(body.source,
                fmt::format("seam{}: {}", body.mesh.seams.size() > 1 ? fmt::format(" {}", tool.seam + 1) : "", why));
  };
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    shapes.insert(shapes.end(), drawn.pieces[b].begin(), drawn.pieces[b].end());
    body_of_shape.resize(shapes.size(), b);
    auto const [back, front] = depth(drawn.pieces[b]);
    for (std::size_t i = 0; i < bodies[b].mesh.seams.size(); ++i) {
      Entities inside;
      std::vector<Entities> origin;
      int const seam = mesher.drawer()->add(bodies[b].mesh.seams[i], back, front, bodies[b].source);
      gmsh::model::occ::intersect({{shapes[0].first - 1, seam}}, drawn.pieces[b], inside, origin, -1, true, false);
      if (inside.empty()) refuse({b, i}, "no part of it lies inside the body");
      cuts.insert(cuts.end(), inside.begin(), inside.end());
      tools.resize(cuts.size(), {b, i});
    }
  }
  std::vector<Entities> origin;
  gmsh::model::occ::fragment(shapes, cuts, result, origin);
  gmsh::model::occ::synchronize();
  std::map<std::pair<int, int>, std::size_t> body_of_piece;
  for (auto& pieces : drawn.pieces) pieces.clear();
  for (std::size_t s = 0; s < shapes.size(); ++s)
    for (auto const& piece : origin[s]) {
      auto const [known, fresh] = body_of_piece.emplace(piece, body_of_shape[s]);
      if (fresh)
        drawn.pieces[body_of_shape[s]].push_back(piece);
      else if (known->second != body_of_shape[s])
        throw Error(bodies[body_of_shape[s]].source,
                    fmt::format("body \"{}\" and body \"{}\" are bonded and overlap; take one from the other: "
                                "difference{{ shape, other }}",
                                bodies[known->second].name, bodies[body_of_shape[s]].name));
    }
  std::map<std::pair<std::size_t, std::size_t>, bool> any_inside;
  for (std::size_t t = 0; t < tools.size(); ++t) {
    Entities const& parts = origin[shapes.size() + t];
    if (bodies[tools[t].body].mesh.blocks() && std::any_of(parts.begin(), parts.end(), ends_inside))
      refuse(tools[t],
             "it ends inside the body, and a mesh of blocks has no faces along such a line; lead it from side to side, "
             "or take cells = \"simplex\"");
    any_inside[{tools[t].body, tools[t].seam}] |= std::any_of(parts.begin(), parts.end(), lies_inside);
  }
  for (auto const& [seam, inside] : any_inside)
    if (!inside)
      refuse({seam.first, seam.second},
             "it lies on the body's boundary (where the mesh has faces anyway); leave it out or move it inside");
}

/// Distance from a place to a line in the plane [m].
double distance(scene::Near const& near, double x, double y) {
  double const along[] = {near.to[0] - near.from[0], near.to[1] - near.from[1]},
               away[] = {x - near.from[0], y - near.from[1]};
  double const squared = along[0] * along[0] + along[1] * along[1];
  double const t = squared > 0 ? std::clamp((away[0] * along[0] + away[1] * along[1]) / squared, 0.0, 1.0) : 0;
  return std::hypot(away[0] - t * along[0], away[1] - t * along[1]);
}

/// Edge length at a place: `size`, less near to the places that ask for less.
double edge_at(std::vector<scene::Near> const& places, double size, double x, double y) {
  for (auto const& near : places)
    size = std::min(size, near.size + growth * std::max(0.0, distance(near, x, y) - near.radius));
  return size;
}

/// Refuses more cells near a place than are possible. `deep`: out of the plane [m], 0 in 2D.
void refuse_many_near(scene::Near const& near, double measure, double deep, scene::Body const& body,
                      Mesher const& mesher) {
  // beyond the radius as many as would fill this much more
  double const pi = std::acos(-1.0), r = near.radius + near.size / growth;
  scene::Body fine = body;
  fine.mesh.size = near.size;
  double const area = 2 * r * std::hypot(near.to[0] - near.from[0], near.to[1] - near.from[1]) + pi * r * r;
  refuse_too_many(
      std::min(area * (deep > 0 ? deep : 1), measure) / std::pow(near.size, deep > 0 ? 3 : 2) * mesher.cells_per_size(),
      fine, deep > 0 ? 3 : 2);
}

/// 1, a little more or less from place to place and from seed to seed.
std::function<double(double, double, double)> unevenness(double size, unsigned seed) {
  std::mt19937 random(seed);
  auto const number = [&] { return static_cast<double>(random()) / 4294967296.0; };  // the same with every library
  struct Wave {
    double x, y, z, phase;
  };
  std::array<Wave, 6> waves;
  for (Wave& w : waves) w = {number() - 0.5, number() - 0.5, number() - 0.5, 6.283185307179586 * number()};
  return [=](double x, double y, double z) {
    double sum = 0;
    for (Wave const& w : waves) sum += std::sin((w.x * x + w.y * y + w.z * z) * 4 / size + w.phase);
    return 1 + 0.015 * sum;
  };
}

/// Tells Gmsh how long edges are where that depends on the place or the body: where bodies meet, the shorter.
void set_edge_lengths(Drawn const& drawn, double over) {
  auto const& first = drawn.bodies[0].mesh;
  auto const plain = [&](scene::Body const& body) {
    return !body.mesh.seed && body.mesh.near.empty() && body.mesh.size == first.size;
  };
  if (std::all_of(drawn.bodies.begin(), drawn.bodies.end(), plain)) return;
  std::vector<std::function<double(double, double, double)>> edges;
  for (auto const& body : drawn.bodies)
    edges.push_back([spec = body.mesh, over, uneven = unevenness(over * body.mesh.size, body.mesh.seed)](
                        double x, double y, double z) {
      return over * edge_at(spec.near, spec.size, x, y) * (spec.seed ? uneven(x, y, z) : 1.0);
    });
  std::map<std::pair<int, int>, std::vector<std::size_t>> bodies_at;  // of entities of all dimensions
  for (std::size_t b = 0; b < drawn.bodies.size() && drawn.bodies.size() > 1; ++b)
    for (Entities level = drawn.pieces[b]; !level.empty();) {
      std::sort(level.begin(), level.end());
      level.erase(std::unique(level.begin(), level.end()), level.end());
      for (auto const& entity : level) bodies_at[entity].push_back(b);
      if (level[0].first == 0) break;
      Entities below;
      gmsh::model::getBoundary(level, below, false, false);
      level = below;
    }
  gmsh::model::mesh::setSizeCallback([=](int dimension, int tag, double x, double y, double z) {
    auto const at = bodies_at.find({dimension, tag});
    if (at == bodies_at.end()) return edges[0](x, y, z);
    double least = INFINITY;
    for (std::size_t const b : at->second) least = std::min(least, edges[b](x, y, z));
    return least;
  });
}

/// Where most of the outline is cut finer than `size` (a polygon of many points), edges grow from there to `size`
/// inside. Returns the number of its short lines; 0: nothing was done.
int grow_inwards(double size) {
  Entities curves;
  gmsh::model::getEntities(curves, 1);
  std::map<int, std::vector<double>> by_octave;  // of size over length
  double fine = 0, whole = 0;
  int count = 0;
  for (auto const& curve : curves) {
    double const length = measure_of(curve);
    auto const [back, front] = depth({curve});
    // between both ends of a prism: as many as the outline has points, however deep it is
    if (front - back > 0.99 * length) continue;
    whole += length;
    if (length > size / 2) continue;
    by_octave[static_cast<int>(std::log2(size / length))].push_back(curve.second);
    fine += length, ++count;
  }
  if (fine < whole / 2 || count < 16) return 0;  // a body smaller than its mesh size is no fine outline
  namespace field = gmsh::model::mesh::field;
  std::vector<double> all;
  for (auto const& [octave, tags] : by_octave) {
    int const distance = field::add("Distance"), edge = field::add("MathEval");
    field::setNumbers(distance, "CurvesList", tags);
    field::setNumber(distance, "NumPointsPerCurve", 3);
    field::setString(edge, "F", fmt::format("{:.17g} + {} * F{}", std::ldexp(size, -octave), growth, distance));
    all.push_back(edge);
  }
  int const least = field::add("Min");
  field::setNumbers(least, "FieldsList", all);
  field::setAsBackgroundMesh(least);
  gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 0);
  gmsh::option::setNumber("Mesh.MeshSizeMin", 0);
  return count;
}

/// Refuses the solid with too many lines shorter than half its edges: Gmsh's time grows with the square of their number
/// (half a minute for a prism of 1000 points, which has 2000).
void refuse_too_many_lines(Entities const& pieces, double over, scene::Body const& body, bool together) {
  Entities faces, curves;
  gmsh::model::getBoundary(pieces, faces, false, false);
  gmsh::model::getBoundary(faces, curves, false, false);
  std::sort(curves.begin(), curves.end());
  curves.erase(std::unique(curves.begin(), curves.end()), curves.end());
  auto const lines = std::count_if(curves.begin(), curves.end(),
                                   [&](auto const& curve) { return measure_of(curve) <= over * body.mesh.size / 2; });
  int const most = 4000;
  if (lines <= most) return;
  throw Error(
      body.source,
      fmt::format("body \"{}\": {} of its lines are less than half as long as its cells (mesh.size is {:g} m); a "
                  "solid with more than {} takes too long to mesh. Leave points out, or draw what is round as disc "
                  "or ring{}",
                  body.name, lines, body.mesh.size, most, together ? "" : ", or use mesh.cells = \"block\""));
}

/// Gmsh's element type of a kind of cell.
int cell_type(CellKind kind, bool blocks) {
  bool const flat = kind == CellKind::triangle;
  return gmsh::model::mesh::getElementType(
      blocks ? (flat ? "Quadrangle" : "Hexahedron") : (flat ? "Triangle" : "Tetrahedron"), 1);
}

/// Where a solid that is the same all along z begins and ends, and its faces at the beginning.
struct Prism {
  double back, front;
  Entities base;
};

/// The prism that solids are together: the only planes across z are its ends, alike and one behind the other, and the
/// area of each times the depth is the volume. None: no prism.
std::optional<Prism> prism(Entities const& solids) {
  auto const [low, high] = depth(solids);
  double const flat = 1e-3 * (high - low) + 3e-7;  // OpenCASCADE's boxes are larger than what they hold, by 1e-7
  Entities faces;
  gmsh::model::getBoundary(solids, faces, true, false);
  Prism found{INFINITY, -INFINITY, {}};
  double volume = 0, areas[2] = {0, 0};
  Vec3 centres[2] = {Vec3::Zero(), Vec3::Zero()};  // times area
  for (auto const& solid : solids) volume += measure_of(solid);
  for (auto const& face : faces) {
    auto const [back, front] = depth({face});
    if (front - back > flat) continue;
    bool const at_back = back - low < flat, at_front = high - front < flat;
    if (at_back == at_front) return std::nullopt;  // a step between both ends
    double x, y, z;
    gmsh::model::occ::getCenterOfMass(face.first, face.second, x, y, z);
    if (at_back)
      found.back = std::min(found.back, z), found.base.push_back(face);
    else
      found.front = std::max(found.front, z);
    areas[at_front] += measure_of(face), centres[at_front] += measure_of(face) * Vec3(x, y, 0);
  }
  for (double area : areas)
    if (!(std::abs(area * (found.front - found.back) - volume) < 1e-6 * volume)) return std::nullopt;
  bool const straight = (centres[0] - centres[1]).norm() < 1e-6 * std::pow(areas[0], 1.5);
  return straight ? std::optional(found) : std::nullopt;
}

/// Mesh the current model's pieces of a dimension; says whether every one of them has cells. Gmsh is told to go on
/// after an error: an exception from inside would leave it locked for the rest of the process.
bool meshed(CellKind kind, bool blocks) {
  int const dimension = node_count(kind) - 1;
  gmsh::option::setNumber("General.AbortOnError", 0);
  gmsh::model::mesh::generate(dimension);
  gmsh::option::setNumber("General.AbortOnError", 2);
  Entities pieces;
  gmsh::model::getEntities(pieces, dimension);
  return std::all_of(pieces.begin(), pieces.end(), [&](auto const& piece) {
    std::vector<std::size_t> tags, corners;
    gmsh::model::mesh::getElementsByType(cell_type(kind, blocks), tags, corners, piece.second);
    return !tags.empty();
  });
}

/// Cells and nodes of the current model's mesh: of some pieces, or (none given) all of it.
Part collect(CellKind kind, bool blocks, Entities const& pieces = {}) {
  Part part;
  int const dimension = node_count(kind) - 1;
  // Gmsh takes a list that is not empty for room that it has been given: one of its own for every question.
  auto const corners_of = [&](bool of_blocks, int piece) {
    std::vector<std::size_t> cells, corners;
    gmsh::model::mesh::getElementsByType(cell_type(kind, of_blocks), cells, corners, piece);
    return corners;
  };
  std::vector<std::size_t> tags, simplices, corners;
  if (pieces.empty()) simplices = corners_of(false, -1);
  for (auto const& piece : pieces) {
    auto const more = corners_of(false, piece.second);
    if (more.empty()) throw std::string("a piece of a body has no cells");
    simplices.insert(simplices.end(), more.begin(), more.end());
  }
  if (blocks) corners = corners_of(true, -1);
  std::vector<double> coordinates, parameters;
  gmsh::model::mesh::getNodes(tags, coordinates, parameters, -1, -1, false, false);
  std::size_t const most = tags.empty() ? 0 : *std::max_element(tags.begin(), tags.end());
  std::vector<char> used(most + 1, pieces.empty());
  for (std::size_t tag : simplices) used.at(tag) = true;
  std::vector<int> number(most + 1, -1);
  for (std::size_t n = 0; n < tags.size(); ++n) {
    if (!used[tags[n]]) continue;
    number[tags[n]] = static_cast<int>(part.nodes.size());
    Vec3 p(coordinates[3 * n], coordinates[3 * n + 1], coordinates[3 * n + 2]);
    for (int axis = dimension; axis < 3; ++axis) p[axis] = 0;
    part.nodes.push_back(p);
  }
  part.cells.reserve(simplices.size());
  for (std::size_t tag : simplices) part.cells.push_back(number.at(tag));
  for (std::size_t tag : corners) part.blocks.push_back(number.at(tag));
  return part;
}

/// Hexahedra over the quadrilaterals of a prism's base, in layers of about the size.
Part extruded(Part const& base, Prism const& prism, double size) {
  double const deep = prism.front - prism.back, middle = (prism.front + prism.back) / 2;
  int const layers = std::max(1, static_cast<int>(std::lround(deep / size))), n = static_cast<int>(base.nodes.size());
  Part part;
  for (int k = 0; k <= layers; ++k)
    for (Vec3 const& p : base.nodes)
      part.nodes.push_back({p.x(), p.y(), middle + deep * ((2.0 * k - layers) / (2.0 * layers))});
  for (std::size_t b = 0; b < base.blocks.size(); b += 4)
    for (int k = 0; k < layers; ++k)
      for (int above : {k, k + 1})
        for (int a = 0; a < 4; ++a) part.blocks.push_back(base.blocks[b + a] + above * n);
  return part;
}

/// Smallest shape of a part's cells.
double worst_shape(Part const& part, CellKind kind) {
  std::size_t const corners = node_count(kind), block = block_corners(kind);
  double worst = 1;
  for (std::size_t b = 0; b < part.blocks.size(); b += block) {
    Block const one(std::span(part.blocks).subspan(b, block), part.nodes);
    // mirrored ones will be turned
    worst = std::min(worst, one.measure() < 0 ? std::abs(one.shape()) : std::max(one.shape(), 0.0));
  }
  for (std::size_t c = 0; c < part.cells.size(); c += corners)
    worst = std::min(worst, Simplex(std::span(part.cells).subspan(c, corners), part.nodes).shape());
  return worst;
}

/// Gmsh at work on bodies, in the model that is current.
class Generation {
 public:
  Generation(std::vector<scene::Body> const& bodies, Mesher const& mesher)
      : bodies_(bodies),
        mesher_(mesher),
        dimension_(node_count(mesher.kind()) - 1),
        together_(bodies.size() > 1),
        blocks_(bodies[0].mesh.blocks()),
        finest_(*std::min_element(bodies.begin(), bodies.end(),
                                  [](auto const& a, auto const& b) { return a.mesh.size < b.mesh.size; })),
        kind_(mesher.kind()),
        drawn_{bodies, {}} {
    for (auto const& body : bodies) drawn_.pieces.push_back(Drawing(mesher).draw(body.shape, body.source));
    fit_together(drawn_, mesher);
  }

  /// One part for every body.
  std::vector<Part> parts() {
    refuse_too_many_foreseen();
    if (blocks_ && dimension_ == 3) keep_base_alone();
    bool const fine_outline = set_sizes();
    auto parts = best_mesh(fine_outline);
    refuse_places_without_body(parts);
    if (solid_) parts[0] = extruded(parts[0], *solid_, bodies_[0].mesh.size);
    return parts;
  }

 private:
  void refuse_too_many_foreseen() const;
  void keep_base_alone();
  bool set_sizes() const;
  std::vector<Part> best_mesh(bool fine_outline) const;
  void refuse_places_without_body(std::vector<Part> const& parts) const;

  std::vector<scene::Body> const& bodies_;
  Mesher const& mesher_;
  int dimension_;
  bool together_, blocks_;  // blocks are meshed alone
  scene::Body const& finest_;
  CellKind kind_;               // that is meshed
  std::optional<Prism> solid_;  // whose base alone is meshed
  Drawn drawn_;
};

/// Thin bodies have more edges along their curves than cells by volume.
void Generation::refuse_too_many_foreseen() const {
  for (int d = 1; d <= dimension_; ++d) {
    double measure = 0;
    Entities entities;
    gmsh::model::getEntities(entities, d);
    for (auto const& entity : entities) measure += measure_of(entity);
    if (d < dimension_ || !together_)
      refuse_too_many(measure / std::pow(finest_.mesh.size, d) * (d == dimension_ ? mesher_.cells_per_size() : 1),
                      finest_, d);
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    double own = 0;
    for (auto const& piece : drawn_.pieces[b]) own += measure_of(piece);
    if (together_)
      refuse_too_many(own / std::pow(bodies_[b].mesh.size, dimension_) * mesher_.cells_per_size(), bodies_[b],
                      dimension_);
    auto const [back, front] = depth(drawn_.pieces[b]);
    for (auto const& near : bodies_[b].mesh.near)
      refuse_many_near(near, own, dimension_ == 3 ? front - back : 0, bodies_[b], mesher_);
  }
}

/// Of a prism, the rest is taken away.
void Generation::keep_base_alone() {
  Entities solids, faces;
  gmsh::model::getEntities(solids, 3);
  gmsh::model::getEntities(faces, 2);
  solid_ = prism(solids);
  if (!solid_) return;
  kind_ = CellKind::triangle;
  std::erase_if(faces, [&](auto const& face) {
    return std::find(solid_->base.begin(), solid_->base.end(), face) != solid_->base.end();
  });
  gmsh::model::removeEntities(solids);
  gmsh::model::removeEntities(faces);
}

/// True where edges grow inwards from an outline that is finer than they.
bool Generation::set_sizes() const {
  bool const recombine = blocks_ && kind_ == CellKind::triangle, cut = blocks_ && !recombine;
  gmsh::option::setNumber("Mesh.RecombineAll", recombine);
  gmsh::option::setNumber("Mesh.RecombinationAlgorithm", 3);  // blossom, quadrilaterals only
  gmsh::option::setNumber("Mesh.SubdivisionAlgorithm", cut ? 2 : 0);
  double const over = cut ? 2 : 1;  // cutting halves edges
  double least = INFINITY, most = 0;
  for (auto const& body : bodies_) {
    double const spread = body.mesh.seed ? 0.09 : 0;
    double edge = body.mesh.size;
    for (auto const& near : body.mesh.near) edge = std::min(edge, near.size);
    least = std::min(least, over * edge * (1 - spread)), most = std::max(most, over * body.mesh.size * (1 + spread));
  }
  gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
  gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", 0);
  gmsh::option::setNumber("Mesh.MeshSizeMin", least);
  gmsh::option::setNumber("Mesh.MeshSizeMax", most);
  gmsh::option::setNumber("Mesh.RandomSeed", 1 + bodies_[0].mesh.seed);
  gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 1);
  // Triangles about an edge of length w: its strip of the plane at distance d has edges w + growth*d, which sums to
  // cells_per_size/growth. Tetrahedra: rings about it, pi*cells_per_size/growth^2.
  double const per_edge = mesher_.cells_per_size() / growth * (dimension_ == 2 ? 1 : std::acos(-1.0) / growth);
  int const fine_lines = grow_inwards(over * finest_.mesh.size);
  refuse_too_many(per_edge * fine_lines, finest_, dimension_);
  for (std::size_t b = 0; b < bodies_.size() && dimension_ == 3 && !solid_; ++b)
    refuse_too_many_lines(drawn_.pieces[b], over, bodies_[b], together_);
  set_edge_lengths(drawn_, over);
  return fine_lines > 0;
}

/// One sliver sets the time step of the whole scene: a mesh with slivers is made again by other algorithms. But narrow
/// places of a shape force slivers on all of them, so that the first, the best in all else, stays unless another is
/// twice as good. Sides of a solid narrower than its cells are such places all round: no second mesh is tried. Throws
/// what Gmsh says where there is none.
std::vector<Part> Generation::best_mesh(bool fine_outline) const {
  std::vector<Part> best;
  double best_shape = 0;
  bool const first_will_do = dimension_ == 3 && !solid_ && fine_outline;
  for (int attempt = 0; attempt < mesher_.drawer()->attempts() && best_shape < good_shape; ++attempt) {
    if (first_will_do && !best.empty()) break;
    mesher_.drawer()->choose_algorithms(attempt);
    if (meshed(kind_, blocks_)) {
      std::vector<Part> parts;
      double shape = 1;
      for (auto const& pieces : drawn_.pieces) {
        parts.push_back(collect(kind_, blocks_, together_ ? pieces : Entities{}));
        shape = std::min(shape, worst_shape(parts.back(), kind_));
      }
      bool const triangles = solid_ && !parts[0].cells.empty();  // no base of hexahedra
      if (!triangles && (best.empty() || shape >= 2 * best_shape)) best = std::move(parts), best_shape = shape;
    }
    gmsh::model::mesh::clear();
  }
  if (!best.empty()) return best;
  std::string why;
  gmsh::logger::getLastError(why);
  throw why.substr(0, why.find_last_not_of(' ') + 1);
}

void Generation::refuse_places_without_body(std::vector<Part> const& parts) const {
  for (std::size_t b = 0; b < parts.size(); ++b)
    for (auto const& near : bodies_[b].mesh.near)
      if (std::none_of(parts[b].nodes.begin(), parts[b].nodes.end(),
                       [&](Vec3 const& p) { return distance(near, p[0], p[1]) <= near.radius + near.size; }))
        throw Error(bodies_[b].source,
                    fmt::format("body \"{}\": mesh.near: no part of the body is within {:g} m of the place from ({:g}, "
                                "{:g}) to ({:g}, {:g}) m",
                                bodies_[b].name, near.radius, near.from[0], near.from[1], near.to[0], near.to[1]));
}

std::vector<Part> generate_or_throw(std::vector<scene::Body> const& bodies, Mesher const& mesher) {
  GmshModel model;
  return Generation(bodies, mesher).parts();
}

/// OpenCASCADE takes points within 1e-7 for one, whatever the unit: small bodies are drawn and meshed larger, by a
/// power of two, and brought back without an error.
std::vector<Part> generate_at_scale(std::vector<scene::Body> const& bodies, Mesher const& mesher) {
  double const least = least_length(bodies);
  if (!(least > 0 && least < 1e-5)) return generate_or_throw(bodies, mesher);
  double const f = std::exp2(std::round(-std::log2(least)));
  if (!std::isfinite(f)) throw std::string("its sizes are too small for numbers");
  auto parts = generate_or_throw(scaled(bodies, f), mesher);
  for (auto& part : parts)
    for (Vec3& node : part.nodes) node /= f;
  return parts;
}

}  // namespace

std::vector<Part> generate(std::vector<scene::Body> const& bodies, Mesher const& mesher) {
  std::string names;
  for (auto const& body : bodies) names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", body.name);
  auto const refuse = [&](std::string const& why) -> std::vector<Part> {
    throw Error(bodies[0].source,
                fmt::format("{} {}: Gmsh could not mesh the {} ({}); try another mesh size or a simpler shape",
                            bodies.size() > 1 ? "bodies" : "body", names,
                            bodies.size() > 1 ? "shapes together" : "shape", why));
  };
  try {
    return generate_at_scale(bodies, mesher);
  } catch (Error const&) {
    throw;
  } catch (std::string const& why) {  // how Gmsh reports
    return refuse(why);
  } catch (std::exception const& why) {
    return refuse(why.what());
  } catch (...) {  // OpenCASCADE's own kinds
    return refuse("no reason given");
  }
}

}  // namespace fissure::mesh
#else

namespace fissure::mesh {
std::vector<Part> generate(std::vector<scene::Body> const& bodies, Mesher const&) {
  auto const& body = bodies.at(0);
  throw Error(body.source,
              fmt::format("body \"{}\": this program was built without Gmsh, which meshes such shapes; without it "
                          "there are boxes with mesh.structured = true and mesh files (mesh_file{{...}})",
                          body.name));
}
}  // namespace fissure::mesh
#endif
