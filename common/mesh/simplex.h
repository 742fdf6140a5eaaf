// Geometry of a simplex of d + 1 corners in d dimensions, written once for triangles and tetrahedra: its edges from
// corner 0, with unit vectors along the axes it does not span, are a 3x3 matrix whose determinant is d! times its
// measure.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "mesh/mesh.h"

namespace fissure::mesh {

struct Simplex {
  int corners = 3;
  std::array<Vec3, 4> point;

  /// `corner`: the node numbers of its corners.
  Simplex(std::span<int const> corner, std::vector<Vec3> const& nodes) : corners(static_cast<int>(corner.size())) {
    for (int a = 0; a < corners; ++a) point[a] = nodes[corner[a]];
  }

  Eigen::Matrix3d edges() const {
    Eigen::Matrix3d e = Eigen::Matrix3d::Identity();
    for (int a = 1; a < corners; ++a) e.col(a - 1) = point[a] - point[0];
    return e;
  }

  /// (d - 1)!: a face's vector is the cofactor divided by it.
  double face_factor() const { return corners - 2; }

  /// Area [m^2] or volume [m^3]; negative when the corners turn the wrong way.
  double measure() const { return edges().determinant() / (face_factor() * (corners - 1)); }

  Vec3 centroid() const {
    Vec3 sum = Vec3::Zero();
    for (int a = 0; a < corners; ++a) sum += point[a];
    return sum / corners;
  }

  double longest_edge() const {
    double longest = 0;
    for (int a = 0; a < corners; ++a)
      for (int b = 0; b < a; ++b) longest = std::max(longest, (point[a] - point[b]).norm());
    return longest;
  }

  /// Least distance of a corner from the face opposite to it [m]: the stable time step goes with it.
  double altitude() const {
    double largest = 0;
    for (int a = 0; a < corners; ++a) largest = std::max(largest, face_vector(a).norm());
    return (corners - 1) * std::abs(measure()) / largest;
  }

  /// Outward normal of the face opposite to corner a, as long as the face is large [m or m^2].
  Vec3 face_vector(int a) const {
    Eigen::Matrix3d const c = cofactors(edges());
    Vec3 sum = Vec3::Zero();
    for (int b = 1; b < corners; ++b) sum += c.col(b - 1);
    return (a == 0 ? sum : Vec3(-c.col(a - 1))) / face_factor();
  }

  /// Radius ratio d * inradius / circumradius: 1 when regular, 0 when flat.
  double shape() const {
    Eigen::Matrix3d const e = edges(), c = cofactors(e);
    double const det = e.determinant();
    Vec3 sum = Vec3::Zero(), center = Vec3::Zero();  // center: circumcentre from corner 0, times det
    double faces = 0;
    for (int i = 0; i < corners - 1; ++i) {
      sum += c.col(i);
      center += 0.5 * e.col(i).squaredNorm() * c.col(i);
      faces += c.col(i).norm();
    }
    double const below = (faces + sum.norm()) * center.norm();
    return below > 0 ? (corners - 1) * det * det / below : 0;
  }

 private:
  static Eigen::Matrix3d cofactors(Eigen::Matrix3d const& e) {
    Eigen::Matrix3d c;
    c << e.col(1).cross(e.col(2)), e.col(2).cross(e.col(0)), e.col(0).cross(e.col(1));
    return c;
  }
};

/// Distance of a point from a segment or triangle (C. Ericson, Real-Time Collision Detection, 2005, sec. 5.1).
inline double distance(Vec3 const& p, Vec3 const& a, Vec3 const& b) {
  Vec3 const along = b - a;
  return (a + std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0) * along - p).norm();
}
inline double distance(Vec3 const& p, Vec3 const& a, Vec3 const& b, Vec3 const& c) {
  Vec3 const normal = (b - a).cross(c - a), foot = p - normal * ((p - a).dot(normal) / normal.squaredNorm());
  bool const within = (b - a).cross(foot - a).dot(normal) >= 0 && (c - b).cross(foot - b).dot(normal) >= 0 &&
                      (a - c).cross(foot - c).dot(normal) >= 0;
  return within ? (foot - p).norm() : std::min({distance(p, a, b), distance(p, b, c), distance(p, c, a)});
}

/// Corners of the face opposite to corner a, ordered so that its normal points outward.
inline std::span<int const> face_corners(int corners, int a) {
  static constexpr int triangle[3][2] = {{1, 2}, {2, 0}, {0, 1}};
  static constexpr int tetrahedron[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  if (corners == node_count(CellKind::triangle)) return triangle[a];
  return tetrahedron[a];
}

}  // namespace fissure::mesh
