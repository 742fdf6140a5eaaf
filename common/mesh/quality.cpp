// How good a mesh is, in numbers and in one line.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "mesh/block.h"
#include "mesh/part.h"
#include "mesh/simplex.h"

namespace fissure::mesh {
namespace {

/// 12345 as "12 345".
std::string grouped(int number) {
  if (number < 1000) return std::to_string(number);
  return fmt::format("{} {:03}", grouped(number / 1000), number % 1000);
}

}  // namespace

std::vector<Quality> quality(Mesh const& mesh) {
  int const corners = node_count(mesh.kind);
  std::vector<Quality> all;
  int shown = 0;  // cells so far, blocks counted once
  for (int b = 0; b < mesh.n_bodies(); ++b) {
    Quality q;
    int const simplices = mesh.n_simplices(b);
    q.blocks = mesh.n_blocks(b);
    q.cells = simplices + q.blocks;
    q.nodes = mesh.body_first_node[b + 1] - mesh.body_first_node[b];
    q.least_edge = q.least_shape = std::numeric_limits<double>::infinity();
    double edges = 0, n_edges = 0, shapes = 0, altitudes = 0;  // edges counted once per cell
    auto const add_edge = [&](double edge) {
      q.least_edge = std::min(q.least_edge, edge);
      q.largest_edge = std::max(q.largest_edge, edge);
      edges += edge;
      ++n_edges;
    };
    auto const add_cell = [&](auto const& cell) {
      double const shape = cell.shape();
      if (shape < q.least_shape) {
        q.least_shape = shape;
        q.worst_cell = shown;
        q.worst_place = cell.centroid();
        q.worst_altitude = cell.altitude();
      }
      shapes += shape;
      altitudes += cell.altitude();
      q.measure += cell.measure();
      ++shown;
    };
    for (int c = mesh.body_first_cell[b]; c < mesh.body_first_cell[b] + simplices; ++c) {
      Simplex const s(std::span(mesh.cells).subspan(std::size_t(c) * corners, corners), mesh.nodes);
      for (int i = 0; i < corners; ++i)
        for (int j = 0; j < i; ++j) add_edge((s.point[i] - s.point[j]).norm());
      add_cell(s);
    }
    for (int k = 0; k < q.blocks; ++k) {
      std::size_t const n = block_corners(mesh.kind), first = (mesh.body_first_block[b] + k) * n;
      Block const block(std::span(mesh.blocks).subspan(first, n), mesh.nodes);
      for (int a = 0; a < block.corners(); ++a)
        for (int axis = 0; axis < block.axes; ++axis)
          if (Block::sign(a, axis) < 0) add_edge(block.edge(a, axis));
      add_cell(block);
    }
    q.mean_edge = edges / n_edges;
    q.mean_shape = shapes / q.cells;
    q.mean_altitude = altitudes / q.cells;
    all.push_back(q);
  }
  return all;
}

std::vector<std::string> warnings(scene::Scene const& scene, Mesh const& mesh) {
  std::vector<std::string> lines;
  auto const all = quality(mesh);
  for (std::size_t b = 0; b < all.size(); ++b) {
    Quality const& q = all[b];
    if (scene.bodies[b].shape.mesh_file())
      if (auto const doubled = doubled_faces(mesh, static_cast<int>(b)); doubled.count > 0)
        lines.push_back(
            fmt::format("{}body \"{}\": {} faces of its mesh lie on each other near ({:.4g}, {:.4g}, {:.4g}) with "
                        "nodes of their own: it is cracked there from the start; merge the nodes if that is not meant",
                        scene.bodies[b].source.prefix(), scene.bodies[b].name, doubled.count, doubled.place.x(),
                        doubled.place.y(), doubled.place.z()));
    auto const& body = scene.bodies[b];
    auto const* const material = body.material >= 0 && body.material < static_cast<int>(scene.materials.size())
                                     ? &scene.materials[body.material]
                                     : nullptr;
    bool const regular = q.blocks > 0 && body.mesh.regular() && !body.shape.mesh_file();
    if (regular && material && material->joint)
      lines.push_back(fmt::format(
          "{}body \"{}\": cracks follow faces, and those of a regular mesh of blocks lead in few directions: it may "
          "carry far too much, above all in compression; a mesh.seed or cells = \"simplex\"?",
          body.source.prefix(), body.name));
    if (q.blocks > 0 && material && material->flow && body.mesh.integration != "b_bar")
      lines.push_back(
          fmt::format("{}body \"{}\" flows, and integration = \"{}\" is not right for that (what flows keeps its "
                      "volume); \"b_bar\"?",
                      body.source.prefix(), body.name, body.mesh.integration));
    if (q.least_shape >= good_shape) continue;
    Vec3 const& p = q.worst_place;
    lines.push_back(
        fmt::format("{}body \"{}\": cell {} near ({:.4g}, {:.4g}, {:.4g}) is a sliver (shape {:.2g}, {:.2g} m high "
                    "where cells are {:.2g} m on average): with it the time step is about {:.2g} times shorter; a "
                    "shape without narrow places, another mesh size or seed?",
                    scene.bodies[b].source.prefix(), scene.bodies[b].name, q.worst_cell, p.x(), p.y(), p.z(),
                    q.least_shape, q.worst_altitude, q.mean_altitude, q.mean_altitude / q.worst_altitude));
  }
  return lines;
}

std::string describe(std::string const& body, CellKind kind, Quality const& q) {
  bool const flat = kind == CellKind::triangle;
  auto const count = [](int number, char const* one, char const* many) {
    return fmt::format("{} {}", grouped(number), number == 1 ? one : many);
  };
  int const simplices = q.cells - q.blocks;
  std::string cells =
      simplices > 0 ? count(simplices, flat ? "triangle" : "tetrahedron", flat ? "triangles" : "tetrahedra") : "";
  if (q.blocks > 0)
    cells += (simplices > 0 ? " and " : "") +
             count(q.blocks, flat ? "quadrilateral" : "hexahedron", flat ? "quadrilaterals" : "hexahedra");
  double const unit = q.mean_edge >= 1 ? 1 : q.mean_edge >= 1e-4 ? 1e-3 : 1e-6;
  char const* const unit_name = unit == 1 ? "m" : unit == 1e-3 ? "mm" : "um";
  return fmt::format(
      "{}: {}, {} nodes, edges {:.3g}-{:.3g} {} (mean {:.3g}), worst shape {:.2f} (cell {}), mean {:.2f}", body, cells,
      grouped(q.nodes), q.least_edge / unit, q.largest_edge / unit, unit_name, q.mean_edge / unit, q.least_shape,
      q.worst_cell, q.mean_shape);
}

}  // namespace fissure::mesh
