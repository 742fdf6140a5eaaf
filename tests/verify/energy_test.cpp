// Ladder B: energy and step.
#include "rig.h"

namespace fissure::verify {
namespace {

/// A free body that rings in a smooth mode: strains of `strain`.
template <class Law>
void set_ringing(Rig<>& rig, double strain) {
  rig.add_material(material<Law>(steel));
  double const L = 0.01;
  rig.add_box({0, 0, 0}, {L, L, L}, L / 2);
  double const speed = strain * steel.bar();
  rig.scene.bodies[0].velocity_at = [=](double x, double y, double z) -> std::array<double, 3> {
    return {speed * std::sin(3 * x / L) + 0.3 * speed * y / L, -0.5 * speed * y / L + 0.2 * speed * std::sin(2 * z / L),
            0.4 * speed * x / L};
  };
  rig.start();
}

struct Energy {
  double most, drift;  // largest error; difference of the means over the first and the second half
};

/// 1e5 steps at 0.8 of the limit. The means have Hann's weight, in which an oscillation of many periods leaves
/// nothing: plain means of a tenth each would show its phase, 1e-6 to 4e-6, as a drift.
template <class Law>
Energy ring(double strain) {
  Rig<> rig;
  set_ringing<Law>(rig, strain);
  int const steps = 100000, every = 5, half = steps / 2;
  double start = 0, most = 0, mean[2] = {}, weight[2] = {};
  double const dt = rig.solver->dt();
  for (int k = 0; k < steps; ++k) {
    rig.solver->evaluate();
    if (k % every == 0) {
      double const e = rig.solver->now().energy("kinetic") + rig.solver->now().energy("elastic");
      if (k == 0) start = e;
      most = std::max(most, std::abs(e / start - 1));
      double const w = 1 - std::cos(2 * std::numbers::pi * (k % half + 0.5 * every) / half);
      mean[k / half] += w * (e / start - 1), weight[k / half] += w;
    }
    rig.solver->advance();
  }
  EXPECT_EQ(rig.solver->dt(), dt);  // leapfrog keeps energy at a constant step only
  double const drift = std::abs(mean[1] / weight[1] - mean[0] / weight[0]);
  std::printf("%s at a strain of %g: largest error %.2e, drift %.1e\n", Law::name, strain, most, drift);
  return {most, drift};
}

/// Of a linear body leapfrog keeps the booked energy to round-off. What is left is of third order in strain, so over
/// the energy it is in proportion to strain: the step's part, and that of a law whose energy is exact to second order
/// only. Such an error comes and goes. The ladder names no strain; its 1e-4 holds below 7e-5 in 2D, 1.2e-4 in 3D.
TEST(Verify, B1_MunjizaBodyKeepsItsEnergy) {
  auto const small = ring<laws::Munjiza>(5e-5), large = ring<laws::Munjiza>(5e-4);
  EXPECT_LT(small.most, 1e-4);
  EXPECT_LT(small.drift, 1e-6);
  EXPECT_LT(large.drift, 1e-6);
  EXPECT_NEAR(large.most / small.most, 10, 0.5);
}

TEST(Verify, B1_NeoHookeanBodyKeepsItsEnergy) {
  auto const small = ring<laws::NeoHookean>(1e-4), large = ring<laws::NeoHookean>(1e-3);
  EXPECT_LT(small.most, 1e-4);
  EXPECT_LT(small.drift, 1e-6);
  EXPECT_LT(large.drift, 1e-6);
  EXPECT_NEAR(large.most / small.most, 10, 0.5);
}

/// A block that can crack, crushed slowly between two plates: the energy that contacts hold or gave may not exceed
/// twice what the plates did, and nothing moves faster than twice the plates.
TEST(Verify, B2_NothingIsPumpedWhileABlockIsPressed) {
  Rig<> rig;
  auto stuff = material(soft_rock);
  stuff.joint = joint(3 * MPa, 10 * MPa, 20, 50, 20 * soft_rock.young);
  rig.add_material(stuff);
  double const L = 0.02, speed = 0.05;
  rig.add_box({0, 0, 0}, {L, L, L}, L / 4);
  // The plates start softly, so that what moves is the tool and not a wave of its start.
  auto const pace = [=](double t) { return speed * std::min(1.0, t / (60 * us)); };
  rig.scene.plates.push_back({"top",
                              {},
                              {{0, 0.75 * L, 0}, {2 * L, L / 2, 2 * L}},
                              {constant(0), of_time([=](double t) { return -pace(t); }), constant(0)},
                              {}});
  rig.scene.plates.push_back(
      {"bottom", {}, {{0, -0.75 * L, 0}, {2 * L, L / 2, 2 * L}}, {constant(0), of_time(pace), constant(0)}, {}});
  rig.scene.run.mass_damping = 2e4;
  auto& solver = rig.start();
  double fastest = 0, most_work = 0, rigid_work = 0;
  while (solver.time() < 200 * us) {
    solver.evaluate();
    for (int p = 0; p < 2; ++p)
      rigid_work += std::abs(solver.now().plate_force(p)[1]) * pace(solver.time()) * solver.dt();
    if (solver.step() % 50 == 0) {
      for (auto const& v : rig.velocities()) fastest = std::max(fastest, v.norm());
      if (rigid_work > 0) most_work = std::max(most_work, std::abs(solver.contact().work().on_vertices) / rigid_work);
    }
    solver.advance();
  }
  std::printf("contact work over plates' work %.3f, fastest node over twice the tool %.3f, residual %.2e of the work\n",
              most_work, fastest / (2 * speed), solver.now().energy("residual") / rigid_work);
  EXPECT_LE(most_work, 2);
  EXPECT_GE(most_work, 0.5);
  EXPECT_LE(fastest / (2 * speed), 1);
}

/// Table 7 of the paper: mass scaled by 5, h 0.94 mm, penalty 12 200 GPa.
double joint_limited_bound(double penalty, double scaling, double* joint_h = nullptr) {
  double const h = 0.94 * mm;
  Rig<> rig;
  auto stuff = material(soft_rock);
  stuff.joint = unbreakable(penalty);
  rig.add_material(stuff);
  rig.add_box({0, 0, 0}, {h, h, h}, h);
  rig.scene.run.mass_scaling = scaling;
  rig.scene.contact = false;
  rig.mesh = regular_simplices(h, C);
  rig.start();
  if (joint_h)
    for (double d : rig.solver->model().interfaces.size) *joint_h = std::max(*joint_h, d);
  return rig.solver->step_limit().bound;
}

TEST(Verify, B3_JointLimitedStep) {
  // dt = 2/sqrt(2 D k/m), k = (p/d)(A/D), m = rho V/(D + 1): D joints pull at a corner, each with twice its stiffness.
  // Ours has d, the distance of centroids normal to the joint; the paper's has the edge h. For regular tetrahedra d =
  // h/sqrt 6 = 0.408 h, so our 6.0 ns for the table's numbers are the paper's 9.4 ns times sqrt(0.408): the same p
  // means a joint 2.45 times as stiff here, and p = 0.408 times the paper's is its joint.
  double const h = 0.94 * mm, p = 12200 * GPa, rho = 5 * soft_rock.density;
  double const area = flat ? h : h * h * std::sqrt(3) / 4,
               volume = flat ? h * h * std::sqrt(3) / 4 : h * h * h / (6 * std::sqrt(2));
  double const size = flat ? h / std::sqrt(3) : h / std::sqrt(6), m = rho * volume / C;
  double d = 0;
  double const bound = joint_limited_bound(p, 5, &d);
  EXPECT_NEAR(d / size, 1, 1e-9);
  auto const formula = [&](double spacing) { return 2 / std::sqrt(2 * D * (p / spacing) * (area / D) / m); };
  if (!flat) {
    EXPECT_NEAR(formula(h), 9.4e-9, 0.05e-9);
  }
  // Bulk stiffness is a thousandth of the joints'; it takes half that share of the step.
  EXPECT_NEAR(bound / formula(size), 1, 2e-3);
  EXPECT_NEAR(bound / formula(h), std::sqrt(size / h), 2e-3);
  // dt ~ 1/sqrt(p), and the paper's joint with p d/h.
  EXPECT_NEAR(joint_limited_bound(4 * p, 5) / bound, 0.5, 1e-3);
  EXPECT_NEAR(joint_limited_bound(p * size / h, 5) / formula(h), 1, 4e-3);
}

/// A body of nothing but viscosity: stiffness E/1e6 and mu = 25 000 Pa s.
scene::Material viscous_stuff() {
  auto stuff = material<laws::NeoHookean>({1e-6 * soft_rock.young, soft_rock.poisson, soft_rock.density});
  stuff.viscosity = 25000;
  return stuff;
}

/// True when a small random motion of one free simplex, regular but for its altitude, dies away at the step dt.
bool viscosity_is_stable(double dt, double flatter) {
  double const h = 0.94 * mm;
  Rig<> rig;
  rig.add_material(viscous_stuff());
  rig.add_box({0, 0, 0}, {h, h, h}, h);
  rig.scene.run.mass_scaling = 5;
  rig.scene.run.dt = dt;
  rig.scene.contact = false;
  rig.mesh = regular_simplices(h, 0);
  for (auto& x : rig.mesh.nodes) x[D - 1] *= flatter;
  auto random = std::make_shared<std::mt19937>(3);
  rig.scene.bodies[0].velocity_at = [=](double, double, double) -> std::array<double, 3> {
    std::uniform_real_distribution<double> v(-1e-6, 1e-6);
    double const x = v(*random), y = v(*random), z = v(*random);
    return {x, y, z};
  };
  rig.start();
  double const start = rig.kinetic();
  for (int k = 0; k < 2000; ++k) {
    try {
      rig.step();
    } catch (Error const&) {
      return false;
    }
  }
  return rig.kinetic() <= start;
}

TEST(Verify, B3_CriticalViscosityLimitsTable7) {
  // The damping eigenvalue is c = 2 mu/E' omega_b^2, omega_b^2 = (D + 1) E'/rho sum |grad N|^2, and viscosity alone
  // allows 2/c: for a regular tetrahedron, sum |grad N|^2 = 6/h^2, that is rho h^2/(24 mu). The page's 13 ns are the
  // 25 000 Pa s that table 7 has for critical; mu = 2 h sqrt(E rho) is 19 700 Pa s there and allows 16.8 ns.
  // Stiffness takes less than a per cent.
  double const h = 0.94 * mm, rho = 5 * soft_rock.density, squares = flat ? 4 / (h * h) : 6 / (h * h);
  auto const bound = [&](double viscosity, double share) {
    Rig<> rig;
    auto stuff = material(soft_rock);
    stuff.viscosity = viscosity, stuff.critical_share = share;
    rig.add_material(stuff);
    rig.add_box({0, 0, 0}, {h, h, h}, h);
    rig.scene.run.mass_scaling = 5;
    rig.scene.contact = false;
    rig.mesh = regular_simplices(h, C);
    rig.start();
    auto const& limit = rig.solver->step_limit();
    EXPECT_NE(limit.owner.find("viscous damping"), std::string::npos) << limit.owner;
    return limit.bound;
  };
  auto const formula = [&](double mu) { return rho / (C * mu * squares); };
  double const table = bound(25000, 0), critical = bound(0, 1);
  std::printf("table 7: %.2f ns (the page: 13 ns in 3D), critical viscosity: %.2f ns\n", table * 1e9, critical * 1e9);
  EXPECT_NEAR(table / formula(25000), 1, 0.01);
  EXPECT_NEAR(critical / formula(2 * h * std::sqrt(soft_rock.young * rho)), 1, 0.01);
  if (!flat) {
    EXPECT_NEAR(table, 13e-9, 0.5e-9);
  }
  // The true limit has the largest eigenvalue of G = sum grad N grad N^T where the bound has its trace: a motion
  // along e that varies along e as well is damped by 2 mu e.G.e. The bound is low by D for a regular simplex, sharp
  // for a flat one.
  for (double flatter : {1.0, 0.2}) {
    Mat<double, D> edges;
    auto const mesh = regular_simplices(h, 0);
    for (int b = 0; b < D; ++b) edges.col(b) = (mesh.nodes[b + 1] - mesh.nodes[0]).head<D>();
    edges.row(D - 1) *= flatter;
    Mat<double, D> const inverse = edges.inverse();
    V const first = -inverse.colwise().sum().transpose();
    Mat<double, D> const G = inverse.transpose() * inverse + first * first.transpose();
    double const largest = Eigen::SelfAdjointEigenSolver<Mat<double, D>>(G).eigenvalues()[D - 1];
    double const limit = rho / (C * 25000 * largest);
    std::printf("altitude times %g: the limit is %.2f ns, %.2f times the bound\n", flatter, limit * 1e9,
                G.trace() / largest);
    EXPECT_TRUE(viscosity_is_stable(0.99 * limit, flatter)) << flatter;
    EXPECT_FALSE(viscosity_is_stable(1.01 * limit, flatter)) << flatter;
    EXPECT_GE(G.trace() / largest, 1);
    EXPECT_NEAR(G.trace() / largest, flatter == 1 ? D : 1, 0.1);
  }
}

/// True when a small random motion stays small for `steps` at the step dt.
bool stays_small(double dt, bool with_joints, int steps) {
  Rig<> rig;
  auto stuff = material<laws::NeoHookean>(rock);
  if (with_joints) stuff.joint = unbreakable(30 * rock.young);
  rig.add_material(stuff);
  rig.scene.contact = false;
  rig.scene.run.dt = dt;
  rig.add_box({0, 0, 0}, {0.04, 0.03, 0.03}, 0.01);
  auto random = std::make_shared<std::mt19937>(3);
  rig.scene.bodies[0].velocity_at = [=](double, double, double) -> std::array<double, 3> {
    std::uniform_real_distribution<double> v(-1e-6, 1e-6);
    double const x = v(*random), y = v(*random), z = v(*random);
    return {x, y, z};
  };
  rig.start();
  double const start = rig.kinetic();
  for (int k = 0; k < steps; ++k) {
    try {
      rig.step();
    } catch (Error const&) {
      return false;
    }
    if (k % 50 == 49 && !(rig.kinetic() < 100 * start)) return false;
  }
  return true;
}

void find_limits(bool with_joints) {
  Rig<> rig;
  auto stuff = material<laws::NeoHookean>(rock);
  if (with_joints) stuff.joint = unbreakable(30 * rock.young);
  rig.add_material(stuff);
  rig.scene.contact = false;
  rig.add_box({0, 0, 0}, {0.04, 0.03, 0.03}, 0.01);
  rig.start();
  double const limit = 2 / std::sqrt(rig.solver->stable_step().top_eigenvalue({}, 300, 1e-6));
  auto const& said = rig.solver->step_limit();
  std::printf("%s: bound %.4f, automatic/safety %.4f of the limit by a long iteration\n",
              with_joints ? "joints" : "bulk", said.bound / limit, said.automatic / rig.scene.run.safety / limit);
  // Growth at 1.02 of the limit is exp(2 acosh(1.02)) = 1.49 per step pair of the top mode: 2000 steps are plenty.
  EXPECT_FALSE(stays_small(1.02 * limit, with_joints, 2000));
  EXPECT_TRUE(stays_small(0.95 * limit, with_joints, 4000));
  EXPECT_TRUE(stays_small(said.automatic, with_joints, 4000));
  EXPECT_LE(said.bound, limit * (1 + 1e-6));
  EXPECT_LE(said.automatic / rig.scene.run.safety, limit);
  EXPECT_GE(said.automatic / rig.scene.run.safety, 0.8 * limit);
}

TEST(Verify, B4_StepBoundAgainstBlowUp) { find_limits(false); }
TEST(Verify, B4_StepBoundAgainstBlowUpWithJoints) { find_limits(true); }

/// A motion that begins at once takes half a step's kick: what it books is m v^2/2, no more. The next half-steps agree
/// to the error of a curved law, which goes with the strain; gravity holds against the motion from the start. A
/// traction that is there from the start: what it does in the first half step is booked as it is, so that a body
/// nothing else acts on has what it was given, from the first step on.
TEST(Verify, B5_SuddenLoadBooksItsEnergy) {
  for (double speed : {0.0, 3.0}) {
    Rig<> rig;
    rig.add_material(material<laws::NeoHookean>(rock));
    rig.add_box({0, 0, 0}, {10 * mm, 10 * mm, 10 * mm}, 5 * mm);
    rig.scene.bodies[0].velocity = {speed, 0, 0};
    rig.pull(0, place("right"), along(0, constant(1 * MPa)));
    auto& solver = rig.start();
    rig.step();
    solver.evaluate();
    double const error = solver.now().energy("residual") / solver.now().energy("external");
    std::printf("after one step: residual over external work %.1e\n", error);
    EXPECT_LT(std::abs(error), 1e-5);
  }
}

TEST(Verify, B5_SuddenHoldBooksItsEnergy) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {4 * mm, 4 * mm, 4 * mm}, 1 * mm);
  double const v = 1e-3;
  rig.hold(0, place("left"), along(0, constant(v)));
  rig.scene.gravity = {0, -9.81, 0};
  auto& solver = rig.start();
  rig.step();
  solver.evaluate();
  double const kinetic = solver.now().energy("kinetic");
  double const error = solver.now().energy("residual") / solver.now().energy("external");
  std::printf("after one step: kinetic %.3e J, residual over external work %.1e\n", kinetic, error);
  EXPECT_GT(kinetic, 0);
  EXPECT_LT(std::abs(error), 1e-5);
}

