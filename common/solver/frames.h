// What output shows of a run: the cells once, and frames of fields, cracks and rigid bodies.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "laws/plastic.h"
#include "output/results.h"
#include "solver/shown.h"

namespace fissure {

template <int D, class Real>
class Solver;

/// What an element remembers of flow, on the host; of a block the mean over its points.
template <int D, class Real>
laws::FlowPoint<double, true> flow_point(model::Model<D, Real> const& model, std::vector<Real> const& memory, Index e);

template <int D, class Real>
class Frames {
 public:
  static constexpr int C = D + 1;

  explicit Frames(Solver<D, Real>& solver) : solver_(solver) {}

  output::Topology topology() const;
  output::Frame frame(std::vector<std::string> const& fields) const;

 private:
  /// A field that output may show: its components by vertex, or by cell's head.
  struct FieldEntry {
    char const *name, *unit;
    int components;
    bool by_cell;
    std::function<void(Index, double*)> value;
  };
  void add_fields(std::vector<std::string> const& names, std::vector<Real> const& u, output::Frame& frame) const;
  void add_cracks(std::vector<Real> const& u, output::Cracks& cracks) const;
  std::vector<double> rigid_corners() const;
  double yield_ratio(std::vector<Real> const& memory, std::vector<Real> const& u, Index e) const;
  model::Model<D, Real> const& model() const { return solver_.model(); }
  scene::Scene const& scene() const { return solver_.scene(); }

  Solver<D, Real>& solver_;  // to be asked, not changed: stresses() fills an array of its own
};

}  // namespace fissure
