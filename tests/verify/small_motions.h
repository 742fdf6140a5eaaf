// What tests of the automatic step share: every section and cell, what bodies are made of, and the true limit by
// bisection.
#pragma once
#include <fmt/format.h>

#include <cstdlib>

#include "rig.h"
#include "solver/element_launch.h"

namespace fissure::verify {

/// Whether long loops go over all that they have; else over some of it.
inline bool nightly() { return std::getenv("FISSURE_TEST_LONG"); }

struct Kind {
  std::string section, cells, integration;
  std::string name() const { return section + ", " + cells + (cells == "block" ? " " + integration : ""); }
};

inline std::vector<Kind> kinds() {
  std::vector<Kind> list;
  auto const sections =
      flat ? std::vector<std::string>{"plane strain", "plane stress", "axisymmetric"} : std::vector<std::string>{"3D"};
  for (auto const& section : sections) {
    list.push_back({section, "simplex", "one_point"});
    for (char const* way : {"one_point", "assumed_strain", "full", "b_bar"}) list.push_back({section, "block", way});
  }
  return list;
}

/// Bodies in a frozen state whose small motions are marched by leapfrog: dead loads hold them where they are. Contacts
/// act as they are, without friction.
class SmallMotions {
 public:
  /// `elastic`: by the elastic trial of a law that flows; else by the forces of a step as they are.
  SmallMotions(Rig<>& rig, bool elastic) : rig_(rig), run_{elastic ? 1.0 : 0.0, elastic} {
    auto& model = rig.solver->model();
    u_ = model.vertices.u.download(), v_ = model.vertices.v.download();
    model.vertices.v.upload(std::vector<double>(u_.size(), 0));
    viscous_ =
        std::any_of(model.groups.begin(), model.groups.end(), [](auto const& group) { return group.damping.on(); });
    free_.assign(u_.size(), 1);
    for (Index i = 0; i < model.vertices.count; ++i)
      for (int c = 0; c < D && !(model.vertices.mass[i] > 0); ++c) free_[i * D + c] = 0;
    for (Index i : model.vertices.on_axis.download()) free_[i * D] = 0;
    if (elastic && model.plan.joints) joints_ = freeze_joints(rig_.device, model);  // an elastic trial leaves them out
    base_ = forces();
    // Seven turns of the operator: high modes prevail over slow ones, which dead loads can make grow at any step.
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(-1, 1);
    for (double& x : (start_.resize(u_.size()), start_)) x = number(random);
    for (std::size_t i = 0; i < u_.size(); ++i) start_[i] *= free_[i];
    for (int k = 0; k < 7; ++k) {
      start_ = acceleration(start_);
      double const size = norm(start_);
      for (double& x : start_) x /= size;
    }
  }
  ~SmallMotions() {
    rig_.solver->model().vertices.u.upload(u_), rig_.solver->model().vertices.v.upload(v_);
    rig_.solver->model().flags.upload_one(model::Notice::fault, 0);
  }
  SmallMotions(SmallMotions const&) = delete;

  /// 1 % above the limit the top mode grows by exp(2 acosh 1.01) = 1.33 a step, with changing sign: 1e14 in 120.
  /// What grows without it is a slow mode that dead loads push over, at any step. Every fourth step the operator itself
  /// thins such modes out: it multiplies one of the frequency w by (w dt/2)^2, which is above 1 for those that the step
  /// is too long for.
  bool blows_up(double dt, int steps = 120) {
    auto x = start_;
    std::vector<double> v(x.size(), 0);
    for (int k = 0; k < steps; ++k) {
      auto a = acceleration(x);
      if (viscous_) {  // on the velocity of half a step before
        auto const drag = viscous_acceleration(v);
        for (std::size_t i = 0; i < x.size(); ++i) a[i] += drag[i];
      }
      double along = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        v[i] += dt * a[i];
        double const next = x[i] + dt * v[i];
        along += next * x[i];
        x[i] = next;
      }
      if (!viscous_ && k % 4 == 3)
        for (auto* values : {&x, &v})
          for (double& value : * values = acceleration(*values)) value *= -dt * dt / 4;
      double const size = norm(x);
      if (!std::isfinite(size) || (size > 1e6 && along < 0)) return true;
      if (size > 1e6)
        for (auto* values : {&x, &v})
          for (double& value : *values) value /= size;
    }
    return false;
  }
  /// Largest step that does not blow up, to 0.3 %.
  double limit(double guess) {
    double low = guess;
    while (blows_up(low)) low /= 1.2;
    double high = 1.2 * low;
    while (!blows_up(high)) low = high, high *= 1.2;
    while (high > 1.003 * low) {
      double const middle = 0.5 * (low + high);
      (blows_up(middle) ? high : low) = middle;
    }
    return low;
  }

