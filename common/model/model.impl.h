// Building a model's arrays; instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "model/cells.impl.h"
#include "model/loads.impl.h"

namespace fissure::model {

using kernels::blocked;
using kernels::layout_width;

inline Index whole_packs(Index n) { return (n + layout_width - 1) / layout_width * layout_width; }

/// Where the thickness is free (`thin`) nothing keeps its volume: b_bar has nothing to average, and is full.
inline kernels::Integration integration(std::string const& word, bool thin) {
  using kernels::Integration;
  if (word == "assumed_strain") return Integration::assumed_strain;
  if (word == "full") return Integration::full;
  if (word == "b_bar") return thin ? Integration::full : Integration::b_bar;
  return Integration::one_point;
}

template <int D, class Real>
Model<D, Real>::Model(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh)
    : parts(mesh::block_parts(mesh.kind)),
      plan(make_plan(scene, mesh)),
      thickness(mesh.thickness),
      axisymmetric(Dim<D>::can_revolve && scene.two_d == "axisymmetric") {
  Vec3 low = mesh.nodes.at(0), high = low;
  for (auto const& x : mesh.nodes) low = low.cwiseMin(x), high = high.cwiseMax(x);
  origin = (low + high) / 2;
  if (axisymmetric) find_axis(scene, mesh);
  for (int b = 0; b < mesh.n_bodies(); ++b) {
    Group group;
    group.body = b;
    group.blocks = mesh.n_blocks(b);
    group.padded_blocks = whole_packs(group.blocks);
    group.padded_simplices = whole_packs(mesh.n_simplices(b));
    group.count = group.padded_simplices + group.padded_blocks * parts;  // padding blocks have parts, too
    group.first = n_elements, group.first_block = n_blocks;
    group.integration =
        integration(scene.bodies[b].mesh.integration, Dim<D>::has_plane_stress && scene.two_d == "plane stress");
    n_blocks += group.padded_blocks;
    auto const& material = scene.materials.at(scene.bodies[b].material);
    group.split = material.joint.has_value();
    group.rankine = group.split && starts_by_stress(*material.joint, group.padded_simplices > 0, group.blocks > 0);
    group.inserted = group.split && std::visit([](auto const& joint) { return joint.inserted; }, *material.joint);
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
  if (flags.empty()) flags = Buffer<int>(device, "flags", 3);
}

/// Mesh nodes on the axis of revolution; refuses those beyond it. Radii are measured from it, so the origin lies on it
/// too.
template <int D, class Real>
void Model<D, Real>::find_axis(scene::Scene const& scene, mesh::Mesh const& mesh) {
  double largest = 0;
  for (auto const& x : mesh.nodes) largest = std::max(largest, std::abs(x[0]));
  double const rounding = 1e-9 * largest;
  for (int b = 0; b < mesh.n_bodies(); ++b)
    for (int n = mesh.body_first_node[b]; n < mesh.body_first_node[b + 1]; ++n)
      if (double const x = mesh.nodes[n][0]; x < -rounding)
        throw Error(
            scene.bodies[b].source,
            fmt::format("body \"{}\": a node lies at x = {:g} m, beyond the axis (with two_d = \"axisymmetric\" x is "
                        "the radius); draw the half of its section where x >= 0, or take rod or ball, which do so",
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
    for (Index cell = mesh.body_first_cell[group.body], k = 0; cell < mesh.body_first_cell[group.body + 1];
         ++cell, ++k) {
      Index const simplices = mesh.n_simplices(group.body),
                  e = group.first + k + (k < simplices ? 0 : group.padded_simplices - simplices);
      element_of_cell[cell] = e;
      cell_of_element[e] = cell;
      body_of_element[e] = group.body;
      int* const nodes = &corner_node[static_cast<std::size_t>(e) * C];
      std::transform(&mesh.cells[static_cast<std::size_t>(cell) * C],
                     &mesh.cells[static_cast<std::size_t>(cell) * C] + C, nodes,
                     [&](int node) { return mesh.place(node); });
      std::sort(nodes, nodes + C);
    }
}

/// Bodies that can crack: a vertex per corner of a cell, in the order of the slots for its forces. Others: a vertex per
/// node, and the slots of the corners that hang on it.
template <int D, class Real>
void Model<D, Real>::number_vertices(mesh::Mesh const& mesh, Device& device) {
  Index slots = 0;
  for (auto& group : groups) {
    group.first_slot = slots, group.first_block_slot = slots + group.padded_simplices * C;
    slots = group.first_block_slot + group.padded_blocks * B;
    // numbers across a bond follow from each other
    if (!mesh.bonded.empty()) slots = std::max(slots, (group.first + group.count) * C);
  }
  if (!plan.shared && !plan.blocks) {
    n_vertices = slots;
    reference.resize(n_vertices);
    return;
  }
  std::vector<Index> vertex_of_node(mesh.nodes.size(), -1);
  host_corner_vertex.assign(static_cast<std::size_t>(n_elements) * C, -1);
  host_block_vertex.assign(static_cast<std::size_t>(n_blocks) * B, -1);
  for (auto const& group : groups) {
    auto const at_node = [&](int node) {
      Index& vertex = vertex_of_node[node];
      if (vertex < 0) vertex = n_vertices++;
      return vertex;
    };
    for (Index e = group.first; e < group.first + group.padded_simplices; ++e) {
      if (cell_of_element[e] < 0 && !group.split) continue;
      for (int a = 0; a < C; ++a)
        host_corner_vertex[blocked(e, a, C)] =
            group.split ? n_vertices++ : at_node(corner_node[static_cast<std::size_t>(e) * C + a]);
    }
    for (Index b = group.first_block; b < group.first_block + group.padded_blocks; ++b) {
      bool const padding = real_block(group, b) != b;
      if (padding && !group.split) continue;
      int const* const nodes =
          padding
              ? nullptr
              : &mesh.blocks[static_cast<std::size_t>(mesh.body_first_block[group.body] + b - group.first_block) * B];
      for (int a = 0; a < B; ++a) host_block_vertex[blocked(b, a, B)] = group.split ? n_vertices++ : at_node(nodes[a]);
      for (Index k = 0; k < parts; ++k)
        for (int a = 0; a < C; ++a) {
          Index const part = part_of(group, b, k);
          auto const corner =
              padding ? a : std::find(nodes, nodes + B, corner_node[static_cast<std::size_t>(part) * C + a]) - nodes;
          host_corner_vertex[blocked(part, a, C)] = host_block_vertex[blocked(b, static_cast<Index>(corner), B)];
        }
    }
    if (!mesh.bonded.empty()) n_vertices = std::max(n_vertices, (group.first + group.count) * C);  // as slots
  }
  if (plan.shared) {  // other padding elements hang on vertices of their own that nothing moves
    Index const idle = n_vertices;
    n_vertices = whole_packs(n_vertices + std::max(C, B));
    for (Index e = 0; e < n_elements; ++e)
      for (int a = 0; a < C; ++a)
        if (Index& vertex = host_corner_vertex[blocked(e, a, C)]; vertex < 0) vertex = idle + a;
    for (Index b = 0; b < n_blocks; ++b)
      for (int a = 0; a < B; ++a)
        if (Index& vertex = host_block_vertex[blocked(b, a, B)]; vertex < 0) vertex = idle + a;
  }
  reference.resize(n_vertices);
  corner_vertex = Buffer<Index>(device, "corner vertices", host_corner_vertex);
  block_vertex = Buffer<Index>(device, "block corners", host_block_vertex);
  if (!plan.shared) return;  // slots are vertices

  auto const over_slots = [&](auto&& f) {
    for (auto const& group : groups) {
      Index slot = group.first_slot;
      for (Index e = group.first; e < group.first + group.padded_simplices; ++e)
        for (int a = 0; a < C; ++a) f(vertex_of(e, a), slot++);
      for (Index b = group.first_block; b < group.first_block + group.padded_blocks; ++b)
        for (int a = 0; a < B; ++a) f(host_block_vertex[blocked(b, a, B)], slot++);
    }
  };
  std::vector<Index> first(n_vertices + 1, 0);
  over_slots([&](Index vertex, Index) { ++first[vertex + 1]; });
  for (Index i = 0; i < n_vertices; ++i) first[i + 1] += first[i];
  std::vector<Index> next(first.begin(), first.end() - 1), list(first.back());
  over_slots([&](Index vertex, Index slot) { list[next[vertex]++] = slot; });
  corner_first = Buffer<Index>(device, "vertex corners", first);
  corner_list = Buffer<Index>(device, "vertex corners", list);
  corners = Buffer<Real>(device, "corner forces", static_cast<std::size_t>(slots) * D);
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
    group.viscosity =
        material.viscosity + material.critical_share * 2 * quality[group.body].mean_edge * std::sqrt(young * density);
    for (Index e = group.first; e < group.first + group.count; ++e) {
      // padding is a copy of the first element, without mass
      Index const from = cell_of_element[e] >= 0 ? e : group.first;
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
          mass[vertex_of(e, a)] +=
              density * std::abs(determinant) * Dim<D>::simplex_share * out_of_plane(e) / C * mass_share(e, a);
    }
  }
  X = Buffer<Real>(device, "reference coordinates", coordinates);
  parity = Buffer<std::int8_t>(device, "orientation", orientation);
  force = Buffer<Real>(device, "forces", static_cast<std::size_t>(n_vertices) * D);
  if (plan.viscous || plan.joints) viscous_work = Buffer<double>(device, "viscous work", n_elements);
}

/// The law of every face that a bond joins, by its use in the mesh, counted from 1; fills host_bond_laws.
template <int D, class Real>
std::vector<std::uint8_t> Model<D, Real>::place_bond_laws(scene::Scene const& scene, mesh::Mesh const& mesh) {
  if (mesh.bonded.empty()) return {};
  std::vector<std::uint8_t> law_of_use(mesh.cells.size(), 0);
  std::map<std::pair<int, double>, std::uint8_t> known;  // bond and friction
  for (auto const& [use, bond, joined] : mesh.bonded) {
    double friction = std::numeric_limits<double>::infinity();
    for (int const side : use) {
      auto const& contact = scene.materials[scene.bodies[mesh.body_of_cell(side / C)].material].contact;
      friction = std::min(friction, contact ? contact->friction : 0);
    }
    auto const [law, fresh] =
        known.emplace(std::pair(bond, friction), static_cast<std::uint8_t>(host_bond_laws.size() + 1));
    if (fresh) {
      constexpr std::size_t most = std::numeric_limits<std::uint8_t>::max();
      if (host_bond_laws.size() == most)
        throw Error(scene.bonds[bond].source,
                    fmt::format("there are more than {} bonds; one bond can join many bodies", most));
      host_bond_laws.push_back(scene.bonds[bond].joint);
      host_bond_laws.back().residual = friction;
      host_bond_laws.back().prepare();
    }
    for (int const side : use) law_of_use[side] = law->second;
  }
  return law_of_use;
}

/// A joint on every inner face between cells, and where bodies are bonded. Its size h is the distance between the two
/// centroids normal to it, for simplices d/(d+1) (V1 + V2)/A.
template <int D, class Real>
void Model<D, Real>::place_joints(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device) {
  auto const across = mesh::neighbours(mesh);
  std::size_t const faces = static_cast<std::size_t>(n_elements) * C;
  host_link.resize(faces);
  joint_size.assign(faces, 0);
  std::vector<Real> weights(faces, 0), stiffnesses(faces, 0);
  std::vector<double> shares(plan.blocks ? faces * D : 0, 1);  // of each corner in a joint's area, 1 on average
  auto const given = mesh::joint_strengths(scene, mesh);
  std::vector<double> strengths(given.of_face.empty() ? 0 : faces, 1), any_plane = strengths;
  std::vector<std::uint8_t> whole(plan.insertion ? faces : 0, 0);
  auto const bonds = place_bond_laws(scene, mesh);
  host_bond.assign(bonds.empty() ? 0 : faces, 0);
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
  // of the cell's whole face, so that both parts of a block's face and both sides agree
  auto const across_normal = [&](Index e, int a) {
    Vec<double, D> normal;
    if (block_of(e) < 0) {
      Vec<double, D> corner[D];
      for (int i = 0; i < D; ++i) corner[i] = reference_of(vertex_of(e, i + (i >= a)));
      normal = Dim<D>::face_normal(corner);
    } else {
      Vec<double, D> corner[P];
      for (int i = 0; i < P; ++i)
        corner[i] =
            reference_of(host_block_vertex[blocked(block_of(e), BlockShape<D>::face(face_of_block(e, a), i), B)]);
      normal = Dim<D>::face_normal(corner);
    }
    return Vec<double, D>(normal / normal.norm());
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
        int const a = static_cast<int>(
            std::find(mine, mine + C, mesh.place(mesh.cells[static_cast<std::size_t>(cell) * C + b])) - mine);
        int face = 0;
        while (std::find(mine, mine + C, theirs[face]) != mine + C) ++face;
        Vec<double, D> corner[D];
        for (int i = 0; i < D; ++i) corner[i] = point(e, i + (i >= a));
        double const area = Dim<D>::face_normal(corner).norm();
        double const h = group.blocks == 0 ? static_cast<double>(D) / (D + 1) * (measure(e) + measure(other)) / area
                                           : std::abs((centre(other) - centre(e)).dot(across_normal(e, a)));
        if (plan.blocks) {
          std::array<int, D> nodes;
          for (int i = 0; i < D; ++i) nodes[i] = mine[i + (i >= a)];
          auto const own = corner_shares(mesh, group.body, cell, nodes),
                     facing = corner_shares(mesh, group.body, neighbour, nodes);
          for (int i = 0; i < D; ++i) shares[blocked(e, a * D + i, C * D)] = 0.5 * (own[i] + facing[i]);
        }
        std::size_t const at = blocked(e, a, C);
        host_link[at] = other * 4 + face;
        joint_size[at] = h;
        auto const reach = face_reach(corner);
        weights[at] = static_cast<Real>(area / D * std::accumulate(reach.begin(), reach.end(), 0.0) / D);
        std::uint8_t const bond = bonds.empty() ? 0 : bonds[static_cast<std::size_t>(cell) * C + b];
        stiffnesses[at] = static_cast<Real>((bond > 0 ? host_bond_laws[bond - 1].penalty : penalty) / h);
        if (bond > 0) host_bond[at] = bond;
        if (std::size_t const use = static_cast<std::size_t>(cell) * C + b; !strengths.empty())
          strengths[at] = given.of_face[use], any_plane[at] = given.any_plane[use];
        if (group.inserted) whole[at] = bond == 0 && (strengths.empty() || strengths[at] > 0);
      }
    }
  }
  link = Buffer<Index>(device, "joint links", host_link);
  weight = Buffer<Real>(device, "joint areas", weights);
  bool const simplices = std::any_of(groups.begin(), groups.end(),
                                     [](Group const& group) { return group.split && group.padded_simplices > 0; });
  joints = JointArrays<C, D, Real>(device, simplices ? stiffnesses : std::vector<Real>{}, D, plan.rubbing_joints);
  std::array<int, 3> broken{0, 0, 0};  // as flags
  if (simplices && !strengths.empty()) broken[1] = joints.set_strengths(device, strengths);
  if (!bonds.empty())
    joints.set_bonds(device, host_bond), bond_laws = Buffer<laws::CohesiveJoint>(device, "bond laws", host_bond_laws);
  dissipated = Buffer<double>(device, "joint dissipation", n_elements + n_blocks);
  bool const blocks =
      std::any_of(groups.begin(), groups.end(), [](Group const& group) { return group.split && group.blocks > 0; });
  if (blocks) place_block_joints(weights, stiffnesses, shares, device);
  if (blocks && !strengths.empty()) broken[2] = block_joints.set_strengths(device, least_of_parts(strengths));
  if (std::any_of(groups.begin(), groups.end(), [](Group const& group) { return group.rankine; })) {
    if (simplices) joints.begin_by_stress(device, any_plane);
    if (blocks) block_joints.begin_by_stress(device, any_plane.empty() ? any_plane : least_of_parts(any_plane));
    stressed = Buffer<std::uint8_t>(device, "stress", n_elements);
  }
  for (double const strength : strengths)
    if (strength > 0) least_strength = std::min(least_strength, strength);
  if (plan.insertion && simplices) joints.insert_on_demand(device, whole);
  if (plan.insertion && blocks) block_joints.insert_on_demand(device, whole_of_parts(whole));
  if (plan.insertion || !stressed.empty())
    stress = Buffer<double>(device, "stress", static_cast<std::size_t>(n_elements) * 6);
  // heard with the first step's news
  flags = Buffer<int>(device, "flags", std::vector<int>(broken.begin(), broken.end()));
}

/// Of the two triangles that a block's face is cut into the weaker one counts.
template <int D, class Real>
std::vector<double> Model<D, Real>::least_of_parts(std::vector<double> const& of_parts) const {
  std::vector<double> strengths(static_cast<std::size_t>(n_blocks) * F, 1);
  for (Index b = 0; b < n_blocks; ++b)
    for (int a = 0; a < F; ++a) {
      auto const parts_here = parts_at(b, a);
      if (parts_here.empty()) continue;
      double& strength = strengths[blocked(b, a, F)] = 1e9;
      for (Index const at : parts_here) strength = std::min(strength, of_parts[blocked(at >> 2, at & 3, C)]);
    }
  return strengths;
}

template <int D, class Real>
std::vector<std::uint8_t> Model<D, Real>::whole_of_parts(std::vector<std::uint8_t> const& of_parts) const {
  std::vector<std::uint8_t> whole(static_cast<std::size_t>(n_blocks) * F, 0);
  for (Index b = 0; b < n_blocks; ++b)
    for (int a = 0; a < F; ++a)
      for (Index const at : parts_at(b, a)) whole[blocked(b, a, F)] = of_parts[blocked(at >> 2, at & 3, C)];
  return whole;
}

/// Joints of parts of blocks as those of the blocks: their areas add up at the corners of a block's face. At one beside
/// a simplex the number is the simplex' own, to the last bit.
template <int D, class Real>
void Model<D, Real>::place_block_joints(std::vector<Real> const& weights, std::vector<Real> const& stiffnesses,
                                        std::vector<double> const& shares, Device& device) {
  using Shape = BlockShape<D>;
  std::size_t const faces = static_cast<std::size_t>(n_blocks) * F;
  face_parts.assign(faces * K, -1);
  std::vector<Index> facing(faces * P);
  std::vector<Real> areas(faces * P, 0), stiff(faces, 0), X(static_cast<std::size_t>(n_blocks) * B * D);
  for (Index b = 0; b < n_blocks; ++b) {
    for (int a = 0; a < F; ++a)
      for (int i = 0; i < P; ++i)
        facing[blocked(b, a * P + i, F * P)] = host_block_vertex[blocked(b, Shape::face(a, i), B)];
  }
  for (auto const& group : groups)
    for (Index b = group.first_block; b < group.first_block + group.padded_blocks; ++b)
      for (int a = 0; a < B; ++a)
        for (int c = 0; c < D; ++c)
          X[blocked(b, a * D + c, B * D)] =
              static_cast<Real>(reference[host_block_vertex[blocked(real_block(group, b), a, B)]][c]);
  for (Index e = 0; e < n_elements; ++e)
    for (int a = 0; a < C; ++a) {
      std::size_t const at = blocked(e, a, C);
      Index const b = block_of(e), other = host_link[at] >> 2, other_face = host_link[at] & 3;
      if (b < 0 || other == e) continue;
      int const face = face_of_block(e, a);
      Index* part = &face_parts[(static_cast<std::size_t>(b) * F + face) * K];
      while (*part >= 0) ++part;
      *part = e * 4 + a;
      stiff[blocked(b, face, F)] = stiffnesses[at];
      for (int i = 0; i < D; ++i) {
        int const point = point_on_face(e, a, i, face);
        facing[blocked(b, face * P + point, F * P)] = vertex_of(other, i + (i >= other_face));
        areas[blocked(b, face * P + point, F * P)] +=
            weights[at] * joint_share(e, a, i) * static_cast<Real>(shares[blocked(e, a * D + i, C * D)]);
      }
    }
  std::vector<Index> others(faces, -1);
  for (Index b = 0; b < n_blocks; ++b)
    for (int a = 0; a < F; ++a)
      if (auto const here = parts_at(b, a); !here.empty())
        others[blocked(b, a, F)] = host_link[blocked(here[0] >> 2, here[0] & 3, C)] >> 2;
  if (std::any_of(groups.begin(), groups.end(),
                  [](Group const& group) { return (group.rankine || group.inserted) && group.blocks > 0; }))
    beyond = Buffer<Index>(device, "block joints", others);
  block_corners = Buffer<Real>(device, "block corners", X);
  across = Buffer<Index>(device, "block joints", facing);
  block_area = Buffer<Real>(device, "joint areas", areas);
  block_joints = JointArrays<F, P, Real>(device, stiff, D, plan.rubbing_joints);
}

template <int D, class Real>
int Model<D, Real>::point_on_face(Index e, Index a, int i, int face) const {
  for (int point = 0; point < P; ++point)
    if (host_block_vertex[blocked(block_of(e), BlockShape<D>::face(face, point), B)] == vertex_of(e, i + (i >= a)))
      return point;
  return -1;
}

template <int D, class Real>
int Model<D, Real>::face_of_block(Index e, Index a) const {
  for (int face = 0; face < F; ++face) {
    int on_it = 0;
    for (int i = 0; i < D; ++i) on_it += point_on_face(e, a, i, face) >= 0;
    if (on_it == D) return face;
  }
  return -1;
}

template <int D, class Real>
Index Model<D, Real>::block_face(Index e, Index a) const {
  Index const b = block_of(e);
  for (Index k = 0; b >= 0 && !face_parts.empty() && k < F * K; ++k)
    if (face_parts[static_cast<std::size_t>(b) * F * K + k] == e * 4 + a) return b * F + k / K;
  return -1;
}

template <int D, class Real>
int Model<D, Real>::block_point(Index e, Index a, int i) const {
  return point_on_face(e, a, i, block_face(e, a) % F);
}

template <int D, class Real>
Real Model<D, Real>::joint_area(BreakingView<Real> const& now, Index e, Index a, int i) const {
  Index const face = block_face(e, a);
  if (face < 0) return now.weight[blocked(e, a, C)] * joint_share(e, a, i);
  int const point = block_point(e, a, i);
  int sharing = 0;
  for (Index k = 0; k < K; ++k)
    for (int j = 0; j < D; ++j) {
      Index const part = face_parts[static_cast<std::size_t>(face) * K + k];
      sharing += block_point(part >> 2, part & 3, j) == point;
    }
  return now.block_area[blocked(face / F, face % F * P + point, F * P)] / static_cast<Real>(sharing);
}

template <int D, class Real>
typename Model<D, Real>::Places Model<D, Real>::places_at(std::vector<Index> const& faces) const {
  Places at;
  for (Index const of : faces) {
    Index const e = of >> 2, a = of & 3, link = host_link[blocked(e, a, C)];
    for (Index const end : {of, link})
      for (int i = 0; i < D; ++i)
        for (int c = 0; c < D; ++c)
          at.displacements.push_back(static_cast<std::size_t>(vertex_of(end >> 2, i + (i >= (end & 3)))) * D + c);
    Index const face = block_face(e, a);
    if (face < 0) at.areas.push_back(blocked(e, a, C));
    for (int i = 0; i < P && face >= 0; ++i) at.block_areas.push_back(blocked(face / F, face % F * P + i, F * P));
    at.elements.push_back(e);
  }
  return at;
}

template <int D, class Real>
void Model<D, Real>::unlink(Index e, Index a) {
  std::size_t const at = blocked(e, a, C);
  host_link[at] = e * 4 + a;
  link.upload_one(at, host_link[at]);
  weight.upload_one(at, Real(0));
  Index const face = block_face(e, a);
  for (int i = 0; i < P && face >= 0; ++i) {
    std::size_t const point = blocked(face / F, face % F * P + i, F * P);
    across.upload_one(point, host_block_vertex[blocked(face / F, BlockShape<D>::face(face % F, i), B)]);
    block_area.upload_one(point, Real(0));
  }
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
    static_cast<laws::ElasticConstants&>(law) =
        std::visit([](auto const& bulk) -> laws::ElasticConstants { return bulk; }, material.bulk);
    law.logarithmic = flow.logarithmic, law.bisection = flow.bisection;
    law.plane_stress = Dim<D>::has_plane_stress && scene.two_d == "plane stress";
    law.flow.which = static_cast<int>(flow.law.index());
    bool has_back = false;
    std::visit(
        [&]<class Law>(Law given) {
          if constexpr (std::is_base_of_v<laws::Curves, Law>) {
            curves.emplace_back(device, "yield curves", flow.curves);
            given.numbers = curves.back().data();
          }
          if constexpr (requires { given.melting_rise; }) given.melting_rise = given.melting - flow.heat.start;
          has_back = Law::has_back;
          std::get<Law>(law.flow.laws) = given;
        },
        flow.law);
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
    numbers += static_cast<std::size_t>(group.padded_simplices) * m.numbers;
    Index const points = group.padded_blocks * kernels::BlockNumbers<D>::points(group.integration);
    group.block_memory_at = numbers, group.first_point = all_points;
    numbers += static_cast<std::size_t>(points) * m.numbers;
    all_points += points;
    auto const& body = scene.bodies[group.body];
    if (flow.averaged && group.blocks > 0)
      throw Error(body.source,
                  fmt::format("body \"{}\" has blocks, and its material plastic{{ pressure = \"averaged\" }} (which is "
                              "for simplices); write mesh = {{ integration = \"b_bar\" }} instead",
                              body.name));
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
  auto const at = [&](int a, int c) {
    return static_cast<double>(u[static_cast<std::size_t>(vertex_of(e, a)) * D + c]);
  };
  for (int b = 0; b < D; ++b)
    for (int c = 0; c < D; ++c) moved(c, b) = moved(c, b) + at(b + 1, c) - at(0, c);
  return moved;
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
Real Model<D, Real>::joint_share(Index e, Index a, Index i) const {
  if (!axisymmetric) return 1;
  auto const radius = [&](Index k) { return static_cast<Real>(reference[vertex_of(e, k + (k >= a))][0]); };
  Real radii = radius(0);
  for (Index k = 1; k < D; ++k) radii += radius(k);
  return kernels::ring_share<D>(radius(i), static_cast<Real>(radii * Real(1.0 / D)));
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

}  // namespace fissure::model
