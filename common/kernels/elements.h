// Forces of elements and of the joints on their faces, in one pass over the elements.
//
// Every element evaluates its own share of the joints around it (kernels/joints.h; corners are sorted by mesh node, so
// both sides see them in one order): no force is written twice and no order of summation exists.
//
// In axisymmetry (x is the radius, y the axis) a triangle is a ring of the volume 2 pi R A (Pappus), R its centroid's
// radius at rest. Its hoop strain is u_r/R at the centroid: one point, which no axis makes singular. All is per full
// revolution.
#pragma once
#include <limits>

#include "backend/for_each.h"
#include "base/elementary.h"
#include "base/rows.h"
#include "kernels/deformation.h"
#include "kernels/flow.h"
#include "kernels/joints.h"
#include "laws/damping.h"

namespace fissure::kernels {

/// What the joints around elements need. Blocked arrays; number a belongs to the face opposite corner a.
template <int D, class Real>
struct JointView {
  Index* link = nullptr;   // neighbour * 4 + its face number; itself where there is no joint        [D + 1]
  Real* weight = nullptr;  // reference area per corner of the face (mean), 0: there is no joint [m^2] [D + 1]
  Index vertex_shift = 0;  // vertex of corner a of element e: e (D + 1) + a + shift
};

/// Pressure averaged over the elements about a node that are still joined; null: each element has its own.
template <class Real>
struct PatchView {
  Index const* of_corner = nullptr;  // blocked, number a of D + 1
  Real* pressure = nullptr;          // (K ln(J) - k (J - 1))/J of the patch's volume ratio J, k = patch_spring() [Pa]
  Real* energy = nullptr;            // K ln(J)^2/2 - k (J - 1 - ln(J)) per reference volume [J/m^3]
};

/// Mean over the corners of the component across the axis.
template <int D, class S>
FISSURE_HD S mean_radial(Vec<S, D> const (&x)[D + 1]) {
  S sum = x[0][0];
  for (int a = 1; a <= D; ++a) sum += x[a][0];
  return sum * as<S>(1.0 / (D + 1));
}

/// Kinematics of one simplex: everything that follows from its corners.
template <int D, class S>
struct ElementMotion {
  Mat<S, D> H;        // displacement gradient [-]
  Mat<S, D> edges;    // current, from corner 0 [m]
  Mat<S, D> current;  // column b: cofactors of the current edges [m^(D-1)]
  S det0;             // determinant of the reference edges [m^D]
  S inverse1;         // 1 / that of the current ones
  S j;                // J - 1
  S radius = S(1);    // of the centroid at rest [m], and
  S hoop = S(0);      // its share of growth, the strain out of the plane [-]: axisymmetry only

  /// +1 where the corners of face a, in their order, turn its normal outward, else -1.
  FISSURE_HD S outward(int a) const { return select(det0 > S(0), S(a % 2 == 0 ? 1 : -1), S(a % 2 == 0 ? -1 : 1)); }

  /// H in three dimensions.
  FISSURE_HD decltype(auto) gradient() const { return Dim<D>::embed(H, hoop); }
  /// Of the centroid now [m]; axisymmetry only.
  FISSURE_HD S radius_now() const { return radius + radius * hoop; }

  FISSURE_HD ElementMotion(Vec<S, D> const (&X)[D + 1], Vec<S, D> const (&u)[D + 1],
                           [[maybe_unused]] bool axisymmetric) {
    Mat<S, D> moved;
    for (int b = 0; b < D; ++b) {
      edges.col(b) = X[b + 1] - X[0];
      moved.col(b) = u[b + 1] - u[0];
    }
    Mat<S, D> const C = Dim<D>::cofactor(edges);
    det0 = edges.col(0).dot(C.col(0));
    S const inverse0 = S(1) / det0;
    for (int i = 0; i < D; ++i)
      for (int k = 0; k < D; ++k) H(i, k) = moved.row(i).dot(C.row(k)) * inverse0;
    edges += moved;
    current = Dim<D>::cofactor(edges);
    inverse1 = S(1) / edges.col(0).dot(current.col(0));
    j = Dim<D>::volume_change(H);
    if constexpr (Dim<D>::can_revolve)
      if (axisymmetric) {
        radius = mean_radial<D, S>(X);
        hoop = mean_radial<D, S>(u) / radius;
        j += hoop + j * hoop;
      }
  }
};

/// Instead of a law: the elements' own forces are there already. They lie beside blocks; their corners' vertices stand
/// anywhere.
struct JointsOnly {
  static constexpr bool remembers = false;
};

/// What all passes over elements share: the views, the laws, and how to read an element and its faces.
template <int D, class Real_, class Bulk, class Joint>
struct ElementPass {
  static constexpr bool packed = true;
  static constexpr bool jointed = !std::is_same_v<Joint, void>;
  // elements are cells, each with its corners in a row
  static constexpr bool whole = !std::is_same_v<Bulk, JointsOnly>;
  static constexpr int C = D + 1;
  using Real = Real_;
  using JointsOfFaces = std::conditional_t<jointed, Joints<D, D + 1, D, Real, Joint>, int>;

