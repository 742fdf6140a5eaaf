// From a raw part to a body of the mesh: checks, orientation, order and boundary.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "mesh/block.h"
#include "mesh/faces.h"
#include "mesh/hilbert.h"
#include "mesh/part.h"
#include "mesh/simplex.h"

namespace fissure::mesh {
namespace {

/// The part on its way into the mesh, with all that a message needs.
class Body {
 public:
  Body(CellKind kind, Part part, std::string const& name, Source const& at)
      : kind_(kind), corners_(node_count(kind)), part_(std::move(part)), name_(name), at_(at), simplices_(n_cells()) {}

  void check_numbers() const;
  void split_blocks();
  void orient();
  void order();
  std::vector<FaceUse> matched_faces() const;
  void append_to(Mesh& mesh, std::vector<FaceUse> const& faces) const;

 private:
  int n_cells() const { return static_cast<int>(part_.cells.size()) / corners_; }
  int n_blocks() const { return static_cast<int>(part_.blocks.size()) / block_corners(kind_); }
  std::span<int const> block(int b) const {
    return std::span(part_.blocks).subspan(std::size_t(b) * block_corners(kind_), block_corners(kind_));
  }
  /// The block that cell c is part of before the cells are put in order; -1: none.
  int owner(int c) const { return c < simplices_ ? -1 : (c - simplices_) / block_parts(kind_); }
  std::span<int const> cell(int c) const { return std::span(part_.cells).subspan(std::size_t(c) * corners_, corners_); }
  Simplex simplex(int c) const { return Simplex(cell(c), part_.nodes); }

  [[noreturn]] void refuse(std::string const& text) const {
    throw Error(at_, fmt::format("body \"{}\": {}", name_, text));
  }

  /// "cell 7 near (0.1, 0.2, 0)" or "element 12 of part.msh near ...".
  std::string says(int c) const {
    Vec3 const p = simplex(c).centroid();
    std::string const which =
        part_.file.empty() ? fmt::format("cell {}", label(c)) : fmt::format("element {} of {}", label(c), part_.file);
    return fmt::format("{} near ({:.4g}, {:.4g}, {:.4g})", which, p.x(), p.y(), p.z());
  }
  long long label(int c) const {
    std::size_t const which = owner(c) < 0 ? c : simplices_ + owner(c);
    return part_.labels.empty() ? static_cast<long long>(which) : part_.labels[which];
  }

  /// What to do about bad blocks: those of a file are its own, Gmsh's come from another attempt.
  char const* mend() const {
    return part_.file.empty() ? "another mesh size or seed, or cells = \"simplex\"?" : "repair the mesh";
  }

