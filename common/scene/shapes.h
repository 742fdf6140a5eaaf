// Shapes as plain data: where a body is.
#pragma once
#include <array>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "base/algebra.h"
#include "base/error.h"

namespace fissure::scene {

// [m]; 2D ignores z
struct Box {
  Vec3 center{0, 0, 0};
  Vec3 size{0, 0, 0};
};
// 3D: cylinder along z, mid-plane at center
struct Disc {
  Vec3 center{0, 0, 0};
  double radius = 0, thickness = 0;
};
// along y; base at center.y; 2D: lengthwise section; end_radius 0: as radius
struct Rod {
  Vec3 center{0, 0, 0};
  double radius = 0, length = 0, end_radius = 0;
};
// 2D: its middle section (axisymmetric: half of it, as of a rod)
struct Ball {
  Vec3 center{0, 0, 0};
  double radius = 0;
};
// 3D: hollow cylinder along z
struct Ring {
  Vec3 center{0, 0, 0};
  double inner = 0, outer = 0, thickness = 0;
};
// counter-clockwise; 3D: extruded, mid-plane z = 0
struct Polygon {
  std::vector<std::array<double, 2>> points;
  double thickness = 0;
};
// a slot through the whole thickness, to be taken away
struct Notch {
  std::array<double, 2> from{}, to{};
  double width = 0;
};
// a section at x >= 0, turned once about the y axis; 2D: the section and its mirror image (axisymmetric: the section)
struct Revolved {
  std::vector<std::array<double, 2>> points;  // counter-clockwise
};
// Gmsh .msh; physical groups become names
struct MeshFile {
  std::string path;
};

struct Shape;
struct Union {
  std::vector<Shape> parts;
};
// the first minus all others
struct Difference {
  std::vector<Shape> parts;
};

// moved, turned, mirrored or scaled
struct Placed {
  enum class How { moved, turned, mirrored, scaled };

  How how = How::moved;
  std::vector<Shape> part;  // one
  Vec3 by{0, 0, 0};         // how far [m]; the axis and the normal, of length 1; factors
  Vec3 about{0, 0, 0};      // a point that stays, but where it is moved [m]
  double angle = 0;         // turned, the right-handed way [rad]

  Mat<double, 3> map() const {
    switch (how) {
      case How::moved:
        return Mat<double, 3>::Identity();
      case How::mirrored:
        return Mat<double, 3>::Identity() - 2 * by * by.transpose();
      case How::scaled:
        return by.asDiagonal();
      case How::turned:
        break;
    }
    Mat<double, 3> cross;  // Rodrigues' formula
    cross << 0, -by[2], by[1], by[2], 0, -by[0], -by[1], by[0], 0;
    return Mat<double, 3>::Identity() + std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
  }
  /// Where a point of the part comes to lie [m].
  Vec3 operator()(Vec3 const& x) const { return how == How::moved ? Vec3(x + by) : Vec3(map() * (x - about) + about); }
};

struct Shape {
  std::variant<Box, Disc, Rod, Ball, Ring, Polygon, Revolved, Notch, MeshFile, Union, Difference, Placed> is;
  Source source;

  /// The mesh file that it is, as it stands there or placed; null: none.
  MeshFile const* mesh_file() const {
    if (auto const* placed = std::get_if<Placed>(&is)) return placed->part.at(0).mesh_file();
    return std::get_if<MeshFile>(&is);
  }
};

}  // namespace fissure::scene
