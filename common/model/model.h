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
#include "kernels/rigid_motion.h"
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
  Index first = 0, count = 0;  // padded range of elements
  CellRange simplices;         // those that are no part of a block: the first ones
  CellRange blocks;
  kernels::Integration integration = kernels::Integration::one_point;
  std::size_t shapes_at = 0;  // where the numbers of its blocks' shapes begin
  Index first_point = 0;      // where their plastic work begins, after that of all elements
  laws::Viscosity damping;
  bool split = false;                    // every corner has its own vertex: the body can crack
  bool rigid = false;                    // the body does not deform: its cells have no forces of their own
  bool rankine = false;                  // its joints begin by the stress beside them, too
  bool inserted = false;                 // they are inserted where it reaches its strength; until then it is whole
  std::optional<laws::Plastic> plastic;  // the law of a body that flows
  Index first_patch = 0, patches = 0;    // of averaged pressure

  /// Joints of simplices act in the pass of their elements; beside blocks they have one of their own.
  bool fused_joints() const { return split && blocks.count == 0; }
  /// Its blocks have one point each, and springs and dampers against the modes that it does not see.
  template <int D>
  bool hourglasses() const {
    return blocks.count > 0 && kernels::BlockNumbers<D>::points(integration) == 1;
  }
};

/// Volume over that at rest below which a cell counts as crushed, where crushed ones are removed.
inline constexpr double crushed = 0.1;

/// What kernels tell of a step: an element that is turned inside out (1), and of how many faces of simplices and of
/// blocks a point began to soften or came to hold nothing.
struct Notice {
  static constexpr int fault = 0, joints = 1, block_joints = 2, count = 3;
};

/// Prescribed motion of some vertices.
template <int D, class Real>
struct HoldSet {
  int hold = 0;                // index into Scene::holds
  scene::Directions velocity;  // asked for, as the scene had it when the model was made [m/s]; or
  std::optional<scene::Around> around;
  Buffer<kernels::LoadedVertex<D, Real>> list;
  Buffer<Real> impulse, held;  // [listed][D]
  Buffer<double> place;        // [listed][D] at rest, from a point of the axis [m]; empty: it has none
};

/// Over its mass: of what nothing pushes away.
inline constexpr double immovable = 1e9;

/// A body that does not deform, and is free in some direction.
template <int D, class Real>
struct RigidBody {
  int body = 0;
  Index first_element = 0;
  Buffer<Index> list;                   // its vertices
  Buffer<double> arm;                   // [listed][D] from the centre of mass at rest [m]
  double mass = 0;                      // scaled [kg]
  Mat<double, 3> inertia;               // of the lumped masses about that centre, at rest [kg m^2]
  std::array<bool, 3> moves{}, held{};  // directions it is free in; that holds move it in
  bool turns = false;

  kernels::RigidView<D> view() {
    kernels::RigidView<D> view{list.data(), arm.data(), {}};
    std::copy_n(held.begin(), D, view.held);
    return view;
  }
};

/// A spring's two ends.
template <int D, class Real>
struct SpringSet {
  std::array<std::vector<kernels::LoadedVertex<D, Real>>, 2> ends;  // shares are 1 together; none: a fixed place
  std::array<Vec<double, D>, 2> place;                              // at rest, about the origin [m]
};

/// A vertex that a tie hangs on the corners of a cell of another body.
template <int D>
struct HungVertex {
  Index vertex = 0;
  Index element = 0;                  // that cell, or a part of it
  std::array<Index, D + 1> on{};      // its vertices
  std::array<double, D + 1> share{};  // 1 together
  int tie = 0;                        // index into Scene::ties
  bool of_second = true;              // of its bodies
};

/// Load on some vertices: value(t) times share.
template <int D, class Real>
struct LoadSet {
  scene::Directions value;  // [Pa] of tractions and pressures, [N] of forces, [-] of body forces
  Buffer<kernels::LoadedVertex<D, Real>> list;
  Buffer<Index> first;  // of a pressure that follows the surface: as kernels::FollowFaces
  Buffer<kernels::PressedCorner<D>> corner;
};

