// Shapes in two dimensions as surfaces of OpenCASCADE.
#include "shapes.h"

#if defined(FISSURE_GMSH)
#include <fmt/format.h>
#include <gmsh.h>

namespace fissure::mesh {
namespace {

namespace occ = gmsh::model::occ;

/// A closed line through the points.
int closed_line(std::vector<std::array<double, 2>> const& corners) {
  std::vector<int> points, lines;
  for (auto const& [x, y] : corners) points.push_back(occ::addPoint(x, y, 0));
  for (std::size_t i = 0; i < points.size(); ++i)
    lines.push_back(occ::addLine(points[i], points[(i + 1) % points.size()]));
  return occ::addCurveLoop(lines);
}

/// A circle as four quarters, so that nodes lie exactly at its left, right, bottom and top, where plates touch.
int circle(Vec3 const& c, double r) {
  int const middle = occ::addPoint(c.x(), c.y(), 0);
  int const compass[4] = {occ::addPoint(c.x() + r, c.y(), 0), occ::addPoint(c.x(), c.y() + r, 0),
                          occ::addPoint(c.x() - r, c.y(), 0), occ::addPoint(c.x(), c.y() - r, 0)};
  std::vector<int> arcs;
  for (int i = 0; i < 4; ++i) arcs.push_back(occ::addCircleArc(compass[i], middle, compass[(i + 1) % 4]));
  return occ::addCurveLoop(arcs);
}

int rectangle(double x0, double y0, double x1, double y1) {
  return occ::addPlaneSurface({closed_line({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}})});
}

class Drawer2d : public Drawer {
 public:
  /// Delaunay, not the frontal method: that one fills discs and boxes with a lattice of equilateral triangles, along
  /// whose three directions cracks would run.
  int attempts() const override { return 2; }
  void choose_algorithms(int attempt) const override {
    gmsh::option::setNumber("Mesh.Algorithm", attempt == 0 ? 5 : 1);  // 5: Delaunay; 1: MeshAdapt, the most forgiving
  }

  int add(scene::Box const& box, Source const& at) const override {
    require_finite(box.center, "box", at);
    for (int axis : {0, 1}) require_positive(box.size[axis], "box", "size", at);
    Vec3 const low = box.center - box.size / 2, high = box.center + box.size / 2;
    return rectangle(low.x(), low.y(), high.x(), high.y());
  }
  int add(scene::Disc const& disc, Source const& at) const override {
    require_finite(disc.center, "disc", at);
    require_positive(disc.radius, "disc", "radius", at);
    return occ::addPlaneSurface({circle(disc.center, disc.radius)});
  }
  int add(scene::Rod const& rod, Source const& at) const override {
    require_finite(rod.center, "rod", at);
    require_positive(rod.radius, "rod", "radius", at);
    require_positive(rod.length, "rod", "length", at);
    Vec3 const& base = rod.center;
    double const end = rod.end_radius > 0 ? rod.end_radius : rod.radius, top = base.y() + rod.length;
    return occ::addPlaneSurface({closed_line({{base.x() - rod.radius, base.y()},
                                              {base.x() + rod.radius, base.y()},
                                              {base.x() + end, top},
                                              {base.x() - end, top}})});
  }
  int add(scene::Ball const& ball, Source const& at) const override {
    require_finite(ball.center, "ball", at);
    require_positive(ball.radius, "ball", "radius", at);
    return occ::addPlaneSurface({circle(ball.center, ball.radius)});
  }
  int add(scene::Ring const& ring, Source const& at) const override {
    require_ring(ring, at);
    int const outer = circle(ring.center, ring.outer);
    return occ::addPlaneSurface({outer, circle(ring.center, ring.inner)});
  }
  int add(scene::Polygon const& polygon, Source const& at) const override {
    return occ::addPlaneSurface({closed_line(polygon_corners(polygon, at))});
  }
  int add(scene::Revolved const& revolved, Source const& at) const override {
    return occ::addPlaneSurface({closed_line(section_corners(revolved, at))});
  }
  int add(scene::Notch const& notch, double, double, Source const& at) const override {
    auto const corners = notch_corners(notch, at);
    return occ::addPlaneSurface({closed_line({corners.begin(), corners.end()})});
  }
  int add(scene::Seam const& seam, double, double, Source const& at) const override {
    require_seam(seam, at);
    return occ::addLine(occ::addPoint(seam.from[0], seam.from[1], 0), occ::addPoint(seam.to[0], seam.to[1], 0));
  }
};

/// Sections of bodies of revolution about the y axis, at x >= 0: half of a rod and of a ball, which stand on it. Other
/// shapes are taken as they are drawn, but for those whose own axis is z.
class AxisymmetricDrawer final : public Drawer2d {
 public:
  using Drawer2d::add;

  int add(scene::Rod const& rod, Source const& at) const override {
    int const whole = Drawer2d::add(rod, at);
    require_axis(rod.center, "rod", at);
    return right_half(whole, std::max(rod.radius, rod.end_radius), rod.center.y(), rod.center.y() + rod.length);
  }
  int add(scene::Ball const& ball, Source const& at) const override {
    int const whole = Drawer2d::add(ball, at);
    require_axis(ball.center, "ball", at);
    return right_half(whole, ball.radius, ball.center.y() - ball.radius, ball.center.y() + ball.radius);
  }
  int add(scene::Disc const&, Source const& at) const override {
    throw Error(at,
                "disc: with two_d = \"axisymmetric\" everything turns about y, and a disc's axis is z; write rod{ "
                "radius, length }");
  }
  int add(scene::Ring const&, Source const& at) const override {
    throw Error(at,
                "ring: with two_d = \"axisymmetric\" everything turns about y, and a ring's axis is z; write "
                "difference{ rod{...}, rod{...} }, or a box at x > 0");
  }

 private:
  static void require_axis(Vec3 const& center, char const* shape, Source const& at) {
    if (center.x() != 0)
      throw Error(
          at, fmt::format(
                  "{}: with two_d = \"axisymmetric\" it stands on the axis (its center is at x = {:g} m); leave x at 0",
                  shape, center.x()));
  }
  static int right_half(int whole, double radius, double bottom, double top) {
    double const margin = top - bottom + radius;
    gmsh::vectorpair half;
    std::vector<gmsh::vectorpair> origin;
    occ::cut({{2, whole}}, {{2, rectangle(-2 * radius, bottom - margin, 0, top + margin)}}, half, origin);
    return half.at(0).second;
  }
};

}  // namespace

Drawer const* drawer_2d() {
  static Drawer2d const drawer;
  return &drawer;
}
Drawer const* axisymmetric_drawer() {
  static AxisymmetricDrawer const drawer;
  return &drawer;
}

}  // namespace fissure::mesh
#else

namespace fissure::mesh {
Drawer const* drawer_2d() { return nullptr; }
Drawer const* axisymmetric_drawer() { return nullptr; }
}  // namespace fissure::mesh
#endif
