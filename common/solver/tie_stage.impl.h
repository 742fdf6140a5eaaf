// Instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>

#include "solver/tie_stage.h"

namespace fissure {

template <int D, class Real>
TieStage<D, Real>::TieStage(Device& device, scene::Scene const& scene, model::Model<D, Real>& model,
                            MotionStage<D, Real>& motion)
    : device_(device), scene_(scene), model_(model), motion_(motion), force_(scene.ties.size(), Vec3::Zero()) {
  if (model_.hung.empty()) return;
  list_vertices();
  find_movers();
  refuse_held();
  start();
}

template <int D, class Real>
void TieStage<D, Real>::list_vertices() {
  for (auto const& one : model_.hung) {
    list_.push_back(one.vertex);
    for (int a = 0; a <= D; ++a)
      if (one.share[a] != 0) list_.push_back(one.on[a]);
  }
  std::sort(list_.begin(), list_.end());
  list_.erase(std::unique(list_.begin(), list_.end()), list_.end());
  listed_ = Buffer<Index>(device_, "ties", list_);
  gathered_ = Buffer<double>(device_, "ties", list_.size() * Gather::size);
  found_ = Buffer<double>(device_, "ties", list_.size() * D);
}

template <int D, class Real>
void TieStage<D, Real>::find_movers() {
  mover_.assign(list_.size() * D, freely);
  auto const listed = [&](Index vertex) { return std::binary_search(list_.begin(), list_.end(), vertex); };
  for (std::size_t set = 0; set < model_.holds.size(); ++set) {
    auto const held = model_.holds[set].list.download();
    for (std::size_t k = 0; k < held.size(); ++k)
      for (int c = 0; c < D && listed(held[k].vertex); ++c) {
        if (!(held[k].share[c] > 0)) continue;
        Index const at = place_of(held[k].vertex);
        mover_[static_cast<std::size_t>(at) * D + c] = model_.holds[set].hold;
        held_.push_back({set, static_cast<Index>(k), at, c});
      }
  }
  for (Index const vertex : model_.vertices.on_axis.download())
    if (listed(vertex)) mover_[static_cast<std::size_t>(place_of(vertex)) * D] = on_axis;
}

/// What hangs and is held must hang on what is held alike.
template <int D, class Real>
void TieStage<D, Real>::refuse_held() {
  for (auto const& one : model_.hung)
    for (int c = 0; c < D; ++c) {
      if (mover(place_of(one.vertex), c) < 0) continue;
      for (int a = 0; a <= D; ++a)
        if (one.share[a] != 0 && mover(place_of(one.on[a]), c) == freely)
          throw Error(scene_.ties[one.tie].source,
                      told(one, c) + fmt::format(", and what it hangs on is not: hold body \"{0}\" there as well, or "
                                                 "give body \"{0}\" the smaller cells, so that it is what hangs",
                                                 scene_.bodies[model_.elements.body[one.element]].name));
      refuse_torn(one, c);
    }
}

/// Motions are compared at 65 times of the run, as those of two holds of one vertex are.
template <int D, class Real>
void TieStage<D, Real>::refuse_torn(model::HungVertex<D> const& one, int c) const {
  auto const velocity = [&](Index vertex, double t) {
    int const hold = mover(place_of(vertex), c);
    return hold < 0 ? 0 : scene_.holds[hold].velocity_at(c, model_.drawn_at(vertex), t);
  };
  for (int k = 0; k <= 64; ++k) {
    double const t = scene_.run.time * k / 64, asked = velocity(one.vertex, t);
    double carried = 0;
    for (int a = 0; a <= D; ++a)
      if (one.share[a] != 0) carried += one.share[a] * velocity(one.on[a], t);
    // What turns or widens is not quite linear between the vertices that carry.
    if (std::abs(asked - carried) > 0.05 * std::max(std::abs(asked), std::abs(carried)))
      throw Error(scene_.ties[one.tie].source,
                  told(one, c) + fmt::format(" at {:.4g} m/s at t = {:.4g} s, and what it hangs on at {:.4g} m/s: what "
                                             "is tied moves as one",
                                             asked, t, carried));
  }
}

template <int D, class Real>
std::string TieStage<D, Real>::told(model::HungVertex<D> const& one, int c) const {
  auto const& tie = scene_.ties[one.tie];
  auto const& hold = scene_.holds[mover(place_of(one.vertex), c)];
  Vec3 const x = model_.drawn_at(one.vertex);
  return fmt::format(
      "tie \"{}\": a node of body \"{}\" that hangs, at ({:.4g}, {:.4g}, {:.4g}), is held along {} by "
      "{}:{}",
      tie.name, scene_.bodies[tie.bodies[one.of_second ? 1 : 0]].name, x[0], x[1], x[2], "xyz"[c], hold.source.file,
      hold.source.line);
}

/// Both bodies of a tie must start with one motion; what a curved function of place leaves between nodes is smoothed.
template <int D, class Real>
void TieStage<D, Real>::start() {
  auto const before = model_.vertices.v.download();
  move();
  auto const after = model_.vertices.v.download();
  for (int c = 0; c < D; ++c) {
    double low = INFINITY, high = -INFINITY;
    for (Index const vertex : list_) {
      double const v = before[static_cast<std::size_t>(vertex) * D + c];
      low = std::min(low, v), high = std::max(high, v);
    }
    double const rounding = 1e-6 * std::max(std::abs(low), std::abs(high));
    for (auto const& one : model_.hung) {
      std::size_t const i = static_cast<std::size_t>(one.vertex) * D + c;
      double const was = before[i], is = after[i];
      if (!(std::abs(was - is) > 0.05 * (high - low) + rounding)) continue;
      auto const& tie = scene_.ties[one.tie];
      Vec3 const place = model_.drawn_at(one.vertex);
      throw Error(
          tie.source,
          fmt::format("tie \"{}\": its bodies start with different velocities, {:.4g} and {:.4g} m/s along {} at "
                      "({:.4g}, {:.4g}, {:.4g}); what is tied moves as one",
                      tie.name, was, is, "xyz"[c], place[0], place[1], place[2]));
    }
  }
}

template <int D, class Real>
void TieStage<D, Real>::place() {
  placed_ = model_.hung.size();
  for (int c = 0; c < D; ++c) {
    along_[c] = std::make_unique<Along>();
    auto& along = *along_[c];
    along.rows = rows_along(c);
    along.unknown.assign(list_.size(), -1);
    int free = 0;
    for (auto const& row : along.rows)
      for (auto const& one : row.on)
        if (int& number = along.unknown[one.at]; number < 0 && mover(one.at, c) == freely) number = free++;
    weigh(along);
    std::vector<Index> hung, first{0}, carrier;
    std::vector<double> share;
    for (auto const& row : along.rows) {
      hung.push_back(list_[row.at]);
      for (auto const& one : row.on) carrier.push_back(list_[one.at]), share.push_back(one.share);
      first.push_back(static_cast<Index>(carrier.size()));
    }
    along.hung = Buffer<Index>(device_, "ties", hung), along.first = Buffer<Index>(device_, "ties", first);
    along.carrier = Buffer<Index>(device_, "ties", carrier), along.share = Buffer<double>(device_, "ties", share);
  }
}

template <int D, class Real>
std::vector<typename TieStage<D, Real>::Row> TieStage<D, Real>::rows_along(int c) const {
  std::map<Index, Row> rows;  // by what hangs
  for (auto const& one : model_.hung) {
    Row row{place_of(one.vertex), {}, {}, one.tie, one.of_second ? 1.0 : -1.0};
    if (mover(row.at, c) != freely) continue;
    for (int a = 0; a <= D; ++a)
      if (one.share[a] != 0) row.direct.push_back({place_of(one.on[a]), one.share[a]});
    rows.emplace(row.at, std::move(row));
  }
  std::vector<Row> list;
  for (auto& [at, row] : rows) resolve(rows, row);
  for (auto& [at, row] : rows) list.push_back(std::move(row));
  std::ranges::stable_sort(list, std::greater{}, &Row::depth);
  return list;
}

/// What hangs on something that hangs, hangs on what carries that. No chain closes (mesh::tie_bodies).
template <int D, class Real>
void TieStage<D, Real>::resolve(std::map<Index, Row>& rows, Row& row) {
  if (row.depth > 0) return;
  row.depth = 1;
  std::map<Index, double> on;
  for (auto const& one : row.direct) {
    auto const above = rows.find(one.at);
    if (above == rows.end()) {
      on[one.at] += one.share;
      continue;
    }
    resolve(rows, above->second);
    row.depth = std::max(row.depth, above->second.depth + 1);
    for (auto const& higher : above->second.on) on[higher.at] += one.share * higher.share;
  }
  for (auto const& [at, share] : on) row.on.push_back({at, share});
}

/// M + N^T m N of the free carriers, as factors.
template <int D, class Real>
void TieStage<D, Real>::weigh(Along& along) {
  auto const mass = [&](Index at) { return model_.vertices.mass[list_[at]]; };
  std::vector<Eigen::Triplet<double>> entries;
  int free = 0;
  for (Index at = 0; at < static_cast<Index>(list_.size()); ++at)
    if (int const i = along.unknown[at]; i >= 0) entries.emplace_back(i, i, mass(at)), ++free;
  for (auto const& row : along.rows)
    for (auto const& one : row.on)
      for (auto const& other : row.on) {
        int const i = along.unknown[one.at], j = along.unknown[other.at];
        if (i >= 0 && j >= 0) entries.emplace_back(i, j, mass(row.at) * one.share * other.share);
      }
  Eigen::SparseMatrix<double> matrix(free, free);
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (free > 0) along.mass.compute(matrix);
}

/// Accelerations, less gravity, that holds ask for [listed][D].
template <int D, class Real>
std::vector<double> TieStage<D, Real>::held_push(kernels::VertexView<D, Real> const& vertices, double t,
                                                 std::vector<double> const& motion) {
  std::vector<double> push(list_.size() * D, 0), asked;
  double const a = 0.5 * vertices.damping * vertices.kick;
  for (std::size_t n = 0; n < held_.size(); ++n) {
    auto const& [set, k, at, c] = held_[n];
    if (n == 0 || held_[n - 1].set != set) asked = motion_.asked(set, t, vertices.dt);
    double const v = motion[static_cast<std::size_t>(at) * Gather::size + D + c];
    push[static_cast<std::size_t>(at) * D + c] =
        ((1 + a) * asked[static_cast<std::size_t>(k) * D + c] - (1 - a) * v) / vertices.kick - vertices.gravity[c];
  }
  return push;
}

template <int D, class Real>
void TieStage<D, Real>::carry_along(int c, std::vector<double> const& motion, std::vector<double> const& held,
                                    std::vector<double>& force) {
  auto const& along = *along_[c];
  auto const mass = [&](Index at) { return model_.vertices.mass[list_[at]]; };
  auto const pushed = [&](Index at) { return motion[static_cast<std::size_t>(at) * Gather::size + c]; };
  auto const at_hold = [&](Index at) { return held[static_cast<std::size_t>(at) * D + c]; };
  Eigen::VectorXd right = Eigen::VectorXd::Zero(along.mass.rows());
  for (Index at = 0; at < static_cast<Index>(list_.size()); ++at)
    if (int const i = along.unknown[at]; i >= 0) right[i] = pushed(at);
  for (auto const& row : along.rows) {
    double own = pushed(row.at);
    for (auto const& one : row.on)
      if (along.unknown[one.at] < 0) own -= mass(row.at) * one.share * at_hold(one.at);
    for (auto const& one : row.on)
      if (int const i = along.unknown[one.at]; i >= 0) right[i] += one.share * own;
  }
  Eigen::VectorXd const a = right.size() > 0 ? Eigen::VectorXd(along.mass.solve(right)) : right;
  std::vector<double> passed(list_.size(), 0);  // to what hangs itself, by what hangs on it [N]
  for (auto const& row : along.rows) {
    double mean = 0;
    for (auto const& one : row.on) {
      int const i = along.unknown[one.at];
      mean += one.share * (i >= 0 ? a[i] : at_hold(one.at));
    }
    double const carried = pushed(row.at) - mass(row.at) * mean + passed[row.at];
    force_[row.tie][c] -= row.sign * carried;
    force[static_cast<std::size_t>(row.at) * D + c] = mass(row.at) * mean;
    for (auto const& one : row.direct) passed[one.at] += one.share * carried;
  }
  for (auto const& row : along.rows) passed[row.at] = 0;
  for (Index at = 0; at < static_cast<Index>(list_.size()); ++at)
    if (mover(at, c) != on_axis) force[static_cast<std::size_t>(at) * D + c] += passed[at];
}

template <int D, class Real>
void TieStage<D, Real>::carry(kernels::VertexView<D, Real> const& vertices, double t, bool more) {
  if (list_.empty()) return;
  if (placed_ != model_.hung.size()) place();
  auto const n = static_cast<Index>(list_.size());
  for_each(device_, 0, n, Gather{listed_.data(), vertices.force, vertices.v, gathered_.data()});
  auto const motion = gathered_.download();
  std::vector<double> force(list_.size() * D);
  for (std::size_t at = 0; at < list_.size(); ++at)
    for (int c = 0; c < D; ++c) force[at * D + c] = motion[at * Gather::size + c];
  auto const held = held_push(vertices, t, motion);
  if (!more) std::ranges::fill(force_, Vec3::Zero());
  for (int c = 0; c < D; ++c) carry_along(c, motion, held, force);
  found_.upload(force);
  for_each(device_, 0, n, kernels::PutForces<D, Real>{listed_.data(), found_.data(), model_.vertex_force()});
}

template <int D, class Real>
void TieStage<D, Real>::move() {
  if (list_.empty()) return;
  if (placed_ != model_.hung.size()) place();
  for (int c = 0; c < D; ++c) {
    auto& along = *along_[c];
    kernels::HangMotion<D, Real> const kernel{along.hung.data(),
                                              along.first.data(),
                                              along.carrier.data(),
                                              along.share.data(),
                                              model_.vertices.u.data(),
                                              model_.vertices.v.data(),
                                              c};
    for_each(device_, 0, static_cast<Index>(along.hung.size()), kernel);
  }
}

}  // namespace fissure
