// Every kernel there is, compiled for CUDA: what host files launch must stand here, or the program does not link. Laws are
// read from the lists in laws/laws.h. Only CUDA files include this, after dim.h and clip.h of their dimension.
#pragma once
#include <variant>

#include "backend/launch.cuh"
#include "kernels/advance.h"
#include "kernels/block_joints.h"
#include "kernels/blocks.h"
#include "kernels/contact.h"
#include "kernels/contact_sums.h"
#include "kernels/crack_faces.h"
#include "kernels/elements.h"
#include "kernels/loads.h"
#include "laws/laws.h"
#include "laws/plane_stress.h"

namespace fissure::kernels {

template <class... Kernels>
void compile_each() {
  (static_cast<void>(&cuda::launch<Kernels>), ...);
}
template <int n_sums, class Combine, class... Kernels>
void compile_sum() {
  (static_cast<void>(&cuda::launch_sum<n_sums, Combine, Kernels>), ...);
}

template <int D, class Real, class Bulk, class... Joints>
void compile_laws() {
  compile_each<ElementForces<D, Real, Bulk, Joints>...>();
  compile_each<ElementStress<D, Real, Bulk, Joints>...>();
  compile_sum<2, Add, ElementEnergy<D, Real, Bulk, Joints>...>();
  compile_each<BlockForces<D, Real, Bulk>, BlockStress<D, Real, Bulk>>();
  compile_sum<2, Add, BlockEnergy<D, Real, Bulk>>();
}

template <int D, class Real, class... Bulks, class... Joints>
void compile_elements(std::variant<Bulks...> const*, std::variant<Joints...> const*) {
  (compile_laws<D, Real, Bulks, void, Joints...>(), ...);
  compile_laws<D, Real, laws::Plastic, void, Joints...>();
  compile_each<ElementForces<D, Real, JointsOnly, Joints>...>();
  compile_sum<2, Add, ElementEnergy<D, Real, JointsOnly, Joints>...>();
  compile_each<BlockJoints<D, Real, Joints>...>();
  compile_sum<1, Add, BlockJointEnergy<D, Real, Joints>...>();
  if constexpr (Dim<D>::has_plane_stress) (compile_laws<D, Real, laws::PlaneStress<Bulks>, void, Joints...>(), ...);
}

/// All kernels over elements and joints.
template <int D, class Real>
void compile_elements() {
  compile_elements<D, Real>(static_cast<laws::AnyBulk*>(nullptr), static_cast<laws::AnyJoint*>(nullptr));
  compile_each<ElementSwelling<D, Real>, PatchPressure<Real>>();
  compile_sum<1, Larger, ElementGradients<D, Real>, BlockGradients<D, Real>>();
}

/// All others.
template <int D, class Real>
void compile_rest() {
  compile_each<Advance<D, Real>, SumCorners<D, Real>, AddLoad<D, Real>, StayOnAxis<D, Real>, PairForces<D, Real>, PlateForces<D, Real>, WallForces<D, Real>,
               CrackForces<D, Real>>();
  compile_sum<3 + D, Add, VertexEnergy<D, Real>>();
  compile_sum<1, Add, LoadWork<D, Real>, HoldMotion<D, Real>, ContactVertexWork<D, Real>, SumOf<Real>>();
  compile_sum<D + 1, Add, HoldReaction<D, Real>>();
  compile_sum<D, Add, Reaction<D, Real>>();
  compile_sum<1, Larger, AddContact<D, Real>, LargestOf<Real>>();
  compile_sum<4 * D, Larger, DriftSince<D, Real>>();
}

}  // namespace fissure::kernels