  MeshView<D, Real> mesh;
  JointView<D, Real> joints;
  MemoryView<Real> memory;
  PatchView<Real> patches;
  Bulk bulk;
  JointsOfFaces joint{};
  laws::Viscosity damping;

  /// Numbers of the corners of element e, from an array by vertex, into one pack after the other.
  template <class S>
  FISSURE_HD void read_corners(Real const* from, Index e, Vec<S, D> (&x)[C]) const {
    if constexpr (jointed && whole)
      load_rows<C * D>(x[0].data(), [&](int l) { return from + own(e + l) * D; });
    else
      for (int a = 0; a < C; ++a)
        load_rows<D>(x[a].data(), [&](int l) { return from + static_cast<std::size_t>(mesh.vertex(e + l, a)) * D; });
  }

  /// The first vertex of an element whose corners have vertices of their own: the others follow it.
  FISSURE_HD std::size_t own(Index e) const { return static_cast<std::size_t>(e * C + joints.vertex_shift); }

  template <class S>
  FISSURE_HD void read(Index e, Vec<S, D> (&X)[C], Vec<S, D> (&u)[C]) const {
    for (int a = 0; a < C; ++a)
      for (int c = 0; c < D; ++c) X[a][c] = load<S>(mesh.X + blocked(e, a * D + c, C * D));
    read_corners<S>(mesh.u, e, u);
  }
  /// The same whether or not corners have vertices of their own.
  template <class S>
  FISSURE_HD void read_shared(Index e, Vec<S, D> (&X)[C], Vec<S, D> (&u)[C]) const {
    for (int a = 0; a < C; ++a) {
      for (int c = 0; c < D; ++c) X[a][c] = load<S>(mesh.X + blocked(e, a * D + c, C * D));
      load_rows<D>(u[a].data(), [&](int l) { return mesh.u + static_cast<std::size_t>(mesh.vertex(e + l, a)) * D; });
    }
  }

  /// Asks memory for what the faces of elements e and on will read: a processor cannot foresee where neighbours are.
  template <class S>
  FISSURE_HD void prefetch_faces([[maybe_unused]] Index e) const {
    if constexpr (lane_width < S >> 1) {
      if (e >= mesh.n_elements) return;
      for (int a = 0; a < C; ++a)
        for (int l = 0; l < lane_width<S>; ++l) {
          Real const* const row = mesh.u + own(joints.link[blocked(e, a, C) + l] >> 2) * D;
          __builtin_prefetch(row);
          __builtin_prefetch(row + C * D - 1);
        }
    }
  }

  /// The gap at each corner of face a, and twice the corners of the surface midway between both sides.
  template <class S>
  FISSURE_HD void read_face(Index e, int a, Vec<S, D> const (&X)[C], Vec<S, D> const (&u)[C], Vec<S, D> (&gap)[D],
                            Vec<S, D> (&middle)[D]) const {
    // The other side's corners of this face are all but its own face number, in the same order.
    Index const* const link = joints.link + blocked(e, a, C);
    S const skipped = generate<S>([&](int l) { return link[l] & 3; });
    Vec<S, D> theirs[C];
    if constexpr (whole)
      load_rows<C * D>(theirs[0].data(), [&](int l) { return mesh.u + own(link[l] >> 2) * D; });
    else
      for (int b = 0; b < C; ++b)
        load_rows<D>(theirs[b].data(),
                     [&](int l) { return mesh.u + static_cast<std::size_t>(mesh.vertex(link[l] >> 2, b)) * D; });
    for (int i = 0; i < D; ++i) {
      int const corner = i + (i >= a);
      auto const next = skipped <= S(i);
      for (int c = 0; c < D; ++c) {
        S const across = select(next, theirs[i + 1][c], theirs[i][c]);
        gap[i][c] = across - u[corner][c];
        middle[i][c] = (X[corner][c] + X[corner][c]) + (across + u[corner][c]);
      }
    }
  }

