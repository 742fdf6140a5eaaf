// Scene and mesh turned into the arrays that kernels run over.
#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "backend/buffer.h"
#include "base/face_id.h"
#include "kernels/block_joints.h"
#include "kernels/blocks.h"
#include "kernels/elements.h"
#include "kernels/loads.h"
#include "mesh/mesh.h"
#include "model/cells.h"
#include "model/interfaces.h"
#include "model/internal_variables.h"
#include "model/plan.h"
#include "model/section.h"
#include "model/vertices.h"
#include "scene/scene.h"

namespace fissure::model {

/// Elements of one body: a contiguous range, padded to whole packs. Elements are simplices: first those that are cells
/// of their own, then, padded again, the parts of blocks.
struct Group {
  int body = 0;
  Index first = 0, count = 0;                            // padded range of elements
  Index padded_simplices = 0;                            // number of those that are no part of a block
  Index first_block = 0, blocks = 0, padded_blocks = 0;  // its blocks
  // where forces at the corners of its simplices and of its blocks begin
  Index first_slot = 0, first_block_slot = 0;
  kernels::Integration integration = kernels::Integration::one_point;
  std::size_t shapes_at = 0;             // where the numbers of its blocks' shapes begin
  std::size_t block_memory_at = 0;       // where those that its blocks remember begin
  Index first_point = 0;                 // where their plastic work begins, after that of all elements
  double viscosity = 0;                  // [Pa s]
  bool split = false;                    // every corner has its own vertex: the body can crack
  bool rankine = false;                  // its joints begin by the stress beside them, too
  bool inserted = false;                 // they are inserted where it reaches its strength; until then it is whole
  std::optional<laws::Plastic> plastic;  // the law of a body that flows
  std::size_t memory_at = 0;             // where its elements' numbers begin
  Index first_patch = 0, patches = 0;    // of averaged pressure
};

/// What kernels tell of a step: an element that is turned inside out (1), and how many faces of simplices and of blocks
/// began to soften or broke.
struct Notice {
  static constexpr int fault = 0, joints = 1, block_joints = 2, count = 3;
};

/// Prescribed motion of some vertices.
template <int D, class Real>
struct HoldSet {
  int hold = 0;                // index into Scene::holds
  scene::Directions velocity;  // asked for, as the scene had it when the model was made [m/s]
  Buffer<kernels::LoadedVertex<D, Real>> list;
  Buffer<Real> impulse, held;  // [listed][D]
};

/// Surface load on some vertices: value(t) times share.
template <int D, class Real>
struct LoadSet {
  scene::Directions value;  // [Pa]
  Buffer<kernels::LoadedVertex<D, Real>> list;
};

/// What the host must see of a model when the joints on some faces of elements break.
template <class Real>
struct BreakingView {
  HostView<Real> u, area, block_area;
  HostView<std::int8_t> parity;

  template <class AnyModel>
  BreakingView(AnyModel const& model, std::vector<FaceId> const& faces) : BreakingView(model, model.places_at(faces)) {}

 private:
  template <class AnyModel, class Places>
  BreakingView(AnyModel const& model, Places const& at)
      : u(model.vertices.u, at.displacements),
        area(model.interfaces.area, at.areas),
        block_area(model.interfaces.block_area, at.block_areas),
        parity(model.elements.parity, at.elements) {}
};

template <int D>
struct BlockIntegrals;

template <int D, class Real>
class Model {
 public:
  static constexpr int C = D + 1;
  static constexpr int B = BlockShape<D>::corners, F = BlockShape<D>::faces, P = BlockShape<D>::face_corners;
  static constexpr int K = P - D + 1;  // simplices' faces that a block's face is cut into

  /// Throws Error (with the scene's place) when a place names nothing, or fracture energies are too small for the mesh.
  Model(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh);

