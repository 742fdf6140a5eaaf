// Instantiated by src2d and src3d.
#pragma once
#include <limits>

#include "solver/pieces.h"
#include "solver/solver.h"

namespace fissure {

template <int D, class Real>
double Probe<D, Real>::time() const {
  return solver_.time();
}
template <int D, class Real>
long Probe<D, Real>::step() const {
  return solver_.step();
}
template <int D, class Real>
Vec3 Probe<D, Real>::plate_force(int plate) const {
  return solver_.contact().rigid().plate_forces().at(plate);
}
template <int D, class Real>
Vec3 Probe<D, Real>::plate_displacement(int plate) const {
  return solver_.contact().rigid().displacements().at(plate);
}
template <int D, class Real>
Vec3 Probe<D, Real>::wall_force(int wall) const {
  return solver_.contact().rigid().wall_forces().at(wall);
}
template <int D, class Real>
Vec3 Probe<D, Real>::reaction(int hold) const {
  return solver_.motion().reaction(hold);
}
template <int D, class Real>
double Probe<D, Real>::torque(int hold) const {
  return solver_.motion().torque(hold);
}
template <int D, class Real>
Vec3 Probe<D, Real>::contact_force(int body, int other) const {
  return solver_.contact().force_between(body, other);
}

template <int D, class Real>
scene::Touch Probe<D, Real>::touch(int body, int other) const {
  return solver_.contact().touch(body, other);
}

template <int D, class Real>
double Probe<D, Real>::energy(std::string const& name) const {
  Ledger const& ledger = solver_.energies();
  if (name == "residual") return ledger.residual();
  double sum = 0;
  bool known = false;
  for (auto const& term : Ledger::terms)
    if (name == term.name) sum += ledger.*term.value, known = true;
  if (!known) throw Error("the ledger has no energy \"" + name + "\"" + suggestion(name, scene::energy_names()));
  return sum;
}

/// A point inside is never farther from a node, nor from the middle of an element, than the body's longest edge.
template <int D, class Real>
void Probe<D, Real>::refuse_outside(int body, Vec3 const& point, double distance) const {
  double longest = 0;
  auto const& group = model().groups.at(body);
  for (Index e = group.first; e < group.first + group.count; ++e)
    for (int a = 1; a < C; ++a)
      for (int b = 0; b < a; ++b) {
        double squared = 0;
        for (int c = 0; c < D; ++c) {
          double const d = model().vertices.reference[model().vertex_of(e, a)][c] -
                           model().vertices.reference[model().vertex_of(e, b)][c];
          squared += d * d;
        }
        longest = std::max(longest, squared);
      }
  if (distance * distance <= longest * (1 + 1e-9)) return;
  std::string at;
  for (int c = 0; c < D; ++c) at += fmt::format("{}{:g}", c ? ", " : "", point[c]);
  throw Error(
      fmt::format("the point {{ {} }} m lies outside body \"{}\": what is nearest in it is {:.3g} m away (its edges "
                  "are at most {:.3g} m)",
                  at, solver_.scene().bodies[body].name, distance, std::sqrt(longest)));
}

template <int D, class Real>
Index Probe<D, Real>::nearest_corner(int body, Vec3 const& point) const {
  auto const key = std::make_pair(body, std::array<double, 3>{point[0], point[1], point[2]});
  auto const known = nearest_.find(key);
  if (known != nearest_.end() && !solver_.removal().excavated(known->second / C)) return known->second;
  struct Nearest {
    double squared = std::numeric_limits<double>::infinity(), middle = squared;
    Index corner = -1;
  };
  Nearest any, standing;  // the latter of what has not been excavated
  auto const& group = model().groups.at(body);
  for (Index e = group.first; e < group.first + group.count; ++e) {
    if (model().elements.cell[e] < 0) continue;
    double squared[C] = {}, middle = 0;
    for (int c = 0; c < D; ++c) {
      double sum = 0;
      for (int a = 0; a < C; ++a) {
        double const d = model().drawn_at(model().vertex_of(e, a))[c] - point[c];
        squared[a] += d * d, sum += d;
      }
      middle += sum * sum;
    }
    auto const look = [&](Nearest& best) {
      for (int a = 0; a < C; ++a)  // of corners at one node that of the element towards the point: its side of a crack
        if (double const same = 1e-12 * best.squared;
            squared[a] < best.squared - same || (squared[a] <= best.squared + same && middle < best.middle))
          best = {std::min(best.squared, squared[a]), middle, e * C + a};
    };
    look(any);
    if (!solver_.removal().excavated(e)) look(standing);
  }
  refuse_outside(body, point, std::sqrt(any.squared));
  // At the wall of what has been dug its node stands, too.
  bool const stands = standing.squared <= any.squared * (1 + 1e-9);
  return nearest_[key] = stands ? standing.corner : any.corner;
}

/// D numbers of the vertex nearest to a point.
template <int D, class Real>
Vec3 Probe<D, Real>::at_vertex(Buffer<Real> const& values, int body, Vec3 const& point) const {
  Index const corner = nearest_corner(body, point), vertex = model().vertex_of(corner / C, corner % C);
  Vec3 x(0, 0, 0);
  for (int c = 0; c < D; ++c) x[c] = values.download_one(static_cast<std::size_t>(vertex) * D + c);
  return x;
}

template <int D, class Real>
Vec3 Probe<D, Real>::displacement(int body, Vec3 const& point) const {
  Index const corner = nearest_corner(body, point);
  std::size_t const at = static_cast<std::size_t>(model().vertex_of(corner / C, corner % C)) * D;
  Vec3 x(0, 0, 0);
  if (solver_.removal().excavated(corner / C)) return x;
  if (model().removed(corner / C)) {
    auto u = model().vertices.u.download();
    solver_.removal().draw(u);
    for (int c = 0; c < D; ++c) x[c] = u[at + c];
  } else {
    x = at_vertex(model().vertices.u, body, point);
  }
  for (int c = 0; c < D && !model().vertices.start.empty(); ++c) x[c] -= model().vertices.start[at + c];
  return x;
}

template <int D, class Real>
Vec3 Probe<D, Real>::velocity(int body, Vec3 const& point) const {
  return at_vertex(model().vertices.v, body, point);
}

/// The element whose centroid at rest is nearest.
template <int D, class Real>
Index Probe<D, Real>::nearest_element(int body, Vec3 const& point) const {
  auto const& group = model().groups.at(body);
  double least = std::numeric_limits<double>::infinity();
  Index best = group.first;
  for (Index e : solver_.shown().cells) {
    if (model().elements.body[e] != body) continue;
    auto const corners = model().cell_vertices(e);
    double squared = 0;
    Vec3 middle = Vec3::Zero();
    for (Index const vertex : corners) middle += model().drawn_at(vertex) / static_cast<double>(corners.size());
    for (int c = 0; c < D; ++c) squared += (middle[c] - point[c]) * (middle[c] - point[c]);
    if (squared < least) least = squared, best = e;
  }
  refuse_outside(body, point, std::sqrt(least));
  return best;
}

template <int D, class Real>
std::array<double, 6> Probe<D, Real>::stress(int body, Vec3 const& point) const {
  auto const all = solver_.stresses();
  std::array<double, 6> value;
  std::copy_n(&all[static_cast<std::size_t>(nearest_element(body, point)) * 6], 6, value.begin());
  return value;
}

/// First component of a field of cells at the element nearest to a point.
template <int D, class Real>
double Probe<D, Real>::field(std::string const& name, int body, Vec3 const& point) const {
  output::Frame const shown = solver_.frame({name});
  auto const& field = shown.cell_fields.at(0);
  return field.values[static_cast<std::size_t>(solver_.shown().number_of_cell[nearest_element(body, point)]) *
                      field.components];
}

template <int D, class Real>
double Probe<D, Real>::average(std::string const& name, int body,
                               std::function<bool(double, double, double)> const& inside) const {
  auto const& components = scene::stress_components();
  auto const component = std::find(components.begin(), components.end(), name);
  bool const of_stress = component != components.end();
  output::Frame const shown = solver_.frame({of_stress ? "stress" : name});
  auto const& field = shown.cell_fields.at(0);
  double sum = 0, whole = 0;
  bool left = false;
  for (Index const e : solver_.shown().cells) {
    if (model().elements.body[e] != body) continue;
    auto const corners = model().cell_vertices(e);
    Vec3 middle = Vec3::Zero();
    for (Index const vertex : corners) middle += model().drawn_at(vertex) / static_cast<double>(corners.size());
    if (inside && !inside(middle[0], middle[1], middle[2])) continue;
    if (!model().present(e)) {
      left = true;
      continue;
    }
    double volume = 0;
    for (double const share : model().corner_volumes(e)) volume += share;
    std::size_t const at = static_cast<std::size_t>(solver_.shown().number_of_cell[e]) * field.components +
                           static_cast<std::size_t>(of_stress ? component - components.begin() : 0);
    sum += volume * field.values[at], whole += volume;
  }
  if (!(whole > 0) && left) return 0;  // as all else that is asked of what has left
  if (!(whole > 0))
    throw Error(fmt::format("now.average: no cell of body \"{}\" has its middle where the function says true",
                            solver_.scene().bodies[body].name));
  return sum / whole;
}

template <int D, class Real>
std::array<Vec3, 2> Probe<D, Real>::bounds(int body) const {
  auto const u = model().vertices.u.download();
  auto const& group = model().groups.at(body);
  Vec3 least = Vec3::Constant(std::numeric_limits<double>::infinity()), largest = -least;
  for (Index e = group.first; e < group.first + group.count; ++e)
    for (int a = 0; a < C && model().present(e); ++a) {
      Index const vertex = model().vertex_of(e, a);
      for (int c = 0; c < D; ++c) {
        double const x = model().origin[c] + model().vertices.reference[vertex][c] +
                         static_cast<double>(u[static_cast<std::size_t>(vertex) * D + c]);
        least[c] = std::min(least[c], x), largest[c] = std::max(largest[c], x);
      }
    }
  for (int c = 0; c < 3; ++c)
    if (c >= D || !(least[c] <= largest[c])) least[c] = largest[c] = 0;  // nothing there
  if (model().section.axisymmetric()) {                                  // of the body, not of its section
    largest[2] = largest[0];
    least[0] = least[2] = -largest[0];
  }
  return {least, largest};
}

template <int D, class Real>
Vec3 Probe<D, Real>::mean_velocity(int body) const {
  auto const v = model().vertices.v.download();
  auto const& group = model().groups.at(body);
  Vec3 momentum(0, 0, 0);
  double mass = 0;
  std::vector<char> seen(model().vertices.count, 0);
  for (Index e = group.first; e < group.first + group.count; ++e)
    for (int a = 0; a < C && model().present(e); ++a) {
      Index const vertex = model().vertex_of(e, a);
      if (seen[vertex]++) continue;
      mass += model().vertices.mass[vertex];
      for (int c = 0; c < D; ++c)
        momentum[c] += model().vertices.mass[vertex] * v[static_cast<std::size_t>(vertex) * D + c];
    }
  return mass > 0 ? Vec3(momentum / mass) : momentum;
}

template <int D, class Real>
double Probe<D, Real>::crack_area() const {
  return solver_.fracture().area();
}
template <int D, class Real>
double Probe<D, Real>::crack_energy() const {
  return solver_.fracture().energy();
}
template <int D, class Real>
long Probe<D, Real>::removed_pieces() const {
  return static_cast<long>(solver_.removal().removed().size());
}

template <int D, class Real>
double Probe<D, Real>::removed_mass() const {
  return solver_.removal().mass();
}

template <int D, class Real>
long Probe<D, Real>::broken_joints() const {
  return solver_.fracture().count();
}

template <int D, class Real>
std::vector<scene::Fragment> Probe<D, Real>::fragments(int body) const {
  return pieces(solver_.scene(), model(), body).list;
}

template <int D, class Real>
double Probe<D, Real>::extreme(std::string const& field) const {
  output::Frame const shown = solver_.frame({field});
  double largest = -std::numeric_limits<double>::infinity();
  for (auto const* fields : {&shown.point_fields, &shown.cell_fields})
    for (auto const& one : *fields)
      for (std::size_t i = 0; i + one.components <= one.values.size(); i += one.components) {
        double squared = one.values[i];
        if (one.components == 3)
          squared = std::sqrt(one.values[i] * one.values[i] + one.values[i + 1] * one.values[i + 1] +
                              one.values[i + 2] * one.values[i + 2]);
        largest = std::max(largest, squared);
      }
  return largest;
}

template <int D, class Real>
std::optional<double> Probe<D, Real>::sampled(std::string const& measure, double Simulation::Sampled::*value) const {
  auto const found = solver_.sampled.find(measure);
  return found == solver_.sampled.end() || !found->second.any ? std::nullopt : std::optional(found->second.*value);
}
template <int D, class Real>
std::optional<double> Probe<D, Real>::latest(std::string const& measure) const {
  return sampled(measure, &Simulation::Sampled::latest);
}
template <int D, class Real>
std::optional<double> Probe<D, Real>::peak(std::string const& measure) const {
  return sampled(measure, &Simulation::Sampled::peak);
}
template <int D, class Real>
std::optional<double> Probe<D, Real>::peak_time(std::string const& measure) const {
  return sampled(measure, &Simulation::Sampled::peak_time);
}
template <int D, class Real>
std::optional<double> Probe<D, Real>::mean(std::string const& measure, double duration) const {
  auto const& recorded = solver_.recorded;
  return recorded.has(measure) ? std::optional(recorded.mean(measure, duration)) : std::nullopt;
}
template <int D, class Real>
bool Probe<D, Real>::at_rest(double share) const {
  return solver_.recorded.calm("energy kinetic", share);
}

}  // namespace fissure
