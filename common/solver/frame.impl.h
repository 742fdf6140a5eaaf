// What a solver shows (frames) and keeps (its state); instantiated by src2d and src3d.
#pragma once
#include "solver/probe.impl.h"

namespace fissure {

template <int D, class Real>
output::Topology Solver<D, Real>::topology() const {
  output::Topology topology;
  auto const parity = model_.parity.download();
  for (Index e : cells_shown_) {
    auto const corners = model_.cell_vertices(e);
    bool const block = model_.block_of(e) >= 0;
    topology.types.push_back(block ? Dim<D>::vtk_block : Dim<D>::vtk_simplex);
    for (std::size_t a = 0; a < corners.size(); ++a) {
      // Corners of a simplex are sorted by node; where that turned the cell over, its first two change places.
      std::size_t const corner = !block && parity[e] < 0 && a < 2 ? 1 - a : a;
      topology.cells.push_back(shown_vertex(corners[corner]));
    }
  }
  for (auto const& set : model_.holds)
    for (auto const& held : set.list.download()) topology.held.push_back(shown_vertex(held.vertex));
  std::sort(topology.held.begin(), topology.held.end());
  topology.held.erase(std::unique(topology.held.begin(), topology.held.end()), topology.held.end());
  topology.rigid_cells = static_cast<int>(scene_.plates.size() + scene_.walls.size());
  topology.rigid_type = Dim<D>::vtk_block;
  return topology;
}

/// Corners of plates where they are now and of walls as far as the bodies were long at the start, in VTK's order [m].
template <int D, class Real>
std::vector<double> Solver<D, Real>::rigid_corners() const {
  std::vector<double> points;
  auto const add = [&](Vec3 const& middle, Vec3 const& u, Vec3 const& v, Vec3 const& w) {
    for (int a = 0; a < BlockShape<D>::corners; ++a) {
      Vec3 const x = middle + (a % 4 == 1 || a % 4 == 2 ? 1 : -1) * u + (a % 4 > 1 ? 1 : -1) * v + (a > 3 ? 1 : -1) * w;
      for (int c = 0; c < 3; ++c) points.push_back(c < D ? x[c] : 0);
    }
  };
  for (std::size_t p = 0; p < scene_.plates.size(); ++p) {
    auto const& box = scene_.plates[p].box;
    Vec3 const half = box.size / 2;
    add(box.center + contact_.plate_displacement(static_cast<int>(p)), {half[0], 0, 0}, {0, half[1], 0},
        {0, 0, half[2]});
  }
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (auto const& x : model_.reference)
    for (int c = 0; c < D; ++c)
      low[c] = std::min(low[c], x[c] + model_.origin[c]), high[c] = std::max(high[c], x[c] + model_.origin[c]);
  for (int c = D; c < 3; ++c) low[c] = high[c] = 0;
  for (auto const& wall : scene_.walls) {
    Vec3 const n = wall.normal.normalized(), middle = (low + high) / 2, foot = middle - n * n.dot(middle - wall.point);
    Vec3 const first = n[0] != 0 || n[1] != 0 ? Vec3(n[1], -n[0], 0).normalized() : Vec3(1, 0, 0);
    double const half = 0.75 * (high - low).norm();
    add(foot, half * first, half * n.cross(first), {0, 0, 0});
  }
  return points;
}

template <int D, class Real>
output::Frame Solver<D, Real>::frame(std::vector<std::string> const& fields) const {
  output::Frame frame;
  frame.time = time_;
  frame.step = step_;
  auto const u = model_.u.download();
  std::size_t const n = shown_.size();
  frame.points.resize(n * 3);
  for (std::size_t i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c)
      frame.points[3 * i + c] = c < D ? model_.origin[c] + model_.reference[shown_[i]][c] +
                                            static_cast<double>(u[static_cast<std::size_t>(shown_[i]) * D + c])
                                      : 0;
  auto const vector_field = [&](char const* name, char const* unit, std::vector<Real> const& values) {
    output::Field field{name, unit, 3, std::vector<double>(n * 3, 0)};
    for (std::size_t i = 0; i < n; ++i)
      for (int c = 0; c < D; ++c)
        field.values[3 * i + c] = static_cast<double>(values[static_cast<std::size_t>(shown_[i]) * D + c]);
    frame.point_fields.push_back(std::move(field));
  };
  std::size_t const cells = cells_shown_.size();
  auto const cell_field = [&](char const* name, char const* unit, int components, auto&& value) {
    output::Field field{name, unit, components, std::vector<double>(cells * components)};
    for (std::size_t k = 0; k < cells; ++k) value(cells_shown_[k], &field.values[k * components]);
    frame.cell_fields.push_back(std::move(field));
  };
  auto const asked = [&](char const* name) { return std::find(fields.begin(), fields.end(), name) != fields.end(); };
  if (asked("displacement")) vector_field("displacement", "m", u);
  if (asked("velocity")) vector_field("velocity", "m/s", model_.v.download());
  if (asked("stress") || asked("pressure") || asked("von_mises") || asked("principal")) {
    auto const stress = element_stresses();
    auto const of = [&](Index e) { return &stress[static_cast<std::size_t>(e) * 6]; };
    if (asked("stress")) cell_field("stress", "Pa", 6, [&](Index e, double* to) { std::copy_n(of(e), 6, to); });
    if (asked("pressure"))
      cell_field("pressure", "Pa", 1, [&](Index e, double* to) { *to = -(of(e)[0] + of(e)[1] + of(e)[2]) / 3; });
    if (asked("von_mises"))
      cell_field("von_mises", "Pa", 1, [&](Index e, double* to) {
        double const* s = of(e);
        double const a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
        *to = std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
      });
    if (asked("principal"))
      cell_field("principal", "Pa", 1, [&](Index e, double* to) {
        double const* s = of(e);
        Eigen::Matrix3d sigma;
        sigma << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
        *to = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sigma, Eigen::EigenvaluesOnly).eigenvalues()[2];
      });
  }
  if (asked("body")) cell_field("body", "", 1, [&](Index e, double* to) { *to = model_.body_of_element[e]; });
  if (asked("fragment")) {  // from 1, the heaviest, on
    auto const of = pieces(-1).of_element;
    cell_field("fragment", "", 1, [&](Index e, double* to) { *to = of[e] + 1; });
  }
  if (asked("material"))
    cell_field("material", "", 1,
               [&](Index e, double* to) { *to = scene_.bodies[model_.body_of_element[e]].material; });
  if (asked("plastic_strain") || asked("plastic_rate") || asked("temperature") || asked("yield_ratio")) {
    // Zero where nothing flows.
    auto const memory = model_.memory.download();
    auto const flow_field = [&](char const* name, char const* unit, auto&& value) {
      if (!asked(name)) return;
      cell_field(name, unit, 1, [&](Index e, double* to) {
        auto const& group = model_.groups[model_.body_of_element[e]];
        *to = group.plastic ? value(flow_point(memory, e), group, e) : 0;
      });
    };
    flow_field("plastic_strain", "", [](auto const& point, auto const&, Index) { return point.strain; });
    flow_field("plastic_rate", "1/s", [](auto const& point, auto const&, Index) { return point.rate; });
    flow_field("temperature", "K", [&](auto const& point, auto const& group, Index) {
      return scene_.materials[scene_.bodies[group.body].material].flow->heat.start + point.rise;
    });
    flow_field("yield_ratio", "", [&](auto const& point, auto const& group, Index e) {
      int const thickness = group.plastic->memory.thickness;
      double const out_of_plane = thickness < 0 ? 0 : model_.remembered(memory, e, thickness);
      double ratio = 0;
      std::visit(
          [&]<class Law>(Law law) {
            law = std::get<Law>(group.plastic->flow.laws);
            if constexpr (std::is_base_of_v<laws::Curves, Law>)
              law.numbers = scene_.materials[scene_.bodies[group.body].material].flow->curves.data();
            ratio = law.yield_ratio(point, model_.volume_ratio(u, e, true) * (1 + out_of_plane));
          },
          scene_.materials[scene_.bodies[group.body].material].flow->law);
      return ratio;
    });
  }
  if (asked("damage")) {
    model::JointRecord const elements(model_.joints);
    model::JointRecord const blocks(model_.block_joints);
    cell_field("damage", "", 1, [&](Index e, double* to) {
      *to = 0;
      if (!model_.groups[model_.body_of_element[e]].split) return;
      Index const block = model_.block_of(e);
      for (int a = 0; a < (block < 0 ? C : Model::F); ++a)
        *to = std::max(*to, block < 0 ? elements.damage(e, a)[1] : blocks.damage(block, a)[1]);
    });
  }
  add_cracks(u, frame.cracks);
  frame.rigid_points = rigid_corners();
  return frame;
}

