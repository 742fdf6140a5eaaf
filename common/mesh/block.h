// Geometry of a block, a quadrilateral or hexahedron with d-linear shape functions, on the host.
#pragma once
#include <span>

#include "base/block_shape.h"
#include "mesh/mesh.h"

namespace fissure::mesh {

struct Block {
  int axes = 2;
  std::array<Vec3, 8> point;

  /// `corner`: the node numbers of its corners.
  Block(std::span<int const> corner, std::vector<Vec3> const& nodes) : axes(corner.size() == 4 ? 2 : 3) {
    for (int a = 0; a < corners(); ++a) point[a] = nodes[corner[a]];
  }

  int corners() const { return 1 << axes; }
  static int sign(int a, int axis) { return BlockShape<3>::sign(a, axis); }

  /// dX/dxi at the local coordinates xi in -1..1; a unit vector along the axis that it does not have.
  Eigen::Matrix3d jacobian(Vec3 const& xi) const {
    Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
    for (int axis = axes; axis < 3; ++axis) J(axis, axis) = 1;
    for (int a = 0; a < corners(); ++a)
      for (int axis = 0; axis < axes; ++axis) J.col(axis) += point[a] * slope(a, axis, xi);
    return J;
  }
  /// dN_a/dxi_axis
  double slope(int a, int axis, Vec3 const& xi) const {
    double product = 0.5 * sign(a, axis);
    for (int other = 0; other < axes; ++other)
      if (other != axis) product *= 0.5 * (1 + sign(a, other) * xi[other]);
    return product;
  }
  double shape_function(int a, Vec3 const& xi) const {
    double product = 1;
    for (int axis = 0; axis < axes; ++axis) product *= 0.5 * (1 + sign(a, axis) * xi[axis]);
    return product;
  }
  /// Local coordinates of corner a, times `share`: 1/sqrt(3) gives the Gauss point next to it.
  Vec3 local(int a, double share = 1) const {
    Vec3 xi = Vec3::Zero();
    for (int axis = 0; axis < axes; ++axis) xi[axis] = share * sign(a, axis);
    return xi;
  }
  static double gauss() { return BlockShape<3>::point(1, 0); }

  /// Area [m^2] or volume [m^3], exactly.
  double measure() const {
    double sum = 0;
    for (int p = 0; p < corners(); ++p) sum += jacobian(local(p, gauss())).determinant();
    return sum;
  }
  Vec3 centroid() const {
    Vec3 sum = Vec3::Zero();
    for (int a = 0; a < corners(); ++a) sum += point[a] / corners();
    return sum;
  }
  /// Least Jacobian at a corner over the lengths of its edges: 1 for a box, 0 or less where it is folded.
  double shape() const {
    double least = 1;
    for (int a = 0; a < corners(); ++a) {
      Eigen::Matrix3d J = jacobian(local(a));
      for (int axis = 0; axis < axes; ++axis) J.col(axis).normalize();
      least = std::min(least, J.determinant());
    }
    return least;
  }
  /// Length of the edge from corner a along an axis.
  double edge(int a, int axis) const { return 2 * jacobian(local(a)).col(axis).norm(); }
  /// Height over its largest face, about: the stable time step goes with it.
  double altitude() const {
    Eigen::Matrix3d const J = jacobian(Vec3::Zero());
    return 2 / std::sqrt(J.inverse().topRows(axes).rowwise().squaredNorm().maxCoeff());
  }
};

/// Parts of a block: the cone of its corner with the lowest number over the faces that do not have it, each of them cut
/// along the diagonal from its own lowest corner, so that neighbours cut a face alike (after Dompierre et al., "How to
/// subdivide pyramids, prisms and hexahedra into tetrahedra", 8th International Meshing Roundtable, 1999). Node
/// numbers, block_parts x node_count.
std::vector<int> parts_of(std::span<int const> corner);

}  // namespace fissure::mesh
