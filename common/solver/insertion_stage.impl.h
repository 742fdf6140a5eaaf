// Instantiated by src2d and src3d.
#pragma once
#include <algorithm>
#include <numeric>

#include "backend/team.h"
#include "base/expect.h"
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
      for (int i = 0; i < set.face_points; ++i) waiting_[node_of_vertex_[set.face_vertex(cell, a, i)]].clear();
    }
  });
}

template <int D, class Real>
void InsertionStage<D, Real>::tie_forces(bool looks) {
  if (looks && !waiting_.empty()) {
    std::vector<Real> u_copy, force_copy;
    auto const u = model_.vertices.u.look(u_copy), force = model_.vertices.force.look(force_copy);
    struct Waiting {
      Index node;
      Seams* seams;
      std::vector<Cut const*> parts;  // of each seam; null: it holds
    };
    std::vector<Waiting> nodes;
    for (auto& [node, seams] : waiting_) nodes.push_back({node, &seams, {}});
    bool const alone = device_.backend() == Backend::cuda;  // its copies are one thread's
    cpu::Team::get().run(alone || nodes.size() < 8 ? 1 : device_.threads(), static_cast<Index>(nodes.size()),
                         [&](Index from, Index to) {
                           for (Index i = from; i < to; ++i) {
                             auto& [node, seams, parts] = nodes[i];
                             if (seams->empty()) *seams = survey(node);
                             for (auto& seam : *seams) parts.push_back(look(seam, u, force));
                           }
                         });
    for (auto const& [node, seams, parts] : nodes) {
      if (seams->empty()) {
        waiting_.erase(node);
        continue;
      }
      bool parted = false;
      for (std::size_t k = 0; k < parts.size(); ++k)
        if (parts[k]) part((*seams)[k], *parts[k], u, force), parted = true;
      if (parted) seams->clear();
    }
  }
  for_each(device_, 0, static_cast<Index>(host_first_.size()) - 1,
           kernels::TieForces<D, Real>{ties(), share_.data(), model_.vertex_force()});
}

/// The groups of a node that are in pieces: those that no whole face holds, and what lies beyond the plane of a face.
template <int D, class Real>
typename InsertionStage<D, Real>::Seams InsertionStage<D, Real>::survey(Index node) const {
  Seams seams;
  for (Index begin = host_first_[node], end; begin < host_first_[node + 1]; begin = end) {
    for (end = begin + 1; end < host_first_[node + 1] && !host_starts_[end];) ++end;
    auto const piece_of = pieces(begin, end, node);
    if (std::count(piece_of.begin(), piece_of.end(), 0) == end - begin) continue;
    Seam seam{begin, end, joints_within(begin, end, node), {}};
    auto const consider = [&](auto&& is_inside) {
      Cut cut;
      for (Index i = 0; i < end - begin; ++i) cut.inside.push_back(is_inside(i));
      bool const known =
          std::any_of(seam.cuts.begin(), seam.cuts.end(), [&](Cut const& other) { return other.inside == cut.inside; });
      if (!known && measure(cut, seam.joints)) seam.cuts.push_back(std::move(cut));
    };
    for (Index piece = 0; piece < end - begin; ++piece)
      if (piece_of[piece] == piece) consider([&](Index i) { return piece_of[i] == piece; });
    for (auto const& joint : seam.joints)
      if (!joint.whole && joint.mine < joint.theirs)
        consider([&](Index i) { return inward_[host_vertex_[begin + i]].dot(joint.normal_at_rest) > 0; });
    seams.push_back(std::move(seam));
  }
  return seams;
}

/// The points of joints between vertices of a group, from both sides.
template <int D, class Real>
std::vector<typename InsertionStage<D, Real>::Joint> InsertionStage<D, Real>::joints_within(Index begin, Index end,
                                                                                            Index node) const {
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
        joint.weakness = static_cast<double>(frame.weakness);
      });
    }
    joints.push_back(joint);
  }
  return joints;
}

/// Area of a cut, and a pull below which it is not worth weighing: how far tractions are on the way to a peak is a norm
/// of them, so at most what it is of both parts, each at its largest; and across a tension, which is at most 60 degrees
/// askew (kernels/rankine.h), the joints hold half of their tension at least. False where it parts what is whole or
/// nothing at all.
template <int D, class Real>
bool InsertionStage<D, Real>::measure(Cut& cut, std::vector<Joint> const& joints) const {
  if (std::count(cut.inside.begin(), cut.inside.end(), cut.inside[0]) == static_cast<long>(cut.inside.size()))
    return false;
  for (auto const& joint : joints) {
    if (cut.inside[joint.mine] == cut.inside[joint.theirs]) continue;
    if (joint.whole) return false;
    if (!cut.inside[joint.mine]) continue;
    cut.area += joint.area;
    std::visit(
        [&](auto const& law) {
          double const peak = std::hypot(law.reach(1, 0), law.reach(0, 1)), torn = 2 / law.tension;
          cut.weakest = std::max(cut.weakest, joint.weakness * std::max(peak, torn));
        },
        law_of(joint));
  }
  if (cut.area > 0) cut.weakest *= 1.01 / cut.area;
  return true;
}

