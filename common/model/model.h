// Scene and mesh turned into the arrays that kernels run over.
#pragma once
#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "backend/buffer.h"
#include "kernels/blocks.h"
#include "kernels/elements.h"
#include "kernels/loads.h"
#include "mesh/mesh.h"
#include "model/plan.h"
#include "scene/scene.h"

namespace fissure::model {

/// Elements of one body: a contiguous range, padded to whole packs. Elements are simplices: first those that are cells of their
/// own, then, padded again, the parts of blocks.
struct Group {
  int body = 0;
  Index first = 0, count = 0;   // padded range of elements
  Index simplices = 0;          // padded number of those that are no part of a block
  Index first_block = 0, blocks = 0, block_count = 0;  // its blocks: real ones, padded
  kernels::Integration integration = kernels::Integration::one_point;
  std::size_t shapes_at = 0;    // where the numbers of its blocks' shapes begin
  std::size_t block_memory_at = 0;    // where those that its blocks remember begin
  Index first_point = 0;        // where their plastic work begins, after that of all elements
  double viscosity = 0;         // [Pa s]
  bool split = false;           // every corner has its own vertex: the body can crack
  std::optional<laws::Plastic> plastic;   // the law of a body that flows
  std::size_t memory_at = 0;    // where its elements' numbers begin
  Index first_patch = 0, patches = 0;     // of averaged pressure
};

/// Prescribed motion of some vertices.
template <int D, class Real>
struct HoldSet {
  int hold = 0;                                       // index into Scene::holds
  Buffer<kernels::LoadedVertex<D, Real>> list;
  Buffer<Real> impulse, held;                         // [listed][D]
};

/// Surface load on some vertices: value(t) times share.
template <int D, class Real>
struct LoadSet {
  int traction = -1, pressure = -1;                   // index into Scene::tractions or Scene::pressures
  Buffer<kernels::LoadedVertex<D, Real>> list;
};

template <int D, class Real>
class Model {
 public:
  static constexpr int C = D + 1;
  static constexpr int B = BlockShape<D>::corners;
  Index parts = 1;                                     // simplices that a block is made of

  /// Throws Error (with the scene's place) when a place names nothing, or fracture energies are too small for the mesh.
  Model(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh);

  kernels::MeshView<D, Real> view() {
    return {n_elements, n_vertices, X.data(), corner_vertex.data(), parity.data(), u.data(), v.data(), thickness, axisymmetric};
  }
  kernels::MemoryView<Real> memory_view(Group const& group) {
    return {memory.data() + group.memory_at, group.first, plastic_work.data()};
  }
  kernels::BlockView<D, Real> block_view(Group const& group, scene::Scene const& scene) {
    kernels::BlockView<D, Real> view;
    view.vertex = block_vertex.data() + static_cast<std::size_t>(group.first_block) * B;
    view.numbers = block_shapes.data() + group.shapes_at;
    view.force = corner_force() + static_cast<std::size_t>(block_slot(group.first_block, 0)) * D;
    view.first_part = group.first + group.simplices;
    view.parts = parts;
    view.how = group.integration;
    view.thin = scene.two_d == "plane stress";
    std::visit([&](auto const& law) { view.young = law.young, view.poisson = law.poisson; }, scene.materials.at(scene.bodies[group.body].material).bulk);
    return view;
  }
  kernels::MemoryView<Real> block_memory_view(Group const& group) {
    return {memory.data() + group.block_memory_at, 0, plastic_work.data() + n_elements + group.first_point};
  }
  kernels::PatchView<Real> patch_view(Group const& group) {
    if (group.patches == 0) return {};
    return {patch_of_corner.data(), patch_pressure.data(), patch_energy.data()};
  }
  kernels::JointView<D, Real> joint_view() {
    return {link.data(), weight.data(), share.data(), stiffness.data(), history.data(), work.data(), dissipated.data(), softening.data(), flags.data() + 1};
  }
  Real* vertex_force() { return force.data(); }
  Real* corner_force() { return plan.shared ? corners.data() : force.data(); }
  /// Forces of the corners of blocks follow those of the elements.
  Index block_slot(Index block, Index corner) const { return n_elements * C + block * B + corner; }

  /// The block that an element is part of (-1: none), and the parts of a block.
  Index block_of(Index element) const {
    if (!plan.blocks || body_of_element[element] < 0) return -1;
    auto const& group = groups[body_of_element[element]];
    Index const part = element - group.first - group.simplices;
    return part < 0 ? -1 : group.first_block + part / parts;
  }
  /// The element that stands for the cell: itself, or the first part of its block.
  Index cell_head(Index element) const {
    Index const block = block_of(element);
    return block < 0 ? element : part_of(groups[body_of_element[element]], block);
  }
  /// How many elements the cell of a head is made of.
  Index cell_parts(Index head) const { return block_of(head) < 0 ? 1 : parts; }
  Index part_of(Group const& group, Index block, Index k = 0) const { return group.first + group.simplices + (block - group.first_block) * parts + k; }

