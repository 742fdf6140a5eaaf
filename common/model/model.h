// Scene and mesh turned into the arrays that kernels run over.
#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "backend/buffer.h"
#include "kernels/block_joints.h"
#include "kernels/blocks.h"
#include "kernels/elements.h"
#include "kernels/loads.h"
#include "mesh/mesh.h"
#include "model/plan.h"
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

/// Prescribed motion of some vertices.
template <int D, class Real>
struct HoldSet {
  int hold = 0;  // index into Scene::holds
  Buffer<kernels::LoadedVertex<D, Real>> list;
  Buffer<Real> impulse, held;  // [listed][D]
};

/// Surface load on some vertices: value(t) times share.
template <int D, class Real>
struct LoadSet {
  int traction = -1, pressure = -1;  // index into Scene::tractions or Scene::pressures
  Buffer<kernels::LoadedVertex<D, Real>> list;
};

/// What the joints on the F faces of cells have and remember, at P points each.
template <int F, int P, class Real>
struct JointArrays {
  static constexpr int faces = F, points = P, numbers = kernels::JointMemory<F, P, Real>::D;
  Buffer<Real> stiffness, history, work, stretch;  // the last where something rubs
  Buffer<Real> weakness;                           // where strengths differ from the law's
  Buffer<Real> tension;                            // that joints open across, by Rankine's criterion
  Buffer<std::uint8_t> bond;                       // that a face belongs to, counted from 1; empty: there are none
  Buffer<std::uint8_t> softening;
  Buffer<Index> events;        // as FaceEvents
  Buffer<Real> offset;         // of joints that are inserted, as JointMemory, and
  Buffer<std::uint8_t> whole;  // where none is yet [F]

  JointArrays() = default;
  JointArrays(Device& device, std::vector<Real> const& stiffnesses, int dimensions, bool rubs)
      : stiffness(device, "joint stiffness", stiffnesses),
        history(device, "joint history", stiffnesses.size() * P * 3),
        work(device, "joint work", stiffnesses.size() * 2),
        stretch(device, "joint friction", rubs ? stiffnesses.size() * P * dimensions : 0),
        softening(device, "joint softening", stiffnesses.size() / kernels::layout_width),
        events(device, "joint events", stiffnesses.size()) {}
  kernels::JointMemory<F, P, Real> view(Index first, double* dissipated, int* count) {
    std::size_t const at = static_cast<std::size_t>(first) * F;
    return {stiffness.data() + at,
            history.data() + at * P * 3,
            work.data() + at * 2,
            softening.data() + at / kernels::layout_width,
            dissipated + first,
            {count, events.data(), first},
            stretch.empty() ? nullptr : stretch.data() + at * stretch.size() / stiffness.size(),
            weakness.empty() ? nullptr : weakness.data() + at,
            tension.empty() ? nullptr : tension.data() + at * numbers,
            bond.empty() ? nullptr : bond.data() + at,
            offset.empty() ? nullptr : offset.data() + at * P * numbers};
  }
  /// Joints are inserted on the faces that are whole.
  void insert_on_demand(Device& device, std::vector<std::uint8_t> const& whole_faces) {
    whole = Buffer<std::uint8_t>(device, "whole faces", whole_faces);
    offset = Buffer<Real>(device, "joint offsets", stiffness.size() * P * numbers);
  }
  /// Faces of bonds, counted from 1: they are asked one by one, since their law is not their neighbours'.
  void set_bonds(Device& device, std::vector<std::uint8_t> const& bonds) {
    auto soft = softening.download();
    for (std::size_t at = 0; at < bonds.size(); ++at)
      if (bonds[at] > 0) soft[static_cast<std::size_t>(cell_of(at) / kernels::layout_width) * F + face_of(at)] = 1;
    softening.upload(soft);
    bond = Buffer<std::uint8_t>(device, "bonds", bonds);
  }
  /// Room for the tensions of Rankine's criterion; there are none yet, and for planes with strengths of their own never
  /// will be.
  void begin_by_stress(Device& device, std::vector<double> const& any_plane) {
    std::vector<Real> none(stiffness.size() * numbers, Real(0));
    for (std::size_t at = 0; at < any_plane.size(); ++at)
      if (any_plane[at] == 0) none[kernels::blocked(cell_of(at), face_of(at) * numbers, F * numbers)] = Real(-1);
    tension = Buffer<Real>(device, "joint tensions", none);
  }
  /// What number `at` of a blocked array [F] belongs to.
  static Index cell_of(std::size_t at) {
    return static_cast<Index>(at / (F * kernels::layout_width) * kernels::layout_width + at % kernels::layout_width);
  }
  static Index face_of(std::size_t at) { return static_cast<Index>(at / kernels::layout_width % F); }
  /// Strengths of faces over the law's; where it is 0 the face is broken before anything moves. Returns how many of
  /// those there are.
  int set_strengths(Device& device, std::vector<double> const& strengths) {
    std::vector<Real> weak(strengths.size()), past = history.download();
    auto soft = softening.download();
    std::vector<Index> broken;
    for (std::size_t at = 0; at < strengths.size(); ++at) {
      weak[at] = static_cast<Real>(strengths[at] > 0 ? 1 / strengths[at] : 1);
      if (strengths[at] > 0) continue;
      Index const cell = cell_of(at), a = face_of(at);
      soft[static_cast<std::size_t>(cell / kernels::layout_width) * F + a] = 1;
      broken.push_back(cell * F + a);
      for (int i = 0; i < P; ++i)
        for (int k = 0; k < 3; ++k)
          past[kernels::blocked(cell, (a * P + i) * 3 + k, F * P * 3)] =
              k == 0 ? Real(1) : std::numeric_limits<Real>::infinity();
    }
    weakness = Buffer<Real>(device, "joint weakness", weak);
    if (broken.empty()) return 0;
    history.upload(past), softening.upload(soft);
    int const count = static_cast<int>(broken.size());
    broken.resize(events.size(), 0);
    events.upload(broken);
    return count;
  }
};