  CellKind kind_;
  int corners_;
  Part part_;
  std::string const& name_;
  Source const& at_;
  int simplices_;  // cells that are no part of a block: the first ones
};

void Body::check_numbers() const {
  if (part_.cells.empty() && part_.blocks.empty())
    refuse("its mesh has no cells (the shape may be empty or far smaller than its mesh size)");
  if (part_.nodes.size() > 1u << 30 || part_.cells.size() + part_.blocks.size() * 6 > 1u << 30)
    refuse("its mesh has more than 2^30 cell corners");
  for (std::size_t n = 0; n < part_.nodes.size(); ++n)
    if (!part_.nodes[n].allFinite())
      refuse(fmt::format("node {} of its mesh has a coordinate that is not a number", n));
  for (int c = 0; c < n_cells(); ++c)
    for (int n : cell(c))
      if (n < 0 || n >= static_cast<int>(part_.nodes.size()))
        refuse(fmt::format("cell {} uses node {}, but the mesh has {} nodes", label(c), n, part_.nodes.size()));
  for (int n : part_.blocks)
    if (n < 0 || n >= static_cast<int>(part_.nodes.size()))
      refuse(fmt::format("a block uses node {}, but the mesh has {} nodes", n, part_.nodes.size()));
}

/// Turns blocks that are mirrored, refuses folded ones, and appends their parts to the cells.
void Body::split_blocks() {
  int const n = block_corners(kind_);
  if (n_blocks() > 0 && simplices_ > 0 && kind_ == CellKind::tetrahedron)
    refuse(
        fmt::format("has {} tetrahedra and {} hexahedra (their faces do not match without pyramids between them); make "
                    "them two bodies that touch",
                    simplices_, n_blocks()));
  for (int b = 0; b < n_blocks(); ++b) {
    std::span<int> const corner(&part_.blocks[std::size_t(b) * n], n);
    if (Block(corner, part_.nodes).measure() < 0) {
      if (n == 4)
        std::swap(corner[1], corner[3]);
      else
        std::swap_ranges(corner.begin(), corner.begin() + 4, corner.begin() + 4);
    }
    Block const it(corner, part_.nodes);
    if (!(it.shape() > 1e-3)) {
      Vec3 const p = it.centroid();
      std::size_t const which = simplices_ + b;
      std::string const from =
          part_.file.empty()
              ? fmt::format("block {}", b)
              : fmt::format("element {} of {}", part_.labels.empty() ? which : part_.labels[which], part_.file);
      refuse(fmt::format(
          "{} near ({:.4g}, {:.4g}, {:.4g}) is folded or flat (its least scaled Jacobian is {:.2g}, a box has 1); {}",
          from, p.x(), p.y(), p.z(), it.shape(), mend()));
    }
    std::vector<int> const parts = parts_of(corner);
    for (std::size_t k = 0; k < parts.size(); k += corners_)
      if (!(Simplex(std::span(parts).subspan(k, corners_), part_.nodes).measure() > 0)) {
        Vec3 const p = it.centroid();
        std::size_t const which = simplices_ + b;
        refuse(fmt::format(
            "{} {} near ({:.4g}, {:.4g}, {:.4g}) is so twisted that it cannot be cut into simplices (contact needs "
            "them); {}",
            part_.file.empty() ? "block" : "element",
            part_.labels.empty() ? static_cast<long long>(part_.file.empty() ? b : which) : part_.labels[which], p.x(),
            p.y(), p.z(), mend()));
      }
    part_.cells.insert(part_.cells.end(), parts.begin(), parts.end());
  }
}

/// The order of a file's corners is only a convention: a cell that turns the wrong way is turned, a flat one refused.
void Body::orient() {
  for (int c = 0; c < n_cells(); ++c) {
    Simplex const s = simplex(c);
    double const measure = s.measure(), shape = s.shape();
    bool const degenerate = !(std::abs(measure) > 1e-14 * std::pow(s.longest_edge(), corners_ - 1)) || !(shape >= 1e-6);
    if (degenerate)
      refuse(fmt::format("{} is degenerate (its radius ratio is {:.2g}, a regular one has 1); repair the mesh", says(c),
                         shape));
    if (measure < 0) std::swap(part_.cells[std::size_t(c) * corners_], part_.cells[std::size_t(c) * corners_ + 1]);
  }
}

void Body::order() {
  // Cells along the curve through the cube about their centroids.
  int const axes = corners_ - 1, bits = 63 / axes;
  std::vector<Vec3> centroids(n_cells());
  for (int c = 0; c < n_cells(); ++c)
    centroids[c] = owner(c) < 0 ? simplex(c).centroid() : Block(block(owner(c)), part_.nodes).centroid();
  Vec3 low = centroids[0], high = centroids[0];
  for (Vec3 const& p : centroids) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  double const extent = std::max((high - low).maxCoeff(), 1e-300);
  double const top = static_cast<double>((std::uint64_t(1) << bits) - 1);
  // equal for all parts of a block, so that these stay together
  std::vector<std::pair<std::uint64_t, int>> place(n_cells());
  for (int c = 0; c < n_cells(); ++c) {
    std::array<std::uint32_t, 3> x{};
    for (int i = 0; i < axes; ++i)
      x[i] = static_cast<std::uint32_t>(std::min(top, (centroids[c][i] - low[i]) / extent * top));
    place[c] = {hilbert_index(x, axes, bits), c};
  }
  std::sort(place.begin(), place.begin() + simplices_);
  std::sort(place.begin() + simplices_, place.end());

  // Nodes by first use; those of no cell get no number.
  std::vector<int> number(part_.nodes.size(), -1), cells;
  std::vector<Vec3> nodes;
  std::vector<long long> labels;
  std::vector<int> blocks;
  cells.reserve(part_.cells.size());
  nodes.reserve(part_.nodes.size());
  for (int c = 0; c < n_cells(); ++c) {
    bool const is_part = owner(place[c].second) >= 0,
               first_part = is_part && (c - simplices_) % block_parts(kind_) == 0;
    if (!is_part || first_part) labels.push_back(label(place[c].second));
    for (int n : cell(place[c].second)) {
      if (number[n] < 0) {
        number[n] = static_cast<int>(nodes.size());
        nodes.push_back(part_.nodes[n]);
      }
      cells.push_back(number[n]);
    }
    if (is_part && (c - simplices_ + 1) % block_parts(kind_) == 0)
      for (int n : block(owner(place[c].second))) blocks.push_back(number[n]);
  }
  part_.cells = std::move(cells);
  part_.blocks = std::move(blocks);
  part_.nodes = std::move(nodes);
  part_.labels = std::move(labels);
  for (auto& [name, group] : part_.group_nodes) {
    for (int& n : group) n = number[n];
    std::erase(group, -1);
    std::sort(group.begin(), group.end());
    group.erase(std::unique(group.begin(), group.end()), group.end());
  }
  for (auto& [name, group] : part_.group_faces)
    for (auto& face : group)
      for (int& n : face) n = n < 0 ? -1 : number[n];
}

std::vector<FaceUse> Body::matched_faces() const {
  std::vector<FaceUse> faces = sorted_faces(part_.cells, corners_);
  for (std::size_t first = 0, end = 0; first < faces.size(); first = end) {
    while (end < faces.size() && faces[end].nodes == faces[first].nodes) ++end;
    if (end - first < 2) continue;
    int const p = faces[first].use, q = faces[first + 1].use;
    for (std::size_t i = first; i < end; ++i)
      for (std::size_t j = first; j < i; ++j)
        if (part_.cells[faces[i].use] == part_.cells[faces[j].use])
          refuse(fmt::format("{} and {} have the same corners; remove one of them", says(faces[j].use / corners_),
                             says(faces[i].use / corners_)));
    if (end - first > 2)
      refuse(fmt::format("more than two cells share a face ({}, {} and {}); repair the mesh", says(p / corners_),
                         says(q / corners_), says(faces[first + 2].use / corners_)));
    Vec3 const one = simplex(p / corners_).face_vector(p % corners_);
    Vec3 const other = simplex(q / corners_).face_vector(q % corners_);
    if (one.dot(other) > 0)
      refuse(fmt::format("{} and {} overlap (both lie on the same side of the face they share); repair the mesh",
                         says(p / corners_), says(q / corners_)));
  }
  return faces;
}

void Body::append_to(Mesh& mesh, std::vector<FaceUse> const& faces) const {
  int const first_cell = mesh.body_first_cell.back(), first_node = mesh.body_first_node.back();
  mesh.nodes.insert(mesh.nodes.end(), part_.nodes.begin(), part_.nodes.end());
  mesh.cells.reserve(mesh.cells.size() + part_.cells.size());
  for (int n : part_.cells) mesh.cells.push_back(first_node + n);
  mesh.body_first_cell.push_back(first_cell + n_cells());
  if (n_blocks() > 0 || !mesh.body_first_block.empty()) {
    mesh.body_first_block.resize(mesh.body_first_cell.size() - 1, 0);
    for (int n : part_.blocks) mesh.blocks.push_back(first_node + n);
    mesh.body_first_block.push_back(static_cast<int>(mesh.blocks.size()) / block_corners(kind_));
  }
  mesh.body_first_node.push_back(static_cast<int>(mesh.nodes.size()));
  std::vector<int> const across = neighbours(faces, corners_);
  for (int use = 0; use < static_cast<int>(across.size()); ++use) {
    if (across[use] >= 0) continue;
    Face face{first_cell + use / corners_, {-1, -1, -1, -1}};
    int filled = 0;
    for (int a : face_corners(corners_, use % corners_)) face.node[filled++] = first_node + cell(use / corners_)[a];
    mesh.boundary.push_back(face);
  }
  name_places(mesh, part_);
}

}  // namespace

Mesh no_bodies(CellKind kind) {
  Mesh mesh;
  mesh.kind = kind;
  mesh.body_first_cell = {0};
  mesh.body_first_node = {0};
  return mesh;
}

void add_body(Mesh& mesh, Part part, std::string const& name, Source const& at) {
  Body body(mesh.kind, std::move(part), name, at);
  body.check_numbers();
  body.split_blocks();
  body.orient();
  body.order();
  body.append_to(mesh, body.matched_faces());
}

}  // namespace fissure::mesh
