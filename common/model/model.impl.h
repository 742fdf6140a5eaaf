// Building a model's arrays; instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "model/cells.impl.h"
#include "model/initial_strain.h"
#include "model/interfaces.impl.h"
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
    : plan(make_plan(scene, mesh)), section(Dim<D>{}, scene.two_d, mesh.thickness) {
  blocks.parts = mesh::block_parts(mesh.kind);
  Vec3 low = mesh.nodes.at(0), high = low;
  for (auto const& x : mesh.nodes) low = low.cwiseMin(x), high = high.cwiseMax(x);
  origin = (low + high) / 2;
  if (section.axisymmetric()) find_axis(scene, mesh);
  for (int b = 0; b < mesh.n_bodies(); ++b) {
    Group group;
    group.body = b;
    group.simplices.first = elements.count, group.simplices.count = mesh.n_simplices(b);
    group.blocks.first = blocks.count, group.blocks.count = mesh.n_blocks(b);
    for (CellRange* range : {&group.simplices, &group.blocks}) range->padded = whole_packs(range->count);
    group.count = group.simplices.padded + group.blocks.padded * blocks.parts;  // padding blocks have parts, too
    group.first = elements.count;
    group.integration = integration(scene.bodies[b].mesh.integration, section.plane_stress());
    blocks.count += group.blocks.padded;
    auto const& material = scene.materials.at(scene.bodies[b].material);
    group.split = material.joint.has_value();
    group.rigid = scene.bodies[b].rigid;
    group.rankine =
        group.split && starts_by_stress(*material.joint, group.simplices.padded > 0, group.blocks.count > 0);
    group.inserted = group.split && std::visit([](auto const& joint) { return joint.inserted; }, *material.joint);
    elements.count += group.count;
    groups.push_back(group);
  }
  if (scene.run.remove_crushed || !scene.excavations.empty()) elements.removed.assign(elements.count, 0);
  number_elements(mesh);
  number_vertices(mesh, device);
  place_elements(scene, mesh, device);
  place_blocks(scene, device);
  if (plan.joints) place_joints(scene, mesh, device);
  if (plan.plastic) place_memory(scene, device);
  if (plan.patches) place_patches(device);
  set_motion(scene, device);
  if (plan.holds) place_holds(scene, mesh, device);
  place_rigid(scene, device);
  place_springs(scene);
  place_ties(scene, mesh);
  if (plan.loads) place_loads(scene, mesh, device);
  if (plan.absorbs) place_absorbers(scene, mesh, device);
  if (flags.empty()) flags = Buffer<int>(device, "flags", Notice::count);
  FISSURE_EXPECT(is_sound());
}

template <int D, class Real>
bool Model<D, Real>::is_sound() const {
  Index first = 0, first_block = 0;
  for (auto const& group : groups) {
    if (group.first != first || group.blocks.first != first_block) return false;
    first += group.count, first_block += group.blocks.padded;
    if (group.count != group.simplices.padded + group.blocks.padded * blocks.parts) return false;
  }
  if (first != elements.count || first_block != blocks.count) return false;
  for (Index e = 0; e < elements.count; ++e)
    for (int a = 0; a < C; ++a) {
      if (Index const vertex = vertex_of(e, a); vertex < 0 || vertex >= vertices.count) return false;
      if (elements.cell[e] >= 0 && !(vertices.mass[vertex_of(e, a)] > 0)) return false;
      if (plan.joints && !(neighbour(neighbour({e, a})) == FaceId{e, a})) return false;
    }
  return true;
}

template <int D, class Real>
double Model<D, Real>::slowest_vibration(scene::Scene const& scene) const {
  double wave = INFINITY, reach = 0;  // the slowest [m/s]; half of what the scene measures along its longest axis [m]
  for (auto const& body : scene.bodies) {
    auto const& material = scene.materials[body.material];
    if (!body.rigid)
      wave = std::min(wave, std::sqrt(material.elastic().young / (material.density * scene.run.mass_scaling)));
  }
  for (auto const& x : vertices.reference)
    for (double const along : x) reach = std::max(reach, std::abs(along));
  return std::numbers::pi / 2 * wave / (2 * reach);
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
  for (auto const& x : mesh.nodes) section.on_axis.push_back(x[0] < rounding);
  origin[0] = 0;
}

