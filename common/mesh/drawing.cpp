// Bodies drawn in OpenCASCADE.
#if defined(FISSURE_GMSH)
#include "mesh/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace fissure::mesh {

double measure_of(std::pair<int, int> const& entity) {
  double measure = 0;
  gmsh::model::occ::getMass(entity.first, entity.second, measure);
  return measure;
}

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
namespace {

// of a shape: OpenCASCADE takes seconds for them, and its time grows by their square
constexpr std::size_t most_parts = 500;

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
}  // namespace

Drawn draw(std::vector<scene::Body> const& bodies, Mesher const& mesher) {
  Drawn drawn{bodies, {}};
  for (auto const& body : bodies) drawn.pieces.push_back(Drawing(mesher).draw(body.shape, body.source));
  fit_together(drawn, mesher);
  return drawn;
}

}  // namespace fissure::mesh
#endif
