// The contract that src2d and src3d fulfil: everything in which the dimensions differ. Nothing in common/ asks for D's value.
//
//   Dim<D>::name                     "2D", "3D"; ::program "fissure2d", "fissure3d"
//   Dim<D>::corners, face_corners    of a simplex: D + 1 and D
//   Dim<D>::embed(Mat<S,D>)          displacement gradient as 3x3: plane strain pads with zero
//   Dim<D>::face_normal(points)      unit-free normal of D points: the edge turned, the cross product halved; its length is the measure
//   Dim<D>::slip_out_of_plane(s, n)  squared part of a slip that is mode III
//   Dim<D>::clip(...)                integral of a linear function over a face cut by a simplex (src?d/clip.h)
//   Dim<D>::plate_faces(box)         faces of a rigid box as convex polygons of Dim<D>::plate_face_corners points
//   Dim<D>::mesher()                 shapes as the mesher builds them (src?d/shapes.cpp)
#pragma once

namespace fissure {

template <int D>
struct Dim;

}  // namespace fissure