 private:
  std::vector<double> forces() {
    auto& model = rig_.solver->model();
    element_forces(rig_.device, model, rig_.scene, run_);
    sum_corners();
    rig_.solver->contact().add_forces(0, 0, 0);
    return model.vertices.force.download();
  }
  void sum_corners() {
    auto& model = rig_.solver->model();
    if (model.plan.shared)
      for_each(rig_.device, 0, model.vertices.count,
               kernels::SumCorners<D, double>{model.corner_force(), model.slots.first.data(), model.slots.list.data(),
                                              model.vertex_force()});
  }
  std::vector<double> acceleration(std::vector<double> const& x) {
    double const scale = 1e-9 / norm(x);
    auto moved = u_, step = x;
    for (std::size_t i = 0; i < x.size(); ++i) step[i] *= scale, moved[i] += step[i];
    auto& model = rig_.solver->model();
    model.vertices.u.upload(moved);
    if (run_.probe) model.vertices.v.upload(step);
    auto a = forces();
    for (std::size_t i = 0; i < x.size(); ++i) a[i] -= base_[i];
    if (joints_) {
      joints_->u.upload(step);
      (model.plan.shared ? model.slots.force : model.vertices.force)
          .upload(std::vector<double>(model.plan.shared ? model.slots.force.size() : x.size(), 0));
      joint_forces(rig_.device, model, rig_.scene, *joints_);
      sum_corners();
      auto const pulls = model.vertices.force.download();
      for (std::size_t i = 0; i < x.size(); ++i) a[i] += pulls[i];
    }
    for (std::size_t i = 0; i < x.size(); ++i) a[i] *= free_[i] ? 1 / (scale * model.vertices.mass[i / D]) : 0;
    return a;
  }
  std::vector<double> viscous_acceleration(std::vector<double> const& v) {
    double const scale = norm(v) > 0 ? 1 / norm(v) : 0;
    auto& model = rig_.solver->model();
    auto scaled = v;
    for (double& x : scaled) x *= scale;
    auto const run = run_;
    run_ = {0, true, true};
    model.vertices.u.upload(u_), model.vertices.v.upload(std::vector<double>(v.size(), 0));
    auto const base = forces();
    model.vertices.v.upload(scaled);
    auto a = forces();
    run_ = run;
    model.vertices.v.upload(std::vector<double>(v.size(), 0));
    for (std::size_t i = 0; i < v.size(); ++i)
      a[i] = free_[i] && scale > 0 ? (a[i] - base[i]) / (scale * model.vertices.mass[i / D]) : 0;
    return a;
  }
  static double norm(std::vector<double> const& x) {
    double sum = 0;
    for (double value : x) sum += value * value;
    return std::sqrt(sum);
  }

  Rig<>& rig_;
  ElementRun run_;
  bool viscous_ = false;
  std::vector<double> u_, v_, base_, start_;
  std::vector<char> free_;
  std::optional<FrozenJoints<D, double>> joints_;
};

/// Automatic step, but for its safety, over the true limit of the body as it is.
inline double found(Rig<>& rig, bool elastic = false) {
  double const step = rig.solver->step_limit().stable;
  return step / SmallMotions(rig, elastic).limit(step);
}

/// What a body is made of, beside its elastic constants.
struct Stuffing {
  std::string name;
  std::function<void(scene::Material&)> add = [](scene::Material&) {};
};

template <class Law = laws::CurvesFlow>
scene::Flow flow(std::vector<double> curve) {
  Law law;
  law.strains = static_cast<int>(curve.size() - 1) / 2, law.rates = 1;
  scene::Flow flow;
  flow.law = law, flow.curves = std::move(curve);
  return flow;
}

/// The elastic law alone, and every one that flows with every way to keep stress or pressure.
inline std::vector<Stuffing> stuffings() {
  auto const granular = [](double dilation) {
    return [=](scene::Material& m) {
      m.flow = flow<laws::DruckerPrager>({0, 0, 500 * MPa});
      auto& law = std::get<laws::DruckerPrager>(m.flow->law);
      law.friction_angle = 0.5, law.dilation_angle = dilation;
    };
  };
  return {
      {"elastic"},
      {"J2",
       [](scene::Material& m) {
         m.flow = flow({0, 0, 500 * MPa});
       }},
      {"J2, logarithmic strain",
       [](scene::Material& m) {
         m.flow = flow({0, 0, 500 * MPa}), m.flow->logarithmic = true;
       }},
      {"Drucker-Prager", granular(0)},
      {"Drucker-Prager, dilates", granular(0.5)},
      {"averaged pressure",
       [](scene::Material& m) {
         m.flow = flow({0, 0, 500 * MPa}), m.flow->averaged = true;
       }},
  };
}

}  // namespace fissure::verify
