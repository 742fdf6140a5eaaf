// Choosing the kernel for a material: the only place where laws meet kernels.
#pragma once
#include <algorithm>

#include "laws/plane_stress.h"
#include "model/model.h"

namespace fissure {

/// What one pass over the elements of a model needs besides the model.
struct ElementRun {
  double dt = 0;  // of the step that led here [s]
  // elastic forces after one small step: no flow, viscosity or joints, and nothing is remembered
  bool probe = false;
  bool viscous = false;  // a probe with viscosity
};

/// Forces of all elements and joints. Instantiated for each dimension and precision in src2d and src3d.
template <int D, class Real>
void element_forces(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run);

/// Averages pressure over patches where elements are now, where bodies do that.
template <int D, class Real>
void average_pressure(Device& device, model::Model<D, Real>& model);

/// Elastic energy, energy held in joints, and in springs against hourglass modes of blocks [J].
template <int D, class Real>
Sums<3> element_energy(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run);

/// Cauchy stress [element][6] into device memory.
template <int D, class Real>
void element_stress(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run,
                    double* stress);

/// Faces of simplices and of blocks where a joint is to be inserted.
struct FacesFound {
  kernels::FaceEvents of_simplices, of_blocks;
};

/// Lets joints begin where the stress beside them reaches their strength (kernels/rankine.h), and finds where bodies
/// that are still whole reach it (kernels/insertion.h).
template <int D, class Real>
void start_by_stress(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run,
                     FacesFound const& found);

/// What elements' tangents depend on: the largest over all elements.
struct Deformation {
  double gradients = 0;  // sum of squared gradients of shape functions now [1/m^2]
  double frequency = 0;  // that times E'/rho [1/s^2]
  double stretch = 0;    // |C|^2 and
  double squeeze = 0;    // |C^-1|^2 of elements that do not flow, C = F^T F
  double rate = 0;       // of strain, that could soon be anywhere [1/s]

  /// How much larger this is than another, at most.
  double grown(Deformation const& then) const {
    return std::max({frequency / then.frequency, stretch > 0 ? stretch / then.stretch : 0,
                     squeeze > 0 ? squeeze / then.squeeze : 0});
  }
};
template <int D, class Real>
Deformation element_deformation(Device& device, model::Model<D, Real>& model, scene::Scene const& scene);

/// Joints as new ones would be where elements are now: X is where corners are, u what moves them from there.
template <int D, class Real>
struct FrozenJoints {
  Buffer<Real> X, block_corners, u;
  Buffer<std::uint8_t> softening, block_softening;
};
template <int D, class Real>
FrozenJoints<D, Real> freeze_joints(Device& device, model::Model<D, Real>& model);

/// Adds their forces for their u to those of elements.
template <int D, class Real>
void joint_forces(Device& device, model::Model<D, Real>& model, scene::Scene const& scene,
                  FrozenJoints<D, Real>& joints);

}  // namespace fissure
