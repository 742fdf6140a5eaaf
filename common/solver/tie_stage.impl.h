// Instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "solver/tie_stage.h"

namespace fissure {

template <int D, class Real>
TieStage<D, Real>::TieStage(Device& device, scene::Scene const& scene, model::Model<D, Real>& model,
                            MotionStage<D, Real>& motion)
    : device_(device), scene_(scene), model_(model), motion_(motion), force_(scene.ties.size(), Vec3::Zero()) {
  if (model_.hung.empty()) return;
  list_vertices();
  find_held();
  for (Index const vertex : list_) mass_.push_back(model_.vertices.mass[vertex]);
  place();
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
void TieStage<D, Real>::find_held() {
  moved_.assign(list_.size() * D, Moved::freely);
  auto const place_of = [&](Index vertex) -> Index {
    auto const found = std::lower_bound(list_.begin(), list_.end(), vertex);
    return found != list_.end() && *found == vertex ? static_cast<Index>(found - list_.begin()) : -1;
  };
  for (std::size_t set = 0; set < model_.holds.size(); ++set) {
    auto const held = model_.holds[set].list.download();
    for (std::size_t k = 0; k < held.size(); ++k) {
      Index const at = place_of(held[k].vertex);
      for (int c = 0; c < D && at >= 0; ++c)
        if (held[k].share[c] > 0) {
          moved_[static_cast<std::size_t>(at) * D + c] = Moved::by_hold;
          held_.push_back({set, static_cast<Index>(k), at, c});
        }
    }
  }
  for (Index const vertex : model_.vertices.on_axis.download())
    if (Index const at = place_of(vertex); at >= 0) moved_[static_cast<std::size_t>(at) * D] = Moved::on_axis;
}

/// What hangs on something that hangs itself hangs on what carries that.
template <int D, class Real>
std::vector<typename TieStage<D, Real>::Row> TieStage<D, Real>::rows_along(int c) const {
  auto const place_of = [&](Index vertex) {
    return static_cast<Index>(std::lower_bound(list_.begin(), list_.end(), vertex) - list_.begin());
  };
  std::map<Index, Row> rows;  // by what hangs
  for (auto const& one : model_.hung) {
    Row row{place_of(one.vertex), {}, one.tie, one.of_second ? 1.0 : -1.0};
    bool here = mass_[row.at] > 0 && moved(row.at, c) == Moved::freely;
    for (int a = 0; a <= D; ++a) {
      if (one.share[a] == 0) continue;
      row.on.push_back({place_of(one.on[a]), one.share[a]});
      here = here && mass_[row.on.back().at] > 0;
    }
    if (here) rows.emplace(row.at, std::move(row));
  }
  // Bodies hang on those of larger cells, so that no chain closes; more links than bodies would be one that does.
  bool again = true;
  for (std::size_t link = 0; again && link < scene_.bodies.size(); ++link) {
    again = false;
    for (auto& [at, row] : rows) {
      std::map<Index, double> on;
      for (auto const& one : row.on) {
        auto const above = rows.find(one.at);
        if (above == rows.end()) on[one.at] += one.share;
        if (above == rows.end()) continue;
        again = true;
        for (auto const& higher : above->second.on) on[higher.at] += one.share * higher.share;
      }
      row.on.clear();
      for (auto const& [carrier, share] : on) row.on.push_back({carrier, share});
    }
  }
  std::vector<Row> list;
  for (auto& [at, row] : rows) list.push_back(std::move(row));
  return list;
}

template <int D, class Real>
void TieStage<D, Real>::place() {
  for (int c = 0; c < D; ++c) {
    along_[c] = std::make_unique<Along>();
    auto& along = *along_[c];
    along.rows = rows_along(c);
    along.unknown.assign(list_.size(), -1);
    int free = 0;
    for (auto const& row : along.rows)
      for (auto const& one : row.on)
        if (int& number = along.unknown[one.at]; number < 0 && moved(one.at, c) == Moved::freely) number = free++;
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

/// M + N^T m N of the free carriers, as factors.
template <int D, class Real>
void TieStage<D, Real>::weigh(Along& along) {
  std::vector<Eigen::Triplet<double>> entries;
  int free = 0;
  for (std::size_t at = 0; at < list_.size(); ++at)
    if (int const i = along.unknown[at]; i >= 0) entries.emplace_back(i, i, mass_[at]), ++free;
  for (auto const& row : along.rows)
    for (auto const& one : row.on)
      for (auto const& other : row.on) {
        int const i = along.unknown[one.at], j = along.unknown[other.at];
        if (i >= 0 && j >= 0) entries.emplace_back(i, j, mass_[row.at] * one.share * other.share);
      }
  Eigen::SparseMatrix<double> matrix(free, free);
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (free > 0) along.mass.compute(matrix);
}

/// Both bodies of a tie must start with one motion; what a curved function of place leaves between nodes is smoothed.
template <int D, class Real>
void TieStage<D, Real>::start() {
  auto const before = model_.vertices.v.download();
  move();
  auto const after = model_.vertices.v.download();
  double fastest = 0;
  for (Real const v : before) fastest = std::max(fastest, std::abs(static_cast<double>(v)));
  for (auto const& one : model_.hung)
    for (int c = 0; c < D; ++c) {
      std::size_t const i = static_cast<std::size_t>(one.vertex) * D + c;
      double const was = before[i], is = after[i];
      if (!(std::abs(was - is) > 0.05 * fastest)) continue;
      auto const& tie = scene_.ties[one.tie];
      Vec3 const place = model_.drawn_at(one.vertex);
      throw Error(
          tie.source,
          fmt::format("tie \"{}\": its bodies start with different velocities, {:.4g} and {:.4g} m/s along {} at "
                      "({:.4g}, {:.4g}, {:.4g}); what is tied moves as one",
                      tie.name, was, is, "xyz"[c], place[0], place[1], place[2]));
    }
}

/// Accelerations, less gravity, that holds ask carriers for [listed][D].
template <int D, class Real>
std::vector<double> TieStage<D, Real>::held_push(kernels::VertexView<D, Real> const& vertices, double t,
                                                 std::vector<double> const& motion) {
  std::vector<double> push(list_.size() * D, 0);
  double const a = 0.5 * vertices.damping * vertices.kick;
  std::vector<double> asked;
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
  auto const pushed = [&](Index at) { return motion[static_cast<std::size_t>(at) * Gather::size + c]; };
  auto const at_hold = [&](Index at) { return held[static_cast<std::size_t>(at) * D + c]; };
  Eigen::VectorXd right = Eigen::VectorXd::Zero(along.mass.rows());
  for (std::size_t at = 0; at < list_.size(); ++at)
    if (int const i = along.unknown[at]; i >= 0) right[i] = pushed(static_cast<Index>(at));
  for (auto const& row : along.rows) {
    double own = pushed(row.at);
    for (auto const& one : row.on)
      if (along.unknown[one.at] < 0) own -= mass_[row.at] * one.share * at_hold(one.at);
    for (auto const& one : row.on)
      if (int const i = along.unknown[one.at]; i >= 0) right[i] += one.share * own;
  }
  Eigen::VectorXd const a = right.size() > 0 ? Eigen::VectorXd(along.mass.solve(right)) : right;
  for (auto const& row : along.rows) {
    double mean = 0;
    for (auto const& one : row.on) {
      int const i = along.unknown[one.at];
      mean += one.share * (i >= 0 ? a[i] : at_hold(one.at));
    }
    double const carried = pushed(row.at) - mass_[row.at] * mean;
    force_[row.tie][c] -= row.sign * carried;
    force[static_cast<std::size_t>(row.at) * D + c] = mass_[row.at] * mean;
    for (auto const& one : row.on)
      if (moved(one.at, c) != Moved::on_axis) force[static_cast<std::size_t>(one.at) * D + c] += one.share * carried;
  }
}

template <int D, class Real>
void TieStage<D, Real>::carry(kernels::VertexView<D, Real> const& vertices, double t, bool more) {
  if (list_.empty()) return;
  auto const n = static_cast<Index>(list_.size());
  for_each(device_, 0, n, Gather{listed_.data(), vertices.force, vertices.v, vertices.inverse_mass, gathered_.data()});
  auto const motion = gathered_.download();
  bool changed = false;
  std::vector<double> force(list_.size() * D);
  for (std::size_t at = 0; at < list_.size(); ++at) {
    double const mass = motion[at * Gather::size + 2 * D] > 0 ? model_.vertices.mass[list_[at]] : 0;
    changed = changed || mass != mass_[at];
    mass_[at] = mass;
    for (int c = 0; c < D; ++c) force[at * D + c] = motion[at * Gather::size + c];
  }
  if (changed) place();
  auto const held = held_push(vertices, t, motion);
  if (!more) std::fill(force_.begin(), force_.end(), Vec3::Zero());
  for (int c = 0; c < D; ++c) carry_along(c, motion, held, force);
  found_.upload(force);
  for_each(device_, 0, n, kernels::PutForces<D, Real>{listed_.data(), found_.data(), model_.vertex_force()});
}

template <int D, class Real>
void TieStage<D, Real>::move() {
  if (list_.empty()) return;
  for (int c = 0; c < D; ++c) {
    auto& along = *along_[c];
    auto& vertices = model_.vertices;
    kernels::HangMotion<D, Real> const kernel{along.hung.data(),
                                              along.first.data(),
                                              along.carrier.data(),
                                              along.share.data(),
                                              vertices.inverse_mass.data(),
                                              vertices.u.data(),
                                              vertices.v.data(),
                                              c};
    for_each(device_, 0, static_cast<Index>(along.hung.size()), kernel);
  }
}

}  // namespace fissure
