// The step itself; instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "contact/contact_stage.impl.h"
#include "kernels/advance.h"
#include "model/model.impl.h"
#include "solver/absorb_stage.impl.h"
#include "solver/checkpoint.impl.h"
#include "solver/faults.impl.h"
#include "solver/fracture_stage.impl.h"
#include "solver/frames.impl.h"
#include "solver/insertion_stage.impl.h"
#include "solver/load_stage.impl.h"
#include "solver/motion_stage.impl.h"
#include "solver/probe.impl.h"
#include "solver/removal_stage.impl.h"
#include "solver/rigid_stage.impl.h"
#include "solver/solver.h"
#include "solver/spring_stage.impl.h"
#include "solver/step_limit.impl.h"
#include "solver/tie_stage.impl.h"

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
      model_(device, scene, mesh),
      shown_(model_),
      contact_(device, scene, mesh, model_),
      fracture_(scene, model_, contact_),
      insertion_(device, scene, model_),
      loads_(device, model_, ledger_),
      absorb_(device, model_, ledger_),
      motion_(device, scene, model_, ledger_),
      rigid_(device, scene, model_),
      springs_(device, scene, model_, ledger_),
      ties_(device, scene, model_, motion_),
      removal_(device, scene, model_, contact_, insertion_, ledger_),
      stable_step_(device, scene, model_, shown_.number_of_cell),
      probe_(*this),
      frames_(*this),
      end_(scene.run.time) {
  for (std::size_t i = 0; i < model_.vertices.start.size(); ++i)
    weight_held_ -= model_.vertices.mass[i / D] * scene.weight_per_mass(i % D) * model_.vertices.start[i];
  stable_step_.start(moment());
}

/// A wave needs about as many steps to cross an element where joints set the step.
constexpr long steps_between_looks = 8;

template <int D, class Real>
void Solver<D, Real>::evaluate() {
  if (started_)
    stable_step_.follow(moment());
  else
    stable_step_.choose(moment());
  FISSURE_EXPECT(dt() > 0 && (scene_.run.dt || dt() <= stable_step_.limit().stable * (1 + 1e-9)));
  {
    StageClock const clock(device_, time_stages, stage_times.elements);
    add_bulk_forces();
    springs_.add_forces(time_, last_dt_);
  }
  std::vector<Real> unbalanced;  // by a stress at the start, and by springs
  if (!started_ && begins_pushed()) unbalanced = model_.vertices.force.download();
  if (started_ && step_ == 1) warn_of_yield();
  {
    StageClock const clock(device_, time_stages, stage_times.contact);
    contact_.add_forces(time_, last_dt_, dt());
    if (model_.plan.joints && fracture_.follow(told_, time_)) patches_stale_ = patches_stale_ || model_.plan.patches;
    stable_step_.heed_contact(moment());
  }
  {
    StageClock const clock(device_, time_stages, stage_times.loads);
    loads_.add_forces(time_, last_dt_);
    motion_.stay_on_axis();
    ties_.carry(vertices(), time_);
    if (model_.plan.insertion) insertion_.tie_forces(step_ % steps_between_looks == 0);
    absorb_.add_forces(vertices());
    if (model_.plan.absorbs) ties_.carry(vertices(), time_, true);
    rigid_.react(vertices(), step_);
    motion_.react(time_, last_dt_, dt(), mass_damping());
    removal_.remove(vertices(), last_dt_, dt());
    if (started_) removal_.excavate(vertices(), time_, dt());
  }
  if (std::exchange(begins_, false)) {
    book();
    ledger_.external = ledger_.mass_damping = ledger_.start = 0;
    ledger_.start = -ledger_.residual();
  }
  if (!started_) {
    started_ = true;
    contact_.begin();
    book();
    // Kinetic energy is that between the velocities before and behind this moment: what a hold took at once was there
    // before it.
    ledger_.start = ledger_.sum(Ledger::Kind::stored) - ledger_.external + ledger_.spring_lost;
    start_gives_ = half_pushed(unbalanced);
  }
  contact_.serve(time_, probe_);
}

