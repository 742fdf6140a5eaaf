// The plane of a polygon in space, and what lies inside of it.
#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "base/dim.h"

namespace fissure::mesh {

class Plane {
 public:
  /// Its normal by Newell's sum (Sutherland, Sproull & Schumacker 1974, doi 10.1145/356625.356626): right for corners
  /// that are not quite flat, too.
  explicit Plane(std::vector<std::array<double, 3>> const& corners) {
    for (auto const& [x, y, z] : corners) middle_ += Vec3(x, y, z) / static_cast<double>(corners.size());
    Vec3 area = Vec3::Zero(), before = corners.empty() ? middle_ : Vec3(corners.back().data()) - middle_;
    for (auto const& corner : corners) {
      Vec3 const now = Vec3(corner.data()) - middle_;
      area += before.cross(now) / 2, size_ = std::max(size_, now.norm()), before = now;
    }
    area_ = area.norm();
    flat_ = area_ > 1e-9 * size_ * size_;
    if (!flat_) return;
    normal_ = area.normalized();
    along_ = normal_.unitOrthogonal(), up_ = normal_.cross(along_);
    for (auto const& corner : corners) outline_.push_back(within(Vec3(corner.data())));
  }

  /// Whether the corners enclose an area at all.
  bool encloses() const { return flat_; }
  double area() const { return area_; }  // [m2]
  double size() const { return size_; }  // from its middle to the farthest corner [m]
  double off(Vec3 const& p) const { return std::abs((p - middle_).dot(normal_)); }
  std::array<double, 2> within(Vec3 const& p) const { return {(p - middle_).dot(along_), (p - middle_).dot(up_)}; }
  std::vector<std::array<double, 2>> const& outline() const { return outline_; }

  /// Whether a point of the plane lies inside of the polygon: a ray from it crosses an odd number of sides.
  bool inside(Vec3 const& p) const {
    auto const [x, y] = within(p);
    bool odd = false;
    for (std::size_t i = 0, j = outline_.size() - 1; i < outline_.size(); j = i++) {
      auto const [ax, ay] = outline_[i];
      auto const [bx, by] = outline_[j];
      if ((ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)) odd = !odd;
    }
    return odd;
  }

 private:
  Vec3 middle_ = Vec3::Zero(), normal_ = Vec3::Zero(), along_ = Vec3::Zero(), up_ = Vec3::Zero();
  double size_ = 0, area_ = 0;
  bool flat_ = false;
  std::vector<std::array<double, 2>> outline_;
};

}  // namespace fissure::mesh