  /// Reference volume [m^3].
  template <class S>
  FISSURE_HD S volume(ElementMotion<D, S> const& motion) const {
    S const measure = larger(motion.det0, -motion.det0) * as<S>(Dim<D>::simplex_share);
    if constexpr (Dim<D>::can_revolve)
      if (mesh.axisymmetric) return measure * motion.radius * as<S>(2 * std::numbers::pi);
    return measure * as<S>(mesh.thickness);
  }

  /// Gradient of a motion (by vertex) of which `share` led here, by coordinates in the middle of that way, in three
  /// dimensions: a body that turns has none but a skew one, however far it turned.
  template <class S>
  FISSURE_HD Mat<S, 3> midway_gradient(Real const* by_vertex, S const& share, Index e,
                                       ElementMotion<D, S> const& motion) const {
    Vec<S, D> moved[C];
    read_corners<S>(by_vertex, e, moved);
    Mat<S, D> step, G;
    FISSURE_UNROLL
    for (int b = 0; b < D; ++b) step.col(b) = moved[b + 1] - moved[0];
    Mat<S, D> const middle = motion.edges - (as<S>(0.5) * share) * step, cofactors = Dim<D>::cofactor(middle);
    S const inverse = S(1) / middle.col(0).dot(cofactors.col(0));
    FISSURE_UNROLL
    for (int i = 0; i < D; ++i) {
      FISSURE_UNROLL
      for (int k = 0; k < D; ++k) G(i, k) = step.row(i).dot(cofactors.row(k)) * inverse;
    }
    S hoop = S(0);
    if constexpr (Dim<D>::can_revolve)
      if (mesh.axisymmetric) {
        S const outward = mean_radial<D, S>(moved);
        hoop = outward / (motion.radius_now() - as<S>(0.5) * share * outward);
      }
    return Dim<D>::embed(G, hoop);
  }

  /// Area of the joint on face a at each of the face's corners [m^2], from the mean of all: of rings, the outer one is
  /// larger.
  template <class S>
  FISSURE_HD void joint_areas(Index e, int a, S (&area)[D]) const {
    S const mean = load<S>(joints.weight + blocked(e, a, C));
    for (S& at : area) at = mean;
    if constexpr (Dim<D>::can_revolve)
      if (mesh.axisymmetric) {
        auto const radius = [&](int k) { return load<S>(mesh.X + blocked(e, (k + (k >= a)) * D, C * D)); };
        S radii = radius(0);
        for (int k = 1; k < D; ++k) radii += radius(k);
        S const least = as<S>(std::numeric_limits<Real>::min());  // a face on the axis has no joint, but is read too
        for (int i = 0; i < D; ++i) area[i] = mean * ring_share<D>(radius(i), larger(radii * as<S>(1.0 / D), least));
      }
  }

  /// Mean of a number of the patches around an element's corners.
  template <class S>
  FISSURE_HD S patch_mean(Real const* of, Index e) const {
    return generate<S>([&](int l) {
      Real sum = 0;
      for (int a = 0; a < C; ++a) sum += of[patches.of_corner[blocked(e + l, a, C)]];
      return sum / C;
    });
  }

  /// Memory of elements that flow.
  FISSURE_HD Flow<D, Real> flow() const { return {bulk, memory}; }

  /// Kirchhoff stress of an element that flows [Pa]: as it remembers it, under the pressure of its patches if there are
  /// any.
  template <class S>
  FISSURE_HD Mat<S, 3> remembered_stress(Index e, S const& j) const {
    Mat<S, 3> tau = flow().template tensor<S>(e, 0);
    if (patches.of_corner) take_patch_pressure(e, j, tau);
    return tau;
  }
  template <class S>
  FISSURE_HD void take_patch_pressure(Index e, S const& j, Mat<S, 3>& tau) const {
    S const mean = (S(1) + j) * patch_mean<S>(patches.pressure, e) + as<S>(bulk.patch_spring()) * j;
    S const change = mean - tau.trace() * as<S>(1.0 / 3);
    for (int i = 0; i < 3; ++i) tau(i, i) += change;
  }
  /// Of volume, per reference volume [J/m^3].
  template <class S>
  FISSURE_HD S patch_energy(Index e, S const& j) const {
    return patch_mean<S>(patches.energy, e) + as<S>(bulk.patch_spring()) * excess_over_log(j);
  }
};

/// How fast the gap at point i of face a of element e + l grows [m/s]. It knows no bulk law, so that softening is
/// compiled once for all of them.
template <int D, class Real>
struct GapRate {
  MeshView<D, Real> const& mesh;
  Index const* link;
  Index e;
  int a;

