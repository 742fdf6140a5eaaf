// Instantiated by src2d and src3d.
#pragma once
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "backend/team.h"
#include "kernels/advance.h"
#include "solver/step_limit.h"

namespace fissure {

namespace step {
inline constexpr double noticeable =
    1.1;  // growth of what is watched that asks for a measurement at once: 5 % of the step
inline constexpr double slight = 1.02;         // and any change by which one is made at the regular look
inline constexpr double strain_between = 0.1;  // looks: by the speed of vertices over the size of elements
inline constexpr long regular = 500;           // steps between regular looks
inline constexpr double least_share = 1e-4;    // of the first step: with less a run would go on without end
inline constexpr double spare = 1.1;           // on bodies' omega^2, for what the measurement has not reached
// step over safety, times the frequency of the stiffest contact: 6 steps a period of it at a safety of 0.8
inline constexpr double of_contact = 1.25;
inline constexpr double per_product = 3;  // steps that a product with the tangent counts for: bodies, joints, vectors

/// visit(i) for all i below n, by the team.
template <class Visit>
void over(Device& device, std::size_t n, Visit const& visit) {
  constexpr std::size_t piece = 8192;
  cpu::Team::get().run(device.threads(), static_cast<Index>((n + piece - 1) / piece), [&](Index from, Index to) {
    for (std::size_t i = from * piece, end = std::min(n, to * piece); i < end; ++i) visit(i);
  });
}
/// Sum over pieces of what visit(i, sum) adds to it: the same for any number of threads.
template <class Visit>
double sum_over(Device& device, std::size_t n, Visit const& visit) {
  constexpr std::size_t piece = 8192;
  std::vector<double> sums((n + piece - 1) / piece, 0);
  cpu::Team::get().run(device.threads(), static_cast<Index>(sums.size()), [&](Index from, Index to) {
    for (Index k = from; k < to; ++k)
      for (std::size_t i = k * piece, end = std::min(n, (k + 1) * piece); i < end; ++i) visit(i, sums[k]);
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}
/// An array of the device becomes value(i).
template <class Real, class Value>
void fill(Device& device, Buffer<Real>& array, Value const& value) {
  if (array.host_can_read()) return over(device, array.size(), [&](std::size_t i) { array.data()[i] = value(i); });
  std::vector<Real> values(array.size());
  over(device, values.size(), [&](std::size_t i) { values[i] = value(i); });
  array.upload(values);
}
}  // namespace step

template <int D, class Real>
StableStep<D, Real>::StableStep(Device& device, scene::Scene const& scene, Model& model,
                                std::vector<Index> const& number_of_cell)
    : device_(device),
      scene_(scene),
      model_(model),
      number_of_cell_(number_of_cell),
      on_axis_(model.vertices.count, 0),
      node_(model.vertices.count, -1),
      vertex_(model.vertices.count) {
  std::iota(vertex_.begin(), vertex_.end(), 0);
  springs_ = of_springs();
  for (Index const vertex : model_.vertices.on_axis.download()) on_axis_[vertex] = 1;
  for (std::size_t k = 0; k < model.elements.node.size(); ++k)
    if (int const node = model.elements.node[k]; node >= 0) {
      Index const vertex = model.vertex_of(static_cast<Index>(k / C), static_cast<Index>(k % C));
      if (node >= static_cast<int>(node_mass_.size())) node_mass_.resize(node + 1, 0);
      if (node_[vertex] < 0) node_[vertex] = node, node_mass_[node] += model.vertices.inertia[vertex];
    }
}

template <int D, class Real>
void StableStep<D, Real>::start(Moment const& now) {
  measure(now);
  share_ = body_share_ = std::min(1.0, share_);  // at rest the bound is rigorous
  viscous_share_ = std::min(1.0, viscous_share_);
  set(now);
  first_ = limit_.automatic;
  look_ = now.step + 1;
}

template <int D, class Real>
void StableStep<D, Real>::follow(Moment const& now) {
  if (now.step < look_) return choose(now);
  auto const deformation = element_deformation(device_, model_, scene_);
  bool const regular = now.step >= refresh_,
             changed = deformation.grown(measured_at_) > (regular ? step::slight : step::noticeable) ||
                       (regular && measured_at_.grown(deformation) > step::slight);
  lost_ += static_cast<double>(now.step - looked_) * (1 - std::sqrt(bound_.total * share_ / squared_frequency()));
  looked_ = now.step;
  if (changed || touched_anew(now, regular)) {
    measure(now, changed);
  } else if (regular) {
    bound_ = frequency_bound();
    refresh_ = now.step + step::regular;
  } else {
    look_again(now, deformation.rate);
    return choose(now);
  }
  auto const rows = know(now.contact);
  room_ = room_for(rows);
  excess_ = std::max(step::noticeable * now.excess, 0.8 * excess_);
  set(now);
  look_again(now, deformation.rate);
  if (!scene_.run.dt && limit_.automatic < step::least_share * first_)
    throw Error(
        fmt::format("step {}, t = {:.6g} s: the stable step has fallen from {:.4g} to {:.4g} s ({}): what limits it is "
                    "crushed; a stronger joint or contact, a finer mesh or another integration may help",
                    now.step, now.time, first_, limit_.automatic, limit_.owner));
}

/// The next look is due before any element can have been strained by `strain_between`. Bodies that flow, and
/// fragments between others, may be given that speed only after this look; elastic ones change slowly.
template <int D, class Real>
void StableStep<D, Real>::look_again(Moment const& now, double rate) {
  double const longest = model_.plan.plastic ? 10 : now.cracked ? 20 : 50;
  double const steps = std::clamp(step::strain_between / (rate * limit_.dt), 1.0, longest);
  look_ = std::min(refresh_, now.step + static_cast<long>(steps));
}

/// Measuring pays where the bounds of new contacts have taken as much of the run as it costs (then both together are at
/// most twice the least that could have been lost), and where contacts that were measured have parted.
template <int D, class Real>
bool StableStep<D, Real>::touched_anew(Moment const& now, bool regular) const {
  if (now.contact.list == measured_list_) return false;
  if (squared_frequency() > step::noticeable * bound_.total * share_) return lost_ >= cost_;
  if (!regular || measured_rows_.empty()) return false;
  auto const rows = now.contact.rows(model_.vertices.inertia);
  return *std::max_element(rows.begin(), rows.end()) <
         *std::max_element(measured_rows_.begin(), measured_rows_.end()) / step::noticeable;
}

/// Not `bodies`: what was measured of them stands.
template <int D, class Real>
void StableStep<D, Real>::measure(Moment const& now, bool bodies) {
  double const of_bodies = bound_.total * body_share_;
  lost_ = cost_ = 0;
  bound_ = frequency_bound();
  if (bodies) measured_at_ = element_deformation(device_, model_, scene_);
  share_ = body_share_ = (bodies ? step::spare * top_eigenvalue() : of_bodies) / bound_.total;
  if (!now.contact.faces.empty()) share_ = step::spare * top_eigenvalue(now.contact) / bound_.total;
  measured_rows_ = now.contact.rows(model_.vertices.inertia);
  measured_list_ = now.contact.list;
  // Dampers of hourglass modes are not linear at the state they calm: there the bound stays.
  bool const linear = std::none_of(model_.groups.begin(), model_.groups.end(), [](model::Group const& group) {
    return group.damping.on() && group.hourglasses<D>();
  });
  if (bodies) viscous_share_ = bound_.viscosity > 0 && linear ? step::spare * top_viscosity() / bound_.viscosity : 1;
  refresh_ = now.step + step::regular;
}

/// Their rows, and how fast the stiffest of them bounces where some have `joined`: of the bodies' surfaces, and of a
/// vertex alone.
template <int D, class Real>
std::vector<double> StableStep<D, Real>::know(SpringBeds<D> const& beds, std::size_t joined) {
  known_list_ = beds.list;
  bounce_ = beds.bounce(node_, node_mass_, joined);
  alone_ = beds.bounce(vertex_, model_.vertices.inertia, joined);
  return beds.rows(model_.vertices.inertia);
}

/// omega^2 beyond what was measured, for beds that were not there then. Two bounds hold, and the smaller one is taken:
/// what was measured and the largest of their rows (Weyl), and the largest sum of all that hangs on a vertex
/// (Gershgorin).
template <int D, class Real>
double StableStep<D, Real>::room_for(std::vector<double> const& rows) const {
  double grown = 0, whole = bound_.total;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    double const measured = measured_rows_.empty() ? 0 : measured_rows_[i];
    if (rows[i] <= step::slight * measured) continue;
    grown = std::max(grown, rows[i] - measured);
    whole = std::max(whole, bound_.of_vertex[i] + rows[i]);
  }
  return grown > 0 ? std::max(0.0, std::min(grown, whole - bound_.total * share_)) : 0;
}

/// Of bodies and beds [1/s^2]. A vertex with faces that look several ways is not pressed on all of them at once: so
/// what one of them takes is added to what was measured of the bodies alone, where that is less.
template <int D, class Real>
double StableStep<D, Real>::squared_frequency() const {
  return std::min(bound_.total * share_ + room_, bound_.total * body_share_ + alone_);
}

/// Beds are there before anything touches; contacts that overlap deeply may be stiffer.
template <int D, class Real>
void StableStep<D, Real>::heed_contact(Moment const& now) {
  bool more = false;
  if (now.contact.list != known_list_) {
    std::size_t const joined = now.contact.list == known_list_ + 1 ? now.contact.joined : 0;
    double const before = bounce_, alone = alone_, room = room_for(know(now.contact, joined));
    more = room > room_ || bounce_ > before || alone_ > alone;
    room_ = std::max(room, room_), bounce_ = std::max(bounce_, before), alone_ = std::max(alone_, alone);
  }
  if (now.excess > excess_) excess_ = step::noticeable * now.excess, more = true;
  if (more) set(now);
}

template <int D, class Real>
void StableStep<D, Real>::set(Moment const& now) {
  double const damping = mass_damping() + springs_.damping, contact = bounce_ + excess_;
  limit_.stable =
      stable_step(squared_frequency() + excess_ + springs_.total, bound_.viscosity * viscous_share_ + damping);
  limit_.bound = stable_step(bound_.total + springs_.total, bound_.viscosity + damping);
  // Contact that begins or ends within a step gives or takes energy, the more the fewer steps it lasts.
  double const followed = contact > 0 ? step::of_contact / std::sqrt(contact) : limit_.stable;
  double automatic = scene_.run.safety * std::min(limit_.stable, followed);
  // Leapfrog keeps energy at a constant step: one that followed every breath of the bodies, and every contact that
  // parts, would pump it. Only what the step before took for contacts that are measured now is given back at once.
  bool const just_shrunk = now.step <= shrunk_ + 1;
  double const longest = std::max(step::noticeable * limit_.automatic, just_shrunk ? before_ : 0);
  if (limit_.automatic > 0) automatic = std::min(automatic, longest);
  if (automatic < limit_.automatic) before_ = std::max(limit_.automatic, just_shrunk ? before_ : 0), shrunk_ = now.step;
  if (!(std::abs(automatic - limit_.automatic) < 0.05 * limit_.automatic)) limit_.automatic = automatic;
  limit_.owner = followed < limit_.stable || contact > bound_.total ? "contact" : bound_.owner;
  if (springs_.total > squared_frequency() || springs_.damping > bound_.viscosity + mass_damping())
    limit_.owner = "a spring's " + std::string(springs_.total > squared_frequency() ? "stiffness" : "damping");
  choose(now);
  if (!(limit_.dt > 0) || !std::isfinite(limit_.dt))
    throw Error(fmt::format("step {}, t = {:.6g} s: the time step is {:.4g} s, which is no step ({}); {}", now.step,
                            now.time, limit_.dt, limit_.owner,
                            sizeof(Real) == 4 ? advice_for_single : "are masses and stiffnesses right?"));
  double const asked = scene_.run.dt.value_or(limit_.dt);
  if (!warned_of_dt_ && asked > limit_.stable) {
    warned_of_dt_ = true;
    model_.warnings.push_back(
        fmt::format("dt = {:.4g} s is above the stable step {:.4g} s ({}){}; the run will probably blow up", asked,
                    limit_.stable, limit_.owner, now.step > 0 ? fmt::format(" since t = {:.4g} s", now.time) : ""));
  }
}

/// The step of the user's own or the automatic one, shortened so that a whole number of them ends when the run does:
/// all are alike, for leapfrog keeps the energy that belongs to its step.
template <int D, class Real>
void StableStep<D, Real>::choose(Moment const& now) {
  double const longest = scene_.run.dt.value_or(limit_.automatic), left = now.end - now.time;
  bool const at_end = now.step > 0 && std::abs(left) <= 1e-9 * limit_.dt;
  if (!at_end) limit_.dt = left > 0 ? left / std::ceil(left / longest * (1 - 1e-9)) : longest;
}

/// What the joints at each vertex add to the squared frequency there [1/s^2].
template <int D, class Real>
std::vector<double> StableStep<D, Real>::joint_rows() const {
  std::vector<double> rows(model_.vertices.count, 0);
  if (!model_.plan.joints) return rows;
  model_.each_set([&](auto const& set) {
    auto const area = set.areas(model_.interfaces).download(),
               stiffness = set.of(model_.interfaces).stiffness.download();
    for (auto const& group : model_.groups) {
      auto const& cells = set.range(group);
      for (Index cell = cells.first; group.split && cell < cells.first + cells.count; ++cell)
        for (int a = 0; a < set.faces; ++a)
          for (int i = 0; i < set.face_points; ++i) {
            Index const vertex = set.face_vertex(cell, a, i);
            Real const w = area[set.area_at(cell, a, i)] * set.area_share(cell, a, i);
            rows[vertex] += 2 * static_cast<double>(stiffness[kernels::blocked(cell, a, set.faces)]) *
                            static_cast<double>(w) / model_.vertices.mass[vertex];
          }
    }
  });
  return rows;
}

/// What sets the step, in words: the joints at element e, its size and shape, or damping.
template <int D, class Real>
std::string StableStep<D, Real>::owner(FrequencyBound const& bound, Index e, bool joints) const {
  auto const& material = scene_.materials[scene_.bodies[model_.elements.body[e]].material];
  double const damping = bound.viscosity + mass_damping();
  if (damping * damping > 4 * bound.total) return fmt::format("viscous damping, at element {}", number_of_cell_[e]);
  if (!joints) return fmt::format("element {}, its size and shape", number_of_cell_[e]);
  auto const penalty_of = [](laws::AnyJoint const& any) {
    return std::visit([](auto const& law) { return law.penalty; }, any);
  };
  double penalty = material.joint ? penalty_of(*material.joint) : 0;
  for (int a = 0; a < C && material.joint && model_.has_bonds(); ++a)
    penalty = std::max(penalty, penalty_of(model_.joint_law(scene_, {e, a})));
  return fmt::format("joints of element {}, penalty {:.3g} E", number_of_cell_[e], penalty / material.elastic().young);
}

/// Of springs alone: Gershgorin's bound for B^T M^-1 B, a row for each of them, which shares what it has with others at
/// its vertices.
template <int D, class Real>
typename StableStep<D, Real>::OfSprings StableStep<D, Real>::of_springs() const {
  std::size_t const n = model_.springs.size();
  auto const mobility = [&](std::size_t s) {  // of its length per force [1/kg]
    double sum = 0;
    for (auto const& end : model_.springs[s].ends)
      for (auto const& at : end)
        sum += std::pow(static_cast<double>(at.share[0]), 2) / model_.vertices.inertia[at.vertex];
    return sum;
  };
  auto const meet = [&](std::size_t s, std::size_t other) {
    for (auto const& end : model_.springs[s].ends)
      for (auto const& at : end)
        for (auto const& beyond : model_.springs[other].ends)
          for (auto const& there : beyond)
            if (at.vertex == there.vertex) return true;
    return false;
  };
  OfSprings most;
  for (std::size_t s = 0; s < n; ++s) {
    double total = 0, damping = 0;
    for (std::size_t other = 0; other < n; ++other) {
      if (!meet(s, other) && s != other) continue;
      auto const row = [&](double scene::Spring::*of) {
        return 0.5 * (scene_.springs[s].*of * mobility(s) + scene_.springs[other].*of * mobility(other));
      };
      total += row(&scene::Spring::stiffness), damping += row(&scene::Spring::damping);
    }
    most.total = std::max(most.total, total), most.damping = std::max(most.damping, damping);
  }
  return most;
}

/// While bodies settle it is the settling's own: critical for the slowest vibration.
template <int D, class Real>
double StableStep<D, Real>::mass_damping() const {
  if (!scene_.settling) return scene_.run.mass_damping;
  double const calming = scene_.settling->damping.value_or(2 * model_.slowest_vibration(scene_));
  return std::max(scene_.run.mass_damping, calming);
}

template <int D, class Real>
FrequencyBound StableStep<D, Real>::frequency_bound() const {
  FrequencyBound bound;
  auto const u = model_.vertices.u.download();
  std::vector<double> bulk(model_.vertices.count, 0);
  std::vector<Index> worst_element(model_.vertices.count, -1);
  std::vector<double> worst(model_.vertices.count, 0);
  double viscosity = 0;
  for (auto const& group : model_.groups) {
    if (group.rigid) continue;
    auto const& material = scene_.materials[scene_.bodies[group.body].material];
    double const stiffness = material.elastic().confined();
    double const density = material.density * scene_.run.mass_scaling;
    for (Index e = group.first; e < group.first + group.count; ++e) {
      if (model_.elements.cell[e] < 0 || model_.cell_head(e) != e) continue;
      auto const vertices = model_.cell_vertices(e);
      auto const volumes = model_.corner_volumes(e);
      double const squared = stiffness / density * model_.squared_gradients(u, e, volumes, on_axis_);
      viscosity = std::max(viscosity, group.damping.per_squared_frequency(stiffness) * squared);
      for (std::size_t a = 0; a < vertices.size(); ++a) {
        Index const vertex = vertices[a];
        bulk[vertex] += squared * density * volumes[a] / model_.vertices.mass[vertex];
        if (squared > worst[vertex]) worst[vertex] = squared, worst_element[vertex] = e;
      }
    }
  }
  bound.viscosity = viscosity;
  auto const joint = joint_rows();
  Index stiffest = -1;
  bound.of_vertex.assign(model_.vertices.count, 0);
  for (Index i = 0; i < model_.vertices.count; ++i) {
    if (!(model_.vertices.mass[i] > 0)) continue;
    bound.of_vertex[i] = bulk[i] + joint[i];
    if (bound.of_vertex[i] > bound.total) bound.total = bound.of_vertex[i], stiffest = i;
  }
  if (stiffest >= 0) bound.owner = owner(bound, worst_element[stiffest], joint[stiffest] > bulk[stiffest]);
  return bound;
}

/// Both until forces are computed again.
template <int D, class Real>
std::span<Real const> StableStep<D, Real>::vertex_forces(ElementRun const& run) {
  element_forces(device_, model_, scene_, run);
  return summed_forces();
}
template <int D, class Real>
std::span<Real const> StableStep<D, Real>::summed_forces() {
  if (model_.plan.shared)
    for_each(device_, 0, model_.vertices.count,
             kernels::SumCorners<D, Real>{model_.corner_force(), model_.slots.first.data(), model_.slots.list.data(),
                                          model_.vertex_force()});
  return model_.vertices.force.look(forces_);
}

/// K x is a difference of forces. Of laws that flow it is that of the elastic trial, which unloading has at any time;
/// joints have the stiffness of their first rise, which they have again as soon as they close. Nothing is remembered
/// of it.
template <int D, class Real>
double StableStep<D, Real>::top_eigenvalue(SpringBeds<D> const& beds, int most_iterations, double tolerance) {
  std::size_t const n = static_cast<std::size_t>(model_.vertices.count) * D;
  auto const u = model_.vertices.u.download(), v = model_.vertices.v.download();
  // So small that forces are linear, so large that the difference has digits; a joint feels nothing else and may take
  // less.
  double const length = 1 / std::sqrt(element_deformation(device_, model_, scene_).gradients);
  double const small = length * (sizeof(Real) == 8 ? 1e-7 : 1e-3), smallest = length * 1e-10;

  ElementRun const run{.dt = 1, .probe = true};
  model_.vertices.v.upload(std::vector<Real>(n, 0));
  auto const at_base = vertex_forces(run);
  std::vector<Real> const base(at_base.begin(), at_base.end());
  FrozenJoints<D, Real> joints;
  auto& corners = model_.plan.shared ? model_.slots.force : model_.vertices.force;
  if (model_.plan.joints) joints = freeze_joints(device_, model_);

  double const top = lanczos(
      [&](std::vector<double> const& x, double largest, std::vector<double>& y) {
        auto const moved = [&](std::size_t i) { return u[i] + static_cast<Real>(x[i] * (small / largest)); };
        step::fill(device_, model_.vertices.u, moved);
        step::fill(device_, model_.vertices.v,
                   [&](std::size_t i) { return moved(i) - u[i]; });  // what is left beside u
        auto const bulk = vertex_forces(run);
        step::over(device_, n, [&](std::size_t i) {
          y[i] = (static_cast<double>(base[i]) - static_cast<double>(bulk[i])) * (largest / small);
        });
        beds.add(x, 1 / step::spare, y);  // they are bounds, and need none to spare
        if (!model_.plan.joints) return;
        step::fill(device_, joints.u, [&](std::size_t i) { return static_cast<Real>(x[i] * (smallest / largest)); });
        step::fill(device_, corners, [](std::size_t) { return Real(0); });
        joint_forces(device_, model_, scene_, joints);
        auto const pulls = summed_forces();
        step::over(device_, n, [&](std::size_t i) { y[i] -= static_cast<double>(pulls[i]) * (largest / smallest); });
      },
      most_iterations, tolerance);
  model_.vertices.u.upload(u), model_.vertices.v.upload(v);
  model_.flags.upload_one(model::Notice::fault, 0);
  return top;
}

/// Forces of viscosity are linear in velocities; in a step of no length nothing else changes.
template <int D, class Real>
double StableStep<D, Real>::top_viscosity(int most_iterations, double tolerance) {
  std::size_t const n = static_cast<std::size_t>(model_.vertices.count) * D;
  auto const v = model_.vertices.v.download();
  auto const deformation = element_deformation(device_, model_, scene_);
  double const fast =
      std::sqrt(deformation.frequency / deformation.gradients);  // where its stress is about the largest elastic one

  ElementRun const run{.dt = 0, .probe = true, .viscous = true};
  model_.vertices.v.upload(std::vector<Real>(n, 0));
  auto const at_base = vertex_forces(run);
  std::vector<Real> const base(at_base.begin(), at_base.end());
  double const top = lanczos(
      [&](std::vector<double> const& x, double largest, std::vector<double>& y) {
        step::fill(device_, model_.vertices.v,
                   [&](std::size_t i) { return static_cast<Real>(x[i] * (fast / largest)); });
        auto const forces = vertex_forces(run);
        step::over(device_, n, [&](std::size_t i) {
          y[i] = (static_cast<double>(base[i]) - static_cast<double>(forces[i])) * (largest / fast);
        });
      },
      most_iterations, tolerance);
  model_.vertices.v.upload(v);
  model_.flags.upload_one(model::Notice::fault, 0);
  return top;
}

/// Top eigenvalue of M^-1 A; apply(x, largest, y) makes y = A x, `largest` the size of the largest number of x.
///
/// Lanczos without reorthogonalization: the largest Ritz value is found all the same, and two vectors are enough. The
/// residual that is left belongs to the value (Zhou & Li 2011, doi 10.1016/j.laa.2010.06.034: with it, it is a bound
/// in practice).
template <int D, class Real>
template <class Apply>
double StableStep<D, Real>::lanczos(Apply&& apply, int most_iterations, double tolerance) {
  // In q = M^1/2 x the operator is symmetric.
  std::size_t const n = static_cast<std::size_t>(model_.vertices.count) * D;
  std::vector<double> root(n, 0), q(n, 0), before(n, 0), x(n), y(n);
  std::uint64_t random = 88172645463325252ull;
  double norm = 0;
  for (Index vertex = 0; vertex < model_.vertices.count; ++vertex)
    for (int c = 0; c < D; ++c) {
      random ^= random << 13, random ^= random >> 7, random ^= random << 17;
      bool const stays = !(model_.vertices.mass[vertex] > 0) || (c == 0 && on_axis_[vertex]);  // no radius on the axis
      if (stays) continue;
      std::size_t const i = static_cast<std::size_t>(vertex) * D + c;
      root[i] = std::sqrt(model_.vertices.inertia[vertex]);
      q[i] = root[i] * (static_cast<double>(random >> 11) / (1ull << 53) - 0.5);
      norm += q[i] * q[i];
    }
  norm = std::sqrt(norm);
  for (double& value : q) value /= norm;

  std::vector<double> diagonal, beside;
  for (int it = 1;; ++it) {
    step::over(device_, n, [&](std::size_t i) { x[i] = root[i] > 0 ? q[i] / root[i] : 0; });
    double largest = 0;
    for (double const value : x) largest = std::max(largest, std::abs(value));
    apply(x, largest, y);
    cost_ += step::per_product;
    double const alpha = step::sum_over(device_, n, [&](std::size_t i, double& sum) {
      y[i] = root[i] > 0 ? y[i] / root[i] : 0;
      if (it > 1) y[i] -= beside.back() * before[i];
      sum += y[i] * q[i];
    });
    double const beta = std::sqrt(step::sum_over(device_, n, [&](std::size_t i, double& sum) {
      y[i] -= alpha * q[i];
      sum += y[i] * y[i];
    }));
    diagonal.push_back(alpha);
    bool const ended = it == most_iterations || !(beta > 1e-9 * std::abs(alpha));
    if (ended || (it >= 16 && it % 8 == 0)) {
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
      Eigen::Map<Eigen::VectorXd const> const alphas(diagonal.data(), it), betas(beside.data(), it - 1);
      solver.computeFromTridiagonal(alphas, betas, Eigen::ComputeEigenvectors);
      double const value = solver.eigenvalues()[it - 1],
                   residual = beta * std::abs(solver.eigenvectors()(it - 1, it - 1));
      if (ended || residual < tolerance * value) return value + residual;
    }
    beside.push_back(beta);
    before.swap(q);
    step::over(device_, n, [&](std::size_t i) { q[i] = y[i] / beta; });
  }
}

template <int D, class Real>
void StableStep<D, Real>::save(State& state) const {
  std::vector<double> numbers;
  for (double const* number : numbers_of(*this)) numbers.push_back(*number);
  state["step limit"] = state_bytes(numbers);
  state["step limit looks"] =
      state_bytes(std::vector<long>{look_, refresh_, known_list_, measured_list_, looked_, shrunk_});
  state["step limit of vertices"] = state_bytes(bound_.of_vertex);
  state["measured beds"] = state_bytes(measured_rows_);
  for (auto const& [name, text] : {std::pair{"owner", &limit_.owner}, {"owner of the bound", &bound_.owner}})
    state[name] = state_bytes(std::vector<char>(text->begin(), text->end()));
}

template <int D, class Real>
void StableStep<D, Real>::restore(State const& state) {
  auto const places = numbers_of(*this);
  auto const numbers = state_values<double>(state, "step limit", places.size());
  for (std::size_t i = 0; i < places.size(); ++i) *places[i] = numbers[i];
  auto const looks = state_values<long>(state, "step limit looks", 6);
  look_ = looks[0], refresh_ = looks[1], known_list_ = looks[2], measured_list_ = looks[3], looked_ = looks[4],
  shrunk_ = looks[5];
  auto const vertices = static_cast<std::size_t>(model_.vertices.count);
  bound_.of_vertex = state_values<double>(state, "step limit of vertices", vertices);
  measured_rows_ = state_values<double>(state, "measured beds", vertices);
  for (auto const& [name, text] : {std::pair{"owner", &limit_.owner}, {"owner of the bound", &bound_.owner}}) {
    auto const letters = state_values<char>(state, name);
    text->assign(letters.begin(), letters.end());
  }
}

}  // namespace fissure
