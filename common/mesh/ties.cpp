// Ties: which nodes of one body hang on which cells of another.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/part.h"
#include "mesh/simplex.h"

namespace fissure::mesh {
namespace {

/// What of a body's boundary a tie asks for.
struct Skin {
  std::vector<int> nodes;                // ascending
  std::vector<std::array<int, 4>> face;  // its nodes, then
  std::vector<int> cell;                 // the cell behind it
  double edge = 0;                       // mean [m]
  bool on_demand = false;                // joints are inserted in the body while it runs

  Skin(scene::Scene const& scene, Mesh const& mesh, int body) {
    int const points = node_count(mesh.kind) - 1;
    for (auto const& one : mesh.boundary) {
      if (mesh.body_of_cell(one.cell) != body) continue;
      face.push_back(one.node), cell.push_back(one.cell);
      for (int i = 0; i < points; ++i) {
        nodes.push_back(one.node[i]);
        edge += (mesh.nodes[one.node[i]] - mesh.nodes[one.node[(i + 1) % points]]).norm() / points;
      }
    }
    if (!face.empty()) edge /= static_cast<double>(face.size());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    auto const& joint = scene.materials[scene.bodies[body].material].joint;
    on_demand = joint && std::visit([](auto const& law) { return law.inserted; }, *joint);
  }
};

struct Nearest {
  double off = INFINITY;  // [m]
  int face = -1;
};

/// Ties at work on a mesh.
class Tying {
 public:
  Tying(scene::Scene const& scene, Mesh& mesh) : scene_(scene), mesh_(mesh), hangs_(mesh.nodes.size(), false) {}

  void tie(int number) {
    auto const& tie = scene_.ties[number];
    Skin const one(scene_, mesh_, tie.bodies[0]), other(scene_, mesh_, tie.bodies[1]);
    bool const first_hangs = one.edge < other.edge;
    Skin const &hung = first_hangs ? one : other, &carrier = first_hangs ? other : one;
    int const carries = tie.bodies[first_hangs ? 1 : 0];
    if (carrier.on_demand)
      refuse(tie,
             fmt::format("body \"{}\" has the larger cells, so that the other one would hang on it, and its joints "
                         "are inserted on demand: what others hang on must keep its vertices; give it the smaller "
                         "cells, or insertion = \"intrinsic\"",
                         scene_.bodies[carries].name));
    double const within = tie.within.value_or(0.1 * carrier.edge);
    std::vector<int> nodes;
    for (int const n : hung.nodes)
      if (!tie.inside || tie.inside(mesh_.nodes[n][0], mesh_.nodes[n][1], mesh_.nodes[n][2])) nodes.push_back(n);
    if (nodes.empty())
      refuse(tie, "its function said true for none of the nodes on the surface of " + name(tie, first_hangs ? 0 : 1));
    auto const nearest = find_nearest(nodes, carrier, within);
    std::size_t const before = mesh_.hung.size();
    double least = INFINITY;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      least = std::min(least, nearest[k].off);
      if (!(nearest[k].off <= within) || hangs_[nodes[k]]) continue;
      hangs_[nodes[k]] = true;
      mesh_.hung.push_back(hang(nodes[k], carrier.cell[nearest[k].face], number));
    }
    if (static_cast<int>(mesh_.hung.size() - before) < node_count(mesh_.kind) - 1)
      refuse(tie,
             fmt::format("{} of the nodes of {} lie within {:.3g} m of {}{}; bodies must meet where they are tied{}",
                         mesh_.hung.size() - before, name(tie, first_hangs ? 0 : 1), within,
                         name(tie, first_hangs ? 1 : 0),
                         std::isfinite(least) ? fmt::format(", the nearest {:.3g} m away", least) : "",
                         tie.within ? "" : ", or `within` must be larger"));
  }

 private:
  std::string name(scene::Tie const& tie, int which) const {
    return fmt::format("body \"{}\"", scene_.bodies[tie.bodies[which]].name);
  }
  [[noreturn]] void refuse(scene::Tie const& tie, std::string const& text) const {
    throw Error(tie.source, fmt::format("tie \"{}\": {}", tie.name, text));
  }

  /// Of each node, among faces that a box about it reaches; sorted along the axis that the nodes reach farthest on.
  std::vector<Nearest> find_nearest(std::vector<int> const& nodes, Skin const& carrier, double within) const {
    Vec3 low = Vec3::Constant(INFINITY), high = -low;
    for (int const n : nodes) low = low.cwiseMin(mesh_.nodes[n]), high = high.cwiseMax(mesh_.nodes[n]);
    int axis = 0;
    (high - low).maxCoeff(&axis);
    std::vector<std::size_t> order(nodes.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    auto const along = [&](std::size_t k) { return mesh_.nodes[nodes[k]][axis]; };
    std::sort(order.begin(), order.end(),
              [&](auto a, auto b) { return std::pair(along(a), a) < std::pair(along(b), b); });

    std::vector<Nearest> nearest(nodes.size());
    int const points = node_count(mesh_.kind) - 1;
    for (std::size_t f = 0; f < carrier.face.size(); ++f) {
      auto const corner = [&](int i) -> Vec3 const& { return mesh_.nodes[carrier.face[f][i]]; };
      Vec3 from = corner(0), to = corner(0);
      for (int i = 1; i < points; ++i) from = from.cwiseMin(corner(i)), to = to.cwiseMax(corner(i));
      // Nodes that are too far are looked at as well, by ten times: a message tells how far the nearest is.
      double const margin = 10 * within;
      auto at = std::lower_bound(order.begin(), order.end(), from[axis] - margin,
                                 [&](std::size_t k, double x) { return along(k) < x; });
      for (; at != order.end() && along(*at) <= to[axis] + margin; ++at) {
        Vec3 const& p = mesh_.nodes[nodes[*at]];
        if (((p - from).array() < -margin).any() || ((p - to).array() > margin).any()) continue;
        double const off =
            points == 2 ? distance(p, corner(0), corner(1)) : distance(p, corner(0), corner(1), corner(2));
        if (off < nearest[*at].off) nearest[*at] = {off, static_cast<int>(f)};
      }
    }
    return nearest;
  }

  /// Shares in the corners of the cell, so that what moves all of them alike, turns or stretches them, moves the node
  /// with them to the last digit, also where it lies a little beside the cell.
  HungNode hang(int node, int cell, int tie) const {
    int const corners = node_count(mesh_.kind);
    Simplex const simplex(std::span(&mesh_.cells[static_cast<std::size_t>(cell) * corners], corners), mesh_.nodes);
    HungNode hung{node, cell, tie, {}};
    Vec3 const shares = simplex.edges().inverse() * (mesh_.nodes[node] - simplex.point[0]);
    hung.share[0] = 1;
    for (int a = 1; a < corners; ++a) hung.share[a] = shares[a - 1], hung.share[0] -= shares[a - 1];
    return hung;
  }

  scene::Scene const& scene_;
  Mesh& mesh_;
  std::vector<char> hangs_;
};

}  // namespace

void tie_bodies(Mesh& mesh, scene::Scene const& scene) {
  Tying tying(scene, mesh);
  for (int k = 0; k < static_cast<int>(scene.ties.size()); ++k) tying.tie(k);
}

}  // namespace fissure::mesh
