// The step itself; instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "kernels/advance.h"
#include "kernels/loads.h"
#include "model/model.impl.h"
#include "solver/contact_stage.impl.h"
#include "solver/insertion_stage.impl.h"
#include "solver/solver.h"
#include "solver/step_limit.impl.h"

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
    : device_(device),
      scene_(scene),
      mesh_(mesh),
      model_(device, scene, mesh),
      contact_(device, scene, mesh, model_),
      stable_step_(device, scene, model_, number_of_cell_),
      insertion_(device, scene, model_),
      hold_reaction_(scene.holds.size(), Vec3(0, 0, 0)) {
  number_shown();
  stable_step_.start(moment());
}

/// A wave needs about as many steps to cross an element where joints set the step.
constexpr long steps_between_looks = 8;

template <int D, class Real>
void Solver<D, Real>::evaluate() {
  if (patches_stale_) model_.place_patches(device_);  // not in the step that broke joints: its forces used the old ones
  patches_stale_ = false;
  if (started_)
    stable_step_.follow(moment());
  else
    stable_step_.choose(moment());
  ElementRun const run{scene_.two_d == "plane stress", last_dt_};
  bool const looks = step_ % steps_between_looks == 0;  // at what stress begins
  {
    StageClock const clock(device_, time_stages, stage_times.elements);
    if (model_.plan.insertion && looks) insertion_.tie_motion();
    element_forces(device_, model_, scene_, run);
    // Behind the forces, which bring stress and pressure to this moment; what begins is felt in the next step.
    if (!model_.stress.empty() && looks) {
      start_by_stress(device_, model_, scene_, run, insertion_.found());
      if (model_.plan.insertion) insertion_.hear();
    }
    if (model_.plan.shared)
      for_each(device_, 0, model_.n_vertices,
               kernels::SumCorners<D, Real>{model_.corner_force(), model_.corner_first.data(),
                                            model_.corner_list.data(), model_.vertex_force()});
    check_elements();
  }
  {
    StageClock const clock(device_, time_stages, stage_times.contact);
    contact_.add_forces(time_, last_dt_, dt());
    if (model_.plan.joints) follow_joints();
    stable_step_.heed_contact(moment());
  }
  {
    StageClock const clock(device_, time_stages, stage_times.loads);
    add_loads();
    stay_on_axis();
    if (model_.plan.insertion) insertion_.tie_forces(looks);
    hold_before();
  }
  if (!started_) {
    started_ = true;
    contact_.begin();
    book();
    // Kinetic energy is that between the velocities before and behind this moment: what a hold took at once was there
    // before it.
    ledger_.start = ledger_.kinetic + ledger_.elastic + ledger_.hourglass + ledger_.joint + ledger_.contact +
                    ledger_.gravity - ledger_.external;
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
  // What acts at the start has pushed for half a step at half the velocity on average: so the balance closes exactly.
  double const share = last_dt_ > 0 ? 0.5 : 0.25;
  for (auto& set : model_.loads) {
    auto const value = load_value(set, time_);
    kernels::LoadWork<D, Real> work{set.list.data(), {}, model_.v.data(), share * dt()};
    std::copy(value.begin(), value.end(), work.value);
    ledger_.external += sum_over<1>(device_, 0, static_cast<Index>(set.list.size()), work)[0];
  }
  contact_.finish_step(time_, dt(), share);
  hold_after();
  last_dt_ = dt();
  time_ += dt();
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
  kernels::VertexView<D, Real> view{
      model_.u.data(),         model_.v.data(),        model_.vertex_force(), model_.inverse_mass.data(), {}, dt(),
      0.5 * (last_dt_ + dt()), scene_.run.mass_damping};
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
    for_each(device_, 0, static_cast<Index>(model_.axis.size()),
             kernels::StayOnAxis<D, Real>{model_.axis.data(), model_.vertex_force()});
}

/// Velocity that a hold asks for over the step that begins at t: taken at the half step, where the leapfrog keeps
/// velocities.
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
    kernel.dt = dt();
    kernel.damping = scene_.run.mass_damping;
    for (int c = 0; c < D; ++c) {
      kernel.gravity[c] = weight_per_mass(c);
      kernel.target[c] = hold.velocity[c] ? (*hold.velocity[c])(time_ + 0.5 * dt()) : 0;
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
    kernel.dt = dt();
    for (int c = 0; c < D; ++c) kernel.target[c] = hold.velocity[c] ? (*hold.velocity[c])(time_ + 0.5 * dt()) : 0;
    ledger_.external += sum_over<1>(device_, 0, static_cast<Index>(set.list.size()), kernel)[0];
  }
}

