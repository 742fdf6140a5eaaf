// One kernel per (elastic law, joint law); instantiated by src2d and src3d.
#pragma once
#include "solver/element_launch.h"

namespace fissure {

namespace launch {

/// f(bulk law, joint law or nullptr) for a material, with its joint law if it is `jointed`.
template <int D, class F>
void with_laws(scene::Material const& material, std::optional<laws::Plastic> const& plastic, bool jointed, bool plane_stress, F&& f) {
  auto const with_joint = [&](auto const& bulk) {
    if (jointed)
      std::visit([&](auto const& joint) { f(bulk, &joint); }, *material.joint);
    else
      f(bulk, static_cast<void const*>(nullptr));
  };
  if (plastic) return with_joint(*plastic);
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

/// A pass over elements with its views and laws set.
template <class Kernel, int D, class Real, class Bulk, class Joint>
Kernel prepared(model::Model<D, Real>& model, model::Group const& group, Bulk const& bulk, [[maybe_unused]] Joint const* joint) {
  Kernel kernel;
  kernel.mesh = model.view();
  kernel.bulk = bulk;
  kernel.viscosity = group.viscosity;
  if constexpr (Bulk::remembers) {
    kernel.memory = model.memory_view(group);
    kernel.patches = model.patch_view(group);
  }
  if constexpr (Kernel::jointed) {
    kernel.joints = model.joint_view();
    kernel.joints.vertex_shift = model.vertex_of(group.first, 0) - group.first * (D + 1);
    kernel.joint = *joint;
    kernel.joint.prepare();
  }
  return kernel;
}

/// Every pass over the elements of a model that have forces: simplices with the joints around them; in a body that has blocks
/// simplices alone, then the joints of all elements. go(kernel, first, count) runs one.
template <int D, class Real, template <int, class, class, class> class Kernel, class Run>
void over_groups(model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run, Run&& go) {
  for (auto const& group : model.groups) {
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    with_laws<D>(material, group.plastic, group.split && group.blocks == 0, run.plane_stress, [&]<class Bulk, class Joint>(Bulk const& bulk, Joint const* joint) {
      auto kernel = prepared<Kernel<D, Real, Bulk, std::remove_cv_t<Joint>>>(model, group, bulk, joint);
      if (group.simplices > 0) go(kernel, group.first, group.simplices);
    });
    if (!group.split || group.blocks == 0) continue;
    std::visit([&]<class Joint>(Joint const& joint) {
      auto kernel = prepared<Kernel<D, Real, kernels::JointsOnly, Joint>>(model, group, kernels::JointsOnly{}, &joint);
      if constexpr (requires { kernel.added; }) kernel.added = true;
      if (group.simplices > 0) go(kernel, group.first, group.simplices);
      if constexpr (requires { kernel.added; }) kernel.added = false;
      go(kernel, group.first + group.simplices, group.count - group.simplices);
    }, *material.joint);
  }
}

/// Every pass over blocks with its views and law set: go(kernel, count).
template <int D, class Real, template <int, class, class> class Kernel, class Run>
void over_blocks(model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run, Run&& go) {
  for (auto const& group : model.groups) {
    if (group.blocks == 0) continue;
    with_laws<D>(scene.materials.at(scene.bodies[group.body].material), group.plastic, false, run.plane_stress,
                 [&]<class Bulk, class Joint>(Bulk const& bulk, Joint const*) {
      if constexpr (std::is_same_v<Joint, void>) {
        Kernel<D, Real, Bulk> kernel;
        kernel.mesh = model.view();
        kernel.blocks = model.block_view(group, scene);
        kernel.bulk = bulk;
        kernel.viscosity = group.viscosity;
        if constexpr (Bulk::remembers) kernel.memory = model.block_memory_view(group);
        go(kernel, group.block_count);
      }
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
  auto const set = [&](auto& kernel) {
    kernel.dt = run.dt;
    kernel.probe = run.probe;
    kernel.viscous_work = model.viscous_work.data();
    kernel.fault = model.flags.data();
  };
  launch::over_groups<D, Real, kernels::ElementForces>(model, scene, run, [&](auto& kernel, Index first, Index count) {
    set(kernel);
    kernel.force = model.corner_force();
    for_each(device, first, count, kernel);
  });
  launch::over_blocks<D, Real, kernels::BlockForces>(model, scene, run, [&](auto& kernel, Index count) {
    set(kernel);
    for_each(device, 0, count, kernel);
  });
}

template <int D, class Real>
Sums<3> element_energy(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run) {
  Sums<3> total{};
  launch::over_groups<D, Real, kernels::ElementEnergy>(model, scene, run, [&](auto& kernel, Index first, Index count) {
    auto const sums = sum_over<2>(device, first, count, kernel);
    for (int k = 0; k < 2; ++k) total[k] += sums[k];
  });
  launch::over_blocks<D, Real, kernels::BlockEnergy>(model, scene, run, [&](auto& kernel, Index count) {
    auto const sums = sum_over<2>(device, 0, count, kernel);
    total[0] += sums[0], total[2] += sums[1];
  });
  return total;
}

template <int D, class Real>
void element_stress(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run, double* stress) {
  launch::over_groups<D, Real, kernels::ElementStress>(model, scene, run, [&](auto& kernel, Index first, Index count) {
    kernel.stress = stress;
    if constexpr (kernel.whole) for_each(device, first, count, kernel);
  });
  launch::over_blocks<D, Real, kernels::BlockStress>(model, scene, run, [&](auto& kernel, Index count) {
    kernel.stress = stress;
    for_each(device, 0, count, kernel);
  });
}

template <int D, class Real>
double largest_gradients(Device& device, model::Model<D, Real>& model, scene::Scene const& scene) {
  double largest = 0;
  for (auto const& group : model.groups) {
    if (!group.plastic && !group.split) continue;
    kernels::ElementGradients<D, Real> kernel;
    kernel.mesh = model.view();
    if (group.simplices > 0) largest = std::max(largest, largest_over<1>(device, group.first, group.simplices, kernel)[0]);
    if (group.blocks == 0) continue;
    kernels::BlockGradients<D, Real> blocks;
    blocks.mesh = model.view();
    blocks.blocks = model.block_view(group, scene);
    largest = std::max(largest, largest_over<1>(device, 0, group.block_count, blocks)[0]);
  }
  return largest;
}

}  // namespace fissure
