// Cells as sets: simplices (triangles, tetrahedra) and blocks (quadrilaterals, hexahedra), body by body.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "backend/buffer.h"
#include "base/dim.h"
#include "base/face_id.h"
#include "kernels/views.h"

namespace fissure::model {

/// Simplices that are cells of their own, and those that a block is cut into, which only contact and output see. Padded
/// to whole packs with copies without mass. Numbers are blocked (kernels::blocked) where that is said.
template <class Real>
struct ElementArrays {
  Index count = 0;
  Buffer<Real> X;                  // place of the corners at rest, about the origin, blocked [m]
  Buffer<Index> vertex;            // at each corner, blocked; empty when every corner is its own vertex
  Buffer<std::int8_t> parity;      // sign of the volume that the order of the corners gives
  Buffer<double> viscous_work;     // [J]
  std::vector<Index> host_vertex;  // as vertex
  std::vector<int> node;           // [element][corner] of the mesh, of twins the lowest, ascending; -1: padding
  std::vector<Index> cell;         // of the mesh; -1: padding
  std::vector<Index> of_cell;      // the element of each
  std::vector<int> body;           // -1: padding
  std::vector<char> removed;       // 1: has left the run; empty: none can
};

template <class Real>
struct BlockArrays {
  Index count = 0;                    // padded
  Index parts = 1;                    // simplices that one is cut into
  Buffer<Index> vertex;               // at each of 2^D corners, blocked
  Buffer<Real> shapes;                // numbers of their shapes at rest, body by body
  std::vector<Index> host_vertex;     // as vertex
  std::vector<Real> host_shapes;      // as shapes
  std::vector<double> corner_volume;  // [block][2^D] what each corner gets of the volume [m^3]
};

/// The cells of one kind in a body: a contiguous range, padded to whole packs.
struct CellRange {
  Index first = 0, count = 0, padded = 0;
  Index first_slot = 0;       // where forces at their corners begin
  std::size_t memory_at = 0;  // where what they remember of flow begins
};

/// A face of a cell, by the cell's number in its set.
struct CellFace {
  Index cell;
  int face;
};

template <int D, class Real>
class Model;
struct Group;

/// A model's simplices that are cells. They and its blocks answer the same questions, and what is told by kind of cell
/// (`joints` and `block_joints`) is found by of(): nobody else asks which kind a cell is (Model::in_set(), each_set()).
template <int D, class Real>
class Simplices {
 public:
  static constexpr int corners = D + 1, faces = D + 1, face_points = D;
  static constexpr int vtk = Dim<D>::vtk_simplex, kind = 0;  // of two

  explicit Simplices(Model<D, Real> const& model) : model_(model) {}
  static CellRange const& range(Group const& group);
  template <class Both>
  static auto& of(Both& both) {
    return both.joints;
  }

  /// The element that stands for a cell.
  Index element(Index cell) const { return cell; }
  Index vertex(Index cell, int a) const;
  /// The vertices at a point of a face: its own, and the one across (its own where there is no joint).
  Index face_vertex(Index cell, int face, int i) const;
  Index across(Index cell, int face, int i) const;
  /// The faces of elements that a face is made of; a block's that has no joint has none.
  std::array<FaceId, 1> parts(Index cell, int face) const { return {FaceId{cell, face}}; }
  /// The face that an element's face is or lies on (-1: it lies inside the cell), and which of that face's points is at
  /// corner i of the element's.
  CellFace face_of(FaceId part) const { return {part.element, part.face}; }
  int point(FaceId, int, int i) const { return i; }
  /// Where areas of faces keep that of a point, and what the point has of it, over a like share [-].
  static std::size_t area_at(Index cell, int face, int) { return kernels::blocked(cell, face, faces); }
  Real area_share(Index cell, int face, int i) const;
  static auto& areas(auto& interfaces) { return interfaces.area; }
  /// Where vertices across have an array of their own.
  static void upload_across(auto&, std::size_t, Index) {}
  /// Numbers of elements' faces as those of the set's: of several the least, or whether all are.
  std::vector<double> const& least(std::vector<double> const& of_elements) const { return of_elements; }
  std::vector<std::uint8_t> const& all(std::vector<std::uint8_t> const& of_elements) const { return of_elements; }

  /// +1: normals of faces come out outward from the corners' order, of even faces; -1: of odd ones.
  Real outward(Index cell, int face) const;
  /// The corner that is drawn as a-th; `mirrored`: the order of corners gives a negative volume.
  static int drawn(int a, bool mirrored) { return mirrored && a < 2 ? 1 - a : a; }
  /// Over the element's area or volume at rest.
  double volume_ratio(std::vector<Real> const& u, Index cell, bool mean) const;
  double squared_gradients(std::vector<Real> const& u, Index cell, std::vector<double> const& volumes,
                           std::vector<char> const& on_axis) const;
  std::vector<double> corner_volumes(Index cell) const;
  double remembered(std::vector<Real> const& memory, Index cell, int k) const;

 private:
  Model<D, Real> const& model_;
};

/// A model's blocks.
template <int D, class Real>
class Blocks {
 public:
  using Shape = BlockShape<D>;
  static constexpr int corners = Shape::corners, faces = Shape::faces, face_points = Shape::face_corners;
  static constexpr int vtk = Dim<D>::vtk_block, kind = 1;

  explicit Blocks(Model<D, Real> const& model) : model_(model) {}
  static CellRange const& range(Group const& group);
  template <class Both>
  static auto& of(Both& both) {
    return both.block_joints;
  }

  Index element(Index cell) const;
  Index vertex(Index cell, int a) const;
  Index face_vertex(Index cell, int face, int i) const { return vertex(cell, Shape::face(face, i)); }
  Index across(Index cell, int face, int i) const;
  std::span<FaceId const> parts(Index cell, int face) const;
  CellFace face_of(FaceId part) const;
  int point(FaceId part, int face, int i) const;  // -1: not on the face
  static std::size_t area_at(Index cell, int face, int i) {
    return kernels::blocked(cell, face * face_points + i, faces * face_points);
  }
  Real area_share(Index, int, int) const { return 1; }
  static auto& areas(auto& interfaces) { return interfaces.block_area; }
  static void upload_across(auto& interfaces, std::size_t at, Index vertex) {
    interfaces.across.upload_one(at, vertex);
  }
  std::vector<double> least(std::vector<double> const& of_parts) const;
  std::vector<std::uint8_t> all(std::vector<std::uint8_t> const& of_parts) const;

  Real outward(Index, int) const { return 1; }
  static int drawn(int a, bool) { return a; }
  double volume_ratio(std::vector<Real> const& u, Index cell, bool mean) const;
  double squared_gradients(std::vector<Real> const& u, Index cell, std::vector<double> const& volumes,
                           std::vector<char> const& on_axis) const;
  std::vector<double> corner_volumes(Index cell) const;
  double remembered(std::vector<Real> const& memory, Index cell, int k) const;

 private:
  std::array<Mat<double, D>, 2> jacobians(std::vector<Real> const& u, Index block, int p) const;
  std::array<double, 2> radii(std::vector<Real> const& u, Index block, int p) const;
  Group const& group_of(Index block) const;

  Model<D, Real> const& model_;
};

}  // namespace fissure::model
