// Choosing the kernel for a material: the only place where laws meet kernels.
#pragma once
#include "laws/plane_stress.h"
#include "model/model.h"

namespace fissure {

/// What one pass over the elements of a model needs besides the model.
struct ElementRun {
  bool plane_stress = false;
  double dt = 0;                // of the step that led here [s]
  bool probe = false;           // forces of the displacements as they are, one small step from rest; nothing is remembered
};

/// Forces of all elements and joints. Instantiated for each dimension and precision in src2d and src3d.
template <int D, class Real>
void element_forces(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run);

/// Elastic energy, energy held in joints, and in springs against hourglass modes of blocks [J].
template <int D, class Real>
Sums<3> element_energy(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run);

/// Cauchy stress [element][6] into device memory.
template <int D, class Real>
void element_stress(Device& device, model::Model<D, Real>& model, scene::Scene const& scene, ElementRun const& run, double* stress);

/// Largest sum of squared shape function gradients among elements that flow or can crack, as they are now [1/m^2].
template <int D, class Real>
double largest_gradients(Device& device, model::Model<D, Real>& model, scene::Scene const& scene);

}  // namespace fissure
