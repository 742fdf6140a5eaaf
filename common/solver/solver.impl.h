// The step itself; instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "kernels/advance.h"
#include "kernels/loads.h"
#include "model/model.impl.h"
#include "solver/contact_stage.impl.h"
#include "solver/solver.h"

namespace fissure {

/// Adds the wall-clock time of a scope to a counter, when asked to.
class StageClock {
 public:
  StageClock(Device& device, bool on, double& sum) : device_(device), on_(on), sum_(sum) {
    if (on_) start_ = std::chrono::steady_clock::now();
  }
  ~StageClock() {
    if (!on_) return;
    device_.wait();
    sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  StageClock(StageClock const&) = delete;

 private:
  Device& device_;
  bool on_;
  double& sum_;
  std::chrono::steady_clock::time_point start_;
};

template <int D, class Real>
Solver<D, Real>::Solver(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh)
    : device_(device), scene_(scene), mesh_(mesh), model_(device, scene, mesh), contact_(device, scene, mesh, model_),
      hold_reaction_(scene.holds.size(), Vec3(0, 0, 0)) {
  number_shown();
  limit_step();
}

template <int D, class Real>
void Solver<D, Real>::evaluate() {
  if (patches_stale_) model_.place_patches(device_);  // not in the step that broke joints: its forces used the old ones
  patches_stale_ = false;
  if (started_ && (step_ >= refresh_ || squeezed())) limit_step();
  choose_step();
  ElementRun const run{scene_.two_d == "plane stress", last_dt_};
  {
    StageClock const clock(device_, time_stages, stage_times.elements);
    element_forces(device_, model_, scene_, run);
    if (model_.plan.shared)
      for_each(device_, 0, model_.n_vertices,
               kernels::SumCorners<D, Real>{model_.corner_force(), model_.corner_first.data(), model_.corner_list.data(), model_.vertex_force()});
    check_elements();
  }
  {
    StageClock const clock(device_, time_stages, stage_times.contact);
    contact_.add_forces(time_, last_dt_);
    if (model_.plan.joints) follow_joints();
    heed_contact();
  }
  {
    StageClock const clock(device_, time_stages, stage_times.loads);
    add_loads();
    stay_on_axis();
    hold_before();
  }
  if (!started_) {
    started_ = true;
    book();
    // Kinetic energy is that between the velocities before and behind this moment: what a hold took at once was there before it.
    ledger_.start = ledger_.kinetic + ledger_.elastic + ledger_.hourglass + ledger_.joint + ledger_.gravity - ledger_.external;
  }
}

template <int D, class Real>
void Solver<D, Real>::advance() {
  {
    StageClock const clock(device_, time_stages, stage_times.advance);
    if (model_.plan.mass_damping) {
      auto const sums = sum_over<3 + D>(device_, 0, model_.n_vertices, kernels::VertexEnergy<D, Real>{vertices()});
      ledger_.mass_damping += sums[1];
    }
    for_each(device_, 0, model_.n_vertices, kernels::Advance<D, Real>{vertices(), model_.plan.gravity});
  }
  StageClock const clock(device_, time_stages, stage_times.loads);
  // A load that is there at the start has pushed for half a step at half the velocity on average: so the balance closes exactly.
  double const share = last_dt_ > 0 ? 0.5 : 0.25;
  for (auto& set : model_.loads) {
    auto const value = load_value(set, time_);
    kernels::LoadWork<D, Real> work{set.list.data(), {}, model_.v.data(), share * limit_.dt};
    std::copy(value.begin(), value.end(), work.value);
    ledger_.external += sum_over<1>(device_, 0, static_cast<Index>(set.list.size()), work)[0];
  }
  contact_.finish_step(time_, limit_.dt);
  hold_after();
  last_dt_ = limit_.dt;
  time_ += limit_.dt;
  ++step_;
}

template <int D, class Real>
void Solver<D, Real>::step_back() {
  auto u = model_.u.download();
  auto const v = model_.v.download();
  for (std::size_t i = 0; i < u.size(); ++i) u[i] -= static_cast<Real>(last_dt_) * v[i];
  model_.u.upload(u);
}

template <int D, class Real>
kernels::VertexView<D, Real> Solver<D, Real>::vertices() {
  kernels::VertexView<D, Real> view{model_.u.data(), model_.v.data(), model_.vertex_force(), model_.inverse_mass.data(), {}, limit_.dt,
                                    0.5 * (last_dt_ + limit_.dt), scene_.run.mass_damping};
  for (int c = 0; c < D; ++c) view.gravity[c] = weight_per_mass(c);
  return view;
}

template <int D, class Real>
std::array<double, D> Solver<D, Real>::load_value(model::LoadSet<D, Real> const& set, double t) const {
  std::array<double, D> value{};
  for (int c = 0; c < D; ++c) {
    if (set.pressure >= 0)
      value[c] = scene_.pressures[set.pressure].value(t);
    else if (auto const& component = scene_.tractions[set.traction].value[c])
      value[c] = (*component)(t);
  }
  return value;
}

template <int D, class Real>
void Solver<D, Real>::add_loads() {
  for (auto& set : model_.loads) {
    auto const value = load_value(set, time_);
    kernels::AddLoad<D, Real> load{set.list.data(), {}, model_.vertex_force()};
    kernels::LoadWork<D, Real> work{set.list.data(), {}, model_.v.data(), 0.5 * last_dt_};
    std::copy(value.begin(), value.end(), load.value);
    std::copy(value.begin(), value.end(), work.value);
    for_each(device_, 0, static_cast<Index>(set.list.size()), load);
    ledger_.external += sum_over<1>(device_, 0, static_cast<Index>(set.list.size()), work)[0];
  }
}

template <int D, class Real>
void Solver<D, Real>::stay_on_axis() {
  if constexpr (Dim<D>::can_revolve)
    for_each(device_, 0, static_cast<Index>(model_.axis.size()), kernels::StayOnAxis<D, Real>{model_.axis.data(), model_.vertex_force()});
}

/// Velocity that a hold asks for over the step that begins at t: taken at the half step, where the leapfrog keeps velocities.
template <int D, class Real>
void Solver<D, Real>::hold_before() {
  for (auto& set : model_.holds) {
    auto const& hold = scene_.holds[set.hold];
    kernels::HoldReaction<D, Real> kernel;
    kernel.list = set.list.data();
    kernel.impulse = set.impulse.data();
    kernel.v = model_.v.data();
    kernel.force = model_.vertex_force();
    kernel.inverse_mass = model_.inverse_mass.data();
    kernel.last_dt = last_dt_;
    kernel.dt = limit_.dt;
    kernel.damping = scene_.run.mass_damping;
    for (int c = 0; c < D; ++c) {
      kernel.gravity[c] = weight_per_mass(c);
      kernel.target[c] = hold.velocity[c] ? (*hold.velocity[c])(time_ + 0.5 * limit_.dt) : 0;
    }
    auto const sums = sum_over<D + 1>(device_, 0, static_cast<Index>(set.list.size()), kernel);
    for (int c = 0; c < D; ++c) hold_reaction_[set.hold][c] = sums[c];
    ledger_.external += sums[D];
  }
}

template <int D, class Real>
void Solver<D, Real>::hold_after() {
  for (auto& set : model_.holds) {
    auto const& hold = scene_.holds[set.hold];
    kernels::HoldMotion<D, Real> kernel;
    kernel.list = set.list.data();
    kernel.impulse = set.impulse.data();
    kernel.held = set.held.data();
    kernel.u = model_.u.data();
    kernel.v = model_.v.data();
    kernel.dt = limit_.dt;
    for (int c = 0; c < D; ++c) kernel.target[c] = hold.velocity[c] ? (*hold.velocity[c])(time_ + 0.5 * limit_.dt) : 0;
    ledger_.external += sum_over<1>(device_, 0, static_cast<Index>(set.list.size()), kernel)[0];
  }
}

/// Energies at this moment, after evaluate(): what a sample of the ledger shows.
template <int D, class Real>
void Solver<D, Real>::book() {
  ElementRun const run{scene_.two_d == "plane stress", limit_.dt};
  auto const elements = element_energy(device_, model_, scene_, run);
  ledger_.elastic = elements[0];
  ledger_.joint = elements[1];
  ledger_.hourglass = elements[2];
  auto const sums = sum_over<3 + D>(device_, 0, model_.n_vertices, kernels::VertexEnergy<D, Real>{vertices()});
  ledger_.kinetic = sums[0];
  ledger_.gravity = sums[2];
  for (int c = 0; c < D; ++c) momentum_[c] = sums[3 + c];
  auto const total = [](Buffer<double> const& terms) {
    double sum = 0;
    for (double term : terms.download()) sum += term;
    return sum;
  };
  ContactWork const& contact = contact_.work();
  ledger_.contact = std::max(contact.stored(), 0.0);  // nothing holds less than nothing (what is not a number stays so)
  ledger_.plates = contact.by_plates;
  ledger_.friction = contact.friction;
  ledger_.fracture = total(model_.dissipated);
  ledger_.viscous = total(model_.viscous_work);
  ledger_.plastic = total(model_.plastic_work);
}

/// Stops the run when an element turned inside out or a number was lost, and names the first such element.
template <int D, class Real>
void Solver<D, Real>::check_elements() {
  notices_ = model_.flags.download();
  if (notices_[0] == 0) return;
  auto const u = model_.u.download();
  for (Index e = 0; e < model_.n_elements; ++e) {
    if (model_.cell_of_element[e] < 0 || model_.cell_head(e) != e) continue;
    double const ratio = model_.volume_ratio(u, e);
    if (ratio > 0) continue;
    auto const& body = scene_.bodies[model_.body_of_element[e]];
    throw Error(fmt::format("step {}, t = {:.6g} s: element {} of body \"{}\" {} (volume ratio {:.3g}); a smaller dt, damping or a finer mesh may help",
                            step_, time_, number_of_cell_[e], body.name,
                            std::isnan(ratio) ? "is not a number" : "has turned inside out", ratio));
  }
  for (Index e = 0; e < model_.n_elements; ++e) {
    if (model_.block_of(e) < 0 || model_.cell_of_element[e] < 0 || model_.moved_edges(u, e).determinant() / model_.edges(e).determinant() > 0) continue;
    throw Error(fmt::format("step {}, t = {:.6g} s: a corner of element {} of body \"{}\" has turned inside out where it touches something; a finer mesh, a softer "
                            "contact or another integration may help", step_, time_, number_of_cell_[model_.cell_head(e)],
                            scene_.bodies[model_.body_of_element[e]].name));
  }
  if (model_.plan.plastic) refuse_flow();
  throw Error(fmt::format("step {}, t = {:.6g} s: the precision of this run cannot tell an element's volume from zero; use --precision double?", step_, time_));
}

/// Names the element whose return mapping gave no number: its memory is as it was before that step, but for its rate.
template <int D, class Real>
void Solver<D, Real>::refuse_flow() {
  auto const memory = model_.memory.download();
  for (auto const& group : model_.groups)
    for (Index e = group.first; group.plastic && e < group.first + group.count; ++e) {
      if (model_.cell_of_element[e] < 0) continue;
      auto const point = flow_point(memory, e);
      if (!std::isnan(point.rate)) continue;
      auto const& s = point.stress;
      throw Error(fmt::format("step {}, t = {:.6g} s: the return mapping of element {} of body \"{}\" did not converge (plastic strain {:.4g}, stress "
                              "before xx {:.4g}, yy {:.4g}, zz {:.4g}, xy {:.4g} Pa); a smaller dt or another yield curve may help",
                              step_, time_, number_of_cell_[model_.cell_head(e)], scene_.bodies[group.body].name, point.strain, s(0, 0), s(1, 1), s(2, 2), s(0, 1)));
    }
}

/// What element e remembers, on the host; of a block the mean over its points.
template <int D, class Real>
laws::FlowPoint<double, true> Solver<D, Real>::flow_point(std::vector<Real> const& memory, Index e) const {
  auto const& m = model_.groups.at(model_.body_of_element[e]).plastic->memory;
  auto const number = [&](int k) { return k < 0 ? 0.0 : model_.remembered(memory, e, k); };
  auto const tensor = [&](int from) {
    Mat<double, 3> t = Mat<double, 3>::Zero();
    for (int k = 0; k < Dim<D>::stresses && from >= 0; ++k)
      t(kernels::tensor_row(k), kernels::tensor_column(k)) = t(kernels::tensor_column(k), kernels::tensor_row(k)) = number(from + k);
    return t;
  };
  return {tensor(0), number(m.strain), number(m.rate), number(m.rise), tensor(m.back)};
}

/// Whether elements have been pressed so flat since the last look that the stable step is another: those that flow, and
/// fragments between others.
template <int D, class Real>
bool Solver<D, Real>::squeezed() {
  bool const looks = model_.plan.plastic ? step_ % 10 == 0 : !contact_.broken().empty() && step_ % 20 == 0;
  return looks && largest_gradients(device_, model_, scene_) > squeeze_;
}

/// Joints that began to soften make their elements eligible for contact; those whose every corner reached full damage leave
/// the elements and become faces that may only press and rub. Faces tell in no order: they are heard body by body, pack by pack.
template <int D, class Real>
void Solver<D, Real>::follow_joints() {
  if (notices_[1] + notices_[2] == 0) return;
  auto const told = [&](auto const& joints, int which) {
    constexpr int faces = std::remove_cvref_t<decltype(joints)>::faces;
    auto list = joints.events.download_first(static_cast<std::size_t>(notices_[which]));
    auto const order = [](Index at) { return std::array{at / faces / kernels::layout_width, at % faces, at / faces}; };
    std::sort(list.begin(), list.end(), [&](Index one, Index other) { return order(one) < order(other); });
    model_.flags.upload_one(which, 0);
    return list;
  };
  auto const of_elements = told(model_.joints, 1), of_blocks = told(model_.block_joints, 2);
  model::JointRecord const elements(model_.joints, of_elements);
  model::JointRecord const blocks(model_.block_joints, of_blocks);
  struct Breaking {
    Index at, cell;  // face of an element, element * 4 + face, and the cell it is or is part of
    int face;        // of the cell
    bool block;
  };
  std::vector<Breaking> breaking;
  // The joint at a face of a cell is that at the faces of these elements, each with its own points.
  auto const hear = [&](auto const& record, Index cell, int face, std::span<Index const> parts, bool block) {
    auto const [least, largest] = record.damage(cell, face);
    for (Index const at : parts) {
      Index const e = at >> 2;
      if (model_.host_link[kernels::blocked(e, at & 3, C)] >> 2 <= e) continue;  // none, or known from the other side
      if (largest > 0) contact_.loosen(e, at & 3);
      if (least >= 1) breaking.push_back({at, cell, face, block});
    }
  };
  for (auto const& group : model_.groups) {
    for (Index const at : of_elements)
      if (Index const e = at / C; e >= group.first && e < group.first + group.padded_simplices) hear(elements, e, at % C, std::array{e * 4 + at % C}, false);
    for (Index const at : of_blocks)
      if (Index const b = at / Model::F; b >= group.first_block && b < group.first_block + group.padded_blocks)
        hear(blocks, b, at % Model::F, model_.parts_at(b, at % Model::F), true);
  }
  if (breaking.empty()) return;
  std::vector<Index> faces;
  for (auto const& joint : breaking) faces.push_back(joint.at);
  model::BreakingView<Real> const now(model_, faces);
  for (auto const& [at, cell, cell_face, block] : breaking) {
    Index const e = at >> 2, face = at & 3, link = model_.host_link[kernels::blocked(e, face, C)];
    BrokenJoint joint;
    joint.element = e, joint.face = face, joint.other = link >> 2, joint.other_face = link & 3;
    joint.time = time_;
    joint.mode = block ? blocks.mode(cell, cell_face) : elements.mode(cell, cell_face);
    std::array<Real, D> areas;
    std::array<laws::JointHistory<Real>, D> corners;
    std::array<Vec<Real, D>, D> stretch;
    for (int i = 0; i < D; ++i) {
      areas[i] = model_.joint_area(now, e, face, i);
      joint.area += static_cast<double>(areas[i]);
      int const point = block ? model_.block_point(e, face, i) : i;
      corners[i] = block ? blocks.point(cell, cell_face, point) : elements.point(cell, cell_face, point);
      for (int c = 0; c < D; ++c)
        stretch[i][c] =
            block ? blocks.stretch_at(cell, cell_face, point, c) : elements.stretch_at(cell, cell_face, point, c);
    }
    Real const stiffness = block ? blocks.stiffness_at(cell, cell_face) : elements.stiffness_at(cell, cell_face);
    contact_.add_broken(now, joint, stiffness, areas,
                        *scene_.materials[scene_.bodies[model_.body_of_element[e]].material].joint, corners, stretch);
  }
  for (auto const& joint : breaking) {
    Index const link = model_.host_link[kernels::blocked(joint.at >> 2, joint.at & 3, C)];
    model_.unlink(joint.at >> 2, joint.at & 3);
    model_.unlink(link >> 2, link & 3);
  }
  patches_stale_ = patches_stale_ || model_.plan.patches;
}

/// Contacts stiffen as they grow: when they exceed what the step allows for, it shrinks at once.
template <int D, class Real>
void Solver<D, Real>::heed_contact() {
  if (contact_.omega_squared() <= contact_allowance_) return;
  contact_allowance_ = 1.5 * contact_.omega_squared();
  set_step();
}

template <int D, class Real>
FrequencyBound Solver<D, Real>::frequency_bound() const {
  FrequencyBound bound;
  auto const u = model_.u.download();
  std::vector<double> bulk(model_.n_vertices, 0), joint(model_.n_vertices, 0);
  std::vector<Index> worst_element(model_.n_vertices, -1);
  std::vector<double> worst(model_.n_vertices, 0);
  double damping = 0;
  for (auto const& group : model_.groups) {
    auto const& material = scene_.materials[scene_.bodies[group.body].material];
    double const stiffness = std::visit([](auto const& law) { return law.confined(); }, material.bulk);
    double const density = material.density * scene_.run.mass_scaling;
    for (Index e = group.first; e < group.first + group.count; ++e) {
      if (model_.cell_of_element[e] < 0 || model_.cell_head(e) != e) continue;
      auto const vertices = model_.cell_vertices(e);
      auto const masses = model_.corner_volumes(e);  // over density
      double const corners = static_cast<double>(vertices.size());
      double mean_mass = 0;
      for (double mass : masses) mean_mass += mass / corners;
      double const least_share = *std::min_element(masses.begin(), masses.end()) / mean_mass;
      double const squared = corners * stiffness / density * model_.squared_gradients(u, e) / least_share;
      damping = std::max(damping, 2 * group.viscosity / stiffness * squared);
      for (std::size_t a = 0; a < vertices.size(); ++a) {
        Index const vertex = vertices[a];
        bulk[vertex] += squared * density * masses[a] / model_.mass[vertex];
        if (squared > worst[vertex]) worst[vertex] = squared, worst_element[vertex] = e;
      }
    }
  }
  bound.damping = damping + scene_.run.mass_damping;
  if (model_.plan.joints) {
    auto const weight = model_.weight.download(), area = model_.block_area.download();
    auto const stiffness = model_.joints.stiffness.download(), block_stiffness = model_.block_joints.stiffness.download();
    auto const add = [&](Index vertex, Real k, Real w) { joint[vertex] += 2 * static_cast<double>(k) * static_cast<double>(w) / model_.mass[vertex]; };
    for (auto const& group : model_.groups) {
      if (!group.split) continue;
      for (Index e = group.first; e < group.first + group.padded_simplices; ++e)
        for (int a = 0; a < C; ++a) {
          std::size_t const at = kernels::blocked(e, a, C);
          for (int i = 0; i < D && weight[at] > 0; ++i) add(model_.vertex_of(e, i + (i >= a)), stiffness[at], weight[at] * model_.joint_share(e, a, i));
        }
      for (Index b = group.first_block; b < group.first_block + group.blocks; ++b)
        for (int a = 0; a < Model::F; ++a)
          for (int i = 0; i < Model::P; ++i)
            add(model_.host_block_vertex[kernels::blocked(b, BlockShape<D>::face(a, i), Model::B)], block_stiffness[kernels::blocked(b, a, Model::F)],
                area[kernels::blocked(b, a * Model::P + i, Model::F * Model::P)]);
    }
  }
  Index stiffest = -1;
  for (Index i = 0; i < model_.n_vertices; ++i) {
    if (!(model_.mass[i] > 0)) continue;
    bound.bulk = std::max(bound.bulk, bulk[i]);
    if (bulk[i] + joint[i] > bound.total) bound.total = bulk[i] + joint[i], stiffest = i;
  }
  if (stiffest >= 0) {
    Index const e = worst_element[stiffest];
    auto const& material = scene_.materials[scene_.bodies[model_.body_of_element[e]].material];
    double const young = std::visit([](auto const& law) { return law.young; }, material.bulk);
    if (joint[stiffest] > bulk[stiffest])
      bound.owner = fmt::format("joints of element {}, penalty {:.3g} E", number_of_cell_[e],
                                std::visit([](auto const& law) { return law.penalty; }, *material.joint) / young);
    else
      bound.owner = fmt::format("element {}, its size and shape", number_of_cell_[e]);
    if (bound.damping * bound.damping > 4 * bound.total)
      bound.owner = fmt::format("viscous damping, at element {}", number_of_cell_[e]);
  }
  return bound;
}

template <int D, class Real>
void Solver<D, Real>::limit_step() {
  bound_ = frequency_bound();
  if (model_.plan.plastic || model_.plan.joints) squeeze_ = 1.1 * largest_gradients(device_, model_, scene_);
  if (!started_) {
    // The power iteration closes in from below: ten per cent on omega^2 cover what it has not reached.
    limit_share_ = std::min(1.0, 1.1 * power_iteration() / bound_.total);
    set_step();
    first_step_ = limit_.automatic;
  } else {
    contact_allowance_ = std::max(1.5 * contact_.omega_squared(), 0.8 * contact_allowance_);
    set_step();
    if (!scene_.run.dt && limit_.automatic < least_step_share * first_step_)
      throw Error(fmt::format("step {}, t = {:.6g} s: the stable step has fallen from {:.4g} to {:.4g} s ({}): what limits it is crushed; a stronger joint or contact, "
                              "a finer mesh or another integration may help", step_, time_, first_step_, limit_.automatic, limit_.owner));
  }
  refresh_ = step_ + 500;
}

template <int D, class Real>
void Solver<D, Real>::set_step() {
  double const omega_squared = bound_.total * limit_share_ + contact_allowance_;
  limit_.bound = stable_step(bound_.total + contact_allowance_, bound_.damping);
  // Leapfrog keeps energy at a constant step: one that followed every breath of the bodies would pump it.
  double const automatic = scene_.run.safety * stable_step(omega_squared, bound_.damping);
  if (!(std::abs(automatic - limit_.automatic) < 0.05 * limit_.automatic)) limit_.automatic = automatic;
  limit_.owner = contact_allowance_ > bound_.total * limit_share_ ? "contact" : bound_.owner;
  choose_step();
  if (!(limit_.dt > 0) || !std::isfinite(limit_.dt))
    throw Error(fmt::format("step {}, t = {:.6g} s: the time step is {:.4g} s, which is no step ({}); are masses and stiffnesses right?",
                            step_, time_, limit_.dt, limit_.owner));
  if (!warned_of_dt_ && limit_.dt > limit_.automatic / scene_.run.safety) {
    warned_of_dt_ = true;
    model_.warnings.push_back(fmt::format("dt = {:.4g} s is above the stable step {:.4g} s ({}){}; the run will probably blow up", limit_.dt,
                                          limit_.automatic / scene_.run.safety, limit_.owner,
                                          started_ ? fmt::format(" since t = {:.4g} s", time_) : ""));
  }
}

/// The step of the user's own or the automatic one, shortened so that a whole number of them ends when the run does: all are alike, for
/// a single short one would show as an error of energy (leapfrog keeps the energy that belongs to its step).
template <int D, class Real>
void Solver<D, Real>::choose_step() {
  double const longest = scene_.run.dt.value_or(limit_.automatic), left = end_ - time_;
  limit_.dt = left > 0 ? left / std::ceil(left / longest * (1 - 1e-9)) : longest;
}

template <int D, class Real>
double Solver<D, Real>::power_iteration(int most_iterations, double tolerance) {
  // A small displacement x of unit size times `scale` keeps the operator linear; forces are -K x.
  std::size_t const n = static_cast<std::size_t>(model_.n_vertices) * D;
  auto const u = model_.u.download();
  auto const v = model_.v.download();
  std::vector<Real> x(n, 0);
  std::uint64_t random = 88172645463325252ull;
  for (std::size_t i = 0; i < n; ++i) {
    random ^= random << 13, random ^= random >> 7, random ^= random << 17;
    x[i] = model_.mass[i / D] > 0 ? static_cast<Real>(static_cast<double>(random >> 11) / (1ull << 53) - 0.5) : Real(0);
  }
  double size = 0;
  for (int k = 0; k < D; ++k) size = std::max(size, std::abs(model_.reference[model_.vertex_of(0, 1)][k] - model_.reference[model_.vertex_of(0, 0)][k]));
  double const scale = size * (sizeof(Real) == 8 ? 1e-9 : 1e-6);
  std::vector<Real> zero(n, 0);
  model_.v.upload(zero);
  auto const dissipated = model_.dissipated.download();
  double omega_squared = 0;
  ElementRun const run{scene_.two_d == "plane stress", 0, true};
  for (int it = 0; it < most_iterations; ++it) {
    double norm = 0;
    for (std::size_t i = 0; i < n; ++i) norm += model_.mass[i / D] * static_cast<double>(x[i]) * x[i];
    norm = std::sqrt(norm);
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(static_cast<double>(x[i])));
    std::vector<Real> probe(n);
    for (std::size_t i = 0; i < n; ++i) probe[i] = static_cast<Real>(x[i] * (scale / largest));
    model_.u.upload(probe);
    element_forces(device_, model_, scene_, run);
    if (model_.plan.shared)
      for_each(device_, 0, model_.n_vertices,
               kernels::SumCorners<D, Real>{model_.corner_force(), model_.corner_first.data(), model_.corner_list.data(), model_.vertex_force()});
    stay_on_axis();
    auto const f = model_.force.download();
    double rayleigh = 0, squares = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double const m = model_.mass[i / D];
      if (!(m > 0)) continue;
      double const y = -static_cast<double>(f[i]) / m;
      rayleigh += m * probe[i] * y;
      squares += m * static_cast<double>(probe[i]) * probe[i];
      x[i] = static_cast<Real>(y * (largest / scale));
    }
    double const now = rayleigh / squares;
    for (auto& value : x) value = static_cast<Real>(value / now);
    if (it > 20 && std::abs(now - omega_squared) < tolerance * now) {
      omega_squared = now;
      break;
    }
    omega_squared = now;
  }
  model_.u.upload(u);
  model_.v.upload(v);
  model_.flags.upload_one(0, 0);
  return omega_squared;
}

}  // namespace fissure
