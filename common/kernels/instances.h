// Every kernel there is, compiled for the backend whose file includes this: what host files launch must stand here, or
// the program does not link. Laws are read from the lists in laws/laws.h. Only files of kernels include this, after
// dim.h and clip.h of their dimension.
#pragma once
#include <variant>

#if defined(__CUDACC__)
#include "backend/launch.cuh"
#else
#include "backend/launch.h"
#endif
#include "kernels/advance.h"
#include "kernels/block_joints.h"
#include "kernels/blocks.h"
#include "kernels/contact_sums.h"
#include "kernels/crack_faces.h"
#include "kernels/elements.h"
#include "kernels/hanging.h"
#include "kernels/insertion.h"
#include "kernels/loads.h"
#include "kernels/rankine.h"
#include "kernels/rigid_contact.h"
#include "kernels/rigid_motion.h"
#include "laws/laws.h"
#include "laws/plane_stress.h"

namespace fissure::kernels {

#if defined(__CUDACC__)
namespace compiled = cuda;
#else
namespace compiled = cpu;
#endif

/// Makes the compiler write out f, which only host files call.
template <class F>
void keep(F* f) {
  F* volatile kept = f;
  static_cast<void>(kept);
}
template <class... Kernels>
void compile_each() {
  (keep(&compiled::launch<Kernels>), ...);
}
template <int n_sums, class Combine, class... Kernels>
void compile_sum() {
  (keep(&compiled::launch_sum<n_sums, Combine, Kernels>), ...);
}

/// A kernel and each of those that may follow it piece by piece on a CPU; a GPU runs one after the other.
template <class Before, class... Afters>
void compile_pairs() {
#if !defined(__CUDACC__)
  (keep(&cpu::launch_pair<Before, Afters>), ...);
#endif
}

template <int D, class Real, class Bulk, class... Joints>
void compile_simplices() {
  compile_each<ElementForces<D, Real, Bulk, Joints>...>();
  compile_each<ElementStress<D, Real, Bulk, Joints>...>();
  compile_sum<2, Add, ElementEnergy<D, Real, Bulk, Joints>...>();
}

/// What one bulk law needs: alone and beside each joint law.
template <int D, class Real, class Bulk, class... Joints>
void compile_law() {
  compile_simplices<D, Real, Bulk, void, Joints...>();
  compile_each<BlockForces<D, Real, Bulk>, BlockStress<D, Real, Bulk>>();
  compile_sum<2, Add, BlockEnergy<D, Real, Bulk>>();
  compile_pairs<BlockForces<D, Real, Bulk>, BlockJoints<D, Real, Joints>...>();
}

template <int D, class Real, class... Bulks, class... Joints>
void compile_elements(std::variant<Bulks...> const*, std::variant<Joints...> const*) {
  (compile_law<D, Real, Bulks, Joints...>(), ...);
  compile_law<D, Real, laws::Plastic, Joints...>();
  compile_each<ElementForces<D, Real, JointsOnly, Joints>...>();
  compile_sum<2, Add, ElementEnergy<D, Real, JointsOnly, Joints>...>();
  compile_each<BlockJoints<D, Real, Joints>..., ElementRankine<D, Real, Joints>..., BlockRankine<D, Real, Joints>...,
               ElementInsertion<D, Real, Joints>..., BlockInsertion<D, Real, Joints>...>();
  compile_sum<1, Add, BlockJointEnergy<D, Real, Joints>...>();
  if constexpr (Dim<D>::has_plane_stress) (compile_law<D, Real, laws::PlaneStress<Bulks>, Joints...>(), ...);
}

/// All kernels over elements and joints.
template <int D, class Real>
void compile_elements() {
  compile_elements<D, Real>(static_cast<laws::AnyBulk*>(nullptr), static_cast<laws::AnyJoint*>(nullptr));
  compile_each<ElementSwelling<D, Real>, PatchPressure<Real>>();
  compile_sum<1, Add, StressedElements<D, Real>>();
  compile_sum<4, Larger, ElementDeformation<D, Real>, BlockDeformation<D, Real>>();
}

/// All others.
template <int D, class Real>
void compile_rest() {
  compile_each<Advance<D, Real>, SumCorners<D, Real>, TieForces<D, Real>, TieMotion<D, Real>, AddLoad<D, Real>,
               FollowFaces<D, Real>, StayOnAxis<D, Real>, PairForces<D, Real>, SumGroups<D, Real>,
               PairFriction<D, Real>, PlateForces<D, Real>, WallForces<D, Real>, CrackForces<D, Real>,
               RigidReaction<D, Real>, RigidMotion<D, Real>, GatherMotion<D, Real>, PutForces<D, Real>,
               HangMotion<D, Real>, HoldAsks<D, Real>>();
  compile_sum<2 + D, Add, VertexEnergy<D, Real>>();
  compile_sum<1, Add, DampedAdvance<D, Real>, LoadWork<D, Real>, AbsorbWaves<D, Real>, AbsorbWork<D, Real>,
              HoldMotion<D, Real>, ContactVertexWork<D, Real>, PlateWork<D, Real>, SumOf<Real>>();
  compile_sum<D + 2, Add, HoldReaction<D, Real>>();
  compile_sum<D, Add, Reaction<D, Real>>();
  compile_sum<D + 3, Add, RigidPush<D, Real>>();
  compile_sum<2, Add, CountPairs<Real>>();
  compile_sum<1, Larger, AddContact<D, Real>, LargestOf<Real>>();
  compile_sum<4 * D, Larger, DriftSince<D, Real>>();
}

}  // namespace fissure::kernels
