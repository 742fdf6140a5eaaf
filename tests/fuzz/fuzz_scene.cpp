// Fuzzing of the scene reader: whatever the text, it becomes a scene or an error, in bounded time and memory.
// Built by clang++ -fsanitize=fuzzer,address,undefined; run with -rss_limit_mb=4096 -timeout=40 -dict=.../scene.dict.
#include <cstdint>
#include <string>

#include "lua/script.h"

namespace {

class Nothing final : public fissure::scene::Now {
 public:
  double time() const override { return 1; }
  long step() const override { return 1; }
  fissure::Vec3 plate_force(int) const override { return {1, 2, 3}; }
  fissure::Vec3 plate_displacement(int) const override { return {1, 2, 3}; }
  fissure::Vec3 wall_force(int) const override { return {1, 2, 3}; }
  double energy(std::string const&) const override { return 1; }
  fissure::Vec3 displacement(int, fissure::Vec3 const&) const override { return {1, 2, 3}; }
  fissure::Vec3 velocity(int, fissure::Vec3 const&) const override { return {1, 2, 3}; }
  std::array<double, 6> stress(int, fissure::Vec3 const&) const override { return {1, 2, 3, 4, 5, 6}; }
  fissure::Vec3 mean_velocity(int) const override { return {1, 2, 3}; }
  fissure::Vec3 reaction(int) const override { return {1, 2, 3}; }
  double torque(int) const override { return 1; }
  fissure::Vec3 contact_force(int, int) const override { return {1, 2, 3}; }
  double pull(int) const override { return 1; }
  fissure::Vec3 tie_force(int) const override { return fissure::Vec3::Zero(); }
  fissure::scene::Touch touch(int, int) const override { return {1, 2}; }
  double crack_area() const override { return 1; }
  double crack_energy() const override { return 0.25; }
  long broken_joints() const override { return 1; }
  long removed_pieces() const override { return 0; }
  double removed_mass() const override { return 0; }
  std::vector<fissure::scene::Fragment> fragments(int body) const override {
    std::vector<fissure::scene::Fragment> list(2);
    list[0].mass = 3 + body, list[0].velocity[1] = 7, list[1].mass = 1;
    return list;
  }
  double field(std::string const&, int, fissure::Vec3 const&) const override { return 0; }
  double average(std::string const&, int, std::function<bool(double, double, double)> const&) const override {
    return 0;
  }
  std::array<fissure::Vec3, 2> bounds(int) const override { return {fissure::Vec3::Zero(), fissure::Vec3::Zero()}; }
  double extreme(std::string const&) const override { return 1; }
  std::optional<double> latest(std::string const&) const override { return {}; }
  std::optional<double> peak(std::string const&) const override { return 1; }
  std::optional<double> peak_time(std::string const&) const override { return 1; }
  std::optional<double> mean(std::string const&, double) const override { return 1; }
  bool at_rest(double) const override { return true; }
};

template <class Call>
void attempt(Call call) {
  try {
    call();
  } catch (fissure::Error const& error) {
    if (std::string(error.what()).empty()) __builtin_trap();  // an error always says what is wrong
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  if (size == 0) return 0;
  std::string const text(reinterpret_cast<char const*>(data) + 1, size - 1);
  attempt([&] {
    auto const scene = fissure::lua::read_scene_text(text, "fuzz.lua", data[0] % 2 == 0 ? 2 : 3, {{"speed", 1}});
    for (auto const& measure : scene.measures) attempt([&] { measure.value(Nothing()); });
    for (auto const& expect : scene.expects) attempt([&] { expect.value(Nothing()); });
    for (auto const& hold : scene.holds)
      for (auto const& component : hold.velocity)
        if (component) attempt([&] { (*component)(0.5); });
    for (auto const& pressure : scene.pressures) {
      attempt([&] { pressure.value(0.5); });
      if (pressure.where.inside) attempt([&] { pressure.where.inside(1, 2, 3); });
    }
    if (scene.run.stop) attempt([&] { scene.run.stop(Nothing()); });
  });
  return 0;
}