template <int D, class Real>
bool Solver<D, Real>::begins_pushed() const {
  return !model_.springs.empty() ||
         std::ranges::any_of(scene_.bodies, [](scene::Body const& body) { return static_cast<bool>(body.stress_at); });
}

/// What internal forces give in the first step beyond the half of it that they push for: they act over the whole of it
/// in the energy of the bodies, and for half of it on velocities [J].
template <int D, class Real>
double Solver<D, Real>::half_pushed(std::vector<Real> const& internal) {
  if (internal.empty()) return 0;
  auto const v = model_.vertices.v.download(), force = model_.vertices.force.download();
  double sum = 0;
  for (std::size_t i = 0; i < internal.size(); ++i) {
    double const m = model_.vertices.mass[i / D];
    if (!(m > 0)) continue;
    double const a = 0.25 * mass_damping() * dt(), push = force[i] / m + scene_.weight_per_mass(i % D);
    sum += 0.25 * dt() * internal[i] * ((1 - a) * v[i] + 0.5 * dt() * push) / (1 + a);
  }
  return sum;
}

/// Internal forces of cells and of the joints between them; where a joint begins by stress, it is found here.
template <int D, class Real>
void Solver<D, Real>::add_bulk_forces() {
  if (patches_stale_) model_.place_patches(device_);  // not in the step that broke joints: its forces used the old ones
  patches_stale_ = false;
  ElementRun const run{last_dt_};
  bool const looks = step_ % steps_between_looks == 0;  // at what stress begins
  if (model_.plan.insertion && looks) insertion_.tie_motion();
  element_forces(device_, model_, scene_, run);
  // Behind the forces, which bring stress and pressure to this moment; what begins is felt in the next step.
  if (!model_.interfaces.stress.empty() && looks) {
    start_by_stress(device_, model_, scene_, run, insertion_.found());
    if (model_.plan.insertion) insertion_.hear();
  }
  if (model_.plan.shared)
    for_each(device_, 0, model_.vertices.count,
             kernels::SumCorners<D, Real>{model_.corner_force(), model_.slots.first.data(), model_.slots.list.data(),
                                          model_.vertex_force()});
  auto const notices = model_.flags.download();
  check_elements(notices[model::Notice::fault]);
  told_ = {notices[model::Notice::joints], notices[model::Notice::block_joints]};
}

template <int D, class Real>
void Solver<D, Real>::advance() {
  {
    StageClock const clock(device_, time_stages, stage_times.advance);
    kernels::Advance<D, Real> const step{vertices(), model_.plan.gravity};
    if (model_.plan.mass_damping)
      ledger_.mass_damping += sum_over<1>(device_, 0, model_.vertices.count, kernels::DampedAdvance<D, Real>{step})[0];
    else
      for_each(device_, 0, model_.vertices.count, step);
  }
  StageClock const clock(device_, time_stages, stage_times.loads);
  // What acts at the start has pushed for half a step at half the velocity on average: so the balance closes exactly.
  double const share = last_dt_ > 0 ? 0.5 : 0.25;
  loads_.finish_step(time_, dt(), share);
  springs_.finish_step(dt(), share);
  contact_.finish_step(time_, dt(), share);
  motion_.move(time_, dt());
  rigid_.move();
  ties_.move();
  absorb_.finish_step();
  ledger_.start -= std::exchange(start_gives_, 0);
  last_dt_ = dt();
  time_ += dt();
  ++step_;
}

template <int D, class Real>
double Solver<D, Real>::settling_time() const {
  if (!scene_.settling) return 0;
  return scene_.settling->time.value_or(10 * 2 * std::numbers::pi / model_.slowest_vibration(scene_));
}

