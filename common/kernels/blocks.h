// Forces of quadrilaterals and hexahedra. Everything is referred to the shape at rest: with the gradients g_a of the
// shape functions there, F = I + sum u_a (x) g_a and f_a = -sum over points of w tau F^-T g_a, w the volume at rest of
// a point.
//
//   one point        gradients averaged over the cell (Flanagan, Belytschko 1981, 10.1002/nme.1620170504: exact for any
//                    distorted cell under uniform stress), and a spring against each hourglass mode
//   assumed strain   the same, springs as stiff as the material: the strains of pure bending and torsion, without those
//                    that make thin cells lock (after Belytschko & Bindeman 1993, doi 10.1016/0045-7825(93)90124-G)
//   full             two Gauss points per axis
//   B-bar            full, with the change of volume of the whole cell at every point (Hughes 1980, doi
//                    10.1002/nme.1620150914, in the large: F times (mean J / J)^(1/3))
//
// In axisymmetry each corner also has the weight c_a of its radial displacement in the hoop strain, N_a/r or its mean
// by volume.
//
// Hourglass modes m of the displacement that a uniform gradient does not explain: q_m = h_m . u - H (h_m . X), zero in
// any rigid motion. Springs have the energy W(q, F), all forces are its derivatives, so that they neither take nor give
// energy.
#pragma once
#include "backend/for_each.h"
#include "base/block_shape.h"
#include "base/rows.h"
#include "kernels/deformation.h"
#include "kernels/flow.h"
#include "kernels/views.h"
#include "laws/damping.h"

namespace fissure::kernels {

enum class Integration { one_point, assumed_strain, full, b_bar };

/// Numbers of a block's shape at rest, in this order.
template <int D>
struct BlockNumbers {
  using Shape = BlockShape<D>;
  // mean g_a [1/m]; full integration: the corners X_a [m]
  static constexpr int gradients = 0;
  static constexpr int moments = Shape::corners * D;         // h_m . X [m]
  static constexpr int volume = moments + Shape::modes * D;  // [m^3]
  static constexpr int springs = volume + 1;                 // one point: stiffness of a mode [N/m]
  // assumed strain: unit axes over 2^D half lengths [1/m]
  static constexpr int axes = springs;
  static constexpr int lengths = axes + D * D;  // and the half lengths [m]
  FISSURE_HD static constexpr int count(Integration how, bool axisymmetric) {
    int const hoops = axisymmetric && points(how) == 1 ? Shape::corners : 0;  // the last ones: mean of N_a/r [1/m]
    return hoops + (how == Integration::one_point        ? springs + 1
                    : how == Integration::assumed_strain ? lengths + D
                                                         : Shape::corners * D);
  }
  FISSURE_HD static constexpr int points(Integration how) {
    return how == Integration::one_point || how == Integration::assumed_strain ? 1 : Shape::points;
  }
};

/// Blocks of one body. Arrays begin with its first block.
template <int D, class Real>
struct BlockView {
  Index const* vertex = nullptr;  // blocked, number a of 2^D
  Real const* numbers = nullptr;  // blocked, BlockNumbers<D>::count(how)
  Real* force = nullptr;          // [block][corner][D] [N]
  Index first_part = 0;           // element that is the first part of the first block
  int parts = 1;                  // simplices that a block is made of, for contact
  bool own = false;               // corners have vertices of their own, one block's after the other's
  Integration how = Integration::one_point;
  double young = 0, poisson = 0;  // of springs [Pa, -]
  bool thin = false;              // plane stress
};

/// What passes over blocks share.
template <int D, class Real_, class Bulk>
struct BlockPass {
  static constexpr bool packed = true;
  using Real = Real_;
  using Shape = BlockShape<D>;
  using Number = BlockNumbers<D>;
  static constexpr int C = Shape::corners, M = Shape::modes;

  MeshView<D, Real> mesh;
  BlockView<D, Real> blocks;
  MemoryView<Real> memory;
  Bulk bulk;
  laws::Viscosity damping;

  /// Shape functions at one point of a block at rest, and the volume that the point stands for.
  template <class S>
  struct Point {
    Vec<S, D> g[C];  // [1/m]
    S c[C];          // weights of the hoop strain [1/m]: axisymmetry only
    S volume;        // [m^3]
  };
  /// Strain at a point.
  template <class S>
  struct Motion {
    Mat<S, D> H;         // displacement gradient [-]
    S hoop = S(0);       // strain out of the plane [-]: axisymmetry only
    S j;                 // J - 1
    Mat<S, D> cofactor;  // of F, and
    S inverse;           // 1 over its determinant: F^-T = cofactor * inverse
  };

