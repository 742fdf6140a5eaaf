// What stops a run: elements turned inside out and numbers that were lost, with the first one's name; a part of
// solver.impl.h.
#pragma once
#include <fmt/format.h>

#include <cmath>

#include "solver/frames.h"
#include "solver/solver.h"

namespace fissure {

/// Stops the run when an element turned inside out or a number was lost, and names the first such element.
template <int D, class Real>
void Solver<D, Real>::check_elements(int fault) {
  if (fault == 0) return;
  auto const u = model_.vertices.u.download();
  bool const removes = scene_.run.remove_crushed;
  if (removes) removal_.look(u, last_dt_);
  for (Index e = 0; e < model_.elements.count; ++e) {
    if (model_.elements.cell[e] < 0 || model_.cell_head(e) != e) continue;
    double const ratio = model_.volume_ratio(u, e);
    if (ratio > 0 || removal_.leaves(e)) continue;
    auto const& body = scene_.bodies[model_.elements.body[e]];
    bool const lost = std::isnan(ratio);
    throw Error(
        fmt::format("step {}, t = {:.6g} s: element {} of body \"{}\" {} (volume ratio {:.3g}); {}", step_, time_,
                    shown_.number_of_cell[e], body.name, lost ? "is not a number" : "has turned inside out", ratio,
                    lost && sizeof(Real) == 4 ? advice_for_single : "a smaller dt, damping or a finer mesh may help"));
  }
  for (Index e = 0; e < model_.elements.count; ++e) {
    if (model_.elements.cell[e] < 0 || removal_.leaves(e) ||
        model_.moved_edges(u, e).determinant() / model_.edges(e).determinant() > 0)
      continue;
    throw Error(fmt::format(
        "step {}, t = {:.6g} s: a corner of element {} of body \"{}\" has turned inside out where it "
        "touches something; a finer mesh, a softer contact or another integration may help",
        step_, time_, shown_.number_of_cell[model_.cell_head(e)], scene_.bodies[model_.elements.body[e]].name));
  }
  if (model_.plan.plastic) refuse_flow();
  if (removes) return model_.flags.upload_one(model::Notice::fault, 0);
  throw Error(
      fmt::format("step {}, t = {:.6g} s: the precision of this run cannot tell an element's volume from zero; use "
                  "--precision double?",
                  step_, time_));
}

/// Names the element whose return mapping gave no number: its memory is as it was before that step, but for its rate.
template <int D, class Real>
void Solver<D, Real>::refuse_flow() {
  auto const memory = model_.internal.memory.download();
  for (auto const& group : model_.groups)
    for (Index e = group.first; group.plastic && e < group.first + group.count; ++e) {
      if (model_.elements.cell[e] < 0 || removal_.leaves(e)) continue;
      auto const point = flow_point(model_, memory, e);
      if (!std::isnan(point.rate)) continue;
      auto const& s = point.stress;
      throw Error(
          fmt::format("step {}, t = {:.6g} s: the return mapping of element {} of body \"{}\" did not converge "
                      "(plastic strain {:.4g}, stress before xx {:.4g}, yy {:.4g}, zz {:.4g}, xy {:.4g} Pa); a smaller "
                      "dt or another yield curve may help",
                      step_, time_, shown_.number_of_cell[model_.cell_head(e)], scene_.bodies[group.body].name,
                      point.strain, s(0, 0), s(1, 1), s(2, 2), s(0, 1)));
    }
}

/// In the second step, the first in which anything may have flowed: a body whose stress at the start lies beyond its
/// yield stress.
template <int D, class Real>
void Solver<D, Real>::warn_of_yield() {
  std::vector<double> work;
  for (auto const& group : model_.groups) {
    auto const& body = scene_.bodies[group.body];
    if (!body.stress_at || !group.plastic) continue;
    if (work.empty()) work = model_.internal.work.download();
    auto const simplices = work.begin() + group.first,
               points = work.begin() + model_.elements.count + group.first_point;
    Index const per_block = kernels::BlockNumbers<D>::points(group.integration);
    auto const flows = [](double taken) { return taken > 0; };
    if (std::any_of(simplices, simplices + group.simplices.padded, flows) ||
        std::any_of(points, points + group.blocks.padded * per_block, flows))
      model_.warnings.push_back(fmt::format(
          "{}body \"{}\": its stress at the start lies beyond its yield stress: it flows in the first step, "
          "and what should balance that stress pushes it",
          body.source.prefix(), body.name));
  }
}

}  // namespace fissure