/// A hold that stops, slows, speeds up or turns round matter takes or gives the difference of its kinetic energy, once;
/// what was there before it is the energy at the start. Leapfrog is exact here: nothing else acts in the first step.
TEST(Verify, B5_HoldThatMeetsMotionBooksItsWorkOnce) {
  for (double target : {0.0, -10.0, -20.0, 30.0}) {
    Rig<> rig;
    rig.add_material(material<laws::NeoHookean>(steel));
    rig.add_box({0, 0, 0}, {4 * mm, 8 * mm, 4 * mm}, 2 * mm);
    double const v = -20;
    rig.scene.bodies[0].velocity = {0, v, 0};
    rig.hold(0, place("bottom"), along(1, constant(target)));
    auto& solver = rig.start();
    double const before = rig.kinetic();
    double held = 0;  // mass of what is held [kg]
    for (std::size_t i = 0; i < solver.model().vertices.mass.size(); ++i)
      if (rig.place_of(static_cast<Index>(i))[1] < -4 * mm + 1e-9) held += solver.model().vertices.mass[i];
    solver.evaluate();
    EXPECT_NEAR(solver.now().energy("residual"), 0, 1e-12 * before) << "at the start, target " << target;
    solver.advance();
    EXPECT_NEAR(solver.now().energy("external"), 0.5 * held * (target * target - v * v), 1e-9 * before)
        << "target " << target;
    solver.evaluate();
    while (solver.time() < 2 * us) solver.advance(), solver.evaluate();
    // Leapfrog's error goes with the strain of the blow, (target - v)/c up to 1 %, and comes and goes with the wave.
    EXPECT_NEAR(solver.now().energy("residual"), 0, 1e-3 * (before + std::abs(solver.now().energy("external"))))
        << "target " << target;
  }
}

