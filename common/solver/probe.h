// What measures may ask of a running experiment (scene::Now).
#pragma once
#include <map>
#include <utility>

#include "solver/simulation.h"

namespace fissure {

template <int D, class Real>
class Solver;

template <int D, class Real>
class Probe final : public scene::Now {
 public:
  static constexpr int C = D + 1;

  explicit Probe(Solver<D, Real>& solver) : solver_(solver) {}

  double time() const override;
  long step() const override;
  Vec3 plate_force(int plate) const override;
  Vec3 plate_displacement(int plate) const override;
  Vec3 wall_force(int wall) const override;
  Vec3 reaction(int hold) const override;
  double torque(int hold) const override;
  Vec3 contact_force(int body, int other) const override;
  scene::Touch touch(int body, int other) const override;
  double pull(int spring) const override { return solver_.springs().pull(spring); }
  Vec3 tie_force(int tie) const override { return solver_.ties().force(tie); }
  double energy(std::string const& name) const override;
  Vec3 displacement(int body, Vec3 const& point) const override;
  Vec3 velocity(int body, Vec3 const& point) const override;
  std::array<double, 6> stress(int body, Vec3 const& point) const override;
  Vec3 mean_velocity(int body) const override;
  double crack_area() const override;
  double crack_energy() const override;
  long broken_joints() const override;
  long removed_pieces() const override;
  double removed_mass() const override;
  std::vector<scene::Fragment> fragments(int body) const override;
  double field(std::string const& field, int body, Vec3 const& point) const override;
  double average(std::string const& field, int body,
                 std::function<bool(double, double, double)> const& inside) const override;
  std::array<Vec3, 2> bounds(int body) const override;
  double extreme(std::string const& field) const override;
  std::optional<double> latest(std::string const& measure) const override;
  std::optional<double> peak(std::string const& measure) const override;
  std::optional<double> peak_time(std::string const& measure) const override;
  std::optional<double> mean(std::string const& measure, double duration) const override;
  bool at_rest(double share) const override;

 private:
  model::Model<D, Real> const& model() const { return solver_.model(); }
  Index nearest_corner(int body, Vec3 const& point) const;
  Index nearest_element(int body, Vec3 const& point) const;
  void refuse_outside(int body, Vec3 const& point, double distance) const;
  Vec3 at_vertex(Buffer<Real> const& values, int body, Vec3 const& point) const;
  std::optional<double> sampled(std::string const& measure, double Simulation::Sampled::*value) const;

  Solver<D, Real>& solver_;  // to be asked, not changed: energies() are booked when they are asked for
  // corner nearest to a point that was asked for
  mutable std::map<std::pair<int, std::array<double, 3>>, Index> nearest_;
};

}  // namespace fissure
