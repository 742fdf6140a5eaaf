// Regular meshes of blocks for what is round: a square (cube) in the middle, bulged, and layers of blocks from its
// sides to the circle (sphere), an O-grid; rings; and both drawn out along an axis.
#include <algorithm>
#include <cmath>

#include "mesh/block.h"
#include "mesh/mesher.h"
#include "mesh/part.h"

namespace fissure::mesh {

namespace {

double const pi = std::acos(-1.0);

int whole(double number, int least) { return std::max(least, static_cast<int>(std::lround(number))); }

using Place = std::array<int, 3>;

/// The cells of unit_ball(): those of its core, n along each axis, and `layers` of them on each of its sides.
/// node(place in the core, layer) is the node there.
template <class Node>
void join(int axes, int n, int layers, Node const& node, std::vector<int>& blocks) {
  auto const corners = 1 << axes;
  auto const add = [&](auto const& corner) {
    for (int a = 0; a < corners; ++a) blocks.push_back(corner(a));
  };
  auto const up = [](int a, int axis) { return BlockShape<3>::sign(a, axis) > 0 ? 1 : 0; };
  for (int k = 0; k < (axes == 3 ? n : 1); ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        add([&](int a) { return node({i + up(a, 0), j + up(a, 1), axes == 3 ? k + up(a, 2) : 0}, 0); });
  // Each side of the core: its cells, layer by layer; the block's last axis leads outwards.
  for (int normal = 0; normal < axes; ++normal)
    for (int side : {0, n})
      for (int k = 0; k < (axes == 3 ? n : 1); ++k)
        for (int j = 0; j < n; ++j)
          for (int l = 0; l < layers; ++l)
            add([&](int a) {
              Place at{0, 0, 0};
              at[normal] = side;
              at[(normal + 1) % axes] = j + up(a, 0);
              if (axes == 3) at[(normal + 2) % axes] = k + up(a, 1);
              return node(at, l + up(a, axes - 1));
            });
}

/// A disc (2 axes) or ball (3) of radius 1 about the origin with edges of about `size` on its surface. The core reaches
/// 0.6 of the radius along the axes; the number of its cells is even, so that nodes lie at the extremes.
Part unit_ball(int axes, double size) {
  int const n = 2 * whole(pi / 4 / size, 1), layers = whole(0.35 / size, 1);
  double const core = 0.6, bulge = 0.6;
  int const row = n + 1;
  auto const number = [&](Place const& at) { return at[0] + row * (at[1] + row * at[2]); };
  auto const outer = [&](Place const& at) {
    return std::any_of(at.begin(), at.begin() + axes, [&](int i) { return i == 0 || i == n; });
  };
  auto const inside = [&](Place const& at) {  // squares and cubes to round ones, where bulge is 1
    Vec3 s = Vec3::Zero(), p;
    for (int x = 0; x < axes; ++x) s[x] = 2.0 * at[x] / n - 1;
    for (int x = 0; x < 3; ++x) {
      double const b = bulge * s[(x + 1) % 3] * s[(x + 1) % 3], c = bulge * s[(x + 2) % 3] * s[(x + 2) % 3];
      p[x] = core * s[x] * std::sqrt(1 - (b + c) / 2 + b * c / 3);
    }
    return p;
  };
  auto const surface = [&](Place const& at) {  // equal angles
    Vec3 p = Vec3::Zero();
    for (int x = 0; x < axes; ++x) p[x] = std::tan(pi / 4 * (2.0 * at[x] / n - 1));
    return Vec3(p.normalized());
  };

  Part part;
  std::vector<std::array<int, 2>> columns;  // by place: the node inside, and the first of those outwards from it
  int const deep = axes == 3 ? n : 0;
  for (int k = 0; k <= deep; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        Place const at{i, j, k};
        Vec3 const from = inside(at);
        int const first = static_cast<int>(part.nodes.size());
        part.nodes.push_back(from);
        columns.push_back({first, first + 1});
        for (int l = 1; outer(at) && l <= layers; ++l)
          part.nodes.push_back(from + (surface(at) - from) * (static_cast<double>(l) / layers));
      }
  auto const node = [&](Place const& at, int layer) {
    return layer == 0 ? columns[number(at)][0] : columns[number(at)][1] + layer - 1;
  };

  join(axes, n, layers, node, part.blocks);
  return part;
}

/// A ring between the radii, in the plane.
Part flat_ring(double inner, double outer, double size) {
  int const around = 4 * whole(pi * (inner + outer) / 4 / size, 2), across = whole((outer - inner) / size, 1);
  Part part;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j <= across; ++j) {
      double const angle = 2 * pi * i / around, r = inner + (outer - inner) * j / across;
      part.nodes.push_back({r * std::cos(angle), r * std::sin(angle), 0});
    }
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      int const here = i * (across + 1) + j, next = (i + 1) % around * (across + 1) + j;
      part.blocks.insert(part.blocks.end(), {here, here + 1, next + 1, next});
    }
  return part;
}

/// Quadrilaterals drawn out to hexahedra: place(p, s) is where point p of the section lies at the share s of the way.
template <class F>
Part drawn_out(Part const& section, int layers, F&& place) {
  Part part;
  int const n = static_cast<int>(section.nodes.size());
  for (int l = 0; l <= layers; ++l)
    for (auto const& p : section.nodes) part.nodes.push_back(place(p, static_cast<double>(l) / layers));
  for (int l = 0; l < layers; ++l)
    for (std::size_t b = 0; b < section.blocks.size(); b += 4)
      for (int end : {0, 1})
        for (int a = 0; a < 4; ++a) part.blocks.push_back(section.blocks[b + a] + (l + end) * n);
  return part;
}

Part moved(Part part, double scale, Vec3 const& by) {
  for (auto& p : part.nodes) p = scale * p + by;
  return part;
}

/// `half`: of its section, which turns about y.
Part rod_part(scene::Rod const& rod, CellKind kind, bool half, double size) {
  double const end = rod.end_radius > 0 ? rod.end_radius : rod.radius;
  auto const radius = [&](double s) { return rod.radius + (end - rod.radius) * s; };
  int const along = whole(rod.length / size, 1);
  if (kind == CellKind::triangle) {
    double const width = half ? 1 : 2;
    Part part = structured_part(kind, {half ? 0.5 : 0, 0.5, 0}, {width, 1, 0},
                                {whole(width * rod.radius / size, 1), along, 0}, true);
    for (auto& p : part.nodes) p = {rod.center.x() + p.x() * radius(p.y()), rod.center.y() + rod.length * p.y(), 0};
    return part;
  }
  // The section's y looks to -z, so that the rod's axis, the section's normal, is y.
  return drawn_out(unit_ball(2, size / rod.radius), along, [&](Vec3 const& p, double s) {
    return Vec3(rod.center.x() + p.x() * radius(s), rod.center.y() + rod.length * s,
                rod.center.z() - p.y() * radius(s));
  });
}

}  // namespace

