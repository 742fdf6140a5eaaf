// Broken joints of the contact stage: how they become crack faces, and these general contact; a part of
// contact_stage.impl.h.
#pragma once
#include <algorithm>

#include "contact/contact_stage.h"

namespace fissure {

/// The friction spring of each corner goes on as that of the joint's damaged share, which by now is all of it.
template <int D, class Real>
double ContactStage<D, Real>::add_broken(model::BreakingView<Real> const& now, BrokenJoint const& joint,
                                         CrackPoints<D, Real> const& points, laws::AnyJoint const& law) {
  kernels::CrackFace<D, Real> crack;
  crack.element = joint.side.element, crack.face = joint.side.face;
  crack.other = joint.other.element, crack.other_face = joint.other.face;
  crack.stiffness = points.stiffness;
  std::copy(points.area.begin(), points.area.end(), crack.weight);
  crack.friction = static_cast<Real>(std::visit([](auto const& joint_law) { return joint_law.residual; }, law));
  crack.size = static_cast<Real>(model_.interfaces.size[kernels::blocked(joint.side.element, joint.side.face, C)]);
  auto const moved = [&](Index vertex) {
    Vec<Real, D> u;
    for (int c = 0; c < D; ++c) u[c] = now.u[static_cast<std::size_t>(vertex) * D + c];
    return u;
  };
  Vec<Real, D> gap[D], middle[D];
  for (int i = 0; i < D; ++i) {
    Index const a = model_.face_vertex(joint.side, i), b = model_.face_vertex(joint.other, i);
    Vec<Real, D> const mine = moved(a), theirs = moved(b);
    gap[i] = theirs - mine;
    for (int c = 0; c < D; ++c)
      middle[i][c] = static_cast<Real>(model_.vertices.reference[a][c]) + Real(0.5) * (mine[c] + theirs[c]);
  }
  Vec<Real, D> const normal = Dim<D>::face_normal(middle).normalized();
  Vec<Real, D> slid = Vec<Real, D>::Zero();
  for (int i = 0; i < D; ++i) {
    // Either sign of the normal gives the same opening here only up to sign: the element lies on its inner side.
    Real const outward = (crack.face % 2 == 0) == (now.parity[joint.side.element] > 0) ? Real(1) : Real(-1);
    Real const opening = outward * gap[i].dot(normal) + points.offset[i];
    Vec<Real, D> const slip = gap[i] - normal * gap[i].dot(normal);
    slid += slip;
    Real const length = slip.norm();
    Real const stored = std::visit(
        [&]<class Law>(Law const& curve) {
          auto const history = Law::template History<Real>::read([&](int k) { return points.history[i][k]; });
          return curve.stored(points.stiffness, opening, length, history);
        },
        law);
    Real const began = points.stiffness * points.offset[i] * points.offset[i] / 2;
    crack.offset[i] = points.offset[i];
    for (int c = 0; c < D; ++c) crack.stretch[i][c] = points.stretch[i][c];
    work_.given += static_cast<double>(crack.weight[i] *
                                       (stored - began + points.stiffness * points.stretch[i].squaredNorm() / 2));
    work_.began_with += static_cast<double>(crack.weight[i] * began);
  }
  new_cracks_.push_back(crack);
  return static_cast<double>(Dim<D>::out_of_plane_share(slid));
}

/// Crack faces that have come apart go on as a pair of general contact, in the same step: they may still press. Where
/// their elements hang together around the crack's end they stay what they are until they have folded open.
template <int D, class Real>
void ContactStage<D, Real>::release_cracks() {
  news_.upload_one(0, 0);
  bonds_.connect();
  std::vector<kernels::CrackFace<D, Real>> kept, freed;
  auto all = cracks_.download();
  std::vector<std::pair<Index, Index>> together;  // blocks with another face between them that has not come apart
  for (auto const& crack : all)
    if (!crack.apart) together.push_back(cells_of(crack));
  std::sort(together.begin(), together.end());
  for (auto& crack : all) {
    auto const hang = [&] {
      return bonds_.hang_together(crack.element, crack.other) ||
             std::binary_search(together.begin(), together.end(), cells_of(crack));
    };
    bool const stays = !crack.apart || (crack.apart < 2 && hang());
    if (!stays) work_.friction += static_cast<double>(crack.lost);
    crack.apart = 0;
    (stays ? kept : freed).push_back(crack);
  }
  if (freed.empty()) return;
  cracks_ = Buffer<kernels::CrackFace<D, Real>>(device_, "crack faces", kept);
  crack_work_ = Buffer<Real>(device_, "crack faces", kept.size());
  slots_are_stale_ = beds_are_stale_ = true;
  if (!model_.plan.pairs) return;
  // Parts of the two cells meet crosswise, too.
  auto pairs = pair_.pairs;
  for (auto const& crack : freed) {
    auto const [one, other] = cells_of(crack);
    for (Index a = one; a < one + model_.cell_parts(one); ++a)
      for (Index b = other; b < other + model_.cell_parts(other); ++b)
        if (!bonds_.hang_together(a, b)) pairs.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  constexpr int size = kernels::spring_size<D>;
  auto springs = pair_.carried_to(pairs, pair_.spring.download(), -1);
  for (auto const& crack : freed) {
    contact::ElementPair const pair{crack.element, crack.other};
    auto const at = std::lower_bound(pairs.begin(), pairs.end(), pair);
    if (at != pairs.end() && *at == pair)
      std::copy(crack.spring, crack.spring + size, springs.begin() + (at - pairs.begin()) * size);
  }
  pair_.set(device_, std::move(pairs), springs);
  near_.join(pair_.pairs, pair_);
}

}  // namespace fissure