/// The same on the host, at a moment: of all joints, or of those on some faces (cell * F + face).
template <int F, int P, class Real>
struct JointRecord {
  HostView<Real> stiffness, history, work, stretch, offset;
  int dimensions = 0;     // of the friction springs; 0: none
  bool inserted = false;  // some are, with offsets

  explicit JointRecord(JointArrays<F, P, Real> const& arrays)
      : stiffness(arrays.stiffness),
        history(arrays.history),
        work(arrays.work),
        stretch(arrays.stretch),
        offset(arrays.offset),
        dimensions(springs(arrays)),
        inserted(!arrays.offset.empty()) {}
  JointRecord(JointArrays<F, P, Real> const& arrays, std::vector<Index> const& faces)
      : stiffness(arrays.stiffness, places(faces, 1)),
        history(arrays.history, places(faces, P * 3)),
        work(arrays.work, places(faces, 2)),
        stretch(arrays.stretch, places(faces, P * springs(arrays))),
        offset(arrays.offset, places(faces, arrays.offset.empty() ? 0 : P * arrays.numbers)),
        dimensions(springs(arrays)),
        inserted(!arrays.offset.empty()) {}
  Real stiffness_at(Index cell, int a) const { return stiffness[kernels::blocked(cell, a, F)]; }
  laws::JointHistory<Real> point(Index cell, int a, int i) const {
    auto const number = [&](int k) { return history[kernels::blocked(cell, (a * P + i) * 3 + k, F * P * 3)]; };
    return {number(0), number(1), number(2)};
  }
  /// Number c of the stretch of a point's friction spring [m].
  Real stretch_at(Index cell, int a, int i, int c) const {
    return dimensions > 0 ? stretch[kernels::blocked(cell, (a * P + i) * dimensions + c, F * P * dimensions)] : Real(0);
  }
  /// Offset of the opening of a point that was inserted under pressure, which stays when it has broken [m].
  Real pressed_at(Index cell, int a, int i) const {
    constexpr int numbers = JointArrays<F, P, Real>::numbers;
    return inserted ? std::min(offset[kernels::blocked(cell, (a * P + i) * numbers, F * P * numbers)], Real(0))
                    : Real(0);
  }
  /// Least and largest damage on a face.
  std::array<double, 2> damage(Index cell, int a) const {
    std::array<double, 2> range{1, 0};
    for (int i = 0; i < P; ++i) {
      double const damage = static_cast<double>(point(cell, a, i).damage);
      range = {std::min(range[0], damage), std::max(range[1], damage)};
    }
    return range;
  }
  /// What softening took, and the share of slip in it.
  double taken(Index cell, int a) const {
    return work[kernels::blocked(cell, a * 2, F * 2)] + work[kernels::blocked(cell, a * 2 + 1, F * 2)];
  }
  double mode(Index cell, int a) const {
    double const opening = work[kernels::blocked(cell, a * 2, F * 2)],
                 slip = work[kernels::blocked(cell, a * 2 + 1, F * 2)];
    return opening + slip > 0 ? slip / (opening + slip) : 0;
  }

