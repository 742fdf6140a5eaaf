// Friction along random closed paths: of pairs of elements, of elements on walls, of softening joints and of crack
// faces. What sliders book never decreases, and the work put in is what they took and what springs still hold, to the
// order of the step.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "contact_rig.h"
#include "kernels/crack_faces.h"
#include "kernels/joints.h"

namespace fissure {
namespace {

using namespace contact_test;

template <class T>
class Friction : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(Friction, Dimensions);

double const two_pi = 2 * std::acos(-1.0);

/// Smooth random motion around a loop: t runs from 0 to 1, the amplitude falls as that of the harmonic.
struct Loop {
  double a[3], phase[3];
  Loop(std::mt19937& rng, double size) {
    std::uniform_real_distribution<double> real(0, 1);
    for (int k = 0; k < 3; ++k) a[k] = size * (2 * real(rng) - 1) / (k + 1), phase[k] = two_pi * real(rng);
  }
  double operator()(double t) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += a[k] * std::sin(two_pi * (k + 1) * t + phase[k]);
    return sum;
  }
};

/// What a path did. `moved`: the sum of the magnitudes of its works.
struct Account {
  double work = 0, moved = 0, booked = 0, least = 0, held = 0;
  void step(double by, double friction) {
    work += by, moved += std::abs(by), booked += friction;
    least = std::min(least, friction);
  }
  /// Of the work; of the smallest that counts where there is hardly any: few steps see it.
  double residual(double smallest) const { return (work - booked - held) / std::max(moved, smallest); }
};

/// Both elements turn and shift around loops of their own and meet several times; they start and end where they do not
/// touch.
template <int D, class Real = double>
Account walk_of_a_pair(int seed, double mu, int steps) {
  std::mt19937 rng(seed);
  std::vector<Corners<D>> const at{random_simplex<D>(rng, 1), random_simplex<D>(rng, 1)};
  Vec<double, D> centre[2];
  std::vector<Loop> shift[2], turn[2];
  for (int e : {0, 1}) {
    centre[e].setZero();
    for (auto const& x : at[e]) centre[e] += x / (D + 1);
    for (int c = 0; c < D; ++c) shift[e].emplace_back(rng, 0.15);
    for (std::size_t c = 0; c < spins<D>().size(); ++c) turn[e].emplace_back(rng, 0.4);
  }
  auto const place = [&](int e, int a, double t) {
    double const inside = std::sin(two_pi / 2 * t) * std::sin(two_pi / 2 * t);
    Vec<double, D> x = at[e][a] - centre[e];
    for (std::size_t k = 0; k < turn[e].size(); ++k) x = rotation<D>(spins<D>()[k], turn[e][k](t)) * x;
    for (int c = 0; c < D; ++c) x[c] += inside * shift[e][c](t) + (e == 1 && c == 0 ? 2 - 1.7 * inside : 0);
    return x;
  };
  Rig<D, Real> rig(at, {10.0, mu});
  double const dt = 1.0 / steps;
  Account sum;
  std::vector<Vec<double, D>> before(2 * (D + 1), Vec<double, D>::Zero()), old(2 * (D + 1));
  for (int i = 0; i <= steps; ++i) {
    double by = 0;
    std::vector<Vec<double, D>> by_step(2 * (D + 1));
    for (int e : {0, 1})
      for (int a = 0; a <= D; ++a) {
        Index const slot = e * (D + 1) + a;
        auto const x = place(e, a, i * dt);
        by_step[slot] = i > 0 ? Vec<double, D>(x - old[slot]) : Vec<double, D>::Zero();
        for (int c = 0; c < D; ++c)
          rig.u[slot * D + c] = Real(x[c] - at[e][a][c]), rig.v[slot * D + c] = Real(by_step[slot][c] / dt);
        old[slot] = x;
      }
    rig.touch(dt);
    for (Index slot = 0; slot < 2 * (D + 1); ++slot)
      by -= (rig.at(slot) + before[slot]).dot(by_step[slot]) / 2, before[slot] = rig.at(slot);
    sum.step(by, rig.work[0]);
  }
  for (int c = 0; c < D; ++c) sum.held += double(rig.spring[D] * rig.spring[c] * rig.spring[c]) / 2;
  return sum;
}

double coefficient(int seed) { return seed % 4 == 0 ? 10.0 * (seed % 13) / 12 : 3.0 * (seed % 17) / 16; }

/// All of them are a nightly test; every coefficient is among the first 250, too.
int paths() { return std::getenv("FISSURE_TEST_LONG") ? 1000 : 250; }

/// Takes `walks` paths with n steps, and the worst of them again with four times as many. Points of action move in a
/// step, so that forces before and after it act at different ones: an error of the first order, a quarter of it is
/// left.
template <class Walk>
void expect_no_work(Walk const& walk, int walks, int n, double limit, double smallest = 1e-3) {
  double worst = 0;
  int touched = 0, at = 0;
  for (int seed = 0; seed < walks; ++seed) {
    Account const sum = walk(seed, coefficient(seed), n);
    EXPECT_GE(sum.least, 0) << seed;
    if (!(sum.moved > 0)) continue;
    ++touched;
    double const residual = sum.residual(smallest);
    EXPECT_NEAR(residual, 0, limit) << seed << ": " << sum.work << " J put in, " << sum.booked << " J booked";
    if (std::abs(residual) > worst) worst = std::abs(residual), at = seed;
  }
  double const finer = std::abs(walk(at, coefficient(at), 4 * n).residual(smallest));
  std::printf("%d of %d paths touch; worst residual %.2e of the work (path %d), with a quarter of the step %.2e\n",
              touched, walks, worst, at, finer);
  EXPECT_LT(finer, 0.5 * worst);
  EXPECT_GT(touched, walks / 2);
}

TYPED_TEST(Friction, OfPairsTakesWhatRandomClosedPathsPutIn) {
  expect_no_work([](int seed, double mu, int n) { return walk_of_a_pair<TypeParam::value>(seed, mu, n); }, paths(),
                 6000, 1e-3);
}

TYPED_TEST(Friction, OfPairsInSinglePrecision) {
  for (int seed = 0; seed < 100; ++seed) {
    Account const sum = walk_of_a_pair<TypeParam::value, float>(seed, coefficient(seed), 2000);
    EXPECT_GE(sum.least, 0) << seed;
    EXPECT_NEAR(sum.residual(1e-3), 0, 3e-3) << seed;
  }
}

/// An element on a wall, which it leaves and meets again.
template <int D>
Account walk_on_a_wall(int seed, double mu, int steps) {
  std::mt19937 rng(seed);
  Corners<D> const at = random_simplex<D>(rng, 1);
  Vec<double, D> centre = Vec<double, D>::Zero(), up = random_simplex<D>(rng, 1)[0].normalized();
  for (auto const& x : at) centre += x / (D + 1);
  std::vector<Loop> shift, turn;
  for (int c = 0; c < D; ++c) shift.emplace_back(rng, 0.2);
  for (std::size_t c = 0; c < spins<D>().size(); ++c) turn.emplace_back(rng, 0.4);
  kernels::HalfSpace<D, double> const wall{centre, up};
  Rig<D> rig({at}, {10.0, mu});
  double const dt = 1.0 / steps;
  Account sum;
  Vec<double, D> before[D + 1], old[D + 1];
  for (int i = 0; i <= steps; ++i) {
    double const t = i * dt, height = 1.5 - 1.4 * std::pow(std::sin(two_pi / 2 * t), 2);
    Vec<double, D> moved[D + 1];
    for (int a = 0; a <= D; ++a) {
      Vec<double, D> x = at[a] - centre;
      for (std::size_t k = 0; k < turn.size(); ++k) x = rotation<D>(spins<D>()[k], turn[k](t)) * x;
      x += centre + up * height;
      for (int c = 0; c < D; ++c) x[c] += (1.5 - height) * shift[c](t);
      moved[a] = i > 0 ? Vec<double, D>(x - old[a]) : Vec<double, D>::Zero();
      if (i == 0) before[a].setZero();
      for (int c = 0; c < D; ++c) rig.u[a * D + c] = x[c] - at[a][c], rig.v[a * D + c] = moved[a][c] / dt;
      old[a] = x;
    }
    rig.press(wall, dt);
    double by = 0;
    for (Index a = 0; a <= D; ++a) by -= (rig.at(a) + before[a]).dot(moved[a]) / 2, before[a] = rig.at(a);
    sum.step(by, rig.work[0]);
  }
  for (int c = 0; c < D; ++c) sum.held += rig.spring[D] * rig.spring[c] * rig.spring[c] / 2;
  return sum;
}

TYPED_TEST(Friction, OnWallsTakesWhatRandomClosedPathsPutIn) {
  expect_no_work([](int seed, double mu, int n) { return walk_on_a_wall<TypeParam::value>(seed, mu, n); }, paths(),
                 8000, 1e-3);
}

/// One side of a joint between two cells, and what it remembers.
template <int D>
struct JointSide {
  static constexpr int F = D + 1, W = kernels::layout_width, slots = W * F;
  std::vector<double> stiffness = std::vector<double>(slots, 4e14),
                      history = std::vector<double>(slots * D * laws::joint_numbers),
                      work = std::vector<double>(slots * 2), stretch = std::vector<double>(slots * D * D),
                      dissipated = std::vector<double>(W), viscous = std::vector<double>(W);
  std::vector<std::uint8_t> softening = std::vector<std::uint8_t>(F);
  std::vector<Index> events = std::vector<Index>(slots);
  int count = 0;