  FISSURE_HD bool one_point() const { return Number::points(blocks.how) == 1; }
  FISSURE_HD bool axisymmetric() const { return Dim<D>::can_revolve && mesh.axisymmetric; }
  FISSURE_HD Index count() const { return Number::count(blocks.how, axisymmetric()); }
  template <class S>
  FISSURE_HD S number(Index b, int k) const {
    return load<S>(blocks.numbers + blocked(b, k, count()));
  }
  template <class S>
  FISSURE_HD Vec<S, D> vector(Index b, int from, int k) const {
    Vec<S, D> x;
    for (int c = 0; c < D; ++c) x[c] = number<S>(b, from + k * D + c);
    return x;
  }
  template <class S>
  FISSURE_HD void read(Real const* by_vertex, Index b, Vec<S, D> (&x)[C]) const {
    auto const at = [&](int l, int a) {
      return by_vertex + static_cast<std::size_t>(blocks.vertex[blocked(b + l, a, C)]) * D;
    };
    if (blocks.own)
      load_rows<C * D>(x[0].data(), [&](int l) { return at(l, 0); });
    else
      for (int a = 0; a < C; ++a) load_rows<D>(x[a].data(), [&](int l) { return at(l, a); });
  }

  /// Where flow keeps what point p of a block remembers.
  FISSURE_HD Index remembered(Index b, int p) const { return point_of_block(b, p, Number::points(blocks.how)); }

  template <class S>
  FISSURE_HD Point<S> point(Index b, int p) const {
    Point<S> at;
    if (one_point()) {
      for (int a = 0; a < C; ++a) at.g[a] = vector<S>(b, Number::gradients, a);
      if constexpr (Dim<D>::can_revolve)
        for (int a = 0; a < C && axisymmetric(); ++a) at.c[a] = number<S>(b, count() - C + a);
      at.volume = number<S>(b, Number::volume);
      return at;
    }
    Mat<S, D> J = Mat<S, D>::Constant(S(0));  // dX/dxi
    S radius = S(0);
    for (int a = 0; a < C; ++a) {
      Vec<S, D> const X = vector<S>(b, Number::gradients, a);
      for (int k = 0; k < D; ++k) J.col(k) += X * as<S>(Shape::slope(a, k, p));
      if constexpr (Dim<D>::can_revolve) radius += X[0] * as<S>(Shape::value(a, p));
    }
    Mat<S, D> const cofactor = Dim<D>::cofactor(J);
    S const det = J.col(0).dot(cofactor.col(0)), inverse = S(1) / det;
    for (int a = 0; a < C; ++a) {
      at.g[a] = cofactor.col(0) * (as<S>(Shape::slope(a, 0, p)) * inverse);
      for (int k = 1; k < D; ++k) at.g[a] += cofactor.col(k) * (as<S>(Shape::slope(a, k, p)) * inverse);
    }
    at.volume = det * as<S>(mesh.thickness);
    if constexpr (Dim<D>::can_revolve)
      if (axisymmetric()) {
        for (int a = 0; a < C; ++a) at.c[a] = as<S>(Shape::value(a, p)) / radius;
        at.volume = det * radius * as<S>(2 * std::numbers::pi);
      }
    return at;
  }

  /// sum x_a (x) g_a, and what of it is out of the plane.
  template <class S>
  FISSURE_HD static Mat<S, D> gradient(Vec<S, D> const (&x)[C], Point<S> const& at) {
    Mat<S, D> H = x[0] * at.g[0].transpose();
    for (int a = 1; a < C; ++a) H += x[a] * at.g[a].transpose();
    return H;
  }
  template <class S>
  FISSURE_HD S hoop([[maybe_unused]] Vec<S, D> const (&x)[C], [[maybe_unused]] Point<S> const& at) const {
    S sum = S(0);
    if constexpr (Dim<D>::can_revolve)
      for (int a = 0; a < C && axisymmetric(); ++a) sum += at.c[a] * x[a][0];
    return sum;
  }
  template <class S>
  FISSURE_HD Motion<S> motion(Vec<S, D> const (&u)[C], Point<S> const& at) const {
    Motion<S> m;
    m.H = gradient(u, at);
    S const j = Dim<D>::volume_change(m.H);
    m.hoop = hoop(u, at);
    m.j = j + m.hoop + j * m.hoop;
    m.cofactor = Dim<D>::cofactor(deformation(m));
    m.inverse = S(1) / (S(1) + j);
    return m;
  }
  template <class S>
  FISSURE_HD static Mat<S, D> deformation(Motion<S> const& m) {
    Mat<S, D> F = m.H;
    for (int i = 0; i < D; ++i) F(i, i) += S(1);
    return F;
  }