 private:
  static int springs(JointArrays<F, P, Real> const& arrays) {
    return arrays.stretch.empty() ? 0 : static_cast<int>(arrays.stretch.size() / (arrays.stiffness.size() * P));
  }
  /// Where arrays with n numbers per face keep those of these faces.
  static std::vector<std::size_t> places(std::vector<Index> const& faces, int n) {
    std::vector<std::size_t> at;
    for (Index const face : faces)
      for (int k = 0; k < n; ++k) at.push_back(kernels::blocked(face / F, face % F * n + k, F * n));
    return at;
  }
};

/// What the host must see of a model when the joints on some faces of elements (element * 4 + face) break.
template <class Real>
struct BreakingView {
  HostView<Real> u, weight, block_area;
  HostView<std::int8_t> parity;

  template <class AnyModel>
  BreakingView(AnyModel const& model, std::vector<Index> const& faces) : BreakingView(model, model.places_at(faces)) {}

 private:
  template <class AnyModel, class Places>
  BreakingView(AnyModel const& model, Places const& at)
      : u(model.u, at.displacements),
        weight(model.weight, at.areas),
        block_area(model.block_area, at.block_areas),
        parity(model.parity, at.elements) {}
};

template <int D, class Real>
class Model {
 public:
  static constexpr int C = D + 1;
  static constexpr int B = BlockShape<D>::corners, F = BlockShape<D>::faces, P = BlockShape<D>::face_corners;
  static constexpr int K = P - D + 1;  // simplices' faces that a block's face is cut into
  Index parts = 1;                     // simplices that a block is made of

  /// Throws Error (with the scene's place) when a place names nothing, or fracture energies are too small for the mesh.
  Model(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh);

  kernels::MeshView<D, Real> view() {
    return {n_elements, n_vertices, X.data(),  corner_vertex.data(), parity.data(),
            u.data(),   v.data(),   thickness, axisymmetric};
  }
  kernels::MemoryView<Real> memory_view(Group const& group) {
    return {memory.data() + group.memory_at, group.first, plastic_work.data()};
  }
  kernels::BlockView<D, Real> block_view(Group const& group, scene::Scene const& scene) {
    kernels::BlockView<D, Real> view;
    view.vertex = block_vertex.data() + static_cast<std::size_t>(group.first_block) * B;
    view.numbers = block_shapes.data() + group.shapes_at;
    view.force = corner_force() + static_cast<std::size_t>(group.first_block_slot) * D;
    view.first_part = group.first + group.padded_simplices;
    view.parts = parts;
    view.own = group.split;
    view.how = group.integration;
    view.thin = scene.two_d == "plane stress";
    std::visit([&](auto const& law) { view.young = law.young, view.poisson = law.poisson; },
               scene.materials.at(scene.bodies[group.body].material).bulk);
    return view;
  }
  kernels::MemoryView<Real> block_memory_view(Group const& group) {
    return {memory.data() + group.block_memory_at, 0, plastic_work.data() + n_elements + group.first_point};
  }
  kernels::PatchView<Real> patch_view(Group const& group) {
    if (group.patches == 0) return {};
    return {patch_of_corner.data(), patch_pressure.data(), patch_energy.data()};
  }
  kernels::JointView<D, Real> joint_view(Group const& group) {
    return {link.data(), weight.data(), vertex_of(group.first, 0) - group.first * C};
  }
  kernels::BlockJointView<D, Real> block_joint_view(Group const& group) {
    std::size_t const first = group.first_block;
    return {host_block_vertex[kernels::blocked(group.first_block, 0, B)],
            block_corners.data() + first * B * D,
            across.data() + first * F * P,
            block_area.data() + first * F * P,
            corner_force() + static_cast<std::size_t>(group.first_block_slot) * D,
            group.first + group.padded_simplices,
            static_cast<int>(parts),
            group.padded_blocks,
            beyond.empty() ? nullptr : beyond.data() + first * F};
  }
  kernels::JointMemory<C, D, Real> joint_memory() { return joints.view(0, dissipated.data(), flags.data() + 1); }
  kernels::JointMemory<F, P, Real> block_joint_memory(Group const& group) {
    return block_joints.view(group.first_block, dissipated.data() + n_elements, flags.data() + 2);
  }
  Real* vertex_force() { return force.data(); }
  /// Forces at the corners of cells, by slot; where every corner has a vertex of its own they are the vertices'.
  Real* corner_force() { return plan.shared ? corners.data() : force.data(); }
  /// Where corner a of element e has its force at number e (D + 1) + a.
  Real* element_force(Group const& group) {
    return corner_force() + (static_cast<std::ptrdiff_t>(group.first_slot) - group.first * C) * D;
  }

