// Cells of a model, simplices and blocks: their shapes at rest, volumes, gradients and what they remember; a part of
// model.impl.h.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "model/model.h"

namespace fissure::model {

using kernels::blocked;
using kernels::layout_width;

/// Of a block at rest, with its corners at X.
template <int D>
struct BlockIntegrals {
  static constexpr int B = BlockShape<D>::corners;
  double volume = 0;                       // [m^3]
  std::array<double, B> share{}, hoop{};   // of each shape function, and of it over the radius
  std::array<Vec<double, D>, B> gradient;  // of its gradient
  std::array<Vec<double, D>, B> const& X;  // [m]

  BlockIntegrals(std::array<Vec<double, D>, B> const& X, Section const& section) : X(X) {
    gradient.fill(Vec<double, D>::Zero());
    for (int p = 0; p < BlockShape<D>::points; ++p) {
      Mat<double, D> const J = jacobian(p), inverse = J.inverse();
      double radius = 0;
      for (int a = 0; a < B; ++a) radius += BlockShape<D>::value(a, p) * X[a][0];
      double const w = J.determinant() * section.reach(radius);
      volume += w;
      for (int a = 0; a < B; ++a) {
        Vec<double, D> slope;
        for (int axis = 0; axis < D; ++axis) slope[axis] = BlockShape<D>::slope(a, axis, p);
        share[a] += w * BlockShape<D>::value(a, p);
        gradient[a] += w * (inverse.transpose() * slope);
        hoop[a] += w * BlockShape<D>::value(a, p) / radius;
      }
    }
  }
  Mat<double, D> jacobian(int p) const {
    Mat<double, D> J = Mat<double, D>::Zero();
    for (int a = 0; a < B; ++a)
      for (int axis = 0; axis < D; ++axis) J.col(axis) += X[a] * BlockShape<D>::slope(a, axis, p);
    return J;
  }
};

/// Shape at rest of every block and its mass: to each corner the integral of its shape function.
template <int D, class Real>
void Model<D, Real>::place_blocks(scene::Scene const& scene, Device& device) {
  using Number = kernels::BlockNumbers<D>;
  std::vector<Real> shapes;
  blocks.corner_volume.assign(static_cast<std::size_t>(blocks.count) * B, 0);
  for (auto& group : groups) {
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    double const density = material.density * scene.run.mass_scaling;
    Index const count = Number::count(group.integration, section.axisymmetric());
    group.shapes_at = shapes.size();
    shapes.resize(shapes.size() + static_cast<std::size_t>(group.blocks.padded) * count);
    for (Index b = group.blocks.first; b < group.blocks.first + group.blocks.padded; ++b) {
      Index const from = real_block(group, b);
      std::array<Vec<double, D>, B> X;
      for (int a = 0; a < B; ++a) X[a] = reference_of(blocks.host_vertex[blocked(from, a, B)]);
      BlockIntegrals<D> const integrals(X, section);
      for (int a = 0; a < B && from == b; ++a) {
        blocks.corner_volume[static_cast<std::size_t>(b) * B + a] = integrals.share[a];
        vertices.mass[blocks.host_vertex[blocked(b, a, B)]] += density * integrals.share[a];
      }
      put_block_shape(integrals, group.integration, material.elastic().young, [&](int k, double value) {
        shapes[group.shapes_at + blocked(b - group.blocks.first, k, count)] = static_cast<Real>(value);
      });
    }
  }
  blocks.shapes = Buffer<Real>(device, "block shapes", shapes);
  blocks.host_shapes = std::move(shapes);
}

/// What the kernels need of a block at rest: put(k, number).
template <int D, class Real>
template <class Put>
void Model<D, Real>::put_block_shape(BlockIntegrals<D> const& block, kernels::Integration how, double young,
                                     Put&& put) const {
  using Number = kernels::BlockNumbers<D>;
  using Shape = BlockShape<D>;
  auto const put_vector = [&](int k, Vec<double, D> const& x) {
    for (int c = 0; c < D; ++c) put(k + c, x[c]);
  };
  if (Number::points(how) > 1) {
    for (int a = 0; a < B; ++a) put_vector(Number::gradients + a * D, block.X[a]);
    return;
  }
  double squares = 0;
  for (int a = 0; a < B; ++a) {
    Vec<double, D> const gradient = block.gradient[a] / block.volume;
    put_vector(Number::gradients + a * D, gradient);
    squares += gradient.squaredNorm();
    if (section.axisymmetric()) put(Number::count(how, true) - B + a, block.hoop[a] / block.volume);
  }
  for (int m = 0; m < Shape::modes; ++m) {
    Vec<double, D> moment = Vec<double, D>::Zero();
    for (int a = 0; a < B; ++a) moment += Shape::mode(m, a) * block.X[a];
    put_vector(Number::moments + m * D, moment);
  }
  put(Number::volume, block.volume);
  if (how == kernels::Integration::one_point) {
    // A quarter to a third of what the mode's bending would take: a beam of four cells over its depth bends within
    // 5 %. Young's modulus, since that of confined strain would lock what is nearly incompressible.
    put(Number::springs, 0.25 * young * block.volume * squares / (B * B));
    return;
  }
  Mat<double, D> const J = block.jacobian(-1);
  for (int i = 0; i < D; ++i) {
    double const length = J.col(i).norm();
    put_vector(Number::axes + i * D, J.col(i) / (length * length * B));
    put(Number::lengths + i, length);
  }
}

/// How the area of a cell's face is shared among its corners, times D: alike for a simplex. Of a block's face, the
/// integral of each shape function over it, (A + T)/6 with T the area of the triangle at the corner: two parts
/// meet at a diagonal's ends and bring half of it each.
template <int D, class Real>
std::array<double, D> Model<D, Real>::corner_shares(mesh::Mesh const& mesh, int body, int cell,
                                                    std::array<int, D> const& nodes) const {
  std::array<double, D> shares;
  shares.fill(1);
  int const block = mesh.block_of(body, cell);
  if (block < 0 || B / 2 == Dim<D>::face_corners) return shares;  // the face of a block is that of one of its parts
  int const* const corner = &mesh.blocks[static_cast<std::size_t>(block) * B];
  std::array<int, D> local;
  for (int i = 0; i < D; ++i) local[i] = static_cast<int>(std::find(corner, corner + B, nodes[i]) - corner);
  auto const sign = [](int a, int axis) { return BlockShape<D>::sign(a, axis); };
  int normal = 0;  // the axis along which all of them lie on one side
  while (std::any_of(local.begin(), local.end(), [&](int a) { return sign(a, normal) != sign(local[0], normal); }))
    ++normal;
  auto const across = [&](int a, bool one, bool other) {  // the face's corner on the other side of a along its two axes
    for (int b = 0; b < B; ++b)
      if (sign(b, normal) == sign(a, normal) && (sign(b, (normal + 1) % D) != sign(a, (normal + 1) % D)) == one &&
          (sign(b, (normal + 2) % D) != sign(a, (normal + 2) % D)) == other)
        return b;
    return a;
  };
  auto const triangle = [&](int a) {
    Vec3 const x = mesh.nodes[corner[a]];
    return 0.5 * (mesh.nodes[corner[across(a, true, false)]] - x)
                     .cross(mesh.nodes[corner[across(a, false, true)]] - x)
                     .norm();
  };
  for (int i = 0; i < D; ++i) {
    int const opposite = across(local[i], true, true);
    bool const apex = std::find(local.begin(), local.end(), opposite) == local.end();
    double const whole = triangle(local[i]) + triangle(opposite);
    shares[i] = (apex ? 1 : 0.5) * (whole + triangle(local[i])) / 6;
  }
  // The part's own area is that of the triangle at its apex.
  for (int i = 0; i < D; ++i)
    if (std::find(local.begin(), local.end(), across(local[i], true, true)) == local.end())
      for (double& share : shares) share *= D / triangle(local[i]);
  return shares;
}

template <int D, class Real>
CellRange const& Simplices<D, Real>::range(Group const& group) {
  return group.simplices;
}
template <int D, class Real>
CellRange const& Blocks<D, Real>::range(Group const& group) {
  return group.blocks;
}

template <int D, class Real>
Index Simplices<D, Real>::vertex(Index cell, int a) const {
  return model_.vertex_of(cell, a);
}
template <int D, class Real>
Index Blocks<D, Real>::element(Index cell) const {
  return model_.part_of(group_of(cell), cell);
}
template <int D, class Real>
Index Blocks<D, Real>::vertex(Index cell, int a) const {
  return model_.blocks.host_vertex[blocked(cell, a, corners)];
}

template <int D, class Real>
Index Simplices<D, Real>::face_vertex(Index cell, int face, int i) const {
  return model_.face_vertex({cell, face}, i);
}
template <int D, class Real>
Index Simplices<D, Real>::across(Index cell, int face, int i) const {
  return model_.face_vertex(model_.neighbour({cell, face}), i);
}
template <int D, class Real>
Index Blocks<D, Real>::across(Index cell, int face, int i) const {
  for (FaceId const part : parts(cell, face))
    for (int j = 0; j < D; ++j)
      if (point(part, face, j) == i) return model_.face_vertex(model_.neighbour(part), j);
  return face_vertex(cell, face, i);
}

template <int D, class Real>
std::span<FaceId const> Blocks<D, Real>::parts(Index cell, int face) const {
  constexpr int K = Model<D, Real>::K;
  FaceId const* const first = &model_.interfaces.parts[(static_cast<std::size_t>(cell) * faces + face) * K];
  return {first, first->element < 0 ? 0u : static_cast<std::size_t>(K)};  // both of a hexahedron's or none
}
template <int D, class Real>
CellFace Blocks<D, Real>::face_of(FaceId part) const {
  for (int face = 0; face < faces; ++face) {
    int on_it = 0;
    for (int i = 0; i < D; ++i) on_it += point(part, face, i) >= 0;
    if (on_it == D) return {model_.block_of(part.element), face};
  }
  return {model_.block_of(part.element), -1};
}
template <int D, class Real>
int Blocks<D, Real>::point(FaceId part, int face, int i) const {
  Index const block = model_.block_of(part.element), at = model_.face_vertex(part, i);
  for (int point = 0; point < face_points; ++point)
    if (face_vertex(block, face, point) == at) return point;
  return -1;
}

template <int D, class Real>
Real Simplices<D, Real>::area_share(Index cell, int face, int i) const {
  return model_.joint_share({cell, face}, i);
}
template <int D, class Real>
Real Simplices<D, Real>::outward(Index cell, int face) const {
  return Real((face % 2 == 0) == (model_.elements.parity.download_one(cell) > 0) ? 1 : -1);
}

template <int D, class Real>
std::vector<double> Blocks<D, Real>::least(std::vector<double> const& of_parts) const {
  if (of_parts.empty()) return {};
  std::vector<double> least(static_cast<std::size_t>(model_.blocks.count) * faces, 1);
  for (Index b = 0; b < model_.blocks.count; ++b)
    for (int a = 0; a < faces; ++a) {
      auto const here = parts(b, a);
      if (here.empty()) continue;
      double& value = least[blocked(b, a, faces)] = std::numeric_limits<double>::infinity();
      for (auto const& [e, face] : here) value = std::min(value, of_parts[blocked(e, face, D + 1)]);
    }
  return least;
}
template <int D, class Real>
std::vector<std::uint8_t> Blocks<D, Real>::all(std::vector<std::uint8_t> const& of_parts) const {
  std::vector<std::uint8_t> all(static_cast<std::size_t>(model_.blocks.count) * faces, 0);
  for (Index b = 0; b < model_.blocks.count; ++b)
    for (int a = 0; a < faces; ++a) {
      auto const here = parts(b, a);
      all[blocked(b, a, faces)] = !here.empty() && std::all_of(here.begin(), here.end(), [&](FaceId const& part) {
        return of_parts[blocked(part.element, part.face, D + 1)] != 0;
      });
    }
  return all;
}

template <int D, class Real>
Group const& Blocks<D, Real>::group_of(Index block) const {
  return *std::partition_point(model_.groups.begin(), model_.groups.end(),
                               [&](Group const& group) { return group.blocks.first + group.blocks.padded <= block; });
}

template <int D, class Real>
double Simplices<D, Real>::volume_ratio(std::vector<Real> const& u, Index cell, bool) const {
  return model_.moved_edges(u, cell).determinant() / model_.edges(cell).determinant() *
         (model_.section.axisymmetric() ? model_.moved_radius(u, cell) / model_.mean_radius(cell) : 1);
}

/// A block's Jacobian at a Gauss point, at rest and now.
template <int D, class Real>
std::array<Mat<double, D>, 2> Blocks<D, Real>::jacobians(std::vector<Real> const& u, Index block, int p) const {
  std::array<Mat<double, D>, 2> J{Mat<double, D>::Zero(), Mat<double, D>::Zero()};
  for (int a = 0; a < corners; ++a) {
    Index const at = vertex(block, a);
    for (int c = 0; c < D; ++c) {
      double const x = model_.vertices.reference[at][c],
                   moved = x + static_cast<double>(u[static_cast<std::size_t>(at) * D + c]);
      for (int axis = 0; axis < D; ++axis) {
        J[0](c, axis) += x * Shape::slope(a, axis, p);
        J[1](c, axis) += moved * Shape::slope(a, axis, p);
      }
    }
  }
  return J;
}

/// What goes around the axis at a block's Gauss point, at rest and now: the radius [m]; 1 without axisymmetry.
template <int D, class Real>
std::array<double, 2> Blocks<D, Real>::radii(std::vector<Real> const& u, Index block, int p) const {
  if (!model_.section.axisymmetric()) return {1, 1};
  std::array<double, 2> radii{0, 0};
  for (int a = 0; a < corners; ++a) {
    Index const at = vertex(block, a);
    double const N = Shape::value(a, p), X = model_.vertices.reference[at][0];
    radii[0] += N * X, radii[1] += N * (X + static_cast<double>(u[static_cast<std::size_t>(at) * D]));
  }
  return radii;
}

template <int D, class Real>
double Blocks<D, Real>::volume_ratio(std::vector<Real> const& u, Index block, bool mean) const {
  using Number = kernels::BlockNumbers<D>;
  auto const& group = group_of(block);
  bool const around = model_.section.axisymmetric();
  if (Number::points(group.integration) == 1) {  // as the kernel sees it
    Index const count = Number::count(group.integration, around);
    auto const number = [&](int k) {
      return static_cast<double>(
          model_.blocks.host_shapes[group.shapes_at + blocked(block - group.blocks.first, k, count)]);
    };
    Mat<double, D> H = Mat<double, D>::Zero();
    double hoop = 0;
    for (int a = 0; a < corners; ++a) {
      auto const* const moved = &u[static_cast<std::size_t>(vertex(block, a)) * D];
      for (int i = 0; i < D; ++i)
        for (int c = 0; c < D; ++c) H(i, c) += static_cast<double>(moved[i]) * number(Number::gradients + a * D + c);
      if (around) hoop += number(count - corners + a) * static_cast<double>(moved[0]);
    }
    return (1 + Dim<D>::volume_change(H)) * (1 + hoop);
  }
  double least = std::numeric_limits<double>::infinity(), now = 0, rest = 0;
  for (int p = 0; p < corners; ++p) {
    auto const J = jacobians(u, block, p);
    auto const radius = radii(u, block, p);
    double const then = J[0].determinant() * radius[0], moved = J[1].determinant() * radius[1];
    if (!(moved / then >= least)) least = moved / then;
    now += moved, rest += then;
  }
  return mean ? now / rest : least;
}

template <int D, class Real>
double Simplices<D, Real>::squared_gradients(std::vector<Real> const& u, Index cell, std::vector<double> const& volumes,
                                             std::vector<char> const& on_axis) const {
  double whole = 0, sum = 0;
  for (double volume : volumes) whole += volume;
  Mat<double, D> const inverse = model_.moved_edges(u, cell).inverse();
  double const hoop = model_.section.axisymmetric() ? std::pow(corners * model_.moved_radius(u, cell), -2) : 0;
  for (int a = 0; a < corners; ++a) {
    double const squared = a > 0 ? inverse.row(a - 1).squaredNorm() : inverse.colwise().sum().squaredNorm();
    sum += (squared + (on_axis[vertex(cell, a)] ? 0 : hoop)) / volumes[a];
  }
  return sum * whole;
}

template <int D, class Real>
double Blocks<D, Real>::squared_gradients(std::vector<Real> const& u, Index block, std::vector<double> const& volumes,
                                          std::vector<char> const& on_axis) const {
  double whole = 0, sum = 0, weights = 0;
  for (double volume : volumes) whole += volume;
  bool const one = kernels::BlockNumbers<D>::points(group_of(block).integration) == 1;
  for (int p = one ? -1 : 0; p < (one ? 0 : corners); ++p) {
    auto const J = jacobians(u, block, p);
    auto const radius = radii(u, block, p);
    Mat<double, D> const inverse = J[1].inverse();
    double squares = 0;
    for (int a = 0; a < corners; ++a) {
      Vec<double, D> slope;
      for (int axis = 0; axis < D; ++axis) slope[axis] = Shape::slope(a, axis, p);
      double squared = (inverse.transpose() * slope).squaredNorm();
      if (model_.section.axisymmetric() && !on_axis[vertex(block, a)])
        squared += std::pow(Shape::value(a, p) / radius[1], 2);
      squares += squared / volumes[a];
    }
    double const weight = J[0].determinant() * radius[0];
    weights += weight, sum += weight * squares;
  }
  return sum / weights * whole;
}

template <int D, class Real>
std::vector<double> Simplices<D, Real>::corner_volumes(Index cell) const {
  double const like =
      std::abs(model_.edges(cell).determinant()) * Dim<D>::simplex_share * model_.out_of_plane(cell) / corners;
  std::vector<double> volumes(corners);
  for (int a = 0; a < corners; ++a) volumes[a] = like * model_.mass_share(cell, a);
  return volumes;
}
template <int D, class Real>
std::vector<double> Blocks<D, Real>::corner_volumes(Index block) const {
  auto const* const first = &model_.blocks.corner_volume[static_cast<std::size_t>(block) * corners];
  return {first, first + corners};
}

template <int D, class Real>
double Simplices<D, Real>::remembered(std::vector<Real> const& memory, Index cell, int k) const {
  auto const& group = model_.groups[model_.elements.body[cell]];
  return static_cast<double>(
      memory[group.simplices.memory_at + blocked(cell - group.first, k, group.plastic->memory.numbers)]);
}
template <int D, class Real>
double Blocks<D, Real>::remembered(std::vector<Real> const& memory, Index block, int k) const {
  auto const& group = group_of(block);
  Index const points = kernels::BlockNumbers<D>::points(group.integration), b = block - group.blocks.first;
  double sum = 0;
  for (Index p = 0; p < points; ++p)
    sum += static_cast<double>(memory[group.blocks.memory_at + blocked(kernels::point_of_block(b, p, points), k,
                                                                       group.plastic->memory.numbers)]);
  return sum / points;
}

/// The mean of a cell's corners at rest [m].
template <int D, class Real>
Vec<double, D> Model<D, Real>::cell_centre(Index element) const {
  return in_set(element, [&](auto const& set, Index cell) {
    Vec<double, D> x = Vec<double, D>::Zero();
    for (int a = 0; a < set.corners; ++a) x += reference_of(set.vertex(cell, a)) / set.corners;
    return x;
  });
}

/// Normal of the cell's whole face, so that both parts of a block's face and both sides agree.
template <int D, class Real>
Vec<double, D> Model<D, Real>::cell_face_normal(FaceId part) const {
  return in_set(part.element, [&]<class Set>(Set const& set, Index cell) -> Vec<double, D> {
    int const face = set.face_of(part).face;
    Vec<double, D> corner[Set::face_points];
    for (int i = 0; i < Set::face_points; ++i) corner[i] = reference_of(set.face_vertex(cell, face, i));
    Vec<double, D> const normal = Dim<D>::face_normal(corner);
    return normal / normal.norm();
  });
}

}  // namespace fissure::model