/// Mass that scaling adds has inertia and no weight: free fall is slower by it, what a support carries and what falling
/// gains are not.
TEST(Verify, B5_ScaledMassWeighsNothing) {
  for (double scaling : {1.0, 100.0}) {
    Rig<> rig;
    rig.add_material(material<laws::NeoHookean>(rock));
    double const L = 10 * mm, volume = flat ? L * L : L * L * L, weight = rock.density * volume * 9.81;
    rig.add_box({0, 0, 0}, {L, L, L}, L / 2);
    rig.scene.gravity = {0, -9.81, 0};
    rig.scene.run.mass_scaling = scaling;
    rig.hold(0, place("all"), still());
    auto& solver = rig.start();
    rig.step();
    solver.evaluate();
    EXPECT_NEAR(solver.now().reaction(0)[1], weight, 1e-9 * weight) << "scaled by " << scaling;

    Rig<> free;
    free.add_material(material<laws::NeoHookean>(rock));
    free.add_box({0, 0, 0}, {L, L, L}, L / 2);
    free.scene.gravity = {0, -9.81, 0};
    free.scene.run.mass_scaling = scaling;
    auto& falling = free.start();
    for (int k = 0; k < 50; ++k) free.step();
    falling.evaluate();
    double const t = falling.time(), fall = 0.5 * 9.81 / scaling * t * t;
    EXPECT_NEAR(-free.displacements()[0][1], fall, 1e-6 * fall);
    EXPECT_NEAR(falling.now().energy("gravity"), -weight * -free.displacements()[0][1], 1e-6 * weight * fall);
    // of the first of 50 steps: v-.v+ begins with 0
    EXPECT_NEAR(falling.now().energy("residual"), 0, 1.01 / (4 * 50 * 50) * weight * fall);
  }
}

