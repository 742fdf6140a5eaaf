// Joints between blocks, or between blocks and simplices: a point at every corner of a face, lines with two in 2D and
// quadrilaterals with four in 3D. Each block evaluates its own share, as simplices do; its corners have vertices of
// their own, one after the other. A face's normal is that of its diagonals, however warped it is.
#pragma once
#include "backend/for_each.h"
#include "base/block_shape.h"
#include "base/rows.h"
#include "kernels/joints.h"

namespace fissure::kernels {

/// What the joints around blocks need. Arrays begin with a body's first block, and are blocked.
template <int D, class Real>
struct BlockJointView {
  Index first_vertex = 0;   // corner a of block b: first_vertex + b 2^D + a
  Real const* X = nullptr;  // reference coordinates of corners [m], [2^D D]
  // Vertex on the other side of point i of face a; its own: there is none. [2 D 2^(D-1)]
  Index const* across = nullptr;
  // Of each point at rest, 0: there is no joint [m^2], [2 D 2^(D-1)]
  Real const* area = nullptr;
  Real* force = nullptr;  // [block][corner][D] [N]
  Index first_part = 0;   // element that is the first part of the first block
  int parts = 1;
  Index count = 0;  // of blocks
  // an element of the cell on the other side of each face, -1: none; where joints begin by stress  [2 D]
  Index const* beyond = nullptr;
};

template <int D, class Real_, class Joint>
struct BlockJointPass {
  static constexpr bool packed = true;
  using Real = Real_;
  using Shape = BlockShape<D>;
  static constexpr int C = Shape::corners, F = Shape::faces, P = Shape::face_corners;

  MeshView<D, Real> mesh;
  BlockJointView<D, Real> blocks;
  Joints<D, F, P, Real, Joint> joint;

  FISSURE_HD std::size_t own(Index b, int corner = 0) const {
    return static_cast<std::size_t>(blocks.first_vertex + b * C + corner);
  }
  FISSURE_HD Index across(Index b, int a, int i) const { return blocks.across[blocked(b, a * P + i, F * P)]; }

  template <class S>
  FISSURE_HD void read(Index b, Vec<S, D> (&X)[C], Vec<S, D> (&u)[C]) const {
    for (int a = 0; a < C; ++a)
      for (int c = 0; c < D; ++c) X[a][c] = load<S>(blocks.X + blocked(b, a * D + c, C * D));
    load_rows<C * D>(u[0].data(), [&](int l) { return mesh.u + own(b + l) * D; });
  }

  /// Asks memory for what the faces of blocks b and on will read from across: a processor cannot foresee where that is.
  template <class S>
  FISSURE_HD void prefetch_faces([[maybe_unused]] Index b) const {
    if constexpr (lane_width < S >> 1) {
      if (b >= blocks.count) return;
      for (int a = 0; a < F; ++a)
        for (int i = 0; i < P; i += 2)
          for (int l = 0; l < lane_width<S>; ++l)
            __builtin_prefetch(mesh.u + static_cast<std::size_t>(across(b + l, a, i)) * D);
    }
  }

  /// The gap at each point of face a, and twice the corners of the surface midway between both sides.
  template <class S>
  FISSURE_HD void read_face(Index b, int a, Vec<S, D> const (&X)[C], Vec<S, D> const (&u)[C], Vec<S, D> (&gap)[P],
                            Vec<S, D> (&middle)[P]) const {
    for (int i = 0; i < P; ++i) {
      int const corner = Shape::face(a, i);
      Vec<S, D> theirs;
      load_rows<D>(theirs.data(), [&](int l) { return mesh.u + static_cast<std::size_t>(across(b + l, a, i)) * D; });
      gap[i] = theirs - u[corner];
      middle[i] = (X[corner] + X[corner]) + (theirs + u[corner]);
    }
  }
  /// All faces stage by stage: what one waits for (gathers, divisions, roots) the others fill.
  template <class S>
  FISSURE_HD void read_faces(Index b, Vec<S, D> const (&X)[C], Vec<S, D> const (&u)[C],
                             FaceMotion<D, P, S> (&faces)[F]) const {
    Vec<S, D> middle[F][P];
    for (int a = 0; a < F; ++a) read_face(b, a, X, u, faces[a].gap, middle[a]);
    for (int a = 0; a < F; ++a) faces[a].resolve(middle[a], S(1));
  }

  template <class S>
  FISSURE_HD void areas(Index b, int a, S (&area)[P]) const {
    for (int i = 0; i < P; ++i) area[i] = load<S>(blocks.area + blocked(b, a * P + i, F * P));
  }
};

/// Adds the pull of joints to the forces of blocks.
template <int D, class Real_, class Joint>
struct BlockJoints : BlockJointPass<D, Real_, Joint> {
  static constexpr char const* name = "block joints";
  using Pass = BlockJointPass<D, Real_, Joint>;
  using Real = Real_;
  using Pass::C, Pass::F, Pass::P;

  template <class S>
  FISSURE_HOT void operator()(Index b) const {
    if (this->joint.asleep(b)) return;
    Vec<S, D> X[C], u[C], f[C];
    this->template read<S>(b, X, u);
    auto const row = [&](int l) { return this->blocks.force + static_cast<std::size_t>(b + l) * (C * D); };
    load_rows<C * D>(f[0].data(), row);
    this->template prefetch_faces<S>(b + 2 * layout_width);
    FaceMotion<D, P, S> faces[F];
    this->read_faces(b, X, u, faces);
    for (int a = 0; a < F; ++a) {
      S area[P];
      this->areas(b, a, area);
      Vec<S, D> pull[P];
      this->joint.template pull<S>(
          b, a, faces[a], area,
          [&](int i, int l) {
            return Vec<Real, D>(this->mesh.velocity(this->across(b + l, a, i)) -
                                this->mesh.velocity(static_cast<Index>(this->own(b + l, Pass::Shape::face(a, i)))));
          },
          BookedBy{this->blocks.first_part + b * this->blocks.parts, this->blocks.parts}, pull);
      for (int i = 0; i < P; ++i) f[Pass::Shape::face(a, i)] += pull[i];
    }
    store_rows<C * D>(f[0].data(), row);
  }
};

/// Energy held in joints around blocks [J], each side its half.
template <int D, class Real_, class Joint>
struct BlockJointEnergy : BlockJointPass<D, Real_, Joint> {
  static constexpr char const* name = "block joint energy";
  using Pass = BlockJointPass<D, Real_, Joint>;
  using Real = Real_;
  using Pass::C, Pass::F, Pass::P;

  template <class S>
  FISSURE_HD void operator()(Index b, Sums<1>& sums) const {
    if (this->joint.asleep(b)) return;
    Vec<S, D> X[C], u[C];
    this->template read<S>(b, X, u);
    FaceMotion<D, P, S> faces[F];
    this->read_faces(b, X, u, faces);
    double held[lane_width<S>] = {};
    for (int a = 0; a < F; ++a) {
      S area[P];
      this->areas(b, a, area);
      this->joint.add_stored(b, a, faces[a], area, held);
    }
    for (double of_cell : held) sums[0] += of_cell;
  }
};

}  // namespace fissure::kernels