/// Of every node, from the place without stress; empty where no body begins with a stress.
template <int D, class Real>
std::vector<Vec<double, D>> Model<D, Real>::initial_displacements(scene::Scene const& scene,
                                                                  mesh::Mesh const& mesh) const {
  std::vector<std::optional<InitialStrain>> of_body(scene.bodies.size());
  std::vector<Vec<double, D>> all;
  for (int b = 0; b < mesh.n_bodies(); ++b) {
    auto const& body = scene.bodies[b];
    if (!body.stress_at) continue;
    auto const& material = scene.materials[body.material];
    auto const refuse = [&](char const* why) {
      throw Error(body.source, fmt::format("body \"{}\" begins with a stress, {}", body.name, why));
    };
    if (material.flow && material.flow->averaged)
      refuse("and its material's pressure is \"averaged\", which no element remembers; write pressure = \"element\"");
    if (material.flow) continue;  // its points remember the stress itself
    int const first = mesh.body_first_node[b], end = mesh.body_first_node[b + 1];
    Vec3 low = mesh.nodes[first], high = low;
    for (int n = first; n < end; ++n) low = low.cwiseMin(mesh.nodes[n]), high = high.cwiseMax(mesh.nodes[n]);
    of_body[b].emplace(body, material.elastic(), section, Dim<D>::has_plane_stress, low, high, origin);
    if (all.empty()) all.assign(mesh.nodes.size(), Vec<double, D>::Zero());
    for (int n = first; n < end; ++n) all[n] = (*of_body[b])(mesh.nodes[n]).template head<D>();
  }
  for (auto const& bond : scene.bonds)
    for (int const b : bond.bodies) {
      auto const &one = of_body[bond.bodies[0]], &other = of_body[b];
      if (one.has_value() != other.has_value() && scene.bodies[b].stress_at && scene.bodies[bond.bodies[0]].stress_at)
        throw Error(bond.source,
                    fmt::format("bond \"{}\": one of its bodies that begin with a stress flows, and another "
                                "does not: what flows is not strained to it; give both a material that "
                                "flows, or neither",
                                bond.name));
      if (one.has_value() != other.has_value() || (one && !one->like(*other)))
        throw Error(bond.source,
                    fmt::format("bond \"{}\": its bodies begin with stresses that do not fit together: where "
                                "they meet they must be strained alike",
                                bond.name));
    }
  return all;
}