template <int D, class Real>
std::vector<bool> Solver<D, Real>::softened() const {
  std::vector<bool> some(scene_.bodies.size() + 1, false);
  model::JointRecord const elements(model_.joints);
  model::JointRecord const blocks(model_.block_joints);
  for (Index e : cells_shown_) {
    Index const block = model_.block_of(e);
    if (!model_.groups[model_.body_of_element[e]].split) continue;
    for (int a = 0; a < (block < 0 ? C : Model::F); ++a) {
      bool const bonded = block < 0 && !model_.host_bond.empty() && model_.host_bond[kernels::blocked(e, a, C)] > 0;
      if ((block < 0 ? elements.taken(e, a) : blocks.taken(block, a)) > 0)
        some[bonded ? scene_.bodies.size() : model_.body_of_element[e]] = true;
    }
  }
  return some;
}

/// Softening joints (those whose largest damage is above a tenth) and broken ones, at the surface midway between their
/// sides.
template <int D, class Real>
void Solver<D, Real>::add_cracks(std::vector<Real> const& u, output::Cracks& cracks) const {
  cracks.nodes_per_cell = D;
  if (!model_.plan.joints) return;
  auto const add = [&](Index e, int a, Index other, int face, double damage, double mode, double out_of_plane,
                       double time) {
    double opening = 0, slip = 0;
    Vec<double, D> middle[D], gap[D];
    for (int i = 0; i < D; ++i) {
      Index const mine = model_.vertex_of(e, i + (i >= a)), theirs = model_.vertex_of(other, i + (i >= face));
      for (int c = 0; c < D; ++c) {
        double const here = u[static_cast<std::size_t>(mine) * D + c],
                     there = u[static_cast<std::size_t>(theirs) * D + c];
        gap[i][c] = there - here;
        middle[i][c] = model_.origin[c] + model_.reference[mine][c] + 0.5 * (here + there);
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
  for (auto const& joint : contact_.broken())
    add(joint.element, joint.face, joint.other, joint.other_face, 1, joint.mode, joint.out_of_plane, joint.time);
  auto const add_softening = [&](auto const& record, Index cell, int a, std::span<Index const> faces) {
    double const damage = record.damage(cell, a)[1];
    for (Index const at : faces) {
      Index const e = at >> 2, face = at & 3, link = model_.host_link[kernels::blocked(e, face, C)], other = link >> 2;
      if (other > e && damage >= 0.1)
        add(e, face, other, link & 3, std::min(damage, 0.999), record.mode(cell, a), 0, -1);
    }
  };
  model::JointRecord const elements(model_.joints);
  model::JointRecord const blocks(model_.block_joints);
  for (auto const& group : model_.groups) {
    if (!group.split) continue;
    for (Index e = group.first; e < group.first + group.padded_simplices; ++e)
      for (Index a = 0; a < C; ++a) {
        Index const at = e * 4 + a;
        add_softening(elements, e, a, std::span(&at, 1));
      }
    for (Index b = group.first_block; b < group.first_block + group.blocks; ++b)
      for (int a = 0; a < Model::F; ++a) add_softening(blocks, b, a, model_.parts_at(b, a));
  }
}

/// Vertices that cells use, in order: padding is not shown.
template <int D, class Real>
void Solver<D, Real>::number_shown() {
  shown_number_.assign(model_.n_vertices, -1);
  number_of_cell_.assign(model_.n_elements, -1);
  for (Index e : model_.element_of_cell)
    if (model_.cell_head(e) == e) {
      number_of_cell_[e] = static_cast<Index>(cells_shown_.size());
      cells_shown_.push_back(e);
    }
  for (Index e : cells_shown_)
    for (Index vertex : model_.cell_vertices(e)) {
      if (shown_number_[vertex] >= 0) continue;
      shown_number_[vertex] = static_cast<Index>(shown_.size());
      shown_.push_back(vertex);
    }
}

template <int D, class Real>
template <class F>
void Solver<D, Real>::for_each_stored(F&& f) {
  f("u", model_.u), f("v", model_.v), f("link", model_.link), f("weight", model_.weight);
  auto const remembered = [&](std::string const& of, auto& joints) {
    f(of + "history", joints.history), f(of + "work", joints.work), f(of + "softening", joints.softening),
        f(of + "friction", joints.stretch), f(of + "tension", joints.tension), f(of + "offset", joints.offset),
        f(of + "whole", joints.whole);
  };
  remembered("", model_.joints), remembered("block ", model_.block_joints);
  f("block links", model_.across), f("block areas", model_.block_area);
  f("dissipated", model_.dissipated), f("viscous_work", model_.viscous_work);
  f("memory", model_.memory), f("plastic_work", model_.plastic_work);
  for (std::size_t h = 0; h < model_.holds.size(); ++h) f("held" + std::to_string(h), model_.holds[h].held);
}

template <int D, class Real>
State Solver<D, Real>::save() const {
  State state;
  const_cast<Solver*>(this)->for_each_stored(
      [&](std::string const& name, auto& buffer) { state[name] = state_bytes(buffer.download()); });
  state["scalars"] =
      state_bytes(std::vector<double>{time_, static_cast<double>(step_), started_ ? 1.0 : 0.0, last_dt_});
  stable_step_.save(state);
  insertion_.save(state);
  state["ledger"] = state_bytes(std::vector<Ledger>{ledger_});
  // As numbers: the struct has room behind its flag, which holds whatever was there.
  for (auto const& [name, s] : sampled)
    state["sampled " + name] = state_bytes(std::vector<double>{s.latest, s.peak, s.peak_time, s.any ? 1.0 : 0.0});
  contact_.save(state);
  return state;
}

template <int D, class Real>
void Solver<D, Real>::restore(State const& state) {
  for_each_stored([&](std::string const& name, auto& buffer) {
    using T = std::remove_cvref_t<decltype(*buffer.data())>;
    buffer.upload(state_values<T>(state, name, buffer.size()));
  });
  if (model_.plan.joints) model_.host_link = model_.link.download();
  for (Index const link : model_.link.download())
    check_index("link", link, 4 * static_cast<std::size_t>(model_.n_elements));
  for (Index const vertex : model_.across.download())
    check_index("block links", vertex, static_cast<std::size_t>(model_.n_vertices), -1);
  if (model_.plan.patches) model_.place_patches(device_);
  auto const scalars = state_values<double>(state, "scalars", 4);
  time_ = scalars[0], step_ = static_cast<long>(scalars[1]), started_ = scalars[2] != 0, last_dt_ = scalars[3];
  stable_step_.restore(state);
  insertion_.restore(state);
  ledger_ = state_values<Ledger>(state, "ledger", 1)[0];
  for (auto const& [name, raw] : state)
    if (name.rfind("sampled ", 0) == 0) {
      auto const numbers = state_values<double>(state, name, 4);
      sampled[name.substr(8)] = {numbers[0], numbers[1], numbers[2], numbers[3] != 0};
    }
  contact_.restore(state);
  booked_step_ = -1;
}

}  // namespace fissure
