// The parts that a step is made of, each alone: who hangs together, force slots, rigid bodies, the ledger's terms and
// the fields of a frame.
#include <set>

#include "contact/bonds.h"
#include "contact/candidates.h"
#include "contact/force_slots.h"
#include "contact/list_age.h"
#include "contact/rigid_bodies.h"
#include "rig.h"

namespace fissure::verify {
namespace {

scene::Material breakable() {
  auto stuff = material(rock);
  stuff.joint = joint(25 * MPa, 50 * MPa, 500, 1500, 20 * rock.young);
  return stuff;
}

TEST(Verify, Stages_AFaceIsOneNumberAndBack) {
  for (Index const element : {0, 1, 12345678})
    for (int face = 0; face < C; ++face) {
      FaceId const id{element, face};
      EXPECT_EQ(FaceId::unpacked(id.packed()), id);
      std::set<int> corners{face};
      for (int i = 0; i < D; ++i) corners.insert(id.corner(i));
      EXPECT_EQ(corners.size(), static_cast<std::size_t>(C));  // all but the one across
    }
}

/// Corners of element e that a walk over whole joints about a node reaches from element `from`: nothing of Bonds' own.
std::set<Index> reached(model::Model<D, double> const& model, std::set<std::pair<Index, int>> const& loose, int node,
                        Index from) {
  auto const has = [&](Index e) {
    auto const first = model.elements.node.begin() + static_cast<std::ptrdiff_t>(e) * C;
    return std::find(first, first + C, node) != first + C;
  };
  std::set<Index> all{from};
  std::vector<Index> next{from};
  while (!next.empty()) {
    Index const e = next.back();
    next.pop_back();
    // Parts of a block share its corners.
    for (Index f = model.cell_head(e); f < model.cell_head(e) + model.cell_parts(model.cell_head(e)); ++f)
      if (has(f) && all.insert(f).second) next.push_back(f);
    for (int a = 0; a < C; ++a) {
      FaceId const here{e, a}, there = model.neighbour(here);
      FaceId const lower = there.element < e ? there : here;
      bool const about = model.elements.node[static_cast<std::size_t>(e) * C + a] != node && has(there.element);
      if (there == here || !about || loose.contains({lower.element, lower.face})) continue;
      if (all.insert(there.element).second) next.push_back(there.element);
    }
  }
  return all;
}

TEST(Verify, Stages_BondsAreThoseOfAWalkOverWholeJoints) {
  Rig<> rig;
  rig.add_material(breakable());
  double const h = 5 * mm;
  rig.add_box({0, 0, 0}, {3 * h, 3 * h, 2 * h}, h, 0, false);
  auto& model = rig.start().model();
  Bonds<D, double> bonds(rig.mesh, model);
  std::mt19937 random(7);
  std::set<std::pair<Index, int>> loose;
  for (int round = 0; round < 6; ++round) {
    for (Index e = 0; e < model.elements.count; ++e)
      for (int a = 0; a < C && model.elements.cell[e] >= 0; ++a)
        if (FaceId const face{e, a}; model.neighbour(face).element > e && random() % 6 == 0) {
          EXPECT_EQ(bonds.loosen(face), loose.insert({e, a}).second);
          EXPECT_TRUE(bonds.bare(face) && bonds.bare(model.neighbour(face)) && bonds.exposed(e));
        }
    bonds.connect();
    int parted = 0;
    for (Index a = 0; a < model.elements.count; ++a)
      for (Index b = 0; b < a; ++b) {
        if (model.elements.cell[a] < 0 || model.elements.cell[b] < 0) continue;
        bool expected = false, near = false;
        for (int i = 0; i < C; ++i)
          for (int j = 0; j < C; ++j)
            if (int const node = model.elements.node[static_cast<std::size_t>(a) * C + i];
                node == model.elements.node[static_cast<std::size_t>(b) * C + j])
              near = true, expected = expected || reached(model, loose, node, a).contains(b);
        ASSERT_EQ(bonds.hang_together(a, b), expected) << a << " " << b << " round " << round;
        parted += near && !expected;
      }
    EXPECT_TRUE(parted > 0 || round < 5);
  }
}

/// Every touched vertex gets the sum of its own slots, and nobody else anything; the work is force times velocity.
TEST(Verify, Stages_ForceSlotsSumAtTheirVertices) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {10 * mm, 10 * mm, 10 * mm}, 5 * mm);
  rig.scene.bodies[0].velocity = {2, -3, 5};
  auto& model = rig.start().model();
  std::mt19937 random(11);
  std::vector<Index> vertex_of_slot, all;
  for (int k = 0; k < 40; ++k) vertex_of_slot.push_back(static_cast<Index>(random() % 7)), all.push_back(k);
  ForceSlots<D, double> slots;
  EXPECT_TRUE(slots.empty());
  slots.place(rig.device, 40);
  slots.list(rig.device, all, vertex_of_slot, model.vertices.count);
  slots.set_room(rig.device, std::vector<double>(slots.vertices().size(), 0));
  std::vector<V> sum(model.vertices.count, V::Zero());
  std::vector<double> stiffness(model.vertices.count, 0);
  double stiffest = 0, work = 0;
  for (Index k = 0; k < 40; ++k) {
    for (int c = 0; c < D; ++c) {
      double const f = static_cast<double>(random() % 1000) - 500;
      slots.force(k)[c] = f;
      sum[vertex_of_slot[k]][c] += f;
      work += 0.25 * f * rig.scene.bodies[0].velocity[c];
    }
    *slots.stiffness(k) = 1000.0 + k;
    stiffness[vertex_of_slot[k]] += 1000.0 + k;
  }
  for (Index i = 0; i < model.vertices.count; ++i)
    if (model.vertices.mass[i] > 0) stiffest = std::max(stiffest, stiffness[i] / model.vertices.mass[i]);
  auto const before = rig.forces();
  EXPECT_NEAR(slots.add(rig.device, model), stiffest, 1e-12 * stiffest);
  EXPECT_NEAR(slots.work(rig.device, model, 0.25), work, 1e-9 * std::abs(work));
  auto const after = rig.forces();
  for (Index i = 0; i < model.vertices.count; ++i)
    EXPECT_LT((after[i] - before[i] - sum[i]).norm(), 1e-12 * (1 + sum[i].norm())) << i;  // rounding of few terms
}