  /// The block that an element is part of (-1: none), and the parts of a block.
  Index block_of(Index element) const {
    if (!plan.blocks || body_of_element[element] < 0) return -1;
    auto const& group = groups[body_of_element[element]];
    Index const part = element - group.first - group.padded_simplices;
    return part < 0 ? -1 : group.first_block + part / parts;
  }
  /// The element that stands for the cell: itself, or the first part of its block.
  Index cell_head(Index element) const {
    Index const block = block_of(element);
    return block < 0 ? element : part_of(groups[body_of_element[element]], block);
  }
  /// Padding is a copy of a body's first block, without mass.
  static Index real_block(Group const& group, Index block) {
    return block < group.first_block + group.blocks ? block : group.first_block;
  }
  /// How many elements the cell of a head is made of.
  Index cell_parts(Index head) const { return block_of(head) < 0 ? 1 : parts; }
  Index part_of(Group const& group, Index block, Index k = 0) const {
    return group.first + group.padded_simplices + (block - group.first_block) * parts + k;
  }

  /// The law of the joint on face a of an element that is a cell.
  laws::AnyJoint joint_law(scene::Scene const& scene, Index element, int a) const {
    std::uint8_t const bond = host_bond.empty() ? 0 : host_bond[kernels::blocked(element, a, C)];
    return bond > 0 ? laws::AnyJoint(host_bond_laws[bond - 1])
                    : *scene.materials[scene.bodies[body_of_element[element]].material].joint;
  }

