// What measures ask of a solver; instantiated by src2d and src3d.
#pragma once
#include <limits>

#include "solver/fragments.impl.h"

namespace fissure {

template <int D, class Real>
Vec3 Solver<D, Real>::plate_force(int plate) const {
  return contact_.plate_force(plate);
}
template <int D, class Real>
Vec3 Solver<D, Real>::plate_displacement(int plate) const {
  return contact_.plate_displacement(plate);
}
template <int D, class Real>
Vec3 Solver<D, Real>::wall_force(int wall) const {
  return contact_.wall_force(wall);
}
template <int D, class Real>
Vec3 Solver<D, Real>::reaction(int hold) const {
  return hold_reaction_.at(hold);
}

template <int D, class Real>
double Solver<D, Real>::energy(std::string const& name) const {
  const_cast<Solver*>(this)->refresh_ledger();
  std::map<std::string, double> const terms{
      {"kinetic", ledger_.kinetic},     {"elastic", ledger_.elastic},
      {"hourglass", ledger_.hourglass}, {"plastic", ledger_.plastic},
      {"joint", ledger_.joint},         {"fracture", ledger_.fracture},
      {"viscous", ledger_.viscous},     {"mass_damping", ledger_.mass_damping},
      {"contact", ledger_.contact},     {"friction", ledger_.friction},
      {"gravity", ledger_.gravity},     {"external", ledger_.external + ledger_.plates},
      {"residual", ledger_.residual()}};
  auto const found = terms.find(name);
  if (found == terms.end())
    throw Error("the ledger has no energy \"" + name + "\"" + suggestion(name, scene::energy_names()));
  return found->second;
}

/// Books once per time, however many terms are asked for.
template <int D, class Real>
void Solver<D, Real>::refresh_ledger() {
  if (booked_step_ == step_) return;
  book();
  booked_step_ = step_;
}

/// A point inside is never farther from a node, nor from the middle of an element, than the body's longest edge.
template <int D, class Real>
void Solver<D, Real>::refuse_outside(int body, Vec3 const& point, double distance) const {
  double longest = 0;
  auto const& group = model_.groups.at(body);
  for (Index e = group.first; e < group.first + group.count; ++e)
    for (int a = 1; a < C; ++a)
      for (int b = 0; b < a; ++b) {
        double squared = 0;
        for (int c = 0; c < D; ++c) {
          double const d = model_.reference[model_.vertex_of(e, a)][c] - model_.reference[model_.vertex_of(e, b)][c];
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
                  at, scene_.bodies[body].name, distance, std::sqrt(longest)));
}

template <int D, class Real>
Index Solver<D, Real>::nearest_corner(int body, Vec3 const& point) const {
  auto const key = std::make_pair(body, std::array<double, 3>{point[0], point[1], point[2]});
  auto const known = nearest_.find(key);
  if (known != nearest_.end()) return known->second;
  double least = std::numeric_limits<double>::infinity(), nearer = least;
  Index best = -1;
  auto const& group = model_.groups.at(body);
  for (Index e = group.first; e < group.first + group.count; ++e) {
    if (model_.cell_of_element[e] < 0) continue;
    double squared[C] = {}, middle = 0;
    for (int c = 0; c < D; ++c) {
      double sum = 0;
      for (int a = 0; a < C; ++a) {
        double const d = model_.reference[model_.vertex_of(e, a)][c] + model_.origin[c] - point[c];
        squared[a] += d * d, sum += d;
      }
      middle += sum * sum;
    }
    for (int a = 0; a < C; ++a)  // of corners at one node that of the element towards the point: on its side of a crack
      if (double const same = 1e-12 * least;
          squared[a] < least - same || (squared[a] <= least + same && middle < nearer))
        least = std::min(least, squared[a]), nearer = middle, best = e * C + a;
  }
  refuse_outside(body, point, std::sqrt(least));
  return nearest_[key] = best;
}

template <int D, class Real>
Vec3 Solver<D, Real>::displacement(int body, Vec3 const& point) const {
  Index const corner = nearest_corner(body, point), vertex = model_.vertex_of(corner / C, corner % C);
  Vec3 x(0, 0, 0);
  for (int c = 0; c < D; ++c) x[c] = model_.u.download_one(static_cast<std::size_t>(vertex) * D + c);
  return x;
}

template <int D, class Real>
Vec3 Solver<D, Real>::velocity(int body, Vec3 const& point) const {
  Index const corner = nearest_corner(body, point), vertex = model_.vertex_of(corner / C, corner % C);
  Vec3 x(0, 0, 0);
  for (int c = 0; c < D; ++c) x[c] = model_.v.download_one(static_cast<std::size_t>(vertex) * D + c);
  return x;
}

template <int D, class Real>
std::vector<double> Solver<D, Real>::element_stresses() const {
  auto& self = *const_cast<Solver*>(this);  // a pass that reads the model and writes an array of its own
  Buffer<double> stress(self.device_, "stress", static_cast<std::size_t>(model_.n_elements) * 6);
  element_stress(self.device_, self.model_, scene_, ElementRun{scene_.two_d == "plane stress", dt()}, stress.data());
  return stress.download();
}

/// The element whose centroid at rest is nearest.
template <int D, class Real>
Index Solver<D, Real>::nearest_element(int body, Vec3 const& point) const {
  auto const& group = model_.groups.at(body);
  double least = std::numeric_limits<double>::infinity();
  Index best = group.first;
  for (Index e : cells_shown_) {
    if (model_.body_of_element[e] != body) continue;
    auto const corners = model_.cell_vertices(e);
    double squared = 0;
    for (int c = 0; c < D; ++c) {
      double middle = model_.origin[c];
      for (Index vertex : corners) middle += model_.reference[vertex][c] / static_cast<double>(corners.size());
      squared += (middle - point[c]) * (middle - point[c]);
    }
    if (squared < least) least = squared, best = e;
  }
  refuse_outside(body, point, std::sqrt(least));
  return best;
}

template <int D, class Real>
std::array<double, 6> Solver<D, Real>::stress(int body, Vec3 const& point) const {
  auto const all = element_stresses();
  std::array<double, 6> value;
  std::copy_n(&all[static_cast<std::size_t>(nearest_element(body, point)) * 6], 6, value.begin());
  return value;
}

/// First component of a field of cells at the element nearest to a point.
template <int D, class Real>
double Solver<D, Real>::field(std::string const& name, int body, Vec3 const& point) const {
  output::Frame const shown = frame({name});
  auto const& field = shown.cell_fields.at(0);
  return field.values[static_cast<std::size_t>(number_of_cell_[nearest_element(body, point)]) * field.components];
}

template <int D, class Real>
std::array<Vec3, 2> Solver<D, Real>::bounds(int body) const {
  auto const u = model_.u.download();
  auto const& group = model_.groups.at(body);
  Vec3 least = Vec3::Constant(std::numeric_limits<double>::infinity()), largest = -least;
  for (Index e = group.first; e < group.first + group.count; ++e)
    for (int a = 0; a < C && model_.cell_of_element[e] >= 0; ++a) {
      Index const vertex = model_.vertex_of(e, a);
      for (int c = 0; c < D; ++c) {
        double const x = model_.origin[c] + model_.reference[vertex][c] +
                         static_cast<double>(u[static_cast<std::size_t>(vertex) * D + c]);
        least[c] = std::min(least[c], x), largest[c] = std::max(largest[c], x);
      }
    }
  for (int c = D; c < 3; ++c) least[c] = largest[c] = 0;
  if (model_.axisymmetric) {  // of the body, not of its section
    largest[2] = largest[0];
    least[0] = least[2] = -largest[0];
  }
  return {least, largest};
}

template <int D, class Real>
Vec3 Solver<D, Real>::mean_velocity(int body) const {
  auto const v = model_.v.download();
  auto const& group = model_.groups.at(body);
  Vec3 momentum(0, 0, 0);
  double mass = 0;
  std::vector<char> seen(model_.n_vertices, 0);
  for (Index e = group.first; e < group.first + group.count; ++e)
    for (int a = 0; a < C && model_.cell_of_element[e] >= 0; ++a) {
      Index const vertex = model_.vertex_of(e, a);
      if (seen[vertex]++) continue;
      mass += model_.mass[vertex];
      for (int c = 0; c < D; ++c) momentum[c] += model_.mass[vertex] * v[static_cast<std::size_t>(vertex) * D + c];
    }
  return momentum / mass;
}

template <int D, class Real>
double Solver<D, Real>::crack_area() const {
  double area = 0;
  for (auto const& joint : contact_.broken()) area += joint.area;
  return area;
}

template <int D, class Real>
double Solver<D, Real>::crack_energy() const {
  double work = 0;
  for (auto const& joint : contact_.broken()) work += joint.work;
  return work;
}

template <int D, class Real>
long Solver<D, Real>::broken_joints() const {
  long parts = 0;  // of blocks' faces
  for (auto const& joint : contact_.broken()) parts += model_.block_face(joint.element, joint.face) >= 0;
  return static_cast<long>(contact_.broken().size()) - parts + parts / Model::K;
}

template <int D, class Real>
double Solver<D, Real>::extreme(std::string const& field) const {
  output::Frame const shown = frame({field});
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
std::optional<double> Solver<D, Real>::latest(std::string const& measure) const {
  auto const found = sampled.find(measure);
  return found == sampled.end() || !found->second.any ? std::nullopt : std::optional(found->second.latest);
}
template <int D, class Real>
std::optional<double> Solver<D, Real>::peak(std::string const& measure) const {
  auto const found = sampled.find(measure);
  return found == sampled.end() || !found->second.any ? std::nullopt : std::optional(found->second.peak);
}
template <int D, class Real>
std::optional<double> Solver<D, Real>::peak_time(std::string const& measure) const {
  auto const found = sampled.find(measure);
  return found == sampled.end() || !found->second.any ? std::nullopt : std::optional(found->second.peak_time);
}

}  // namespace fissure
