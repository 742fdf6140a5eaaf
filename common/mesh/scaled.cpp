// Bodies drawn larger or smaller.
#include "mesh/scaled.h"

#include <algorithm>
#include <cmath>

namespace fissure::mesh {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

double least_side(std::vector<std::array<double, 2>> const& points) {
  double length = INFINITY;
  for (std::size_t i = 1; i < points.size(); ++i)
    length = std::min(length, std::hypot(points[i][0] - points[i - 1][0], points[i][1] - points[i - 1][1]));
  return length;
}

/// The shortest length that a shape is given by [m].
double least_length(scene::Shape const& shape) {
  auto const least = [](auto const& parts) {
    double length = INFINITY;
    for (auto const& part : parts) length = std::min(length, least_length(part));
    return length;
  };
  return std::visit(
      Overloaded{[](scene::Box const& b) { return b.size[2] > 0 ? b.size.minCoeff() : std::min(b.size[0], b.size[1]); },
                 [](scene::Disc const& d) { return d.thickness > 0 ? std::min(d.radius, d.thickness) : d.radius; },
                 [](scene::Rod const& r) { return std::min(r.radius, r.length); },
                 [](scene::Ball const& b) { return b.radius; },
                 [](scene::Ring const& r) { return std::min(r.inner, r.outer - r.inner); },
                 [](scene::Polygon const& p) { return least_side(p.points); },
                 [](scene::Revolved const& r) { return least_side(r.points); },
                 [](scene::Notch const& n) { return n.width; }, [](scene::MeshFile const&) { return double(INFINITY); },
                 [&](scene::Union const& u) { return least(u.parts); },
                 [&](scene::Difference const& d) { return least(d.parts); },
                 [&](scene::Placed const& p) {
                   return least(p.part) * (p.how == scene::Placed::How::scaled ? p.by.minCoeff() : 1);
                 }},
      shape.is);
}

/// The shape times a factor.
scene::Shape scaled(scene::Shape shape, double f) {
  auto const point = [f](std::array<double, 2>& p) { p[0] *= f, p[1] *= f; };
  auto const parts = [f](auto& list) {
    for (auto& part : list) part = scaled(part, f);
  };
  std::visit(Overloaded{[f](scene::Box& b) { b.center *= f, b.size *= f; },
                        [f](scene::Disc& d) { d.center *= f, d.radius *= f, d.thickness *= f; },
                        [f](scene::Rod& r) { r.center *= f, r.radius *= f, r.length *= f, r.end_radius *= f; },
                        [f](scene::Ball& b) { b.center *= f, b.radius *= f; },
                        [f](scene::Ring& r) { r.center *= f, r.inner *= f, r.outer *= f, r.thickness *= f; },
                        [&](scene::Polygon& p) {
                          for (auto& corner : p.points) point(corner);
                          p.thickness *= f;
                        },
                        [&](scene::Revolved& r) {
                          for (auto& corner : r.points) point(corner);
                        },
                        [&](scene::Notch& n) { point(n.from), point(n.to), n.width *= f; }, [](scene::MeshFile&) {},
                        [&](scene::Union& u) { parts(u.parts); }, [&](scene::Difference& d) { parts(d.parts); },
                        [&](scene::Placed& p) {
                          parts(p.part), p.about *= f;
                          if (p.how == scene::Placed::How::moved) p.by *= f;
                        }},
             shape.is);
  return shape;
}

}  // namespace

double least_length(std::vector<scene::Body> const& bodies) {
  double least = INFINITY;
  for (auto const& body : bodies) {
    least = std::min({least, least_length(body.shape), body.mesh.size});
    for (auto const& near : body.mesh.near) least = std::min(least, near.size);
  }
  return least;
}

std::vector<scene::Body> scaled(std::vector<scene::Body> bodies, double f) {
  for (auto& body : bodies) {
    body.shape = scaled(body.shape, f);
    body.mesh.size *= f;
    for (auto& near : body.mesh.near) {
      for (auto* end : {&near.from, &near.to}) (*end)[0] *= f, (*end)[1] *= f;
      near.radius *= f, near.size *= f;
    }
    for (auto& seam : body.mesh.seams) {
      for (auto* end : {&seam.from, &seam.to}) (*end)[0] *= f, (*end)[1] *= f;
      for (auto& corner : seam.corners)
        for (double& x : corner) x *= f;
    }
  }
  return bodies;
}

}  // namespace fissure::mesh
