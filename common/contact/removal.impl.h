// Contacts of cells that leave the run: what they hold, and that they end; a part of contact_stage.impl.h.
#pragma once
#include <algorithm>

#include "contact/contact_stage.h"

namespace fissure {

inline bool contains(std::vector<Index> const& ascending, Index e) {
  return std::binary_search(ascending.begin(), ascending.end(), e);
}

/// Pressing once more without a step between tells what overlaps hold, and changes nothing else.
template <int D, class Real>
double ContactStage<D, Real>::let_go(std::vector<Index> const& leaving) {
  double held = 0;
  std::vector<Index> slots;  // of what acts no more
  if (!slots_.empty()) {
    for (auto* kind : {&pair_, &plate_, &wall_})  // what has parted since is not told again
      kind->held.upload(std::vector<Real>(kind->held.size(), Real(0)));
    if (pair_.count > 0) press_pairs(0);
    if (plate_.count > 0) press_on(plate_, rigid_.place_boxes(0), laws_.plates(), 0);
    if (wall_.count > 0) press_on(wall_, rigid_.planes(), laws_.walls(), 0);
    for (auto* kind : {&pair_, &plate_, &wall_}) held += let_go(*kind, leaving, slots);
  }
  auto const u = model_.vertices.u.download();
  auto cracks = cracks_.download();
  cracks.insert(cracks.end(), new_cracks_.begin(), new_cracks_.end());
  for (std::size_t k = 0; k < cracks.size(); ++k)
    if (contains(leaving, cracks[k].element) || contains(leaving, cracks[k].other)) {
      some_left_ = true;
      held += held_by(cracks[k], u);
      for (int i = 0; i < 2 * D && k < cracks_.size(); ++i)
        slots.push_back(crack_slot_ + static_cast<Index>(k) * 2 * D + i);
    }
  slots_.take_back(model_, slots);
  work_.given -= held;
  return held;
}

/// Neither rigid bodies nor other cells feel them any more in what is left of the step.
template <int D, class Real>
double ContactStage<D, Real>::let_go(Candidates<D, Real>& kind, std::vector<Index> const& leaving,
                                     std::vector<Index>& slots) {
  constexpr int size = kernels::spring_size<D>;
  auto const overlap = kind.held.download(), spring = kind.spring.download();
  auto const u = model_.vertices.u.download();
  auto const between = laws_.of_pairs().download();
  double sum = 0;
  for (std::size_t k = 0; k < kind.pairs.size(); ++k) {
    if (!contains(leaving, kind.pairs[k].a) && (kind.rigid || !contains(leaving, kind.pairs[k].b))) continue;
    some_left_ = true;
    if (model_.removed(kind.pairs[k].a) || (!kind.rigid && model_.removed(kind.pairs[k].b)))
      continue;  // with the other
    for (int i = 0; i < (kind.rigid ? C : 2 * C); ++i)
      slots.push_back(kind.first_slot + static_cast<Index>(k) * (kind.rigid ? C : 2 * C) + i);
    double stretch = 0;
    for (int c = 0; c < D; ++c) stretch += std::pow(static_cast<double>(spring[k * size + c]), 2);
    double const pressed = kind.rigid || !(overlap[k] != 0)
                               ? static_cast<double>(overlap[k])
                               : held_by(kind.pairs[k], static_cast<double>(spring[k * size + size - 1]), u, between);
    sum += pressed + static_cast<double>(spring[k * size + D]) * stretch / 2;
    for (std::size_t c = 0; kind.rigid && c < D; ++c) kind.reaction.upload_one(k * D + c, Real(0));
  }
  return sum;
}

/// As the overlap of a pair holds it (kernels::Overlap), in double: single precision loses it among what it is the
/// difference of.
template <int D, class Real>
double ContactStage<D, Real>::held_by(contact::ElementPair const& pair, double begins, std::vector<Real> const& u,
                                      std::vector<laws::ContactLaw> const& between) const {
  auto a = placed(pair.a, u), b = placed(pair.b, u);
  Vec<double, D> const origin = a.x[0];
  for (auto* simplex : {&a, &b})
    for (auto& x : simplex->x) x -= origin;
  Mat<double, D + 1> a_in_b, b_in_a;
  double along = 0;
  double const gap = kernels::separation<D, double>(a, b, a_in_b, b_in_a, true, along);
  auto const material = [&](Index e) { return scene_.bodies[model_.elements.body[e]].material; };
  auto const& law = between[material(pair.a) * scene_.materials.size() + material(pair.b)];
  double const p = law.penalty * std::min(model_.out_of_plane(pair.a), model_.out_of_plane(pair.b));
  return kernels::Overlap<D, double>(a, b, a_in_b, b_in_a, p, std::max(begins, 0.0), gap, true).held;
}

/// As the faces of a broken joint hold it (kernels::CrackForces).
template <int D, class Real>
double ContactStage<D, Real>::held_by(kernels::CrackFace<D, Real> const& crack, std::vector<Real> const& u) const {
  Vec<double, D> gap[D], middle[D];
  for (int i = 0; i < D; ++i) {
    std::size_t const a = model_.face_vertex({crack.element, crack.face}, i),
                      b = model_.face_vertex({crack.other, crack.other_face}, i);
    for (int c = 0; c < D; ++c) {
      double const mine = u[a * D + c], theirs = u[b * D + c];
      gap[i][c] = theirs - mine;
      middle[i][c] = model_.vertices.reference[a][c] + (mine + theirs) / 2;
    }
  }
  int const parity = model_.elements.parity.download_one(static_cast<std::size_t>(crack.element));
  Vec<double, D> const normal =
      Dim<D>::face_normal(middle).normalized() * ((crack.face % 2 == 0) == (parity > 0) ? 1 : -1);
  double pressed = 0, sheared = 0;
  for (int i = 0; i < D; ++i) {
    double const k = static_cast<double>(crack.weight[i]) * crack.stiffness, offset = crack.offset[i],
                 depth = std::max(-gap[i].dot(normal) - offset, 0.0);
    pressed += k * (depth * depth - offset * offset) / 2;
    for (int c = 0; c < D; ++c) sheared += k * std::pow(static_cast<double>(crack.stretch[i][c]), 2) / 2;
  }
  return std::max(pressed, 0.0) + sheared;
}

template <int D, class Real>
void ContactStage<D, Real>::drop_removed() {
  some_left_ = false;
  for (auto* kind : {&pair_, &plate_, &wall_})
    kind->keep_only(device_, [&](contact::ElementPair const& pair) {
      return !model_.removed(pair.a) && (kind->rigid || !model_.removed(pair.b));
    });
  near_.keep_only([&](contact::ElementPair const& pair) { return !model_.removed(pair.a) && !model_.removed(pair.b); });
  auto const gone = [&](kernels::CrackFace<D, Real> const& crack) {
    return model_.removed(crack.element) || model_.removed(crack.other);
  };
  auto cracks = cracks_.download();
  cracks.erase(std::remove_if(cracks.begin(), cracks.end(), gone), cracks.end());
  new_cracks_.erase(std::remove_if(new_cracks_.begin(), new_cracks_.end(), gone), new_cracks_.end());
  cracks_ = Buffer<kernels::CrackFace<D, Real>>(device_, "crack faces", cracks);
  crack_work_ = Buffer<Real>(device_, "crack faces", cracks.size());
  slots_are_stale_ = beds_are_stale_ = true;
}

}  // namespace fissure
