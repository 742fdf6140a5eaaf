// Interfaces between cells: joints on faces, of simplices and of blocks, and bonds; a part of model.impl.h.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "model/model.h"

namespace fissure::model {

using kernels::blocked;

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
        known.emplace(std::pair(bond, friction), static_cast<std::uint8_t>(interfaces.host_bond_laws.size() + 1));
    if (fresh) {
      constexpr std::size_t most = std::numeric_limits<std::uint8_t>::max();
      if (interfaces.host_bond_laws.size() == most)
        throw Error(scene.bonds[bond].source,
                    fmt::format("there are more than {} bonds; one bond can join many bodies", most));
      interfaces.host_bond_laws.push_back(scene.bonds[bond].joint);
      interfaces.host_bond_laws.back().residual = friction;
      interfaces.host_bond_laws.back().prepare();
    }
    for (int const side : use) law_of_use[side] = law->second;
  }
  return law_of_use;
}

/// The mean of the corners of the cell that an element is or is part of [m].
template <int D, class Real>
Vec<double, D> Model<D, Real>::cell_centre(Index e) const {
  Vec<double, D> x = Vec<double, D>::Zero();
  Index const block = block_of(e);
  for (int a = 0; a < (block < 0 ? C : B); ++a) {
    auto const& corner = vertices.reference[block < 0 ? vertex_of(e, a) : blocks.host_vertex[blocked(block, a, B)]];
    for (int c = 0; c < D; ++c) x[c] += corner[c] / (block < 0 ? C : B);
  }
  return x;
}

/// Normal of the cell's whole face, so that both parts of a block's face and both sides agree.
template <int D, class Real>
Vec<double, D> Model<D, Real>::cell_face_normal(FaceId face) const {
  Vec<double, D> normal;
  if (block_of(face.element) < 0) {
    Vec<double, D> corner[D];
    for (int i = 0; i < D; ++i) corner[i] = reference_of(face_vertex(face, i));
    normal = Dim<D>::face_normal(corner);
  } else {
    Vec<double, D> corner[P];
    for (int i = 0; i < P; ++i)
      corner[i] = reference_of(
          blocks.host_vertex[blocked(block_of(face.element), BlockShape<D>::face(face_of_block(face), i), B)]);
    normal = Dim<D>::face_normal(corner);
  }
  return normal / normal.norm();
}

/// A joint on every inner face between cells, and where bodies are bonded.
template <int D, class Real>
void Model<D, Real>::place_joints(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device) {
  auto const given = mesh::joint_strengths(scene, mesh);
  JointNumbers joints(static_cast<std::size_t>(elements.count) * C, plan, !given.of_face.empty());
  link_faces(scene, mesh, given, joints);
  make_joint_arrays(joints, device);
}

