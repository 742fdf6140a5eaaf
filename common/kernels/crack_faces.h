// The two faces of a broken joint: they press with the joint's own stiffness and rub with Coulomb friction, so that a
// joint that breaks under pressure hands over the force it carried, and none of it twice.
//   opening o < 0: sigma = k o;  tau = k stretch within mu |sigma| (friction.h).
// The opening counts from where a joint that was inserted under pressure began.
// Faces that have moved far go on as a pair of general contact, whose potential begins where it has no more force and
// no more energy than the faces had; on every way further in it resists with all of its penalty.
#pragma once
#include "backend/for_each.h"
#include "kernels/contact.h"
#include "kernels/fold.h"

namespace fissure::kernels {

/// One broken joint: corner i of its face is corner i + (i >= face) of the element and i + (i >= other_face) of the
/// other.
template <int D, class Real>
struct CrackFace {
  Index element = 0, face = 0, other = 0, other_face = 0;
  Real stiffness = 0;       // [Pa/m]
  Real weight[D] = {};      // area at each corner [m^2]
  Real friction = 0;        // [-]
  Real size = 0;            // h of the joint [m]
  Real offset[D] = {};      // of the opening of each corner: of a joint that was inserted under pressure [m]
  Real stretch[D][D] = {};  // of the friction spring of each corner [m]
  // 1: the faces have moved so far that general contact must take over; 2: even where they hang together, for they have
  // folded open. A number, so that no byte is left undefined.
  Real apart = 0;
  Real spring[spring_size<D>] = {};  // what its pair starts with then
  Real lost = 0;                     // energy that the faces held and the pair does not [J]
};

template <int D, class Real_>
struct CrackForces {
  static constexpr char const* name = "crack faces";
  static constexpr bool packed = false, costly = true;
  using Real = Real_;
  /// Faces that have opened or slid by this share of the joint's size no longer face each other.
  static constexpr double reach = 0.3;

  MeshView<D, Real> mesh;
  ContactTable table;
  Real dt = 0;        // since the springs were last stretched [s]
  bool pairs = true;  // general contact takes over; false: nothing does
  CrackFace<D, Real>* faces = nullptr;
  Real* force = nullptr;      // [face][2][D][D]: on the element's corners, then on the other's [N]
  Real* stiffness = nullptr;  // [face][2][D]: bound of the corner's row of the stiffness matrix [N/m]
  Real* work = nullptr;       // [face] what friction took in this step [J]
  int* news = nullptr;        // set to 1 when faces have come apart

  template <class S>
  FISSURE_HD void operator()(Index f) const {
    CrackFace<D, Real>& crack = faces[f];
    Vec<Real, D> gap[D], middle[D], rate[D];
    for (int i = 0; i < D; ++i) {
      int const a = i + (i >= crack.face), b = i + (i >= crack.other_face);
      rate[i] = mesh.velocity(mesh.vertex(crack.other, b)) - mesh.velocity(mesh.vertex(crack.element, a));
      Vec<Real, D> const mine = mesh.displacement(mesh.vertex(crack.element, a));
      Vec<Real, D> const theirs = mesh.displacement(mesh.vertex(crack.other, b));
      gap[i] = theirs - mine;
      middle[i] = mesh.reference(crack.element, a) + Real(0.5) * (mine + theirs);
    }
    Vec<Real, D> normal = Dim<D>::face_normal(middle);
    normal *= Real((crack.face % 2 == 0) == (mesh.parity[crack.element] > 0) ? 1 : -1) / normal.norm();

    // Where the faces have slid, the two forces of a corner are a couple. What derives from the energy of the openings
    // turns the faces back by as much: an opening changes with the normal, so with the middle surface.
    Eigen::Matrix<Real, D, D - 1> along;
    for (int j = 1; j < D; ++j) along.col(j - 1) = middle[j] - middle[0];
    Eigen::Matrix<Real, D, D - 1> const slopes = along * (along.transpose() * along).inverse();
    Vec<Real, D> gradient[D];  // of the corners' shape functions on the middle surface [1/m]
    gradient[0].setZero();
    for (int j = 1; j < D; ++j) {
      gradient[j] = slopes.col(j - 1);
      gradient[0] -= gradient[j];
    }
    Real lever[D] = {};

    Real least_opening = crack.size, most_slip = 0, taken = 0, pressing = 0;
    for (int i = 0; i < D; ++i) {
      Real const apart = gap[i].dot(normal), opening = apart + crack.offset[i];
      Vec<Real, D> const slip = gap[i] - apart * normal;
      Real const k = crack.weight[i] * crack.stiffness, force_along = k * positive(-opening);
      Real spring[D + 1], lost = 0;
      for (int c = 0; c < D; ++c) spring[c] = crack.stretch[i][c];
      spring[D] = k;
      auto const drag =
          friction<D, Real>(normal, force_along, rate[i], dt, k, crack.friction * force_along, spring, lost);
      Vec<Real, D> const pull = -drag - force_along * normal;
      for (int j = 0; j < D; ++j) lever[j] -= force_along * gap[i].dot(gradient[j]) / 2;
      taken += lost;
      if (opening < 0) pressing += k;
      least_opening = smaller(least_opening, opening);
      most_slip = larger(most_slip, slip.norm());
      Real const stiff = opening < 0 ? 2 * k : Real(0);
      std::size_t const mine = (static_cast<std::size_t>(f) * 2 + 0) * D + i,
                        theirs = (static_cast<std::size_t>(f) * 2 + 1) * D + i;
      for (int c = 0; c < D; ++c) {
        crack.stretch[i][c] = spring[c];
        force[mine * D + c] = pull[c];
        force[theirs * D + c] = -pull[c];
      }
      stiffness[mine] = stiffness[theirs] = stiff;
    }
    for (int j = 0; j < D; ++j)
      for (int side = 0; side < 2; ++side)
        for (int c = 0; c < D; ++c)
          force[((static_cast<std::size_t>(f) * 2 + side) * D + j) * D + c] += lever[j] * normal[c];
    work[f] = taken;
    Eigen::Matrix<Real, D, D - 1> turn;
    for (int j = 1; j < D; ++j) turn.col(j - 1) = (gap[j] - gap[0]) / 2;
    bool const turned = folded<D, Real>(along, turn);
    if (turned || least_opening > Real(reach) * crack.size || most_slip > Real(reach) * crack.size) {
      crack.apart = turned ? 2 : 1;
      hand_over(crack, gap, normal, pressing, pairs && !turned);
      raise(news);
    }
  }