/// What is found is listed; what held on by friction stays, with its spring, until that has let go.
TEST(Verify, Stages_CandidatesKeepTheirSprings) {
  Rig<> rig;
  constexpr int size = kernels::spring_size<D>;
  Candidates<D, double> list{false};
  std::vector<double> springs(3 * size, 0);
  springs[0 * size] = 0.25;   // (1, 2) is stretched, and
  springs[0 * size + D] = 7;  // its spring holds, as does
  springs[2 * size + D] = 9;  // (3, 8)
  list.set(rig.device, {{1, 2}, {1, 5}, {3, 8}}, springs);
  list.renew(rig.device, {{0, 4}, {1, 2}, {6, 7}});
  std::vector<contact::ElementPair> const expected{{0, 4}, {1, 2}, {3, 8}, {6, 7}};
  ASSERT_EQ(list.pairs.size(), expected.size());
  EXPECT_TRUE(list.pairs == expected && list.count == 4);
  auto const carried = list.spring.download();
  EXPECT_EQ(carried[1 * size], 0.25);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(carried[k * size + D], k == 1 ? 7 : k == 2 ? 9 : 0) << k;
  EXPECT_EQ(list.wake.size(), 4u);

  State state;
  list.save(state, "pair");
  Candidates<D, double> other{false};
  other.restore(rig.device, state, "pair", 9, 9);
  EXPECT_TRUE(other.pairs == expected && other.spring.download() == carried);
  EXPECT_THROW(other.restore(rig.device, state, "pair", 8, 8), Error);  // there is no element 8
  state["pair springs"].pop_back();
  EXPECT_THROW(other.restore(rig.device, state, "pair", 9, 9), Error);
}