/// Finds the faces that lie on each other, and the numbers of the joints between them. Their size h is the distance
/// between the two centroids normal to the face, for simplices d/(d+1) (V1 + V2)/A.
template <int D, class Real>
void Model<D, Real>::link_faces(scene::Scene const& scene, mesh::Mesh const& mesh, mesh::JointStrengths const& given,
                                JointNumbers& joints) {
  auto const across = mesh::neighbours(mesh);
  auto const bonds = place_bond_laws(scene, mesh);
  std::size_t const faces = joints.area.size();
  interfaces.host_link.resize(faces);
  interfaces.size.assign(faces, 0);
  interfaces.host_bond.assign(bonds.empty() ? 0 : faces, 0);
  auto const point = [&](Index e, int a) {
    Vec<double, D> x;
    Vec3 const node = mesh.nodes[elements.node[static_cast<std::size_t>(e) * C + a]];
    for (int c = 0; c < D; ++c) x[c] = node[c];
    return x;
  };
  auto const measure = [&](Index e) {
    Mat<double, D> edges;
    for (int b = 0; b < D; ++b) edges.col(b) = point(e, b + 1) - point(e, 0);
    return std::abs(edges.determinant()) * Dim<D>::simplex_share;
  };
  for (Index e = 0; e < elements.count; ++e)
    for (int a = 0; a < C; ++a) interfaces.host_link[blocked(e, a, C)] = FaceId{e, a}.packed();
  for (auto const& group : groups) {
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    if (!material.joint) continue;
    double const penalty = std::visit([](auto const& law) { return law.penalty; }, *material.joint);
    for (std::size_t use = static_cast<std::size_t>(mesh.body_first_cell[group.body]) * C;
         use < static_cast<std::size_t>(mesh.body_first_cell[group.body + 1]) * C; ++use) {
      Index const cell = static_cast<Index>(use / C), e = elements.of_cell[cell];
      int const neighbour_cell = across[use];
      if (neighbour_cell < 0) continue;
      Index const other = elements.of_cell[neighbour_cell];
      if (block_of(e) >= 0 && block_of(e) == block_of(other)) continue;
      // The cell's corner is some sorted corner; the other side's face is opposite its corner that is not shared.
      int const* const mine = &elements.node[static_cast<std::size_t>(e) * C];
      int const* const theirs = &elements.node[static_cast<std::size_t>(other) * C];
      FaceId const here{e, static_cast<int>(std::find(mine, mine + C, mesh.place(mesh.cells[use])) - mine)};
      FaceId there{other, 0};
      while (std::find(mine, mine + C, theirs[there.face]) != mine + C) ++there.face;
      Vec<double, D> corner[D];
      for (int i = 0; i < D; ++i) corner[i] = point(e, here.corner(i));
      double const area = Dim<D>::face_normal(corner).norm();
      double const h = group.blocks == 0 ? static_cast<double>(D) / (D + 1) * (measure(e) + measure(other)) / area
                                         : std::abs((cell_centre(other) - cell_centre(e)).dot(cell_face_normal(here)));
      if (plan.blocks) {
        std::array<int, D> nodes;
        for (int i = 0; i < D; ++i) nodes[i] = mine[here.corner(i)];
        auto const own = corner_shares(mesh, group.body, cell, nodes),
                   facing = corner_shares(mesh, group.body, neighbour_cell, nodes);
        for (int i = 0; i < D; ++i) joints.share[blocked(e, here.face * D + i, C * D)] = 0.5 * (own[i] + facing[i]);
      }
      std::size_t const at = blocked(e, here.face, C);
      interfaces.host_link[at] = there.packed();
      interfaces.size[at] = h;
      auto const reach = face_reach(corner);
      joints.area[at] = static_cast<Real>(area / D * std::accumulate(reach.begin(), reach.end(), 0.0) / D);
      std::uint8_t const bond = bonds.empty() ? 0 : bonds[use];
      joints.stiffness[at] = static_cast<Real>((bond > 0 ? interfaces.host_bond_laws[bond - 1].penalty : penalty) / h);
      if (bond > 0) interfaces.host_bond[at] = bond;
      if (!joints.strength.empty())
        joints.strength[at] = given.of_face[use], joints.any_plane[at] = given.any_plane[use];
      if (group.inserted) joints.whole[at] = bond == 0 && (joints.strength.empty() || joints.strength[at] > 0);
    }
  }
}

template <int D, class Real>
void Model<D, Real>::make_joint_arrays(JointNumbers const& numbers, Device& device) {
  auto const any = [&](auto&& has) { return std::any_of(groups.begin(), groups.end(), has); };
  bool const of_simplices = any([](Group const&group) { return group.split && group.padded_simplices > 0; }),
             of_blocks = any([](Group const&group) { return group.split && group.blocks > 0; });
  interfaces.link = Buffer<Index>(device, "joint links", interfaces.host_link);
  interfaces.area = Buffer<Real>(device, "joint areas", numbers.area);
  auto& simplices = interfaces.joints;
  simplices =
      JointArrays<C, D, Real>(device, of_simplices ? numbers.stiffness : std::vector<Real>{}, D, plan.rubbing_joints);
  std::array<int, Notice::count> broken{};
  if (of_simplices && !numbers.strength.empty())
    broken[Notice::joints] = simplices.set_strengths(device, numbers.strength);
  if (has_bonds()) {
    simplices.set_bonds(device, interfaces.host_bond);
    interfaces.bond_laws = Buffer<laws::CohesiveJoint>(device, "bond laws", interfaces.host_bond_laws);
  }
  interfaces.dissipated = Buffer<double>(device, "joint dissipation", elements.count + blocks.count);
  if (of_blocks) place_block_joints(numbers, device);
  if (of_blocks && !numbers.strength.empty())
    broken[Notice::block_joints] = interfaces.block_joints.set_strengths(device, least_of_parts(numbers.strength));
  if (any([](Group const& group) { return group.rankine; })) {
    if (of_simplices) simplices.begin_by_stress(device, numbers.any_plane);
    if (of_blocks)
      interfaces.block_joints.begin_by_stress(
          device, numbers.any_plane.empty() ? numbers.any_plane : least_of_parts(numbers.any_plane));
    interfaces.stressed = Buffer<std::uint8_t>(device, "stress", elements.count);
  }
  for (double const strength : numbers.strength)
    if (strength > 0) interfaces.least_strength = std::min(interfaces.least_strength, strength);
  if (plan.insertion && of_simplices) simplices.insert_on_demand(device, numbers.whole);
  if (plan.insertion && of_blocks) interfaces.block_joints.insert_on_demand(device, whole_of_parts(numbers.whole));
  if (plan.insertion || !interfaces.stressed.empty())
    interfaces.stress = Buffer<double>(device, "stress", static_cast<std::size_t>(elements.count) * 6);
  // heard with the first step's news
  flags = Buffer<int>(device, "flags", std::vector<int>(broken.begin(), broken.end()));
}