  /// (1 + mean j)^(1/3) / (1 + j)^(1/3) - 1
  template <class S>
  FISSURE_HD static S bar_stretch(S const& j, S const& mean) {
    return cbrt_minus_one(S((mean - j) / (S(1) + j)));
  }

  /// Mean of J - 1 over a block's points, by volume at rest.
  template <class S>
  FISSURE_HD S mean_swelling(Index b, Vec<S, D> const (&u)[C]) const {
    S swollen = S(0), whole = S(0);
    for (int p = 0; p < Shape::points; ++p) {
      auto const at = point<S>(b, p);
      swollen += at.volume * motion(u, at).j;
      whole += at.volume;
    }
    return swollen / whole;
  }

  /// H as the law must see it, and J - 1 with it: as it is, or for B-bar with the mean change of volume.
  template <class S>
  FISSURE_HD Mat<S, 3> seen(Motion<S> const& m, S& j, bool bar, S const& mean) const {
    Mat<S, 3> seen = Dim<D>::embed(m.H, m.hoop);
    j = m.j;
    if (!bar) return seen;
    S const s = bar_stretch(m.j, mean);
    seen += s * seen;
    for (int i = 0; i < 3; ++i) seen(i, i) += s;
    j = mean;
    return seen;
  }

  /// Amplitudes of the hourglass modes of a nodal field (displacements or velocities) whose mean gradient is H.
  template <class S>
  FISSURE_HD void modes(Index b, Vec<S, D> const (&field)[C], Mat<S, D> const& H, Vec<S, D> (&q)[M]) const {
    for (int m = 0; m < M; ++m) {
      q[m] = field[0] * S(Shape::mode(m, 0));
      for (int a = 1; a < C; ++a) q[m] += field[a] * S(Shape::mode(m, a));
      q[m] -= H * vector<S>(b, Number::moments, m);
    }
  }

  /// Energy of the springs [J] and what they pull with, dW/dq; adds to `stress` (first Piola, times volume) dW/dF at
  /// constant q.
  template <class S>
  FISSURE_HD S springs(Index b, Vec<S, D> const (&q)[M], Motion<S> const& at, Vec<S, D> (&pull)[M],
                       Mat<S, D>& stress) const {
    if (blocks.how != Integration::one_point) return material_springs<S>(b, q, at.H, pull, stress);
    S stiffness = number<S>(b, Number::springs), squares = S(0);
    for (int m = 0; m < M; ++m) squares += q[m].squaredNorm();
    S energy = as<S>(0.5) * stiffness * squares;
    // Elastic cells that are pressed would buckle into these modes, did the springs not grow (docs/theory/blocks.md).
    if constexpr (!Bulk::remembers) {
      Mat<S, D> const inverse = at.inverse * at.cofactor;  // F^-T
      S const square = inverse.squaredNorm() * as<S>(1.0 / D);
      stress -= (as<S>(4.0 / D) * square * energy) * inverse.lazyProduct(inverse.transpose().lazyProduct(inverse));
      energy *= square * square, stiffness *= square * square;
    }
    for (int m = 0; m < M; ++m) pull[m] = stiffness * q[m];
    return energy;
  }

  /// Forces of what pulls at the modes; as q = h . u - H (h . X), a part of them is a stress.
  template <class S>
  FISSURE_HD void apply(Index b, Vec<S, D> const (&pull)[M], Mat<S, D>& stress, Vec<S, D> (&f)[C]) const {
    for (int m = 0; m < M; ++m) {
      stress -= pull[m] * vector<S>(b, Number::moments, m).transpose();
      for (int a = 0; a < C; ++a) f[a] -= pull[m] * S(Shape::mode(m, a));
    }
  }

