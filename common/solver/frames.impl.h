// Instantiated by src2d and src3d.
#pragma once
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "solver/frames.h"
#include "solver/pieces.h"
#include "solver/solver.h"

namespace fissure {

/// Of a stress xx yy zz xy yz zx [Pa].
inline double von_mises(double const* s) {
  double const a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}
inline double largest_principal(double const* s) {
  Eigen::Matrix3d sigma;
  sigma << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sigma, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

template <int D, class Real>
laws::FlowPoint<double, true> flow_point(model::Model<D, Real> const& model, std::vector<Real> const& memory, Index e) {
  auto const& m = model.groups.at(model.elements.body[e]).plastic->memory;
  auto const number = [&](int k) { return k < 0 ? 0.0 : model.remembered(memory, e, k); };
  auto const tensor = [&](int from) {
    Mat<double, 3> t = Mat<double, 3>::Zero();
    for (int k = 0; k < Dim<D>::stresses && from >= 0; ++k)
      t(kernels::tensor_row(k), kernels::tensor_column(k)) = t(kernels::tensor_column(k), kernels::tensor_row(k)) =
          number(from + k);
    return t;
  };
  return {tensor(0), number(m.strain), number(m.rate), number(m.rise), tensor(m.back)};
}

template <int D, class Real>
output::Topology Frames<D, Real>::topology() const {
  output::Topology topology;
  auto const parity = model().elements.parity.download();
  for (Index e : solver_.shown().cells) {
    model().in_set(e, [&](auto const& set, Index cell) {
      topology.types.push_back(set.vtk);
      for (int a = 0; a < set.corners; ++a)
        topology.cells.push_back(solver_.shown().number_of_vertex[set.vertex(cell, set.drawn(a, parity[e] < 0))]);
    });
  }
  for (auto const& set : model().holds)
    for (auto const& held : set.list.download()) topology.held.push_back(solver_.shown().number_of_vertex[held.vertex]);
  std::sort(topology.held.begin(), topology.held.end());
  topology.held.erase(std::unique(topology.held.begin(), topology.held.end()), topology.held.end());
  topology.rigid_cells = static_cast<int>(scene().plates.size() + scene().walls.size() + scene().springs.size());
  topology.rigid_type = Dim<D>::vtk_block;
  return topology;
}

/// Corners of plates where they are now and of walls as far as the bodies were long at the start, in VTK's order [m].
template <int D, class Real>
std::vector<double> Frames<D, Real>::rigid_corners() const {
  std::vector<double> points;
  auto const add = [&](Vec3 const& middle, Vec3 const& u, Vec3 const& v, Vec3 const& w) {
    for (int a = 0; a < BlockShape<D>::corners; ++a) {
      Vec3 const x = middle + (a % 4 == 1 || a % 4 == 2 ? 1 : -1) * u + (a % 4 > 1 ? 1 : -1) * v + (a > 3 ? 1 : -1) * w;
      for (int c = 0; c < 3; ++c) points.push_back(c < D ? x[c] : 0);
    }
  };
  for (std::size_t p = 0; p < scene().plates.size(); ++p) {
    auto const& box = scene().plates[p].box;
    Vec3 const half = box.size / 2;
    add(box.center + solver_.contact().rigid().displacements()[p], {half[0], 0, 0}, {0, half[1], 0}, {0, 0, half[2]});
  }
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (auto const& x : model().vertices.reference)
    for (int c = 0; c < D; ++c)
      low[c] = std::min(low[c], x[c] + model().origin[c]), high[c] = std::max(high[c], x[c] + model().origin[c]);
  for (int c = D; c < 3; ++c) low[c] = high[c] = 0;
  for (auto const& wall : scene().walls) {
    Vec3 const n = wall.normal.normalized(), middle = (low + high) / 2, foot = middle - n * n.dot(middle - wall.point);
    Vec3 const first = n[0] != 0 || n[1] != 0 ? Vec3(n[1], -n[0], 0).normalized() : Vec3(1, 0, 0);
    double const half = 0.75 * (high - low).norm();
    add(foot, half * first, half * n.cross(first), {0, 0, 0});
  }
  for (int s = 0; s < static_cast<int>(scene().springs.size()); ++s) {  // lines; broken ones are points
    Vec3 const from = solver_.springs().end(s, 0),
               to = solver_.springs().broken(s) ? from : solver_.springs().end(s, 1);
    add((from + to) / 2, (to - from) / 2, {0, 0, 0}, {0, 0, 0});
  }
  return points;
}

template <int D, class Real>
output::Frame Frames<D, Real>::frame(std::vector<std::string> const& fields) const {
  output::Frame frame;
  frame.time = solver_.time();
  frame.step = solver_.step();
  auto u = model().vertices.u.download();
  solver_.removal().draw(u);
  auto const& shown = solver_.shown().vertices;
  frame.points.resize(shown.size() * 3);
  for (std::size_t i = 0; i < shown.size(); ++i)
    for (int c = 0; c < 3; ++c)
      frame.points[3 * i + c] = c < D ? model().origin[c] + model().vertices.reference[shown[i]][c] +
                                            static_cast<double>(u[static_cast<std::size_t>(shown[i]) * D + c])
                                      : 0;
  add_fields(fields, u, frame);
  add_cracks(u, frame.cracks);
  frame.rigid_points = rigid_corners();
  return frame;
}

/// A value that is had when it is first asked for.
template <class Make>
class Lazy {
 public:
  using Value = std::invoke_result_t<Make>;
  explicit Lazy(Make make) : make_(std::move(make)) {}
  auto const& operator()() const {
    if (!value_) value_.reset(new Value(make_()));
    return *value_;
  }

 private:
  Make make_;
  mutable std::unique_ptr<Value> value_;
};

/// The fields asked for, in the order of this table, which has them all.
template <int D, class Real>
void Frames<D, Real>::add_fields(std::vector<std::string> const& names, std::vector<Real> const& u,
                                 output::Frame& frame) const {
  auto const& m = model();
  Lazy const v([&] { return m.vertices.v.download(); });
  Lazy const stresses([&] { return solver_.stresses(); });
  Lazy const memory([&] { return m.internal.memory.download(); });
  Lazy const piece([&] { return pieces(scene(), m, -1).of_element; });
  Lazy const joints([&] { return model::JointRecords<D, Real>(m.interfaces); });
  auto const vector = [](std::vector<Real> const& values, Index vertex, double* to) {
    for (int c = 0; c < D; ++c) to[c] = static_cast<double>(values[static_cast<std::size_t>(vertex) * D + c]);
  };
  auto const stress = [&](Index e) { return &stresses()[static_cast<std::size_t>(e) * 6]; };
  auto const material = [&](Index e) { return scene().bodies[m.elements.body[e]].material; };
  auto const flow = [&](auto&& value) {  // zero where nothing flows
    return [&, value](Index e, double* to) { *to = m.groups[m.elements.body[e]].plastic ? value(e) : 0; };
  };
  std::vector<FieldEntry> const table{
      {"displacement", "m", 3, false,
       [&](Index vertex, double* to) {
         vector(u, vertex, to);
         for (int c = 0; c < D && !m.vertices.start.empty(); ++c)
           to[c] -= m.vertices.start[static_cast<std::size_t>(vertex) * D + c];
       }},
      {"velocity", "m/s", 3, false, [&](Index vertex, double* to) { vector(v(), vertex, to); }},
      {"stress", "Pa", 6, true, [&](Index e, double* to) { std::copy_n(stress(e), 6, to); }},
      {"pressure", "Pa", 1, true,
       [&](Index e, double* to) { *to = -(stress(e)[0] + stress(e)[1] + stress(e)[2]) / 3; }},
      {"von_mises", "Pa", 1, true, [&](Index e, double* to) { *to = von_mises(stress(e)); }},
      {"principal", "Pa", 1, true, [&](Index e, double* to) { *to = largest_principal(stress(e)); }},
      {"body", "", 1, true, [&](Index e, double* to) { *to = m.elements.body[e]; }},
      {"fragment", "", 1, true, [&](Index e, double* to) { *to = piece()[e] + 1; }},  // from 1, the heaviest, on
      {"material", "", 1, true, [&](Index e, double* to) { *to = material(e); }},
      {"plastic_strain", "", 1, true, flow([&](Index e) { return flow_point(m, memory(), e).strain; })},
      {"plastic_rate", "1/s", 1, true, flow([&](Index e) { return flow_point(m, memory(), e).rate; })},
      {"temperature", "K", 1, true, flow([&](Index e) {
         return scene().materials[material(e)].flow->heat.reference + flow_point(m, memory(), e).rise;
       })},
      {"yield_ratio", "", 1, true, flow([&](Index e) { return yield_ratio(memory(), u, e); })},
      {"damage", "", 1, true, [&](Index e, double* to) {
         if (!m.groups[m.elements.body[e]].split) return;
         m.in_set(e, [&](auto const& set, Index cell) {
           for (int a = 0; a < set.faces; ++a) *to = std::max(*to, set.of(joints()).damage(cell, a)[1]);
         });
       }}};
  for (auto const& entry : table) {
    if (std::find(names.begin(), names.end(), entry.name) == names.end()) continue;
    auto const& places = entry.by_cell ? solver_.shown().cells : solver_.shown().vertices;
    output::Field field{entry.name, entry.unit, entry.components,
                        std::vector<double>(places.size() * static_cast<std::size_t>(entry.components), 0)};
    for (std::size_t i = 0; i < places.size(); ++i)
      entry.value(places[i], &field.values[i * static_cast<std::size_t>(entry.components)]);
    (entry.by_cell ? frame.cell_fields : frame.point_fields).push_back(std::move(field));
  }
}

/// Equivalent stress over what the law takes as yield stress now, at an element.
template <int D, class Real>
double Frames<D, Real>::yield_ratio(std::vector<Real> const& memory, std::vector<Real> const& u, Index e) const {
  auto const& group = model().groups[model().elements.body[e]];
  auto const& flow = *scene().materials[scene().bodies[group.body].material].flow;
  int const thickness = group.plastic->memory.thickness;
  double const out_of_plane = thickness < 0 ? 0 : model().remembered(memory, e, thickness);
  return std::visit(
      [&]<class Law>(Law law) {
        law = std::get<Law>(group.plastic->flow.laws);
        if constexpr (std::is_base_of_v<laws::Curves, Law>) law.numbers = flow.curves.data();
        return law.yield_ratio(flow_point(model(), memory, e), model().volume_ratio(u, e, true) * (1 + out_of_plane));
      },
      flow.law);
}

/// Softening joints (those whose largest damage is above a tenth) and broken ones, at the surface midway between their
/// sides.
template <int D, class Real>
void Frames<D, Real>::add_cracks(std::vector<Real> const& u, output::Cracks& cracks) const {
  cracks.nodes_per_cell = D;
  if (!model().plan.joints) return;
  auto const add = [&](FaceId face, FaceId other, double damage, double mode, double out_of_plane, double time) {
    double opening = 0, slip = 0;
    Vec<double, D> middle[D], gap[D];
    for (int i = 0; i < D; ++i) {
      Index const mine = model().face_vertex(face, i), theirs = model().face_vertex(other, i);
      for (int c = 0; c < D; ++c) {
        double const here = u[static_cast<std::size_t>(mine) * D + c],
                     there = u[static_cast<std::size_t>(theirs) * D + c];
        gap[i][c] = there - here;
        middle[i][c] = model().origin[c] + model().vertices.reference[mine][c] + 0.5 * (here + there);
      }
    }
    Vec<double, D> const normal = Dim<D>::face_normal(middle).normalized();
    for (int i = 0; i < D; ++i) {
      opening += std::abs(gap[i].dot(normal)) / D;
      slip += (gap[i] - normal * gap[i].dot(normal)).norm() / D;
      for (int c = 0; c < 3; ++c) cracks.points.push_back(c < D ? middle[i][c] : 0);
    }
    cracks.damage.push_back(damage);
    cracks.mode.push_back(mode);
    cracks.slip_out_of_plane.push_back(out_of_plane);
    cracks.time.push_back(time);
    cracks.opening.push_back(opening);
    cracks.slip.push_back(slip);
  };
  for (auto const& joint : solver_.fracture().broken())
    if (!model().removed(joint.side.element) && !model().removed(joint.other.element))
      add(joint.side, joint.other, 1, joint.mode, joint.out_of_plane, joint.time);
  auto const add_softening = [&](auto const& record, Index cell, int a, std::span<FaceId const> faces) {
    double const damage = record.damage(cell, a)[1];
    for (FaceId const face : faces)
      if (FaceId const other = model().neighbour(face); other.element > face.element && damage >= 0.1)
        add(face, other, std::min(damage, 0.999), record.mode(cell, a), 0, -1);
  };
  model::JointRecords<D, Real> const records(model().interfaces);
  for (auto const& group : model().groups)
    model().each_set([&](auto const& set) {
      auto const& cells = set.range(group);
      for (Index cell = cells.first; group.split && cell < cells.first + cells.count; ++cell)
        for (int a = 0; a < set.faces; ++a) add_softening(set.of(records), cell, a, set.parts(cell, a));
    });
}

}  // namespace fissure
