// Shapes in three dimensions as solids of OpenCASCADE.
#include "shapes.h"

#if defined(FISSURE_GMSH)
#include <gmsh.h>

#include <cmath>

namespace fissure::mesh {
namespace {

namespace occ = gmsh::model::occ;

/// A closed line through the points at height z.
int closed_line(std::vector<std::array<double, 2>> const& corners, double z) {
  std::vector<int> points, lines;
  for (auto const& [x, y] : corners) points.push_back(occ::addPoint(x, y, z));
  for (std::size_t i = 0; i < points.size(); ++i)
    lines.push_back(occ::addLine(points[i], points[(i + 1) % points.size()]));
  return occ::addCurveLoop(lines);
}

/// A circle in the plane of u and v as four quarters, so that nodes lie exactly at its extremes, where plates touch.
int circle(Vec3 const& c, Vec3 const& u, Vec3 const& v) {
  auto const point = [](Vec3 const& p) { return occ::addPoint(p.x(), p.y(), p.z()); };
  int const middle = point(c);
  int const compass[4] = {point(c + u), point(c + v), point(c - u), point(c - v)};
  std::vector<int> arcs;
  for (int i = 0; i < 4; ++i) arcs.push_back(occ::addCircleArc(compass[i], middle, compass[(i + 1) % 4]));
  return occ::addCurveLoop(arcs);
}

/// The solid that the surface within the loops (the first outside, then holes) sweeps.
int extruded(std::vector<int> const& loops, Vec3 const& along) {
  gmsh::vectorpair swept;
  occ::extrude({{2, occ::addPlaneSurface(loops)}}, along.x(), along.y(), along.z(), swept);
  for (auto const& [dimension, tag] : swept)
    if (dimension == 3) return tag;
  throw std::string("extrusion gave no solid");
}

class Drawer3d final : public Drawer {
 public:
  /// The serial Delaunay method, not HXT: that one is three times as fast, but gives another mesh every time.
  /// Optimising all but good cells (Gmsh's own threshold is 0.3) lifts the mean radius ratio of a ball from 0.79 to
  /// 0.84.
  int attempts() const override { return 4; }
  void choose_algorithms(int attempt) const override {
    gmsh::option::setNumber("Mesh.Algorithm", attempt % 2 ? 1 : 5);  // of the surface; 1: MeshAdapt, the most forgiving
    gmsh::option::setNumber("Mesh.OptimizeNetgen", attempt >= 2);    // slower
    gmsh::option::setNumber("Mesh.Algorithm3D", 1);
    gmsh::option::setNumber("Mesh.OptimizeThreshold", 0.7);
  }

  int add(scene::Box const& box, Source const& at) const override {
    require_finite(box.center, "box", at);
    for (int axis : {0, 1, 2}) require_positive(box.size[axis], "box", "size", at);
    Vec3 const low = box.center - box.size / 2;
    return occ::addBox(low.x(), low.y(), low.z(), box.size.x(), box.size.y(), box.size.z());
  }
  int add(scene::Disc const& disc, Source const& at) const override {
    require_finite(disc.center, "disc", at);
    require_positive(disc.radius, "disc", "radius", at);
    require_positive(disc.thickness, "disc", "thickness", at);
    double const r = disc.radius;
    Vec3 const along(0, 0, disc.thickness);
    return extruded({circle(disc.center - along / 2, {r, 0, 0}, {0, r, 0})}, along);
  }
  int add(scene::Rod const& rod, Source const& at) const override {
    require_finite(rod.center, "rod", at);
    require_positive(rod.radius, "rod", "radius", at);
    require_positive(rod.length, "rod", "length", at);
    double const r = rod.radius;
    int const lower = circle(rod.center, {0, 0, r}, {r, 0, 0});
    if (!(rod.end_radius > 0)) return extruded({lower}, {0, rod.length, 0});
    double const end = rod.end_radius;
    gmsh::vectorpair swept;
    occ::addThruSections({lower, circle(rod.center + Vec3(0, rod.length, 0), {0, 0, end}, {end, 0, 0})}, swept, -1,
                         true, true);
    for (auto const& [dimension, tag] : swept)
      if (dimension == 3) return tag;
    throw std::string("the tapered rod gave no solid");
  }
  int add(scene::Ball const& ball, Source const& at) const override {
    require_finite(ball.center, "ball", at);
    require_positive(ball.radius, "ball", "radius", at);
    Vec3 const& c = ball.center;
    int const tag = occ::addSphere(c.x(), c.y(), c.z(), ball.radius);
    occ::rotate({{3, tag}}, c.x(), c.y(), c.z(), 1, 0, 0, -std::acos(0.0));  // its poles to the bottom and the top
    return tag;
  }
  int add(scene::Ring const& ring, Source const& at) const override {
    require_ring(ring, at);
    require_positive(ring.thickness, "ring", "thickness", at);
    Vec3 const along(0, 0, ring.thickness), back = ring.center - along / 2;
    int const outer = circle(back, {ring.outer, 0, 0}, {0, ring.outer, 0});
    return extruded({outer, circle(back, {ring.inner, 0, 0}, {0, ring.inner, 0})}, along);
  }
  int add(scene::Polygon const& polygon, Source const& at) const override {
    auto const corners = polygon_corners(polygon, at);
    require_positive(polygon.thickness, "polygon", "thickness", at);
    return extruded({closed_line(corners, -polygon.thickness / 2)}, {0, 0, polygon.thickness});
  }
  int add(scene::Revolved const& revolved, Source const& at) const override {
    int const section = occ::addPlaneSurface({closed_line(section_corners(revolved, at), 0)});
    gmsh::vectorpair swept;
    occ::revolve({{2, section}}, 0, 0, 0, 0, 1, 0, 4 * std::acos(0.0), swept);
    for (auto const& [dimension, tag] : swept)
      if (dimension == 3) return tag;
    throw std::string("revolution gave no solid");
  }
  int add(scene::Notch const& notch, double back, double front, Source const& at) const override {
    auto const corners = notch_corners(notch, at);
    double const beyond = front - back;  // faces of the slot and of the body must not coincide
    return extruded({closed_line({corners.begin(), corners.end()}, back - beyond)}, {0, 0, 3 * beyond});
  }
  int add(scene::Seam const& seam, double back, double front, Source const& at) const override {
    require_seam(seam, at);
    double const low = back - (front - back), high = front + (front - back);
    auto const& [from, to] = std::pair(seam.from, seam.to);
    std::vector<std::array<double, 3>> corners = seam.corners;
    if (corners.empty())
      corners = {{from[0], from[1], low}, {to[0], to[1], low}, {to[0], to[1], high}, {from[0], from[1], high}};
    std::vector<int> points, lines;
    for (auto const& [x, y, z] : corners) points.push_back(occ::addPoint(x, y, z));
    for (std::size_t i = 0; i < points.size(); ++i)
      lines.push_back(occ::addLine(points[i], points[(i + 1) % points.size()]));
    return occ::addPlaneSurface({occ::addCurveLoop(lines)});
  }
};

}  // namespace

Drawer const* drawer_3d() {
  static Drawer3d const drawer;
  return &drawer;
}

}  // namespace fissure::mesh
#else

namespace fissure::mesh {
Drawer const* drawer_3d() { return nullptr; }
}  // namespace fissure::mesh
#endif
