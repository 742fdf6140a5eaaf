// Ties between bodies whose meshes do not match (tie{}): what is uniform, what turns, what passes, what holds move.
#include "rig.h"

namespace fissure::verify {
namespace {

void tie(Rig<>& rig, int one, int other) {
  scene::Tie tie;
  tie.name = "glue " + std::to_string(rig.scene.ties.size()), tie.bodies = {one, other};
  rig.scene.ties.push_back(tie);
}

/// Two halves of a bar along x from -L/2 to L/2, of cells that do not match, neither where they are cut nor in size.
constexpr double L = 0.4, a = 0.1;
void set_bar(Rig<>& rig, double coarse = 0.05, double fine = flat ? 0.0142 : 0.024) {
  rig.add_material(material(rock));
  rig.add_box({-L / 4, 0, 0}, {L / 2, a, a}, coarse);
  rig.add_box({L / 4, 0, 0}, {L / 2, a, a}, fine, 0, false);
  rig.scene.out_of_plane = a;
  tie(rig, 0, 1);
}

/// Pulled at both ends it is as long as a bar of one piece, and the tie carries the whole force.
TEST(Verify, M1_ABarOfTwoMeshesStretches) {
  Rig<> rig;
  set_bar(rig);
  double const stress = 1 * MPa;
  rig.pull(0, place("left"), along(0, constant(-stress)));
  rig.pull(1, place("right"), along(0, constant(stress)));
  rig.come_to_rest(L, rock.bar(), 10);
  rig.solver->evaluate();
  double left = 0, right = 0;
  int n_left = 0, n_right = 0;
  auto const u = rig.displacements();
  for (Index i = 0; i < static_cast<Index>(u.size()); ++i) {
    double const x = rig.place_of(i)[0];
    if (!(rig.solver->model().vertices.mass[i] > 0)) continue;
    if (x < -L / 2 + 1e-9) left += u[i][0], ++n_left;
    if (x > L / 2 - 1e-9) right += u[i][0], ++n_right;
  }
  double const young = flat ? rock.young / (1 - rock.poisson * rock.poisson) : rock.young;
  // Points that hang pass on forces that are not those of a uniform stress: felt in the cells beside the tie alone.
  EXPECT_NEAR((right / n_right - left / n_left) / (stress * L / young), 1, 0.005);
  EXPECT_NEAR(rig.solver->ties().force(0)[0] / (stress * a * a), -1, 1e-3);
  EXPECT_LT(std::abs(rig.solver->energies().residual()), 1e-3 * 0.5 * stress * stress / young * L * a * a);
}

/// In free flight nothing is lost: momentum, angular momentum and energy, while it turns several times.
TEST(Verify, M2_ItTurnsAsOne) {
  Rig<> rig;
  set_bar(rig);
  double const spin = 2e3;
  for (auto& body : rig.scene.bodies)
    body.velocity_at = [=](double x, double y, double) { return std::array{3 - spin * y, spin * x - 5, 1.0}; };
  rig.start();
  V const before = rig.momentum();
  Vec3 const turning = rig.angular_momentum();
  double const whole = rig.kinetic();
  rig.run_for(2 * 2 * std::numbers::pi / spin);
  EXPECT_LT((rig.momentum() - before).norm(), 1e-11 * before.norm());
  EXPECT_LT((rig.angular_momentum() - turning).norm(), 1e-10 * turning.norm());
  rig.solver->evaluate();
  EXPECT_LT(std::abs(rig.solver->energies().residual()), 1e-3 * whole);
}

/// Of a pulse between rollers once it has gone half the length of the bar: error of velocities in the mean square
/// (d'Alembert). `tied`: into cells of a third the size; else the bar is of one body.
double pulse_error(bool tied) {
  Rig<> rig;
  double const coarse = flat ? 0.01 : 0.02;
  if (tied) {
    set_bar(rig, coarse, coarse / 2.8);
  } else {
    rig.add_material(material(rock));
    rig.add_box({0, 0, 0}, {L, a, a}, coarse);
    rig.scene.out_of_plane = a;
  }
  std::vector<std::pair<char const*, int>> const rollers{{"bottom", 1}, {"top", 1}, {"back", 2}, {"front", 2}};
  for (int body = 0; body < static_cast<int>(rig.scene.bodies.size()); ++body)
    for (auto const& [side, c] : rollers) rig.roller(body, side, c);
  double const w = 0.05, from = -L / 4, speed = 1, c = rock.c_P();
  auto const pulse = [=](double x) { return speed * std::exp(-std::pow((x - from) / w, 2)); };
  for (auto& body : rig.scene.bodies)
    body.velocity_at = [=](double x, double, double) { return std::array{pulse(x), 0.0, 0.0}; };
  rig.start();
  rig.run_for(L / 2 / c);
  auto const v = rig.velocities();
  double error = 0, size = 0;
  for (Index i = 0; i < static_cast<Index>(v.size()); ++i) {
    double const x = rig.place_of(i)[0], t = rig.solver->time() - 0.5 * rig.solver->dt(),
                 m = rig.solver->model().vertices.mass[i];
    // Two halves, and the image of the left one beyond the free end.
    double const exact = 0.5 * (pulse(x - c * t) + pulse(x + c * t) + pulse(-L - x + c * t));
    error += m * std::pow(v[i][0] - exact, 2), size += m * exact * exact;
  }
  rig.solver->evaluate();
  EXPECT_LT(std::abs(rig.solver->energies().residual()), 1e-3 * 0.5 * rig.mass() * speed * speed);
  return std::sqrt(error / size);
}

/// What a tie sends back is of the order of what the coarser of both meshes errs by alone: the square of its cells over
/// the width of the pulse.
TEST(Verify, M3_APulsePasses) {
  double const tied = pulse_error(true), whole = pulse_error(false);
  EXPECT_LT(whole, 0.15);
  EXPECT_LT(tied, 2 * whole);
}

/// A wall of two leaves under its weight, both on rollers, one of them lifted at a side: holds move what carries and
/// what hangs, and their reactions are the weight.
TEST(Verify, M4_HoldsCarryWhatHangsOnThem) {
  Rig<> rig;
  set_bar(rig);
  double const g = 9.81;
  rig.scene.gravity = {0, -g, 0};
  auto const low = [](double, double y, double) { return y < -a / 2 + 1e-9; };
  double const rise = 0.01;
  for (int body : {0, 1}) rig.hold(body, where(low), along(1, constant(rise)));
  rig.hold(0, where([](double x, double, double) { return x < -L / 2 + 1e-9; }), along(0, constant(0)));
  rig.roller(0, "back", 2);
  for (auto& body : rig.scene.bodies) body.velocity = {0, rise, 0};
  rig.come_to_rest(L, rock.bar(), 10);
  double up = 0;
  for (int k = 0; k < 400; ++k) {
    rig.solver->evaluate();
    up += (rig.solver->motion().reaction(0)[1] + rig.solver->motion().reaction(1)[1]) / 400;
    rig.solver->advance();
  }
  // Damping by mass resists the rise, too.
  EXPECT_NEAR(up / (rig.mass() * (g + rig.scene.run.mass_damping * rise)), 1, 1e-3);
  rig.solver->evaluate();
  auto const& ledger = rig.solver->energies();
  EXPECT_LT(std::abs(ledger.residual()), 1e-3 * (ledger.kinetic + std::abs(ledger.external)));
  auto const u = rig.displacements();
  for (auto const& one : rig.solver->model().hung) {
    V gap = u[one.vertex];
    for (int k = 0; k < C; ++k) gap -= one.share[k] * u[one.on[k]];
    if (rig.place_of(one.vertex)[1] < -a / 2 + 1e-9) gap[1] = 0;  // held along y itself
    EXPECT_LT(gap.norm(), 1e-15);
  }
}

/// Three bodies that meet at a corner, each tied to the others: nodes hang on nodes that hang.
void set_corner(Rig<>& rig) {
  rig.add_material(material(rock));
  rig.add_box({0, -0.05, 0}, {0.2, 0.1, 0.1}, 0.05);
  rig.add_box({-0.05, 0.05, 0}, {0.1, 0.1, 0.1}, 0.03);
  rig.add_box({0.05, 0.05, 0}, {0.1, 0.1, 0.1}, 0.018);
  for (int one : {0, 1, 2})
    for (int other : {1, 2})
      if (one < other) tie(rig, one, other);
}

/// The base carries both others: what its ties pull them with is their weight.
TEST(Verify, M5_TheBaseCarriesBoth) {
  Rig<> rig;
  set_corner(rig);
  double const g = 9.81;
  rig.scene.gravity = {0, -g, 0};
  rig.hold(0, place("bottom"), still());
  rig.come_to_rest(0.2, rock.bar(), 12);
  rig.solver->evaluate();
  double const up = rig.solver->ties().force(0)[1] + rig.solver->ties().force(1)[1];
  EXPECT_NEAR(up / (rig.mass() / 2 * g), 1, 1e-3);
}

/// One leaves, the rest flies on.
TEST(Verify, M5_ThreeMeetAndOneLeaves) {
  Rig<> rig;
  set_corner(rig);
  double const spin = 100;
  for (auto& body : rig.scene.bodies)
    body.velocity_at = [=](double x, double y, double z) {
      return std::array{2 - spin * y + 20 * x, spin * x, flat ? 0 : 1 - 15 * z};
    };
  scene::Excavation out;
  out.body = 1, out.time = 100 * us;
  rig.scene.excavations.push_back(out);
  rig.start();
  double const whole = rig.kinetic();
  V momentum = rig.momentum();
  rig.run_for(90 * us);
  EXPECT_LT((rig.momentum() - momentum).norm(), 1e-11 * momentum.norm());
  rig.run_for(20 * us);
  momentum = V::Zero();
  auto const of_two = [&] {
    V sum = V::Zero();
    auto const v = rig.velocities();
    for (std::size_t i = 0; i < v.size(); ++i)
      if (rig.solver->model().vertices.inverse_mass.download_one(i) > 0)
        sum += rig.solver->model().vertices.mass[i] * v[i];
    return sum;
  };
  momentum = of_two();
  State const middle = rig.solver->save();
  rig.run_for(100 * us);
  EXPECT_LT((of_two() - momentum).norm(), 1e-11 * momentum.norm());
  State const last = rig.solver->save();
  long const steps = rig.solver->step();
  rig.solver->evaluate();
  EXPECT_LT(std::abs(rig.solver->energies().residual()), 1e-3 * whole);

  Rig<> again;
  again.scene = rig.scene, again.mesh = rig.mesh;
  again.start();
  again.solver->restore(middle);
  while (again.solver->step() < steps) again.step();
  EXPECT_TRUE(again.solver->save() == last);
}

/// Around an axis nothing leaves it, and a pressed rod of two meshes is as long as theory says.
TEST(Verify, M7_TheAxisStaysWhereItIs) {
  if (!flat) return;
  Rig<> rig;
  rig.add_material(material(rock));
  rig.scene.two_d = "axisymmetric";
  double const H = 0.1, R = 0.02, p = 5 * MPa;
  rig.add_box({R / 2, -H / 4, 0}, {R, H / 2, 1}, 5 * mm, 0, false);
  rig.add_box({R / 2, H / 4, 0}, {R, H / 2, 1}, 1.8 * mm, 0, false);
  tie(rig, 0, 1);
  rig.press(0, place("bottom"), constant(p));
  rig.press(1, place("top"), constant(p));
  rig.come_to_rest(H, rock.bar(), 10);
  auto const u = rig.displacements();
  double top = 0, bottom = 0;
  for (Index i = 0; i < static_cast<Index>(u.size()); ++i) {
    if (!(rig.solver->model().vertices.mass[i] > 0)) continue;
    V const x = rig.place_of(i);
    if (x[0] < 1e-9) {
      EXPECT_EQ(u[i][0], 0);
    }
    if (x[0] < 1e-9 && x[1] > H / 2 - 1e-9) top = u[i][1];
    if (x[0] < 1e-9 && x[1] < -H / 2 + 1e-9) bottom = u[i][1];
  }
  EXPECT_NEAR((bottom - top) / (p * H / rock.young), 1, 0.005);
}

/// Bodies that start with different velocities cannot be tied, whatever else flies about; nor may holds ask what hangs
/// for what the place it hangs on does not do.
TEST(Verify, M6_TiesAndMotionsMustAgree) {
  auto const refusal = [](auto&& change) {
    Rig<> rig;
    set_bar(rig);
    change(rig);
    try {
      rig.start();
    } catch (Error const& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  auto const says = [](std::string const& text, char const* part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  says(refusal([](Rig<>& rig) {
         rig.add_box({5, 5, 0}, {a, a, a}, a);
         for (int body : {0, 1, 2})
           rig.scene.bodies[body].velocity = {body == 1 ? 104.0 : body == 0 ? 100.0 : 1e4, 0, 0};
       }),
       "start with different velocities, 104 and 100 m/s along x");
  says(refusal([](Rig<>& rig) { rig.hold(1, place("all"), still()); }),
       "and what it hangs on is not: hold body \"body 0\"");
  EXPECT_EQ(refusal([](Rig<>& rig) {
              for (int body : {0, 1}) rig.roller(body, "bottom", 1);
            }),
            "accepted");
  says(refusal([](Rig<>& rig) {
         for (int body : {0, 1}) rig.hold(body, place("bottom"), along(1, constant(body)));
       }),
       "what is tied moves as one");
}

/// Once what carries has left, the rest touches like others: a block falls onto what was below, and rests there.
TEST(Verify, M8_WhatIsFreeTouches) {
  Rig<> rig;
  auto rock_that_breaks = material(soft_rock);
  rock_that_breaks.joint = unbreakable(20 * soft_rock.young);
  rig.add_material(rock_that_breaks);
  double const b = 0.1, gap = 0.025;
  rig.add_box({0, 0, 0}, {b, b, b}, gap);
  rig.add_box({0, b, 0}, {b, b, b}, 0.02, 0, false);
  tie(rig, 0, 1);
  rig.hold(0, where([=](double, double y, double) { return y < -b / 2 + 1e-9; }), still());
  rig.scene.gravity = {0, -2000, 0};
  scene::Excavation out;
  out.body = 0, out.time = 10 * us;
  out.within = [=](double, double y, double) { return y > b / 2 - gap; };
  rig.scene.excavations.push_back(out);
  rig.scene.run.mass_damping = 200;
  rig.start();
  rig.run_for(3 * std::sqrt(2 * gap / 2000));
  double const lowest = b / 2 - gap + 0.5 * b;  // of the middle of the block, where it rests
  auto const bounds = rig.solver->now().bounds(1);
  EXPECT_NEAR(0.5 * (bounds[0][1] + bounds[1][1]), lowest, 0.1 * gap);
}

}  // namespace
}  // namespace fissure::verify
