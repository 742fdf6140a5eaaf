// Keys of fracture{} that are functions or words: what they become, and what is refused in which words.
#include <gtest/gtest.h>

#include <map>

#include "lua/script.h"

namespace fissure {
namespace {

laws::CohesiveJoint read(std::string const& keys) {
  auto const scene = lua::read_scene_text(
      "local m = material{ \"m\", density = 2500, elastic = { young = 3e10, poisson = 0.2 },\n"
      "fracture = { tension = 3e6, shear = 1e7, G1 = 50, G2 = 100, penalty = 6e11, " +
          keys +
          " } }\n"
          "body{ shape = box{ size = { 1, 1 } }, mesh = { size = 1 }, material = m }\nrun{ time = 1 }",
      "s.lua", 2, {});
  return std::get<laws::CohesiveJoint>(*scene.materials.at(0).joint);
}

std::string refusal(std::string const& keys) {
  try {
    read(keys);
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

TEST(FractureKeys, RateIsAFactorOfTheSpeed) {
  auto const points = read("rate = { { 0, 1 }, { 1, 2 }, { 10, 3 } }").faster;
  for (auto const& [speed, factor] :
       std::map<double, double>{{0, 1}, {0.5, 1.5}, {1, 2}, {5.5, 2.5}, {10, 3}, {1e6, 3}})
    EXPECT_NEAR(points.value(speed), factor, 1e-6) << speed;
  auto const power = read("rate = function(v) return (1 + v/0.1)^0.3 end").faster;
  for (double speed : {0.0, 1e-4, 3e-3, 0.07, 0.5, 8.0, 900.0})  // straight between points a third of their size apart
    EXPECT_NEAR(power.value(speed) / std::pow(1 + speed / 0.1, 0.3), 1, 3e-3) << speed;
  EXPECT_EQ(read("").faster.value(5.0), 1);
  for (auto const& [rate, why] : std::map<std::string, std::string>{
           {"3", "rate must be a list of { speed, factor } or a function(speed)"},
           {"{ { 0, 1 } }", "rate needs two points at least"},
           {"{ { 0, 1 }, { 1, 0.5 } }", "rate falls from 1 to 0.5 at 1 m/s; strength may only grow with the speed"},
           {"{ { 0, 1 }, { 0, 2 } }", "rate has the speed 0 m/s after 0 m/s; speeds must rise"},
           {"{ { 1, 1 }, { 2, 2 } }", "rate begins with a factor of 1 at 1 m/s; it must be 1 at 0 m/s"},
           {"{ { 0, 1 }, { 1, 1e9 } }", "rate reaches a factor of 1e+09 at 1 m/s; at most 100 is allowed"},
           {"function(v) return 1 - v end", "rate falls from 1 to 0.9999 at 0.0001 m/s"},
           {"function(v) return 1/v end", "returned inf at a speed of 0 m/s"},
           {"function(v) end", "returned a nil at a speed of 0 m/s; it must return a factor"}})
    EXPECT_NE(refusal("rate = " + rate).find(why), std::string::npos) << refusal("rate = " + rate);
}

TEST(FractureKeys, CriterionGoesWithTheEllipse) {
  EXPECT_TRUE(read("").rankine);
  EXPECT_FALSE(read("criterion = \"traction\"").rankine);
  EXPECT_FALSE(read("mixed = \"independent\"").rankine);
  EXPECT_NE(refusal("mixed = \"independent\", criterion = \"rankine\"")
                .find("criterion = \"rankine\" needs mixed = \"ellipse\""),
            std::string::npos);
  EXPECT_NE(refusal("criterion = \"rankin\"").find("did you mean \"rankine\"?"), std::string::npos);
}

TEST(FractureKeys, JointsAreThereFromTheStartUnlessTheyAreInserted) {
  EXPECT_FALSE(read("").inserted);
  EXPECT_FALSE(read("insertion = \"intrinsic\"").inserted);
  EXPECT_TRUE(read("insertion = \"adaptive\"").inserted);
  EXPECT_NE(refusal("insertion = \"adaptiv\"").find("did you mean \"adaptive\"?"), std::string::npos);
}

}  // namespace
}  // namespace fissure