  Index vertex_of(Index element, Index corner) const {
    return host_corner_vertex.empty() ? element * C + corner : host_corner_vertex[kernels::blocked(element, corner, C)];
  }

  /// Vertices at the corners of the cell whose head an element is.
  std::vector<Index> cell_vertices(Index head) const;
  /// Volume of that cell over that at rest (of a block the least at a Gauss point, or the mean; in axisymmetry with the hoop stretch), and the largest sum over its corners of the
  /// squared gradients of shape functions now [1/m^2], with the displacements u.
  double volume_ratio(std::vector<Real> const& u, Index head, bool mean = false) const;
  double squared_gradients(std::vector<Real> const& u, Index head) const;
  /// What each corner of that cell gets of its volume [m^3].
  std::vector<double> corner_volumes(Index head) const;
  /// Number k of what a cell's element remembers of flow; of a block the mean over its points.
  double remembered(std::vector<Real> const& memory, Index head, int k) const;

  /// Patches of averaged pressure: the corners at a node whose elements are still joined about it. Again when joints broke.
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
  double joint_share(Index e, Index a, Index i) const;
  /// How far a face reaches out of the plane at each corner, which gets the D-th part of its measure times that [m].
  std::array<double, D> face_reach(Vec<double, D> const (&corner)[D]) const;

  Plan plan;
  std::vector<Group> groups;
  Index n_elements = 0, n_vertices = 0, n_blocks = 0;  // padded
  Vec3 origin{0, 0, 0};                                // subtracted from every coordinate, so that far-away scenes lose no digit [m]
  double thickness = 1;                                // out of plane [m], unless:
  bool axisymmetric = false;                           // x is the radius: all that has a volume goes once around
  std::vector<std::string> warnings;

  // On the device.
  Buffer<Real> X, u, v, force, corners, inverse_mass;
  Buffer<Index> corner_vertex, corner_first, corner_list;
  Buffer<std::int8_t> parity;
  Buffer<Index> block_vertex;                          // blocked, number a of 2^D
  Buffer<Real> block_shapes;                           // numbers of the blocks' shapes at rest, body by body
  Buffer<Index> link;
  Buffer<Real> share;                                  // of each corner in a joint's area, 1 on average; empty: all alike
  Buffer<Real> weight, stiffness, history, work;
  Buffer<double> dissipated, viscous_work;
  Buffer<std::uint8_t> softening;
  Buffer<Real> memory;                                 // of elements that flow, body by body
  Buffer<double> plastic_work;
  std::vector<Buffer<double>> curves;                  // yield stresses
  Buffer<Index> patch_of_corner, patch_first, patch_list;
  Buffer<Real> patch_pressure, patch_energy, swelling, swelling_volume;
  Buffer<int> flags;                                   // 0 fault, 1 news
  std::vector<HoldSet<D, Real>> holds;
  std::vector<LoadSet<D, Real>> loads;
  Buffer<Index> axis;                                  // vertices on the axis of revolution: they stay there

  // On the host.
  std::vector<Index> element_of_cell, cell_of_element;            // -1: padding
  std::vector<Index> host_block_vertex;                           // as block_vertex
  std::vector<double> block_corner_volume;                        // what each corner gets of a block's volume [block][2^D] [m^3]
  std::vector<double> host_share;                                 // as share
  std::vector<Index> host_corner_vertex;                          // as corner_vertex; empty when every corner is its own vertex
  std::vector<Index> host_link;                                   // as link
  std::vector<int> corner_node;                                   // [element][corner] mesh node, -1: padding
  std::vector<std::array<double, D>> reference;                   // of vertices, about the origin [m]
  std::vector<double> mass;                                       // of vertices, scaled [kg]
  std::vector<int> body_of_element;
  std::vector<char> on_axis;                                      // mesh nodes; empty without axisymmetry
  std::vector<double> joint_size;                                 // h of the joint on each face [element][corner] [m]

 private:
  std::array<Mat<double, D>, 2> block_jacobians(std::vector<Real> const& u, Index block, int p) const;
  void number_elements(mesh::Mesh const& mesh);
  void number_vertices(mesh::Mesh const& mesh, Device& device);
  void place_elements(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  void place_blocks(scene::Scene const& scene, Device& device);
  std::array<double, D> corner_shares(mesh::Mesh const& mesh, int body, int cell, std::array<int, D> const& nodes) const;
  void place_joints(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  void place_memory(scene::Scene const& scene, Device& device);
  void set_motion(scene::Scene const& scene, Device& device);
  void place_loads(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device);
  std::vector<int> nodes_at(scene::Region const& where, int body, Source const& source, mesh::Mesh const& mesh) const;
  std::vector<int> faces_at(scene::Region const& where, int body, Source const& source, mesh::Mesh const& mesh) const;
  std::vector<std::vector<Index>> vertices_of_nodes(mesh::Mesh const& mesh) const;
  void find_axis(scene::Scene const& scene, mesh::Mesh const& mesh);
};

}  // namespace fissure::model
