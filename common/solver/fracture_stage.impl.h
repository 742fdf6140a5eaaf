// Instantiated by src2d and src3d.
#pragma once
#include <algorithm>

#include "solver/fracture_stage.h"

namespace fissure {

/// Faces tell in no order: they are heard pack by pack.
template <int D, class Real>
template <class Joints>
std::vector<Index> FractureStage<D, Real>::hear(Joints& joints, int flag, int told) {
  constexpr int faces = Joints::faces;
  auto list = joints.events.download_first(static_cast<std::size_t>(told));
  auto const order = [](Index at) { return std::array{at / faces / kernels::layout_width, at % faces, at / faces}; };
  std::sort(list.begin(), list.end(), [&](Index one, Index other) { return order(one) < order(other); });
  model_.flags.upload_one(flag, 0);
  return list;
}

template <int D, class Real>
bool FractureStage<D, Real>::follow(std::array<int, 2> const& told, double time) {
  if (told[0] + told[1] == 0) return false;
  using Model = model::Model<D, Real>;
  auto const of_elements = hear(model_.interfaces.joints, model::Notice::joints, told[0]),
             of_blocks = hear(model_.interfaces.block_joints, model::Notice::block_joints, told[1]);
  model::JointRecord const elements(model_.interfaces.joints, of_elements);
  model::JointRecord const blocks(model_.interfaces.block_joints, of_blocks);
  std::vector<Breaking> breaking;
  // The joint at a face of a cell is that at the faces of these elements, each with its own points.
  auto const look = [&](auto const& record, Index cell, int face, std::span<FaceId const> parts, bool block) {
    auto const [least, largest] = record.damage(cell, face);
    for (FaceId const at : parts) {
      if (model_.neighbour(at).element <= at.element) continue;  // none, or known from the other side
      if (largest > 0) contact_.loosen(at);
      if (least >= 1)
        breaking.push_back({at, cell, face, block, record.taken(cell, face) / static_cast<double>(parts.size())});
    }
  };
  for (auto const& group : model_.groups) {
    for (Index const at : of_elements)
      if (Index const e = at / C; e >= group.first && e < group.first + group.padded_simplices)
        look(elements, e, at % C, std::array{FaceId{e, at % C}}, false);
    for (Index const at : of_blocks)
      if (Index const b = at / Model::F; b >= group.first_block && b < group.first_block + group.padded_blocks)
        look(blocks, b, at % Model::F, model_.parts_at(b, at % Model::F), true);
  }
  if (breaking.empty()) return false;
  std::vector<FaceId> faces;
  for (auto const& joint : breaking) faces.push_back(joint.at);
  model::BreakingView<Real> const now(model_, faces);
  for (auto const& joint : breaking) release(joint, now, elements, blocks, time);
  for (auto const& joint : breaking) {
    FaceId const other = model_.neighbour(joint.at);
    model_.unlink(joint.at);
    model_.unlink(other);
  }
  return true;
}

/// Into the record, and to contact with all that its points remember.
template <int D, class Real>
void FractureStage<D, Real>::release(
    Breaking const& from, model::BreakingView<Real> const& now, model::JointRecord<C, D, Real> const& elements,
    model::JointRecord<BlockShape<D>::faces, BlockShape<D>::face_corners, Real> const& blocks, double time) {
  BrokenJoint joint{.side = from.at, .other = model_.neighbour(from.at), .time = time, .work = from.work};
  CrackPoints<D, Real> points;
  for (int i = 0; i < D; ++i) {
    points.area[i] = model_.joint_area(now, from.at, i);
    joint.area += static_cast<double>(points.area[i]);
  }
  auto const remember = [&](auto const& record, auto&& point_of) {
    joint.mode = record.mode(from.cell, from.face);
    points.stiffness = record.stiffness_at(from.cell, from.face);
    for (int i = 0; i < D; ++i) {
      int const point = point_of(i);
      points.history[i] = record.point(from.cell, from.face, point);
      points.offset[i] = record.pressed_at(from.cell, from.face, point);
      for (int c = 0; c < D; ++c) points.stretch[i][c] = record.stretch_at(from.cell, from.face, point, c);
    }
  };
  if (from.block)
    remember(blocks, [&](int i) { return model_.block_point(from.at, i); });
  else
    remember(elements, [](int i) { return i; });
  joint.out_of_plane = contact_.add_broken(now, joint, points, model_.joint_law(scene_, from.at));
  broken_.push_back(joint);
}

template <int D, class Real>
double FractureStage<D, Real>::area() const {
  double sum = 0;
  for (auto const& joint : broken_) sum += joint.area;
  return sum;
}

template <int D, class Real>
double FractureStage<D, Real>::energy() const {
  double sum = 0;
  for (auto const& joint : broken_) sum += joint.work;
  return sum;
}

template <int D, class Real>
long FractureStage<D, Real>::count() const {
  long parts = 0;  // of blocks' faces
  for (auto const& joint : broken_) parts += model_.block_face(joint.side) >= 0;
  return static_cast<long>(broken_.size()) - parts + parts / model::Model<D, Real>::K;
}

template <int D, class Real>
std::vector<bool> FractureStage<D, Real>::softened(std::vector<Index> const& cells) const {
  std::vector<bool> some(scene_.bodies.size() + 1, false);
  model::JointRecord const elements(model_.interfaces.joints);
  model::JointRecord const blocks(model_.interfaces.block_joints);
  for (Index e : cells) {
    Index const block = model_.block_of(e);
    if (!model_.groups[model_.elements.body[e]].split) continue;
    for (int a = 0; a < (block < 0 ? C : BlockShape<D>::faces); ++a) {
      bool const bonded = block < 0 && model_.bond_of({e, a}) > 0;
      if ((block < 0 ? elements.taken(e, a) : blocks.taken(block, a)) > 0)
        some[bonded ? scene_.bodies.size() : model_.elements.body[e]] = true;
    }
  }
  return some;
}

template <int D, class Real>
void FractureStage<D, Real>::restore(State const& state) {
  broken_ = state_values<BrokenJoint>(state, "broken");
  for (auto const& joint : broken_)
    for (FaceId const face : {joint.side, joint.other}) {
      check_index("broken", face.element, static_cast<std::size_t>(model_.elements.count));
      check_index("broken", face.face, C);
    }
}

}  // namespace fissure