  kernels::MeshView<D, Real> view() {
    return {elements.count,    vertices.count,    elements.X.data(), elements.vertex.data(), elements.parity.data(),
            vertices.u.data(), vertices.v.data(), section.thickness, section.axisymmetric()};
  }
  kernels::MemoryView<Real> memory_view(Group const& group) {
    return {internal.memory.data() + group.memory_at, group.first, internal.work.data()};
  }
  kernels::BlockView<D, Real> block_view(Group const& group, scene::Scene const& scene) {
    kernels::BlockView<D, Real> view;
    view.vertex = blocks.vertex.data() + static_cast<std::size_t>(group.first_block) * B;
    view.numbers = blocks.shapes.data() + group.shapes_at;
    view.force = corner_force() + static_cast<std::size_t>(group.first_block_slot) * D;
    view.first_part = group.first + group.padded_simplices;
    view.parts = blocks.parts;
    view.own = group.split;
    view.how = group.integration;
    view.thin = section.plane_stress();
    auto const& elastic = scene.materials.at(scene.bodies[group.body].material).elastic();
    view.young = elastic.young, view.poisson = elastic.poisson;
    return view;
  }
  kernels::MemoryView<Real> block_memory_view(Group const& group) {
    return {internal.memory.data() + group.block_memory_at, 0,
            internal.work.data() + elements.count + group.first_point};
  }
  kernels::PatchView<Real> patch_view(Group const& group) {
    if (group.patches == 0) return {};
    return {patches.of_corner.data(), patches.pressure.data(), patches.energy.data()};
  }
  kernels::JointView<D, Real> joint_view(Group const& group) {
    return {interfaces.link.data(), interfaces.area.data(), vertex_of(group.first, 0) - group.first * C};
  }
  kernels::BlockJointView<D, Real> block_joint_view(Group const& group) {
    std::size_t const first = group.first_block;
    return {blocks.host_vertex[kernels::blocked(group.first_block, 0, B)],
            interfaces.block_corners.data() + first * B * D,
            interfaces.across.data() + first * F * P,
            interfaces.block_area.data() + first * F * P,
            corner_force() + static_cast<std::size_t>(group.first_block_slot) * D,
            group.first + group.padded_simplices,
            static_cast<int>(blocks.parts),
            group.padded_blocks,
            interfaces.beyond.empty() ? nullptr : interfaces.beyond.data() + first * F};
  }
  kernels::JointMemory<C, D, Real> joint_memory() {
    return interfaces.joints.view(0, interfaces.dissipated.data(), flags.data() + Notice::joints);
  }
  kernels::JointMemory<F, P, Real> block_joint_memory(Group const& group) {
    return interfaces.block_joints.view(group.first_block, interfaces.dissipated.data() + elements.count,
                                        flags.data() + Notice::block_joints);
  }
  Real* vertex_force() { return vertices.force.data(); }
  /// Forces at the corners of cells, by slot; where every corner has a vertex of its own they are the vertices'.
  Real* corner_force() { return plan.shared ? slots.force.data() : vertices.force.data(); }
  /// Where corner a of element e has its force at number e (D + 1) + a.
  Real* element_force(Group const& group) {
    return corner_force() + (static_cast<std::ptrdiff_t>(group.first_slot) - group.first * C) * D;
  }

  /// The block that an element is part of (-1: none), and the parts of a block.
  Index block_of(Index element) const {
    if (!plan.blocks || elements.body[element] < 0) return -1;
    auto const& group = groups[elements.body[element]];
    Index const part = element - group.first - group.padded_simplices;
    return part < 0 ? -1 : group.first_block + part / blocks.parts;
  }
  /// The element that stands for the cell: itself, or the first part of its block.
  Index cell_head(Index element) const {
    Index const block = block_of(element);
    return block < 0 ? element : part_of(groups[elements.body[element]], block);
  }
  /// Padding is a copy of a body's first block, without mass.
  static Index real_block(Group const& group, Index block) {
    return block < group.first_block + group.blocks ? block : group.first_block;
  }
  /// How many elements the cell of a head is made of.
  Index cell_parts(Index head) const { return block_of(head) < 0 ? 1 : blocks.parts; }
  Index part_of(Group const& group, Index block, Index k = 0) const {
    return group.first + group.padded_simplices + (block - group.first_block) * blocks.parts + k;
  }

