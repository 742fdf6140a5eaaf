// Every body of a scene, from where its mesh comes: a grid, Gmsh or a file.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "mesh/mesher.h"
#include "mesh/msh_file.h"
#include "mesh/part.h"

namespace fissure::mesh {
namespace {

void check_spec(scene::Body const& body, Mesher const& mesher) {
  scene::MeshSpec const& spec = body.mesh;
  std::string const word(mesher.cell_word());
  auto const refuse = [&](std::string const& text) {
    throw Error(body.source, fmt::format("body \"{}\": {}", body.name, text));
  };
  std::string const block_word = word == "tri" ? "quad" : "hex";
  if (std::string const other[] = {"tri", "tet", "quad", "hex"};
      std::find(std::begin(other), std::end(other), spec.cells) != std::end(other)) {
    if (spec.cells != word && spec.cells != block_word)
      refuse(fmt::format(
          "cells = \"{}\" is not for this program (its cells are \"{}\" and \"{}\"); write \"{}\", which fits both",
          spec.cells, word, block_word, spec.blocks() ? "block" : "simplex"));
  } else if (spec.cells != "simplex" && spec.cells != "block") {
    refuse(fmt::format("unknown cells \"{}\"{}", spec.cells,
                       suggestion(spec.cells, {"simplex", "block", "tri", "tet", "quad", "hex"})));
  }
  bool const from_file = body.shape.mesh_file();
  if (from_file) {
    if (spec.structured)
      refuse("structured = true has no meaning for a mesh file (it is already meshed); leave it out");
    if (spec.seed) refuse("seed has no meaning for a mesh file (it is already meshed); leave it out");
    if (!spec.seams.empty()) refuse("seam has no meaning for a mesh file (it is already meshed); leave it out");
    if (!spec.near.empty()) refuse("near has no meaning for a mesh file (it is already meshed); leave it out");
    if (spec.irregular > 0) refuse("irregular has no meaning for a mesh file (it is already meshed); leave it out");
    if (spec.cells != "simplex")
      refuse("cells has no meaning for a mesh file (its cells are what they are); leave it out");
  } else {
    if (!(std::isfinite(spec.size) && spec.size > 0))
      refuse(fmt::format("mesh size must be a number above 0 (it is {:g})", spec.size));
    if (spec.structured && !std::holds_alternative<scene::Box>(body.shape.is))
      refuse("structured = true needs a box (other shapes have no regular grid); leave structured out");
    if (!spec.seams.empty() && (spec.structured || spec.irregular > 0))
      refuse(fmt::format("seam and {} exclude each other ({}); leave one out",
                         spec.structured ? "structured = true" : "irregular",
                         spec.structured ? "a regular grid has its own lines" : "its nodes would be moved"));
    if (!spec.near.empty() && spec.structured)
      refuse("near and structured = true exclude each other (the cells of a regular grid are alike); leave one out");
    if (spec.blocks() && spec.irregular > 0)
      refuse(fmt::format("irregular is for simplices (cells are \"{}\"); a seed gives an irregular mesh of blocks",
                         spec.cells));
    if (spec.structured && spec.seed)
      refuse("seed has no meaning with structured = true (a regular grid is not random); leave one out");
  }
}

Part structured(scene::Box const& box, scene::Body const& body, Mesher const& mesher) {
  Source const& at = body.shape.source.file.empty() ? body.source : body.shape.source;
  require_finite(box.center, "box", at);
  for (int axis = 0; axis < node_count(mesher.kind()) - 1; ++axis) require_positive(box.size[axis], "box", "size", at);
  refuse_too_many(structured_count(mesher.kind(), box.size, body.mesh.size), body, node_count(mesher.kind()) - 1);
  return structured_part(mesher.kind(), box.center, box.size, body.mesh.size, body.mesh.blocks());
}

/// Blocks of a shape that has a regular mesh of them; a seam, a seed or places with smaller elements ask for an
/// irregular one.
std::optional<Part> regular_blocks(scene::Body const& body, Mesher const& mesher) {
  if (!body.mesh.regular()) return std::nullopt;
  if (auto const* box = std::get_if<scene::Box>(&body.shape.is)) return structured(*box, body, mesher);
  return block_part(body, mesher);
}

Part from_file(scene::MeshFile const& file, scene::Body const& body, Mesher const& mesher) {
  std::error_code no_exception;
  if (!std::filesystem::is_regular_file(file.path, no_exception))
    throw Error(body.source,
                fmt::format("body \"{}\": cannot read mesh file \"{}\" (no such file)", body.name, file.path));
  Part part = read_msh_file(file.path, mesher.kind());
  if (part.blocks.empty() && body.mesh.integration != "one_point")
    throw Error(
        body.source,
        fmt::format("body \"{}\": integration = \"{}\" is for blocks, and mesh file \"{}\" has none; leave it out",
                    body.name, body.mesh.integration, file.path));
  return part;
}

/// A mesh file's nodes where the shape places them.
Part place(Part part, scene::Shape const& shape, scene::Body const& body) {
  auto const* placed = std::get_if<scene::Placed>(&shape.is);
  if (!placed) return part;
  part = place(std::move(part), placed->part.at(0), body);
  if (placed->how == scene::Placed::How::mirrored && !part.blocks.empty())
    throw Error(
        body.source,
        fmt::format("body \"{}\": a mesh file with blocks cannot be mirrored (their corners would run the wrong "
                    "way around); mirror it where it is made",
                    body.name));
  for (Vec3& node : part.nodes) node = (*placed)(node);
  return part;
}

}  // namespace

namespace {

/// Memory of this machine [bytes].
double machine_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

}  // namespace

double most_cells() {
  double const bytes_per_cell = 400;  // of the mesh while it is made; a run needs more
  return std::min(50e6, machine_memory() / bytes_per_cell);
}

void refuse_too_many(double cells, scene::Body const& body, int dimension) {
  if (cells <= most_cells()) return;
  throw Error(body.source,
              fmt::format("body \"{}\": its mesh would have about {:.2g} cells (at most {:.2g} are possible); mesh "
                          "sizes about {:.2g} times as large are needed",
                          body.name, cells, most_cells(), 1.1 * std::pow(cells / most_cells(), 1.0 / dimension)));
}

namespace {

/// Refuses the scene whose bodies together have too many cells, before the first is meshed: regular grids by their
/// number, others by the least that fills their area or volume, where that is known without drawing them.
void refuse_too_many_in_all(scene::Scene const& scene, Mesher const& mesher) {
  bool const flat = mesher.kind() == CellKind::triangle;
  double const pi = std::acos(-1.0);
  double all = 0;
  for (scene::Body const& body : scene.bodies) {
    double const h = body.mesh.size, per_size = mesher.cells_per_size() / std::pow(h, flat ? 2 : 3);
    if (auto const* box = std::get_if<scene::Box>(&body.shape.is))
      all += body.mesh.structured ? structured_count(mesher.kind(), box->size, h)
                                  : box->size[0] * box->size[1] * (flat ? 1 : box->size[2]) * per_size;
    if (auto const* disc = std::get_if<scene::Disc>(&body.shape.is))
      all += pi * disc->radius * disc->radius * (flat ? 1 : disc->thickness) * per_size;
    if (auto const* ball = std::get_if<scene::Ball>(&body.shape.is))
      all += pi * ball->radius * ball->radius * (flat ? 1 : 4.0 / 3 * ball->radius) * per_size;
    if (auto const* rod = std::get_if<scene::Rod>(&body.shape.is))
      all += rod->length * rod->radius * (flat ? 2 : pi * rod->radius) * per_size;
    if (auto const* ring = std::get_if<scene::Ring>(&body.shape.is))
      all += pi * (ring->outer * ring->outer - ring->inner * ring->inner) * (flat ? 1 : ring->thickness) * per_size;
    if (mesher.revolves() && !body.mesh.structured) continue;
    if (!(all <= most_cells()))
      throw Error(body.source, fmt::format("body \"{}\": the bodies up to this one would have about {:.2g} cells (at "
                                           "most {:.2g} are possible); larger mesh sizes are needed",
                                           body.name, all, most_cells()));
  }
}

/// The body and those behind it that bonds join to it, over others if need be, and that Gmsh meshes.
std::vector<std::size_t> bonded_with(scene::Scene const& scene, std::size_t body) {
  auto const drawn = [&](std::size_t b) {
    auto const& one = scene.bodies[b];
    return !one.mesh.structured && !one.mesh.blocks() && !one.shape.mesh_file();
  };
  std::vector<char> found(scene.bodies.size(), false);
  found[body] = true;
  for (bool grown = true; grown;) {
    grown = false;
    for (auto const& bond : scene.bonds) {
      if (std::none_of(bond.bodies.begin(), bond.bodies.end(), [&](int b) { return found[b]; })) continue;
      for (int const b : bond.bodies)
        if (!found[b] && drawn(b)) found[b] = grown = true;
    }
  }
  std::vector<std::size_t> together{body};
  for (std::size_t b = body + 1; b < scene.bodies.size() && drawn(body); ++b)
    if (found[b]) together.push_back(b);
  return together;
}

}  // namespace

Mesh make_mesh(scene::Scene const& scene, Mesher const& any) {
  Mesher const& mesher = any.assuming(scene);
  Mesh mesh = no_bodies(mesher.kind());
  mesh.thickness = mesher.thickness(scene);
  for (scene::Body const& body : scene.bodies) check_spec(body, mesher);
  if (scene.bodies.size() > 1) refuse_too_many_in_all(scene, mesher);
  std::map<std::size_t, Part> drawn;  // of bodies that are meshed together with one before them
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    scene::Body const& body = scene.bodies[b];
    Part part;
    if (auto const* file = body.shape.mesh_file())
      part = place(from_file(*file, body, mesher), body.shape, body);
    else if (body.mesh.structured)
      part = structured(std::get<scene::Box>(body.shape.is), body, mesher);
    else if (auto regular = regular_blocks(body, mesher))
      part = std::move(*regular);
    else if (auto const done = drawn.find(b); done != drawn.end())
      part = std::move(done->second);
    else {
      auto const together = bonded_with(scene, b);
      std::vector<scene::Body> bodies;
      for (std::size_t const k : together) bodies.push_back(scene.bodies[k]);
      auto parts = generate(bodies, mesher);
      for (std::size_t k = 1; k < together.size(); ++k) drawn[together[k]] = std::move(parts[k]);
      part = std::move(parts[0]);
    }
    std::size_t const cells = part.cells.size() / node_count(mesher.kind()) +
                              part.blocks.size() / block_corners(mesher.kind()) * block_parts(mesher.kind());
    refuse_too_many(static_cast<double>(mesh.n_cells()) + static_cast<double>(cells), body,
                    node_count(mesher.kind()) - 1);
    if (body.mesh.irregular > 0) make_irregular(part, mesher.kind(), body.mesh.irregular, body.mesh.seed);
    add_body(mesh, std::move(part), body.name, body.source);
    if (body.shape.mesh_file()) refuse_unmatched_faces(mesh, body.name, body.source);
  }
  bond_bodies(mesh, scene);
  tie_bodies(mesh, scene);
  return mesh;
}

}  // namespace fissure::mesh