/// A pane is torn in two and its halves ring for some hundred periods without any damping of theirs, pressed together
/// again and again where joints have softened. Leapfrog gains a tenth of the energy at every bounce on a one-sided
/// spring at this step; with the damper of softened joints the balance closes to the 5 % above which a run warns.
/// Without it the residual is four times the work. Edges are so short that no element reaches from one held face to the
/// other: it would be torn inside out.
TEST(Verify, B6_SoftenedJointsThatRingMakeNoEnergy) {
  Rig<> rig;
  rig.scene.two_d = "plane stress";
  double const L = 10 * mm, speed = 1;
  auto stuff = material(steel);
  stuff.joint = joint(1140 * MPa, 3 * 1140 * MPa, 20e3, 20e3, 4000 * GPa);
  rig.add_material(stuff);
  rig.scene.out_of_plane = L;
  rig.add_body({scene::Box{{0, 0, 0}, {L, L, L}}, {}}, flat ? 2.5 * mm : 3.5 * mm, false);
  rig.scene.bodies[0].velocity_at = [=](double x, double, double) {
    return std::array<double, 3>{speed * (x / L + 0.5), 0, 0};
  };
  rig.hold(0, place("left"), along(0, constant(0)));
  rig.hold(0, place("right"), along(0, constant(speed)));
  rig.start();
  rig.run_for(0.5e-3);
  auto& solver = *rig.solver;
  solver.evaluate();
  double const work = solver.now().energy("external"), fracture = solver.now().energy("fracture"),
               residual = solver.now().energy("residual");
  std::printf("work %.3f J, fracture %.3f J, viscous %.3f J, residual %.4f J\n", work, fracture,
              solver.now().energy("viscous"), residual);
  EXPECT_GT(fracture, 0.1 * work);
  EXPECT_LT(std::abs(residual), 0.05 * work);
}