/// All vertices of absorbing boundaries.
template <int D, class Real>
struct AbsorbSet {
  Buffer<kernels::AbsorbingVertex<D, Real>> list;
  Buffer<Real> impulse;  // [listed][D]
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
        area(model.interfaces.area, at.area),
        block_area(model.interfaces.block_area, at.block_area),
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
    return {internal.memory.data() + group.simplices.memory_at, group.first, internal.work.data()};
  }
  kernels::BlockView<D, Real> block_view(Group const& group, scene::Scene const& scene) {
    kernels::BlockView<D, Real> view;
    view.vertex = blocks.vertex.data() + static_cast<std::size_t>(group.blocks.first) * B;
    view.numbers = blocks.shapes.data() + group.shapes_at;
    view.force = corner_force() + static_cast<std::size_t>(group.blocks.first_slot) * D;
    view.first_part = group.first + group.simplices.padded;
    view.parts = blocks.parts;
    view.own = group.split;
    view.how = group.integration;
    view.thin = section.plane_stress();
    auto const& elastic = scene.materials.at(scene.bodies[group.body].material).elastic();
    view.young = elastic.young, view.poisson = elastic.poisson;
    return view;
  }
  kernels::MemoryView<Real> block_memory_view(Group const& group) {
    return {internal.memory.data() + group.blocks.memory_at, 0,
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
    std::size_t const first = group.blocks.first;
    return {blocks.host_vertex[kernels::blocked(group.blocks.first, 0, B)],
            interfaces.block_corners.data() + first * B * D,
            interfaces.across.data() + first * F * P,
            interfaces.block_area.data() + first * F * P,
            corner_force() + static_cast<std::size_t>(group.blocks.first_slot) * D,
            group.first + group.simplices.padded,
            static_cast<int>(blocks.parts),
            group.blocks.padded,
            interfaces.beyond.empty() ? nullptr : interfaces.beyond.data() + first * F};
  }
  kernels::JointMemory<C, D, Real> joint_memory() {
    return interfaces.joints.view(0, interfaces.dissipated.data(), flags.data() + Notice::joints);
  }
  kernels::JointMemory<F, P, Real> block_joint_memory(Group const& group) {
    return interfaces.block_joints.view(group.blocks.first, interfaces.dissipated.data() + elements.count,
                                        flags.data() + Notice::block_joints);
  }
  /// About the slowest vibration of a scene of this size: of a bar as long, held at one end [rad/s].
  double slowest_vibration(scene::Scene const& scene) const;
  Real* vertex_force() { return vertices.force.data(); }
  Real const* inverse_inertia() {
    return vertices.inverse_inertia.empty() ? vertices.inverse_mass.data() : vertices.inverse_inertia.data();
  }
  /// Forces at the corners of cells, by slot; where every corner has a vertex of its own they are the vertices'.
  Real* corner_force() { return plan.shared ? slots.force.data() : vertices.force.data(); }
  /// Where corner a of element e has its force at number e (D + 1) + a.
  Real* element_force(Group const& group) {
    return corner_force() + (static_cast<std::ptrdiff_t>(group.simplices.first_slot) - group.first * C) * D;
  }

  /// The block that an element is part of (-1: none), and the parts of a block.
  Index block_of(Index element) const {
    if (!plan.blocks || elements.body[element] < 0) return -1;
    auto const& group = groups[elements.body[element]];
    Index const part = element - group.first - group.simplices.padded;
    return part < 0 ? -1 : group.blocks.first + part / blocks.parts;
  }
  /// The element that stands for the cell: itself, or the first part of its block.
  Index cell_head(Index element) const {
    Index const block = block_of(element);
    return block < 0 ? element : part_of(groups[elements.body[element]], block);
  }
  /// Padding is a copy of a body's first block, without mass.
  static Index real_block(Group const& group, Index block) {
    return block < group.blocks.first + group.blocks.count ? block : group.blocks.first;
  }
  /// The element has left the run.
  bool removed(Index element) const { return !elements.removed.empty() && elements.removed[element]; }
  /// A corner of one hangs on a cell that the other is or lies about.
  bool tied(Index a, Index b) const {
    auto const hangs = [this](Index one, Index other) {
      auto const* const nodes = &elements.node[static_cast<std::size_t>(other) * C];
      return std::any_of(nodes, nodes + C, [&](int node) {
        return std::binary_search(beside_tie.begin(), beside_tie.end(), std::array<Index, 2>{one, node});
      });
    };
    return !beside_tie.empty() && (hangs(a, b) || hangs(b, a));
  }
  /// What hangs on something that has left, or has left itself, hangs no more.
  void drop_ties();
  /// It is no padding, and has not left.
  bool present(Index element) const { return elements.cell[element] >= 0 && !removed(element); }
  /// How many elements the cell of a head is made of.
  Index cell_parts(Index head) const { return block_of(head) < 0 ? 1 : blocks.parts; }
  Index part_of(Group const& group, Index block, Index k = 0) const {
    return group.first + group.simplices.padded + (block - group.blocks.first) * blocks.parts + k;
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

  /// The corner of an element that stands at a node.
  Index corner_at(Index e, int node) const {
    int const* const mine = &elements.node[static_cast<std::size_t>(e) * C];
    return static_cast<Index>(std::find(mine, mine + C, node) - mine);
  }
  /// The face on the other side of a joint; the face itself where there is none.
  FaceId neighbour(FaceId face) const {
    return FaceId::unpacked(interfaces.host_link[kernels::blocked(face.element, face.face, C)]);
  }
  /// Where the scene has a vertex at the start [m].
  Vec3 drawn_at(Index vertex) const {
    Vec3 x = origin;
    for (int c = 0; c < D; ++c) {
      x[c] += vertices.reference[vertex][c];
      if (!vertices.start.empty()) x[c] += vertices.start[static_cast<std::size_t>(vertex) * D + c];
    }
    return x;
  }
  Index face_vertex(FaceId face, int i) const { return vertex_of(face.element, face.corner(i)); }

  Index vertex_of(Index element, Index corner) const {
    return elements.host_vertex.empty() ? element * C + corner
                                        : elements.host_vertex[kernels::blocked(element, corner, C)];
  }

  /// f(set, cell) with the set and number of the cell that an element is or is part of.
  template <class F>
  decltype(auto) in_set(Index element, F&& f) const {
    Index const block = block_of(element);
    return block < 0 ? f(Simplices<D, Real>(*this), element) : f(Blocks<D, Real>(*this), block);
  }
  /// f(set) with simplices, then with blocks.
  template <class F>
  void each_set(F&& f) const {
    f(Simplices<D, Real>(*this));
    f(Blocks<D, Real>(*this));
  }

  // Of the cell that an element is or is part of:
  /// Vertices at its corners.
  std::vector<Index> cell_vertices(Index element) const {
    return in_set(element, [](auto const& set, Index cell) {
      std::vector<Index> vertices(set.corners);
      for (int a = 0; a < set.corners; ++a) vertices[a] = set.vertex(cell, a);
      return vertices;
    });
  }
  /// Volume over that at rest (of a block by its mean gradients, or at several points the least or the mean).
  double volume_ratio(std::vector<Real> const& u, Index element, bool mean = false) const {
    return in_set(element, [&](auto const& set, Index cell) { return set.volume_ratio(u, cell, mean); });
  }
  /// Sum over its corners of the squared gradients of shape functions now [1/m^2], each over the corner's share of the
  /// volume (one of `volumes`); of a block the mean over its points by volume. Corners on the axis (by vertex) do not
  /// stretch hoops.
  double squared_gradients(std::vector<Real> const& u, Index element, std::vector<double> const& volumes,
                           std::vector<char> const& on_axis) const {
    return in_set(element,
                  [&](auto const& set, Index cell) { return set.squared_gradients(u, cell, volumes, on_axis); });
  }
  /// What each corner gets of its volume [m^3].
  std::vector<double> corner_volumes(Index element) const {
    return in_set(element, [](auto const& set, Index cell) { return set.corner_volumes(cell); });
  }
  /// Number k of what it remembers of flow; of a block the mean over its points.
  double remembered(std::vector<Real> const& memory, Index element, int k) const {
    return in_set(element, [&](auto const& set, Index cell) { return set.remembered(memory, cell, k); });
  }

  /// Patches of averaged pressure: the corners at a node whose elements are still joined about it. Again when joints
  /// broke.
  void place_patches(Device& device);

  /// An element's edges from its first corner, as columns: at rest, and where the displacements u move its corners [m].
  Mat<double, D> edges(Index e) const;
  Mat<double, D> moved_edges(std::span<Real const> u, Index e) const;
  /// Mean radius of an element's corners, at rest and moved [m]: axisymmetry only.
  double mean_radius(Index e) const;
  double moved_radius(std::vector<Real> const& u, Index e) const;
  /// How far an element reaches out of the plane [m]: as MeshView::out_of_plane().
  double out_of_plane(Index e) const { return section.reach(mean_radius(e)); }
  /// What corner a gets of an element's mass, and corner i of a face of its joint's area, over a like share [-].
  double mass_share(Index e, Index a) const;
  Real joint_share(FaceId face, int i) const;

  /// Area at rest of the joint on an element's face at its corner i [m^2]: where parts of a block's face meet, each
  /// has its share.
  Real joint_area(BreakingView<Real> const& now, FaceId part, int i) const;
  /// Where arrays keep what belongs to the joints on these faces of elements: displacements of their own corners and of
  /// those across.
  struct Places {
    std::vector<std::size_t> displacements, area, block_area, elements;
  };
  Places places_at(std::vector<FaceId> const& faces) const;
  /// No joint any more on this face.
  void unlink(FaceId part);
  /// How far a face reaches out of the plane at each corner, which gets the D-th part of its measure times that [m].
  std::array<double, D> face_reach(Vec<double, D> const (&corner)[D]) const;

  Plan plan;
  std::vector<Group> groups;
  Vec3 origin{0, 0, 0};  // subtracted from every coordinate, so that far-away scenes lose no digit [m]
  Section section;
  std::vector<std::string> warnings;

  Vertices<D, Real> vertices;
  CornerSlots<Real> slots;
  ElementArrays<Real> elements;
  BlockArrays<Real> blocks;
  Interfaces<D, Real> interfaces;
  InternalVariables<Real> internal;
  PressurePatches<Real> patches;
  std::vector<HoldSet<D, Real>> holds;
  std::vector<RigidBody<D, Real>> rigid;
  std::vector<SpringSet<D, Real>> springs;
  std::vector<HungVertex<D>> hung;
  std::vector<std::array<Index, 2>> beside_tie;  // element, and nodes of cells that its corners hang on; ascending
  std::vector<LoadSet<D, Real>> loads;
  AbsorbSet<D, Real> absorbing;
  Buffer<int> flags;  // by Notice

 private:
  void number_elements(mesh::Mesh const& mesh);
  void number_vertices(mesh::Mesh const& mesh, Device& device);
  void hang_corners(mesh::Mesh const& mesh);
  void hang_padding();
  void list_slots(Index n_slots, Device& device);
  void place_elements(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  void place_blocks(scene::Scene const& scene, Device& device);
  std::vector<Real> memory_at_start(scene::Scene const& scene, std::size_t numbers) const;
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
  void make_joint_arrays(scene::Scene const& scene, JointNumbers const& numbers, Device& device);
  Vec<double, D> cell_centre(Index e) const;
  Vec<double, D> cell_face_normal(FaceId face) const;
  std::vector<std::uint8_t> place_bond_laws(scene::Scene const& scene, mesh::Mesh const& mesh);
  Vec<double, D> reference_of(Index vertex) const {
    return Eigen::Map<Vec<double, D> const>(vertices.reference[vertex].data());
  }
  std::vector<Real> cell_joints(Simplices<D, Real> const&, JointNumbers const& numbers, Device&) {
    return numbers.stiffness;
  }
  std::vector<Real> cell_joints(Blocks<D, Real> const& set, JointNumbers const& numbers, Device& device);
  void place_memory(scene::Scene const& scene, Device& device);
  void set_motion(scene::Scene const& scene, Device& device);
  void refuse_contradiction(scene::Scene const& scene, scene::Hold const& one, scene::Hold const& other, Index vertex,
                            int c) const;
  void place_holds(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  void place_rigid(scene::Scene const& scene, Device& device);
  void place_springs(scene::Scene const& scene);
  void place_ties(scene::Scene const& scene, mesh::Mesh const& mesh);
  void find_beside_ties();
  void hang(scene::Scene const& scene, scene::Spring const& spring, int which, SpringSet<D, Real>& set) const;
  void weigh_rigid(RigidBody<D, Real>& body, std::vector<Index> const& list, Device& device) const;
  void place_loads(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  template <class Visit>
  void each_face_corner(mesh::Mesh const& mesh, int body, std::vector<int> const& faces, Visit&& visit) const;
  template <class Visit>
  void each_corner_area(mesh::Mesh const& mesh, int body, std::vector<int> const& faces, Visit&& visit) const;
  LoadSet<D, Real> followed(scene::Pressure const& pressure, mesh::Mesh const& mesh, Device& device) const;
  std::vector<kernels::LoadedVertex<D, Real>> loaded_vertices(mesh::Mesh const& mesh, int body,
                                                              std::vector<int> const& faces, bool inward) const;
  std::vector<kernels::LoadedVertex<D, Real>> pushed_vertices(scene::Force const& force, mesh::Mesh const& mesh) const;
  std::vector<kernels::LoadedVertex<D, Real>> volumes_times(scene::BodyForce const& force,
                                                            scene::Scene const& scene) const;
  void place_absorbers(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  std::vector<int> nodes_at(scene::Region const& where, int body, Source const& source, mesh::Mesh const& mesh) const;
  std::vector<int> faces_at(scene::Region const& where, int body, Source const& source, mesh::Mesh const& mesh) const;
  std::vector<std::vector<Index>> vertices_of_nodes(mesh::Mesh const& mesh) const;
  /// A contract: ranges of bodies follow each other, corners have vertices with mass, and joints two sides.
  bool is_sound() const;
  int own_node(mesh::Mesh const& mesh, Index e, int a) const;  // of corner a of an element, as its cell has it
  std::vector<Vec<double, D>> initial_displacements(scene::Scene const& scene, mesh::Mesh const& mesh) const;
  void find_axis(scene::Scene const& scene, mesh::Mesh const& mesh);
};

}  // namespace fissure::model
