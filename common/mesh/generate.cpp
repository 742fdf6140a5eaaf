// Unstructured meshes from Gmsh (C. Geuzaine, J.-F. Remacle, Int. J. Numer. Meth. Engng 79, 2009, 1309-1331).
// One thread and fixed seeds, so that the same scene gives the same mesh.
#include <fmt/format.h>

#include "mesh/mesher.h"
#include "mesh/part.h"
#include "mesh/scaled.h"

#if defined(FISSURE_GMSH)
#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "mesh/block.h"
#include "mesh/edge_lengths.h"
#include "mesh/simplex.h"

namespace fissure::mesh {
namespace {

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
        drawn_(draw(bodies, mesher)) {}

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