  bool has_bonds() const { return !interfaces.host_bond.empty(); }
  /// The bond law, counted from 1, of the joint on a face of an element that is a cell; 0: that of its body.
  int bond_of(FaceId face) const {
    return has_bonds() ? interfaces.host_bond[kernels::blocked(face.element, face.face, C)] : 0;
  }
  /// The law of the joint on a face of an element that is a cell.
  laws::AnyJoint joint_law(scene::Scene const& scene, FaceId face) const {
    int const bond = bond_of(face);
    return bond > 0 ? laws::AnyJoint(interfaces.host_bond_laws[bond - 1])
                    : *scene.materials[scene.bodies[elements.body[face.element]].material].joint;
  }

  /// The face on the other side of a joint; the face itself where there is none.
  FaceId neighbour(FaceId face) const {
    return FaceId::unpacked(interfaces.host_link[kernels::blocked(face.element, face.face, C)]);
  }
  Index face_vertex(FaceId face, int i) const { return vertex_of(face.element, face.corner(i)); }

  Index vertex_of(Index element, Index corner) const {
    return elements.host_vertex.empty() ? element * C + corner
                                        : elements.host_vertex[kernels::blocked(element, corner, C)];
  }

  /// Vertices at the corners of the cell whose head an element is.
  std::vector<Index> cell_vertices(Index head) const;
  /// Volume of that cell over that at rest (of a block by its mean gradients, or at several points the least or the
  /// mean).
  double volume_ratio(std::vector<Real> const& u, Index head, bool mean = false) const;
  /// Sum over its corners of the squared gradients of shape functions now [1/m^2], each over the corner's share of the
  /// volume (one of `volumes`); of a block the mean over its points by volume. Corners on the axis (by vertex) do not
  /// stretch hoops.
  double squared_gradients(std::vector<Real> const& u, Index head, std::vector<double> const& volumes,
                           std::vector<char> const& on_axis) const;
  /// What each corner of that cell gets of its volume [m^3].
  std::vector<double> corner_volumes(Index head) const;
  /// Number k of what a cell's element remembers of flow; of a block the mean over its points.
  double remembered(std::vector<Real> const& memory, Index head, int k) const;

  /// Patches of averaged pressure: the corners at a node whose elements are still joined about it. Again when joints
  /// broke.
  void place_patches(Device& device);

  /// An element's edges from its first corner, as columns: at rest, and where the displacements u move its corners [m].
  Mat<double, D> edges(Index e) const;
  Mat<double, D> moved_edges(std::vector<Real> const& u, Index e) const;
  /// Mean radius of an element's corners, at rest and moved [m]: axisymmetry only.
  double mean_radius(Index e) const;
  double moved_radius(std::vector<Real> const& u, Index e) const;
  /// How far an element reaches out of the plane [m]: as MeshView::out_of_plane().
  double out_of_plane(Index e) const { return section.reach(mean_radius(e)); }
  /// What corner a gets of an element's mass, and corner i of a face of its joint's area, over a like share [-].
  double mass_share(Index e, Index a) const;
  Real joint_share(FaceId face, int i) const;

  /// The faces of parts, that the face of a block with a joint is cut into.
  std::span<FaceId const> parts_at(Index block, int face) const {
    FaceId const* const first = &interfaces.parts[(static_cast<std::size_t>(block) * F + face) * K];
    return {first, first->element < 0 ? 0u : static_cast<std::size_t>(K)};  // both of a hexahedron's or none
  }
  /// The face of a block, block * F + face, that the face of one of its parts is or lies on; -1: none.
  Index block_face(FaceId part) const;
  /// The point of that block's face at corner i of its part's face.
  int block_point(FaceId part, int i) const;
  /// Area at rest of the joint on an element's face at its corner i [m^2]: where parts of a block's face meet, each
  /// has its share.
  Real joint_area(BreakingView<Real> const& now, FaceId face, int i) const;
  /// Where arrays keep what belongs to the joints on these faces of elements: displacements of their own corners and of
  /// those across.
  struct Places {
    std::vector<std::size_t> displacements, areas, block_areas, elements;
  };
  Places places_at(std::vector<FaceId> const& faces) const;
  /// No joint any more on this face.
  void unlink(FaceId face);
  /// How far a face reaches out of the plane at each corner, which gets the D-th part of its measure times that [m].
  std::array<double, D> face_reach(Vec<double, D> const (&corner)[D]) const;

  Plan plan;
  std::vector<Group> groups;
  Vec3 origin{0, 0, 0};  // subtracted from every coordinate, so that far-away scenes lose no digit [m]
  Section section;
  std::vector<std::string> warnings;