/// A list is stale when two vertices have moved by its buffer relative to each other, or will have with the next step.
TEST(Verify, Stages_AListIsGoodUntilThingsHaveMovedByItsBuffer) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {10 * mm, 10 * mm, 10 * mm}, 5 * mm);
  auto& model = rig.start().model();
  RigidBodies<D, double> const nothing(rig.device, rig.scene, Vec3(0, 0, 0));
  std::vector<Index> all;
  for (Index vertex = 0; vertex < model.vertices.count; ++vertex)
    if (model.vertices.mass[vertex] > 0) all.push_back(vertex);
  ListAge<D, double> age(rig.mesh);
  age.begin_list();
  auto u = model.vertices.u.download();
  age.follow(rig.device, all, u, nothing);
  double const buffer = age.buffer(), least = 0.05 * 0.2 * 5 * mm;
  EXPECT_NEAR(buffer, least, least);  // the shortest edges are 5 mm, slanted ones longer
  auto const moved = [&](double everything, double one, double speed) {
    auto now = u;
    std::vector<double> v(u.size(), 0);
    for (Index vertex : all) now[static_cast<std::size_t>(vertex) * D] = everything;
    now[static_cast<std::size_t>(all[3]) * D] += one;
    v[static_cast<std::size_t>(all[3]) * D] = speed;
    model.vertices.u.upload(now), model.vertices.v.upload(v);
    return age.advance(rig.device, model, nothing, 0, 1e-6, 1e-6);
  };
  EXPECT_FALSE(moved(0, 0, 0));
  EXPECT_FALSE(moved(100 * buffer, 0, 0));  // all together
  EXPECT_FALSE(moved(0, 0.9 * buffer, 0));
  EXPECT_TRUE(moved(0, 1.1 * buffer, 0));
  EXPECT_FALSE(moved(0, 0.5 * buffer, 0.4 * buffer / 1e-6));
  EXPECT_TRUE(moved(0, 0.5 * buffer, 0.6 * buffer / 1e-6));
  EXPECT_NEAR(age.path(), buffer, 1e-12 * buffer);  // 0.4 and 0.6 of it, at their speeds
}

TEST(Verify, Stages_PlatesMoveByTheirVelocityAtTheMiddleOfSteps) {
  Rig<> rig;
  rig.scene.plates.resize(2);
  rig.scene.plates[0].box = {{1, 2, 3}, {2, 2, 2}};
  rig.scene.plates[0].velocity = {of_time([](double t) { return 3 * t; }), std::nullopt, std::nullopt};
  rig.scene.plates[1].box = {{-4, 0, 0}, {1, 1, 1}};
  RigidBodies<D, double> bodies(rig.device, rig.scene, Vec3(1, 0, 0));
  for (int step = 0; step < 10; ++step) bodies.move(0.1 * step, 0.1);
  EXPECT_NEAR(bodies.displacements()[0][0], 1.5, 1e-14);  // the midpoint rule is exact for 3 t^2/2
  EXPECT_EQ(bodies.displacements()[1], Vec3(0, 0, 0));
  auto const boxes = bodies.boxes_at(2);
  EXPECT_EQ(boxes[0].low[0], -1);  // about the origin (1, 0, 0)
  EXPECT_EQ(boxes[0].velocity[0], 6);
  EXPECT_NEAR(boxes[0].displacement[0], 1.5, 1e-14);
  EXPECT_EQ(boxes[1].high[0], -4.5);
}