  /// Bending and torsion. Along the cell's axes i, carried by F, the amplitudes e_mi = (F a_i) . q_m are the strains at
  /// the surface that mode m makes along i. Bending: two strains that grow along the third axis k act as in a plate
  /// (plane stress), so nothing locks. Torsion: the shears xy, yz, zx, each growing along the third axis.
  template <class S>
  FISSURE_HD S material_springs(Index b, Vec<S, D> const (&q)[M], Mat<S, D> const& H, Vec<S, D> (&pull)[M],
                                Mat<S, D>& stress) const {
    S const V = number<S>(b, Number::volume);
    double const E = blocks.young, nu = blocks.poisson, plate = E / (1 - nu * nu);
    Vec<S, D> axis[D], carried[D];
    S length[D], e[M][D], s[M][D];  // s: dW/de
    for (int i = 0; i < D; ++i) {
      axis[i] = vector<S>(b, Number::axes, i);
      carried[i] = axis[i] + H * axis[i];
      length[i] = number<S>(b, Number::lengths + i);
      for (int m = 0; m < M; ++m) e[m][i] = carried[i].dot(q[m]), s[m][i] = S(0);
    }
    if constexpr (M == 1) {  // the product of both axes
      for (int i = 0; i < D; ++i) s[0][i] = as<S>((blocks.thin ? E : plate) / 3) * V * e[0][i];
    } else {
      double const G = E / (2 * (1 + nu));
      for (int k = 0; k < D; ++k) {
        int const i = (k + 1) % D, j = (k + 2) % D;  // mode j is the product of k and i, mode i of k and j
        s[j][i] += as<S>(plate / 3) * V * (e[j][i] + as<S>(nu) * e[i][j]);
        s[i][j] += as<S>(plate / 3) * V * (e[i][j] + as<S>(nu) * e[j][i]);
        s[M - 1][k] = as<S>(E / 9) * V * e[M - 1][k];
        // mode i along i shears plane ij, as mode j along j
        S const to_i = length[i] / length[j], to_j = length[j] / length[i];
        S const shear = as<S>(G / 3) * V * (e[i][i] * to_i + e[j][j] * to_j);
        s[i][i] += shear * to_i;
        s[j][j] += shear * to_j;
      }
    }
    S energy = S(0);
    for (int m = 0; m < M; ++m) {
      pull[m] = carried[0] * s[m][0];
      for (int i = 1; i < D; ++i) pull[m] += carried[i] * s[m][i];
      for (int i = 0; i < D; ++i) {
        energy += as<S>(0.5) * s[m][i] * e[m][i];
        stress += q[m] * (axis[i] * s[m][i]).transpose();
      }
    }
    return energy;
  }
};

/// f[corner] = -sum w tau F^-T g, with viscosity and springs.
template <int D, class Real_, class Bulk>
struct BlockForces : BlockPass<D, Real_, Bulk> {
  static constexpr char const* name = "blocks";
  using Pass = BlockPass<D, Real_, Bulk>;
  using Real = Real_;
  using Pass::C;
  using Shape = typename Pass::Shape;

  double dt = 0;                   // of the step that led here [s]
  double* viscous_work = nullptr;  // per element, booked on a block's first part [J]
  int* fault = nullptr;

