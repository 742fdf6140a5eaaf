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
  std::array const heard{hear(model_.interfaces.joints, model::Notice::joints, told[0]),
                         hear(model_.interfaces.block_joints, model::Notice::block_joints, told[1])};
  model::JointRecords<D, Real> const records(model_.interfaces, heard);
  std::vector<Breaking> breaking;
  // The joint at a face of a cell is that at the faces of these elements, each with its own points.
  auto const look = [&](auto const& set, Index cell, int face) {
    auto const& record = set.of(records);
    auto const [least, largest] = record.damage(cell, face);
    auto const parts = set.parts(cell, face);
    for (FaceId const at : parts) {
      if (model_.neighbour(at).element <= at.element) continue;  // none, or known from the other side
      if (largest >= 1 || (largest > 0 && opens_wide(at))) contact_.loosen(at);
      if (least >= 1) breaking.push_back({at, record.taken(cell, face) / static_cast<double>(parts.size())});
    }
  };
  for (auto const& group : model_.groups)
    model_.each_set([&](auto const& set) {
      auto const& cells = set.range(group);
      for (Index const at : heard[set.kind])
        if (Index const cell = at / set.faces; cell >= cells.first && cell < cells.first + cells.padded)
          look(set, cell, at % set.faces);
    });
  if (breaking.empty()) return false;
  std::vector<FaceId> faces;
  for (auto const& joint : breaking) faces.push_back(joint.at);
  model::BreakingView<Real> const now(model_, faces);
  for (auto const& joint : breaking) release(joint, now, records, time);
  for (auto const& joint : breaking) {
    FaceId const other = model_.neighbour(joint.at);
    model_.unlink(joint.at);
    model_.unlink(other);
  }
  return true;
}

/// Before it breaks, another piece may come between its sides.
template <int D, class Real>
bool FractureStage<D, Real>::opens_wide(FaceId face) const {
  Vec3 const one = model_.drawn_at(model_.face_vertex(face, 0)), other = model_.drawn_at(model_.face_vertex(face, 1));
  double const gap = std::visit([](auto const& law) { return law.final_gap(); }, model_.joint_law(scene_, face));
  return gap > wide * (other - one).norm();
}

/// Into the record, and to contact with all that its points remember.
template <int D, class Real>
void FractureStage<D, Real>::release(Breaking const& from, model::BreakingView<Real> const& now,
                                     model::JointRecords<D, Real> const& records, double time) {
  BrokenJoint joint{.side = from.at, .other = model_.neighbour(from.at), .time = time, .work = from.work};
  CrackPoints<D, Real> points;
  for (int i = 0; i < D; ++i) {
    points.area[i] = model_.joint_area(now, from.at, i);
    joint.area += static_cast<double>(points.area[i]);
  }
  model_.in_set(from.at.element, [&](auto const& set, Index cell) {
    auto const& record = set.of(records);
    int const face = set.face_of(from.at).face;
    joint.mode = record.mode(cell, face);
    points.stiffness = record.stiffness_at(cell, face);
    for (int i = 0; i < D; ++i) {
      int const point = set.point(from.at, face, i);
      points.history[i] = record.point(cell, face, point);
      points.offset[i] = record.pressed_at(cell, face, point);
      for (int c = 0; c < D; ++c) points.stretch[i][c] = record.stretch_at(cell, face, point, c);
    }
  });
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
  std::array<long, 2> parts{};  // of faces of simplices and of blocks
  for (auto const& joint : broken_)
    model_.in_set(joint.side.element, [&](auto const& set, Index) { ++parts[set.kind]; });
  return parts[0] + parts[1] / model::Model<D, Real>::K;
}

template <int D, class Real>
std::vector<Softened> FractureStage<D, Real>::softened(std::vector<Index> const& cells) const {
  std::vector<Softened> sums(scene_.bodies.size() + 1);
  model::JointRecords<D, Real> const records(model_.interfaces);
  for (Index e : cells)
    model_.in_set(e, [&](auto const& set, Index cell) {
      for (int a = 0; model_.groups[model_.elements.body[e]].split && a < set.faces; ++a) {
        double const taken = set.of(records).taken(cell, a);
        if (!(taken > 0)) continue;
        auto const parts = set.parts(cell, a);
        bool const bonded = !parts.empty() && model_.bond_of(parts[0]) > 0;
        auto& sum = sums[bonded ? scene_.bodies.size() : model_.elements.body[e]];
        sum.taken += taken, sum.by_slip += taken * set.of(records).mode(cell, a);
      }
    });
  return sums;
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