/// How a seam parts in two: where what the tie carries between both, m a - f of one, reaches the strength of the joints
/// there; null: it holds. What meets at an edge or a node alone parts at once.
template <int D, class Real>
typename InsertionStage<D, Real>::Cut const* InsertionStage<D, Real>::look(Seam& seam, std::span<Real const> u,
                                                                           std::span<Real const> force) const {
  auto const& [begin, end, joints, _] = seam;
  double mass = 0;
  Vec<double, D> total = Vec<double, D>::Zero();
  auto const own = [&](Index k) {
    Vec<double, D> f;
    for (int c = 0; c < D; ++c) f[c] = static_cast<double>(force[static_cast<std::size_t>(host_vertex_[k]) * D + c]);
    return f;
  };
  for (Index k = begin; k < end; ++k) total += own(k), mass += model_.vertices.mass[host_vertex_[k]];
  Cut const* best = nullptr;
  bool placed = false;
  for (auto& cut : seam.cuts) {
    cut.pull.setZero();
    double share = 0;
    for (Index k = begin; k < end; ++k)
      if (cut.inside[k - begin]) cut.pull -= own(k), share += model_.vertices.mass[host_vertex_[k]] / mass;
    cut.pull += share * total;
    if (!(cut.area > 0)) {
      cut.reach = std::numeric_limits<double>::infinity();
    } else {
      if (!(cut.pull.norm() * cut.weakest >= 1)) continue;
      if (!placed) place(seam.joints, u), placed = true;
      weigh(cut, joints);
    }
    if (cut.reach >= 1 && (!best || cut.reach > best->reach)) best = &cut;
  }
  return best;
}

/// Where the joints lie now.
template <int D, class Real>
void InsertionStage<D, Real>::place(std::vector<Joint>& joints, std::span<Real const> u) const {
  for (auto& joint : joints) {
    if (joint.whole) continue;
    auto const& point = *joint.point;
    with_frame(point, u, [&](auto const& set, Index cell, Frame const& frame) {
      auto const& arrays = set.of(model_.interfaces);
      joint.normal = frame.normal.template cast<double>();
      if (arrays.tension.empty()) return;
      auto const number = [&](int c) {
        return static_cast<double>(value(arrays.tension, blocked(cell, point.face * D + c, set.faces * D)));
      };
      joint.cosine = std::max(number(0), 0.0);
      joint.way = joint.cosine * joint.normal;
      for (int c = 1; c < D; ++c) joint.way += number(c) * frame.axes.in_face[c - 1].template cast<double>();
    });
  }
}

/// How far the pull of a cut is on the way to the peak of the joints that it parts, or along the tension that opens
/// them, by their areas.
template <int D, class Real>
void InsertionStage<D, Real>::weigh(Cut& cut, std::vector<Joint> const& joints) const {
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
        law_of(joint));
  }
  cut.reach = std::max(reach, torn > 0 ? along / torn : 0);
  FISSURE_EXPECT(cut.reach <= cut.pull.norm() * cut.weakest);  // or measure() let something hold that would part
}

/// What the tie has carried goes on as the traction of the joints between both parts, in this step as a force.
template <int D, class Real>
void InsertionStage<D, Real>::part(Seam const& seam, Cut const& by, std::span<Real const> u,
                                   std::span<Real const> force) {
  auto const& [begin, end, joints, _] = seam;
  for (auto const& joint : joints)
    if (by.inside[joint.mine] != by.inside[joint.theirs])
      load(*joint.point, (by.inside[joint.mine] ? 1 : -1) / by.area * by.pull, u);
  Index const cut = gather(begin, end, by.inside);
  for (int c = 0; c < D && by.area > 0; ++c) {
    std::size_t const mine = static_cast<std::size_t>(host_vertex_[begin]) * D + c,
                      theirs = static_cast<std::size_t>(host_vertex_[cut]) * D + c;
    model_.vertices.force.upload_one(mine, force[mine] + static_cast<Real>(by.pull[c]));
    model_.vertices.force.upload_one(theirs, force[theirs] - static_cast<Real>(by.pull[c]));
  }
  for (Index k = begin; k < end; ++k) vertex_.upload_one(k, host_vertex_[k]);
  host_starts_[cut] = 1;
  starts_.upload_one(cut, 1);
  set_shares(begin, end);
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
  std::vector<Index> nodes;
  for (auto const& [node, _] : waiting_) nodes.push_back(node);
  state["waiting nodes"] = state_bytes(nodes);
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
  waiting_.clear();
  for (Index const node : waiting) waiting_[node];
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