  template <class S>
  FISSURE_HOT void operator()(Index b) const {
    Vec<S, D> u[C], v[C], f[C];
    this->template read<S>(this->mesh.u, b, u);
    if (Bulk::remembers || this->damping.on()) this->template read<S>(this->mesh.v, b, v);
    for (int a = 0; a < C; ++a) f[a] = Vec<S, D>::Constant(S(0));
    bool const bar = this->blocks.how == Integration::b_bar;
    S mean = S(0), mean_rate = S(0), swollen = S(0);
    if (bar) {
      mean = this->template mean_swelling<S>(b, u);
      if constexpr (Bulk::remembers) mean_rate = mean_growth<S>(b, u, v);
    }
    S pressed = S(0);  // sum of w tr(tau)/3
    int const points = Pass::Number::points(this->blocks.how);
    for (int p = 0; p < points; ++p) {
      auto const at = this->template point<S>(b, p);
      auto const m = this->motion(u, at);
      if (!all_lanes(m.j > as<S>(-1))) raise(fault);
      Mat<S, 3> tau;
      if constexpr (Bulk::remembers) {
        tau = flowing<S>(b, p, at, v, m, bar, mean, mean_rate);
      } else {
        S j;
        Mat<S, 3> const H = this->seen(m, j, bar, mean);
        tau = this->bulk.template kirchhoff<S>(H, j);
      }
      if (bar) {
        S const third = tau.trace() * as<S>(1.0 / 3);
        for (int i = 0; i < 3; ++i) tau(i, i) -= third;
        pressed += at.volume * third;
        swollen += at.volume * (S(1) + m.j);
      }
      if (this->damping.on()) tau += viscous<S>(b, at, v, m);
      Mat<S, D> stress = tau.template topLeftCorner<D, D>();
      stress = (at.volume * m.inverse) * (stress * m.cofactor).eval();
      if (points == 1) resist_modes<S>(b, at, u, v, m, stress, f);
      push<S>(at, stress, at.volume * tau(2, 2) / (S(1) + m.hoop), f);
    }
    if (bar) {  // pressure acts on the volume of the whole: sum over points of w J F^-T g
      S const pressure = pressed / swollen;
      for (int p = 0; p < points; ++p) {
        auto const at = this->template point<S>(b, p);
        auto const m = this->motion(u, at);
        S const volume = pressure * at.volume;
        push<S>(at, Mat<S, D>(m.cofactor * (volume * (S(1) + m.hoop))), volume * (S(1) + m.j) / (S(1) + m.hoop), f);
      }
    }
    store_rows<C * D>(f[0].data(),
                      [&](int l) { return this->blocks.force + static_cast<std::size_t>(b + l) * (C * D); });
  }

  /// Forces of a stress (first Piola, times volume) and, in axisymmetry, of that around the axis.
  template <class S>
  FISSURE_HD void push(typename Pass::template Point<S> const& at, Mat<S, D> const& stress,
                       [[maybe_unused]] S const& around, Vec<S, D> (&f)[C]) const {
    for (int a = 0; a < C; ++a) f[a] -= stress * at.g[a];
    if constexpr (Dim<D>::can_revolve)
      for (int a = 0; a < C && this->axisymmetric(); ++a) f[a][0] -= around * at.c[a];
  }

  /// Springs, and with viscosity dampers beside them, slow as the material itself in shear: after viscosity/G they have
  /// let go. All forces of the springs grow by the share slow W'/(2 W): for one mode that is a damper of slow k q', and
  /// as W is the same in any frame, a body that spins feels nothing of it.
  template <class S>
  FISSURE_HD void resist_modes(Index b, typename Pass::template Point<S> const& at, Vec<S, D> const (&u)[C],
                               Vec<S, D> const (&v)[C], typename Pass::template Motion<S> const& m, Mat<S, D>& stress,
                               Vec<S, D> (&f)[C]) const {
    Vec<S, D> q[Pass::M], pull[Pass::M];
    Mat<S, D> carried = Mat<S, D>::Constant(S(0));
    this->modes(b, u, m.H, q);
    S const energy = this->springs(b, q, m, pull, carried);
    if (this->damping.on()) {
      double const slow = this->damping.slowness(this->blocks.young, this->blocks.poisson);  // [s]
      Mat<S, D> const rate = this->gradient(v, at);
      this->modes(b, v, rate, q);
      S power = carried.cwiseProduct(rate).sum();
      for (int k = 0; k < Pass::M; ++k) power += pull[k].dot(q[k]);
      S const share = as<S>(0.5 * slow) * power / (energy + as<S>(std::numeric_limits<Real>::min()));
      for (int k = 0; k < Pass::M; ++k) pull[k] += share * pull[k];
      carried += share * carried;
      add_viscous_work<S>(b, share * power * as<S>(dt));
    }
    stress += carried;
    this->apply(b, pull, stress, f);
  }
  template <class S>
  FISSURE_HD void add_viscous_work(Index b, S const& work) const {
    for (int l = 0; l < lane_width<S>; ++l)
      viscous_work[this->blocks.first_part + (b + l) * this->blocks.parts] += static_cast<double>(lane(work, l));
  }

  /// 2 mu D J, and its work.
  template <class S>
  FISSURE_HD Mat<S, 3> viscous(Index b, typename Pass::template Point<S> const& at, Vec<S, D> const (&v)[C],
                               typename Pass::template Motion<S> const& m) const {
    Mat<S, 3> const L = midway_gradient<S>(at, v, as<S>(dt), m), rate = as<S>(0.5) * (L + L.transpose());
    Mat<S, 3> const stress = this->damping.kirchhoff(rate, m.j);
    add_viscous_work<S>(b, at.volume * as<S>(dt) * stress.cwiseProduct(rate).sum());
    return stress;
  }