 private:
  /// What the pair of the two elements starts with: as one spring, of the stiffness `pressing` of the corners that
  /// press [N/m], what their springs carry, and a potential that begins where neither the force along the normal nor
  /// the energy grows. `takes`: else it starts with nothing, wherever it is (contact.h).
  FISSURE_HD void hand_over(CrackFace<D, Real>& crack, Vec<Real, D> const (&gap)[D], Vec<Real, D> const& normal,
                            Real pressing, bool takes) const {
    Real force = 0, pressed = 0, sheared = 0;
    Vec<Real, D> mean = Vec<Real, D>::Zero();
    for (int i = 0; i < D; ++i) {
      Real const k = crack.weight[i] * crack.stiffness, depth = positive(-gap[i].dot(normal) - crack.offset[i]);
      force += k * depth;
      pressed += k * (depth * depth - crack.offset[i] * crack.offset[i]) / 2;
      for (int c = 0; c < D; ++c) {
        mean[c] += k * crack.stretch[i][c];
        sheared += k * crack.stretch[i][c] * crack.stretch[i][c] / 2;
      }
    }
    pressed = positive(pressed);  // beyond what it began with, which no work was done for
    if (pressing > 0) mean /= pressing;

    laws::ContactLaw const& law = table.of(table.law[crack.element], table.law[crack.other]);
    bool const rubs = takes && law.rubs();
    Start const start =
        takes ? begin(crack, normal, pair_penalty(mesh, law, crack.element, crack.other), force, pressed) : Start{};
    for (int c = 0; c < D; ++c) crack.spring[c] = rubs ? mean[c] : Real(0);
    crack.spring[D] = rubs ? pressing : Real(0);
    crack.spring[D + 1] = start.begins;
    crack.lost = pressed - start.held + sheared - crack.spring[D] * mean.squaredNorm() / 2;
  }

  /// Where the potential of a pair begins (overlap.h), and the energy that it holds then [J].
  struct Start {
    Real begins = -1, held = 0;
  };

  /// The potential of penalty `p` (pair_penalty) that begins first with at most this force along the normal [N] and
  /// this energy [J], as the two elements stand: by bisection, for both fall as it begins later.
  FISSURE_HD Start begin(CrackFace<D, Real> const& crack, Vec<Real, D> const& normal, Real p, Real force,
                         Real energy) const {
    Simplex<D, Real> a, b;
    Vec<Real, D> const X0 = mesh.reference(crack.element, 0), u0 = mesh.displacement(mesh.vertex(crack.element, 0));
    a.place(mesh, crack.element, X0, u0);
    b.place(mesh, crack.other, X0, u0);
    Mat<Real, D + 1> a_in_b, b_in_a;
    Real axis = 0;
    Real const gap = separation<D, Real>(a, b, a_in_b, b_in_a, false, axis);
    auto const fits = [&](Real begins, Start& start) {
      Overlap<D, Real> const between(a, b, a_in_b, b_in_a, p, begins, gap, true);
      if (between.on_b.total().dot(normal) > force || between.held > energy) return false;
      start = {begins, between.held};
      return true;
    };
    Start start;
    if (fits(0, start)) return start;
    Real early = 0, late = Overlap<D, Real>(a, b, a_in_b, b_in_a, p, Real(0), gap, false).deepest;
    start = {late, 0};
    for (Real middle = late / 2; middle > early && middle < late; middle = (early + late) / 2)
      (fits(middle, start) ? late : early) = middle;  // to the last digit
    return start;
  }
};

}  // namespace fissure::kernels