  FISSURE_HD Vec<Real, D> operator()(int i, int l) const {
    Index const across = link[blocked(e, a, D + 1) + l];
    return mesh.velocity(mesh.vertex(across >> 2, i + (i >= (across & 3)))) -
           mesh.velocity(mesh.vertex(e + l, i + (i >= a)));
  }
};

/// Bulk and joint forces of elements: f[corner] = -V tau grad N + tractions. Costs are counted in docs/performance.md.
template <int D, class Real_, class Bulk, class Joint>
struct ElementForces : ElementPass<D, Real_, Bulk, Joint> {
  static constexpr char const* name = "elements";
  using Pass = ElementPass<D, Real_, Bulk, Joint>;
  using Real = Real_;
  using Pass::C, Pass::jointed;

  double dt = 0;                   // of the step that led here [s]
  Real* force = nullptr;           // [corner][D] [N]
  double* viscous_work = nullptr;  // of viscosity, per element [J]
  int* fault = nullptr;            // set to 1 when an element is pressed flat or not a number:
  double least_volume = 0;         // its volume over that at rest is not above this

  template <class S>
  FISSURE_HOT void operator()(Index e) const {
    Vec<S, D> X[C], u[C], f[C];
    this->template read<S>(e, X, u);
    ElementMotion<D, S> const motion(X, u, this->mesh.axisymmetric);
    if constexpr (Pass::whole) {
      if (!all_lanes(motion.j > as<S>(least_volume - 1))) raise(fault);
      add_bulk<S>(e, motion, f);
    } else {
      load_rows<C * D>(f[0].data(), [&](int l) { return force + static_cast<std::size_t>(e + l) * (C * D); });
    }
    if constexpr (jointed) {
      if (!this->joint.asleep(e)) {
        if constexpr (Pass::whole) this->template prefetch_faces<S>(e + 2 * layout_width);
        // All faces stage by stage: what one waits for (gathers, divisions, roots) the others fill.
        FaceMotion<D, D, S> faces[C];
        Vec<S, D> middle[C][D];
        for (int a = 0; a < C; ++a) this->read_face(e, a, X, u, faces[a].gap, middle[a]);
        for (int a = 0; a < C; ++a) faces[a].resolve(middle[a], motion.outward(a));
        for (int a = 0; a < C; ++a) add_joint<S>(e, a, faces[a], f);
      }
    }
    store_rows<C * D>(f[0].data(), [&](int l) { return force + static_cast<std::size_t>(e + l) * (C * D); });
  }

  /// f = -V (tau + 2 mu D J) grad N, V the reference volume, gradients with respect to current positions. In
  /// axisymmetry the hoop stress pulls every corner alike to the axis: what makes its virtual work that of the hoop
  /// strain at the centroid.
  template <class S>
  FISSURE_HD void add_bulk(Index e, ElementMotion<D, S> const& motion, Vec<S, D> (&f)[C]) const {
    S const volume = this->volume(motion);
    Mat<S, 3> stress;
    if constexpr (Bulk::remembers)
      stress = flowing<S>(e, motion, volume);
    else
      stress = this->bulk.template kirchhoff<S>(motion.gradient(), motion.j);
    if (this->damping.on()) {
      Mat<S, 3> const L = this->template midway_gradient<S>(this->mesh.v, as<S>(dt), e, motion),
                      rate = as<S>(0.5) * (L + L.transpose());
      Mat<S, 3> const viscous = this->damping.kirchhoff(rate, motion.j);
      stress += viscous;
      S const work = volume * as<S>(dt) * viscous.cwiseProduct(rate).sum();
      for (int l = 0; l < lane_width<S>; ++l) viscous_work[e + l] += static_cast<double>(lane(work, l));
    }
    Mat<S, D> const tau = stress.template topLeftCorner<D, D>();
    f[0] = Vec<S, D>::Constant(S(0));
    S const scale = -volume * motion.inverse1;
    for (int b = 0; b < D; ++b) {
      f[b + 1] = tau.lazyProduct(motion.current.col(b)) * scale;
      f[0] -= f[b + 1];
    }
    if constexpr (Dim<D>::can_revolve)
      if (this->mesh.axisymmetric) {
        S const inward = volume * stress(2, 2) * as<S>(1.0 / C) / motion.radius_now();
        for (int a = 0; a < C; ++a) f[a][0] -= inward;
      }
  }

