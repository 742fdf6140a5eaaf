// What lies between two cells: joints, their areas and memory, and who is on the other side.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "backend/buffer.h"
#include "base/face_id.h"
#include "kernels/block_joints.h"
#include "laws/laws.h"

namespace fissure::model {

/// What the joints on the F faces of cells have and remember, at P points each.
template <int F, int P, class Real>
struct JointArrays {
  static constexpr int faces = F, points = P, numbers = kernels::JointMemory<F, P, Real>::D;
  static constexpr int remembered = laws::joint_numbers;
  Buffer<Real> stiffness, history, work, stretch;  // the last where something rubs
  Buffer<Real> weakness;                           // where strengths differ from the law's
  Buffer<Real> tension;                            // that joints open across, by Rankine's criterion
  Buffer<std::uint8_t> bond;                       // that a face belongs to, counted from 1; empty: there are none
  Buffer<std::uint8_t> softening;
  Buffer<Index> events;        // as FaceEvents
  Buffer<Real> offset;         // of joints that are inserted, as JointMemory, and
  Buffer<std::uint8_t> whole;  // where none is yet [F]

  JointArrays() = default;
  JointArrays(Device& device, std::vector<Real> const& stiffnesses, int dimensions, bool rubs)
      : stiffness(device, "joint stiffness", stiffnesses),
        history(device, "joint history", stiffnesses.size() * P * remembered),
        work(device, "joint work", stiffnesses.size() * 2),
        stretch(device, "joint friction", rubs ? stiffnesses.size() * P * dimensions : 0),
        softening(device, "joint softening", stiffnesses.size() / kernels::layout_width),
        events(device, "joint events", stiffnesses.size()) {}
  kernels::JointMemory<F, P, Real> view(Index first, double* dissipated, int* count) {
    std::size_t const at = static_cast<std::size_t>(first) * F;
    return {stiffness.data() + at,
            history.data() + at * P * remembered,
            work.data() + at * 2,
            softening.data() + at / kernels::layout_width,
            dissipated + first,
            {count, events.data(), first},
            stretch.empty() ? nullptr : stretch.data() + at * stretch.size() / stiffness.size(),
            weakness.empty() ? nullptr : weakness.data() + at,
            tension.empty() ? nullptr : tension.data() + at * numbers,
            bond.empty() ? nullptr : bond.data() + at,
            offset.empty() ? nullptr : offset.data() + at * P * numbers};
  }
  /// Joints are inserted on the faces that are whole.
  void insert_on_demand(Device& device, std::vector<std::uint8_t> const& whole_faces) {
    whole = Buffer<std::uint8_t>(device, "whole faces", whole_faces);
    offset = Buffer<Real>(device, "joint offsets", stiffness.size() * P * numbers);
  }
  /// Faces of bonds, counted from 1: they are asked one by one, since their law is not their neighbours'.
  void set_bonds(Device& device, std::vector<std::uint8_t> const& bonds) {
    auto soft = softening.download();
    for (std::size_t at = 0; at < bonds.size(); ++at)
      if (bonds[at] > 0) soft[static_cast<std::size_t>(cell_of(at) / kernels::layout_width) * F + face_of(at)] = 1;
    softening.upload(soft);
    bond = Buffer<std::uint8_t>(device, "bonds", bonds);
  }
  /// Room for the tensions of Rankine's criterion; there are none yet, and for planes with strengths of their own never
  /// will be.
  void begin_by_stress(Device& device, std::vector<double> const& any_plane) {
    std::vector<Real> none(stiffness.size() * numbers, Real(0));
    for (std::size_t at = 0; at < any_plane.size(); ++at)
      if (any_plane[at] == 0) none[kernels::blocked(cell_of(at), face_of(at) * numbers, F * numbers)] = Real(-1);
    tension = Buffer<Real>(device, "joint tensions", none);
  }
  /// What number `at` of a blocked array [F] belongs to.
  static Index cell_of(std::size_t at) {
    return static_cast<Index>(at / (F * kernels::layout_width) * kernels::layout_width + at % kernels::layout_width);
  }
  static Index face_of(std::size_t at) { return static_cast<Index>(at / kernels::layout_width % F); }
  /// Strengths of faces over the law's; where it is 0 the face is broken before anything moves, and broken_points(cell,
  /// put) puts what its points remember. Returns how many of those there are.
  template <class Broken>
  int set_strengths(Device& device, std::vector<double> const& strengths, Broken const& broken_points) {
    std::vector<Real> weak(strengths.size()), past = history.download();
    auto soft = softening.download();
    std::vector<Index> broken;
    for (std::size_t at = 0; at < strengths.size(); ++at) {
      weak[at] = static_cast<Real>(strengths[at] > 0 ? 1 / strengths[at] : 1);
      if (strengths[at] > 0) continue;
      Index const cell = cell_of(at), a = face_of(at);
      soft[static_cast<std::size_t>(cell / kernels::layout_width) * F + a] = 1;
      broken.push_back(cell * F + a);
      for (int i = 0; i < P; ++i)
        broken_points(cell, [&](int k, Real value) {
          past[kernels::blocked(cell, (a * P + i) * remembered + k, F * P * remembered)] = value;
        });
    }
    weakness = Buffer<Real>(device, "joint weakness", weak);
    if (broken.empty()) return 0;
    history.upload(past), softening.upload(soft);
    int const count = static_cast<int>(broken.size());
    broken.resize(events.size(), 0);
    events.upload(broken);
    return count;
  }
};

/// The same on the host, at a moment: of all joints, or of those on some faces (cell * F + face).
template <int F, int P, class Real>
struct JointRecord {
  static constexpr int remembered = JointArrays<F, P, Real>::remembered;
  HostView<Real> stiffness, history, work, stretch, offset;
  int dimensions = 0;     // of the friction springs; 0: none
  bool inserted = false;  // some are, with offsets