  kernels::Joints<D, F, D, double, laws::CohesiveJoint> joint(laws::CohesiveJoint const& law, double dt) {
    return {{stiffness.data(),
             history.data(),
             work.data(),
             softening.data(),
             dissipated.data(),
             {&count, events.data(), 0},
             stretch.data()},
            law,
            nullptr,
            dt,
            viscous.data()};
  }
  double taken() const { return dissipated[0] + viscous[0]; }
};

/// Cohesion and friction of a joint whose sides open and slip around loops, pressing, sliding, loosening and breaking,
/// while both turn about together: forces of both sides, all that they do and all that they book.
template <int D>
Account walk_of_a_joint(int seed, double mu, int steps) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> real(0, 1);
  laws::CohesiveJoint law;
  law.tension = 3e6, law.shear = 10e6, law.G1 = 20, law.G2 = 50, law.penalty = 1e12, law.residual = mu;
  law.prepare();
  JointSide<D> sides[2];
  double const closing = 40e6 / 4e14 * (0.2 + real(rng)), sliding = 3e-5 * (0.1 + real(rng)), size = 1e-4;
  Loop const opening(rng, 1.5 * closing), along(rng, sliding), across(rng, sliding);
  double const spin = seed % 2 == 0 ? 0 : 0.5;
  std::vector<Loop> turn;
  for (std::size_t k = 0; k < spins<D>().size(); ++k) turn.emplace_back(rng, spin);
  double area[D];
  Vec<double, D> corner[D], old[2][D], before[2][D];
  for (int i = 0; i < D; ++i) {
    area[i] = 1, corner[i].setZero();
    if (i > 0) corner[i][i == 1 ? 0 : D - 1] = size;
    for (int side : {0, 1}) old[side][i].setZero(), before[side][i].setZero();
  }
  Account sum;
  double total = 0;
  for (int s = 0; s <= steps; ++s) {
    double const t = double(s) / steps;
    Mat<double, D> turned = Mat<double, D>::Identity();
    for (std::size_t k = 0; k < turn.size(); ++k) turned = rotation<D>(spins<D>()[k], turn[k](t)) * turned;
    Vec<double, D> at[2][D], moved[2][D], middle[D];
    for (int i = 0; i < D; ++i) {
      double const rise = std::min(1.0, 20 * t) * (1 + 0.1 * i);
      Vec<double, D> gap = Vec<double, D>::Zero();
      gap[0] = rise * along(t), gap[1] = rise * (opening(t) - 0.5 * closing);
      if (D == 3) gap[D - 1] = rise * across(t);
      for (int side : {0, 1}) {
        at[side][i] = turned * (corner[i] + (side - 0.5) * gap);
        moved[side][i] = s > 0 ? Vec<double, D>(at[side][i] - old[side][i]) : Vec<double, D>::Zero();
        old[side][i] = at[side][i];
      }
      middle[i] = at[0][i] + at[1][i];
    }
    double by = 0, taken = 0, held[1] = {};
    for (int side : {0, 1}) {
      kernels::FaceMotion<D, D, double> motion;
      for (int i = 0; i < D; ++i) motion.gap[i] = at[1 - side][i] - at[side][i];
      motion.resolve(middle, (side == 0 ? 1 : -1) * (Dim<D>::face_normal(middle).dot(turned.col(1)) > 0 ? 1.0 : -1.0));
      Vec<double, D> f[D];
      auto const joint = sides[side].joint(law, 1.0 / steps);
      joint.template pull<double>(
          0, 0, motion, area,
          [&](int i, int) { return Vec<double, D>((moved[1 - side][i] - moved[side][i]) * double(steps)); },
          kernels::BookedBy{0, 0}, f);
      for (int i = 0; i < D; ++i) by -= (f[i] + before[side][i]).dot(moved[side][i]) / 2, before[side][i] = f[i];
      taken += sides[side].taken();
      joint.template add_stored<double>(0, 0, motion, area, held);
    }
    sum.step(by, taken - total);
    total = taken, sum.held = held[0];
  }
  return sum;
}

