// The contract that src2d and src3d fulfil: everything in which the dimensions differ. Nothing in common/ asks for D's
// value.
//
//   Dim<D>::name                     "2D", "3D"; ::program "fissure2d", "fissure3d"
//   Dim<D>::corners, face_corners    of a simplex: D + 1 and D
//   Dim<D>::vtk_simplex, vtk_block   VTK's numbers of both kinds of cell
//   Dim<D>::embed(Mat<S,D>, out)     gradient of displacement as 3x3; `out`: strain out of the plane, 0 in plane strain
//   Dim<D>::simplex_share            measure of a simplex over the determinant of its edges
//   Dim<D>::stresses                 how many of xx yy zz xy yz zx a stress has
//   Dim<D>::face_normal(points)      normal of the corners of a simplex' or block's face: the edge turned, half the
//                                    cross product of edges or diagonals; its length is the face's measure
//   Dim<D>::cofactor, volume_change  of a matrix, and det(I + H) - 1 without cancellation
//   Dim<D>::has_plane_stress         whether a scene may ask for it
//   Dim<D>::can_revolve              whether a scene may ask for axisymmetry: 0 is then the radius, 1 along the axis
//   Dim<D>::out_of_plane_share(s)    share of a slip that is mode III
//   Clip<D>                          a flat piece of boundary cut by simplices (src?d/clip.h)
#pragma once
#include <concepts>

#include "base/algebra.h"

namespace fissure {

template <int D>
struct Dim;
template <int D>
struct Clip;

/// Most of that contract, checked where a dimension is defined.
template <int D>
concept Dimension = requires(Vec<double, D> const (&corners)[D], Mat<double, D> const M) {
  { Dim<D>::name } -> std::convertible_to<char const*>;
  { Dim<D>::program } -> std::convertible_to<char const*>;
  { Dim<D>::vtk_simplex + Dim<D>::vtk_block + Dim<D>::stresses } -> std::convertible_to<int>;
  { Dim<D>::simplex_share } -> std::convertible_to<double>;
  { !Dim<D>::has_plane_stress && !Dim<D>::can_revolve } -> std::same_as<bool>;
  requires(Dim<D>::corners == D + 1 && Dim<D>::face_corners == D);
  { Dim<D>::embed(M) } -> std::convertible_to<Mat<double, 3>>;
  { Dim<D>::cofactor(M) } -> std::same_as<Mat<double, D>>;
  { Dim<D>::volume_change(M) } -> std::same_as<double>;
  { Dim<D>::face_normal(corners) } -> std::same_as<Vec<double, D>>;
  { Dim<D>::out_of_plane_share(corners[0]) } -> std::same_as<double>;
};

}  // namespace fissure
