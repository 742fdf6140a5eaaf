// Bodies that do not deform (body{ rigid = true }): their own motion, and what they do to others.
#include "rig.h"
#include "small_motions.h"

namespace fissure::verify {
namespace {

/// Something that deforms, far away: it sets the step.
void add_far_box(Rig<>& rig, double h) { rig.add_box({5, 5, 0}, {h, h, h}, h); }

struct Turning {
  V center = V::Zero();
  Vec3 momentum = Vec3::Zero();  // angular, about the centre, over the step that led here [kg m^2/s]
  Vec3 in_body = Vec3::Zero();   // the same along the edges of the box
  double strain = 0;             // largest change of a distance from the centre, over that distance
};
Turning turning(Rig<>& rig) {
  auto& model = rig.solver->model();
  auto const& body = model.rigid.at(0);
  auto const list = body.list.download();
  auto const u = model.vertices.u.download(), v = model.vertices.v.download();
  auto const arms = body.arm.download();
  Turning now;
  for (Index const i : list)
    for (int c = 0; c < D; ++c)
      now.center[c] += model.vertices.mass[i] / body.mass * (rig.place_of(i)[c] + u[i * D + c]);
  Mat<double, 3> turn = Mat<double, 3>::Zero(), square = turn;
  for (std::size_t k = 0; k < list.size(); ++k) {
    Index const i = list[k];
    Vec3 r = Vec3::Zero(), at_rest = r, velocity = r;
    for (int c = 0; c < D; ++c)
      r[c] = rig.place_of(i)[c] + u[i * D + c] - now.center[c], at_rest[c] = arms[k * D + c],
      velocity[c] = v[i * D + c];
    now.momentum += model.vertices.mass[i] * r.cross(velocity);
    if (at_rest.norm() > 1e-6) now.strain = std::max(now.strain, std::abs(r.norm() / at_rest.norm() - 1));
    turn += r * at_rest.transpose(), square += at_rest * at_rest.transpose();
  }
  for (int c = D; c < 3; ++c) turn(c, c) = square(c, c) = 1;
  now.in_body = (turn * square.inverse()).transpose() * now.momentum;
  return now;
}

/// A box that spins about (almost) its middle axis, which is unstable: it turns over again and again. Euler's equations
/// give the period of the momentum seen from the body (L. D. Landau, E. M. Lifshitz, Mechanics, section 37).
TEST(Verify, K1_ABoxTurnsOver) {
  Rig<> rig;
  double const h = 50 * mm, spin = 8e3;
  rig.add_material(material(steel));
  rig.add_box({0, 0, 0}, {0.2, 0.1, 0.05}, h);
  rig.scene.bodies[0].rigid = true;
  Vec3 const omega = flat ? Vec3(0, 0, spin) : Vec3(0.02 * spin, spin, 0.01 * spin);  // I of y lies between the others
  rig.scene.bodies[0].velocity_at = [=](double x, double y, double z) {
    Vec3 const around = omega.cross(Vec3(x, y, z));
    return std::array{around[0] + 3, around[1] + 3, around[2] + (flat ? 0 : 3)};
  };
  add_far_box(rig, h);
  rig.scene.bodies[1].velocity = {0, 0, 0};
  rig.start();
  auto const& body = rig.solver->model().rigid.at(0);
  Vec3 const L = body.inertia * omega;
  double period = 2 * std::numbers::pi / spin;  // 2D: of a turn
  if constexpr (!flat) {
    // About axes of growing inertia: I1 (x), I2 (y), I3 (z) of this box.
    double const I1 = body.inertia(0, 0), I2 = body.inertia(1, 1), I3 = body.inertia(2, 2);
    ASSERT_TRUE(I1 < I2 && I2 < I3);
    double const E2 = omega.dot(L), L2 = L.squaredNorm();
    bool const above = L2 > E2 * I2;
    double const p = above ? (I3 - I2) * (L2 - E2 * I1) : (I2 - I1) * (E2 * I3 - L2),
                 q = above ? (I2 - I1) * (E2 * I3 - L2) : (I3 - I2) * (L2 - E2 * I1);
    period = 4 * std::comp_ellint_1(std::sqrt(q / p)) / std::sqrt(p / (I1 * I2 * I3));
  }
  std::vector<double> crossings;  // of one component of the momentum in the body, upwards [s]
  double last = 0, last_time = 0, drift = 0, strain = 0, residual = 0;
  while (rig.solver->time() < 2.6 * period) {
    rig.step();
    auto const now = turning(rig);
    drift = std::max(drift, (now.momentum - L).norm() / L.norm()), strain = std::max(strain, now.strain);
    double const seen = now.in_body[1];
    if (last < 0 && seen >= 0) crossings.push_back(last_time + (rig.solver->time() - last_time) * last / (last - seen));
    last = seen, last_time = rig.solver->time();
    rig.solver->evaluate();
    auto const& ledger = rig.solver->energies();
    residual = std::max(residual, std::abs(ledger.residual()) / ledger.kinetic);
  }
  EXPECT_LT(drift, 1e-11);
  EXPECT_LT(strain, 1e-13);
  // The central difference: (omega dt)^2 of it.
  EXPECT_LT(residual, 2e-3);
  V const moved = V::Constant(3 * rig.solver->time());
  EXPECT_LT((turning(rig).center - moved).norm(), 1e-12);
  if constexpr (!flat) {
    ASSERT_GE(crossings.size(), 2u);
    EXPECT_NEAR((crossings[1] - crossings[0]) / period, 1, 2e-3);
  }
}

/// A push at an end: force over mass, and moment over inertia, as long as it has hardly turned; what the push gives is
/// kinetic.
TEST(Verify, K2_APushMovesAndTurns) {
  for (bool const weight : {false, true}) {
    Rig<> rig;
    double const force = 1000, length = 0.2;
    rig.add_material(material(rock));
    rig.add_box({0, 0, 0}, {length, 0.05, 0.05}, 0.025);
    rig.scene.bodies[0].rigid = true;
    rig.scene.bodies[0].mesh.cells = "simplex", rig.scene.bodies[0].mesh.integration = "one_point";
    add_far_box(rig, 0.05);
    rig.scene.out_of_plane = 0.05;
    scene::Force push;
    push.body = 0, push.point = Vec3(length / 2, 0, 0), push.value = along(1, constant(force));
    rig.scene.forces.push_back(push);
    if (weight) rig.scene.gravity = {0, -9.81, 0};
    rig.start();
    auto const& body = rig.solver->model().rigid.at(0);
    double const m = rock.density * length * 0.05 * 0.05;
    EXPECT_NEAR(body.mass, m, 1e-12 * m);
    rig.run_for(1e-3);
    double const t = rig.solver->time(), a = force / m - (weight ? 9.81 : 0);
    auto const now = turning(rig);
    EXPECT_NEAR(now.center[1], a * t * t / 2, 1e-9 * a * t * t);
    // The velocity is that of half a step ago.
    double const turned = force * length / 2 * (t - rig.solver->dt() / 2);
    EXPECT_NEAR(now.momentum[2], turned, 1e-4 * turned);  // the arm shortens by cos(angle), here of 0.01
    rig.solver->evaluate();
    auto const& ledger = rig.solver->energies();
    EXPECT_LT(std::abs(ledger.residual()), 1e-6 * ledger.kinetic);
    EXPECT_NEAR(ledger.kinetic, ledger.external - ledger.gravity, 1e-6 * ledger.kinetic);
  }
}

/// A punch that a hold drives presses a confined block: stress is E' times strain, less what contact gives way; the
/// reaction of the hold is what it pushes with.
TEST(Verify, K3_APunchPressesLikeAPlate) {
  Rig<> rig;
  double const h = 0.1, speed = 0.02, L = 1;
  auto stuff = material(rock);
  stuff.contact = laws::ContactLaw{20 * rock.confined(), 0};
  rig.add_material(stuff);
  rig.add_box({0, 0, 0}, {0.4, L, 0.4}, h);
  rig.add_box({0, L / 2 + 0.1, 0}, {0.4, 0.2, 0.4}, h);
  rig.scene.bodies[1].rigid = true;
  rig.scene.out_of_plane = 0.4;
  for (auto const* side : {"left", "right"}) rig.roller(0, side, 0);
  for (auto const* side : {"front", "back"}) rig.roller(0, side, 2);
  rig.roller(0, "bottom", 1);
  scene::Directions down = still();
  down[1] = constant(-speed);
  rig.hold(1, place("all"), down);
  int const punch = static_cast<int>(rig.scene.holds.size()) - 1;
  // After twenty crossings waves have sunk to 0.2 % of it, and damping drags by 1.1 %.
  rig.scene.run.mass_damping = 0.2 * 2 * std::numbers::pi * rock.c_P() / (4 * L);
  rig.start();
  EXPECT_TRUE(rig.solver->model().rigid.empty());  // nothing is free
  rig.run_for(20 * L / rock.c_P());
  rig.solver->evaluate();
  double const pushed = -rig.solver->motion().reaction(punch)[1] / (0.4 * 0.4), strain = speed * rig.solver->time() / L;
  // Contact of 20 E' gives way by some of a cell's tenth.
  EXPECT_NEAR(pushed / (rock.confined() * strain), 1, 0.03);
  // The whole face is pressed, and carries all of it: cells below an edge overlap by the square of the depth alone.
  auto const touch = rig.solver->now().touch(0, 1);
  double const force = -rig.solver->now().contact_force(0, 1)[1];
  EXPECT_NEAR(touch.area, 0.4 * 0.4, 1e-6);
  EXPECT_NEAR(touch.push / force, 1, 0.01);
  EXPECT_NEAR(rig.solver->now().touch(1, 0).area, 0.4 * 0.4, 1e-6);
  EXPECT_LT(std::abs(rig.solver->energies().residual()), 1e-3 * rig.solver->energies().external);
}

/// A weight that a force drives onto a block does there what a plate of its mass does, which has no cells.
TEST(Verify, K4_AWeightIsAPlate) {
  double const h = 0.1, force = 1e6, L = 1;
  auto const run = [&](bool plate) {
    auto rig = std::make_unique<Rig<>>();
    auto stuff = material(rock);
    stuff.contact = laws::ContactLaw{rock.confined(), 0};
    rig->scene.run.safety = 0.4;  // contact begins within a step, and gives or takes the less the shorter it is
    rig->add_material(stuff);
    rig->add_box({0, 0, 0}, {0.4, L, 0.4}, h);
    rig->roller(0, "bottom", 1);
    rig->scene.out_of_plane = 0.4;
    Vec3 const middle{0, L / 2 + 0.1, 0}, size{0.4, 0.2, 0.4};
    double const mass = rock.density * 0.2 * 0.4 * 0.4;
    if (plate) {
      scene::Plate weight;
      weight.name = "weight", weight.box = {middle, size}, weight.force = along(1, constant(-force)),
      weight.mass = mass;
      rig->scene.plates.push_back(weight);
    } else {
      rig->add_box(middle, size, h);
      rig->scene.bodies[1].rigid = true;
      scene::Force push;
      push.body = 1, push.where = place("top"), push.value = along(1, constant(-force));
      rig->scene.forces.push_back(push);
    }
    rig->start();
    return rig;
  };
  auto const weight = run(false), plate = run(true);
  double worst = 0, most = 0, residual = 0;
  for (int k = 1; k <= 40; ++k) {
    double const until = k * 0.1 * L / rock.c_P();
    double sink[2];
    for (auto* rig : {weight.get(), plate.get()}) {
      rig->run_for(until - rig->solver->time());
      double top = 0, count = 0;
      auto const u = rig->solver->model().vertices.u.download();
      rig->each_corner([&](Index e, int, Index vertex) {
        if (rig->solver->model().elements.body[e] == 0 && rig->place_of(vertex)[1] > L / 2 - 1e-9)
          top += u[static_cast<std::size_t>(vertex) * D + 1], ++count;
      });
      sink[rig == plate.get()] = top / count;
    }
    worst = std::max(worst, std::abs(sink[0] - sink[1])), most = std::max(most, std::abs(sink[1]));
    weight->solver->evaluate();
    auto const& ledger = weight->solver->energies();
    residual = std::max(residual, std::abs(ledger.residual()));
    weight->solver->advance();  // evaluated twice, contact's work would be booked twice
  }
  // Both contacts give way, by overlaps of cells here and of corners there: by half a cell's share of what the block
  // does.
  EXPECT_LT(worst, 0.05 * most);
  EXPECT_LT(residual, 5e-3 * force * most);
}

/// A disc (3D: a cylinder that lies) rolls down a slope without sliding: with 2/3 of the acceleration of what slides.
TEST(Verify, K5_ADiscRollsDownASlope) {
  Rig<> rig;
  double const radius = 0.1, slope = 0.3, h = radius / 16;
  auto stuff = material(soft_rock);
  stuff.contact = laws::ContactLaw{soft_rock.confined(), 0.9};
  rig.add_material(stuff);
  rig.add_body({scene::Disc{{0, radius, 0}, radius, 0.02}, {}}, h, false);
  rig.scene.bodies[0].rigid = true;
  add_far_box(rig, 0.05);
  rig.scene.out_of_plane = 0.02;
  scene::Wall wall;
  wall.name = "slope", wall.normal = Vec3(0, 1, 0), wall.point = Vec3(0, 0, 0);
  rig.scene.walls.push_back(wall);
  double const g = 9810;  // so that it takes a second's thousandth
  rig.scene.gravity = {g * std::sin(slope), -g * std::cos(slope), 0};
  rig.start();
  double const time = 4e-3;
  rig.run_for(time);
  auto const now = turning(rig);
  auto const& body = rig.solver->model().rigid.at(0);
  double const share = 1 / (1 + body.inertia(2, 2) / (body.mass * radius * radius)), t = rig.solver->time();
  EXPECT_NEAR(share, 2.0 / 3, 0.01);
  EXPECT_NEAR(now.center[0] / (share * g * std::sin(slope) * t * t / 2), 1, 0.05);
  rig.solver->evaluate();
  auto const& ledger = rig.solver->energies();
  EXPECT_LT(std::abs(ledger.residual()), 5e-3 * ledger.kinetic);
}

/// What is held in part is refused; what one direction leaves free does not turn; restarts go on in the same bits.
TEST(Verify, K6_WhatHoldsDoToIt) {
  auto const fill = [](Rig<>& rig) {
    rig.add_material(material(rock));
    rig.add_box({0, 0, 0}, {0.2, 0.1, 0.1}, 0.05);
    rig.scene.bodies[0].rigid = true;
    rig.scene.bodies[0].velocity = {1, 2, 0};
    add_far_box(rig, 0.05);
  };
  {
    Rig<> rig;
    fill(rig);
    rig.hold(0, place("left"), still());
    try {
      rig.start();
      FAIL() << "a part of a rigid body is held";
    } catch (Error const& error) {
      EXPECT_NE(std::string(error.what()).find("is rigid"), std::string::npos);
    }
  }
  Rig<> rig;
  fill(rig);
  rig.hold(0, place("all"), along(0, constant(5)));  // y is free
  scene::Force push;
  push.body = 0, push.point = Vec3(0.1, 0.05, 0), push.value = along(1, constant(1e3));
  rig.scene.forces.push_back(push);
  rig.start();
  rig.run_for(5e-5);
  State const state = rig.solver->save();
  rig.run_for(5e-5);
  auto const now = turning(rig);
  double const t = rig.solver->time(), m = rig.solver->model().rigid.at(0).mass;
  EXPECT_NEAR(now.center[0], 5 * t, 1e-12);
  EXPECT_NEAR(now.center[1], 2 * t + 1e3 / m * t * t / 2, 1e-12);
  EXPECT_LT(now.strain, 1e-13);
  EXPECT_LT(now.momentum.norm(), 1e-12);
  Rig<> other;
  fill(other);
  other.hold(0, place("all"), along(0, constant(5)));
  other.scene.forces.push_back(push);
  other.start();
  other.solver->restore(state);
  other.run_for(rig.solver->time() - other.solver->time());
  EXPECT_TRUE(other.solver->save() == rig.solver->save());
}

}  // namespace
}  // namespace fissure::verify
