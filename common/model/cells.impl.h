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
    if (group.blocks == 0) continue;
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    double const density = material.density * scene.run.mass_scaling;
    Index const count = Number::count(group.integration, section.axisymmetric());
    group.shapes_at = shapes.size();
    shapes.resize(shapes.size() + static_cast<std::size_t>(group.padded_blocks) * count);
    for (Index b = group.first_block; b < group.first_block + group.padded_blocks; ++b) {
      Index const from = real_block(group, b);
      std::array<Vec<double, D>, B> X;
      for (int a = 0; a < B; ++a) X[a] = reference_of(blocks.host_vertex[blocked(from, a, B)]);
      BlockIntegrals<D> const integrals(X, section);
      for (int a = 0; a < B && from == b; ++a) {
        blocks.corner_volume[static_cast<std::size_t>(b) * B + a] = integrals.share[a];
        vertices.mass[blocks.host_vertex[blocked(b, a, B)]] += density * integrals.share[a];
      }
      put_block_shape(integrals, group.integration, material.elastic().young, [&](int k, double value) {
        shapes[group.shapes_at + blocked(b - group.first_block, k, count)] = static_cast<Real>(value);
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
std::vector<Index> Model<D, Real>::cell_vertices(Index head) const {
  Index const block = block_of(head);
  std::vector<Index> vertices(block < 0 ? C : B);
  for (Index a = 0; a < static_cast<Index>(vertices.size()); ++a)
    vertices[a] = block < 0 ? vertex_of(head, a) : blocks.host_vertex[blocked(block, a, B)];
  return vertices;
}

/// A block's Jacobian at a Gauss point, at rest and now.
template <int D, class Real>
std::array<Mat<double, D>, 2> Model<D, Real>::block_jacobians(std::vector<Real> const& u, Index block, int p) const {
  std::array<Mat<double, D>, 2> J{Mat<double, D>::Zero(), Mat<double, D>::Zero()};
  for (int a = 0; a < B; ++a) {
    Index const vertex = blocks.host_vertex[blocked(block, a, B)];
    for (int c = 0; c < D; ++c) {
      double const x = vertices.reference[vertex][c],
                   moved = x + static_cast<double>(u[static_cast<std::size_t>(vertex) * D + c]);
      for (int axis = 0; axis < D; ++axis) {
        J[0](c, axis) += x * BlockShape<D>::slope(a, axis, p);
        J[1](c, axis) += moved * BlockShape<D>::slope(a, axis, p);
      }
    }
  }
  return J;
}

/// The radius of a block's Gauss point, at rest and now [m]: axisymmetry only.
template <int D, class Real>
std::array<double, 2> Model<D, Real>::block_radii(std::vector<Real> const& u, Index block, int p) const {
  std::array<double, 2> radii{0, 0};
  for (int a = 0; a < B; ++a) {
    Index const vertex = blocks.host_vertex[blocked(block, a, B)];
    double const N = BlockShape<D>::value(a, p), X = vertices.reference[vertex][0];
    radii[0] += N * X, radii[1] += N * (X + static_cast<double>(u[static_cast<std::size_t>(vertex) * D]));
  }
  return radii;
}

template <int D, class Real>
double Model<D, Real>::volume_ratio(std::vector<Real> const& u, Index head, bool mean) const {
  Index const block = block_of(head);
  if (block < 0)
    return moved_edges(u, head).determinant() / edges(head).determinant() *
           (section.axisymmetric() ? moved_radius(u, head) / mean_radius(head) : 1);
  auto const& group = groups[elements.body[head]];
  using Number = kernels::BlockNumbers<D>;
  if (Number::points(group.integration) == 1) {  // as the kernel sees it
    Index const count = Number::count(group.integration, section.axisymmetric());
    auto const number = [&](int k) {
      return static_cast<double>(blocks.host_shapes[group.shapes_at + blocked(block - group.first_block, k, count)]);
    };
    Mat<double, D> H = Mat<double, D>::Zero();
    double hoop = 0;
    for (int a = 0; a < B; ++a) {
      auto const* const moved = &u[static_cast<std::size_t>(blocks.host_vertex[blocked(block, a, B)]) * D];
      for (int i = 0; i < D; ++i)
        for (int c = 0; c < D; ++c) H(i, c) += static_cast<double>(moved[i]) * number(Number::gradients + a * D + c);
      if (section.axisymmetric()) hoop += number(count - B + a) * static_cast<double>(moved[0]);
    }
    return (1 + Dim<D>::volume_change(H)) * (1 + hoop);
  }
  double least = std::numeric_limits<double>::infinity(), now = 0, rest = 0;
  for (int p = 0; p < B; ++p) {
    auto const J = block_jacobians(u, block, p);
    std::array<double, 2> const around =
        section.axisymmetric() ? block_radii(u, block, p) : std::array<double, 2>{1, 1};
    double const then = J[0].determinant() * around[0], moved = J[1].determinant() * around[1];
    if (!(moved / then >= least)) least = moved / then;
    now += moved, rest += then;
  }
  return mean ? now / rest : least;
}

template <int D, class Real>
double Model<D, Real>::squared_gradients(std::vector<Real> const& u, Index head, std::vector<double> const& volumes,
                                         std::vector<char> const& on_axis) const {
  Index const block = block_of(head);
  double whole = 0, sum = 0;
  for (double volume : volumes) whole += volume;
  if (block < 0) {
    Mat<double, D> const inverse = moved_edges(u, head).inverse();
    double const hoop = section.axisymmetric() ? std::pow(C * moved_radius(u, head), -2) : 0;
    for (int a = 0; a < C; ++a) {
      double const squared = a > 0 ? inverse.row(a - 1).squaredNorm() : inverse.colwise().sum().squaredNorm();
      sum += (squared + (on_axis[vertex_of(head, a)] ? 0 : hoop)) / volumes[a];
    }
    return sum * whole;
  }
  bool const one = kernels::BlockNumbers<D>::points(groups[elements.body[head]].integration) == 1;
  double weights = 0;
  for (int p = one ? -1 : 0; p < (one ? 0 : B); ++p) {
    auto const J = block_jacobians(u, block, p);
    std::array<double, 2> const around =
        section.axisymmetric() ? block_radii(u, block, p) : std::array<double, 2>{1, 1};
    Mat<double, D> const inverse = J[1].inverse();
    double squares = 0;
    for (int a = 0; a < B; ++a) {
      Vec<double, D> slope;
      for (int axis = 0; axis < D; ++axis) slope[axis] = BlockShape<D>::slope(a, axis, p);
      double squared = (inverse.transpose() * slope).squaredNorm();
      if (section.axisymmetric() && !on_axis[blocks.host_vertex[blocked(block, a, B)]])
        squared += std::pow(BlockShape<D>::value(a, p) / around[1], 2);
      squares += squared / volumes[a];
    }
    double const weight = J[0].determinant() * around[0];
    weights += weight, sum += weight * squares;
  }
  return sum / weights * whole;
}

template <int D, class Real>
std::vector<double> Model<D, Real>::corner_volumes(Index head) const {
  Index const block = block_of(head);
  if (block >= 0)
    return {&blocks.corner_volume[static_cast<std::size_t>(block) * B],
            &blocks.corner_volume[static_cast<std::size_t>(block) * B] + B};
  double const like = std::abs(edges(head).determinant()) * Dim<D>::simplex_share * out_of_plane(head) / C;
  std::vector<double> volumes(C);
  for (int a = 0; a < C; ++a) volumes[a] = like * mass_share(head, a);
  return volumes;
}

template <int D, class Real>
double Model<D, Real>::remembered(std::vector<Real> const& memory, Index head, int k) const {
  auto const& group = groups[elements.body[head]];
  int const numbers = group.plastic->memory.numbers;
  Index const block = block_of(head);
  if (block < 0) return static_cast<double>(memory[group.memory_at + blocked(head - group.first, k, numbers)]);
  Index const points = kernels::BlockNumbers<D>::points(group.integration), b = block - group.first_block;
  double sum = 0;
  for (Index p = 0; p < points; ++p)
    sum += static_cast<double>(
        memory[group.block_memory_at +
               blocked(b / layout_width * layout_width * points + p * layout_width + b % layout_width, k, numbers)]);
  return sum / points;
}

}  // namespace fissure::model
