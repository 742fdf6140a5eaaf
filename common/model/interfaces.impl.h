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

/// A joint on every inner face between cells, and where bodies are bonded.
template <int D, class Real>
void Model<D, Real>::place_joints(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device) {
  auto const given = mesh::joint_strengths(scene, mesh);
  JointNumbers joints(static_cast<std::size_t>(elements.count) * C, plan, !given.of_face.empty());
  link_faces(scene, mesh, given, joints);
  make_joint_arrays(scene, joints, device);
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
      if (cell_head(e) == cell_head(other)) continue;
      // The cell's corner is some sorted corner; the other side's face is opposite its corner that is not shared.
      int const* const mine = &elements.node[static_cast<std::size_t>(e) * C];
      int const* const theirs = &elements.node[static_cast<std::size_t>(other) * C];
      FaceId const here{e, static_cast<int>(std::find(mine, mine + C, mesh.place(mesh.cells[use])) - mine)};
      FaceId there{other, 0};
      while (std::find(mine, mine + C, theirs[there.face]) != mine + C) ++there.face;
      Vec<double, D> corner[D];
      for (int i = 0; i < D; ++i) corner[i] = point(e, here.corner(i));
      double const area = Dim<D>::face_normal(corner).norm();
      double const h = group.blocks.count == 0
                           ? static_cast<double>(D) / (D + 1) * (measure(e) + measure(other)) / area
                           : std::abs((cell_centre(other) - cell_centre(e)).dot(cell_face_normal(here)));
      if (!joints.share.empty()) {
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
void Model<D, Real>::make_joint_arrays(scene::Scene const& scene, JointNumbers const& numbers, Device& device) {
  auto const any = [&](auto&& has) { return std::any_of(groups.begin(), groups.end(), has); };
  bool const by_stress = any([](Group const& group) { return group.rankine; });
  interfaces.link = Buffer<Index>(device, "joint links", interfaces.host_link);
  interfaces.area = Buffer<Real>(device, "joint areas", numbers.area);
  interfaces.dissipated = Buffer<double>(device, "joint dissipation", elements.count + blocks.count);
  std::array<int, Notice::count> broken{};
  each_set([&]<class Set>(Set const& set) {
    if (!any([](Group const& group) { return group.split && Set::range(group).padded > 0; })) return;
    auto& joints = Set::of(interfaces);
    using Joints = std::remove_reference_t<decltype(joints)>;
    joints = Joints(device, cell_joints(set, numbers, device), D, plan.rubbing_joints);
    if (!numbers.strength.empty())
      broken[Notice::joints + Set::kind] =
          joints.set_strengths(device, set.least(numbers.strength), [&](Index cell, auto const& put) {
            auto const& body = scene.bodies[elements.body[set.element(cell)]];
            std::visit([&]<class Law>(Law const&) { Law::template History<Real>::broken().write(put); },
                       *scene.materials[body.material].joint);
          });
    if (by_stress) joints.begin_by_stress(device, set.least(numbers.any_plane));
    if (plan.insertion) joints.insert_on_demand(device, set.all(numbers.whole));
  });
  if (has_bonds()) {
    interfaces.joints.set_bonds(device, interfaces.host_bond);
    interfaces.bond_laws = Buffer<laws::CohesiveJoint>(device, "bond laws", interfaces.host_bond_laws);
  }
  for (double const strength : numbers.strength)
    if (strength > 0) interfaces.least_strength = std::min(interfaces.least_strength, strength);
  if (plan.insertion || by_stress) {
    interfaces.stress = Buffer<double>(device, "stress", static_cast<std::size_t>(elements.count) * 6);
    interfaces.stressed = Buffer<std::uint8_t>(device, "stress", elements.count);
  }
  // heard with the first step's news
  flags = Buffer<int>(device, "flags", std::vector<int>(broken.begin(), broken.end()));
}

/// Stiffness of the joints of blocks, by the faces of their parts, whose areas add up at the corners of a block's face:
/// places those, too. At one beside a simplex the number is the simplex' own, to the last bit.
template <int D, class Real>
std::vector<Real> Model<D, Real>::cell_joints(Blocks<D, Real> const& set, JointNumbers const& numbers, Device& device) {
  std::size_t const faces = static_cast<std::size_t>(blocks.count) * F;
  interfaces.parts.assign(faces * K, FaceId{-1, 0});
  std::vector<Index> facing(faces * P);
  std::vector<Real> areas(faces * P, 0), stiff(faces, 0), X(static_cast<std::size_t>(blocks.count) * B * D);
  for (Index b = 0; b < blocks.count; ++b) {
    for (int a = 0; a < F; ++a)
      for (int i = 0; i < P; ++i) facing[blocked(b, a * P + i, F * P)] = set.face_vertex(b, a, i);
  }
  for (auto const& group : groups)
    for (Index b = group.blocks.first; b < group.blocks.first + group.blocks.padded; ++b)
      for (int a = 0; a < B; ++a)
        for (int c = 0; c < D; ++c)
          X[blocked(b, a * D + c, B * D)] =
              static_cast<Real>(vertices.reference[set.vertex(real_block(group, b), a)][c]);
  for (Index e = 0; e < elements.count; ++e)
    for (int a = 0; a < C; ++a) {
      std::size_t const at = blocked(e, a, C);
      Index const b = block_of(e);
      FaceId const other = neighbour({e, a});
      if (b < 0 || other.element == e) continue;
      int const face = set.face_of({e, a}).face;
      FaceId* part = &interfaces.parts[(static_cast<std::size_t>(b) * F + face) * K];
      while (part->element >= 0) ++part;
      *part = {e, a};
      stiff[blocked(b, face, F)] = numbers.stiffness[at];
      for (int i = 0; i < D; ++i) {
        int const point = set.point({e, a}, face, i);
        facing[blocked(b, face * P + point, F * P)] = face_vertex(other, i);
        areas[blocked(b, face * P + point, F * P)] +=
            numbers.area[at] * joint_share({e, a}, i) * static_cast<Real>(numbers.share[blocked(e, a * D + i, C * D)]);
      }
    }
  std::vector<Index> others(faces, -1);
  for (Index b = 0; b < blocks.count; ++b)
    for (int a = 0; a < F; ++a)
      if (auto const here = set.parts(b, a); !here.empty()) others[blocked(b, a, F)] = neighbour(here[0]).element;
  if (std::any_of(groups.begin(), groups.end(),
                  [](Group const& group) { return (group.rankine || group.inserted) && group.blocks.count > 0; }))
    interfaces.beyond = Buffer<Index>(device, "block joints", others);
  interfaces.block_corners = Buffer<Real>(device, "block corners", X);
  interfaces.across = Buffer<Index>(device, "block joints", facing);
  interfaces.block_area = Buffer<Real>(device, "joint areas", areas);
  return stiff;
}

template <int D, class Real>
Real Model<D, Real>::joint_area(BreakingView<Real> const& now, FaceId part, int i) const {
  return in_set(part.element, [&](auto const& set, Index cell) {
    int const face = set.face_of(part).face, point = set.point(part, face, i);
    int sharing = 0;
    for (FaceId const one : set.parts(cell, face))
      for (int j = 0; j < D; ++j) sharing += set.point(one, face, j) == point;
    return set.areas(now)[set.area_at(cell, face, point)] * set.area_share(cell, face, point) /
           static_cast<Real>(sharing);
  });
}

template <int D, class Real>
typename Model<D, Real>::Places Model<D, Real>::places_at(std::vector<FaceId> const& faces) const {
  Places at;
  for (FaceId const part : faces) {
    for (FaceId const side : {part, neighbour(part)})
      for (int i = 0; i < D; ++i)
        for (int c = 0; c < D; ++c) at.displacements.push_back(static_cast<std::size_t>(face_vertex(side, i)) * D + c);
    in_set(part.element, [&](auto const& set, Index cell) {
      int const face = set.face_of(part).face;
      for (int i = 0; i < set.face_points; ++i) set.areas(at).push_back(set.area_at(cell, face, i));
    });
    at.elements.push_back(part.element);
  }
  return at;
}

template <int D, class Real>
void Model<D, Real>::unlink(FaceId part) {
  std::size_t const at = blocked(part.element, part.face, C);
  interfaces.host_link[at] = part.packed();
  interfaces.link.upload_one(at, interfaces.host_link[at]);
  interfaces.area.upload_one(at, Real(0));
  in_set(part.element, [&](auto const& set, Index cell) {
    int const face = set.face_of(part).face;
    for (int i = 0; i < set.face_points; ++i) {
      std::size_t const point = set.area_at(cell, face, i);
      set.areas(interfaces).upload_one(point, Real(0));
      set.upload_across(interfaces, point, set.face_vertex(cell, face, i));
    }
  });
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
