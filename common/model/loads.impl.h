// Where motion is prescribed and surfaces are loaded; a part of model.impl.h.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "model/model.h"

namespace fissure::model {

template <int D, class Real>
std::vector<int> Model<D, Real>::nodes_at(scene::Region const& where, int body, Source const& source,
                                          mesh::Mesh const& mesh) const {
  std::vector<int> nodes;
  if (where.inside) {
    for (int n = mesh.body_first_node[body]; n < mesh.body_first_node[body + 1]; ++n)
      if (where.inside(mesh.nodes[n][0], mesh.nodes[n][1], mesh.nodes[n][2])) nodes.push_back(n);
    if (nodes.empty())
      throw Error(source, "no vertex of the body lies where the function says (it returned false everywhere)");
    return nodes;
  }
  auto const& names = mesh.named_nodes.at(body);
  auto const found = names.find(where.name);
  if (found != names.end()) return found->second;
  if (where.name == "front" || where.name == "back") return {};  // a flat model has none
  std::vector<std::string> known;
  for (auto const& [name, list] : names) known.push_back(name);
  throw Error(source, fmt::format("the body has no place \"{}\" (known: {}){}", where.name, fmt::join(known, ", "),
                                  suggestion(where.name, known)));
}

template <int D, class Real>
std::vector<int> Model<D, Real>::faces_at(scene::Region const& where, int body, Source const& source,
                                          mesh::Mesh const& mesh) const {
  if (!where.inside) {
    if (nodes_at(where, body, source, mesh).empty()) return {};  // a side that a flat model does not have
    auto const& names = mesh.named_faces.at(body);
    auto const found = names.find(where.name);
    if (found == names.end() || found->second.empty())
      throw Error(source, fmt::format("the body has no face at \"{}\" that could be loaded (it has nodes there, but is "
                                      "sharp, or bonded all over)",
                                      where.name));
    return found->second;
  }
  std::vector<int> faces;
  for (int f = 0; f < static_cast<int>(mesh.boundary.size()); ++f) {
    auto const& face = mesh.boundary[f];
    if (face.cell < mesh.body_first_cell[body] || face.cell >= mesh.body_first_cell[body + 1]) continue;
    Vec3 middle{0, 0, 0};
    for (int i = 0; i < D; ++i) middle += mesh.nodes[face.node[i]] / D;
    if (where.inside(middle[0], middle[1], middle[2])) faces.push_back(f);
  }
  if (faces.empty())
    throw Error(source, "no face of the body lies where the function says (it returned false at every face's centre)");
  return faces;
}

template <int D, class Real>
int Model<D, Real>::own_node(mesh::Mesh const& mesh, Index e, int a) const {
  int const* const cell = &mesh.cells[static_cast<std::size_t>(elements.cell[e]) * C];
  return *std::find_if(
      cell, cell + C, [&](int node) { return mesh.place(node) == elements.node[static_cast<std::size_t>(e) * C + a]; });
}

template <int D, class Real>
std::vector<std::vector<Index>> Model<D, Real>::vertices_of_nodes(mesh::Mesh const& mesh) const {
  std::vector<std::vector<Index>> vertices(mesh.nodes.size());
  for (Index e = 0; e < elements.count; ++e)
    for (int a = 0; a < C && elements.cell[e] >= 0; ++a) {
      auto& list = vertices[own_node(mesh, e, a)];
      Index const vertex = vertex_of(e, a);
      if (std::find(list.begin(), list.end(), vertex) == list.end()) list.push_back(vertex);
    }
  return vertices;
}

/// Refuses two holds that ask a vertex, or some that it stands for, for different motions along direction c: the last
/// said would win, and both would book work. Motions are compared at 65 times of the run, so that equal functions (a
/// body held at two of its places) stay allowed.
template <int D, class Real>
void Model<D, Real>::refuse_contradiction(scene::Scene const& scene, scene::Hold const& one, scene::Hold const& other,
                                          Index vertex, int c) const {
  Vec3 const place = drawn_at(vertex);
  for (int k = 0; k <= 64; ++k) {
    double const t = scene.run.time * k / 64, a = one.velocity_at(c, place, t), b = other.velocity_at(c, place, t);
    if (one.agrees(other, c, place, t)) continue;
    std::string const both = fmt::format("this hold and the one at {}:{} ask a vertex of body \"{}\" for different ",
                                         one.source.file, one.source.line, scene.bodies[other.body].name);
    if (one.around || other.around)
      throw Error(other.source, both +
                                    "motions: what moves about an axis moves like that in each of its holds; let them "
                                    "have no vertex in common, or the same `around`");
    throw Error(other.source, both + fmt::format("velocities along {}: {} and {} m/s at t = {:.6g} s; leave that "
                                                 "direction out (nil) of one of them",
                                                 "xyz"[c], b, a, t));
  }
}

template <int D, class Real>
void Model<D, Real>::place_holds(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device) {
  using Loaded = kernels::LoadedVertex<D, Real>;
  auto const vertices_of = vertices_of_nodes(mesh);
  std::vector<int> holder(static_cast<std::size_t>(vertices.count) * D, -1);  // the first hold, which alone moves it
  std::set<std::array<int, 3>> alike;                                         // first hold, second, direction
  for (int h = 0; h < static_cast<int>(scene.holds.size()); ++h) {
    auto const& hold = scene.holds[h];
    Loaded prototype;
    bool any = false;
    for (int c = 0; c < D; ++c)
      prototype.share[c] = hold.velocity[c] || hold.around ? Real(1) : Real(0), any = any || prototype.share[c] > 0;
    if (!any) continue;  // it concerns a direction that this dimension does not have
    std::vector<Loaded> list;
    for (int node : nodes_at(hold.where, hold.body, hold.source, mesh))
      for (Index vertex : vertices_of[node]) {
        prototype.vertex = vertex;
        list.push_back(prototype);
        if (section.axisymmetric() && section.on_axis[node]) list.back().share[0] = 0;  // it stays there anyway
        for (int c = 0; c < D; ++c) {
          if (list.back().share[c] == 0) continue;
          int& first = holder[static_cast<std::size_t>(vertex) * D + c];
          if (first < 0) first = h;
          if (first == h) continue;
          auto const& one = scene.holds[first];
          if (alike.insert({first, h, c}).second || one.around || hold.around)
            refuse_contradiction(scene, one, hold, vertex, c);
          list.back().share[c] = 0;
        }
      }
    HoldSet<D, Real> set;
    set.hold = h, set.velocity = hold.velocity, set.around = hold.around;
    set.list = Buffer<Loaded>(device, "prescribed motion", list);
    set.impulse = Buffer<Real>(device, "prescribed motion", list.size() * D);
    std::vector<Real> held(list.size() * D, 0);
    for (std::size_t k = 0; k < list.size() && !vertices.start.empty(); ++k)
      for (int c = 0; c < D; ++c)
        held[k * D + c] = static_cast<Real>(vertices.start[static_cast<std::size_t>(list[k].vertex) * D + c]);
    set.held = Buffer<Real>(device, "prescribed motion", held);
    std::vector<double> place;
    for (std::size_t k = 0; k < list.size() && hold.around; ++k)
      for (int c = 0; c < D; ++c)
        place.push_back(drawn_at(list[k].vertex)[c] - static_cast<double>(held[k * D + c]) - hold.around->through[c]);
    set.place = Buffer<double>(device, "prescribed motion", place);
    holds.push_back(std::move(set));
  }
}

[[noreturn]] inline void refuse_part_of_rigid(scene::Scene const& scene, int body) {
  auto const& hold =
      *std::find_if(scene.holds.begin(), scene.holds.end(), [&](scene::Hold const& one) { return one.body == body; });
  throw Error(hold.source,
              fmt::format("hold: body \"{}\" is rigid, and this moves a part of it: what is rigid is held altogether; "
                          "write at = \"all\"",
                          scene.bodies[body].name));
}

/// A hold moves a rigid body altogether along a direction, or not at all.
template <int D, class Real>
void Model<D, Real>::place_rigid(scene::Scene const& scene, Device& device) {
  std::vector<char> held(static_cast<std::size_t>(vertices.count) * D, 0);
  for (auto const& set : holds)
    for (auto const& at : set.list.download())
      for (int c = 0; c < D; ++c)
        if (at.share[c] > 0) held[static_cast<std::size_t>(at.vertex) * D + c] = 1;
  vertices.inertia = vertices.mass;
  for (auto const& group : groups) {
    if (!group.rigid) continue;
    RigidBody<D, Real> body;
    body.body = group.body, body.first_element = group.first;
    while (elements.cell[body.first_element] < 0) ++body.first_element;
    std::vector<Index> list;
    for (Index e = group.first; e < group.first + group.count; ++e)
      for (int a = 0; a < C && elements.cell[e] >= 0; ++a) list.push_back(vertex_of(e, a));
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    for (int c = 0; c < D; ++c) {
      bool const radius = section.axisymmetric() && c == 0;
      auto const moved = std::count_if(
          list.begin(), list.end(), [&](Index vertex) { return held[static_cast<std::size_t>(vertex) * D + c] != 0; });
      body.held[c] = moved > 0, body.moves[c] = moved == 0 && !radius;
      if (moved > 0 && moved < static_cast<long>(list.size()) && !radius) refuse_part_of_rigid(scene, group.body);
    }
    body.turns = std::all_of(body.moves.begin(), body.moves.begin() + D, [](bool moves) { return moves; });
    if (std::none_of(body.moves.begin(), body.moves.end(), [](bool moves) { return moves; })) {
      for (Index const vertex : list) vertices.inertia[vertex] *= immovable;
      continue;
    }
    weigh_rigid(body, list, device);
    rigid.push_back(std::move(body));
  }
  if (vertices.inertia == vertices.mass) return;
  std::vector<Real> inverse(vertices.count, 0);
  for (Index i = 0; i < vertices.count; ++i)
    if (vertices.mass[i] > 0) inverse[i] = static_cast<Real>(1 / vertices.inertia[i]);
  vertices.inverse_inertia = Buffer<Real>(device, "inverse masses", inverse);
}

/// Mass, centre, arms and inertia of these vertices.
template <int D, class Real>
void Model<D, Real>::weigh_rigid(RigidBody<D, Real>& body, std::vector<Index> const& list, Device& device) const {
  auto const at_rest = [this](Index vertex) {
    Vec3 place = Vec3::Zero();
    place.head<D>() = reference_of(vertex);
    return place;
  };
  Vec3 center = Vec3::Zero();
  for (Index const vertex : list) body.mass += vertices.mass[vertex], center += vertices.mass[vertex] * at_rest(vertex);
  center /= body.mass;
  std::vector<double> arms;
  body.inertia.setZero();
  for (Index const vertex : list) {
    Vec3 const arm = at_rest(vertex) - center;
    arms.insert(arms.end(), arm.data(), arm.data() + D);
    body.inertia += vertices.mass[vertex] * (arm.squaredNorm() * Mat<double, 3>::Identity() - arm * arm.transpose());
  }
  body.list = Buffer<Index>(device, "rigid bodies", list);
  body.arm = Buffer<double>(device, "rigid bodies", arms);
}

/// visit(face, i, element, its corner, share) for corner i of each of these faces; the shares of a face are D in all.
template <int D, class Real>
template <class Visit>
void Model<D, Real>::each_face_corner(mesh::Mesh const& mesh, int body, std::vector<int> const& faces,
                                      Visit&& visit) const {
  for (int const number : faces) {
    auto const& face = mesh.boundary[number];
    Index const e = elements.of_cell[face.cell];
    std::array<int, D> nodes;
    std::copy_n(face.node.begin(), D, nodes.begin());
    auto const shares = corner_shares(mesh, body, face.cell, nodes);
    for (int i = 0; i < D; ++i) visit(face, i, e, corner_at(e, mesh.place(face.node[i])), shares[i]);
  }
}

/// visit(vertex, node, outward area [m^(D-1) times m out of the plane]) for each corner of faces, at rest.
template <int D, class Real>
template <class Visit>
void Model<D, Real>::each_corner_area(mesh::Mesh const& mesh, int body, std::vector<int> const& faces,
                                      Visit&& visit) const {
  each_face_corner(mesh, body, faces, [&](mesh::Face const& face, int i, Index e, Index a, double share) {
    Vec<double, D> corner[D];
    for (int k = 0; k < D; ++k)
      for (int c = 0; c < D; ++c) corner[k][c] = mesh.nodes[face.node[k]][c];
    Vec<double, D> const normal = Dim<D>::face_normal(corner) / D;
    visit(vertex_of(e, a), face.node[i], Vec<double, D>(normal * face_reach(corner)[i] * share));
  });
}

/// What a pressure that follows the surface needs to know.
template <int D, class Real>
LoadSet<D, Real> Model<D, Real>::followed(scene::Pressure const& pressure, mesh::Mesh const& mesh,
                                          Device& device) const {
  std::map<Index, std::vector<kernels::PressedCorner<D>>> of_vertex;
  auto const faces = faces_at(pressure.where, pressure.body, pressure.source, mesh);
  each_face_corner(mesh, pressure.body, faces, [&](mesh::Face const& face, int i, Index e, Index a, double share) {
    kernels::PressedCorner<D> at{e, {}, static_cast<std::int8_t>(i), share};
    for (int k = 0; k < D; ++k) at.corner[k] = static_cast<std::int8_t>(corner_at(e, mesh.place(face.node[k])));
    of_vertex[vertex_of(e, a)].push_back(at);
  });
  std::vector<kernels::LoadedVertex<D, Real>> list;
  std::vector<Index> first{0};
  std::vector<kernels::PressedCorner<D>> corners;
  for (auto const& [vertex, its] : of_vertex) {
    list.push_back({vertex});
    corners.insert(corners.end(), its.begin(), its.end());
    first.push_back(static_cast<Index>(corners.size()));
  }
  LoadSet<D, Real> set;
  set.value.fill(pressure.value);
  set.list = Buffer<kernels::LoadedVertex<D, Real>>(device, "loads", list);
  set.first = Buffer<Index>(device, "loads", first);
  set.corner = Buffer<kernels::PressedCorner<D>>(device, "loads", corners);
  return set;
}

/// Each vertex's part of the area [m^2] of the faces that a load acts on: in every direction alike, or `inward`.
template <int D, class Real>
std::vector<kernels::LoadedVertex<D, Real>> Model<D, Real>::loaded_vertices(mesh::Mesh const& mesh, int body,
                                                                            std::vector<int> const& faces,
                                                                            bool inward) const {
  std::map<Index, Vec<double, D>> shares;
  each_corner_area(mesh, body, faces, [&](Index vertex, int, Vec<double, D> const& outward) {
    auto& share = shares.emplace(vertex, Vec<double, D>::Zero()).first->second;
    for (int c = 0; c < D; ++c) share[c] += inward ? -outward[c] : outward.norm();
  });
  std::vector<kernels::LoadedVertex<D, Real>> list;
  for (auto const& [vertex, share] : shares) {
    auto& entry = list.emplace_back();
    entry.vertex = vertex;
    for (int c = 0; c < D; ++c) entry.share[c] = static_cast<Real>(share[c]);
  }
  return list;
}

/// Shares of a force, 1 together: by the area of faces, or those of the vertex nearest to a point (where bodies can
/// crack there are several, which share it by mass).
template <int D, class Real>
std::vector<kernels::LoadedVertex<D, Real>> Model<D, Real>::pushed_vertices(scene::Force const& force,
                                                                            mesh::Mesh const& mesh) const {
  if (!force.point) {
    auto list = loaded_vertices(mesh, force.body, faces_at(force.where, force.body, force.source, mesh), false);
    double whole = 0;
    for (auto const& entry : list) whole += static_cast<double>(entry.share[0]);
    if (!(whole > 0))
      throw Error(force.source, "the force acts on no area (faces on the axis of revolution have none)");
    for (auto& entry : list)
      for (Real& share : entry.share) share /= static_cast<Real>(whole);
    return list;
  }
  auto const off = [&](int n) {
    Vec<double, D> away;
    for (int c = 0; c < D; ++c) away[c] = mesh.nodes[n][c] - (*force.point)[c];
    return away.norm();
  };
  int nearest = mesh.body_first_node[force.body];
  for (int n = nearest; n < mesh.body_first_node[force.body + 1]; ++n)
    if (off(n) < off(nearest)) nearest = n;
  double longest = 0;  // a point inside a cell is never farther from a corner than 0.62 of its longest edge
  for (Index e = groups[force.body].first; e < groups[force.body].first + groups[force.body].count; ++e)
    for (int a = 0; a < C && elements.cell[e] >= 0; ++a)
      for (int b = 0; b < a; ++b)
        longest = std::max(longest, (reference_of(vertex_of(e, a)) - reference_of(vertex_of(e, b))).norm());
  if (off(nearest) > 0.62 * longest)
    throw Error(force.source,
                fmt::format("the point lies outside the body: its nearest vertex is {:.3g} m away (edges are "
                            "at most {:.3g} m)",
                            off(nearest), longest));
  auto const at_node = vertices_of_nodes(mesh)[nearest];
  double whole = 0;
  for (Index const vertex : at_node) whole += vertices.mass[vertex];
  std::vector<kernels::LoadedVertex<D, Real>> list;
  for (Index const vertex : at_node) {
    auto& entry = list.emplace_back();
    entry.vertex = vertex;
    for (Real& share : entry.share) share = static_cast<Real>(vertices.mass[vertex] / whole);
  }
  return list;
}

/// An end hangs on the corners of the cell that its point lies in, by their shares of a linear function there.
template <int D, class Real>
void Model<D, Real>::place_springs(scene::Scene const& scene) {
  for (auto const& spring : scene.springs) {
    auto& set = springs.emplace_back();
    for (int which : {0, 1}) {
      set.place[which] = (spring.at[which] - origin).template head<D>();
      if (spring.bodies[which] >= 0) hang(scene, spring, which, set);
    }
  }
}

template <int D, class Real>
void Model<D, Real>::hang(scene::Scene const& scene, scene::Spring const& spring, int which,
                          SpringSet<D, Real>& set) const {
  auto const& group = groups[spring.bodies[which]];
  Vec<double, D> const point = set.place[which];
  double most = -INFINITY;
  Index cell = -1;
  Vec<double, C> shares = Vec<double, C>::Zero();
  for (Index e = group.first; e < group.first + group.count; ++e) {
    if (elements.cell[e] < 0) continue;
    Mat<double, D> edges;
    for (int a = 0; a < D; ++a) edges.col(a) = reference_of(vertex_of(e, a + 1)) - reference_of(vertex_of(e, 0));
    Vec<double, C> inside;
    inside.template tail<D>() = edges.inverse() * (point - reference_of(vertex_of(e, 0)));
    inside[0] = 1 - inside.template tail<D>().sum();
    if (inside.minCoeff() > most) most = inside.minCoeff(), cell = e, shares = inside;
  }
  // Round surfaces lie a little inside of what was drawn; a point beyond is moved to the cell.
  shares = shares.cwiseMax(0);
  shares /= shares.sum();
  double longest = 0;
  set.place[which].setZero();
  for (int a = 0; a < C; ++a) {
    auto const x = reference_of(vertex_of(cell, a));
    set.place[which] += shares[a] * x;
    for (int b = 0; b < a; ++b) longest = std::max(longest, (x - reference_of(vertex_of(cell, b))).norm());
    if (!(shares[a] > 1e-12)) continue;
    auto& entry = set.ends[which].emplace_back();
    entry.vertex = vertex_of(cell, a);
    for (Real& share : entry.share) share = static_cast<Real>(shares[a]);
  }
  double const off = (set.place[which] - point).norm();
  if (off > 0.1 * longest)
    throw Error(spring.source,
                fmt::format("spring \"{}\": `{}` lies outside body \"{}\", {:.3g} m from its surface", spring.name,
                            which == 0 ? "from" : "to", scene.bodies[spring.bodies[which]].name, off));
}

template <int D, class Real>
void Model<D, Real>::place_ties(scene::Scene const& scene, mesh::Mesh const& mesh) {
  if (mesh.hung.empty()) return;
  auto const vertices_of = vertices_of_nodes(mesh);
  for (auto const& node : mesh.hung) {
    HungVertex<D> one;
    one.tie = node.tie, one.element = elements.of_cell[node.cell];
    one.of_second = elements.body[one.element] == scene.ties[node.tie].bodies[0];
    for (int a = 0; a < C; ++a) {
      int const place = mesh.place(mesh.cells[static_cast<std::size_t>(node.cell) * C + a]);
      one.on[a] = vertex_of(one.element, corner_at(one.element, place));
      one.share[a] = mesh::carries(node, a) ? node.share[a] : 0;
    }
    for (Index const vertex : vertices_of[node.node]) {
      one.vertex = vertex;
      hung.push_back(one);
    }
  }
  find_beside_ties();
}

template <int D, class Real>
void Model<D, Real>::find_beside_ties() {
  std::multimap<Index, Index> carrier;  // of a vertex: elements
  for (auto const& one : hung) carrier.emplace(one.vertex, one.element);
  beside_tie.clear();
  for (Index e = 0; e < elements.count; ++e)
    for (int a = 0; a < C && elements.cell[e] >= 0; ++a) {
      auto const [from, to] = carrier.equal_range(vertex_of(e, a));
      for (auto one = from; one != to; ++one)
        for (int b = 0; b < C; ++b)
          beside_tie.push_back({e, elements.node[static_cast<std::size_t>(one->second) * C + b]});
    }
  std::sort(beside_tie.begin(), beside_tie.end());
  beside_tie.erase(std::unique(beside_tie.begin(), beside_tie.end()), beside_tie.end());
}

template <int D, class Real>
void Model<D, Real>::drop_ties() {
  auto const lost = std::erase_if(hung, [this](HungVertex<D> const& one) {
    return removed(one.element) || !(vertices.inverse_mass.download_one(one.vertex) > 0);
  });
  if (lost > 0) find_beside_ties();
}

/// A body force at each vertex's place times the volume that hangs on it [N].
template <int D, class Real>
std::vector<kernels::LoadedVertex<D, Real>> Model<D, Real>::volumes_times(scene::BodyForce const& force,
                                                                          scene::Scene const& scene) const {
  double const density = scene.materials[scene.bodies[force.body].material].density * scene.run.mass_scaling;
  std::vector<char> seen(vertices.count, 0);
  std::vector<kernels::LoadedVertex<D, Real>> list;
  auto const& group = groups[force.body];
  for (Index e = group.first; e < group.first + group.count; ++e)
    for (int a = 0; a < C && elements.cell[e] >= 0; ++a) {
      Index const vertex = vertex_of(e, a);
      if (seen[vertex]++) continue;
      Vec3 const x = drawn_at(vertex);
      auto const value = force.value_at ? force.value_at(x[0], x[1], x[2]) : force.value;
      auto& entry = list.emplace_back();
      entry.vertex = vertex;
      for (int c = 0; c < D; ++c) entry.share[c] = static_cast<Real>(value[c] * vertices.mass[vertex] / density);
    }
  return list;
}

template <int D, class Real>
void Model<D, Real>::place_loads(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device) {
  using Loaded = kernels::LoadedVertex<D, Real>;
  auto const add = [&](scene::Directions const& value, std::vector<Loaded> const& list) {
    loads.push_back({value, Buffer<Loaded>(device, "loads", list), {}, {}});
  };
  auto const alike = [](scene::TimeFunction const& value) {
    scene::Directions directions;
    directions.fill(value);
    return directions;
  };
  auto const faces = [&](auto const& load) { return faces_at(load.where, load.body, load.source, mesh); };
  for (auto const& traction : scene.tractions)
    add(traction.value, loaded_vertices(mesh, traction.body, faces(traction), false));
  for (auto const& pressure : scene.pressures)
    if (pressure.follows)
      loads.push_back(followed(pressure, mesh, device));
    else
      add(alike(pressure.value), loaded_vertices(mesh, pressure.body, faces(pressure), true));
  for (auto const& force : scene.forces) add(force.value, pushed_vertices(force, mesh));
  for (auto const& force : scene.body_forces) add(alike(force.times), volumes_times(force, scene));
}

/// Dashpots that let waves pass as the body would if it went on (Lysmer & Kuhlemeyer 1969): of the area A with the
/// normal n, rho A (c_p n n' + c_s (1 - n n')). What hangs on a node is shared by its vertices by mass, so that those
/// that are tied stay together.
template <int D, class Real>
void Model<D, Real>::place_absorbers(scene::Scene const& scene, mesh::Mesh const& mesh, Device& device) {
  std::map<int, Mat<double, D>> of_node;
  std::set<int> taken;  // a face absorbs once, however often it is named
  for (auto const& absorb : scene.absorbers) {
    auto const& material = scene.materials[scene.bodies[absorb.body].material];
    auto const& elastic = material.elastic();
    double const density = material.density * scene.run.mass_scaling,
                 stiffness = section.plane_stress() ? elastic.young / (1 - elastic.poisson * elastic.poisson)
                                                    : elastic.confined(),
                 shear = elastic.young / (2 * (1 + elastic.poisson));
    double const pressing = std::sqrt(density * stiffness), shearing = std::sqrt(density * shear);  // rho c
    std::vector<int> faces;
    for (int const face : faces_at(absorb.where, absorb.body, absorb.source, mesh))
      if (taken.insert(face).second) faces.push_back(face);
    each_corner_area(mesh, absorb.body, faces, [&](Index, int node, Vec<double, D> const& outward) {
      double const area = outward.norm();
      if (!(area > 0)) return;  // on the axis of revolution
      Vec<double, D> const n = outward / area;
      auto& impedance = of_node.emplace(node, Mat<double, D>::Zero()).first->second;
      impedance += area * (shearing * Mat<double, D>::Identity() + (pressing - shearing) * n * n.transpose());
    });
  }
  auto const vertices_of = vertices_of_nodes(mesh);
  std::vector<kernels::AbsorbingVertex<D, Real>> list;
  for (auto const& [node, impedance] : of_node) {
    double whole = 0;
    for (Index const vertex : vertices_of[node]) whole += vertices.mass[vertex];
    for (Index const vertex : vertices_of[node]) {
      auto& entry = list.emplace_back();
      entry.vertex = vertex;
      for (int i = 0; i < D * D; ++i) entry.impedance[i] = impedance(i / D, i % D) * vertices.mass[vertex] / whole;
    }
  }
  absorbing.impulse = Buffer<Real>(device, "absorbing boundary", list.size() * D);
  absorbing.list = Buffer<kernels::AbsorbingVertex<D, Real>>(device, "absorbing boundary", list);
}

}  // namespace fissure::model