/// Time before the start is negative. What is left of motion at its end is told.
template <int D, class Real>
bool Solver<D, Real>::settle(std::function<bool()> const& goes_on) {
  if (!scene_.settling) return true;
  calming_ = stable_step_.mass_damping();
  time_ = -settling_time();

  auto const start = model_.vertices.v.download();
  model_.vertices.v.upload(std::vector<Real>(start.size(), 0));
  rigid_.take_velocities();
  auto const end = std::exchange(end_, 0);
  while (time_ < 0) {
    evaluate();
    advance();
    if (std::abs(time_) <= 1e-9 * dt()) time_ = 0;
    if (!goes_on()) return false;
  }
  double const moving = energies().kinetic, held = ledger_.sum(Ledger::Kind::stored) - moving - ledger_.gravity;
  if (moving > 1e-4 * std::abs(held))
    model_.warnings.push_back(fmt::format(
        "{}settle: at its end {:.3g} J are still in motion, of {:.3g} J that bodies hold; they are left "
        "out at t = 0, and bodies go on to swing. A longer time or another damping than {:.3g} 1/s may help",
        scene_.settling->source.prefix(), moving, held, calming_));
  model_.vertices.v.upload(start);
  rigid_.take_velocities();
  end_ = end, settled_ = step_, begins_ = true;
  return true;
}

template <int D, class Real>
void Solver<D, Real>::step_back() {
  auto u = model_.vertices.u.download();
  auto const v = model_.vertices.v.download();
  for (std::size_t i = 0; i < u.size(); ++i) u[i] -= static_cast<Real>(last_dt_) * v[i];
  model_.vertices.u.upload(u);
}

template <int D, class Real>
kernels::VertexView<D, Real> Solver<D, Real>::vertices() {
  kernels::VertexView<D, Real> view{model_.vertices.u.data(),
                                    model_.vertices.v.data(),
                                    model_.vertex_force(),
                                    model_.vertices.inverse_mass.data(),
                                    {},
                                    dt(),
                                    0.5 * (last_dt_ + dt()),
                                    mass_damping()};
  for (int c = 0; c < D; ++c) view.gravity[c] = scene_.weight_per_mass(c);
  return view;
}

/// Energies at this moment, after evaluate(): what a sample of the ledger shows.
template <int D, class Real>
void Solver<D, Real>::book() {
  ElementRun const run{dt()};
  auto const elements = element_energy(device_, model_, scene_, run);
  ledger_.elastic = elements[0];
  ledger_.joint = elements[1];
  ledger_.hourglass = elements[2];
  auto const sums = sum_over<2 + D>(device_, 0, model_.vertices.count, kernels::VertexEnergy<D, Real>{vertices()});
  ledger_.kinetic = sums[0];
  ledger_.gravity = sums[1] - weight_held_;
  auto const total = [](Buffer<double> const& terms) {
    double sum = 0;
    for (double term : terms.download()) sum += term;
    return sum;
  };
  ContactWork const& contact = contact_.work();
  // Nothing holds less than it began with (what is not a number stays so).
  ledger_.contact = std::max(contact.stored(), -contact.began_with);
  ledger_.plates = contact.by_plates;
  ledger_.spring = springs_.stored();
  ledger_.friction = contact.friction;
  ledger_.fracture = total(model_.interfaces.dissipated);
  ledger_.viscous = total(model_.elements.viscous_work);
  ledger_.plastic = total(model_.internal.work);
}

template <int D, class Real>
Ledger const& Solver<D, Real>::energies() {
  if (booked_step_ != step_) book();
  booked_step_ = step_;
  return ledger_;
}

template <int D, class Real>
std::vector<double> Solver<D, Real>::stresses() {
  Buffer<double> stress(device_, "stress", static_cast<std::size_t>(model_.elements.count) * 6);
  element_stress(device_, model_, scene_, ElementRun{dt()}, stress.data());
  return stress.download();
}

}  // namespace fissure
