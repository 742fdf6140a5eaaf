// Contact as a stage of the step; instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <numeric>

#include "contact/bonds.impl.h"
#include "contact/crack_faces.impl.h"
#include "contact/removal.impl.h"
#include "contact/spring_beds.impl.h"

namespace fissure {

template <int D, class Real>
ContactStage<D, Real>::ContactStage(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh,
                                    model::Model<D, Real>& model)
    : device_(device), scene_(scene), model_(model), bonds_(mesh, model), rigid_(device, scene, model.origin) {
  if (!model.plan.contact() && !model.plan.joints) return;
  laws_ = ContactLaws(device, scene, model.elements.body);
  age_ = ListAge<D, Real>(mesh);
  news_ = Buffer<int>(device, "contact flags", 1);
}

template <int D, class Real>
void ContactStage<D, Real>::loosen(FaceId face) {
  stale_ = bonds_.loosen(face) || stale_;
}

/// Neither bonded nor tied nor sides of a crack that still presses as a joint.
template <int D, class Real>
bool ContactStage<D, Real>::may_touch(Index a, Index b) const {
  std::pair<Index, Index> const cells = std::minmax(model_.cell_head(a), model_.cell_head(b));
  return !bonds_.joined(a, b) && !model_.tied(a, b) && !std::binary_search(facing_.begin(), facing_.end(), cells);
}

/// Candidates anew, or (not `everything`) those of elements whose neighbourhood has changed, added to the others.
template <int D, class Real>
void ContactStage<D, Real>::make_list(bool everything) {
  everything ? age_.begin_list() : age_.begin_extension();
  // Pairs that join a list that has drifted already must look as far again.
  double const buffer = everything ? age_.buffer() : 2 * age_.buffer();
  stale_ = false;
  active_.clear();
  for (Index e = 0; e < model_.elements.count; ++e)
    if (bonds_.exposed(e) && !model_.removed(e)) active_.push_back(e);

  auto const u = model_.vertices.u.look(u_copy_);
  std::vector<Index> vertices;
  for (Index const e : active_)
    for (int a = 0; a < C; ++a) vertices.push_back(model_.vertex_of(e, a));
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  if (everything)
    age_.follow(device_, vertices, u, rigid_);
  else
    age_.join(device_, vertices, u);

  auto const bounds = bounds_of_active(u, buffer);
  if (model_.plan.pairs) {
    auto const found = near_pairs(bounds, u, buffer, everything);
    everything ? near_.renew(found, pair_) : near_.join(found, pair_);
    // Of a new list nobody knows how far its pairs are apart: it is chosen from again once they have been looked at.
    watch(everything ? 0 : watch_window());
  }
  if (model_.plan.plates) plate_.renew(device_, near_plates(bounds, buffer));
  if (model_.plan.walls) wall_.renew(device_, near_walls(bounds, buffer));
  bonds_.forget_changes();
  slots_are_stale_ = beds_are_stale_ = true;
}

/// Pairs that may touch soon, and they alone.
template <int D, class Real>
void ContactStage<D, Real>::watch(double window) {
  near_.watch(device_, pair_, age_.path(), window, last_dt_ > 0);
  slots_are_stale_ = true;
}

/// Boxes around active elements, wider than they are by half the buffer.
template <int D, class Real>
typename ContactStage<D, Real>::Bounds ContactStage<D, Real>::bounds_of_active(std::span<Real const> u,
                                                                               double buffer) const {
  Bounds bounds(active_.size());
  for (std::size_t k = 0; k < active_.size(); ++k) {
    bounds[k].low.fill(std::numeric_limits<double>::infinity());
    bounds[k].high.fill(-std::numeric_limits<double>::infinity());
    for (int a = 0; a < C; ++a) {
      Index const vertex = model_.vertex_of(active_[k], a);
      for (int c = 0; c < D; ++c) {
        double const x =
            model_.vertices.reference[vertex][c] + static_cast<double>(u[static_cast<std::size_t>(vertex) * D + c]);
        bounds[k].low[c] = std::min(bounds[k].low[c], x - 0.5 * buffer);
        bounds[k].high[c] = std::max(bounds[k].high[c], x + 0.5 * buffer);
      }
    }
  }
  return bounds;
}

/// An element where it is, from the model's origin.
template <int D, class Real>
kernels::Simplex<D, double> ContactStage<D, Real>::placed(Index e, std::span<Real const> u) const {
  kernels::Simplex<D, double> simplex;
  for (int a = 0; a <= D; ++a) {
    Index const vertex = model_.vertex_of(e, a);
    for (int c = 0; c < D; ++c)
      simplex.x[a][c] =
          model_.vertices.reference[vertex][c] + static_cast<double>(u[static_cast<std::size_t>(vertex) * D + c]);
  }
  return simplex;
}

/// Pairs of elements that may touch and are near each other; without `everything` those that are new.
template <int D, class Real>
std::vector<contact::ElementPair> ContactStage<D, Real>::near_pairs(Bounds const& bounds, std::span<Real const> u,
                                                                    double buffer, bool everything) {
  if (model_.plan.joints) bonds_.connect();
  facing_.clear();
  std::vector<kernels::CrackFace<D, Real>> copy;
  for (auto const& crack : cracks_.look(copy)) facing_.push_back(cells_of(crack));
  for (auto const& crack : new_cracks_) facing_.push_back(cells_of(crack));
  std::sort(facing_.begin(), facing_.end());
  // Two boxes that touch may hold simplices far from each other: the widest gap that boxes, faces or edges show
  // tells. Until the list is made anew, no axis brings them nearer than by the buffer.
  auto const near = [&](Index a, Index b) {
    auto one = placed(a, u), other = placed(b, u);
    double axis = 0;
    double const most = std::sqrt(D) * buffer;
    Mat<double, D + 1> inside;
    if (kernels::box_gap(one, other, axis) > most) return false;
    if (!one.differentiate() || !other.differentiate()) return true;
    return kernels::face_gap(one, other, inside, axis) <= most && kernels::face_gap(other, one, inside, axis) <= most &&
           Clip<D>::edge_gap(one.x, other.x, axis) <= most;
  };
  std::vector<char> wanted(active_.size(), 1);
  for (std::size_t k = 0; k < active_.size() && !everything; ++k) wanted[k] = bonds_.changed(active_[k]);
  std::vector<contact::ElementPair> found;
  for (auto const& pair : contact::overlapping_pairs<D>(bounds, wanted)) {
    Index const a = active_[pair.a], b = active_[pair.b];
    if (may_touch(a, b) && near(a, b)) found.push_back({a, b});
  }
  return found;
}

/// Numbers of active elements become those of elements.
template <int D, class Real>
std::vector<contact::ElementPair> ContactStage<D, Real>::of_active(std::vector<contact::ElementPair> found) const {
  for (auto& pair : found) pair.a = active_[pair.a];
  return found;
}

template <int D, class Real>
std::vector<contact::ElementPair> ContactStage<D, Real>::near_plates(Bounds const& bounds, double buffer) const {
  Bounds plates;
  for (auto const& box : rigid_.boxes_at(0)) {
    auto& bound = plates.emplace_back();
    for (int c = 0; c < D; ++c) {
      bound.low[c] = static_cast<double>(box.low[c]) + static_cast<double>(box.displacement[c]) - 0.5 * buffer;
      bound.high[c] = static_cast<double>(box.high[c]) + static_cast<double>(box.displacement[c]) + 0.5 * buffer;
    }
  }
  return of_active(contact::pairs_with_boxes<D>(bounds, plates));
}

template <int D, class Real>
std::vector<contact::ElementPair> ContactStage<D, Real>::near_walls(Bounds const& bounds, double buffer) const {
  std::vector<Vec<double, D>> points, normals;
  for (auto const& plane : rigid_.host_planes()) {
    points.push_back(plane.point.template cast<double>());
    normals.push_back(plane.normal.template cast<double>());
  }
  return of_active(contact::pairs_with_planes<D>(bounds, points, normals, 0.5 * buffer));
}

/// Cracks of the last step join the others; returns them.
template <int D, class Real>
std::vector<kernels::CrackFace<D, Real>> ContactStage<D, Real>::join_cracks() {
  if (new_cracks_.empty()) return {};
  auto all = cracks_.download();
  all.insert(all.end(), new_cracks_.begin(), new_cracks_.end());
  cracks_ = Buffer<kernels::CrackFace<D, Real>>(device_, "crack faces", all);
  crack_work_ = Buffer<Real>(device_, "crack faces", all.size());
  lists_are_stale_ = true;
  return std::exchange(new_cracks_, {});
}

/// Every candidate and crack owns force slots.
template <int D, class Real>
void ContactStage<D, Real>::place_slots() {
  slots_are_stale_ = false;
  auto const fresh = join_cracks();
  Index next = 0;
  auto const take = [&](std::size_t slots) { return std::exchange(next, next + static_cast<Index>(slots)); };
  pair_.first_slot = take(pair_.pairs.size() * 2 * C);
  plate_.first_slot = take(plate_.pairs.size() * C);
  wall_.first_slot = take(wall_.pairs.size() * C);
  crack_slot_ = take(cracks_.size() * 2 * D);
  slots_.place(device_, next);
  lists_are_stale_ = true;
  for (auto* kind : {&pair_, &plate_, &wall_}) kind->forget_last_step();
  pressing_.forget(device_, pair_.pairs.size());
  if (laws_.rubs()) {
    if (model_.plan.joints) bonds_.connect();
    groups_.divide(device_, model_, bonds_, pair_.pairs.size() * 2 * C);
  }
  if (beds_are_stale_)
    place_beds();
  else if (!fresh.empty())
    add_beds(fresh);
}

/// Nothing but cracks has joined.
template <int D, class Real>
void ContactStage<D, Real>::place_cracks() {
  auto const fresh = join_cracks();
  slots_.grow(device_, crack_slot_ + cracks_.size() * 2 * D);
  add_beds(fresh);
}

/// Every touched vertex knows its slots, in order: of pairs that press, of rigid bodies' candidates and of cracks.
template <int D, class Real>
void ContactStage<D, Real>::list_slots() {
  lists_are_stale_ = false;
  std::vector<Index> slots, vertex;
  auto const add = [&](Index slot, Index at) { slots.push_back(slot), vertex.push_back(at); };
  auto const corners_of = [&](Index slot, Index e) {
    for (Index a = 0; a < C; ++a) add(slot + a, model_.vertex_of(e, a));
  };
  for (Index const place : pressing_.places()) {
    Index const slot = pair_.first_slot + place * 2 * C;
    corners_of(slot, pair_.pairs[place].a), corners_of(slot + C, pair_.pairs[place].b);
  }
  for (auto const* kind : {&plate_, &wall_})
    for (Index k = 0; k < kind->count; ++k) corners_of(kind->first_slot + k * C, kind->pairs[k].a);
  Index slot = crack_slot_;
  std::vector<kernels::CrackFace<D, Real>> copy;
  for (auto const& crack : cracks_.look(copy))
    for (FaceId const side : {FaceId{crack.element, crack.face}, FaceId{crack.other, crack.other_face}})
      for (int i = 0; i < D; ++i) add(slot++, model_.face_vertex(side, i));
  slots_.list(device_, slots, vertex, model_.vertices.count);
  tell_room();
}

template <int D, class Real>
void ContactStage<D, Real>::add_forces(double t, double last_dt, double dt) {
  last_dt_ = last_dt;
  if (!model_.plan.contact() && cracks_.empty() && new_cracks_.empty()) return;
  bool const left = some_left_;
  if (left) drop_removed();
  if (!cracks_.empty() && news_.download_one(0) != 0) release_cracks();
  if (model_.plan.contact() && age_.lists() == 0) make_list(true);  // so that it is known how fast things are
  if (model_.plan.contact() && (age_.advance(device_, model_, rigid_, t, last_dt, dt) || left))
    make_list(true);
  else if (model_.plan.contact() && stale_ && age_.since_extension() > 10)
    make_list(false);
  else if (near_.stale(age_.path()))
    near_.note(pair_), watch(watch_window());
  if (slots_are_stale_)
    place_slots();
  else if (!new_cracks_.empty())
    place_cracks();
  if (slots_.empty()) {
    for (auto* forces : {&rigid_.plate_forces(), &rigid_.wall_forces()})
      std::fill(forces->begin(), forces->end(), Vec3(0, 0, 0));
    excess_ = 0;
    return;
  }

  if (pair_.count > 0) press_pairs(last_dt);
  if (plate_.count > 0)  // with their speed on the way here
    press_on(plate_, rigid_.place_boxes(t - 0.5 * last_dt), laws_.plates(), last_dt);
  if (wall_.count > 0) press_on(wall_, rigid_.planes(), laws_.walls(), last_dt);
  if (!cracks_.empty()) press_cracks(last_dt);
  if (lists_are_stale_) list_slots();
  excess_ = slots_.add(device_, model_);
  book(t, last_dt);
}

/// visit(element, force on it [N]) for every contact of one body with another.
template <int D, class Real>
template <class Visit>
void ContactStage<D, Real>::between(int body, int other, Visit&& visit) const {
  if (slots_.empty()) return;
  auto const force = slots_.forces();
  auto const see = [&](Index e, Index partner, Index slot, int corners) {
    if (model_.elements.body[e] != body || model_.elements.body[partner] != other) return;
    Vec<double, D> sum = Vec<double, D>::Zero();
    for (int k = 0; k < corners; ++k)
      for (int c = 0; c < D; ++c) sum[c] += static_cast<double>(force[static_cast<std::size_t>(slot + k) * D + c]);
    visit(e, sum);
  };
  Index slot = pair_.first_slot;
  for (auto const& pair : pair_.pairs) {
    see(pair.a, pair.b, slot, C), see(pair.b, pair.a, slot + C, C);
    slot += 2 * C;
  }
  slot = crack_slot_;
  for (auto const& crack : cracks_.download()) {
    see(crack.element, crack.other, slot, D), see(crack.other, crack.element, slot + D, D);
    slot += 2 * D;
  }
}

template <int D, class Real>
Vec3 ContactStage<D, Real>::force_between(int body, int other) const {
  Vec3 sum(0, 0, 0);
  between(body, other, [&](Index, Vec<double, D> const& force) {
    for (int c = 0; c < D; ++c) sum[c] += force[c];
  });
  return sum;
}

template <int D, class Real>
scene::Touch ContactStage<D, Real>::touch(int body, int other) const {
  std::map<Index, Vec<double, D>> pushed;
  between(body, other, [&](Index e, Vec<double, D> const& force) {
    if (force.squaredNorm() > 0) pushed.try_emplace(e, Vec<double, D>::Zero()).first->second += force;
  });
  if (pushed.empty()) return {};
  auto const& skin = skins_.try_emplace(body, model_, body).first->second;
  return skin.pressed(pushed, model_.vertices.u.download());
}

template <int D, class Real>
void ContactStage<D, Real>::press_pairs(double last_dt) {
  Real* const force = slots_.force(pair_.first_slot);
  Real* const stiffness = slots_.stiffness(pair_.first_slot);
  looked_at_ = std::lround(count_pairs()[0]);  // before those with a gap sleep on
  for_each(device_, 0, pair_.count,
           kernels::PairForces<D, Real>{.mesh = model_.view(),
                                        .table = laws_.pairs(),
                                        .count = pair_.count,
                                        .pair = pair_.list.data(),
                                        .spring = pair_.spring.data(),
                                        .force = force,
                                        .stiffness = stiffness,
                                        .weight = groups_.weight(),
                                        .work = pair_.work.data(),
                                        .penetration = pair_.penetration.data(),
                                        .path = age_.path(),
                                        .wake = pair_.wake.data(),
                                        .axis = pair_.axis.data(),
                                        .held = last_dt > 0 ? nullptr : pair_.held.data(),
                                        .fault = model_.flags.data(),
                                        .listed = pressing_.listed(),
                                        .news = pressing_.news()});
  if (pressing_.stale()) list_pressing();
  if (!laws_.rubs()) return;
  for_each(device_, 0, groups_.count(),
           kernels::SumGroups<D, Real>{
               .first = groups_.first(), .slot = groups_.slot(), .slot_force = force, .sum = groups_.force()});
  for_each(device_, 0, pressing_.count(),
           kernels::PairFriction<D, Real>{.mesh = model_.view(),
                                          .table = laws_.pairs(),
                                          .dt = static_cast<Real>(last_dt),
                                          .pair = pair_.list.data(),
                                          .spring = pair_.spring.data(),
                                          .force = force,
                                          .stiffness = stiffness,
                                          .weight = groups_.weight(),
                                          .work = pair_.work.data(),
                                          .penetration = pair_.penetration.data(),
                                          .listed = pressing_.list(),
                                          .group = groups_.of_corner(),
                                          .pressure = groups_.force()});
}

/// Some press that did not since others are watched.
template <int D, class Real>
void ContactStage<D, Real>::list_pressing() {
  pressing_.renew(device_, pair_);
  lists_are_stale_ = true;
  if (!laws_.rubs()) return;
  if (model_.plan.joints) bonds_.connect();
  groups_.find(device_, model_, bonds_, pair_.pairs, pressing_.places());
}

/// Elements and rigid bodies of one kind.
template <int D, class Real>
template <class Body>
void ContactStage<D, Real>::press_on(Candidates<D, Real>& kind, Body const* body, kernels::ContactTable const& table,
                                     double last_dt) {
  for_each(device_, 0, kind.count,
           kernels::RigidForces<D, Real, Body>{.mesh = model_.view(),
                                               .table = table,
                                               .body = body,
                                               .dt = static_cast<Real>(last_dt),
                                               .candidate = kind.list.data(),
                                               .spring = kind.spring.data(),
                                               .force = slots_.force(kind.first_slot),
                                               .reaction = kind.reaction.data(),
                                               .stiffness = slots_.stiffness(kind.first_slot),
                                               .work = kind.work.data(),
                                               .penetration = kind.penetration.data(),
                                               .held = last_dt > 0 ? nullptr : kind.held.data(),
                                               .fault = model_.flags.data()});
}

template <int D, class Real>
void ContactStage<D, Real>::press_cracks(double last_dt) {
  for_each(device_, 0, static_cast<Index>(cracks_.size()),
           kernels::CrackForces<D, Real>{.mesh = model_.view(),
                                         .table = laws_.pairs(),
                                         .dt = static_cast<Real>(last_dt),
                                         .pairs = model_.plan.pairs,
                                         .faces = cracks_.data(),
                                         .force = slots_.force(crack_slot_),
                                         .stiffness = slots_.stiffness(crack_slot_),
                                         .work = crack_work_.data(),
                                         .news = news_.data()});
}

/// Energies, reactions and the deepest contact; of each work the half that belongs to the step that led here.
template <int D, class Real>
void ContactStage<D, Real>::book(double t, double last_dt) {
  work_.on_vertices += slots_.work(device_, model_, 0.5 * last_dt);
  for (auto* kind : {&pair_, &plate_, &wall_}) {
    if (kind->count == 0) continue;
    work_.friction += sum_over<1>(device_, 0, kind->count, kernels::SumOf<Real>{kind->work.data()})[0];
    deepest_ = std::max(
        deepest_, largest_over<1>(device_, 0, kind->count, kernels::LargestOf<Real>{kind->penetration.data()})[0]);
  }
  if (!cracks_.empty())
    work_.friction +=
        sum_over<1>(device_, 0, static_cast<Index>(cracks_.size()), kernels::SumOf<Real>{crack_work_.data()})[0];
  auto const react = [&](Candidates<D, Real>& kind, std::vector<Vec3>& forces) {
    for (std::size_t b = 0; b < forces.size(); ++b) {
      auto const sum =
          sum_over<D>(device_, 0, kind.count,
                      kernels::Reaction<D, Real>{kind.list.data(), kind.reaction.data(), static_cast<Index>(b)});
      for (int c = 0; c < D; ++c) forces[b][c] = sum[c];
    }
  };
  react(plate_, rigid_.plate_forces());
  react(wall_, rigid_.wall_forces());
  auto const& on_plates = rigid_.plate_forces();
  for (std::size_t p = 0; p < on_plates.size(); ++p) {
    auto const v = rigid_.velocity(static_cast<int>(p), t - 0.5 * last_dt);
    for (int c = 0; c < D; ++c) work_.by_plates -= 0.5 * last_dt * on_plates[p][c] * v[c];
  }
}

template <int D, class Real>
void ContactStage<D, Real>::begin() {
  for (auto* kind : {&pair_, &plate_, &wall_})
    if (kind->count > 0)
      work_.given += sum_over<1>(device_, 0, kind->count, kernels::SumOf<Real>{kind->held.data()})[0];
}

template <int D, class Real>
ContactCounts ContactStage<D, Real>::counts() const {
  auto const pairs = static_cast<long>(near_.all().size());
  if (pair_.count == 0) return {pairs, 0, 0, age_.lists()};
  return {pairs, looked_at_, std::lround(count_pairs()[1]), age_.lists()};
}

/// Of those that are watched: how many are awake, how many touched when they were looked at last.
template <int D, class Real>
Sums<2> ContactStage<D, Real>::count_pairs() const {
  return sum_over<2>(device_, 0, pair_.count,
                     kernels::CountPairs<Real>{pair_.wake.data(), pair_.penetration.data(), age_.path()});
}

template <int D, class Real>
void ContactStage<D, Real>::finish_step(double t, double dt, double share) {
  rigid_.push(t, 0.5 * (last_dt_ + dt));
  if (!slots_.empty()) work_.on_vertices += slots_.work(device_, model_, share * dt);
  if (plate_.count > 0) {
    work_.by_plates +=
        sum_over<1>(device_, 0, plate_.count,
                    kernels::PlateWork<D, Real>{model_.view(), rigid_.place_boxes(t + 0.5 * dt), share * dt,
                                                plate_.list.data(), plate_.spring.data(), plate_.reaction.data(),
                                                slots_.stiffness(plate_.first_slot)})[0];
  }
  rigid_.move(t, dt);
}

template <int D, class Real>
void ContactStage<D, Real>::save(State& state) const {
  auto const put = [&](char const* name, auto const& values) { state[name] = state_bytes(values); };
  bonds_.save(state), rigid_.save(state), age_.save(state), pressing_.save(state), groups_.save(state);
  pair_.save(state, "pair"), plate_.save(state, "plate"), wall_.save(state, "wall");
  near_.save(state, pair_);
  auto cracks = cracks_.download();
  cracks.insert(cracks.end(), new_cracks_.begin(), new_cracks_.end());
  put("cracks", cracks);
  put("contact counts", std::vector<long>{static_cast<long>(cracks_.size()), stale_,
                                          news_.empty() ? 0 : news_.download_one(0), beds_.list, some_left_});
  put("contact numbers", std::vector<double>{excess_, deepest_, light_plate_});
  put("contact beds", beds_.flat());
  put("contact work", std::vector<ContactWork>{work_});
}

template <int D, class Real>
void ContactStage<D, Real>::restore(State const& state) {
  auto const elements = static_cast<std::size_t>(model_.elements.count),
             vertices = static_cast<std::size_t>(model_.vertices.count);
  bonds_.restore(state), rigid_.restore(state), age_.restore(device_, state, vertices, scene_.plates.size());
  pair_.restore(device_, state, "pair", elements, elements);
  near_.restore(state, elements, pair_);
  plate_.restore(device_, state, "plate", elements, scene_.plates.size());
  wall_.restore(device_, state, "wall", elements, scene_.walls.size());
  new_cracks_ = state_values<kernels::CrackFace<D, Real>>(state, "cracks");
  cracks_ = {}, crack_work_ = {};  // they join them below
  for (auto const& crack : new_cracks_) {
    check_index("cracks", crack.element, elements), check_index("cracks", crack.other, elements);
    check_index("cracks", crack.face, C), check_index("cracks", crack.other_face, C);
  }
  auto const counts = state_values<long>(state, "contact counts", 5);
  stale_ = counts[1] != 0;
  if (!news_.empty()) news_.upload_one(0, static_cast<int>(counts[2]));
  auto const numbers = state_values<double>(state, "contact numbers", 3);
  excess_ = numbers[0], deepest_ = numbers[1];
  work_ = state_values<ContactWork>(state, "contact work", 1)[0];
  // Faces that broke in the last step before the checkpoint join the others only now, as they did in the run that wrote
  // it.
  check_index("contact counts", counts[0], new_cracks_.size() + 1);
  auto const old = new_cracks_.begin() + counts[0];
  std::vector<kernels::CrackFace<D, Real>> const late(old, new_cracks_.end());
  new_cracks_.erase(old, new_cracks_.end());
  join_cracks();
  if (model_.plan.contact() || model_.plan.joints) place_slots();
  new_cracks_ = late;
  beds_are_stale_ = false;
  pressing_.restore(device_, state, pair_.pairs.size());
  groups_.restore(device_, state, laws_.rubs() ? pair_.pairs.size() : 0, pressing_.places(), elements);
  // Faces were as they stood when the list was made.
  auto const beds = state_values<double>(state, "contact beds");
  if (beds.size() % SpringBeds<D>::numbers_each != 0)
    throw Error("the checkpoint's contacts are of another scene or mesh");
  beds_.set_flat(beds);
  for (auto const& bed : beds_.faces)
    for (Index const vertex : bed.vertex) check_index("contact beds", vertex, vertices);
  beds_.list = counts[3], light_plate_ = numbers[2];
  some_left_ = counts[4] != 0;
  pair_.restore_penetration(state, "pair");
  plate_.restore_penetration(state, "plate");
  wall_.restore_penetration(state, "wall");
}

}  // namespace fissure