/// Energies at this moment, after evaluate(): what a sample of the ledger shows.
template <int D, class Real>
void Solver<D, Real>::book() {
  ElementRun const run{scene_.two_d == "plane stress", dt()};
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
  // Nothing holds less than it began with (what is not a number stays so).
  ledger_.contact = std::max(contact.stored(), -contact.began_with);
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
    bool const lost = std::isnan(ratio);
    throw Error(
        fmt::format("step {}, t = {:.6g} s: element {} of body \"{}\" {} (volume ratio {:.3g}); {}", step_, time_,
                    number_of_cell_[e], body.name, lost ? "is not a number" : "has turned inside out", ratio,
                    lost && sizeof(Real) == 4 ? advice_for_single : "a smaller dt, damping or a finer mesh may help"));
  }
  for (Index e = 0; e < model_.n_elements; ++e) {
    if (model_.block_of(e) < 0 || model_.cell_of_element[e] < 0 ||
        model_.moved_edges(u, e).determinant() / model_.edges(e).determinant() > 0)
      continue;
    throw Error(
        fmt::format("step {}, t = {:.6g} s: a corner of element {} of body \"{}\" has turned inside out where it "
                    "touches something; a finer mesh, a softer contact or another integration may help",
                    step_, time_, number_of_cell_[model_.cell_head(e)], scene_.bodies[model_.body_of_element[e]].name));
  }
  if (model_.plan.plastic) refuse_flow();
  throw Error(
      fmt::format("step {}, t = {:.6g} s: the precision of this run cannot tell an element's volume from zero; use "
                  "--precision double?",
                  step_, time_));
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
      throw Error(
          fmt::format("step {}, t = {:.6g} s: the return mapping of element {} of body \"{}\" did not converge "
                      "(plastic strain {:.4g}, stress before xx {:.4g}, yy {:.4g}, zz {:.4g}, xy {:.4g} Pa); a smaller "
                      "dt or another yield curve may help",
                      step_, time_, number_of_cell_[model_.cell_head(e)], scene_.bodies[group.body].name, point.strain,
                      s(0, 0), s(1, 1), s(2, 2), s(0, 1)));
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
      t(kernels::tensor_row(k), kernels::tensor_column(k)) = t(kernels::tensor_column(k), kernels::tensor_row(k)) =
          number(from + k);
    return t;
  };
  return {tensor(0), number(m.strain), number(m.rate), number(m.rise), tensor(m.back)};
}

/// Joints that began to soften make their elements eligible for contact; those whose every corner reached full damage
/// leave the elements and become faces that may only press and rub. Faces tell in no order: they are heard body by
/// body, pack by pack.
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
    double work;  // what softening took of the part [J]
  };
  std::vector<Breaking> breaking;
  // The joint at a face of a cell is that at the faces of these elements, each with its own points.
  auto const hear = [&](auto const& record, Index cell, int face, std::span<Index const> parts, bool block) {
    auto const [least, largest] = record.damage(cell, face);
    for (Index const at : parts) {
      Index const e = at >> 2;
      if (model_.host_link[kernels::blocked(e, at & 3, C)] >> 2 <= e) continue;  // none, or known from the other side
      if (largest > 0) contact_.loosen(e, at & 3);
      if (least >= 1)
        breaking.push_back({at, cell, face, block, record.taken(cell, face) / static_cast<double>(parts.size())});
    }
  };
  for (auto const& group : model_.groups) {
    for (Index const at : of_elements)
      if (Index const e = at / C; e >= group.first && e < group.first + group.padded_simplices)
        hear(elements, e, at % C, std::array{e * 4 + at % C}, false);
    for (Index const at : of_blocks)
      if (Index const b = at / Model::F; b >= group.first_block && b < group.first_block + group.padded_blocks)
        hear(blocks, b, at % Model::F, model_.parts_at(b, at % Model::F), true);
  }
  if (breaking.empty()) return;
  std::vector<Index> faces;
  for (auto const& joint : breaking) faces.push_back(joint.at);
  model::BreakingView<Real> const now(model_, faces);
  for (auto const& [at, cell, cell_face, block, work] : breaking) {
    Index const e = at >> 2, face = at & 3, link = model_.host_link[kernels::blocked(e, face, C)];
    BrokenJoint joint;
    joint.element = e, joint.face = face, joint.other = link >> 2, joint.other_face = link & 3;
    joint.time = time_, joint.work = work;
    joint.mode = block ? blocks.mode(cell, cell_face) : elements.mode(cell, cell_face);
    std::array<Real, D> areas;
    std::array<laws::JointHistory<Real>, D> corners;
    std::array<Vec<Real, D>, D> stretch;
    std::array<Real, D> offsets;
    for (int i = 0; i < D; ++i) {
      areas[i] = model_.joint_area(now, e, face, i);
      joint.area += static_cast<double>(areas[i]);
      int const point = block ? model_.block_point(e, face, i) : i;
      corners[i] = block ? blocks.point(cell, cell_face, point) : elements.point(cell, cell_face, point);
      offsets[i] = block ? blocks.pressed_at(cell, cell_face, point) : elements.pressed_at(cell, cell_face, point);
      for (int c = 0; c < D; ++c)
        stretch[i][c] =
            block ? blocks.stretch_at(cell, cell_face, point, c) : elements.stretch_at(cell, cell_face, point, c);
    }
    Real const stiffness = block ? blocks.stiffness_at(cell, cell_face) : elements.stiffness_at(cell, cell_face);
    contact_.add_broken(now, joint, stiffness, areas, model_.joint_law(scene_, e, face), corners, stretch, offsets);
  }
  for (auto const& joint : breaking) {
    Index const link = model_.host_link[kernels::blocked(joint.at >> 2, joint.at & 3, C)];
    model_.unlink(joint.at >> 2, joint.at & 3);
    model_.unlink(link >> 2, link & 3);
  }
  patches_stale_ = patches_stale_ || model_.plan.patches;
}

}  // namespace fissure