/// A rock whose shear strength grows with pressure is crushed between rough plates: joints soften and break pressed,
/// slide, turn back and loosen. A shear traction that follows the pressure of the moment makes 470 % of the work here.
TEST(Verify, B7_RockWithAFrictionAngleMakesNoEnergy) {
  for (double degrees : flat ? std::vector{0.0, 20.0, 35.0, 45.0} : std::vector{45.0}) {
    Rig<> rig;
    double const h = flat ? 2 * mm : 2.5 * mm, phi = degrees * std::numbers::pi / 180,
                 cohesion = degrees > 0 ? 50 * MPa : 96 * MPa;
    auto stuff = material({50 * GPa, 0.2, 2600});
    auto law = joint(9 * MPa, cohesion, 50, 500, 20 * 50 * GPa);
    law.friction_angle = phi, law.residual = 0.7;
    law.prepare();
    stuff.joint = law;
    stuff.contact = laws::ContactLaw{50 * GPa, 0.7};
    rig.add_material(stuff);
    rig.scene.run.mass_damping = 5e3;
    rig.scene.out_of_plane = 5 * mm;
    rig.add_body({scene::Box{{0, 0, 0}, {10 * mm, 20 * mm, 5 * mm}}, {}}, h, false);
    for (double side : {-1.0, 1.0})
      rig.scene.plates.push_back({side < 0 ? "bottom" : "top",
                                  {},
                                  {{0, side * 12 * mm, 0}, {20 * mm, 4 * mm, 20 * mm}},
                                  along(1, constant(-side)),
                                  laws::ContactLaw{50 * GPa, 0.5}});
    auto& solver = rig.start();
    rig.run_for(100 * us);
    solver.evaluate();
    double const work = solver.now().energy("external"), residual = solver.now().energy("residual");
    std::printf("%g degrees: %ld joints broken, work %.3f J, residual %.2f %%\n", degrees,
                static_cast<long>(solver.now().broken_joints()), work, 100 * residual / work);
    EXPECT_GT(solver.now().broken_joints(), 10) << degrees;
    EXPECT_LT(std::abs(residual), 5e-3 * work) << degrees;
  }
}

}  // namespace
}  // namespace fissure::verify