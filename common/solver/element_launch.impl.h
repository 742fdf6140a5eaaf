// One kernel per (elastic law, joint law); instantiated by src2d and src3d.
#pragma once
#include "kernels/insertion.h"
#include "solver/element_launch.h"

namespace fissure {

namespace launch {

/// f(bulk law, joint law or nullptr) for a material, with its joint law if it is `jointed`.
template <int D, class F>
void with_laws(scene::Material const& material, std::optional<laws::Plastic> const& plastic, bool jointed,
               bool plane_stress, F&& f) {
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
Kernel prepared(model::Model<D, Real>& model, model::Group const& group, Bulk const& bulk,
                [[maybe_unused]] Joint const* joint) {
  Kernel kernel;
  kernel.mesh = model.view();
  kernel.bulk = bulk;
  kernel.damping = group.damping;
  if constexpr (Bulk::remembers) {
    kernel.memory = model.memory_view(group);
    kernel.patches = model.patch_view(group);
  }
  if constexpr (Kernel::jointed) {
    kernel.joints = model.joint_view(group);
    kernel.joint.memory = model.joint_memory();
    kernel.joint.law = *joint;
    kernel.joint.law.prepare();
    kernel.joint.bonds = model.interfaces.template bonds<std::remove_cv_t<Joint>>();
    kernel.joint.on_demand = group.inserted;
  }
  return kernel;
}

/// Every pass over the elements of a model that are cells, with the joints around them; where some cells of a body are
/// blocks, the joints in a pass of their own. go(kernel, group) runs one.
template <int D, class Real, template <int, class, class, class> class Kernel, class Run>
void over_groups(model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run, Run&& go) {
  for (auto const& group : model.groups) {
    if (group.simplices.padded == 0 || group.rigid) continue;
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    with_laws<D>(material, group.plastic, group.fused_joints() && !run.probe, model.section.plane_stress(),
                 [&]<class Bulk, class Joint>(Bulk const& bulk, Joint const* joint) {
                   auto kernel = prepared<Kernel<D, Real, Bulk, std::remove_cv_t<Joint>>>(model, group, bulk, joint);
                   go(kernel, group);
                 });
    if (!group.split || group.fused_joints() || run.probe) continue;
    std::visit(
        [&]<class Joint>(Joint const& joint) {
          auto kernel =
              prepared<Kernel<D, Real, kernels::JointsOnly, Joint>>(model, group, kernels::JointsOnly{}, &joint);
          go(kernel, group);
        },
        *material.joint);
  }
}

/// Every pass over blocks with its views and law set: go(kernel, group).
template <int D, class Real, template <int, class, class> class Kernel, class Run>
void over_blocks(model::Model<D, Real>& model, scene::Scene const& scene, Run&& go) {
  for (auto const& group : model.groups) {
    if (group.blocks.padded == 0 || group.rigid) continue;
    with_laws<D>(scene.materials.at(scene.bodies[group.body].material), group.plastic, false,
                 model.section.plane_stress(), [&]<class Bulk, class Joint>(Bulk const& bulk, Joint const*) {
                   if constexpr (std::is_same_v<Joint, void>) {
                     Kernel<D, Real, Bulk> kernel;
                     kernel.mesh = model.view();
                     kernel.blocks = model.block_view(group, scene);
                     kernel.bulk = bulk;
                     kernel.damping = group.damping;
                     if constexpr (Bulk::remembers) kernel.memory = model.block_memory_view(group);
                     go(kernel, group);
                   }
                 });
  }
}

/// A pass over the joints around a body's blocks, if it can crack and has some: go(kernel).
template <template <int, class, class> class Kernel, int D, class Real, class Run>
void with_block_joints(model::Model<D, Real>& model, scene::Scene const& scene, model::Group const& group, Run&& go) {
  if (!group.split || group.blocks.padded == 0) return;
  std::visit(
      [&]<class Joint>(Joint const& joint) {
        Kernel<D, Real, Joint> kernel;
        kernel.mesh = model.view();
        kernel.blocks = model.block_joint_view(group);
        kernel.joint.memory = model.block_joint_memory(group);
        kernel.joint.law = joint;
        kernel.joint.law.prepare();
        kernel.joint.bonds = model.interfaces.template bonds<Joint>();
        kernel.joint.on_demand = group.inserted;
        go(kernel);
      },
      *scene.materials.at(scene.bodies[group.body].material).joint);
}

}  // namespace launch

/// Pressure of patches, where a body averages it.
template <int D, class Real>
void average_pressure(Device& device, model::Model<D, Real>& model) {
  for (auto const& group : model.groups) {
    if (group.patches == 0) continue;
    kernels::ElementSwelling<D, Real> swell;
    swell.mesh = model.view();
    swell.swelling = model.patches.swelling.data();
    swell.whole = model.patches.volume.data();
    for_each(device, group.first, group.count, swell);
    for_each(device, group.first_patch, group.patches,
             kernels::PatchPressure<Real>{model.patches.first.data(), model.patches.list.data(),
                                          model.patches.swelling.data(), model.patches.volume.data(),
                                          model.patches.pressure.data(), model.patches.energy.data(),
                                          group.plastic->bulk(), group.plastic->patch_spring()});
  }
}

template <int D, class Real>
void element_forces(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run) {
  if (model.plan.patches) average_pressure(device, model);
  auto const set = [&](auto& kernel) {
    kernel.dt = run.dt;
    if (run.probe && !run.viscous) kernel.damping = {};
    if constexpr (requires { kernel.bulk.frozen; }) kernel.bulk.frozen = run.probe;
    kernel.viscous_work = model.elements.viscous_work.data();
    kernel.fault = model.flags.data();
    if constexpr (requires { kernel.least_volume; })
      if (scene.run.remove_crushed) kernel.least_volume = model::crushed;
  };
  auto const set_joint = [&](auto& kernel) {
    if constexpr (requires { kernel.joint.law; }) {
      kernel.joint.dt = run.dt;
      kernel.joint.viscous_work = model.elements.viscous_work.data();
    }
  };
  launch::over_groups<D, Real, kernels::ElementForces>(model, scene, run, [&](auto& kernel, model::Group const& group) {
    set(kernel);
    set_joint(kernel);
    kernel.force = model.element_force(group);
    for_each(device, group.first, group.simplices.padded, kernel);
  });
  launch::over_blocks<D, Real, kernels::BlockForces>(model, scene, [&](auto& kernel, model::Group const& group) {
    set(kernel);
    if (!group.split || run.probe) return for_each(device, 0, group.blocks.padded, kernel);
    launch::with_block_joints<kernels::BlockJoints>(model, scene, group, [&](auto& joints) {
      set_joint(joints);
      for_each(device, 0, group.blocks.padded, kernel, joints);
    });
  });
}

template <int D, class Real>
Sums<3> element_energy(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run) {
  Sums<3> total{};
  launch::over_groups<D, Real, kernels::ElementEnergy>(model, scene, run, [&](auto& kernel, model::Group const& group) {
    auto const sums = sum_over<2>(device, group.first, group.simplices.padded, kernel);
    for (int k = 0; k < 2; ++k) total[k] += sums[k];
  });
  launch::over_blocks<D, Real, kernels::BlockEnergy>(model, scene, [&](auto& kernel, model::Group const& group) {
    auto const sums = sum_over<2>(device, 0, group.blocks.padded, kernel);
    total[0] += sums[0], total[2] += sums[1];
  });
  for (auto const& group : model.groups)
    launch::with_block_joints<kernels::BlockJointEnergy>(
        model, scene, group, [&](auto& kernel) { total[1] += sum_over<1>(device, 0, group.blocks.padded, kernel)[0]; });
  return total;
}

template <int D, class Real>
void element_stress(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run,
                    double* stress) {
  launch::over_groups<D, Real, kernels::ElementStress>(model, scene, run, [&](auto& kernel, model::Group const& group) {
    kernel.stress = stress;
    if constexpr (std::decay_t<decltype(kernel)>::whole) for_each(device, group.first, group.simplices.padded, kernel);
  });
  launch::over_blocks<D, Real, kernels::BlockStress>(model, scene, [&](auto& kernel, model::Group const& group) {
    kernel.stress = stress;
    for_each(device, 0, group.blocks.padded, kernel);
  });
}

/// The pass over the faces of simplices in a body.
template <template <int, class, class> class Kernel, class Joint, int D, class Real>
Kernel<D, Real, Joint> over_faces(model::Model<D, Real>& model, model::Group const& group, Joint const& law) {
  Kernel<D, Real, Joint> kernel;
  kernel.joint.law = law;
  kernel.joint.law.prepare();
  kernel.mesh = model.view();
  kernel.joints = model.joint_view(group);
  kernel.joint.memory = model.joint_memory();
  return kernel;
}

template <int D, class Real, class Joint>
void open_by_stress(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, model::Group const& group,
                    Joint const& joint) {
  kernels::StressedElements<D, Real> const near{model.interfaces.stress.data(), model.interfaces.stressed.data(),
                                                kernels::enough * model.interfaces.least_strength * joint.tension};
  if (sum_over<1>(device, group.first, group.count, near)[0] == 0) return;
  auto const set = [&](auto& kernel) {
    kernel.question.memory = kernel.joint.memory, kernel.question.law = kernel.joint.law;
    kernel.question.stress = model.interfaces.stress.data();
    kernel.question.reached = model.interfaces.stressed.data();
  };
  launch::with_block_joints<kernels::BlockRankine>(model, scene, group, [&](auto& kernel) {
    set(kernel);
    for_each(device, 0, group.blocks.padded, kernel);
  });
  if (group.simplices.padded == 0) return;
  auto kernel = over_faces<kernels::ElementRankine>(model, group, joint);
  set(kernel);
  for_each(device, group.first, group.simplices.padded, kernel);
}

template <int D, class Real, class Joint>
void insert_by_stress(Device& device, model::Model<D, Real>& model, scene::Scene const& scene,
                      model::Group const& group, Joint const& law, FacesFound const& found) {
  double const least = kernels::felt * model.interfaces.least_strength;
  kernels::StressedElements<D, Real> const near{model.interfaces.stress.data(), model.interfaces.stressed.data(),
                                                least * law.tension, least * law.shear};
  if (sum_over<1>(device, group.first, group.count, near)[0] == 0) return;
  auto const set = [&](auto& kernel, std::uint8_t* whole, kernels::FaceEvents const& events) {
    kernel.question.memory = kernel.joint.memory, kernel.question.law = kernel.joint.law;
    kernel.question.stress = model.interfaces.stress.data();
    kernel.question.reached = model.interfaces.stressed.data();
    kernel.question.whole = whole, kernel.question.found = events;
    kernel.question.rankine = group.rankine;
  };
  launch::with_block_joints<kernels::BlockInsertion>(model, scene, group, [&](auto& kernel) {
    auto events = found.of_blocks;
    events.first_cell = group.blocks.first;
    set(kernel,
        model.interfaces.block_joints.whole.data() +
            static_cast<std::size_t>(group.blocks.first) * BlockShape<D>::faces,
        events);
    for_each(device, 0, group.blocks.padded, kernel);
  });
  if (group.simplices.padded == 0) return;
  auto kernel = over_faces<kernels::ElementInsertion>(model, group, law);
  set(kernel, model.interfaces.joints.whole.data(), found.of_simplices);
  for_each(device, group.first, group.simplices.padded, kernel);
}

template <int D, class Real>
void start_by_stress(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run,
                     FacesFound const& found) {
  launch::over_groups<D, Real, kernels::ElementStress>(model, scene, run, [&](auto& kernel, model::Group const& group) {
    kernel.stress = model.interfaces.stress.data();
    if constexpr (std::decay_t<decltype(kernel)>::whole)
      if (group.rankine || group.inserted) for_each(device, group.first, group.simplices.padded, kernel);
  });
  launch::over_blocks<D, Real, kernels::BlockStress>(model, scene, [&](auto& kernel, model::Group const& group) {
    kernel.stress = model.interfaces.stress.data();
    if (group.rankine || group.inserted) for_each(device, 0, group.blocks.padded, kernel);
  });
  for (auto const& group : model.groups) {
    if (!group.rankine && !group.inserted) continue;
    std::visit(
        [&]<class Joint>(Joint const& joint) {
          if (group.inserted)
            insert_by_stress(device, model, scene, group, joint, found);
          else
            open_by_stress(device, model, scene, group, joint);
        },
        *scene.materials.at(scene.bodies[group.body].material).joint);
  }
}

template <int D, class Real>
Deformation element_deformation(Device& device, model::Model<D, Real>& model, scene::Scene const& scene) {
  Deformation largest;
  for (auto const& group : model.groups) {
    if (group.rigid) continue;
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    double const stiffness = material.elastic().confined();
    auto const add = [&](Sums<4> const& sums) {
      largest.gradients = std::max(largest.gradients, sums[0]);
      largest.frequency =
          std::max(largest.frequency, sums[0] * stiffness / (material.density * scene.run.mass_scaling));
      largest.rate = std::max(largest.rate, std::sqrt(sums[3]));
      if (group.plastic) return;  // the stiffness of their spatial tangent does not depend on stretch
      largest.stretch = std::max(largest.stretch, sums[1]);
      largest.squeeze = std::max(largest.squeeze, sums[2]);
    };
    kernels::ElementDeformation<D, Real> kernel;
    kernel.mesh = model.view();
    if (group.simplices.padded > 0) add(largest_over<4>(device, group.first, group.simplices.padded, kernel));
    kernels::BlockDeformation<D, Real> blocks;
    blocks.mesh = model.view();
    blocks.blocks = model.block_view(group, scene);
    if (group.blocks.padded > 0) add(largest_over<4>(device, 0, group.blocks.padded, blocks));
  }
  return largest;
}

template <int D, class Real>
FrozenJoints<D, Real> freeze_joints(Device& device, model::Model<D, Real>& model) {
  auto const u = model.vertices.u.download();
  auto X = model.elements.X.download(), corners = model.interfaces.block_corners.download();
  auto const move = [&](std::vector<Real>& x, Index cells, int n, auto&& vertex) {
    for (Index e = 0; e < cells; ++e)
      for (int a = 0; a < n; ++a)
        for (int c = 0; c < D; ++c)
          x[kernels::blocked(e, a * D + c, n * D)] += u[static_cast<std::size_t>(vertex(e, a)) * D + c];
  };
  model::Blocks<D, Real> const blocks(model);
  move(X, model.elements.count, D + 1, [&](Index e, int a) { return model.vertex_of(e, a); });
  move(corners, static_cast<Index>(corners.size() / (blocks.corners * D)), blocks.corners,
       [&](Index b, int a) { return blocks.vertex(b, a); });
  FrozenJoints<D, Real> joints;
  joints.X = Buffer<Real>(device, "moved corners", X);
  joints.block_corners = Buffer<Real>(device, "moved block corners", corners);
  joints.u = Buffer<Real>(device, "probe", model.vertices.u.size());
  auto const whole = [&](Buffer<std::uint8_t> const& like) {
    return Buffer<std::uint8_t>(device, "whole joints", std::vector<std::uint8_t>(like.size(), 0));
  };
  joints.softening = whole(model.interfaces.joints.softening),
  joints.block_softening = whole(model.interfaces.block_joints.softening);
  return joints;
}

/// A probe feels the spring of a joint alone, however weak it is: nothing breaks.
template <class Joint>
void never_break(Joint& joint) {
  joint.tension = joint.shear = std::numeric_limits<double>::infinity();
}

template <int D, class Real>
void joint_forces(Device& device, model::Model<D, Real>& model, scene::Scene const& scene,
                  FrozenJoints<D, Real>& joints) {
  for (auto const& group : model.groups) {
    if (!group.split) continue;
    auto const& material = scene.materials.at(scene.bodies[group.body].material);
    if (group.simplices.padded > 0)
      std::visit(
          [&]<class Joint>(Joint const& joint) {
            auto kernel = launch::prepared<kernels::ElementForces<D, Real, kernels::JointsOnly, Joint>>(
                model, group, kernels::JointsOnly{}, &joint);
            kernel.mesh.X = joints.X.data(), kernel.mesh.u = joints.u.data();
            kernel.joint.memory.softening = joints.softening.data();
            kernel.joint.on_demand = false;  // where they may be inserted, too
            never_break(kernel.joint.law);
            kernel.force = model.element_force(group);
            for_each(device, group.first, group.simplices.padded, kernel);
          },
          *material.joint);
    launch::with_block_joints<kernels::BlockJoints>(model, scene, group, [&](auto& kernel) {
      std::size_t const first = group.blocks.first;
      kernel.mesh.u = joints.u.data();
      kernel.blocks.X = joints.block_corners.data() + first * (BlockShape<D>::corners * D);
      never_break(kernel.joint.law);
      kernel.joint.on_demand = false;
      kernel.joint.memory.softening =
          joints.block_softening.data() + first * BlockShape<D>::faces / kernels::layout_width;
      for_each(device, 0, group.blocks.padded, kernel);
    });
  }
}

}  // namespace fissure
