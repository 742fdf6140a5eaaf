// Every body of a scene, from where its mesh comes: a grid, Gmsh or a file.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

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
  if (std::string const other[] = {"tri", "tet", "quad", "hex"}; std::find(std::begin(other), std::end(other), spec.cells) != std::end(other)) {
    if (spec.cells != word && spec.cells != block_word)
      refuse(fmt::format("cells = \"{}\" is not for this program (its cells are \"{}\" and \"{}\"); write \"{}\", which fits both", spec.cells,
                         word, block_word, spec.blocks() ? "block" : "simplex"));
  } else if (spec.cells != "simplex" && spec.cells != "block") {
    refuse(fmt::format("unknown cells \"{}\"{}", spec.cells, suggestion(spec.cells, {"simplex", "block", "tri", "tet", "quad", "hex"})));
  }
  bool const from_file = std::holds_alternative<scene::MeshFile>(body.shape.is);
  if (from_file) {
    if (spec.structured)
      refuse("structured = true has no meaning for a mesh file (it is already meshed); leave it out");
    if (spec.seed) refuse("seed has no meaning for a mesh file (it is already meshed); leave it out");
    if (spec.seam) refuse("seam has no meaning for a mesh file (it is already meshed); leave it out");
    if (spec.irregular > 0) refuse("irregular has no meaning for a mesh file (it is already meshed); leave it out");
    if (spec.cells != "simplex") refuse("cells has no meaning for a mesh file (its cells are what they are); leave it out");
  } else {
    if (!(std::isfinite(spec.size) && spec.size > 0))
      refuse(fmt::format("mesh size must be a number above 0 (it is {:g})", spec.size));
    if (spec.structured && !std::holds_alternative<scene::Box>(body.shape.is))
      refuse("structured = true needs a box (other shapes have no regular grid); leave structured out");
    if (spec.seam && (spec.structured || spec.irregular > 0))
      refuse(fmt::format("seam and {} exclude each other ({}); leave one out", spec.structured ? "structured = true" : "irregular",
                         spec.structured ? "a regular grid has its own lines" : "its nodes would be moved"));
    if (spec.blocks() && spec.irregular > 0)
      refuse(fmt::format("irregular is for simplices (cells are \"{}\"); a seed gives an irregular mesh of blocks", spec.cells));
    if (spec.structured && spec.seed)
      refuse("seed has no meaning with structured = true (a regular grid is not random); leave one out");
  }
}

Part structured(scene::Box const& box, scene::Body const& body, Mesher const& mesher) {
  Source const& at = body.shape.source.file.empty() ? body.source : body.shape.source;
  require_finite(box.center, "box", at);
  for (int axis = 0; axis < node_count(mesher.kind()) - 1; ++axis) require_positive(box.size[axis], "box", "size", at);
  refuse_too_many(structured_count(mesher.kind(), box.size, body.mesh.size), body);
  return structured_part(mesher.kind(), box.center, box.size, body.mesh.size, body.mesh.blocks());
}

/// Blocks of a shape that has a regular mesh of them; a seam or a seed asks for an irregular one.
std::optional<Part> regular_blocks(scene::Body const& body, Mesher const& mesher) {
  if (!body.mesh.blocks() || body.mesh.seed || body.mesh.seam) return std::nullopt;
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
    throw Error(body.source, fmt::format("body \"{}\": integration = \"{}\" is for blocks, and mesh file \"{}\" has none; leave it out", body.name,
                                         body.mesh.integration, file.path));
  return part;
}

}  // namespace

void refuse_too_many(double cells, scene::Body const& body) {
  double const most = 50e6;
  if (cells <= most) return;
  throw Error(body.source,
              fmt::format("body \"{}\": its mesh would have about {:.2g} cells (at most {:.2g} are possible); "
                          "a larger mesh size than {:g} m is needed",
                          body.name, cells, most, body.mesh.size));
}

Mesh make_mesh(scene::Scene const& scene, Mesher const& any) {
  Mesher const& mesher = any.assuming(scene);
  Mesh mesh = no_bodies(mesher.kind());
  mesh.thickness = mesher.thickness(scene);
  for (scene::Body const& body : scene.bodies) {
    check_spec(body, mesher);
    Part part;
    if (auto const* file = std::get_if<scene::MeshFile>(&body.shape.is))
      part = from_file(*file, body, mesher);
    else if (body.mesh.structured)
      part = structured(std::get<scene::Box>(body.shape.is), body, mesher);
    else if (auto regular = regular_blocks(body, mesher))
      part = std::move(*regular);
    else
      part = generate(body, mesher);
    if (body.mesh.irregular > 0) make_irregular(part, mesher.kind(), body.mesh.irregular, body.mesh.seed);
    add_body(mesh, std::move(part), body.name, body.source);
    if (std::holds_alternative<scene::MeshFile>(body.shape.is)) refuse_unmatched_faces(mesh, body.name, body.source);
  }
  return mesh;
}

}  // namespace fissure::mesh
