// One kernel per (elastic law, joint law); instantiated by src2d and src3d.
#pragma once
#include "solver/element_launch.h"

namespace fissure {

namespace launch {

/// f(bulk law, joint law or nullptr) for the group's material.
template <int D, class F>
void with_laws(scene::Material const& material, model::Group const& group, bool plane_stress, F&& f) {
  auto const with_joint = [&](auto const& bulk) {
    if (group.split)
      std::visit([&](auto const& joint) { f(bulk, &joint); }, *material.joint);
    else
      f(bulk, static_cast<void const*>(nullptr));
  };
  if (group.plastic) return with_joint(*group.plastic);
  std::visit(
      [&](auto const& law) {
        using Law = std::decay_t<decltype(law)>;
        if constexpr (Dim<D>::has_plane_stress) {
          if (plane_stress) return with_joint(laws::PlaneStress<Law>(law));
        }
        with_joint(law);
      },
      material.bulk);
}

/// The pass over one group with its views and laws set: kernel(pass) runs it.
template <int D, class Real, template <int, class, class, class> class Kernel, class Run>
void over_groups(model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run, Run&& go) {
  for (auto const& group : model.groups) {
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    with_laws<D>(material, group, run.plane_stress, [&]<class Bulk, class Joint>(Bulk const& bulk, Joint const* joint) {
      Kernel<D, Real, Bulk, std::remove_cv_t<Joint>> kernel;
      kernel.mesh = model.view();
      kernel.bulk = bulk;
      kernel.viscosity = group.viscosity;
      if constexpr (Bulk::remembers) {
        kernel.memory = model.memory_view(group);
        kernel.patches = model.patch_view(group);
      }
      if constexpr (kernel.jointed) {
        kernel.joints = model.joint_view();
        kernel.joints.vertex_shift = model.vertex_of(group.first, 0) - group.first * (D + 1);
        kernel.joint = *joint;
        kernel.joint.prepare();
      }
      go(kernel, group);
    });
  }
}

}  // namespace launch

/// Pressure of patches, where a body averages it.
template <int D, class Real>
void average_pressure(Device& device, model::Model<D, Real>& model) {
  for (auto const& group : model.groups) {
    if (group.patches == 0) continue;
    kernels::ElementSwelling<D, Real> swell;
    swell.mesh = model.view();
    swell.swelling = model.swelling.data();
    swell.whole = model.swelling_volume.data();
    for_each(device, group.first, group.count, swell);
    for_each(device, group.first_patch, group.patches,
             kernels::PatchPressure<Real>{model.patch_first.data(), model.patch_list.data(), model.swelling.data(), model.swelling_volume.data(),
                                          model.patch_pressure.data(), model.patch_energy.data(), group.plastic->bulk()});
  }
}

template <int D, class Real>
void element_forces(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run) {
  if (model.plan.patches) average_pressure(device, model);
  launch::over_groups<D, Real, kernels::ElementForces>(model, scene, run, [&](auto& kernel, model::Group const& group) {
    kernel.dt = run.dt;
    kernel.probe = run.probe;
    kernel.force = model.corner_force();
    kernel.viscous_work = model.viscous_work.data();
    kernel.fault = model.flags.data();
    for_each(device, group.first, group.count, kernel);
  });
}

template <int D, class Real>
Sums<2> element_energy(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run) {
  Sums<2> total{};
  launch::over_groups<D, Real, kernels::ElementEnergy>(model, scene, run, [&](auto& kernel, model::Group const& group) {
    auto const sums = sum_over<2>(device, group.first, group.count, kernel);
    for (int k = 0; k < 2; ++k) total[k] += sums[k];
  });
  return total;
}

template <int D, class Real>
void element_stress(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run, double* stress) {
  launch::over_groups<D, Real, kernels::ElementStress>(model, scene, run, [&](auto& kernel, model::Group const& group) {
    kernel.stress = stress;
    for_each(device, group.first, group.count, kernel);
  });
}

template <int D, class Real>
double largest_gradients(Device& device, model::Model<D, Real>& model) {
  double largest = 0;
  for (auto const& group : model.groups) {
    if (!group.plastic) continue;
    kernels::ElementGradients<D, Real> kernel;
    kernel.mesh = model.view();
    largest = std::max(largest, largest_over<1>(device, group.first, group.count, kernel)[0]);
  }
  return largest;
}

}  // namespace fissure