  explicit JointRecord(JointArrays<F, P, Real> const& arrays)
      : stiffness(arrays.stiffness),
        history(arrays.history),
        work(arrays.work),
        stretch(arrays.stretch),
        offset(arrays.offset),
        dimensions(springs(arrays)),
        inserted(!arrays.offset.empty()) {}
  JointRecord(JointArrays<F, P, Real> const& arrays, std::vector<Index> const& faces)
      : stiffness(arrays.stiffness, places(faces, 1)),
        history(arrays.history, places(faces, P * remembered)),
        work(arrays.work, places(faces, 2)),
        stretch(arrays.stretch, places(faces, P * springs(arrays))),
        offset(arrays.offset, places(faces, arrays.offset.empty() ? 0 : P * arrays.numbers)),
        dimensions(springs(arrays)),
        inserted(!arrays.offset.empty()) {}
  Real stiffness_at(Index cell, int a) const { return stiffness[kernels::blocked(cell, a, F)]; }
  /// What a point remembers, damage first.
  std::array<Real, remembered> point(Index cell, int a, int i) const {
    std::array<Real, remembered> numbers;
    for (int k = 0; k < remembered; ++k)
      numbers[k] = history[kernels::blocked(cell, (a * P + i) * remembered + k, F * P * remembered)];
    return numbers;
  }
  /// Number c of the stretch of a point's friction spring [m].
  Real stretch_at(Index cell, int a, int i, int c) const {
    return dimensions > 0 ? stretch[kernels::blocked(cell, (a * P + i) * dimensions + c, F * P * dimensions)] : Real(0);
  }
  /// Offset of the opening of a point that was inserted under pressure, which stays when it has broken [m].
  Real pressed_at(Index cell, int a, int i) const {
    constexpr int numbers = JointArrays<F, P, Real>::numbers;
    return inserted ? std::min(offset[kernels::blocked(cell, (a * P + i) * numbers, F * P * numbers)], Real(0))
                    : Real(0);
  }
  /// Least and largest damage on a face.
  std::array<double, 2> damage(Index cell, int a) const {
    std::array<double, 2> range{1, 0};
    for (int i = 0; i < P; ++i) {
      double const damage = static_cast<double>(point(cell, a, i)[0]);
      range = {std::min(range[0], damage), std::max(range[1], damage)};
    }
    return range;
  }
  /// What softening took, and the share of slip in it.
  double taken(Index cell, int a) const {
    return work[kernels::blocked(cell, a * 2, F * 2)] + work[kernels::blocked(cell, a * 2 + 1, F * 2)];
  }
  double mode(Index cell, int a) const {
    double const opening = work[kernels::blocked(cell, a * 2, F * 2)],
                 slip = work[kernels::blocked(cell, a * 2 + 1, F * 2)];
    return opening + slip > 0 ? slip / (opening + slip) : 0;
  }