/// Of the two triangles that a block's face is cut into the weaker one counts.
template <int D, class Real>
std::vector<double> Model<D, Real>::least_of_parts(std::vector<double> const& of_parts) const {
  std::vector<double> strengths(static_cast<std::size_t>(blocks.count) * F, 1);
  for (Index b = 0; b < blocks.count; ++b)
    for (int a = 0; a < F; ++a) {
      auto const parts_here = parts_at(b, a);
      if (parts_here.empty()) continue;
      double& strength = strengths[blocked(b, a, F)] = 1e9;
      for (auto const& [e, face] : parts_here) strength = std::min(strength, of_parts[blocked(e, face, C)]);
    }
  return strengths;
}

template <int D, class Real>
std::vector<std::uint8_t> Model<D, Real>::whole_of_parts(std::vector<std::uint8_t> const& of_parts) const {
  std::vector<std::uint8_t> whole(static_cast<std::size_t>(blocks.count) * F, 0);
  for (Index b = 0; b < blocks.count; ++b)
    for (int a = 0; a < F; ++a)
      for (auto const& [e, face] : parts_at(b, a)) whole[blocked(b, a, F)] = of_parts[blocked(e, face, C)];
  return whole;
}

/// Joints of parts of blocks as those of the blocks: their areas add up at the corners of a block's face. At one beside
/// a simplex the number is the simplex' own, to the last bit.
template <int D, class Real>
void Model<D, Real>::place_block_joints(JointNumbers const& numbers, Device& device) {
  using Shape = BlockShape<D>;
  std::size_t const faces = static_cast<std::size_t>(blocks.count) * F;
  interfaces.parts.assign(faces * K, FaceId{-1, 0});
  std::vector<Index> facing(faces * P);
  std::vector<Real> areas(faces * P, 0), stiff(faces, 0), X(static_cast<std::size_t>(blocks.count) * B * D);
  for (Index b = 0; b < blocks.count; ++b) {
    for (int a = 0; a < F; ++a)
      for (int i = 0; i < P; ++i)
        facing[blocked(b, a * P + i, F * P)] = blocks.host_vertex[blocked(b, Shape::face(a, i), B)];
  }
  for (auto const& group : groups)
    for (Index b = group.first_block; b < group.first_block + group.padded_blocks; ++b)
      for (int a = 0; a < B; ++a)
        for (int c = 0; c < D; ++c)
          X[blocked(b, a * D + c, B * D)] =
              static_cast<Real>(vertices.reference[blocks.host_vertex[blocked(real_block(group, b), a, B)]][c]);
  for (Index e = 0; e < elements.count; ++e)
    for (int a = 0; a < C; ++a) {
      std::size_t const at = blocked(e, a, C);
      Index const b = block_of(e);
      FaceId const other = neighbour({e, a});
      if (b < 0 || other.element == e) continue;
      int const face = face_of_block({e, a});
      FaceId* part = &interfaces.parts[(static_cast<std::size_t>(b) * F + face) * K];
      while (part->element >= 0) ++part;
      *part = {e, a};
      stiff[blocked(b, face, F)] = numbers.stiffness[at];
      for (int i = 0; i < D; ++i) {
        int const point = point_on_face({e, a}, i, face);
        facing[blocked(b, face * P + point, F * P)] = face_vertex(other, i);
        areas[blocked(b, face * P + point, F * P)] +=
            numbers.area[at] * joint_share({e, a}, i) * static_cast<Real>(numbers.share[blocked(e, a * D + i, C * D)]);
      }
    }
  std::vector<Index> others(faces, -1);
  for (Index b = 0; b < blocks.count; ++b)
    for (int a = 0; a < F; ++a)
      if (auto const here = parts_at(b, a); !here.empty()) others[blocked(b, a, F)] = neighbour(here[0]).element;
  if (std::any_of(groups.begin(), groups.end(),
                  [](Group const& group) { return (group.rankine || group.inserted) && group.blocks > 0; }))
    interfaces.beyond = Buffer<Index>(device, "block joints", others);
  interfaces.block_corners = Buffer<Real>(device, "block corners", X);
  interfaces.across = Buffer<Index>(device, "block joints", facing);
  interfaces.block_area = Buffer<Real>(device, "joint areas", areas);
  interfaces.block_joints = JointArrays<F, P, Real>(device, stiff, D, plan.rubbing_joints);
}