std::optional<Part> block_part(scene::Body const& body, Mesher const& mesher) {
  CellKind const kind = mesher.kind();
  Source const& at = body.shape.source.file.empty() ? body.source : body.shape.source;
  bool const flat = kind == CellKind::triangle;
  double const size = body.mesh.size;
  auto const refuse_many = [&](double measure) {
    refuse_too_many(2 * measure / std::pow(size, flat ? 2 : 3), body, flat ? 2 : 3);
  };
  auto const along_z = [&](Part const& section, double scale, Vec3 const& center, double thickness) {
    return drawn_out(section, whole(thickness / size, 1), [&](Vec3 const& p, double s) {
      return Vec3(center.x() + scale * p.x(), center.y() + scale * p.y(), center.z() + thickness * (s - 0.5));
    });
  };
  bool const half = mesher.revolves();  // of a section that turns about y
  if (half && !std::holds_alternative<scene::Rod>(body.shape.is)) return std::nullopt;
  if (auto const* disc = std::get_if<scene::Disc>(&body.shape.is)) {
    require_finite(disc->center, "disc", at);
    require_positive(disc->radius, "disc", "radius", at);
    if (!flat) require_positive(disc->thickness, "disc", "thickness", at);
    refuse_many(pi * disc->radius * disc->radius * (flat ? 1 : disc->thickness));
    Part section = unit_ball(2, size / disc->radius);
    if (flat) return moved(std::move(section), disc->radius, {disc->center.x(), disc->center.y(), 0});
    return along_z(section, disc->radius, disc->center, disc->thickness);
  }
  if (auto const* ball = std::get_if<scene::Ball>(&body.shape.is)) {
    require_finite(ball->center, "ball", at);
    require_positive(ball->radius, "ball", "radius", at);
    refuse_many(4 * std::pow(ball->radius, flat ? 2 : 3));
    Vec3 center = ball->center;
    if (flat) center.z() = 0;
    return moved(unit_ball(flat ? 2 : 3, size / ball->radius), ball->radius, center);
  }
  if (auto const* ring = std::get_if<scene::Ring>(&body.shape.is)) {
    require_ring(*ring, at);
    if (!flat) require_positive(ring->thickness, "ring", "thickness", at);
    refuse_many(pi * (ring->outer * ring->outer - ring->inner * ring->inner) * (flat ? 1 : ring->thickness));
    Part section = flat_ring(ring->inner, ring->outer, size);
    if (flat) return moved(std::move(section), 1, {ring->center.x(), ring->center.y(), 0});
    return along_z(section, 1, ring->center, ring->thickness);
  }
  if (auto const* rod = std::get_if<scene::Rod>(&body.shape.is)) {
    require_finite(rod->center, "rod", at);
    require_positive(rod->radius, "rod", "radius", at);
    require_positive(rod->length, "rod", "length", at);
    refuse_many((flat ? 2 * rod->radius : pi * rod->radius * rod->radius) * rod->length);
    if (half && rod->center.x() != 0) return std::nullopt;  // refused where it is drawn
    return rod_part(*rod, kind, half, size);
  }
  return std::nullopt;
}

}  // namespace fissure::mesh
