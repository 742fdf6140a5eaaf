// Contact as a stage of the step; instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <numeric>

#include "solver/bonds.impl.h"
#include "solver/contact_groups.impl.h"
#include "solver/crack_faces.impl.h"
#include "solver/spring_beds.impl.h"

namespace fissure {

namespace contact {

/// The material's contact law; without one, a penalty of E' (the stiffness of the body itself) and no friction.
inline laws::ContactLaw law_of(scene::Material const& material) {
  if (material.contact) return *material.contact;
  return {std::visit([](auto const& law) { return law.confined(); }, material.bulk), 0};
}

/// Laws of rigid bodies against materials, [body][material]: a body without a law of its own takes the material's.
template <class Rigid>
std::vector<laws::ContactLaw> rigid_laws(std::vector<Rigid> const& bodies,
                                         std::vector<scene::Material> const& materials) {
  std::vector<laws::ContactLaw> laws;
  for (auto const& body : bodies)
    for (auto const& material : materials) {
      auto const own = law_of(material);
      laws.push_back(body.contact ? laws::ContactLaw::between(*body.contact, own) : own);
    }
  return laws;
}

}  // namespace contact

template <int D, class Real>
ContactStage<D, Real>::ContactStage(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh,
                                    model::Model<D, Real>& model)
    : device_(device), scene_(scene), model_(model), bonds_(mesh, model), rigid_(device, scene, model.origin) {
  if (!model.plan.contact() && !model.plan.joints) return;
  auto const quality = mesh::quality(mesh);
  reach_ = std::numeric_limits<double>::infinity();
  // paper, sec. 2.3.1: a fifth of an element
  for (auto const& body : quality) reach_ = std::min(reach_, 0.2 * body.mean_edge);
  buffer_ = least_buffer * reach_;

  using Number = kernels::ContactTable::Number;
  if (std::size_t const most = std::numeric_limits<Number>::max() + std::size_t(1); scene.materials.size() > most)
    throw Error(fmt::format("{}: there are {} materials (contact can tell {} apart); let bodies share them", scene.file,
                            scene.materials.size(), most));
  std::vector<Number> law(model.elements.count, 0);
  for (Index e = 0; e < model.elements.count; ++e)
    if (model.elements.body[e] >= 0) law[e] = static_cast<Number>(scene.bodies[model.elements.body[e]].material);
  std::vector<laws::ContactLaw> between;
  for (auto const& a : scene.materials)
    for (auto const& b : scene.materials)
      between.push_back(laws::ContactLaw::between(contact::law_of(a), contact::law_of(b)));
  rubs_ = std::any_of(between.begin(), between.end(), [](laws::ContactLaw const& one) { return one.friction > 0; });
  law_ = Buffer<Number>(device, "contact laws", law);
  between_ = Buffer<laws::ContactLaw>(device, "contact laws", between);
  plate_between_ = Buffer<laws::ContactLaw>(device, "contact laws", contact::rigid_laws(scene.plates, scene.materials));
  wall_between_ = Buffer<laws::ContactLaw>(device, "contact laws", contact::rigid_laws(scene.walls, scene.materials));
  news_ = Buffer<int>(device, "contact flags", 1);
}

/// Something has moved by the buffer relative to something else since the list was built, or will have with the next
/// step: what touches then must be on the list now, for it to limit that step.
template <int D, class Real>
bool ContactStage<D, Real>::list_is_stale(double t, double dt, double next) {
  ++since_build_, ++since_extension_;
  if (drifting_.empty()) return false;
  auto moved = largest_over<4 * D>(device_, 0, static_cast<Index>(drifting_.size()),
                                   kernels::DriftSince<D, Real>{drifting_.data(), drift_start_.data(),
                                                                model_.vertices.u.data(), model_.vertices.v.data()});
  double speed_squared = 0;
  for (int c = 0; c < D; ++c) speed_squared += std::pow(moved[2 * D + c] + moved[3 * D + c], 2);
  path_ += dt * std::sqrt(speed_squared);
  for (int c = 0; c < D; ++c) middle_drift_[c] = 0.5 * (moved[D + c] - moved[c]);
  // By axis: the largest of -x and of x, for drift and for velocity.
  auto const include = [&](int c, double by, double v) {
    moved[c] = std::max(moved[c], -by), moved[D + c] = std::max(moved[D + c], by);
    moved[2 * D + c] = std::max(moved[2 * D + c], -v), moved[3 * D + c] = std::max(moved[3 * D + c], v);
  };
  for (std::size_t p = 0; p < scene_.plates.size(); ++p) {
    auto const v = rigid_.velocity(static_cast<int>(p), t);
    for (int c = 0; c < D; ++c) include(c, rigid_.displacements()[p][c] - displacement_at_build_[p][c], v[c]);
  }
  bool stale = false;
  ahead_ = 0;
  for (int c = 0; c < D; ++c) {
    if (!scene_.walls.empty()) include(c, 0, 0);
    double const ahead = next * (moved[2 * D + c] + moved[3 * D + c]);
    ahead_ = std::max(ahead_, ahead);
    stale = stale || moved[c] + moved[D + c] + ahead > buffer_;
  }
  return stale;
}

template <int D, class Real>
void ContactStage<D, Real>::prepare(Candidates& kind, std::vector<solver::ElementPair> const& pairs,
                                    std::vector<Real> const& springs, bool rigid) {
  kind.count = static_cast<Index>(pairs.size());
  std::vector<Index> list;
  list.reserve(2 * pairs.size());
  for (auto const& pair : pairs) list.push_back(pair.a), list.push_back(pair.b);
  kind.list = Buffer<Index>(device_, "contact candidates", list);
  kind.spring = Buffer<Real>(device_, "contact springs", springs);
  kind.work = Buffer<Real>(device_, "contact springs", pairs.size());
  kind.penetration = Buffer<Real>(device_, "contact springs", pairs.size());
  kind.wake = Buffer<double>(device_, "contact candidates", rigid ? 0 : pairs.size());
  kind.axis = Buffer<std::uint8_t>(device_, "contact candidates",
                                   std::vector<std::uint8_t>(rigid ? 0 : pairs.size(), kernels::no_axis));
  kind.reaction = Buffer<Real>(device_, "contact springs", rigid ? pairs.size() * D : 0);
  kind.held = Buffer<Real>(device_, "contact springs", pairs.size());
}

template <int D, class Real>
void ContactStage<D, Real>::rebuild(bool everything) {
  if (everything) {
    // As wide as what moves in some hundred steps: a wide buffer means many candidates, a narrow one many lists.
    if (since_build_ > 0)
      buffer_ = std::clamp(steps_per_list * path_ / static_cast<double>(since_build_), least_buffer * reach_, reach_);
    buffer_ = std::max(buffer_, 4 * ahead_);
    ++rebuilds_;
    since_build_ = 0;
    path_ = 0;
  }
  // Pairs that join a list that has drifted already must look as far again.
  double const buffer = everything ? buffer_ : 2 * buffer_;
  since_extension_ = 0;
  stale_ = false;
  active_.clear();
  for (Index e = 0; e < model_.elements.count; ++e)
    if (bonds_.exposed(e)) active_.push_back(e);

  auto const u = model_.vertices.u.look(u_copy_);
  std::vector<solver::Bounds<D>> bounds(active_.size());
  std::vector<Index> vertices;
  for (std::size_t k = 0; k < active_.size(); ++k) {
    bounds[k].low.fill(std::numeric_limits<double>::infinity());
    bounds[k].high.fill(-std::numeric_limits<double>::infinity());
    for (int a = 0; a < C; ++a) {
      Index const vertex = model_.vertex_of(active_[k], a);
      vertices.push_back(vertex);
      for (int c = 0; c < D; ++c) {
        double const x =
            model_.vertices.reference[vertex][c] + static_cast<double>(u[static_cast<std::size_t>(vertex) * D + c]);
        bounds[k].low[c] = std::min(bounds[k].low[c], x - 0.5 * buffer);
        bounds[k].high[c] = std::max(bounds[k].high[c], x + 0.5 * buffer);
      }
    }
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  if (everything) {
    std::vector<Real> start;
    for (Index vertex : vertices)
      for (int c = 0; c < D; ++c) start.push_back(u[static_cast<std::size_t>(vertex) * D + c]);
    drifting_ = Buffer<Index>(device_, "contact drift", vertices);
    drift_start_ = Buffer<Real>(device_, "contact drift", start);
    displacement_at_build_ = rigid_.displacements();
  } else {
    extend_drift(vertices, u);
  }

  auto const of_elements = [&](std::vector<solver::ElementPair> found) {
    for (auto& pair : found) pair.a = active_[pair.a];
    return found;
  };
  auto const renew = [&](Candidates& kind, std::vector<solver::ElementPair>& old,
                         std::vector<solver::ElementPair> found, bool rigid) {
    // What flew apart faster than the buffer stays until its friction spring has let go.
    auto const springs = kind.spring.download();
    std::vector<solver::ElementPair> all, holding;
    for (std::size_t k = 0; k < old.size(); ++k)
      if (springs[k * kernels::spring_size<D> + D] > 0) holding.push_back(old[k]);
    std::set_union(found.begin(), found.end(), holding.begin(), holding.end(), std::back_inserter(all));
    found = std::move(all);
    prepare(kind, found, solver::carry_springs<Real>(kernels::spring_size<D>, old, springs, found), rigid);
    old = std::move(found);
  };
  if (model_.plan.pairs) {
    if (model_.plan.joints) bonds_.connect();
    facing_.clear();
    std::vector<kernels::CrackFace<D, Real>> copy;
    for (auto const& crack : cracks_.look(copy)) facing_.push_back(cells_of(crack));
    for (auto const& crack : new_cracks_) facing_.push_back(cells_of(crack));
    std::sort(facing_.begin(), facing_.end());
    auto const placed = [&](Index e) {
      kernels::Simplex<D, double> simplex;
      for (int a = 0; a <= D; ++a) {
        Index const vertex = model_.vertex_of(e, a);
        for (int c = 0; c < D; ++c)
          simplex.x[a][c] =
              model_.vertices.reference[vertex][c] + static_cast<double>(u[static_cast<std::size_t>(vertex) * D + c]);
      }
      return simplex;
    };
    // Two boxes that touch may hold simplices far from each other: the widest gap that boxes, faces or edges show
    // tells. Until the list is made anew, no axis brings them nearer than by the buffer.
    auto const near = [&](Index a, Index b) {
      auto one = placed(a), other = placed(b);
      int axis = 0;
      double gap = kernels::box_gap(one, other, axis);
      Mat<double, D + 1> inside;
      if (one.differentiate() && other.differentiate())
        gap = std::max({gap, kernels::face_gap(one, other, inside, axis), kernels::face_gap(other, one, inside, axis),
                        Clip<D>::edge_gap(one.x, other.x, axis)});
      return gap <= std::sqrt(D) * buffer;
    };
    std::vector<char> wanted(active_.size(), 1);
    for (std::size_t k = 0; k < active_.size() && !everything; ++k) wanted[k] = bonds_.changed(active_[k]);
    std::vector<solver::ElementPair> found;
    for (auto const& pair : solver::overlapping_pairs<D>(bounds, wanted)) {
      Index const a = active_[pair.a], b = active_[pair.b];
      if (may_touch(a, b) && near(a, b)) found.push_back({a, b});
    }
    if (!everything) {
      std::vector<solver::ElementPair> both;
      std::set_union(found.begin(), found.end(), pairs_.begin(), pairs_.end(), std::back_inserter(both));
      found = std::move(both);
    }
    renew(pair_, pairs_, std::move(found), false);
    group_slots();
  }
  if (model_.plan.plates) {
    std::vector<solver::Bounds<D>> plates;
    for (auto const& box : rigid_.boxes_at(0)) {
      solver::Bounds<D> bound;
      for (int c = 0; c < D; ++c) {
        bound.low[c] = static_cast<double>(box.low[c]) + static_cast<double>(box.displacement[c]) - 0.5 * buffer;
        bound.high[c] = static_cast<double>(box.high[c]) + static_cast<double>(box.displacement[c]) + 0.5 * buffer;
      }
      plates.push_back(bound);
    }
    renew(plate_, plate_candidates_, of_elements(solver::pairs_with_boxes<D>(bounds, plates)), true);
  }
  if (model_.plan.walls) {
    std::vector<Vec<double, D>> points, normals;
    for (auto const& plane : rigid_.host_planes()) {
      points.push_back(plane.point.template cast<double>());
      normals.push_back(plane.normal.template cast<double>());
    }
    renew(wall_, wall_candidates_, of_elements(solver::pairs_with_planes<D>(bounds, points, normals, 0.5 * buffer)),
          true);
  }
  bonds_.forget_changes();
  slots_are_stale_ = true;
}

/// Vertices that join the list start in the middle of the drift of the others: what these have moved since the list was
/// built is none of theirs.
template <int D, class Real>
void ContactStage<D, Real>::extend_drift(std::vector<Index> const& vertices, std::span<Real const> u) {
  auto known = drifting_.download();
  auto start = drift_start_.download();
  std::vector<Index> joining;
  std::vector<Index> sorted = known;
  std::sort(sorted.begin(), sorted.end());
  std::set_difference(vertices.begin(), vertices.end(), sorted.begin(), sorted.end(), std::back_inserter(joining));
  if (joining.empty()) return;
  for (Index vertex : joining) {
    known.push_back(vertex);
    for (int c = 0; c < D; ++c)
      start.push_back(static_cast<Real>(u[static_cast<std::size_t>(vertex) * D + c] - middle_drift_[c]));
  }
  drifting_ = Buffer<Index>(device_, "contact drift", known);
  drift_start_ = Buffer<Real>(device_, "contact drift", start);
}

/// Every candidate owns force slots; every touched vertex knows its slots, in order.
template <int D, class Real>
void ContactStage<D, Real>::place_slots() {
  slots_are_stale_ = false;
  if (!new_cracks_.empty()) {
    auto all = cracks_.download();
    all.insert(all.end(), new_cracks_.begin(), new_cracks_.end());
    new_cracks_.clear();
    cracks_ = Buffer<kernels::CrackFace<D, Real>>(device_, "crack faces", all);
    crack_work_ = Buffer<Real>(device_, "crack faces", all.size());
  }
  std::vector<Index> vertex_of_slot;
  auto const corners_of = [&](Index e) {
    for (int a = 0; a < C; ++a) vertex_of_slot.push_back(model_.vertex_of(e, a));
  };
  auto const next = [&] { return static_cast<Index>(vertex_of_slot.size()); };
  pair_.first_slot = next();
  for (auto const& pair : pairs_) corners_of(pair.a), corners_of(pair.b);
  plate_.first_slot = next();
  for (auto const& pair : plate_candidates_) corners_of(pair.a);
  wall_.first_slot = next();
  for (auto const& pair : wall_candidates_) corners_of(pair.a);
  crack_slot_ = next();
  for (auto const& crack : cracks_.download())
    for (FaceId const side : {FaceId{crack.element, crack.face}, FaceId{crack.other, crack.other_face}})
      for (int i = 0; i < D; ++i) vertex_of_slot.push_back(model_.face_vertex(side, i));
  slots_.place(device_, std::move(vertex_of_slot), model_.vertices.count);
  // A candidate that does not touch and did not before is left alone, so what it left behind must go.
  for (auto* kind : {&pair_, &plate_, &wall_}) {
    kind->penetration.upload(std::vector<Real>(kind->count, Real(0)));
    kind->work.upload(std::vector<Real>(kind->count, Real(0)));
    kind->reaction.upload(std::vector<Real>(kind->reaction.size(), Real(0)));
    kind->held.upload(std::vector<Real>(kind->held.size(), Real(0)));
  }
  place_beds();
}

template <int D, class Real>
void ContactStage<D, Real>::add_forces(double t, double dt, double next) {
  if (!model_.plan.contact() && cracks_.empty() && new_cracks_.empty()) return;
  if (!cracks_.empty() && news_.download_one(0) != 0) release_cracks();
  if (model_.plan.contact() && rebuilds_ == 0) rebuild(true);  // so that it is known how fast things are
  if (model_.plan.contact() && list_is_stale(t, dt, next))
    rebuild(true);
  else if (model_.plan.contact() && stale_ && since_extension_ > 10)
    rebuild(false);
  if (slots_are_stale_) place_slots();
  if (slots_.empty()) {
    for (auto* forces : {&rigid_.plate_forces(), &rigid_.wall_forces()})
      std::fill(forces->begin(), forces->end(), Vec3(0, 0, 0));
    excess_ = 0;
    return;
  }

  if (pair_.count > 0) press_pairs(dt);
  if (plate_.count > 0)  // with their speed on the way here
    press_on(plate_, rigid_.place_boxes(t - 0.5 * dt), plate_between_, dt);
  if (wall_.count > 0) press_on(wall_, rigid_.planes(), wall_between_, dt);
  if (!cracks_.empty()) press_cracks(dt);
  excess_ = slots_.add(device_, model_);
  book(t, dt);
}

template <int D, class Real>
kernels::ContactTable ContactStage<D, Real>::table(Buffer<laws::ContactLaw> const& between) const {
  return {.law = law_.data(), .between = between.data(), .n_laws = static_cast<Index>(scene_.materials.size())};
}

template <int D, class Real>
void ContactStage<D, Real>::press_pairs(double dt) {
  Real* const force = slots_.force(pair_.first_slot);
  Real* const stiffness = slots_.stiffness(pair_.first_slot);
  for_each(device_, 0, pair_.count,
           kernels::PairForces<D, Real>{.mesh = model_.view(),
                                        .table = table(between_),
                                        .pair = pair_.list.data(),
                                        .spring = pair_.spring.data(),
                                        .force = force,
                                        .stiffness = stiffness,
                                        .weight = pair_weight_.data(),
                                        .work = pair_.work.data(),
                                        .penetration = pair_.penetration.data(),
                                        .path = path_,
                                        .wake = pair_.wake.data(),
                                        .axis = pair_.axis.data(),
                                        .held = dt > 0 ? nullptr : pair_.held.data(),
                                        .fault = model_.flags.data()});
  if (!rubs_) return;
  for_each(
      device_, 0, static_cast<Index>(group_force_.size() / D),
      kernels::SumGroups<D, Real>{
          .first = group_first_.data(), .slot = group_slot_.data(), .slot_force = force, .sum = group_force_.data()});
  for_each(device_, 0, pair_.count,
           kernels::PairFriction<D, Real>{.mesh = model_.view(),
                                          .table = table(between_),
                                          .dt = static_cast<Real>(dt),
                                          .pair = pair_.list.data(),
                                          .spring = pair_.spring.data(),
                                          .force = force,
                                          .stiffness = stiffness,
                                          .weight = pair_weight_.data(),
                                          .work = pair_.work.data(),
                                          .penetration = pair_.penetration.data(),
                                          .group = group_.data(),
                                          .pressure = group_force_.data()});
}

/// Elements and rigid bodies of one kind.
template <int D, class Real>
template <class Body>
void ContactStage<D, Real>::press_on(Candidates& kind, Body const* body, Buffer<laws::ContactLaw> const& between,
                                     double dt) {
  for_each(device_, 0, kind.count,
           kernels::RigidForces<D, Real, Body>{.mesh = model_.view(),
                                               .table = table(between),
                                               .body = body,
                                               .dt = static_cast<Real>(dt),
                                               .candidate = kind.list.data(),
                                               .spring = kind.spring.data(),
                                               .force = slots_.force(kind.first_slot),
                                               .reaction = kind.reaction.data(),
                                               .stiffness = slots_.stiffness(kind.first_slot),
                                               .work = kind.work.data(),
                                               .penetration = kind.penetration.data(),
                                               .held = dt > 0 ? nullptr : kind.held.data(),
                                               .fault = model_.flags.data()});
}

template <int D, class Real>
void ContactStage<D, Real>::press_cracks(double dt) {
  for_each(device_, 0, static_cast<Index>(cracks_.size()),
           kernels::CrackForces<D, Real>{.mesh = model_.view(),
                                         .table = table(between_),
                                         .dt = static_cast<Real>(dt),
                                         .pairs = model_.plan.pairs,
                                         .faces = cracks_.data(),
                                         .force = slots_.force(crack_slot_),
                                         .stiffness = slots_.stiffness(crack_slot_),
                                         .work = crack_work_.data(),
                                         .news = news_.data()});
}

/// Energies, reactions and the deepest contact; of each work the half that belongs to the step that led here.
template <int D, class Real>
void ContactStage<D, Real>::book(double t, double dt) {
  work_.on_vertices += slots_.work(device_, model_, 0.5 * dt);
  for (auto* kind : {&pair_, &plate_, &wall_}) {
    if (kind->count == 0) continue;
    work_.friction += sum_over<1>(device_, 0, kind->count, kernels::SumOf<Real>{kind->work.data()})[0];
    deepest_ = std::max(
        deepest_, largest_over<1>(device_, 0, kind->count, kernels::LargestOf<Real>{kind->penetration.data()})[0]);
  }
  if (!cracks_.empty())
    work_.friction +=
        sum_over<1>(device_, 0, static_cast<Index>(cracks_.size()), kernels::SumOf<Real>{crack_work_.data()})[0];
  auto const react = [&](Candidates& kind, std::vector<Vec3>& forces) {
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
    auto const v = rigid_.velocity(static_cast<int>(p), t - 0.5 * dt);
    for (int c = 0; c < D; ++c) work_.by_plates -= 0.5 * dt * on_plates[p][c] * v[c];
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
  ContactCounts counts{pair_.count, 0, 0, rebuilds_};
  if (pair_.count == 0) return counts;
  auto const sums = sum_over<2>(device_, 0, pair_.count,
                                kernels::CountPairs<Real>{pair_.wake.data(), pair_.penetration.data(), path_});
  counts.looked_at = std::lround(sums[0]), counts.touching = std::lround(sums[1]);
  return counts;
}

template <int D, class Real>
void ContactStage<D, Real>::finish_step(double t, double dt, double share) {
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
  bonds_.save(state);
  rigid_.save(state);
  put("contact pairs", pairs_), put("contact plates", plate_candidates_), put("contact walls", wall_candidates_);
  for (auto const& [name, kind] : {std::pair{"pair", &pair_}, {"plate", &plate_}, {"wall", &wall_}}) {
    state[std::string(name) + " springs"] = state_bytes(kind->spring.download());
    state[std::string(name) + " penetration"] = state_bytes(kind->penetration.download());
  }
  auto cracks = cracks_.download();
  cracks.insert(cracks.end(), new_cracks_.begin(), new_cracks_.end());
  put("cracks", cracks);
  put("cracks old", std::vector<long>{static_cast<long>(cracks_.size())});
  put("contact groups", group_of_slot_);
  put("drifting", drifting_.download()), put("drift start", drift_start_.download());
  put("plates at build", displacement_at_build_);
  put("contact counts",
      std::vector<long>{rebuilds_, since_build_, since_extension_, stale_, news_.empty() ? 0 : news_.download_one(0)});
  put("contact numbers", std::vector<double>{excess_, deepest_, buffer_, path_});
  put("contact beds", beds_.flat()), put("contact bed list", std::vector<long>{beds_.list});
  put("contact work", std::vector<ContactWork>{work_});
}

template <int D, class Real>
void ContactStage<D, Real>::restore(State const& state) {
  auto const get = [&](char const* name, auto& values) {
    values = state_values<typename std::remove_reference_t<decltype(values)>::value_type>(state, name);
  };
  bonds_.restore(state);
  rigid_.restore(state);
  get("contact pairs", pairs_), get("contact plates", plate_candidates_), get("contact walls", wall_candidates_);
  get("cracks", new_cracks_);
  auto const elements = static_cast<std::size_t>(model_.elements.count);
  for (auto const& [name, list, partners] : {std::tuple{"contact pairs", &pairs_, elements},
                                             {"contact plates", &plate_candidates_, scene_.plates.size()},
                                             {"contact walls", &wall_candidates_, scene_.walls.size()}})
    for (auto const& [element, partner] : *list)
      check_index(name, element, elements), check_index(name, partner, partners);
  for (auto const& crack : new_cracks_) {
    check_index("cracks", crack.element, elements), check_index("cracks", crack.other, elements);
    check_index("cracks", crack.face, C), check_index("cracks", crack.other_face, C);
  }
  auto const drifting = state_values<Index>(state, "drifting");
  for (Index const vertex : drifting) check_index("drifting", vertex, static_cast<std::size_t>(model_.vertices.count));
  get("plates at build", displacement_at_build_);
  auto const counts = state_values<long>(state, "contact counts");
  if (counts.size() != 5) throw Error("the checkpoint's contacts are of another scene or mesh");
  rebuilds_ = counts[0], since_build_ = counts[1], since_extension_ = counts[2], stale_ = counts[3] != 0;
  if (!news_.empty()) news_.upload_one(0, static_cast<int>(counts[4]));
  auto const numbers = state_values<double>(state, "contact numbers", 4);
  excess_ = numbers[0], deepest_ = numbers[1], buffer_ = numbers[2], path_ = numbers[3];
  work_ = state_values<ContactWork>(state, "contact work").at(0);
  drifting_ = Buffer<Index>(device_, "contact drift", drifting);
  drift_start_ = Buffer<Real>(device_, "contact drift", state_values<Real>(state, "drift start", drifting.size() * D));
  prepare(pair_, pairs_, state_values<Real>(state, "pair springs"), false);
  prepare(plate_, plate_candidates_, state_values<Real>(state, "plate springs"), true);
  prepare(wall_, wall_candidates_, state_values<Real>(state, "wall springs"), true);
  get("contact groups", group_of_slot_);
  if (group_of_slot_.size() != (rubs_ ? pairs_.size() * 2 * C : 0))
    throw Error("the checkpoint's contacts are of another scene or mesh");
  for (Index const group : group_of_slot_) check_index("contact groups", group, group_of_slot_.size());
  place_groups();
  // Faces that broke in the last step before the checkpoint join the others only now, as they did in the run that wrote
  // it.
  long const old_cracks = state_values<long>(state, "cracks old", 1)[0];
  check_index("cracks old", old_cracks, new_cracks_.size() + 1);
  auto const old = static_cast<std::size_t>(old_cracks);
  std::vector<kernels::CrackFace<D, Real>> const late(new_cracks_.begin() + static_cast<long>(old), new_cracks_.end());
  new_cracks_.resize(old);
  if (model_.plan.contact() || model_.plan.joints) place_slots();
  new_cracks_ = late;
  slots_are_stale_ = !late.empty();
  // Faces were as they stood when the list was made.
  auto const beds = state_values<double>(state, "contact beds");
  if (beds.size() % SpringBeds<D>::numbers_each != 0)
    throw Error("the checkpoint's contacts are of another scene or mesh");
  beds_.set_flat(beds);
  for (auto const& bed : beds_.faces)
    for (Index const vertex : bed.vertex)
      check_index("contact beds", vertex, static_cast<std::size_t>(model_.vertices.count));
  beds_.list = state_values<long>(state, "contact bed list", 1)[0];
  if (!slots_.empty()) expect();
  pair_.penetration.upload(state_values<Real>(state, "pair penetration"));
  plate_.penetration.upload(state_values<Real>(state, "plate penetration"));
  wall_.penetration.upload(state_values<Real>(state, "wall penetration"));
}

}  // namespace fissure
