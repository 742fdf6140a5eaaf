// Pair search against brute force, springs and slots carried from list to list.
#include "contact/broad_phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.h"
#include "kernels/contact_sums.h"
#include "kernels/rigid_contact.h"

namespace fissure {
namespace {

template <class T>
class PairSearch : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(PairSearch, Dimensions);

// ---------------------------------------------------------------------------------------------------------------
// gathering
TYPED_TEST(PairSearch, VerticesSumTheirSlotsInOrder) {
  constexpr int D = TypeParam::value;
  std::vector<Index> const vertex_of_slot{4, 1, 4, 4, 1, 0};
  auto const lists = contact::slot_lists(vertex_of_slot, 6);
  EXPECT_EQ(lists.vertex, (std::vector<Index>{0, 1, 4}));
  EXPECT_EQ(lists.first, (std::vector<Index>{0, 1, 3, 6}));
  EXPECT_EQ(lists.slot, (std::vector<Index>{5, 1, 4, 0, 2, 3}));
  std::vector<double> force(6 * D), stiffness(6), inverse_mass{1, 10, 1, 1, 1, 1}, f(6 * D, 1.0), sum(3 * D);
  std::vector<double> const room{0, 20, 0};  // of the vertices 0, 1 and 4
  for (int s = 0; s < 6; ++s) {
    stiffness[s] = s + 1;
    for (int c = 0; c < D; ++c) force[s * D + c] = std::pow(10, s) * (c + 1);
  }
  Sums<1> largest{0};
  kernels::AddContact<D, double> const add{.vertex = lists.vertex.data(),
                                           .first = lists.first.data(),
                                           .slot = lists.slot.data(),
                                           .slot_force = force.data(),
                                           .slot_stiffness = stiffness.data(),
                                           .inverse_mass = inverse_mass.data(),
                                           .room = room.data(),
                                           .force = f.data(),
                                           .sum_force = sum.data()};
  for (Index t = 0; t < 3; ++t) add.template operator()<double>(t, largest);
  for (int c = 0; c < D; ++c) {
    EXPECT_EQ(f[0 * D + c], 1 + 100000 * (c + 1));
    EXPECT_EQ(f[1 * D + c], 1 + 10010 * (c + 1));
    EXPECT_EQ(f[4 * D + c], 1 + 1101 * (c + 1));
    EXPECT_EQ(f[2 * D + c], 1);
    EXPECT_EQ(sum[1 * D + c], 10010 * (c + 1));
  }
  EXPECT_EQ(largest[0], 50);  // (2 + 5) times 10 less its room of 20, more than 1 + 3 + 4 and 6
}

TYPED_TEST(PairSearch, SpringsFollowTheirPairs) {
  constexpr int D = TypeParam::value;
  std::vector<contact::ElementPair> const before{{0, 3}, {1, 2}, {5, 9}}, after{{0, 2}, {0, 3}, {4, 5}, {5, 9}};
  std::vector<double> springs;
  for (int i = 0; i < 3 * D; ++i) springs.push_back(i + 1);
  auto const carried = contact::carry_springs(std::vector<double>(D, -1), before, springs, after);
  for (int c = 0; c < D; ++c) {
    EXPECT_EQ(carried[c], -1);
    EXPECT_EQ(carried[D + c], springs[c]);
    EXPECT_EQ(carried[2 * D + c], -1);
    EXPECT_EQ(carried[3 * D + c], springs[2 * D + c]);
  }
}

TYPED_TEST(PairSearch, DriftIsTheLargestMoveAndSpeedOnEachAxis) {
  constexpr int D = TypeParam::value;
  std::vector<Index> const vertex{0, 1, 3};
  std::vector<double> const start(3 * D, 1.0);
  std::vector<double> u(4 * D, 8.0), v(4 * D, 2.0);  // a common translation of 7 at the speed 2
  u[1 * D] += 0.25, u[3 * D] -= 0.5, v[3 * D] = -1;
  u[2 * D] = 1000;  // not listed
  Sums<4 * D> largest;
  largest.fill(-1e300);
  kernels::DriftSince<D, double> const drift{vertex.data(), start.data(), u.data(), v.data()};
  for (Index k = 0; k < 3; ++k) drift.template operator()<double>(k, largest);
  EXPECT_EQ(largest[0] + largest[D], 0.75);
  EXPECT_EQ(largest[1] + largest[D + 1], 0);
  EXPECT_EQ(largest[2 * D] + largest[3 * D], 3);
  EXPECT_EQ(largest[2 * D + 1] + largest[3 * D + 1], 0);
}

// ------------------------------------------------------------------------------------------------------------- pair
// search
template <int D>
using Boxes = std::vector<contact::Bounds<D>>;

template <int D>
contact::Bounds<D> box(std::array<double, D> const& center, double half) {
  contact::Bounds<D> b;
  for (int c = 0; c < D; ++c) b.low[c] = center[c] - half, b.high[c] = center[c] + half;
  return b;
}

template <int D>
std::vector<contact::ElementPair> brute_force(Boxes<D> const& boxes) {
  std::vector<contact::ElementPair> pairs;
  for (Index p = 0; p < static_cast<Index>(boxes.size()); ++p)
    for (Index q = p + 1; q < static_cast<Index>(boxes.size()); ++q) {
      bool meet = true;
      for (int c = 0; c < D; ++c)
        meet = meet && boxes[p].low[c] <= boxes[q].high[c] && boxes[q].low[c] <= boxes[p].high[c];
      if (meet) pairs.push_back({p, q});
    }
  return pairs;
}

/// n boxes at random in a cube of side `space`; half sizes from `least` to `most`, evenly over orders of magnitude.
template <int D>
Boxes<D> cloud(int n, double space, double least, double most, unsigned seed = 1) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Boxes<D> boxes;
  for (int i = 0; i < n; ++i) {
    std::array<double, D> center;
    for (double& x : center) x = space * unit(rng);
    boxes.push_back(box<D>(center, least * std::pow(most / least, unit(rng))));
  }
  return boxes;
}

TYPED_TEST(PairSearch, SearchAgreesWithBruteForceD6) {
  constexpr int D = TypeParam::value;
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<std::pair<std::string, Boxes<D>>> cases;
  cases.emplace_back("even sizes", cloud<D>(2000, 10, 0.2, 0.3));
  cases.emplace_back("size ratio 1000", cloud<D>(2000, 10, 0.002, 2));
  cases.emplace_back("all in one cell", cloud<D>(400, 1e-6, 1, 1.001));
  cases.emplace_back("far flung", cloud<D>(1000, 1e15, 0.2, 0.3));
  cases.emplace_back("coincident", Boxes<D>(200, box<D>({}, 1)));
  cases.emplace_back("touching on a grid", Boxes<D>{});
  for (int i = 0; i < 1000; ++i) {
    std::array<double, D> center{};
    for (int c = 0, k = i; c < D; ++c, k /= 10) center[c] = k % 10;
    cases.back().second.push_back(box<D>(center, 0.5));
  }
  cases.emplace_back("nested", Boxes<D>{});
  for (int i = 0; i < 60; ++i) cases.back().second.push_back(box<D>({}, std::pow(2.0, -i)));
  cases.emplace_back("slivers", cloud<D>(1000, 10, 0.001, 0.002));
  for (auto& b : cases.back().second) b.high[std::abs(static_cast<int>(100 * b.low[0])) % D] += 3 * std::abs(unit(rng));
  cases.emplace_back("flat and points", cloud<D>(500, 3, 0.1, 0.2));
  for (std::size_t i = 0; i < 500; ++i) {
    auto& b = cases.back().second[i];
    if (i % 2) b.high[0] = b.low[0];
    if (i % 4 == 3) b.high = b.low;
  }
  cases.emplace_back("fragments around a far origin", cloud<D>(1000, 10, 0.1, 1));
  for (auto& b : cases.back().second)
    for (int c = 0; c < D; ++c) b.low[c] += 1e6, b.high[c] += 1e6;
  cases.emplace_back("beyond any cell number", cloud<D>(50, 1e300, 1e-3, 1e-3));
  cases.emplace_back("one giant among crumbs", cloud<D>(2000, 10, 0.01, 0.02));
  cases.back().second.push_back(box<D>({}, 1e4));
  cases.emplace_back("none", Boxes<D>{});
  cases.emplace_back("one", Boxes<D>{box<D>({}, 1)});
  for (auto const& [name, boxes] : cases) {
    auto all = brute_force<D>(boxes);
    EXPECT_EQ(contact::overlapping_pairs<D>(boxes), all) << name;
    std::vector<char> wanted(boxes.size());
    for (auto& w : wanted) w = unit(rng) > 0.8;
    std::erase_if(all, [&](auto const& pair) { return !wanted[pair.a] && !wanted[pair.b]; });
    EXPECT_EQ(contact::overlapping_pairs<D>(boxes, wanted), all) << name << ", some wanted";
    for (std::size_t k = 0, left = 5; k < wanted.size(); ++k) wanted[k] = wanted[k] && left > 0 ? (--left, 1) : 0;
    std::erase_if(all, [&](auto const& pair) { return !wanted[pair.a] && !wanted[pair.b]; });
    EXPECT_EQ(contact::overlapping_pairs<D>(boxes, wanted), all) << name << ", five wanted";
  }
}

/// n boxes of which each octave of sizes fills the space about as much as any other.
template <int D>
Boxes<D> graded_cloud(int n, double ratio) {
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> half;
  double filled = 0;
  for (int i = 0; i < n; ++i) {
    half.push_back(std::pow(1 + unit(rng) * (std::pow(ratio, -D) - 1), -1.0 / D));
    filled += std::pow(2 * half.back(), D);
  }
  Boxes<D> boxes;
  for (double h : half) {
    std::array<double, D> center;
    for (double& x : center) x = std::pow(filled, 1.0 / D) * unit(rng);
    boxes.push_back(box<D>(center, h));
  }
  return boxes;
}

TYPED_TEST(PairSearch, SearchIsLinearAtAnyRatioOfSizes) {
  constexpr int D = TypeParam::value;
  for (double ratio : {1.0, 10.0, 1000.0}) {
    double each[2], found[2];
    int const n[2] = {4000, 64000};
    for (int i : {0, 1}) {
      contact::SearchCost cost;
      auto const pairs = contact::overlapping_pairs<D>(graded_cloud<D>(n[i], ratio), {}, 1.5, &cost);
      EXPECT_LE(cost.entries, (1LL << D) * n[i]);
      each[i] = double(cost.comparisons) / n[i];
      found[i] = double(pairs.size()) / n[i];
    }
    EXPECT_LT(each[1], 1.2 * each[0] + (D == 2 ? 10 : 50))
        << "ratio " << ratio;  // more boxes bring the rare large ones
    EXPECT_LT(each[1], 12 * found[1]) << "ratio " << ratio;
    this->RecordProperty("comparisons_and_pairs_per_box_ratio_" + std::to_string(static_cast<int>(ratio)),
                         std::to_string(each[0]) + " " + std::to_string(found[0]) + ", " + std::to_string(each[1]) +
                             " " + std::to_string(found[1]));
  }
}

TYPED_TEST(PairSearch, SearchRefusesBoxesWithoutAPlace) {
  constexpr int D = TypeParam::value;
  auto boxes = cloud<D>(5, 10, 1, 1);
  boxes[3].low[0] = std::numeric_limits<double>::quiet_NaN();
  try {
    contact::overlapping_pairs<D>(boxes);
    FAIL() << "a box that is not a number was accepted";
  } catch (Error const& error) {
    EXPECT_STREQ(
        error.what(),
        "contact search: box 3 of 5 is not finite (its nodes have no place any more: the run has become unstable); "
        "use a smaller time step or a smaller contact penalty");
  }
}

TYPED_TEST(PairSearch, RigidBodiesFindTheirElements) {
  constexpr int D = TypeParam::value;
  Boxes<D> const boxes{box<D>({0, 0}, 1), box<D>({0, 5}, 1), box<D>({9, 0}, 1)};
  using Pairs = std::vector<contact::ElementPair>;
  EXPECT_EQ((contact::pairs_with_boxes<D>(boxes, {box<D>({0, 3}, 1), box<D>({10, 0}, 1)})), (Pairs{{1, 0}, {2, 1}}));
  Vec<double, D> const up = Vec<double, D>::Unit(1);
  EXPECT_EQ((contact::pairs_with_planes<D>(boxes, {up * -1.5, up * -1.5}, {up, -up}, 0.0)),
            (Pairs{{0, 1}, {1, 1}, {2, 1}}));
  EXPECT_EQ((contact::pairs_with_planes<D>(boxes, {up * -1.5}, {up}, 0.6)), (Pairs{{0, 0}, {2, 0}}));
}

}  // namespace
}  // namespace fissure