  /// Gradient of a motion of which `share` led here, by coordinates in the middle of that way: dF (F - share dF/2)^-1.
  template <class S>
  FISSURE_HD Mat<S, 3> midway_gradient(typename Pass::template Point<S> const& at, Vec<S, D> const (&moved)[C],
                                       S const& share, typename Pass::template Motion<S> const& m) const {
    Mat<S, D> const dF = this->gradient(moved, at), middle = this->deformation(m) - (as<S>(0.5) * share) * dF,
                    cofactor = Dim<D>::cofactor(middle);
    Mat<S, D> const G = (dF * cofactor.transpose()).eval() * (S(1) / middle.col(0).dot(cofactor.col(0)));
    S const out = this->hoop(moved, at);
    return Dim<D>::embed(G, S(out / (S(1) + m.hoop - as<S>(0.5) * share * out)));
  }
  /// Increment of displacement in the step that led here.
  template <class S>
  FISSURE_HD Mat<S, 3> increment(typename Pass::template Point<S> const& at, Vec<S, D> const (&moved)[C],
                                 typename Pass::template Motion<S> const& m) const {
    S const share = as<S>(dt);
    return share * midway_gradient<S>(at, moved, share, m);
  }

  /// Mean of the increments' trace over the points, by volume in the middle of the step: so it is the cell's change of
  /// volume, by its gradients, whose digits do not depend on how far the body has flown.
  template <class S>
  FISSURE_HD S mean_growth(Index b, Vec<S, D> const (&u)[C], Vec<S, D> const (&moved)[C]) const {
    S sum = S(0), whole = S(0);
    for (int p = 0; p < Shape::points; ++p) {
      auto const at = this->template point<S>(b, p);
      auto const m = this->motion(u, at);
      S const growth = increment<S>(at, moved, m).trace(),
              middle = at.volume * (S(1) + m.j) * (S(1) - as<S>(0.5) * growth);
      sum += middle * growth;
      whole += middle;
    }
    return sum / whole;
  }

  /// tau of a law that remembers, after one step.
  template <class S>
  FISSURE_HD Mat<S, 3> flowing(Index b, int p, typename Pass::template Point<S> const& at, Vec<S, D> const (&moved)[C],
                               typename Pass::template Motion<S> const& m, bool bar, S const& mean,
                               S const& mean_rate) const {
    Mat<S, 3> G = increment<S>(at, moved, m);
    if (bar) {
      S const change = (mean_rate - G.trace()) * as<S>(1.0 / 3);
      for (int i = 0; i < 3; ++i) G(i, i) += change;
    }
    Mat<S, 3> tau;
    Index const e = this->remembered(b, p);
    S const j = bar ? mean : m.j;
    Flow<D, Real> const flow{this->bulk, this->memory};
    this->bulk.flow.visit([&](auto const& law) { tau = flow.template step<S>(law, e, G, j, at.volume, dt, fault); });
    return tau;
  }
};

/// Energies of blocks [J]: 0 elastic, 1 in springs against hourglass modes. Assumed strains of a body that only deforms
/// elastically are its own: what they hold is elastic.
template <int D, class Real_, class Bulk>
struct BlockEnergy : BlockPass<D, Real_, Bulk> {
  static constexpr char const* name = "block energy";
  using Pass = BlockPass<D, Real_, Bulk>;
  using Real = Real_;
  using Pass::C;

  template <class S>
  FISSURE_HD void operator()(Index b, Sums<2>& sums) const {
    Vec<S, D> u[C];
    this->template read<S>(this->mesh.u, b, u);
    bool const bar = this->blocks.how == Integration::b_bar;
    S const mean = bar ? this->template mean_swelling<S>(b, u) : S(0);
    int const points = Pass::Number::points(this->blocks.how);
    S elastic = S(0);
    for (int p = 0; p < points; ++p) {
      auto const at = this->template point<S>(b, p);
      auto const m = this->motion(u, at);
      if constexpr (Bulk::remembers) {
        elastic += at.volume * this->bulk.energy(Flow<D, Real>{this->bulk, this->memory}.template tensor<S>(
                                   this->remembered(b, p), 0));
      } else {
        S j;
        Mat<S, 3> const H = this->seen(m, j, bar, mean);
        elastic += at.volume * this->bulk.template energy<S>(H, j);
      }
      if (points == 1) {
        Vec<S, D> q[Pass::M], pull[Pass::M];
        Mat<S, D> unused = Mat<S, D>::Constant(S(0));
        this->modes(b, u, m.H, q);
        S const held = this->springs(b, q, m, pull, unused);
        if (!Bulk::remembers && this->blocks.how == Integration::assumed_strain)
          elastic += held;
        else
          add_lanes(held, sums[1]);
      }
    }
    add_lanes(elastic, sums[0]);
  }
};

/// Cauchy stress of blocks [Pa], the mean over their points: xx yy zz xy yz zx, for each of their parts.
template <int D, class Real_, class Bulk>
struct BlockStress : BlockPass<D, Real_, Bulk> {
  static constexpr char const* name = "block stress";
  using Pass = BlockPass<D, Real_, Bulk>;
  using Real = Real_;
  using Pass::C;