  Index vertex_of(Index element, Index corner) const {
    return host_corner_vertex.empty() ? element * C + corner : host_corner_vertex[kernels::blocked(element, corner, C)];
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
  double out_of_plane(Index e) const { return axisymmetric ? 2 * std::numbers::pi * mean_radius(e) : thickness; }
  /// What corner a gets of an element's mass, and corner i of face a of its joint's area, over a like share [-].
  double mass_share(Index e, Index a) const;
  Real joint_share(Index e, Index a, Index i) const;

  /// The faces of parts, element * 4 + face, that the face of a block with a joint is cut into.
  std::span<Index const> parts_at(Index block, int face) const {
    Index const* const first = &face_parts[(static_cast<std::size_t>(block) * F + face) * K];
    return {first, *first < 0 ? 0u : static_cast<std::size_t>(K)};  // both of a hexahedron's or none
  }
  /// The face of a block, block * F + face, that face a of its part e is or lies on; -1: none.
  Index block_face(Index e, Index a) const;
  /// The point of that block's face at corner i of face a of its part e.
  int block_point(Index e, Index a, int i) const;
  /// Area at rest of the joint on face a of element e at its corner i [m^2]: where parts of a block's face meet, each
  /// has its share.
  Real joint_area(BreakingView<Real> const& now, Index e, Index a, int i) const;
  /// Where arrays keep what belongs to the joints on these faces of elements: displacements of their own corners and of
  /// those across.
  struct Places {
    std::vector<std::size_t> displacements, areas, block_areas, elements;
  };
  Places places_at(std::vector<Index> const& faces) const;
  /// No joint any more on face a of element e.
  void unlink(Index e, Index a);
  /// How far a face reaches out of the plane at each corner, which gets the D-th part of its measure times that [m].
  std::array<double, D> face_reach(Vec<double, D> const (&corner)[D]) const;

  Plan plan;
  std::vector<Group> groups;
  Index n_elements = 0, n_vertices = 0, n_blocks = 0;  // padded
  // subtracted from every coordinate, so that far-away scenes lose no digit [m]
  Vec3 origin{0, 0, 0};
  double thickness = 1;       // out of plane [m], unless:
  bool axisymmetric = false;  // x is the radius: all that has a volume goes once around
  std::vector<std::string> warnings;

  // On the device.
  Buffer<Real> X, u, v, force, corners, inverse_mass;
  Buffer<Index> corner_vertex, corner_first, corner_list;
  Buffer<std::int8_t> parity;
  Buffer<Index> block_vertex;  // blocked, number a of 2^D
  Buffer<Real> block_shapes;   // numbers of the blocks' shapes at rest, body by body
  Buffer<Index> link;          // [element][D + 1], as JointView
  Buffer<Real> weight;
  JointArrays<D + 1, D, Real> joints;  // of elements that are cells; empty where only blocks can crack
  Buffer<Real> block_corners;          // as BlockJointView
  Buffer<Index> across, beyond;
  Buffer<Real> block_area;
  JointArrays<BlockShape<D>::faces, BlockShape<D>::face_corners, Real> block_joints;
  Buffer<laws::CohesiveJoint> bond_laws;  // of each bond, by the friction of its bodies
  Buffer<double> dissipated;              // by joints: of elements, then of blocks
  Buffer<double> viscous_work;
  Buffer<Real> memory;  // of elements that flow, body by body
  Buffer<double> plastic_work;
  std::vector<Buffer<double>> curves;  // yield stresses
  Buffer<Index> patch_of_corner, patch_first, patch_list;
  Buffer<double> stress;          // [element][6], where joints begin by stress, and
  Buffer<std::uint8_t> stressed;  // which elements are near to that
  // of all joints that are no crack from the start, over their law's
  double least_strength = 1;
  Buffer<Real> patch_pressure, patch_energy, swelling, swelling_volume;
  Buffer<int> flags;  // 0 fault, 1 and 2: events of joints of elements and of blocks
  std::vector<HoldSet<D, Real>> holds;
  std::vector<LoadSet<D, Real>> loads;
  Buffer<Index> axis;  // vertices on the axis of revolution: they stay there

  // On the host.
  std::vector<Index> element_of_cell, cell_of_element;  // -1: padding
  std::vector<Index> host_block_vertex;                 // as block_vertex
  std::vector<Real> host_block_shapes;                  // as block_shapes
  // what each corner gets of a block's volume [block][2^D] [m^3]
  std::vector<double> block_corner_volume;
  // [block][face][K] faces of parts, element * 4 + face; -1: no joint
  std::vector<Index> face_parts;
  // as corner_vertex; empty when every corner is its own vertex
  std::vector<Index> host_corner_vertex;
  std::vector<Index> host_link;  // as link
  // [element][corner] mesh node, of twins the lowest; -1: padding
  std::vector<int> corner_node;
  std::vector<laws::CohesiveJoint> host_bond_laws;
  // [face] blocked as link: bond law from 1, 0: the body's own; may be empty
  std::vector<std::uint8_t> host_bond;
  std::vector<std::array<double, D>> reference;  // of vertices, about the origin [m]
  std::vector<double> mass;                      // of vertices, scaled [kg]
  std::vector<int> body_of_element;
  std::vector<char> on_axis;  // mesh nodes; empty without axisymmetry
  // h of the joint on each face blocked, number a of D + 1 [m]
  std::vector<double> joint_size;

 private:
  std::array<Mat<double, D>, 2> block_jacobians(std::vector<Real> const& u, Index block, int p) const;
  std::array<double, 2> block_radii(std::vector<Real> const& u, Index block, int p) const;
  void number_elements(mesh::Mesh const& mesh);
  void number_vertices(mesh::Mesh const& mesh, Device& device);
  void place_elements(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  void place_blocks(scene::Scene const& scene, Device& device);
  std::array<double, D> corner_shares(mesh::Mesh const& mesh, int body, int cell,
                                      std::array<int, D> const& nodes) const;
  void place_joints(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  std::vector<std::uint8_t> place_bond_laws(scene::Scene const& scene, mesh::Mesh const& mesh);
  // number of the face of its block that face a of part e lies on; -1: inside
  int face_of_block(Index e, Index a) const;
  int point_on_face(Index e, Index a, int i, int face) const;  // of corner i of that; -1: not on the face
  Vec<double, D> reference_of(Index vertex) const { return Eigen::Map<Vec<double, D> const>(reference[vertex].data()); }
  std::vector<double> least_of_parts(std::vector<double> const& of_parts) const;
  std::vector<std::uint8_t> whole_of_parts(std::vector<std::uint8_t> const& of_parts) const;
  void place_block_joints(std::vector<Real> const& weights, std::vector<Real> const& stiffnesses,
                          std::vector<double> const& shares, Device& device);
  void place_memory(scene::Scene const& scene, Device& device);
  void set_motion(scene::Scene const& scene, Device& device);
  void refuse_contradictions(scene::Scene const& scene) const;
  void place_loads(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  std::vector<int> nodes_at(scene::Region const& where, int body, Source const& source, mesh::Mesh const& mesh) const;
  std::vector<int> faces_at(scene::Region const& where, int body, Source const& source, mesh::Mesh const& mesh) const;
  std::vector<std::vector<Index>> vertices_of_nodes(mesh::Mesh const& mesh) const;
  int own_node(mesh::Mesh const& mesh, Index e, int a) const;  // of corner a of an element, as its cell has it
  void find_axis(scene::Scene const& scene, mesh::Mesh const& mesh);
};

}  // namespace fissure::model