  /// tau of a law that remembers, after one step with the increment by the middle of the step: G = du (x) grad_middle
  /// N.
  template <class S>
  FISSURE_HD Mat<S, 3> flowing(Index e, ElementMotion<D, S> const& motion, S const& volume) const {
    S const share = as<S>(dt);
    Mat<S, 3> const G = share * this->template midway_gradient<S>(this->mesh.v, share, e, motion);
    Mat<S, 3> tau;
    this->bulk.flow.visit(
        [&](auto const& law) { tau = this->flow().template step<S>(law, e, G, motion.j, volume, dt, fault); });
    if (this->patches.of_corner) this->take_patch_pressure(e, motion.j, tau);
    return tau;
  }

  template <class S>
  FISSURE_HD void add_joint(Index e, int a, FaceMotion<D, D, S> const& motion, Vec<S, D> (&f)[C]) const {
    S area[D];
    this->template joint_areas<S>(e, a, area);
    Vec<S, D> pull[D];
    GapRate<D, Real> const rate{this->mesh, this->joints.link, e, a};
    this->joint.template pull<S>(e, a, motion, area, rate, BookedBy{e, 1}, pull);
    for (int i = 0; i < D; ++i) f[i + (i >= a)] += pull[i];
  }
};

/// Energies of elements at this moment [J]: 0 elastic, 1 held in joints (each side its half).
template <int D, class Real_, class Bulk, class Joint>
struct ElementEnergy : ElementPass<D, Real_, Bulk, Joint> {
  static constexpr char const* name = "element energy";
  using Pass = ElementPass<D, Real_, Bulk, Joint>;
  using Real = Real_;
  using Pass::C, Pass::jointed;

  template <class S>
  FISSURE_HD void operator()(Index e, Sums<2>& sums) const {
    Vec<S, D> X[C], u[C];
    this->template read<S>(e, X, u);
    ElementMotion<D, S> const motion(X, u, this->mesh.axisymmetric);
    S energy = S(0);
    if constexpr (!Pass::whole) {
    } else if constexpr (Bulk::remembers) {
      Mat<S, 3> const tau = this->flow().template tensor<S>(e, 0);
      energy = this->patches.of_corner ? this->bulk.shape_energy(tau) + this->template patch_energy<S>(e, motion.j)
                                       : this->bulk.energy(tau);
    } else {
      energy = this->bulk.template energy<S>(motion.gradient(), motion.j);
    }
    add_lanes(S(this->volume(motion) * energy), sums[0]);
    if constexpr (jointed) {
      double held[lane_width<S>] = {};
      for (int a = 0; a < C && !this->joint.asleep(e); ++a) {
        FaceMotion<D, D, S> side;
        Vec<S, D> middle[D];
        this->read_face(e, a, X, u, side.gap, middle);
        side.resolve(middle, motion.outward(a));
        S area[D];
        this->template joint_areas<S>(e, a, area);
        this->joint.add_stored(e, a, side, area, held);
      }
      for (double of_cell : held) sums[1] += of_cell;
    }
  }
};

/// Cauchy stress of elements [Pa]: xx yy zz xy yz zx, without the viscous part.
template <int D, class Real_, class Bulk, class Joint>
struct ElementStress : ElementPass<D, Real_, Bulk, Joint> {
  static constexpr char const* name = "element stress";
  using Pass = ElementPass<D, Real_, Bulk, Joint>;
  using Real = Real_;
  using Pass::C;

  double* stress = nullptr;  // [element][6]