  double* stress = nullptr;  // [element][6]

  template <class S>
  FISSURE_HD void operator()(Index b) const {
    Vec<S, D> u[C];
    this->template read<S>(this->mesh.u, b, u);
    bool const bar = this->blocks.how == Integration::b_bar;
    S const mean = bar ? this->template mean_swelling<S>(b, u) : S(0);
    int const points = Pass::Number::points(this->blocks.how);
    Mat<S, 3> sum = Mat<S, 3>::Constant(S(0));
    S whole = S(0);
    for (int p = 0; p < points; ++p) {
      auto const at = this->template point<S>(b, p);
      auto const m = this->motion(u, at);
      S volume = at.volume;
      whole += volume;
      if constexpr (Bulk::remembers) {
        Flow<D, Real> const flow{this->bulk, this->memory};
        Index const e = this->remembered(b, p);
        volume =
            volume / ((S(1) + (bar ? mean : m.j)) * (S(1) + flow.template number<S>(e, this->bulk.memory.thickness)));
        sum += volume * flow.template tensor<S>(e, 0);
      } else {
        S j;
        Mat<S, 3> const H = this->seen(m, j, bar, mean);
        sum += (volume / this->bulk.template volume_ratio<S>(H, j)) * this->bulk.template kirchhoff<S>(H, j);
      }
    }
    for (int l = 0; l < lane_width<S>; ++l)
      for (int part = 0; part < this->blocks.parts; ++part)
        for (int k = 0; k < 6; ++k)
          stress[(static_cast<std::size_t>(this->blocks.first_part) + (b + l) * this->blocks.parts + part) * 6 + k] =
              static_cast<double>(lane(sum(tensor_row(k), tensor_column(k)), l) / lane(whole, l));
  }
};

/// What a block's tangent depends on, as ElementDeformation: the largest at one of its points.
template <int D, class Real_>
struct BlockDeformation : BlockPass<D, Real_, laws::Plastic> {
  static constexpr char const* name = "block deformation";
  using Pass = BlockPass<D, Real_, laws::Plastic>;
  using Real = Real_;
  using Pass::C;

  template <class S>
  FISSURE_HD void operator()(Index b, Sums<4>& sums) const {
    Vec<S, D> u[C];
    this->template read<S>(this->mesh.u, b, u);
    Vec<S, D> v[C];
    this->template read<S>(this->mesh.v, b, v);
    S fastest = S(0);
    for (int a = 0; a < C; ++a) fastest = larger(fastest, v[a].squaredNorm());
    for (int p = 0; p < Pass::Number::points(this->blocks.how); ++p) {
      auto const at = this->template point<S>(b, p);
      auto const m = this->motion(u, at);
      Mat<S, D> const cofactor = m.cofactor * m.inverse;
      S squares = S(0);
      for (int a = 0; a < C; ++a) squares += Vec<S, D>(cofactor * at.g[a]).squaredNorm();
      if constexpr (Dim<D>::can_revolve)
        for (int a = 0; a < C && this->axisymmetric(); ++a) {
          S stretch = at.c[a] / (S(1) + m.hoop);
          // Corners on the axis stay there: their weights, large at a point beside it, would hide what changes
          // elsewhere.
          if (!this->one_point())
            stretch = select(this->template number<S>(b, Pass::Number::gradients + a * D) > S(0), stretch, S(0));
          squares += stretch * stretch;
        }
      raise_deformation<D, S>(squares, m.H, m.hoop, fastest, sums);
    }
  }
};

}  // namespace fissure::kernels