template <int D, class Real>
int Model<D, Real>::point_on_face(FaceId part, int i, int face) const {
  Index const block = block_of(part.element), vertex = face_vertex(part, i);
  for (int point = 0; point < P; ++point)
    if (blocks.host_vertex[blocked(block, BlockShape<D>::face(face, point), B)] == vertex) return point;
  return -1;
}

template <int D, class Real>
int Model<D, Real>::face_of_block(FaceId part) const {
  for (int face = 0; face < F; ++face) {
    int on_it = 0;
    for (int i = 0; i < D; ++i) on_it += point_on_face(part, i, face) >= 0;
    if (on_it == D) return face;
  }
  return -1;
}

template <int D, class Real>
Index Model<D, Real>::block_face(FaceId part) const {
  Index const b = block_of(part.element);
  for (Index k = 0; b >= 0 && !interfaces.parts.empty() && k < F * K; ++k)
    if (interfaces.parts[static_cast<std::size_t>(b) * F * K + k] == part) return b * F + k / K;
  return -1;
}

template <int D, class Real>
int Model<D, Real>::block_point(FaceId part, int i) const {
  return point_on_face(part, i, block_face(part) % F);
}

template <int D, class Real>
Real Model<D, Real>::joint_area(BreakingView<Real> const& now, FaceId face, int i) const {
  Index const of_block = block_face(face);
  if (of_block < 0) return now.area[blocked(face.element, face.face, C)] * joint_share(face, i);
  int const point = block_point(face, i);
  int sharing = 0;
  for (FaceId const part : parts_at(of_block / F, of_block % F))
    for (int j = 0; j < D; ++j) sharing += block_point(part, j) == point;
  return now.block_area[blocked(of_block / F, of_block % F * P + point, F * P)] / static_cast<Real>(sharing);
}

template <int D, class Real>
typename Model<D, Real>::Places Model<D, Real>::places_at(std::vector<FaceId> const& faces) const {
  Places at;
  for (FaceId const one : faces) {
    for (FaceId const side : {one, neighbour(one)})
      for (int i = 0; i < D; ++i)
        for (int c = 0; c < D; ++c) at.displacements.push_back(static_cast<std::size_t>(face_vertex(side, i)) * D + c);
    Index const face = block_face(one);
    if (face < 0) at.areas.push_back(blocked(one.element, one.face, C));
    for (int i = 0; i < P && face >= 0; ++i) at.block_areas.push_back(blocked(face / F, face % F * P + i, F * P));
    at.elements.push_back(one.element);
  }
  return at;
}

template <int D, class Real>
void Model<D, Real>::unlink(FaceId one) {
  std::size_t const at = blocked(one.element, one.face, C);
  interfaces.host_link[at] = one.packed();
  interfaces.link.upload_one(at, interfaces.host_link[at]);
  interfaces.area.upload_one(at, Real(0));
  Index const face = block_face(one);
  for (int i = 0; i < P && face >= 0; ++i) {
    std::size_t const point = blocked(face / F, face % F * P + i, F * P);
    interfaces.across.upload_one(point, blocks.host_vertex[blocked(face / F, BlockShape<D>::face(face % F, i), B)]);
    interfaces.block_area.upload_one(point, Real(0));
  }
}

template <int D, class Real>
Real Model<D, Real>::joint_share(FaceId face, int i) const {
  if (!section.axisymmetric()) return 1;
  auto const radius = [&](Index k) { return static_cast<Real>(vertices.reference[face_vertex(face, k)][0]); };
  Real radii = radius(0);
  for (Index k = 1; k < D; ++k) radii += radius(k);
  return kernels::ring_share<D>(radius(i), static_cast<Real>(radii * Real(1.0 / D)));
}

}  // namespace fissure::model
