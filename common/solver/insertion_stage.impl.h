// Instantiated by src2d and src3d.
#pragma once
#include <algorithm>
#include <map>
#include <numeric>

#include "backend/team.h"
#include "solver/insertion_stage.h"

namespace fissure {

using kernels::blocked;

template <int D, class Real>
InsertionStage<D, Real>::InsertionStage(Device& device, scene::Scene const& scene, Model& model)
    : device_(device), scene_(scene), model_(model) {
  if (!model.plan.insertion) return;
  model.each_set([&](auto const& set) {
    whole_[set.kind] = set.of(model.interfaces).whole.download();
    found_[set.kind] = Buffer<Index>(device, "insertion", whole_[set.kind].size());
  });
  list_points();
  starts_ = Buffer<std::uint8_t>(device, "ties", host_starts_);
  first_ = Buffer<Index>(device, "ties", host_first_);
  share_ = Buffer<Real>(device, "ties", host_vertex_.size());
  set_shares(0, static_cast<Index>(host_vertex_.size()));
  vertex_ = Buffer<Index>(device, "ties", host_vertex_);
  count_ = Buffer<int>(device, "insertion", 2);
}

/// Nodes of bodies that are whole, their vertices in groups that hang together, and the points of joints about them.
template <int D, class Real>
void InsertionStage<D, Real>::list_points() {
  std::map<int, std::vector<Index>> vertices_at;  // by mesh node
  node_of_vertex_.assign(model_.vertices.count, -1);
  inward_.assign(model_.vertices.count, Vec<double, D>::Zero());
  std::vector<char> known(model_.vertices.count, 0);
  for (auto const& group : model_.groups)
    for (Index e = group.first; group.inserted && e < group.first + group.count; ++e)
      for (int a = 0; a < C && model_.elements.cell[e] >= 0; ++a) {
        Index const vertex = model_.vertex_of(e, a);
        if (known[vertex]) continue;
        known[vertex] = 1;
        inward_[vertex] = inward(model_.cell_head(e), vertex);
        vertices_at[model_.elements.node[static_cast<std::size_t>(e) * C + a]].push_back(vertex);
      }
  host_first_.push_back(0);
  for (auto& [node, vertices] : vertices_at) {
    std::sort(vertices.begin(), vertices.end());
    for (Index const vertex : vertices) node_of_vertex_[vertex] = static_cast<Index>(host_first_.size()) - 1;
    host_vertex_.insert(host_vertex_.end(), vertices.begin(), vertices.end());
    host_first_.push_back(static_cast<Index>(host_vertex_.size()));
  }
  for (auto const& group : model_.groups)
    model_.each_set([&](auto const& set) {
      auto const& cells = set.range(group);
      for (Index cell = cells.first; group.inserted && cell < cells.first + cells.count; ++cell)
        for (int a = 0; a < set.faces; ++a)
          for (int i = 0; i < set.face_points && !set.parts(cell, a).empty(); ++i) {
            Index const mine = set.face_vertex(cell, a, i), theirs = set.across(cell, a, i);
            if (mine != theirs && known[theirs])
              points_.push_back({group.body, node_of_vertex_[mine], mine, theirs, set.element(cell), a, i});
          }
    });
  std::stable_sort(points_.begin(), points_.end(),
                   [](Point const& one, Point const& other) { return one.node < other.node; });
  auto const nodes = static_cast<Index>(vertices_at.size());
  first_point_.assign(nodes + 1, 0);
  for (auto const& point : points_) ++first_point_[point.node + 1];
  std::partial_sum(first_point_.begin(), first_point_.end(), first_point_.begin());
  host_starts_.assign(host_vertex_.size(), 0);
  for (Index node = 0; node < nodes; ++node) {
    Index const begin = host_first_[node], end = host_first_[node + 1];
    for (Index at = begin; at < end;) {
      auto const piece_of = pieces(at, end, node);
      std::vector<char> first;
      for (Index const piece : piece_of) first.push_back(piece == 0);
      host_starts_[at] = 1;
      at = gather(at, end, first);
    }
  }
}

/// From a corner of a cell to the mean of its corners, at rest [m].
template <int D, class Real>
Vec<double, D> InsertionStage<D, Real>::inward(Index head, Index vertex) const {
  auto const corners = model_.cell_vertices(head);
  Vec<double, D> way = Vec<double, D>::Zero();
  for (Index const corner : corners)
    for (int c = 0; c < D; ++c)
      way[c] += (model_.vertices.reference[corner][c] - model_.vertices.reference[vertex][c]) /
                static_cast<double>(corners.size());
  return way;
}

template <int D, class Real>
bool InsertionStage<D, Real>::whole(Point const& point) const {
  return model_.in_set(point.element, [&](auto const& set, Index cell) {
    return whole_[set.kind][blocked(cell, point.face, set.faces)] != 0;
  });
}

/// Which piece each vertex of a group belongs to, named after its first one: they hang together by whole faces.
template <int D, class Real>
std::vector<Index> InsertionStage<D, Real>::pieces(Index begin, Index end, Index node) const {
  std::vector<Index> root(end - begin);
  std::iota(root.begin(), root.end(), 0);
  auto const find = [&](Index i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  auto const place = [&](Index vertex) {
    return static_cast<Index>(std::find(&host_vertex_[begin], &host_vertex_[begin] + (end - begin), vertex) -
                              &host_vertex_[begin]);
  };
  for (std::size_t k = first_point_[node]; k < first_point_[node + 1]; ++k) {
    if (!whole(points_[k])) continue;
    Index const one = place(points_[k].mine), other = place(points_[k].theirs);
    if (one == end - begin || other == end - begin) continue;
    Index const low = std::min(find(one), find(other)), high = std::max(find(one), find(other));
    root[high] = low;
  }
  std::vector<Index> piece_of(root.size());
  for (Index i = 0; i < end - begin; ++i) piece_of[i] = find(i);
  return piece_of;
}

/// Puts the vertices inside in front of the others of their group, each in the order they had; where the others begin.
template <int D, class Real>
Index InsertionStage<D, Real>::gather(Index begin, Index end, std::vector<char> const& inside) {
  std::vector<Index> ordered;
  for (char const side : {1, 0})
    for (Index i = 0; i < end - begin; ++i)
      if (inside[i] == side) ordered.push_back(host_vertex_[begin + i]);
  std::copy(ordered.begin(), ordered.end(), host_vertex_.begin() + begin);
  return begin + static_cast<Index>(std::count(inside.begin(), inside.end(), 1));
}

/// Of each vertex in the mass of its group; begin and end lie between groups.
template <int D, class Real>
void InsertionStage<D, Real>::set_shares(Index begin, Index end) {
  for (Index from = begin, to; from < end; from = to) {
    double mass = 0;
    for (to = from; to < end && (to == from || !host_starts_[to]); ++to) mass += model_.vertices.mass[host_vertex_[to]];
    for (Index k = from; k < to; ++k)
      share_.upload_one(k, static_cast<Real>(model_.vertices.mass[host_vertex_[k]] / mass));
  }
}

template <int D, class Real>
void InsertionStage<D, Real>::tie_motion() {
  for_each(device_, 0, static_cast<Index>(host_first_.size()) - 1,
           kernels::TieMotion<D, Real>{ties(), model_.vertices.u.data(), model_.vertices.v.data()});
}

template <int D, class Real>
FacesFound InsertionStage<D, Real>::found() {
  return {{count_.data(), found_[0].data(), 0}, {count_.data() + 1, found_[1].data(), 0}};
}

/// Faces tell in no order, and each side for itself; what is kept of it has no order.
template <int D, class Real>
void InsertionStage<D, Real>::hear() {
  auto const count = count_.download();
  if (count[0] + count[1] == 0) return;
  count_.upload({0, 0});
  model_.each_set([&](auto const& set) {
    for (Index const side : found_[set.kind].download_first(static_cast<std::size_t>(count[set.kind]))) {
      Index const cell = side / set.faces, a = side % set.faces;
      whole_[set.kind][blocked(cell, a, set.faces)] = 0;
      for (int i = 0; i < set.face_points; ++i) waiting_.insert(node_of_vertex_[set.face_vertex(cell, a, i)]);
    }
  });
}

template <int D, class Real>
void InsertionStage<D, Real>::tie_forces(bool looks) {
  if (looks && !waiting_.empty()) {
    std::vector<Real> u_copy, force_copy;
    auto const u = model_.vertices.u.look(u_copy), force = model_.vertices.force.look(force_copy);
    std::vector<Parting> found(waiting_.size());
    std::vector<Index> const nodes(waiting_.begin(), waiting_.end());
    bool const alone = device_.backend() == Backend::cuda;  // its copies are one thread's
    cpu::Team::get().run(alone || nodes.size() < 8 ? 1 : device_.threads(), static_cast<Index>(nodes.size()),
                         [&](Index from, Index to) {
                           for (Index i = from; i < to; ++i) found[i] = look(nodes[i], u, force);
                         });
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (auto const& group : found[i].groups) part(group, u, force);
      if (!found[i].waits) waiting_.erase(nodes[i]);
    }
  }
  for_each(device_, 0, static_cast<Index>(host_first_.size()) - 1,
           kernels::TieForces<D, Real>{ties(), share_.data(), model_.vertex_force()});
}

/// Where each group of a node parts in two: where what the tie carries between both, m a - f of one, reaches the
/// strength of the joints there.
template <int D, class Real>
typename InsertionStage<D, Real>::Parting InsertionStage<D, Real>::look(Index node, std::span<Real const> u,
                                                                        std::span<Real const> force) const {
  Parting parting;
  for (Index begin = host_first_[node], end; begin < host_first_[node + 1]; begin = end) {
    for (end = begin + 1; end < host_first_[node + 1] && !host_starts_[end];) ++end;
    auto const piece_of = pieces(begin, end, node);
    if (std::count(piece_of.begin(), piece_of.end(), 0) == end - begin) continue;
    parting.waits = true;
    double mass = 0;
    Vec<double, D> total = Vec<double, D>::Zero();
    std::vector<Vec<double, D>> own(end - begin);
    for (Index k = begin; k < end; ++k) {
      for (int c = 0; c < D; ++c)
        own[k - begin][c] = static_cast<double>(force[static_cast<std::size_t>(host_vertex_[k]) * D + c]);
      total += own[k - begin];
      mass += model_.vertices.mass[host_vertex_[k]];
    }
    auto joints = joints_within(begin, end, node, u);
    Cut best;
    auto const consider = [&](auto&& is_inside) {
      Cut cut;
      double share = 0;
      for (Index k = begin; k < end; ++k) {
        cut.inside.push_back(is_inside(k - begin));
        if (cut.inside.back()) cut.pull -= own[k - begin], share += model_.vertices.mass[host_vertex_[k]] / mass;
      }
      cut.pull += share * total;
      if (weigh(cut, joints) && cut.reach > best.reach) best = cut;
    };
    // Pieces that no whole face holds, and what lies beyond the plane of a face.
    for (Index piece = 0; piece < end - begin; ++piece)
      if (piece_of[piece] == piece) consider([&](Index i) { return piece_of[i] == piece; });
    for (auto const& joint : joints)
      if (!joint.whole && joint.mine < joint.theirs)
        consider([&](Index i) { return inward_[host_vertex_[begin + i]].dot(joint.normal_at_rest) > 0; });
    if (best.reach >= 1) parting.groups.push_back({begin, end, std::move(best), std::move(joints)});
  }
  return parting;
}

/// What the tie has carried goes on as the traction of the joints between both parts, in this step as a force.
template <int D, class Real>
void InsertionStage<D, Real>::part(PartingGroup const& group, std::span<Real const> u, std::span<Real const> force) {
  auto const& [begin, end, best, joints] = group;
  for (auto const& joint : joints)
    if (best.inside[joint.mine] != best.inside[joint.theirs])
      load(*joint.point, (best.inside[joint.mine] ? 1 : -1) / best.area * best.pull, u);
  Index const cut = gather(begin, end, best.inside);
  for (int c = 0; c < D && best.area > 0; ++c) {
    std::size_t const mine = static_cast<std::size_t>(host_vertex_[begin]) * D + c,
                      theirs = static_cast<std::size_t>(host_vertex_[cut]) * D + c;
    model_.vertices.force.upload_one(mine, force[mine] + static_cast<Real>(best.pull[c]));
    model_.vertices.force.upload_one(theirs, force[theirs] - static_cast<Real>(best.pull[c]));
  }
  for (Index k = begin; k < end; ++k) vertex_.upload_one(k, host_vertex_[k]);
  host_starts_[cut] = 1;
  starts_.upload_one(cut, 1);
  set_shares(begin, end);
}

/// The points of joints between vertices of a group, from both sides.
template <int D, class Real>
std::vector<typename InsertionStage<D, Real>::Joint> InsertionStage<D, Real>::joints_within(
    Index begin, Index end, Index node, std::span<Real const> u) const {
  std::vector<Joint> joints;
  auto const from = host_vertex_.begin() + begin, to = host_vertex_.begin() + end;
  for (std::size_t k = first_point_[node]; k < first_point_[node + 1]; ++k) {
    auto const& point = points_[k];
    auto const mine = std::find(from, to, point.mine), theirs = std::find(from, to, point.theirs);
    if (mine == to || theirs == to) continue;
    Joint joint{&point, static_cast<Index>(mine - from), static_cast<Index>(theirs - from), whole(point)};
    if (!joint.whole) {
      joint.area = area(point);
      with_frame(point, {}, [&](auto const&, Index, Frame const& frame) {
        joint.normal_at_rest = frame.normal.template cast<double>();
      });
      with_frame(point, u, [&](auto const& set, Index cell, Frame const& frame) {
        auto const& arrays = set.of(model_.interfaces);
        joint.normal = frame.normal.template cast<double>();
        joint.weakness = static_cast<double>(frame.weakness);
        if (arrays.tension.empty()) return;
        auto const number = [&](int c) {
          return static_cast<double>(value(arrays.tension, blocked(cell, point.face * D + c, set.faces * D)));
        };
        joint.cosine = std::max(number(0), 0.0);
        joint.way = joint.cosine * joint.normal;
        for (int c = 1; c < D; ++c) joint.way += number(c) * frame.axes.in_face[c - 1].template cast<double>();
      });
    }
    joints.push_back(joint);
  }
  return joints;
}

/// How far the pull of a cut is on the way to the peak of the joints that it parts, or along the tension that opens
/// them, by their areas; false where it parts what is whole or nothing at all. What meets at an edge or a node alone
/// parts at once.
template <int D, class Real>
bool InsertionStage<D, Real>::weigh(Cut& cut, std::vector<Joint> const& joints) const {
  if (std::count(cut.inside.begin(), cut.inside.end(), cut.inside[0]) == static_cast<long>(cut.inside.size()))
    return false;
  for (auto const& joint : joints) {
    if (cut.inside[joint.mine] == cut.inside[joint.theirs]) continue;
    if (joint.whole) return false;
    if (cut.inside[joint.mine]) cut.area += joint.area;
  }
  if (!(cut.area > 0)) return cut.reach = std::numeric_limits<double>::infinity(), true;
  double reach = 0, along = 0, torn = 0;
  for (auto const& joint : joints) {
    if (!cut.inside[joint.mine] || cut.inside[joint.theirs]) continue;
    Vec<double, D> const traction = joint.weakness / cut.area * cut.pull;
    double const normal = traction.dot(joint.normal);
    std::visit(
        [&](auto const& law) {
          reach += joint.area / cut.area * law.reach(normal, (traction - normal * joint.normal).norm());
          if (!(joint.cosine > 0)) return;
          along += joint.area * traction.dot(joint.way);
          torn += joint.area * law.tension * joint.cosine;
        },
        *scene_.materials[scene_.bodies[joint.point->body].material].joint);
  }
  cut.reach = std::max(reach, torn > 0 ? along / torn : 0);
  return true;
}

template <int D, class Real>
double InsertionStage<D, Real>::area(Point const& point) const {
  return model_.in_set(point.element, [&](auto const& set, Index cell) {
    return static_cast<double>(value(set.areas(model_.interfaces), set.area_at(cell, point.face, point.i)) *
                               set.area_share(cell, point.face, point.i));
  });
}

/// visit(set, cell, frame) for the face of a point, moved by u or at rest.
template <int D, class Real>
template <class Visit>
void InsertionStage<D, Real>::with_frame(Point const& point, std::span<Real const> u, Visit&& visit) const {
  model_.in_set(point.element, [&](auto const& set, Index cell) { visit(set, cell, frame(set, cell, point, u)); });
}

template <int D, class Real>
template <class Set>
typename InsertionStage<D, Real>::Frame InsertionStage<D, Real>::frame(Set const& set, Index cell, Point const& point,
                                                                       std::span<Real const> u) const {
  Vec<Real, D> middle[Set::face_points];
  kernels::FaceMotion<D, Set::face_points, Real> motion;
  for (int i = 0; i < Set::face_points; ++i) {
    Index const mine = set.face_vertex(cell, point.face, i), theirs = set.across(cell, point.face, i);
    for (int c = 0; c < D; ++c) {
      Real const X = static_cast<Real>(model_.vertices.reference[mine][c]);
      Real const own = u.empty() ? Real(0) : u[static_cast<std::size_t>(mine) * D + c],
                 other = u.empty() ? Real(0) : u[static_cast<std::size_t>(theirs) * D + c];
      middle[i][c] = (X + X) + (other + own);
      motion.gap[i][c] = other - own;
    }
  }
  motion.resolve(middle, set.outward(cell, point.face));
  auto const& joints = set.of(model_.interfaces);
  std::size_t const at = blocked(cell, point.face, Set::faces);
  return {motion.normal, kernels::FaceAxes<D, Real>(motion.span), value(joints.stiffness, at),
          joints.weakness.empty() ? Real(1) : value(joints.weakness, at)};
}

/// The point begins with a traction on its own side [Pa].
template <int D, class Real>
void InsertionStage<D, Real>::load(Point const& point, Vec<double, D> const& traction, std::span<Real const> u) {
  with_frame(point, u, [&](auto const& set, Index cell, Frame const& frame) {
    auto& joints = set.of(model_.interfaces);
    Index const number = (point.face * set.face_points + point.i) * D, numbers = set.faces * set.face_points * D;
    Vec<Real, D> const offset = traction.template cast<Real>() / frame.stiffness;
    for (int c = 0; c < D; ++c)
      joints.offset.upload_one(blocked(cell, number + c, numbers),
                               offset.dot(c == 0 ? frame.normal : frame.axes.in_face[c - 1]));
    joints.softening.upload_one(
        static_cast<std::size_t>(cell / kernels::layout_width) * set.faces + static_cast<std::size_t>(point.face), 1);
  });
}

template <int D, class Real>
void InsertionStage<D, Real>::save(State& state) const {
  if (!model_.plan.insertion) return;
  state["ties"] = state_bytes(host_vertex_);
  state["tie starts"] = state_bytes(host_starts_);
  state["waiting nodes"] = state_bytes(std::vector<Index>(waiting_.begin(), waiting_.end()));
}

template <int D, class Real>
void InsertionStage<D, Real>::restore(State const& state) {
  if (!model_.plan.insertion) return;
  host_vertex_ = state_values<Index>(state, "ties", host_vertex_.size());
  host_starts_ = state_values<std::uint8_t>(state, "tie starts", host_starts_.size());
  for (Index node = 0; node + 1 < static_cast<Index>(host_first_.size()); ++node)
    for (Index k = host_first_[node]; k < host_first_[node + 1]; ++k) {
      check_index("ties", host_vertex_[k], static_cast<std::size_t>(model_.vertices.count));
      if (node_of_vertex_[host_vertex_[k]] != node) throw Error("the checkpoint's ties are not those of this scene");
    }
  auto const waiting = state_values<Index>(state, "waiting nodes");
  for (Index const node : waiting) check_index("waiting nodes", node, host_first_.size() - 1);
  waiting_ = std::set<Index>(waiting.begin(), waiting.end());
  vertex_.upload(host_vertex_);
  starts_.upload(host_starts_);
  set_shares(0, static_cast<Index>(host_vertex_.size()));
  model_.each_set([&](auto const& set) { whole_[set.kind] = set.of(model_.interfaces).whole.download(); });
}

template <int D, class Real>
bool InsertionStage<D, Real>::tied(Index vertex) const {
  for (std::size_t node = 0; node + 1 < host_first_.size(); ++node)
    for (Index k = host_first_[node], end = host_first_[node + 1]; k < end; ++k)
      if (host_vertex_[k] == vertex) return !host_starts_[k] || (k + 1 < end && !host_starts_[k + 1]);
  return false;
}

}  // namespace fissure