  template <class S>
  FISSURE_HD void operator()(Index e) const {
    Vec<S, D> X[C], u[C];
    this->template read<S>(e, X, u);
    ElementMotion<D, S> const motion(X, u, this->mesh.axisymmetric);
    Mat<S, 3> sigma;
    S volume;
    if constexpr (Bulk::remembers) {
      sigma = this->template remembered_stress<S>(e, motion.j);
      volume = (S(1) + motion.j) * (S(1) + this->flow().template number<S>(e, this->bulk.memory.thickness));
    } else {
      Mat<S, 3> const H = motion.gradient();
      sigma = this->bulk.template kirchhoff<S>(H, motion.j);
      volume = this->bulk.template volume_ratio<S>(H, motion.j);
    }
    sigma *= S(1) / volume;
    for (int l = 0; l < lane_width<S>; ++l)
      for (int k = 0; k < 6; ++k)
        stress[static_cast<std::size_t>(e + l) * 6 + k] =
            static_cast<double>(lane(sigma(tensor_row(k), tensor_column(k)), l));
  }
};

/// What elements' tangents depend on and how fast that can change: the largest of each (raise_deformation).
template <int D, class Real_>
struct ElementDeformation : ElementPass<D, Real_, laws::Plastic, void> {
  static constexpr char const* name = "element deformation";
  using Pass = ElementPass<D, Real_, laws::Plastic, void>;
  using Real = Real_;
  using Pass::C;

  template <class S>
  FISSURE_HD void operator()(Index e, Sums<4>& sums) const {
    Vec<S, D> X[C], u[C];
    this->template read_shared<S>(e, X, u);
    ElementMotion<D, S> const motion(X, u, this->mesh.axisymmetric);
    S squares = S(0);
    Vec<S, D> first = Vec<S, D>::Constant(S(0));
    for (int b = 0; b < D; ++b) {
      Vec<S, D> const g = motion.current.col(b) * motion.inverse1;
      squares += g.squaredNorm();
      first += g;
    }
    squares += first.squaredNorm();
    if constexpr (Dim<D>::can_revolve)
      if (this->mesh.axisymmetric) {
        // Corners on the axis stay there: their share, large beside it, would hide what changes elsewhere.
        S moving = S(0);
        for (int a = 0; a < C; ++a) moving += select(X[a][0] > S(0), S(1), S(0));
        S const hoop = as<S>(C) * motion.radius_now();
        squares += moving / (hoop * hoop);
      }
    S fastest = S(0);
    for (int a = 0; a < C; ++a) {
      Vec<S, D> v;
      load_rows<D>(v.data(),
                   [&](int l) { return this->mesh.v + static_cast<std::size_t>(this->mesh.vertex(e + l, a)) * D; });
      fastest = larger(fastest, v.squaredNorm());
    }
    raise_deformation<D, S>(squares, motion.H, motion.hoop, fastest, sums);
  }
};

/// How far elements have swollen: V (J - 1) [m^3], for patches.
template <int D, class Real_>
struct ElementSwelling : ElementPass<D, Real_, laws::Plastic, void> {
  static constexpr char const* name = "element swelling";
  using Pass = ElementPass<D, Real_, laws::Plastic, void>;
  using Real = Real_;
  using Pass::C;

  Real *swelling = nullptr, *whole = nullptr;  // per element

  template <class S>
  FISSURE_HD void operator()(Index e) const {
    Vec<S, D> X[C], u[C];
    this->template read_shared<S>(e, X, u);
    ElementMotion<D, S> const motion(X, u, this->mesh.axisymmetric);
    S const V = this->volume(motion);
    store(V, whole + e);
    store(S(V * motion.j), swelling + e);
  }
};

/// Pressure of patches: each corner brings the same share of its element (average nodal pressure; Bonet & Burton 1998,
/// with K ln(J)/J for the pressure), less what the spring between elements and patches takes. Both come from energies,
/// which are booked.
template <class Real_>
struct PatchPressure {
  static constexpr char const* name = "patch pressure";
  static constexpr bool packed = false;
  using Real = Real_;

  Index const *first = nullptr, *list = nullptr;  // elements of patch p: list[first[p]] .. list[first[p + 1] - 1]
  Real const *swelling = nullptr, *volume = nullptr;
  Real *pressure = nullptr, *energy = nullptr;
  double bulk = 0, spring = 0;  // K and k [Pa]

  template <class S>
  FISSURE_HD void operator()(Index p) const {
    Real swollen = 0, whole = 0;
    for (Index i = first[p]; i < first[p + 1]; ++i) swollen += swelling[list[i]], whole += volume[list[i]];
    Real const j = whole > 0 ? swollen / whole : Real(0), log_J = std::log1p(j);
    pressure[p] = (static_cast<Real>(bulk) * log_J - static_cast<Real>(spring) * j) / (1 + j);
    energy[p] = static_cast<Real>(0.5 * bulk) * log_J * log_J - static_cast<Real>(spring) * (j - log_J);
  }
};

}  // namespace fissure::kernels