/// Elements are the mesh's cells in order, each with its corners sorted by node.
template <int D, class Real>
void Model<D, Real>::number_elements(mesh::Mesh const& mesh) {
  elements.of_cell.assign(mesh.n_cells(), -1);
  elements.cell.assign(elements.count, -1);
  elements.body.assign(elements.count, -1);
  elements.node.assign(static_cast<std::size_t>(elements.count) * C, -1);
  for (auto const& group : groups)
    for (Index cell = mesh.body_first_cell[group.body], k = 0; cell < mesh.body_first_cell[group.body + 1];
         ++cell, ++k) {
      Index const simplices = mesh.n_simplices(group.body),
                  e = group.first + k + (k < simplices ? 0 : group.simplices.padded - simplices);
      elements.of_cell[cell] = e;
      elements.cell[e] = cell;
      elements.body[e] = group.body;
      int* const nodes = &elements.node[static_cast<std::size_t>(e) * C];
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
  Index n_slots = 0;
  for (auto& group : groups) {
    group.simplices.first_slot = n_slots, group.blocks.first_slot = n_slots + group.simplices.padded * C;
    n_slots = group.blocks.first_slot + group.blocks.padded * B;
    // numbers across a bond follow from each other
    if (!mesh.bonded.empty()) n_slots = std::max(n_slots, (group.first + group.count) * C);
  }
  vertices.count = n_slots;  // slots are vertices, unless:
  if (plan.shared || plan.blocks) {
    vertices.count = 0;
    hang_corners(mesh);
    if (plan.shared) hang_padding();
    elements.vertex = Buffer<Index>(device, "corner vertices", elements.host_vertex);
    blocks.vertex = Buffer<Index>(device, "block corners", blocks.host_vertex);
  }
  vertices.reference.resize(vertices.count);
  if (plan.shared) list_slots(n_slots, device);
}

/// The vertices at the corners of all cells, and of the parts of blocks.
template <int D, class Real>
void Model<D, Real>::hang_corners(mesh::Mesh const& mesh) {
  std::vector<Index> vertex_of_node(mesh.nodes.size(), -1);
  elements.host_vertex.assign(static_cast<std::size_t>(elements.count) * C, -1);
  blocks.host_vertex.assign(static_cast<std::size_t>(blocks.count) * B, -1);
  for (auto const& group : groups) {
    auto const at_node = [&](int node) {
      Index& vertex = vertex_of_node[node];
      if (vertex < 0) vertex = vertices.count++;
      return vertex;
    };
    for (Index e = group.first; e < group.first + group.simplices.padded; ++e) {
      if (elements.cell[e] < 0 && !group.split) continue;
      for (int a = 0; a < C; ++a)
        elements.host_vertex[blocked(e, a, C)] =
            group.split ? vertices.count++ : at_node(elements.node[static_cast<std::size_t>(e) * C + a]);
    }
    for (Index b = group.blocks.first; b < group.blocks.first + group.blocks.padded; ++b) {
      bool const padding = real_block(group, b) != b;
      if (padding && !group.split) continue;
      int const* const nodes =
          padding
              ? nullptr
              : &mesh.blocks[static_cast<std::size_t>(mesh.body_first_block[group.body] + b - group.blocks.first) * B];
      for (int a = 0; a < B; ++a)
        blocks.host_vertex[blocked(b, a, B)] = group.split ? vertices.count++ : at_node(nodes[a]);
      for (Index k = 0; k < blocks.parts; ++k)
        for (int a = 0; a < C; ++a) {
          Index const part = part_of(group, b, k);
          auto const corner =
              padding ? a : std::find(nodes, nodes + B, elements.node[static_cast<std::size_t>(part) * C + a]) - nodes;
          elements.host_vertex[blocked(part, a, C)] = blocks.host_vertex[blocked(b, static_cast<Index>(corner), B)];
        }
    }
    if (!mesh.bonded.empty()) vertices.count = std::max(vertices.count, (group.first + group.count) * C);  // as slots
  }
}

/// Padding that has no vertices hangs on some of its own that nothing moves.
template <int D, class Real>
void Model<D, Real>::hang_padding() {
  Index const idle = vertices.count;
  vertices.count = whole_packs(vertices.count + std::max(C, B));
  for (Index e = 0; e < elements.count; ++e)
    for (int a = 0; a < C; ++a)
      if (Index& vertex = elements.host_vertex[blocked(e, a, C)]; vertex < 0) vertex = idle + a;
  for (Index b = 0; b < blocks.count; ++b)
    for (int a = 0; a < B; ++a)
      if (Index& vertex = blocks.host_vertex[blocked(b, a, B)]; vertex < 0) vertex = idle + a;
}

/// The slots that each vertex sums, in order.
template <int D, class Real>
void Model<D, Real>::list_slots(Index n_slots, Device& device) {
  auto const over_slots = [&](auto&& f) {
    for (auto const& group : groups) {
      each_set([&](auto const& set) {
        auto const& cells = set.range(group);
        Index slot = cells.first_slot;
        for (Index cell = cells.first; cell < cells.first + cells.padded; ++cell)
          for (int a = 0; a < set.corners; ++a) f(set.vertex(cell, a), slot++);
      });
    }
  };
  std::vector<Index> first(vertices.count + 1, 0);
  over_slots([&](Index vertex, Index) { ++first[vertex + 1]; });
  for (Index i = 0; i < vertices.count; ++i) first[i + 1] += first[i];
  std::vector<Index> next(first.begin(), first.end() - 1), list(first.back());
  over_slots([&](Index vertex, Index slot) { list[next[vertex]++] = slot; });
  slots.first = Buffer<Index>(device, "vertex corners", first);
  slots.list = Buffer<Index>(device, "vertex corners", list);
  slots.force = Buffer<Real>(device, "corner forces", static_cast<std::size_t>(n_slots) * D);
}

template <int D, class Real>
void Model<D, Real>::place_elements(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device) {
  std::vector<Real> coordinates(static_cast<std::size_t>(elements.count) * C * D);
  std::vector<std::int8_t> orientation(elements.count, 1);
  vertices.mass.assign(vertices.count, 0);
  auto const strained = initial_displacements(scene, mesh);  // of nodes
  if (!strained.empty()) vertices.start.assign(static_cast<std::size_t>(vertices.count) * D, 0);
  auto const quality = mesh::quality(mesh);
  for (auto& group : groups) {
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    double const density = material.density * scene.run.mass_scaling;
    double const young = material.elastic().young;
    group.damping.mu =
        material.viscosity + material.critical_share * 2 * quality[group.body].mean_edge * std::sqrt(young * density);
    for (Index e = group.first; e < group.first + group.count; ++e) {
      // padding is a copy of the first element, without mass
      Index const from = elements.cell[e] >= 0 ? e : group.first;
      Mat<double, D> edges;
      for (int a = 0; a < C; ++a) {
        int const node = elements.node[static_cast<std::size_t>(from) * C + a];
        Vec3 x = mesh.nodes[node] - origin;
        if (section.axisymmetric() && section.on_axis[node]) x[0] = 0;
        for (int c = 0; c < D; ++c) {
          if (!strained.empty() && elements.cell[e] >= 0) {  // padding has no stress
            x[c] -= strained[node][c];
            vertices.start[static_cast<std::size_t>(vertex_of(e, a)) * D + c] = strained[node][c];
          }
          coordinates[blocked(e, a * D + c, C * D)] = static_cast<Real>(x[c]);
          vertices.reference[vertex_of(e, a)][c] = x[c];
          if (a > 0) edges(c, a - 1) = x[c] - vertices.reference[vertex_of(e, 0)][c];
        }
      }
      double const determinant = edges.determinant();
      orientation[e] = determinant > 0 ? 1 : -1;
      if (e < group.first + group.simplices.count)
        for (int a = 0; a < C; ++a)
          vertices.mass[vertex_of(e, a)] +=
              density * std::abs(determinant) * Dim<D>::simplex_share * out_of_plane(e) / C * mass_share(e, a);
    }
  }
  elements.X = Buffer<Real>(device, "reference coordinates", coordinates);
  elements.parity = Buffer<std::int8_t>(device, "orientation", orientation);
  vertices.force = Buffer<Real>(device, "forces", static_cast<std::size_t>(vertices.count) * D);
  if (plan.viscous || plan.joints) elements.viscous_work = Buffer<double>(device, "viscous work", elements.count);
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
    static_cast<laws::ElasticConstants&>(law) = material.elastic();
    law.logarithmic = flow.logarithmic, law.bisection = flow.bisection;
    law.plane_stress = section.plane_stress();
    law.flow.which = static_cast<int>(flow.law.index());
    bool has_back = false;
    std::visit(
        [&]<class Law>(Law given) {
          if constexpr (std::is_base_of_v<laws::Curves, Law>) {
            internal.curves.emplace_back(device, "yield curves", flow.curves);
            given.numbers = internal.curves.back().data();
          }
          if constexpr (requires { given.melting_rise; }) given.melting_rise = given.melting - flow.heat.reference;
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
    group.simplices.memory_at = numbers;
    numbers += static_cast<std::size_t>(group.simplices.padded) * m.numbers;
    Index const points = group.blocks.padded * kernels::BlockNumbers<D>::points(group.integration);
    group.blocks.memory_at = numbers, group.first_point = all_points;
    numbers += static_cast<std::size_t>(points) * m.numbers;
    all_points += points;
    auto const& body = scene.bodies[group.body];
    if (flow.averaged && group.blocks.count > 0)
      throw Error(body.source,
                  fmt::format("body \"{}\" has blocks, and its material plastic{{ pressure = \"averaged\" }} (which is "
                              "for simplices); write mesh = {{ integration = \"b_bar\" }} instead",
                              body.name));
    if (flow.averaged) group.patches = 1;  // counted by place_patches()
  }
  internal.memory = Buffer<Real>(device, "plastic memory", memory_at_start(scene, numbers));
  internal.work = Buffer<double>(device, "plastic work", elements.count + all_points);
}

/// What points of materials that flow remember at the start: their temperature, and the stress that their body begins
/// with (in the middle of their cell), which needs no strain to fit to.
template <int D, class Real>
std::vector<Real> Model<D, Real>::memory_at_start(scene::Scene const& scene, std::size_t numbers) const {
  std::vector<Real> memory(numbers, Real(0));
  for (auto const& group : groups) {
    if (!group.plastic) continue;
    auto const& body = scene.bodies[group.body];
    auto const& m = group.plastic->memory;
    auto const begin = [&](Real* point, Index head) {  // point: its number 0; number k stands k layout_width further
      auto const& heat = scene.materials.at(body.material).flow->heat;
      if (m.rise >= 0)
        point[m.rise * layout_width] = static_cast<Real>(body.temperature.value_or(heat.start) - heat.reference);
      if (!body.stress_at || elements.cell[head] < 0) return;
      Vec3 x = origin;
      x.template head<D>() += cell_centre(head);
      auto stress = body.stress_at(x[0], x[1], x[2]);
      if (section.plane_stress()) stress[2] = 0;
      for (int k = 0; k < Dim<D>::stresses; ++k) point[k * layout_width] = static_cast<Real>(stress[k]);
    };
    for (Index i = 0; i < group.simplices.padded; ++i)
      begin(&memory[group.simplices.memory_at + kernels::blocked(i, 0, m.numbers)], group.first + i);
    Index const points = kernels::BlockNumbers<D>::points(group.integration);
    for (Index b = 0; b < group.blocks.padded; ++b)
      for (Index p = 0; p < points; ++p)
        begin(&memory[group.blocks.memory_at + kernels::blocked(kernels::point_of_block(b, p, points), 0, m.numbers)],
              part_of(group, real_block(group, group.blocks.first + b)));
  }
  return memory;
}

template <int D, class Real>
void Model<D, Real>::place_patches(Device& device) {
  // Patch 0 is empty: padding hangs on it and neither presses nor stores anything.
  std::vector<Index> of_corner(static_cast<std::size_t>(elements.count) * C, 0), first{0, 0}, list;
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
      for (int a = 0; a < C && elements.cell[e] >= 0; ++a) {
        if (!group.split) {
          auto const [known, is_new] =
              at_node.emplace(elements.node[static_cast<std::size_t>(e) * C + a], corner(e, a));
          if (!is_new) root[find(corner(e, a))] = find(known->second);
          continue;
        }
        FaceId const here{e, a}, there = neighbour(here);
        if (there == here) continue;
        for (int i = 0; i < D; ++i)
          root[find(corner(e, here.corner(i)))] = find(corner(there.element, there.corner(i)));
      }
    std::vector<std::vector<Index>> members(root.size());
    for (Index e = group.first; e < group.first + group.count; ++e)
      for (int a = 0; a < C && elements.cell[e] >= 0; ++a) members[find(corner(e, a))].push_back(corner(e, a));
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
  std::size_t const count = first.size() - 1;
  patches.of_corner = Buffer<Index>(device, "patches", of_corner);
  patches.first = Buffer<Index>(device, "patches", first);
  patches.list = Buffer<Index>(device, "patches", list);
  patches.pressure = Buffer<Real>(device, "patches", count);
  patches.energy = Buffer<Real>(device, "patches", count);
  patches.swelling = Buffer<Real>(device, "patches", elements.count);
  patches.volume = Buffer<Real>(device, "patches", elements.count);
}

template <int D, class Real>
Mat<double, D> Model<D, Real>::edges(Index e) const {
  Mat<double, D> edges;
  for (int b = 0; b < D; ++b)
    for (int c = 0; c < D; ++c)
      edges(c, b) = vertices.reference[vertex_of(e, b + 1)][c] - vertices.reference[vertex_of(e, 0)][c];
  return edges;
}

template <int D, class Real>
Mat<double, D> Model<D, Real>::moved_edges(std::span<Real const> u, Index e) const {
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
  for (int a = 0; a < C; ++a) sum += vertices.reference[vertex_of(e, a)][0];
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
  return section.axisymmetric() ? kernels::ring_share<C>(vertices.reference[vertex_of(e, a)][0], mean_radius(e)) : 1;
}

template <int D, class Real>
std::array<double, D> Model<D, Real>::face_reach(Vec<double, D> const (&corner)[D]) const {
  std::array<double, D> reach;
  reach.fill(section.thickness);
  double radii = 0;
  for (auto const& x : corner) radii += x[0];
  for (int i = 0; i < D && section.axisymmetric(); ++i)
    reach[i] = 2 * std::numbers::pi * (corner[i][0] + radii) / (D + 1);
  return reach;
}

template <int D, class Real>
void Model<D, Real>::set_motion(scene::Scene const& scene, Device& device) {
  std::size_t const n = static_cast<std::size_t>(vertices.count) * D;
  std::vector<Real> velocity(n, 0), inverse(vertices.count, 0);
  std::vector<Index> still;
  for (Index i = 0; i < vertices.count; ++i)
    inverse[i] = vertices.mass[i] > 0 ? static_cast<Real>(1 / vertices.mass[i]) : Real(0);
  for (auto const& group : groups) {
    auto const& body = scene.bodies[group.body];
    for (Index e = group.first; e < group.first + group.count; ++e)
      for (int a = 0; a < C && elements.cell[e] >= 0; ++a) {
        Index const vertex = vertex_of(e, a);
        Vec3 const x = drawn_at(vertex);
        auto const start = body.velocity_at ? body.velocity_at(x[0], x[1], x[2]) : body.velocity;
        for (int c = 0; c < D; ++c) velocity[static_cast<std::size_t>(vertex) * D + c] = static_cast<Real>(start[c]);
        if (!section.axisymmetric() || !section.on_axis[elements.node[static_cast<std::size_t>(e) * C + a]]) continue;
        velocity[static_cast<std::size_t>(vertex) * D] = 0;
        still.push_back(vertex);
      }
  }
  if (vertices.start.empty())
    vertices.u = Buffer<Real>(device, "displacements", n);
  else
    vertices.u = Buffer<Real>(device, "displacements", std::vector<Real>(vertices.start.begin(), vertices.start.end()));
  vertices.v = Buffer<Real>(device, "velocities", velocity);
  vertices.inverse_mass = Buffer<Real>(device, "inverse masses", inverse);
  std::sort(still.begin(), still.end());
  still.erase(std::unique(still.begin(), still.end()), still.end());
  vertices.on_axis = Buffer<Index>(device, "axis", still);
}

}  // namespace fissure::model
