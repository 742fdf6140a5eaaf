// Building a model's arrays; instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "mesh/block.h"
#include "model/model.h"

namespace fissure::model {

using kernels::blocked;
using kernels::layout_width;

inline Index whole_blocks(Index n) { return (n + layout_width - 1) / layout_width * layout_width; }

inline kernels::Integration integration(std::string const& word) {
  using kernels::Integration;
  if (word == "assumed_strain") return Integration::assumed_strain;
  if (word == "full") return Integration::full;
  if (word == "b_bar") return Integration::b_bar;
  return Integration::one_point;
}

template <int D, class Real>
Model<D, Real>::Model(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh)
    : parts(mesh::block_parts(mesh.kind)), plan(make_plan(scene, mesh)), thickness(mesh.thickness),
      axisymmetric(Dim<D>::can_revolve && scene.two_d == "axisymmetric") {
  Vec3 low = mesh.nodes.at(0), high = low;
  for (auto const& x : mesh.nodes) low = low.cwiseMin(x), high = high.cwiseMax(x);
  origin = (low + high) / 2;
  if (axisymmetric) find_axis(scene, mesh);
  for (int b = 0; b < mesh.n_bodies(); ++b) {
    Group group;
    group.body = b;
    group.blocks = mesh.n_blocks(b);
    group.block_count = whole_blocks(group.blocks);
    group.simplices = whole_blocks(mesh.n_simplices(b));
    group.count = group.simplices + group.block_count * parts;  // padding blocks have parts, too
    group.first = n_elements, group.first_block = n_blocks;
    group.integration = integration(scene.bodies[b].mesh.integration);
    n_blocks += group.block_count;
    group.split = scene.materials.at(scene.bodies[b].material).joint.has_value();
    n_elements += group.count;
    groups.push_back(group);
  }
  number_elements(mesh);
  number_vertices(mesh, device);
  place_elements(scene, mesh, device);
  if (plan.blocks) place_blocks(scene, device);
  if (plan.joints) place_joints(scene, mesh, device);
  if (plan.plastic) place_memory(scene, device);
  if (plan.patches) place_patches(device);
  set_motion(scene, device);
  place_loads(scene, mesh, device);
  flags = Buffer<int>(device, "flags", 2);
}

/// Mesh nodes on the axis of revolution; refuses those beyond it. Radii are measured from it, so the origin lies on it too.
template <int D, class Real>
void Model<D, Real>::find_axis(scene::Scene const& scene, mesh::Mesh const& mesh) {
  double largest = 0;
  for (auto const& x : mesh.nodes) largest = std::max(largest, std::abs(x[0]));
  double const rounding = 1e-9 * largest;
  for (int b = 0; b < mesh.n_bodies(); ++b)
    for (int n = mesh.body_first_node[b]; n < mesh.body_first_node[b + 1]; ++n)
      if (double const x = mesh.nodes[n][0]; x < -rounding)
        throw Error(scene.bodies[b].source, fmt::format("body \"{}\": a node lies at x = {:g} m, beyond the axis (with two_d = \"axisymmetric\" x is the "
                                                        "radius); draw the half of its section where x >= 0, or take rod or ball, which do so",
                                                        scene.bodies[b].name, x));
  for (auto const& x : mesh.nodes) on_axis.push_back(x[0] < rounding);
  origin[0] = 0;
}

/// Elements are the mesh's cells in order, each with its corners sorted by node.
template <int D, class Real>
void Model<D, Real>::number_elements(mesh::Mesh const& mesh) {
  element_of_cell.assign(mesh.n_cells(), -1);
  cell_of_element.assign(n_elements, -1);
  body_of_element.assign(n_elements, -1);
  corner_node.assign(static_cast<std::size_t>(n_elements) * C, -1);
  for (auto const& group : groups)
    for (Index cell = mesh.body_first_cell[group.body], k = 0; cell < mesh.body_first_cell[group.body + 1]; ++cell, ++k) {
      Index const simplices = mesh.n_simplices(group.body), e = group.first + k + (k < simplices ? 0 : group.simplices - simplices);
      element_of_cell[cell] = e;
      cell_of_element[e] = cell;
      body_of_element[e] = group.body;
      int* const nodes = &corner_node[static_cast<std::size_t>(e) * C];
      std::copy_n(&mesh.cells[static_cast<std::size_t>(cell) * C], C, nodes);
      std::sort(nodes, nodes + C);
    }
}

/// Bodies that can crack: a vertex per corner. Others: a vertex per node, and the corners that hang on it.
template <int D, class Real>
void Model<D, Real>::number_vertices(mesh::Mesh const& mesh, Device& device) {
  if (!plan.shared) {
    n_vertices = n_elements * C;
    reference.resize(n_vertices);
    return;
  }
  std::vector<Index> vertex_of_node(mesh.nodes.size(), -1);
  host_corner_vertex.assign(static_cast<std::size_t>(n_elements) * C, -1);
  host_block_vertex.assign(static_cast<std::size_t>(n_blocks) * B, -1);
  for (auto const& group : groups) {
    bool const own = group.split && group.blocks == 0;  // one after the other, padding too: kernels rely on it
    auto const at_node = [&](int node) {
      Index& vertex = vertex_of_node[node];
      if (vertex < 0) vertex = n_vertices++;
      return vertex;
    };
    for (Index e = group.first; e < group.first + group.simplices; ++e) {
      if (cell_of_element[e] < 0 && !own) continue;
      for (int a = 0; a < C; ++a)
        host_corner_vertex[blocked(e, a, C)] = group.split ? n_vertices++ : at_node(corner_node[static_cast<std::size_t>(e) * C + a]);
    }
    for (Index b = group.first_block; b < group.first_block + group.blocks; ++b) {
      int const* const nodes = &mesh.blocks[static_cast<std::size_t>(mesh.body_first_block[group.body] + b - group.first_block) * B];
      for (int a = 0; a < B; ++a) host_block_vertex[blocked(b, a, B)] = group.split ? n_vertices++ : at_node(nodes[a]);
      for (Index k = 0; k < parts; ++k)
        for (int a = 0; a < C; ++a) {
          Index const part = part_of(group, b, k);
          auto const corner = std::find(nodes, nodes + B, corner_node[static_cast<std::size_t>(part) * C + a]) - nodes;
          host_corner_vertex[blocked(part, a, C)] = host_block_vertex[blocked(b, static_cast<Index>(corner), B)];
        }
    }
  }
  // Other padding elements hang on vertices of their own that nothing moves.
  Index const idle = n_vertices;
  n_vertices = whole_blocks(n_vertices + std::max(C, B));
  for (Index e = 0; e < n_elements; ++e)
    for (int a = 0; a < C; ++a)
      if (Index& vertex = host_corner_vertex[blocked(e, a, C)]; vertex < 0) vertex = idle + a;
  for (Index b = 0; b < n_blocks; ++b)
    for (int a = 0; a < B; ++a)
      if (Index& vertex = host_block_vertex[blocked(b, a, B)]; vertex < 0) vertex = idle + a;
  reference.resize(n_vertices);

  // Every slot that somebody writes: parts of blocks write only what their joints do.
  auto const over_slots = [&](auto&& f) {
    for (auto const& group : groups) {
      for (Index e = group.first; e < group.first + (group.split ? group.count : group.simplices); ++e)
        for (int a = 0; a < C; ++a) f(vertex_of(e, a), e * C + a);
      for (Index b = group.first_block; b < group.first_block + group.block_count; ++b)
        for (int a = 0; a < B; ++a) f(host_block_vertex[blocked(b, a, B)], block_slot(b, a));
    }
  };
  std::vector<Index> first(n_vertices + 1, 0);
  over_slots([&](Index vertex, Index) { ++first[vertex + 1]; });
  for (Index i = 0; i < n_vertices; ++i) first[i + 1] += first[i];
  std::vector<Index> next(first.begin(), first.end() - 1), list(first.back());
  over_slots([&](Index vertex, Index slot) { list[next[vertex]++] = slot; });
  corner_vertex = Buffer<Index>(device, "corner vertices", host_corner_vertex);
  corner_first = Buffer<Index>(device, "vertex corners", first);
  corner_list = Buffer<Index>(device, "vertex corners", list);
  corners = Buffer<Real>(device, "corner forces", (static_cast<std::size_t>(n_elements) * C + static_cast<std::size_t>(n_blocks) * B) * D);
  block_vertex = Buffer<Index>(device, "block corners", host_block_vertex);
}

template <int D, class Real>
void Model<D, Real>::place_elements(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device) {
  std::vector<Real> coordinates(static_cast<std::size_t>(n_elements) * C * D);
  std::vector<std::int8_t> orientation(n_elements, 1);
  mass.assign(n_vertices, 0);
  auto const quality = mesh::quality(mesh);
  for (auto& group : groups) {
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    double const density = material.density * scene.run.mass_scaling;
    double const young = std::visit([](auto const& law) { return law.young; }, material.bulk);
    group.viscosity = material.viscosity +
                      material.critical_share * 2 * quality[group.body].mean_edge * std::sqrt(young * density);
    for (Index e = group.first; e < group.first + group.count; ++e) {
      Index const from = cell_of_element[e] >= 0 ? e : group.first;  // padding is a copy of the first element, without mass
      Mat<double, D> edges;
      for (int a = 0; a < C; ++a) {
        int const node = corner_node[static_cast<std::size_t>(from) * C + a];
        Vec3 x = mesh.nodes[node] - origin;
        if (axisymmetric && on_axis[node]) x[0] = 0;
        for (int c = 0; c < D; ++c) {
          coordinates[blocked(e, a * D + c, C * D)] = static_cast<Real>(x[c]);
          reference[vertex_of(e, a)][c] = x[c];
          if (a > 0) edges(c, a - 1) = x[c] - reference[vertex_of(e, 0)][c];
        }
      }
      double const determinant = edges.determinant();
      orientation[e] = determinant > 0 ? 1 : -1;
      if (cell_of_element[e] >= 0 && block_of(e) < 0)
        for (int a = 0; a < C; ++a)
          mass[vertex_of(e, a)] += density * std::abs(determinant) * Dim<D>::simplex_share * out_of_plane(e) / C * mass_share(e, a);
    }
  }
  X = Buffer<Real>(device, "reference coordinates", coordinates);
  parity = Buffer<std::int8_t>(device, "orientation", orientation);
  force = Buffer<Real>(device, "forces", static_cast<std::size_t>(n_vertices) * D);
  if (plan.viscous || plan.joints) viscous_work = Buffer<double>(device, "viscous work", n_elements);
}

/// Shape at rest of every block and its mass: to each corner the integral of its shape function.
template <int D, class Real>
void Model<D, Real>::place_blocks(scene::Scene const& scene, Device& device) {
  using Number = kernels::BlockNumbers<D>;
  using Shape = BlockShape<D>;
  std::vector<Real> shapes;
  block_corner_volume.assign(static_cast<std::size_t>(n_blocks) * B, 0);
  for (auto& group : groups) {
    if (group.blocks == 0) continue;
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    double const density = material.density * scene.run.mass_scaling;
    double const young = std::visit([](auto const& law) { return law.young; }, material.bulk);
    Index const count = Number::count(group.integration, axisymmetric);
    group.shapes_at = shapes.size();
    shapes.resize(shapes.size() + static_cast<std::size_t>(group.block_count) * count);
    for (Index b = group.first_block; b < group.first_block + group.block_count; ++b) {
      Index const from = b < group.first_block + group.blocks ? b : group.first_block;  // padding is a copy without mass
      std::array<Vec<double, D>, B> X;
      for (int a = 0; a < B; ++a)
        for (int c = 0; c < D; ++c) X[a][c] = reference[host_block_vertex[blocked(from, a, B)]][c];
      auto const put = [&](int k, double value) { shapes[group.shapes_at + blocked(b - group.first_block, k, count)] = static_cast<Real>(value); };
      auto const put_vector = [&](int k, Vec<double, D> const& x) {
        for (int c = 0; c < D; ++c) put(k + c, x[c]);
      };
      // Integrals over the volume: of 1, of each shape function, of its gradient and of it over the radius.
      double volume = 0;
      std::array<double, B> share{}, hoop{};
      std::array<Vec<double, D>, B> gradient;
      gradient.fill(Vec<double, D>::Zero());
      auto const jacobian = [&](int p) {
        Mat<double, D> J = Mat<double, D>::Zero();
        for (int a = 0; a < B; ++a)
          for (int axis = 0; axis < D; ++axis) J.col(axis) += X[a] * Shape::slope(a, axis, p);
        return J;
      };
      for (int p = 0; p < Shape::points; ++p) {
        Mat<double, D> const J = jacobian(p), inverse = J.inverse();
        double radius = 0;
        for (int a = 0; a < B; ++a) radius += Shape::value(a, p) * X[a][0];
        double const w = J.determinant() * (axisymmetric ? 2 * std::numbers::pi * radius : thickness);
        volume += w;
        for (int a = 0; a < B; ++a) {
          Vec<double, D> slope;
          for (int axis = 0; axis < D; ++axis) slope[axis] = Shape::slope(a, axis, p);
          share[a] += w * Shape::value(a, p);
          gradient[a] += w * (inverse.transpose() * slope);
          hoop[a] += w * Shape::value(a, p) / radius;
        }
      }
      if (from == b)
        for (int a = 0; a < B; ++a) {
          block_corner_volume[static_cast<std::size_t>(b) * B + a] = share[a];
          mass[host_block_vertex[blocked(b, a, B)]] += density * share[a];
        }
      if (Number::points(group.integration) > 1) {
        for (int a = 0; a < B; ++a) put_vector(Number::gradients + a * D, X[a]);
        continue;
      }
      double squares = 0;
      for (int a = 0; a < B; ++a) {
        put_vector(Number::gradients + a * D, gradient[a] / volume);
        squares += (gradient[a] / volume).squaredNorm();
        if (axisymmetric) put(count - B + a, hoop[a] / volume);
      }
      for (int m = 0; m < Shape::modes; ++m) {
        Vec<double, D> moment = Vec<double, D>::Zero();
        for (int a = 0; a < B; ++a) moment += Shape::mode(m, a) * X[a];
        put_vector(Number::moments + m * D, moment);
      }
      put(Number::volume, volume);
      if (group.integration == kernels::Integration::one_point) {
        // A quarter to a third of what the mode's bending would take: a beam of four cells over its depth bends within 5 %.
        // Young's modulus, since that of confined strain would lock what is nearly incompressible.
        put(Number::springs, 0.25 * young * volume * squares / (B * B));
        continue;
      }
      Mat<double, D> const J = jacobian(-1);
      for (int i = 0; i < D; ++i) {
        double const length = J.col(i).norm();
        put_vector(Number::axes + i * D, J.col(i) / (length * length * B));
        put(Number::lengths + i, length);
      }
    }
  }
  block_shapes = Buffer<Real>(device, "block shapes", shapes);
}

/// How the area of a cell's face is shared among its corners, times D: alike for a simplex. Of a block's face, the integral of
/// each shape function over it, (A + T)/6 with T the area of the triangle at the corner: two parts meet at a diagonal's ends
/// and bring half of it each.
template <int D, class Real>
std::array<double, D> Model<D, Real>::corner_shares(mesh::Mesh const& mesh, int body, int cell, std::array<int, D> const& nodes) const {
  std::array<double, D> shares;
  shares.fill(1);
  int const block = mesh.block_of(body, cell);
  if (block < 0 || B / 2 == Dim<D>::face_corners) return shares;  // the face of a block is that of one of its parts
  int const* const corner = &mesh.blocks[static_cast<std::size_t>(block) * B];
  std::array<int, D> local;
  for (int i = 0; i < D; ++i) local[i] = static_cast<int>(std::find(corner, corner + B, nodes[i]) - corner);
  auto const sign = [](int a, int axis) { return BlockShape<D>::sign(a, axis); };
  int normal = 0;  // the axis along which all of them lie on one side
  while (std::any_of(local.begin(), local.end(), [&](int a) { return sign(a, normal) != sign(local[0], normal); })) ++normal;
  auto const across = [&](int a, bool one, bool other) {  // the face's corner on the other side of a along its two axes
    for (int b = 0; b < B; ++b)
      if (sign(b, normal) == sign(a, normal) && (sign(b, (normal + 1) % D) != sign(a, (normal + 1) % D)) == one &&
          (sign(b, (normal + 2) % D) != sign(a, (normal + 2) % D)) == other)
        return b;
    return a;
  };
  auto const triangle = [&](int a) {
    Vec3 const x = mesh.nodes[corner[a]];
    return 0.5 * (mesh.nodes[corner[across(a, true, false)]] - x).cross(mesh.nodes[corner[across(a, false, true)]] - x).norm();
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

/// A joint on every inner face between cells. Its size h is the distance between the two centroids normal to it, for simplices
/// d/(d+1) (V1 + V2)/A.
template <int D, class Real>
void Model<D, Real>::place_joints(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device) {
  auto const across = mesh::neighbours(mesh);
  std::size_t const faces = static_cast<std::size_t>(n_elements) * C;
  host_link.resize(faces);
  joint_size.assign(faces, 0);
  std::vector<Real> weights(faces, 0), stiffnesses(faces, 0), shares(plan.blocks ? faces * D : 0, 1);
  auto const point = [&](Index e, int a) {
    Vec<double, D> x;
    Vec3 const node = mesh.nodes[corner_node[static_cast<std::size_t>(e) * C + a]];
    for (int c = 0; c < D; ++c) x[c] = node[c];
    return x;
  };
  auto const measure = [&](Index e) {
    Mat<double, D> edges;
    for (int b = 0; b < D; ++b) edges.col(b) = point(e, b + 1) - point(e, 0);
    return std::abs(edges.determinant()) * Dim<D>::simplex_share;
  };
  auto const centre = [&](Index e) {  // of the cell that the element is or is part of
    Vec<double, D> x = Vec<double, D>::Zero();
    Index const block = block_of(e);
    for (int a = 0; a < (block < 0 ? C : B); ++a) {
      auto const& corner = reference[block < 0 ? vertex_of(e, a) : host_block_vertex[blocked(block, a, B)]];
      for (int c = 0; c < D; ++c) x[c] += corner[c] / (block < 0 ? C : B);
    }
    return x;
  };
  for (Index e = 0; e < n_elements; ++e)
    for (int a = 0; a < C; ++a) host_link[blocked(e, a, C)] = e * 4 + a;  // none: linked to itself, with no area
  for (auto const& group : groups) {
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    if (!material.joint) continue;
    double const penalty = std::visit([](auto const& law) { return law.penalty; }, *material.joint);
    for (Index e = group.first; e < group.first + group.count; ++e) {
      Index const cell = cell_of_element[e];
      if (cell < 0) continue;
      for (int b = 0; b < C; ++b) {
        int const neighbour = across[static_cast<std::size_t>(cell) * C + b];
        if (neighbour < 0) continue;
        Index const other = element_of_cell[neighbour];
        if (block_of(e) >= 0 && block_of(e) == block_of(other)) continue;
        // The cell's corner b is some sorted corner a; the other side's face is opposite its corner that is not shared.
        int const* const mine = &corner_node[static_cast<std::size_t>(e) * C];
        int const* const theirs = &corner_node[static_cast<std::size_t>(other) * C];
        int const a = static_cast<int>(std::find(mine, mine + C, mesh.cells[static_cast<std::size_t>(cell) * C + b]) - mine);
        int face = 0;
        while (std::find(mine, mine + C, theirs[face]) != mine + C) ++face;
        Vec<double, D> corner[D];
        for (int i = 0; i < D; ++i) corner[i] = point(e, i + (i >= a));
        Vec<double, D> const normal = Dim<D>::face_normal(corner);
        double const area = normal.norm();
        double const h = group.blocks == 0 ? static_cast<double>(D) / (D + 1) * (measure(e) + measure(other)) / area
                                           : std::abs((centre(other) - centre(e)).dot(normal)) / area;
        if (plan.blocks) {
          std::array<int, D> nodes;
          for (int i = 0; i < D; ++i) nodes[i] = mine[i + (i >= a)];
          auto const own = corner_shares(mesh, group.body, cell, nodes), facing = corner_shares(mesh, group.body, neighbour, nodes);
          for (int i = 0; i < D; ++i) shares[blocked(e, a * D + i, C * D)] = static_cast<Real>(0.5 * (own[i] + facing[i]));
        }
        std::size_t const at = blocked(e, a, C);
        host_link[at] = other * 4 + face;
        joint_size[at] = h;
        auto const reach = face_reach(corner);
        weights[at] = static_cast<Real>(area / D * std::accumulate(reach.begin(), reach.end(), 0.0) / D);
        stiffnesses[at] = static_cast<Real>(penalty / h);
      }
    }
  }
  link = Buffer<Index>(device, "joint links", host_link);
  weight = Buffer<Real>(device, "joint areas", weights);
  share = Buffer<Real>(device, "joint areas", shares);
  host_share.assign(shares.begin(), shares.end());
  stiffness = Buffer<Real>(device, "joint stiffness", stiffnesses);
  history = Buffer<Real>(device, "joint history", faces * D * 3);
  work = Buffer<Real>(device, "joint work", faces * 2);
  dissipated = Buffer<double>(device, "joint dissipation", n_elements);
  softening = Buffer<std::uint8_t>(device, "joint softening", faces / layout_width);
}

/// Laws of bodies that flow and the numbers their elements remember, all zero at the start.
template <int D, class Real>
void Model<D, Real>::place_memory(scene::Scene const& scene, Device& device) {
  std::size_t numbers = 0;
  Index all_points = 0;
  for (auto& group : groups) {
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    if (!material.flow) continue;
    auto const& flow = *material.flow;
    laws::Plastic law;
    static_cast<laws::ElasticConstants&>(law) = std::visit([](auto const& bulk) -> laws::ElasticConstants { return bulk; }, material.bulk);
    law.logarithmic = flow.logarithmic, law.bisection = flow.bisection;
    law.plane_stress = Dim<D>::has_plane_stress && scene.two_d == "plane stress";
    law.flow.which = static_cast<int>(flow.law.index());
    bool has_back = false;
    std::visit([&]<class Law>(Law given) {
      if constexpr (std::is_base_of_v<laws::Curves, Law>) {
        curves.emplace_back(device, "yield curves", flow.curves);
        given.numbers = curves.back().data();
      }
      if constexpr (requires { given.melting_rise; }) given.melting_rise = given.melting - flow.heat.start;
      has_back = Law::has_back;
      std::get<Law>(law.flow.laws) = given;
    }, flow.law);
    if (flow.heat.on()) law.heating = flow.heat.share / (material.density * flow.heat.capacity);
    auto& m = law.memory;
    m.stresses = m.numbers = Dim<D>::stresses;
    if (has_back) m.back = m.numbers, m.numbers += Dim<D>::stresses;
    m.strain = m.numbers++;
    m.rate = m.numbers++;
    if (flow.heat.on()) m.rise = m.numbers++;
    if (law.plane_stress) m.thickness = m.numbers++;
    group.plastic = law;
    group.memory_at = numbers;
    numbers += static_cast<std::size_t>(group.simplices) * m.numbers;
    Index const points = group.block_count * kernels::BlockNumbers<D>::points(group.integration);
    group.block_memory_at = numbers, group.first_point = all_points;
    numbers += static_cast<std::size_t>(points) * m.numbers;
    all_points += points;
    auto const& body = scene.bodies[group.body];
    if (flow.averaged && group.blocks > 0)
      throw Error(body.source, fmt::format("body \"{}\" has blocks, and its material plastic{{ pressure = \"averaged\" }} (which is for simplices); "
                                           "write mesh = {{ integration = \"b_bar\" }} instead", body.name));
    if (flow.averaged) group.patches = 1;  // counted by place_patches()
  }
  memory = Buffer<Real>(device, "plastic memory", numbers);
  plastic_work = Buffer<double>(device, "plastic work", n_elements + all_points);
}

template <int D, class Real>
void Model<D, Real>::place_patches(Device& device) {
  // Patch 0 is empty: padding hangs on it and neither presses nor stores anything.
  std::vector<Index> of_corner(static_cast<std::size_t>(n_elements) * C, 0), first{0, 0}, list;
  for (auto& group : groups) {
    group.first_patch = static_cast<Index>(first.size()) - 1;
    if (group.patches == 0) continue;
    // Corners that share a patch: those at one node whose elements hang together by faces about that node.
    std::vector<Index> root(static_cast<std::size_t>(group.count) * C);
    for (std::size_t i = 0; i < root.size(); ++i) root[i] = static_cast<Index>(i);
    auto const find = [&](Index i) {
      while (root[i] != i) i = root[i] = root[root[i]];
      return i;
    };
    auto const corner = [&](Index e, int a) { return (e - group.first) * C + a; };
    std::map<int, Index> at_node;
    for (Index e = group.first; e < group.first + group.count; ++e)
      for (int a = 0; a < C && cell_of_element[e] >= 0; ++a) {
        if (!group.split) {
          auto const [known, is_new] = at_node.emplace(corner_node[static_cast<std::size_t>(e) * C + a], corner(e, a));
          if (!is_new) root[find(corner(e, a))] = find(known->second);
          continue;
        }
        Index const link = host_link[blocked(e, a, C)], other = link >> 2, face = link & 3;
        if (other == e) continue;
        for (int i = 0; i < D; ++i) root[find(corner(e, i + (i >= a)))] = find(corner(other, i + (i >= face)));
      }
    std::vector<std::vector<Index>> members(root.size());
    for (Index e = group.first; e < group.first + group.count; ++e)
      for (int a = 0; a < C && cell_of_element[e] >= 0; ++a) members[find(corner(e, a))].push_back(corner(e, a));
    for (auto const& patch : members) {
      if (patch.empty()) continue;
      for (Index const c : patch) {
        of_corner[blocked(group.first + c / C, c % C, C)] = static_cast<Index>(first.size()) - 1;
        list.push_back(group.first + c / C);
      }
      first.push_back(static_cast<Index>(list.size()));
    }
    group.patches = static_cast<Index>(first.size()) - 1 - group.first_patch;
  }
  std::size_t const patches = first.size() - 1;
  patch_of_corner = Buffer<Index>(device, "patches", of_corner);
  patch_first = Buffer<Index>(device, "patches", first);
  patch_list = Buffer<Index>(device, "patches", list);
  patch_pressure = Buffer<Real>(device, "patches", patches);
  patch_energy = Buffer<Real>(device, "patches", patches);
  swelling = Buffer<Real>(device, "patches", n_elements);
  swelling_volume = Buffer<Real>(device, "patches", n_elements);
}

template <int D, class Real>
Mat<double, D> Model<D, Real>::edges(Index e) const {
  Mat<double, D> edges;
  for (int b = 0; b < D; ++b)
    for (int c = 0; c < D; ++c) edges(c, b) = reference[vertex_of(e, b + 1)][c] - reference[vertex_of(e, 0)][c];
  return edges;
}

template <int D, class Real>
Mat<double, D> Model<D, Real>::moved_edges(std::vector<Real> const& u, Index e) const {
  Mat<double, D> moved = edges(e);
  auto const at = [&](int a, int c) { return static_cast<double>(u[static_cast<std::size_t>(vertex_of(e, a)) * D + c]); };
  for (int b = 0; b < D; ++b)
    for (int c = 0; c < D; ++c) moved(c, b) = moved(c, b) + at(b + 1, c) - at(0, c);
  return moved;
}

template <int D, class Real>
std::vector<Index> Model<D, Real>::cell_vertices(Index head) const {
  Index const block = block_of(head);
  std::vector<Index> vertices(block < 0 ? C : B);
  for (Index a = 0; a < static_cast<Index>(vertices.size()); ++a) vertices[a] = block < 0 ? vertex_of(head, a) : host_block_vertex[blocked(block, a, B)];
  return vertices;
}

/// A block's Jacobian at a Gauss point, at rest and now.
template <int D, class Real>
std::array<Mat<double, D>, 2> Model<D, Real>::block_jacobians(std::vector<Real> const& u, Index block, int p) const {
  std::array<Mat<double, D>, 2> J{Mat<double, D>::Zero(), Mat<double, D>::Zero()};
  for (int a = 0; a < B; ++a) {
    Index const vertex = host_block_vertex[blocked(block, a, B)];
    for (int c = 0; c < D; ++c) {
      double const x = reference[vertex][c], moved = x + static_cast<double>(u[static_cast<std::size_t>(vertex) * D + c]);
      for (int axis = 0; axis < D; ++axis) {
        J[0](c, axis) += x * BlockShape<D>::slope(a, axis, p);
        J[1](c, axis) += moved * BlockShape<D>::slope(a, axis, p);
      }
    }
  }
  return J;
}

template <int D, class Real>
double Model<D, Real>::volume_ratio(std::vector<Real> const& u, Index head, bool mean) const {
  Index const block = block_of(head);
  double const hoop = axisymmetric ? moved_radius(u, head) / mean_radius(head) : 1;
  if (block < 0) return moved_edges(u, head).determinant() / edges(head).determinant() * hoop;
  bool const one = kernels::BlockNumbers<D>::points(groups[body_of_element[head]].integration) == 1;
  double least = std::numeric_limits<double>::infinity(), now = 0, rest = 0;
  for (int p = one ? -1 : 0; p < (one ? 0 : B); ++p) {
    auto const J = block_jacobians(u, block, p);
    double const ratio = J[1].determinant() / J[0].determinant();
    if (!(ratio >= least)) least = ratio;
    now += J[1].determinant(), rest += J[0].determinant();
  }
  return (mean ? now / rest : least) * hoop;
}

template <int D, class Real>
double Model<D, Real>::squared_gradients(std::vector<Real> const& u, Index head) const {
  Index const block = block_of(head);
  if (block < 0) {
    Mat<double, D> const inverse = moved_edges(u, head).inverse();
    return inverse.squaredNorm() + inverse.colwise().sum().squaredNorm() + (axisymmetric ? 1 / (C * std::pow(moved_radius(u, head), 2)) : 0);
  }
  bool const one = kernels::BlockNumbers<D>::points(groups[body_of_element[head]].integration) == 1;
  double largest = 0;
  for (int p = one ? -1 : 0; p < (one ? 0 : B); ++p) {
    Mat<double, D> const inverse = block_jacobians(u, block, p)[1].inverse();
    double squares = 0;
    for (int a = 0; a < B; ++a) {
      Vec<double, D> slope;
      for (int axis = 0; axis < D; ++axis) slope[axis] = BlockShape<D>::slope(a, axis, p);
      squares += (inverse.transpose() * slope).squaredNorm();
    }
    if (axisymmetric) {  // hoop weights N_a/r at the point
      double radius = 0, values = 0;
      for (int a = 0; a < B; ++a) {
        Index const vertex = host_block_vertex[blocked(block, a, B)];
        double const N = BlockShape<D>::value(a, p);
        radius += N * (reference[vertex][0] + static_cast<double>(u[static_cast<std::size_t>(vertex) * D]));
        values += N * N;
      }
      squares += values / (radius * radius);
    }
    largest = std::max(largest, squares);
  }
  return largest;
}

template <int D, class Real>
std::vector<double> Model<D, Real>::corner_volumes(Index head) const {
  Index const block = block_of(head);
  if (block >= 0) return {&block_corner_volume[static_cast<std::size_t>(block) * B], &block_corner_volume[static_cast<std::size_t>(block) * B] + B};
  double const like = std::abs(edges(head).determinant()) * Dim<D>::simplex_share * out_of_plane(head) / C;
  std::vector<double> masses(C);
  for (int a = 0; a < C; ++a) masses[a] = like * mass_share(head, a);
  return masses;
}

template <int D, class Real>
double Model<D, Real>::remembered(std::vector<Real> const& memory, Index head, int k) const {
  auto const& group = groups[body_of_element[head]];
  int const numbers = group.plastic->memory.numbers;
  Index const block = block_of(head);
  if (block < 0) return static_cast<double>(memory[group.memory_at + blocked(head - group.first, k, numbers)]);
  Index const points = kernels::BlockNumbers<D>::points(group.integration), b = block - group.first_block;
  double sum = 0;
  for (Index p = 0; p < points; ++p)
    sum += static_cast<double>(memory[group.block_memory_at + blocked(b / layout_width * layout_width * points + p * layout_width + b % layout_width, k, numbers)]);
  return sum / points;
}

template <int D, class Real>
double Model<D, Real>::mean_radius(Index e) const {
  double sum = 0;
  for (int a = 0; a < C; ++a) sum += reference[vertex_of(e, a)][0];
  return sum / C;
}

template <int D, class Real>
double Model<D, Real>::moved_radius(std::vector<Real> const& u, Index e) const {
  double outward = 0;
  for (int a = 0; a < C; ++a) outward += static_cast<double>(u[static_cast<std::size_t>(vertex_of(e, a)) * D]);
  return mean_radius(e) + outward / C;
}

template <int D, class Real>
double Model<D, Real>::mass_share(Index e, Index a) const {
  return axisymmetric ? kernels::ring_share<C>(reference[vertex_of(e, a)][0], mean_radius(e)) : 1;
}

template <int D, class Real>
double Model<D, Real>::joint_share(Index e, Index a, Index i) const {
  if (!host_share.empty() && !axisymmetric) return host_share[blocked(e, a * D + i, C * D)];
  if (!axisymmetric) return 1;
  auto const radius = [&](Index k) { return reference[vertex_of(e, k + (k >= a))][0]; };
  double mean = 0;
  for (Index k = 0; k < D; ++k) mean += radius(k) / D;
  return kernels::ring_share<D>(radius(i), mean);
}

template <int D, class Real>
std::array<double, D> Model<D, Real>::face_reach(Vec<double, D> const (&corner)[D]) const {
  std::array<double, D> reach;
  reach.fill(thickness);
  double radii = 0;
  for (auto const& x : corner) radii += x[0];
  for (int i = 0; i < D && axisymmetric; ++i) reach[i] = 2 * std::numbers::pi * (corner[i][0] + radii) / (D + 1);
  return reach;
}

template <int D, class Real>
void Model<D, Real>::set_motion(scene::Scene const& scene, Device& device) {
  std::size_t const n = static_cast<std::size_t>(n_vertices) * D;
  std::vector<Real> velocity(n, 0), inverse(n_vertices, 0);
  std::vector<Index> still;
  for (Index i = 0; i < n_vertices; ++i) inverse[i] = mass[i] > 0 ? static_cast<Real>(1 / mass[i]) : Real(0);
  for (auto const& group : groups) {
    auto const& body = scene.bodies[group.body];
    for (Index e = group.first; e < group.first + group.count; ++e)
      for (int a = 0; a < C && cell_of_element[e] >= 0; ++a) {
        Index const vertex = vertex_of(e, a);
        Vec3 x = origin;
        for (int c = 0; c < D; ++c) x[c] += reference[vertex][c];
        auto const start = body.velocity_at ? body.velocity_at(x[0], x[1], x[2]) : body.velocity;
        for (int c = 0; c < D; ++c) velocity[static_cast<std::size_t>(vertex) * D + c] = static_cast<Real>(start[c]);
        if (!axisymmetric || !on_axis[corner_node[static_cast<std::size_t>(e) * C + a]]) continue;
        velocity[static_cast<std::size_t>(vertex) * D] = 0;
        still.push_back(vertex);
      }
  }
  u = Buffer<Real>(device, "displacements", n);
  v = Buffer<Real>(device, "velocities", velocity);
  inverse_mass = Buffer<Real>(device, "inverse masses", inverse);
  std::sort(still.begin(), still.end());
  still.erase(std::unique(still.begin(), still.end()), still.end());
  axis = Buffer<Index>(device, "axis", still);
}

template <int D, class Real>
std::vector<int> Model<D, Real>::nodes_at(scene::Region const& where, int body, Source const& source, mesh::Mesh const& mesh) const {
  std::vector<int> nodes;
  if (where.inside) {
    for (int n = mesh.body_first_node[body]; n < mesh.body_first_node[body + 1]; ++n)
      if (where.inside(mesh.nodes[n][0], mesh.nodes[n][1], mesh.nodes[n][2])) nodes.push_back(n);
    if (nodes.empty()) throw Error(source, "no vertex of the body lies where the function says (it returned false everywhere)");
    return nodes;
  }
  auto const& names = mesh.named_nodes.at(body);
  auto const found = names.find(where.name);
  if (found != names.end()) return found->second;
  if (where.name == "front" || where.name == "back") return {};  // a flat model has none
  std::vector<std::string> known;
  for (auto const& [name, list] : names) known.push_back(name);
  throw Error(source, fmt::format("the body has no place \"{}\" (known: {}){}", where.name, fmt::join(known, ", "), suggestion(where.name, known)));
}

template <int D, class Real>
std::vector<int> Model<D, Real>::faces_at(scene::Region const& where, int body, Source const& source, mesh::Mesh const& mesh) const {
  if (!where.inside) {
    nodes_at(where, body, source, mesh);  // for its errors
    auto const& names = mesh.named_faces.at(body);
    auto const found = names.find(where.name);
    return found == names.end() ? std::vector<int>{} : found->second;
  }
  std::vector<int> faces;
  for (int f = 0; f < static_cast<int>(mesh.boundary.size()); ++f) {
    auto const& face = mesh.boundary[f];
    if (face.cell < mesh.body_first_cell[body] || face.cell >= mesh.body_first_cell[body + 1]) continue;
    Vec3 middle{0, 0, 0};
    for (int i = 0; i < D; ++i) middle += mesh.nodes[face.node[i]] / D;
    if (where.inside(middle[0], middle[1], middle[2])) faces.push_back(f);
  }
  if (faces.empty()) throw Error(source, "no face of the body lies where the function says (it returned false at every face's centre)");
  return faces;
}

template <int D, class Real>
std::vector<std::vector<Index>> Model<D, Real>::vertices_of_nodes(mesh::Mesh const& mesh) const {
  std::vector<std::vector<Index>> vertices(mesh.nodes.size());
  for (Index e = 0; e < n_elements; ++e)
    for (int a = 0; a < C && cell_of_element[e] >= 0; ++a) {
      auto& list = vertices[corner_node[static_cast<std::size_t>(e) * C + a]];
      Index const vertex = vertex_of(e, a);
      if (std::find(list.begin(), list.end(), vertex) == list.end()) list.push_back(vertex);
    }
  return vertices;
}

template <int D, class Real>
void Model<D, Real>::place_loads(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device) {
  if (!plan.holds && !plan.loads) return;
  using Loaded = kernels::LoadedVertex<D, Real>;
  if (plan.holds) {
    auto const vertices = vertices_of_nodes(mesh);
    for (int h = 0; h < static_cast<int>(scene.holds.size()); ++h) {
      auto const& hold = scene.holds[h];
      Loaded prototype;
      bool any = false;
      for (int c = 0; c < D; ++c) prototype.share[c] = hold.velocity[c] ? Real(1) : Real(0), any = any || hold.velocity[c];
      if (!any) continue;  // it concerns a direction that this dimension does not have
      std::vector<Loaded> list;
      for (int node : nodes_at(hold.where, hold.body, hold.source, mesh))
        for (Index vertex : vertices[node]) {
          prototype.vertex = vertex;
          list.push_back(prototype);
          if (axisymmetric && on_axis[node]) list.back().share[0] = 0;  // it stays there anyway
        }
      HoldSet<D, Real> set;
      set.hold = h;
      set.list = Buffer<Loaded>(device, "prescribed motion", list);
      set.impulse = Buffer<Real>(device, "prescribed motion", list.size() * D);
      set.held = Buffer<Real>(device, "prescribed motion", list.size() * D);
      holds.push_back(std::move(set));
    }
  }
  auto const add_load = [&](int traction, int pressure, int body, scene::Region const& where, Source const& source) {
    std::vector<double> share(static_cast<std::size_t>(n_vertices) * D, 0);
    std::vector<char> loaded(n_vertices, 0);
    for (int f : faces_at(where, body, source, mesh)) {
      auto const& face = mesh.boundary[f];
      Index const e = element_of_cell[face.cell];
      Vec<double, D> corner[D];
      for (int i = 0; i < D; ++i)
        for (int c = 0; c < D; ++c) corner[i][c] = mesh.nodes[face.node[i]][c];
      Vec<double, D> const normal = Dim<D>::face_normal(corner) / D;
      auto const reach = face_reach(corner);
      std::array<int, D> nodes;
      std::copy_n(face.node.begin(), D, nodes.begin());
      auto const shares = corner_shares(mesh, body, face.cell, nodes);
      int const* const mine = &corner_node[static_cast<std::size_t>(e) * C];
      for (int i = 0; i < D; ++i) {
        Index const vertex = vertex_of(e, static_cast<Index>(std::find(mine, mine + C, face.node[i]) - mine));
        Vec<double, D> const outward = normal * reach[i];
        loaded[vertex] = 1;
        for (int c = 0; c < D; ++c) share[static_cast<std::size_t>(vertex) * D + c] += shares[i] * (pressure >= 0 ? -outward[c] : outward.norm());
      }
    }
    std::vector<Loaded> list;
    for (Index vertex = 0; vertex < n_vertices; ++vertex)
      if (loaded[vertex]) {
        Loaded entry;
        entry.vertex = vertex;
        for (int c = 0; c < D; ++c) entry.share[c] = static_cast<Real>(share[static_cast<std::size_t>(vertex) * D + c]);
        list.push_back(entry);
      }
    LoadSet<D, Real> set;
    set.traction = traction, set.pressure = pressure;
    set.list = Buffer<Loaded>(device, "surface loads", list);
    loads.push_back(std::move(set));
  };
  for (int t = 0; t < static_cast<int>(scene.tractions.size()); ++t)
    add_load(t, -1, scene.tractions[t].body, scene.tractions[t].where, scene.tractions[t].source);
  for (int p = 0; p < static_cast<int>(scene.pressures.size()); ++p)
    add_load(-1, p, scene.pressures[p].body, scene.pressures[p].where, scene.pressures[p].source);
}

}  // namespace fissure::model