/// Each vote alone: bodies at rest, contact that comes and parts, the user's own step, and where the run ends.
TEST(Verify, Stages_TheStepIsTheLeastOfItsVotes) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {20 * mm, 10 * mm, 10 * mm}, 5 * mm);
  rig.start();
  auto& model = rig.solver->model();
  SpringBeds<D> const none;
  std::vector<Index> const names(model.elements.count, 0);
  using Step = StableStep<D, double>;
  auto const moment = [&](long step, double excess = 0, double end = 1) {
    return Step::Moment{step, 0, end, none, excess, false};
  };
  Step step(rig.device, rig.scene, model, names);
  step.start(moment(0));
  double const bodies = step.limit().stable, safety = rig.scene.run.safety;
  EXPECT_DOUBLE_EQ(step.limit().automatic, safety * bodies);
  EXPECT_NEAR(bodies, 2 / std::sqrt(step.top_eigenvalue()), 0.1 * bodies);  // with what the iteration has not reached

  double const excess = 40 / (bodies * bodies);  // ten times what bodies have
  step.heed_contact(moment(1, excess));
  double const frequency = 4 / (bodies * bodies) + 1.1 * excess;
  EXPECT_NEAR(step.limit().stable, 2 / std::sqrt(frequency), 1e-12 * bodies);
  EXPECT_LT(step.limit().automatic, safety * step.limit().stable * (1 + 1e-12));
  EXPECT_EQ(step.limit().owner, "contact");
  double const touched = step.limit().automatic;
  step.heed_contact(moment(2, 0.5 * excess));  // less than was made room for: nothing changes
  EXPECT_EQ(step.limit().automatic, touched);

  step.choose(moment(3, 0, 2.5 * touched));  // three like steps end with the run
  EXPECT_NEAR(step.limit().dt, 2.5 / 3 * touched, 1e-12 * touched);
  rig.scene.run.dt = 0.1 * touched;
  step.choose(moment(4));
  EXPECT_NEAR(step.limit().dt, 0.1 * touched, 1e-6 * touched);

  rig.scene.run.dt.reset();
  rig.scene.run.mass_damping = 1e9;
  Step damped(rig.device, rig.scene, model, names);
  damped.start(moment(0));
  EXPECT_NEAR(damped.limit().stable, stable_step(4 / (bodies * bodies), 1e9), 1e-9 * bodies);
  rig.scene.run.mass_damping = 0;
}

TEST(Verify, Stages_TheLedgerHasTheEnergiesThatScenesAskFor) {
  Rig<> rig;
  rig.add_material(material(rock));
  rig.add_box({0, 0, 0}, {10 * mm, 10 * mm, 10 * mm}, 5 * mm);
  rig.start().evaluate();
  std::set<std::string> names{"residual"}, asked;
  for (auto const& term : Ledger::terms) names.insert(term.name);
  for (auto const& name : scene::energy_names()) {
    asked.insert(name);
    EXPECT_NO_THROW(rig.solver->now().energy(name)) << name;
  }
  EXPECT_EQ(names, asked);
  Ledger ledger;  // each term counts once, with its sign
  double left = ledger.start = 1000;
  for (std::size_t k = 0; k < Ledger::terms.size(); ++k) {
    auto const& term = Ledger::terms[k];
    ledger.*term.value = std::pow(2.0, static_cast<double>(k));
    left += (term.kind == Ledger::Kind::given ? 1 : -1) * std::pow(2.0, static_cast<double>(k));
  }
  EXPECT_EQ(ledger.residual(), left);
}

TEST(Verify, Stages_AFrameHasEveryFieldThatScenesAskFor) {
  Rig<> rig;
  rig.add_material(breakable());
  rig.add_box({0, 0, 0}, {10 * mm, 10 * mm, 10 * mm}, 5 * mm);
  rig.start().evaluate();
  for (auto const& name : scene::output_fields()) {
    auto const frame = rig.solver->frame({name});
    ASSERT_EQ(frame.point_fields.size() + frame.cell_fields.size(), 1u) << name;
    auto const& field = frame.point_fields.empty() ? frame.cell_fields[0] : frame.point_fields[0];
    EXPECT_EQ(field.name, name);
    EXPECT_FALSE(field.values.empty()) << name;
  }
  auto const all = rig.solver->frame(scene::output_fields());
  EXPECT_EQ(all.point_fields.size() + all.cell_fields.size(), scene::output_fields().size());
}

}  // namespace
}  // namespace fissure::verify