 private:
  static int springs(JointArrays<F, P, Real> const& arrays) {
    return arrays.stretch.empty() ? 0 : static_cast<int>(arrays.stretch.size() / (arrays.stiffness.size() * P));
  }
  /// Where arrays with n numbers per face keep those of these faces.
  static std::vector<std::size_t> places(std::vector<Index> const& faces, int n) {
    std::vector<std::size_t> at;
    for (Index const face : faces)
      for (int k = 0; k < n; ++k) at.push_back(kernels::blocked(face / F, face % F * n + k, F * n));
    return at;
  }
};

/// Both kinds at a moment.
template <int D, class Real>
struct JointRecords {
  JointRecord<D + 1, D, Real> joints;
  JointRecord<BlockShape<D>::faces, BlockShape<D>::face_corners, Real> block_joints;

  template <class Interfaces>
  explicit JointRecords(Interfaces const& all) : joints(all.joints), block_joints(all.block_joints) {}
  template <class Interfaces>
  JointRecords(Interfaces const& all, std::array<std::vector<Index>, 2> const& faces)
      : joints(all.joints, faces[0]), block_joints(all.block_joints, faces[1]) {}
};

/// All interfaces of a model: of simplices that are cells, and of blocks. The faces of a block's parts have areas and
/// neighbours, too, since contact sees those.
template <int D, class Real>
struct Interfaces {
  static constexpr int F = BlockShape<D>::faces, P = BlockShape<D>::face_corners;

  // Of simplices, on the device.
  Buffer<Index> link;  // [element][D + 1] FaceId across, packed, blocked; its own: there is none
  Buffer<Real> area;   // of each of its face's corners [m^2], blocked
  JointArrays<D + 1, D, Real> joints;
  // Of blocks, on the device, as kernels::BlockJointView.
  Buffer<Real> block_corners;
  Buffer<Index> across, beyond;
  Buffer<Real> block_area;
  JointArrays<F, P, Real> block_joints;

  Buffer<laws::CohesiveJoint> bond_laws;  // of each bond, by the friction of its bodies
  Buffer<double> dissipated;              // of elements, then of blocks [J]
  Buffer<double> stress;                  // [element][6], where joints begin by stress [Pa], and
  Buffer<std::uint8_t> stressed;          // which elements are near to that
  double least_strength = 1;              // of all joints that are no crack from the start, over their law's

  /// Bonds are cohesive: beside a body of another law there are none.
  template <class Law>
  Law const* bonds() const {
    if constexpr (std::is_same_v<Law, laws::CohesiveJoint>) return bond_laws.data();
    return nullptr;
  }

  // On the host.
  std::vector<Index> host_link;  // as link
  std::vector<double> size;      // h of each joint, [face] blocked as link [m]
  std::vector<FaceId> parts;     // [block][face][K] of parts; element -1: no joint
  std::vector<laws::CohesiveJoint> host_bond_laws;
  std::vector<std::uint8_t> host_bond;  // [face] blocked as link: bond law from 1, 0: the body's own; may be empty
};

}  // namespace fissure::model