TYPED_TEST(Friction, OfSofteningJointsTakesWhatRandomPathsPutIn) {
  expect_no_work([](int seed, double mu, int n) { return walk_of_a_joint<TypeParam::value>(seed, mu, n); }, paths(),
                 32000, 1e-3);
}

/// Two elements on both sides of a crack in the plane y = 0.
template <int D>
struct CrackRig {
  Corners<D> below, above;
  std::vector<std::int8_t> parity = std::vector<std::int8_t>(16, 1);
  kernels::CrackFace<D, double> crack;

  CrackRig() {
    for (auto& x : below) x.setZero();
    for (int a = 1; a <= D; ++a) below[a][a - 1] = 1;
    below[D].setConstant(0.3), below[D][1] = -0.8;
    if (D == 3) below[2].setZero(), below[2][2] = 1;
    above = below;
    for (auto& x : above) x[1] *= -1;
    Mat<double, D> edges;
    for (int e : {0, 1}) {
      for (int a = 1; a <= D; ++a) edges.col(a - 1) = (e ? above : below)[a] - (e ? above : below)[0];
      parity[e] = edges.determinant() > 0 ? 1 : -1;
    }
    crack.element = 0, crack.face = D, crack.other = 1, crack.other_face = D, crack.stiffness = 1e3, crack.size = 1;
    for (auto& w : crack.weight) w = 0.5;
  }
};