  Vertices<D, Real> vertices;
  CornerSlots<Real> slots;
  Elements<Real> elements;
  Blocks<Real> blocks;
  Interfaces<D, Real> interfaces;
  InternalVariables<Real> internal;
  PressurePatches<Real> patches;
  std::vector<HoldSet<D, Real>> holds;
  std::vector<LoadSet<D, Real>> loads;
  Buffer<int> flags;  // by Notice

 private:
  std::array<Mat<double, D>, 2> block_jacobians(std::vector<Real> const& u, Index block, int p) const;
  std::array<double, 2> block_radii(std::vector<Real> const& u, Index block, int p) const;
  void number_elements(mesh::Mesh const& mesh);
  void number_vertices(mesh::Mesh const& mesh, Device& device);
  void hang_corners(mesh::Mesh const& mesh);
  void hang_padding();
  void list_slots(Index n_slots, Device& device);
  void place_elements(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  void place_blocks(scene::Scene const& scene, Device& device);
  template <class Put>
  void put_block_shape(BlockIntegrals<D> const& block, kernels::Integration how, double young, Put&& put) const;
  std::array<double, D> corner_shares(mesh::Mesh const& mesh, int body, int cell,
                                      std::array<int, D> const& nodes) const;
  /// Numbers of joints by face, blocked as Interfaces::link, while they are made: area [m^2], stiffness [Pa/m], share
  /// of each corner in the area (1 on average; where there are blocks), strength over the law's and whether it counts
  /// on any plane (where some differ), and whether it is still to be inserted.
  struct JointNumbers {
    std::vector<Real> area, stiffness;
    std::vector<double> share, strength, any_plane;
    std::vector<std::uint8_t> whole;
    JointNumbers(std::size_t faces, Plan const& plan, bool strengths)
        : area(faces, 0),
          stiffness(faces, 0),
          share(plan.blocks ? faces * D : 0, 1),
          strength(strengths ? faces : 0, 1),
          any_plane(strength),
          whole(plan.insertion ? faces : 0, 0) {}
  };
  void place_joints(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  void link_faces(scene::Scene const& scene, mesh::Mesh const& mesh, mesh::JointStrengths const& given,
                  JointNumbers& joints);
  void make_joint_arrays(JointNumbers const& numbers, Device& device);
  Vec<double, D> cell_centre(Index e) const;
  Vec<double, D> cell_face_normal(FaceId face) const;
  std::vector<std::uint8_t> place_bond_laws(scene::Scene const& scene, mesh::Mesh const& mesh);
  // number of the face of its block that a part's face lies on; -1: inside
  int face_of_block(FaceId part) const;
  int point_on_face(FaceId part, int i, int face) const;  // of corner i of that; -1: not on the face
  Vec<double, D> reference_of(Index vertex) const {
    return Eigen::Map<Vec<double, D> const>(vertices.reference[vertex].data());
  }
  std::vector<double> least_of_parts(std::vector<double> const& of_parts) const;
  std::vector<std::uint8_t> whole_of_parts(std::vector<std::uint8_t> const& of_parts) const;
  void place_block_joints(JointNumbers const& numbers, Device& device);
  void place_memory(scene::Scene const& scene, Device& device);
  void set_motion(scene::Scene const& scene, Device& device);
  void refuse_contradictions(scene::Scene const& scene) const;
  void place_holds(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  void place_loads(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  std::vector<kernels::LoadedVertex<D, Real>> loaded_vertices(mesh::Mesh const& mesh, int body,
                                                              std::vector<int> const& faces, bool inward) const;
  std::vector<int> nodes_at(scene::Region const& where, int body, Source const& source, mesh::Mesh const& mesh) const;
  std::vector<int> faces_at(scene::Region const& where, int body, Source const& source, mesh::Mesh const& mesh) const;
  std::vector<std::vector<Index>> vertices_of_nodes(mesh::Mesh const& mesh) const;
  int own_node(mesh::Mesh const& mesh, Index e, int a) const;  // of corner a of an element, as its cell has it
  void find_axis(scene::Scene const& scene, mesh::Mesh const& mesh);
};

}  // namespace fissure::model
