// Section E of the verification page in bodies: flow against closed forms, locking and its remedy, flow beside
// fracture. The laws alone are in tests/unit/flow_test.cpp.
#include "rig.h"

namespace fissure::verify {
namespace {

/// 42CrMo4 (paper table 1).
scene::Material flowing_steel() {
  scene::Material m = material(steel, "steel");
  laws::JohnsonCookFlow law;
  law.A = 806 * MPa, law.B = 614 * MPa, law.n = 0.168, law.C = 0.0089, law.rate0 = 1, law.melting = 1813;
  m.flow.emplace();
  m.flow->law = law;
  return m;
}

/// A cube at the origin's corner that is pulled along x at v, and moves so from the start.
void set_cube(Rig<>& rig, double size, double spacing, double v) {
  rig.add_box({size / 2, size / 2, flat ? 0 : size / 2}, {size, size, size}, spacing);
  rig.scene.bodies[0].velocity_at = [=](double x, double, double) { return std::array<double, 3>{v * x / size, 0, 0}; };
  rig.hold(0, place("left"), along(0, constant(0)));
  rig.hold(0, place("right"), along(0, constant(v)));
}

/// von Mises stress, mean of the elements.
double mean_von_mises(Rig<>& rig) {
  double sum = 0, n = 0;
  auto const stress = rig.stresses();
  for (Index e = 0; e < rig.solver->model().elements.count; ++e) {
    if (rig.solver->model().elements.cell[e] < 0) continue;
    auto const& s = stress[e];
    double const a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
    sum += std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
    ++n;
  }
  return sum / n;
}

void expect_balance(Rig<>& rig, double share = 1e-3) {
  rig.solver->evaluate();
  EXPECT_LT(std::abs(rig.solver->now().energy("residual")), share * rig.solver->now().energy("plastic"));
}

TEST(Verify, E2_CubeWithAllSidesHeld) {
  // s:s fixed by the deviatoric strain alone: q/3G + ep = 2/3 ln(1 + u). 0.05/s is slower than the reference rate. The
  // page's stresses are Cauchy with a linear pressure; ours carry J in the elastic part, 0.05 % of the stress at u =
  // 0.2.
  for (bool logarithmic : {false, true}) {
    Rig<> rig;
    rig.add_material(flowing_steel());
    rig.scene.materials[0].flow->logarithmic = logarithmic;
    set_cube(rig, 1, 0.5, 0.5);
    for (char const* side : {"bottom", "top"}) rig.roller(0, side, 1);
    for (char const* side : {"back", "front"}) rig.roller(0, side, 2);
    rig.start();
    double at = 0;
    for (auto const& [u, stress] : {std::pair{0.01, 1028.23}, {0.05, 1142.29}, {0.1, 1187.23}, {0.2, 1233.82}}) {
      rig.run_for((u - at) / 0.5);
      at = u;
      rig.solver->evaluate();
      EXPECT_NEAR(mean_von_mises(rig) / MPa, stress, 1e-3 * stress) << u;
      rig.solver->advance();
    }
    expect_balance(rig);
  }
}

TEST(Verify, E3_ElementAtAHighRateWithAndWithoutHeat) {
  // 10 mm pulled by 10 mm at 1 m/s: 1430.48 MPa, ep 0.68620; adiabatic 1261.49 MPa, 0.68702, 238.2 C. Sides free: plane
  // stress in 2D.
  for (bool heat : {false, true}) {
    Rig<> rig;
    scene::Material m = flowing_steel();
    if (heat) {
      std::get<laws::JohnsonCookFlow>(m.flow->law).m = 1.1;
      m.flow->heat = {460, 0.9, 293.15};
      std::get<laws::JohnsonCookFlow>(m.flow->law).melting = 1813.15;
    }
    rig.add_material(m);
    rig.scene.two_d = "plane stress";
    set_cube(rig, 10 * mm, 10 * mm, 1);
    rig.start();
    rig.run_for(10e-3);
    rig.solver->evaluate();
    EXPECT_NEAR(mean_von_mises(rig) / MPa, heat ? 1261.49 : 1430.48, 5e-3 * 1400);
    EXPECT_NEAR(rig.solver->now().extreme("plastic_strain"), heat ? 0.68702 : 0.68620, 5e-3 * 0.69);
    if (heat)
      EXPECT_NEAR(rig.solver->now().extreme("temperature") - 273.15, 238.2, 5e-3 * 238);
    else
      EXPECT_EQ(rig.solver->now().extreme("temperature"), 293.15);
    rig.solver->advance();
    expect_balance(rig);
  }
}

/// Yield stress over that at the reference temperature: 1 - ((T - T0)/(T_melting - T0))^m (Johnson & Cook 1983),
/// however a body comes by its temperature; colder than T0 nothing is harder.
TEST(Verify, E3_ABodyThatBeginsHot) {
  double const T0 = 293.15, hot = 600, melting = 1813.15, exponent = 1.1;
  struct Start {
    double material;
    std::optional<double> body;
  };
  for (auto const& [of_material, of_body] : {Start{T0, {}}, {hot, {}}, {T0, hot}, {hot, T0}, {T0, 200}}) {
    Rig<> rig;
    scene::Material m = flowing_steel();
    auto& law = std::get<laws::JohnsonCookFlow>(m.flow->law);
    law.m = exponent, law.melting = melting, law.C = 0;
    m.flow->heat = {1e12, 0.9, of_material, T0};  // such a capacity keeps its temperature
    rig.add_material(m);
    rig.scene.two_d = "plane stress";
    set_cube(rig, 1, 0.5, 0.5);
    rig.scene.bodies[0].temperature = of_body;
    rig.start();
    rig.run_for(0.1);
    rig.solver->evaluate();
    double const T = of_body.value_or(of_material), ep = rig.solver->now().extreme("plastic_strain"),
                 soft = T > T0 ? 1 - std::pow((T - T0) / (melting - T0), exponent) : 1;
    EXPECT_GT(ep, 0.04);
    EXPECT_NEAR(mean_von_mises(rig), soft * (law.A + law.B * std::pow(ep, law.n)), 1e-3 * law.A) << T;
    EXPECT_NEAR(rig.solver->now().extreme("temperature"), T, 1e-9 * T);
    rig.solver->advance();
    expect_balance(rig);
  }
}

TEST(Verify, E_YieldRatioIsOneWhereItFlowsAndTheStressShareWhereNot) {
  Rig<> rig;
  rig.add_material(flowing_steel());
  rig.scene.two_d = "plane stress";
  set_cube(rig, 1, 0.5, 0.5);
  rig.start();
  rig.run_for(2e-3 / 0.5);  // half of the yield strain 3.9e-3
  rig.solver->evaluate();
  EXPECT_NEAR(rig.solver->now().extreme("yield_ratio"), 206.9e9 * std::log(1.002) / (806 * MPa), 0.01);
  rig.solver->advance();
  rig.run_for(8e-3 / 0.5);
  rig.solver->evaluate();
  EXPECT_NEAR(rig.solver->now().extreme("yield_ratio"), 1, 1e-6);
  EXPECT_NEAR(rig.solver->now().field("yield_ratio", 0, {0.5, 0.5, 0.5}), 1, 1e-6);
  rig.solver->advance();
}

/// Steel that yields at 500 MPa and does not harden.
scene::Material perfectly_plastic() {
  scene::Material m = material(steel, "perfectly plastic");
  laws::CurvesFlow law;
  law.strains = law.rates = 1;
  m.flow.emplace();
  m.flow->law = law;
  m.flow->curves = {0, 0, 500 * MPa};
  return m;
}

/// A block whose lower and upper face are held sideways, pressed by a fifth: flow is forced through corners.
/// Returns the mean pressure on it over the yield stress, and the spread of pressure from element to element over it.
std::pair<double, double> pressed(bool averaged, bool fracture) {
  Rig<> rig;
  scene::Material m = perfectly_plastic();
  m.flow->averaged = averaged;
  if (fracture) m.joint = unbreakable(20 * steel.young);
  rig.add_material(m);
  double const L = 10 * mm, v = 10;
  rig.add_box({L / 2, L / 2, flat ? 0 : L / 2}, {L, L, L}, L / 5);
  rig.scene.bodies[0].velocity_at = [=](double, double y, double) { return std::array<double, 3>{0, -v * y / L, 0}; };
  rig.hold(0, place("bottom"), still());
  rig.hold(0, place("top"), {constant(0), constant(-v), constant(0)});
  rig.start();
  rig.run_for(0.2 * L / v);
  rig.solver->evaluate();
  auto const stress = rig.stresses();
  double load = std::abs(rig.solver->now().reaction(1)[1]) / (flat ? L : L * L), spread = 0;
  auto const& model = rig.solver->model();
  Index pairs = 0;
  auto const across = mesh::neighbours(rig.mesh);
  for (std::size_t k = 0; k < across.size(); ++k) {
    if (across[k] < 0) continue;
    auto const pressure = [&](int cell) {
      auto const& s = stress[model.elements.of_cell[cell]];
      return -(s[0] + s[1] + s[2]) / 3;
    };
    spread += std::abs(pressure(static_cast<int>(k) / C) - pressure(across[k]));
    ++pairs;
  }
  rig.solver->advance();
  expect_balance(rig, 5e-3);
  return {load / (500 * MPa), spread / pairs / (500 * MPa)};
}

/// A metal cube pressed to a third of its height between rollers, with the step `dt` (0: automatic). Returns the last
/// step over the first, and the residual over what flow took; infinite when the run stopped.
std::pair<double, double> flattened(double dt) {
  Rig<> rig;
  scene::Material m = perfectly_plastic();
  rig.add_material(m);
  double const L = 10 * mm, v = 50;
  rig.add_box({L / 2, L / 2, L / 2}, {L, L, L}, L / 4);
  rig.scene.bodies[0].velocity_at = [=](double, double y, double) { return std::array<double, 3>{0, -v * y / L, 0}; };
  for (int c = 0; c < 3; ++c) rig.roller(0, c == 0 ? "left" : c == 1 ? "bottom" : "back", c);
  rig.hold(0, place("top"), along(1, constant(-v)));
  if (dt > 0) rig.scene.run.dt = dt;
  double const first = rig.start().step_limit().dt;
  try {
    rig.run_for(2.0 / 3 * L / v);
    rig.solver->evaluate();
  } catch (Error const&) {
    return {1, std::numeric_limits<double>::infinity()};
  }
  return {rig.solver->step_limit().dt / first,
          std::abs(rig.solver->now().energy("residual")) / rig.solver->now().energy("plastic")};
}

/// The step goes with the height of the elements, which is a third at the end, as long as that is what limits it; kept
/// as it was at the start, at 0.8 of the limit, it is 2.4 times too long in the end.
TEST(Verify, E8_StepFollowsTheShapeOfWhatIsCrushed) {
  auto const [shrunk, residual] = flattened(0);
  std::printf("step at a third of the height: %.3f of the first, residual %.1e\n", shrunk, residual);
  EXPECT_LT(shrunk, 0.6);
  EXPECT_GT(shrunk, 0.2);
  EXPECT_LT(residual, 5e-3);
  Rig<> rig;
  rig.add_material(material(steel));
  double const L = 10 * mm;
  rig.add_box({L / 2, L / 2, L / 2}, {L, L, L}, L / 4);
  double const start = rig.start().step_limit().automatic;
  EXPECT_GT(flattened(start).second, 0.1);
}

/// Spun up at once, a body rings while it turns, far below yield. A strain added in the axes of the middle of the step
/// lags the stress by half of the step's turn, and feeds what rings: seven turns made 1.2 times the motion there was.
TEST(Verify, E9_BodyThatSpinsFarBelowYieldRingsNoLouder) {
  for (bool soil : {false, true}) {
    Rig<> rig;
    auto stuff = material({1e9, 0.3, 1000});
    stuff.flow.emplace();
    if (soil) {
      laws::DruckerPrager law;
      stuff.flow->curves = {0, 0, 50 * MPa};  // one strain, one rate, one stress
      law.strains = law.rates = 1, law.friction_angle = 0.5;
      stuff.flow->law = law;
    } else {
      laws::JohnsonCookFlow law;
      law.A = 50 * MPa;
      stuff.flow->law = law;
    }
    rig.add_material(stuff);
    double const L = 20 * mm, spin = 100 / L;
    rig.add_box({0, 0, 0}, {L, L, L}, L / 4);
    rig.scene.bodies[0].velocity_at = [=](double x, double y, double) -> std::array<double, 3> {
      return {-spin * y, spin * x, 0};
    };
    auto& solver = rig.start();
    double const energy = rig.kinetic();
    rig.run_for(10 * 2 * std::numbers::pi / spin);
    solver.evaluate();
    std::printf("motion %.4f of the first, elastic %.1e, residual %.1e\n", rig.kinetic() / energy,
                solver.now().energy("elastic") / energy, solver.now().energy("residual") / energy);
    EXPECT_EQ(solver.now().energy("plastic"), 0);
    EXPECT_LT(std::abs(solver.now().energy("residual")), 1e-3 * energy);
  }
}

/// Rock of a very steep yield surface (69 degrees), crushed to a third of its height between faces that are held.
struct Crushed {
  double work, flow, residual;
};
Crushed crushed_rock(Rig<>& rig, double dilation, bool logarithmic) {
  auto stuff = material({30e9, 0.2, 2500});
  laws::DruckerPrager law;
  stuff.flow.emplace();
  stuff.flow->curves = {0, 0, 50 * MPa};
  law.strains = law.rates = 1, law.friction_angle = 1.2, law.dilation_angle = dilation;
  stuff.flow->law = law;
  stuff.flow->logarithmic = logarithmic;
  rig.add_material(stuff);
  double const L = 40 * mm, v = 70;
  rig.add_box({0, L / 2, 0}, {L, L, L}, L / 4);
  rig.scene.bodies[0].velocity_at = [=](double, double y, double) { return std::array<double, 3>{0, -v * y / L, 0}; };
  rig.hold(0, place("bottom"), still());
  rig.hold(0, place("top"), along(1, constant(-v)));
  rig.start();
  rig.run_for(2.0 / 3 * L / v);
  rig.solver->evaluate();
  return {rig.solver->now().energy("external"), rig.solver->now().energy("plastic"),
          rig.solver->now().energy("residual")};
}

/// It flows, turns and rings at once, its elastic strain is large (0.7 by its logarithm), and its pressure nears its
/// stiffness. With strains that lagged the stress the balance was off by up to 9 %, or elements turned inside out; with
/// logarithms by series by up to 35 %.
TEST(Verify, E9_CrushedRockWithASteepSurfaceClosesItsBalance) {
  for (bool logarithmic : {false, true})
    for (double dilation : flat ? std::vector{0.0, 0.6} : std::vector{0.0, 1.2}) {
      Rig<> rig;
      auto const now = crushed_rock(rig, dilation, logarithmic);
      std::printf("%s, dilation %g: work %.3g J, residual %.2f %%\n", logarithmic ? "logarithmic" : "Jaumann", dilation,
                  now.work, 100 * now.residual / now.work);
      EXPECT_GT(now.flow, 0);
      EXPECT_LT(std::abs(now.residual), 5e-3 * now.work) << dilation;
    }
}

/// A block that flies 1.6 m, 160 times its size, in single precision: growth by differences of positions made energy of
/// their rounding.
TEST(Verify, F_BlocksThatFlowStoreNothingInFlight) {
  for (char const* way : {"one_point", "assumed_strain", "full", "b_bar"}) {
    Rig<float> rig;
    rig.cell_name = "block", rig.integration = way;
    auto stuff = material({1e9, 0.3, 1000});
    stuff.flow.emplace();
    laws::JohnsonCookFlow law;
    law.A = 1e9;
    stuff.flow->law = law;
    rig.add_material(stuff);
    double const L = 10 * mm;
    rig.add_box({0, 0, 0}, {L, L, L}, L / 2);
    rig.scene.bodies[0].velocity_at = [](double, double, double) { return std::array<double, 3>{200, 0, 0}; };
    auto& solver = rig.start();
    double const motion = rig.kinetic();
    rig.run_for(8e-3);
    solver.evaluate();
    std::printf("%s: elastic %.1e of the motion\n", way, solver.now().energy("elastic") / motion);
    // No more strain than if the last digit of all the way, 6e-8 of 1.6 m over an edge of 5 mm, were lost in one
    // direction: E e^2.
    EXPECT_LT(solver.now().energy("elastic") / motion, 1e9 * 2e-5 * 2e-5 / (0.5 * 1000 * 200 * 200)) << way;
  }
}

/// The default step is short enough: half of it gives the same work and the same flow, and the residual falls with its
/// square. Where the step missed what pressure adds to the stiffness, full blocks flowed 28 % less and closed to 1 %.
TEST(Verify, F_CrushedRockOfBlocksIsRightAtTheDefaultStep) {
  for (char const* way : {"full", "b_bar"}) {
    Crushed at[2];
    for (int half : {0, 1}) {
      Rig<> rig;
      rig.cell_name = "block", rig.integration = way;
      rig.scene.run.safety = half ? 0.4 : 0.8;
      at[half] = crushed_rock(rig, 0.6, false);
    }
    std::printf("%s: work %.4g and %.4g J, flow %.4g and %.4g J, residual %.2g and %.2g %%\n", way, at[0].work,
                at[1].work, at[0].flow, at[1].flow, 100 * at[0].residual / at[0].work,
                100 * at[1].residual / at[1].work);
    EXPECT_NEAR(at[0].work / at[1].work, 1, 0.02) << way;
    EXPECT_NEAR(at[0].flow / at[1].flow, 1, 0.02) << way;
    EXPECT_LT(std::abs(at[0].residual), 5e-3 * at[0].work) << way;
    // 1/4, but for what is left of ringing
    EXPECT_LT(std::abs(at[1].residual), 0.35 * std::abs(at[0].residual)) << way;
  }
}

TEST(Verify, E6_AveragedPressureUnlocksFlow) {
  // Elements of their own pressure carry more load, and a pressure that jumps from one to the next: averaging over the
  // 10 to 20 elements about a node must take more than half of the jumps.
  auto const [locked, rough] = pressed(false, false);
  auto const [load, smooth] = pressed(true, false);
  EXPECT_LT(load, locked);
  EXPECT_LT(smooth, 0.5 * rough);
  // With joints, whose corners have vertices of their own, the patches are the same: what is bonded averages.
  auto const [jointed, smooth_too] = pressed(true, true);
  EXPECT_NEAR(jointed / load, 1, 0.1);  // the joints' own compliance
  EXPECT_LT(smooth_too, 0.5 * rough);
}

/// A bar of soft metal with averaged pressure, 6.4 mm thick: in 2D it is a slab or, axisymmetric, round.
void set_bar(Rig<>& rig, std::string const& two_d, double spacing) {
  scene::Material m = material({117 * GPa, 0.35, 8930}, "soft metal");
  laws::CurvesFlow law;
  law.strains = law.rates = 1, law.beyond = 100 * MPa;
  m.flow.emplace();
  m.flow->law = law;
  m.flow->curves = {0, 0, 400 * MPa};
  m.flow->averaged = true;
  rig.add_material(m);
  rig.scene.two_d = two_d;
  rig.add_body({scene::Rod{{0, 0, 0}, 3.2 * mm, 32.4 * mm, 0}, {}}, spacing, false);
}

std::vector<std::string> const ways_in_2d =
    flat ? std::vector<std::string>{"plane strain", "axisymmetric"} : std::vector<std::string>{"plane strain"};

/// Forces of averaged pressure are the derivatives of what is booked as energy of volume, far from rest too. In a step
/// of no length nothing is remembered of shape: forces are those of volume alone.
TEST(Verify, E6_ForcesOfPatchesAreDerivativesOfTheirEnergy) {
  for (auto const& two_d : ways_in_2d) {
    Rig<> rig;
    set_bar(rig, two_d, flat ? 0.8 * mm : 2 * mm);
    rig.start();
    std::mt19937 random(11);
    double const size = flat ? 0.1 * mm : 0.2 * mm;
    auto const u = rig.random_vectors(size, random), direction = rig.random_vectors(size, random);
    EXPECT_NEAR(rig.force_over_slope(u, direction), 1, 1e-8) << two_d;
  }
}

/// Least ratio of volumes of all elements.
double least_volume(Rig<>& rig) {
  bool const round = rig.scene.two_d == "axisymmetric";
  auto const u = rig.displacements();
  double least = 1;
  for (Index const e : rig.heads()) {
    auto const volume = [&](double share) {
      Mat<double, D> edges;
      double radius = 0;
      for (int a = 0; a < C; ++a) {
        Index const vertex = rig.solver->model().vertex_of(e, a), first = rig.solver->model().vertex_of(e, 0);
        V const x = rig.place_of(vertex) + share * u[vertex], from = rig.place_of(first) + share * u[first];
        if (a > 0) edges.col(a - 1) = x - from;
        radius += x[0];
      }
      return edges.determinant() * (round ? radius : 1.0);
    };
    least = std::min(least, volume(1) / volume(0));
  }
  return least;
}

/// The bar hits a wall at 227 m/s, without friction. Single elements of a patch must not be crushed while others swell:
/// one is pushed with about the yield stress, 0.7 GPa at a strain of 3, against k (1 - J) with the spring k = G/50 =
/// 0.87 GPa, so a fifth of its volume stays. Length and radius are those of another code (axisymmetric B-bar
/// quadrilaterals: 21.453 and 7.303 mm), to 1 % and 3 % as in E5.
TEST(Verify, E6_FootOfASoftBarIsNotCrushed) {
  for (auto const& two_d : ways_in_2d) {
    Rig<> rig;
    set_bar(rig, two_d, flat ? 0.6 * mm : 2 * mm);
    rig.scene.bodies[0].velocity = {0, -227, 0};
    rig.scene.walls.push_back({"wall", {}, {0, 0, 0}, {0, 1, 0}, {}});
    rig.start();
    rig.run_for(80 * us);
    rig.solver->evaluate();
    auto const [lower, upper] = rig.solver->now().bounds(0);
    double const length = upper[1] - lower[1], foot = upper[0], least = least_volume(rig);
    std::printf("%s: length %.3f mm, foot %.3f mm, least volume %.3f, %ld steps\n", two_d.c_str(), length / mm,
                foot / mm, least, rig.solver->step());
    EXPECT_GT(least, 0.2);
    if (two_d == "axisymmetric") {
      EXPECT_NEAR(length, 21.453 * mm, 0.01 * 21.453 * mm);
      EXPECT_NEAR(foot, 7.303 * mm, 0.03 * 7.303 * mm);
    }
    rig.solver->advance();
    expect_balance(rig, 1e-2);
  }
}

TEST(Verify, E6_PatchesEndWhereJointsHaveBroken) {
  Rig<> rig;
  scene::Material m = flowing_steel();
  m.flow->averaged = true;
  m.joint = joint(1600 * MPa, 1600 * MPa, 1e3, 1e3, 20 * steel.young);
  rig.add_material(m);
  rig.add_box({0, 0, 0}, {4 * mm, 4 * mm, 4 * mm}, 2 * mm);
  rig.start();
  Index const nodes = static_cast<Index>(rig.mesh.nodes.size());
  EXPECT_EQ(rig.solver->model().groups[0].patches, nodes);  // all is bonded: one patch per node
  // Pull the left half off the right one.
  rig.displace([&](Index e, int, V const&) {
    V u = V::Zero();
    if (rig.centroid(e)[0] > 0) u[0] = 0.1 * mm;
    return u;
  });
  rig.step();
  Index const middle = static_cast<Index>(
      std::count_if(rig.mesh.nodes.begin(), rig.mesh.nodes.end(), [](Vec3 const& x) { return std::abs(x[0]) < 1e-9; }));
  EXPECT_GT(rig.solver->now().broken_joints(), 0);
  EXPECT_EQ(rig.solver->model().groups[0].patches, nodes);  // this step's forces were those of the whole
  rig.step();
  EXPECT_EQ(rig.solver->model().groups[0].patches, nodes + middle);  // one on each side of the crack
}

TEST(Verify, E_YieldsFirstThenCracks) {
  // The joint model's claim (paper, sec. 3.3.2): with joints stronger than the yield stress a clamped bar flows, then
  // cracks; with weaker ones it cracks and never flows.
  for (double strength : {1600 * MPa, 400 * MPa}) {
    Rig<> rig;
    scene::Material m = flowing_steel();
    m.joint = joint(strength, strength, 1e4, 1e4, 20 * steel.young);
    m.critical_share = 0.1;
    rig.add_material(m);
    double const L = 0.1, v = 5;
    rig.add_box({L / 2, L / 2, flat ? 0 : L / 2}, {L, L, L}, L / 2);
    rig.scene.bodies[0].velocity_at = [=](double x, double, double) { return std::array<double, 3>{v * x / L, 0, 0}; };
    rig.hold(0, place("left"), still());
    rig.hold(0, place("right"), {constant(v), constant(0), constant(0)});
    rig.start();
    double flowed = 0;
    while (rig.solver->time() < 0.3 * L / v && rig.solver->now().broken_joints() == 0) {
      rig.step();
      if (rig.solver->step() % 50 == 0) flowed = rig.solver->now().extreme("plastic_strain");
    }
    EXPECT_GT(rig.solver->now().broken_joints(), 0) << strength;
    if (strength > 806 * MPa)
      EXPECT_GT(flowed, 806 * MPa / steel.young);  // more than it was stretched before
    else
      EXPECT_EQ(flowed, 0);
  }
}

TEST(Verify, E_ReturnThatFindsNoNumberStopsTheRun) {
  Rig<> rig;
  rig.add_material(flowing_steel());
  set_cube(rig, 1, 0.5, 0.5);
  auto& solver = rig.start();
  for (int i = 0; i < 20; ++i) rig.step();
  auto memory = solver.model().internal.memory.download();
  auto const& group = solver.model().groups[0];
  memory[group.simplices.memory_at + kernels::blocked(1, group.plastic->memory.strain, group.plastic->memory.numbers)] =
      NAN;
  solver.model().internal.memory.upload(memory);
  try {
    rig.step();
    FAIL() << "it went on";
  } catch (Error const& error) {
    EXPECT_NE(std::string(error.what()).find("the return mapping of element 1 of body \"body 0\" did not converge"),
              std::string::npos)
        << error.what();
  }
}

TEST(Verify, E_SingleAndDoublePrecisionFlowAlike) {
  double stress[2];
  auto const run = [&]<class Real>(Rig<Real>& rig, double& out) {
    rig.add_material(flowing_steel());
    rig.scene.two_d = "plane stress";
    rig.add_box({0.5, 0.5, flat ? 0 : 0.5}, {1, 1, 1}, 0.5);
    rig.scene.bodies[0].velocity_at = [](double x, double, double) { return std::array<double, 3>{x, 0, 0}; };
    rig.hold(0, place("left"), along(0, constant(0)));
    rig.hold(0, place("right"), along(0, constant(1)));
    rig.start();
    rig.run_for(0.05);
    rig.solver->evaluate();
    out = rig.solver->now().field("von_mises", 0, {0.5, 0.5, 0.5});
  };
  Rig<double> fine;
  Rig<float> coarse;
  run(fine, stress[0]);
  run(coarse, stress[1]);
  // a few thousand steps of 1e-7 each in the strain of a slowly rising curve
  EXPECT_NEAR(stress[1] / stress[0], 1, 1e-3);
}

}  // namespace
}  // namespace fissure::verify