/// Turned about together by up to a whole turn, which is a closed path, as their faces rub.
template <int D>
Account walk_of_a_crack(int seed, double mu, int steps) {
  std::mt19937 rng(seed);
  CrackRig<D> faces;
  auto const &below = faces.below, &above = faces.above;
  auto const& parity = faces.parity;
  auto& crack = faces.crack;
  crack.friction = mu;
  Rig<D> rig({below, above}, {10.0, mu});
  kernels::MeshView<D, double> mesh = rig.mesh();
  mesh.parity = parity.data();
  std::vector<double> force(2 * D * D), stiff(2 * D);
  double work = 0, dt = 1.0 / steps;
  int news = 0;
  kernels::CrackForces<D, double> const kernel{
      mesh, {rig.law.data(), &rig.contact, 1}, dt, false, &crack, force.data(), stiff.data(), &work, &news};
  Loop const lift(rng, 0.005), slide(rng, 0.06), across(rng, 0.06);
  std::vector<Loop> tilt;
  for (std::size_t k = 0; k < spins<D>().size(); ++k) tilt.emplace_back(rng, 0.003);
  double const spin = two_pi * (seed % 3 - 1);
  auto const& W = spins<D>();
  auto const place = [&](int e, int a, double t) {
    Vec<double, D> x = (e ? above : below)[a];
    if (e) {
      for (std::size_t k = 0; k < W.size(); ++k) x = rotation<D>(W[k], tilt[k](t)) * x;
      x[0] += slide(t), x[1] += lift(t);
      if (D == 3) x[D - 1] += across(t);
    }
    return Vec<double, D>(rotation<D>(W[seed % W.size()], spin * t) * x);
  };
  Account sum;
  std::vector<Vec<double, D>> before(2 * D, Vec<double, D>::Zero()), old(2 * (D + 1));
  double first = 0;
  for (int i = 0; i <= steps; ++i) {
    std::vector<Vec<double, D>> moved(2 * (D + 1));
    for (int e : {0, 1})
      for (int a = 0; a <= D; ++a) {
        Index const slot = e * (D + 1) + a;
        auto const x = place(e, a, i * dt);
        moved[slot] = i > 0 ? Vec<double, D>(x - old[slot]) : Vec<double, D>::Zero();
        for (int c = 0; c < D; ++c)
          rig.u[slot * D + c] = x[c] - (e ? above : below)[a][c], rig.v[slot * D + c] = moved[slot][c] / dt;
        old[slot] = x;
      }
    kernel.template operator()<double>(0);
    double by = 0;
    for (int e : {0, 1})
      for (int k = 0; k < D; ++k) {
        Index const slot = e * D + k;
        Vec<double, D> f;
        for (int c = 0; c < D; ++c) f[c] = force[slot * D + c];
        by -= (f + before[slot]).dot(moved[e * (D + 1) + k]) / 2;
        before[slot] = f;
      }
    // What the springs of normals and of slips hold, from the faces as they stand.
    double held = 0;
    for (int k = 0; k < D; ++k) {
      Vec<double, D> middle[D], stretch;
      for (int j = 0; j < D; ++j) middle[j] = (old[j] + old[D + 1 + j]) / 2;
      double const depth = (old[D + 1 + k] - old[k]).dot(Dim<D>::face_normal(middle).normalized());
      // The side that closes is the one on which the crack presses.
      for (int c = 0; c < D; ++c) stretch[c] = crack.stretch[k][c];
      double const outward = Dim<D>::face_normal(middle).dot(old[D + 1 + D] - old[D]) > 0 ? 1 : -1;
      double const closed = std::min(0.0, outward * depth);
      held += 0.5 * 1e3 * (closed * closed + stretch.squaredNorm()) / 2;
    }
    if (i == 0) first = held;
    sum.held = held - first;
    sum.step(by, work);
  }
  return sum;
}

