// Instantiated by src2d and src3d.
#pragma once
#include <algorithm>
#include <cmath>

#include "solver/element_launch.h"
#include "solver/removal_stage.h"

namespace fissure {

template <int D, class Real>
RemovalStage<D, Real>::RemovalStage(Device& device, scene::Scene const& scene, model::Model<D, Real>& model,
                                    ContactStage<D, Real>& contact, InsertionStage<D, Real> const& insertion,
                                    Ledger& ledger)
    : device_(device), scene_(scene), model_(model), contact_(contact), insertion_(insertion), ledger_(ledger) {
  for (auto const& excavation : scene.excavations) {
    excavations_.push_back({excavation.time, excavated_by(excavation)});
    if (excavation.time >= scene.run.time)
      model_.warnings.push_back(fmt::format("{}excavate of body \"{}\": at {:.4g} s, but the run ends at {:.4g} s",
                                            excavation.source.prefix(), scene.bodies[excavation.body].name,
                                            excavation.time, scene.run.time));
  }
}

/// Whether a hold moves it.
template <int D, class Real>
bool RemovalStage<D, Real>::held(Index vertex) const {
  if (held_.empty()) {
    held_.assign(static_cast<std::size_t>(model_.vertices.count), 0);
    for (auto const& set : model_.holds)
      for (auto const& one : set.list.download()) held_[one.vertex] = 1;
  }
  return held_[vertex];
}

/// Its elements, ascending; an error where they cannot leave.
template <int D, class Real>
std::vector<Index> RemovalStage<D, Real>::excavated_by(scene::Excavation const& excavation) const {
  auto const& group = model_.groups[excavation.body];
  auto const refuse = [&](std::string const& why) {
    throw Error(fmt::format("{}excavate of body \"{}\": {}", excavation.source.prefix(),
                            scene_.bodies[excavation.body].name, why));
  };
  if (excavation.within && (!group.split || group.inserted))
    refuse(group.split
               ? "its cells share corners until joints are inserted, so it can only leave as a whole; leave "
                 "out within, give its fracture insertion = \"intrinsic\", or make what leaves a body of its "
                 "own and bond{} both"
               : "its cells share corners, so it can only leave as a whole; leave out within, give its material "
                 "fracture, or make what leaves a body of its own and bond{} both");
  std::vector<Index> elements;
  for (Index e = group.first; e < group.first + group.count; ++e) {
    if (model_.elements.cell[e] < 0) continue;
    Vec3 middle(0, 0, 0);
    auto const corners = model_.cell_vertices(e);
    for (Index const vertex : corners) middle += model_.drawn_at(vertex) / static_cast<double>(corners.size());
    if (!excavation.within || excavation.within(middle[0], middle[1], middle[2])) elements.push_back(e);
  }
  if (elements.empty()) refuse("no cell has its middle where within says true");
  return elements;
}

/// Vertices of elements, each once.
template <int D, class Real>
std::vector<Index> RemovalStage<D, Real>::corners_of(std::vector<Index> const& elements) const {
  std::vector<Index> all;
  for (Index const e : elements)
    for (Index const vertex : model_.cell_vertices(e)) all.push_back(vertex);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// Holds move it no more.
template <int D, class Real>
void RemovalStage<D, Real>::end_holds(std::vector<Index> const& corners) {
  for (auto& set : model_.holds) {
    auto list = set.list.download();
    for (auto& one : list)
      if (std::binary_search(corners.begin(), corners.end(), one.vertex))
        for (auto& share : one.share) share = 0;
    set.list.upload(list);
  }
}

/// From its neighbours.
template <int D, class Real>
void RemovalStage<D, Real>::cut(Index e) {
  for (int a = 0; a <= D && model_.plan.joints; ++a) {
    FaceId const mine{e, a}, other = model_.neighbour(mine);
    if (other.element == e) continue;
    contact_.loosen(mine);
    model_.unlink(mine), model_.unlink(other);
  }
}

template <int D, class Real>
void RemovalStage<D, Real>::excavate(kernels::VertexView<D, Real> const& vertices, double t, double dt) {
  std::vector<Index> now;
  for (auto& excavation : excavations_)
    if (!excavation.done && t >= excavation.time) {
      excavation.done = true;
      std::copy_if(excavation.elements.begin(), excavation.elements.end(), std::back_inserter(now),
                   [this](Index e) { return !model_.removed(e); });
    }
  if (now.empty()) return;
  std::sort(now.begin(), now.end());
  now.erase(std::unique(now.begin(), now.end()), now.end());
  ledger_.excavated += take_out(vertices, now, dt);
}

/// Of these, ascending: all that the others, and what they do to them, no longer have [J].
template <int D, class Real>
double RemovalStage<D, Real>::take_out(kernels::VertexView<D, Real> const& vertices, std::vector<Index> const& elements,
                                       double dt) {
  auto const corners = corners_of(elements);
  double const held = kinetic_and_weight(vertices) + stored(dt) + contact_.let_go(elements);
  for (Index const e : elements) {
    cut(e);
    model_.elements.removed[e] = 1;
  }
  end_holds(corners);
  still(corners);
  for (Index const e : elements) forget_flow(e);
  model_.drop_ties();
  if (model_.plan.patches) model_.place_patches(device_);
  return held - stored(dt) - kinetic_and_weight(vertices);
}

/// Simplices of bodies that can crack have corners of their own, so what is left of one without joints is alone.
template <int D, class Real>
bool RemovalStage<D, Real>::may_leave(Index e) const {
  if (model_.elements.cell[e] < 0 || model_.block_of(e) >= 0 || !model_.groups[model_.elements.body[e]].split ||
      model_.removed(e))
    return false;
  for (int a = 0; a <= D; ++a)
    if (model_.neighbour({e, a}).element != e) return false;
  auto const corners = model_.cell_vertices(e);
  return std::none_of(corners.begin(), corners.end(),
                      [this](Index vertex) { return held(vertex) || insertion_.tied(vertex); });
}

template <int D, class Real>
void RemovalStage<D, Real>::look(std::vector<Real> const& u, double last_dt) {
  std::vector<Real> before;  // where everything was a step ago
  for (Index e = 0; e < model_.elements.count; ++e) {
    double const ratio = model_.elements.cell[e] >= 0 ? model_.volume_ratio(u, e) : 1;
    if (ratio > model::crushed || !std::isfinite(ratio) || !may_leave(e)) continue;
    if (!(ratio > 0) && before.empty()) {
      before = u;
      auto const v = model_.vertices.v.download();
      for (std::size_t i = 0; i < v.size(); ++i) before[i] -= static_cast<Real>(last_dt) * v[i];
    }
    // What was inside out before is no crushed piece, but a run that is unstable.
    if (ratio > 0 || model_.volume_ratio(before, e) > 0) leaving_.push_back(e);
  }
}

/// m v-.v+/2, as the ledger has it, and what their weight holds [J].
template <int D, class Real>
double RemovalStage<D, Real>::kinetic_and_weight(kernels::VertexView<D, Real> const& vertices) const {
  auto const u = model_.vertices.u.download(), v = model_.vertices.v.download(),
             force = model_.vertices.force.download();
  double sum = 0;
  for (Index vertex = 0; vertex < model_.vertices.count; ++vertex)
    for (int c = 0; c < D && model_.vertices.mass[vertex] > 0; ++c) {
      std::size_t const i = static_cast<std::size_t>(vertex) * D + c;
      double const m = model_.vertices.mass[vertex], before = v[i], a = vertices.damping * vertices.kick / 2;
      double const push = static_cast<double>(force[i]) / m + vertices.gravity[c];
      double const after = ((1 - a) * before + vertices.kick * push) / (1 + a);
      sum += 0.5 * m * before * (std::isfinite(after) ? after : before) - m * vertices.gravity[c] * u[i];
    }
  return sum;
}

/// They stand where they stood at rest, without mass.
template <int D, class Real>
void RemovalStage<D, Real>::still(std::vector<Index> const& of) {
  for (Index const vertex : of) {
    model_.vertices.inverse_mass.upload_one(static_cast<std::size_t>(vertex), Real(0));
    for (int c = 0; c < D; ++c)
      for (auto* const numbers : {&model_.vertices.u, &model_.vertices.v, &model_.vertices.force})
        numbers->upload_one(static_cast<std::size_t>(vertex) * D + c, Real(0));
  }
}

/// Of cells, as they stand [J].
template <int D, class Real>
double RemovalStage<D, Real>::stored(double dt) {
  if (model_.plan.patches) average_pressure(device_, model_);
  auto const sums = element_energy(device_, model_, scene_, ElementRun{dt});
  return sums[0] + sums[1] + sums[2];
}

template <int D, class Real>
void RemovalStage<D, Real>::forget_flow(Index e) {
  auto const& group = model_.groups[model_.elements.body[e]];
  for (int k = 0; group.plastic && k < group.plastic->memory.numbers; ++k)
    model_.internal.memory.upload_one(
        group.simplices.memory_at + kernels::blocked(e - group.first, k, group.plastic->memory.numbers), Real(0));
}

template <int D, class Real>
void RemovalStage<D, Real>::remove(kernels::VertexView<D, Real> const& vertices, double last_dt, double dt) {
  if (leaving_.empty()) return;
  auto u = model_.vertices.u.download();
  auto const v = model_.vertices.v.download();
  for (Index const e : leaving_) {
    RemovedCell cell{.element = e};
    bool const inverted = !(model_.volume_ratio(u, e) > 0);
    for (Index const vertex : model_.cell_vertices(e)) {
      cell.mass += model_.vertices.mass[vertex];
      for (int c = 0; c < D; ++c) {
        std::size_t const i = static_cast<std::size_t>(vertex) * D + c;
        // No law has an energy for what is inside out: that of a step before.
        if (inverted) model_.vertices.u.upload_one(i, u[i] -= static_cast<Real>(last_dt) * v[i]);
        cell.place[c] += (model_.vertices.reference[vertex][c] + static_cast<double>(u[i])) / (D + 1);
      }
    }
    removed_.push_back(cell);
  }
  ledger_.removed += take_out(vertices, leaving_, dt);
  leaving_.clear();
}

template <int D, class Real>
double RemovalStage<D, Real>::mass() const {
  double sum = 0;
  for (auto const& cell : removed_) sum += cell.mass;
  return sum / scene_.run.mass_scaling;
}

template <int D, class Real>
void RemovalStage<D, Real>::draw(std::vector<Real>& u) const {
  draw_excavated(u);
  for (auto const& cell : removed_)
    for (Index const vertex : model_.cell_vertices(cell.element))
      for (int c = 0; c < D; ++c)
        u[static_cast<std::size_t>(vertex) * D + c] =
            static_cast<Real>(cell.place[c] - model_.vertices.reference[vertex][c]);
}

template <int D, class Real>
bool RemovalStage<D, Real>::excavated(Index e) const {
  return model_.removed(e) && std::any_of(excavations_.begin(), excavations_.end(), [e](Excavated const& excavation) {
           return excavation.done && std::binary_search(excavation.elements.begin(), excavation.elements.end(), e);
         });
}

/// What has been excavated is a point in its middle.
template <int D, class Real>
void RemovalStage<D, Real>::draw_excavated(std::vector<Real>& u) const {
  for (auto const& excavation : excavations_) {
    if (!excavation.done) continue;
    auto const corners = corners_of(excavation.elements);
    Vec<double, D> middle = Vec<double, D>::Zero();
    auto const at = [&](Index vertex, int c) { return model_.vertices.reference[vertex][c]; };
    for (Index const vertex : corners)
      for (int c = 0; c < D; ++c) middle[c] += at(vertex, c) / static_cast<double>(corners.size());
    for (Index const vertex : corners)
      for (int c = 0; c < D; ++c)
        u[static_cast<std::size_t>(vertex) * D + c] = static_cast<Real>(middle[c] - at(vertex, c));
  }
}

template <int D, class Real>
void RemovalStage<D, Real>::save(State& state) const {
  std::vector<long> done;
  for (auto const& excavation : excavations_) done.push_back(excavation.done);
  state["excavated"] = state_bytes(done);
  std::vector<double> numbers;
  for (auto const& cell : removed_)
    numbers.insert(numbers.end(),
                   {static_cast<double>(cell.element), cell.mass, cell.place[0], cell.place[1], cell.place[2]});
  state["removed"] = state_bytes(numbers);
}

/// Before contact, which looks at what is left.
template <int D, class Real>
void RemovalStage<D, Real>::restore(State const& state) {
  auto const numbers = state_values<double>(state, "removed");
  if (numbers.size() % 5 != 0) throw Error("the checkpoint's removed cells are of another scene or mesh");
  removed_.clear();
  for (std::size_t k = 0; k < numbers.size(); k += 5) {
    double const* const n = &numbers[k];
    auto const count = static_cast<double>(model_.elements.count);
    Index const e = n[0] >= 0 && n[0] < count ? static_cast<Index>(n[0]) : -1;
    check_index("removed", e, model_.elements.removed.size());
    if (model_.elements.cell[e] < 0) throw Error("the checkpoint's removed cells are of another scene or mesh");
    removed_.push_back({.element = e, .mass = n[1], .place = {n[2], n[3], n[4]}});
    leave(e);
  }
  auto const done = state_values<long>(state, "excavated", excavations_.size());
  for (std::size_t k = 0; k < done.size(); ++k) {
    if (!(excavations_[k].done = done[k] != 0)) continue;
    for (Index const e : excavations_[k].elements) leave(e);
    end_holds(corners_of(excavations_[k].elements));
  }
  model_.drop_ties();
}

template <int D, class Real>
void RemovalStage<D, Real>::leave(Index e) {
  model_.elements.removed[e] = 1;
  for (Index const vertex : model_.cell_vertices(e))
    model_.vertices.inverse_mass.upload_one(static_cast<std::size_t>(vertex), Real(0));
}

}  // namespace fissure