/// Faces that have slid apart go on as a pair that presses no more and holds no more than they did, however stiff it
/// is, and what it lacks is booked; those that press more than it would find its potential whole.
TYPED_TEST(Friction, OfCrackFacesIsHandedOverWithoutAJump) {
  constexpr int D = TypeParam::value;
  for (double penalty : {1.0, 1e3, 1e6, 1e9}) {
    CrackRig<D> faces;
    auto const& crack = faces.crack;
    double const depth = 1e-3, mu = 0.5;
    Rig<D> rig({faces.below, faces.above}, {penalty, mu});
    Vec<double, D> moved = Vec<double, D>::Zero();
    moved[0] = 0.31, moved[1] = -depth;
    rig.move(1, moved);
    kernels::MeshView<D, double> mesh = rig.mesh();
    mesh.parity = faces.parity.data();
    std::vector<double> force(2 * D * D), stiff(2 * D);
    double work = 0;
    int news = 0;
    kernels::CrackForces<D, double>{
        mesh, {rig.law.data(), &rig.contact, 1}, 1e-3, true, &faces.crack, force.data(), stiff.data(), &work, &news}
        .template operator()<double>(0);
    ASSERT_EQ(crack.apart, 1);
    double const pressed = crack.stiffness * 0.5 * D * depth, stored = pressed * depth / 2;
    std::copy(std::begin(crack.spring), std::end(crack.spring), rig.spring.begin());
    std::fill_n(rig.spring.begin(), D + 1, 0.0);  // its friction aside
    rig.contact.friction = 0;
    rig.touch();
    double const begins = crack.spring[D + 1], now = rig.total(1)[1];
    EXPECT_LE(now, pressed * (1 + 1e-12));
    EXPECT_LE(rig.held, stored * (1 + 1e-12));
    EXPECT_NEAR(crack.lost, stored - rig.held, 1e-6 * stored);  // of an energy whose terms are 1e6 times as large
    if (penalty < 10) {
      EXPECT_EQ(begins, 0);
      continue;
    }
    // It is no later than it must be: one of both is what the faces had.
    EXPECT_GT(begins, 0);
    EXPECT_GT(std::max(now / pressed, rig.held / stored), 0.99) << penalty;
    // On its way in it resists as if it had begun like that by itself: with all of its penalty.
    rig.move(1, -10 * depth * Vec<double, D>::Unit(1));
    rig.touch();
    Rig<D> whole({faces.below, faces.above}, {penalty, 0});
    whole.move(1, moved - 10 * depth * Vec<double, D>::Unit(1));
    whole.spring.back() = begins;
    whole.touch();
    EXPECT_EQ(rig.total(1)[1], whole.total(1)[1]);
    EXPECT_GT(rig.total(1)[1], 5 * std::max(now, 0.01 * pressed));
  }
}

TYPED_TEST(Friction, OfCrackFacesTakesWhatRandomPathsPutIn) {
  expect_no_work([](int seed, double mu, int n) { return walk_of_a_crack<TypeParam::value>(seed, mu, n); }, paths(),
                 4000, 1e-3);
}

}  // namespace
}  // namespace fissure
