// Ties: which nodes of one body hang on which cells of another.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/part.h"
#include "mesh/simplex.h"

namespace fissure::mesh {
namespace {

/// What of a body's boundary a tie asks for.
struct Skin {
  std::vector<int> nodes;                 // ascending
  std::vector<std::vector<Vec3>> facing;  // of each: unit normals of its faces, outward
  std::vector<std::array<int, 4>> face;   // its nodes, then
  std::vector<int> cell;                  // the cell behind it
  std::vector<Vec3> normal;               // outward
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);
  bool on_demand = false;  // joints are inserted in the body while it runs

  Skin(scene::Scene const& scene, Mesh const& mesh, int body) {
    for (auto const& one : mesh.boundary) {
      if (mesh.body_of_cell(one.cell) != body) continue;
      face.push_back(one.node), cell.push_back(one.cell), normal.push_back(outward(mesh, one).normalized());
      for (int i = 0; i < node_count(mesh.kind) - 1; ++i) nodes.push_back(one.node[i]);
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    facing.resize(nodes.size());
    for (std::size_t f = 0; f < face.size(); ++f)
      for (int i = 0; i < node_count(mesh.kind) - 1; ++i)
        facing[std::lower_bound(nodes.begin(), nodes.end(), face[f][i]) - nodes.begin()].push_back(normal[f]);
    for (int const n : nodes) low = low.cwiseMin(mesh.nodes[n]), high = high.cwiseMax(mesh.nodes[n]);
    auto const& joint = scene.materials[scene.bodies[body].material].joint;
    on_demand = joint && std::visit([](auto const& law) { return law.inserted; }, *joint);
  }
  /// Mean edge of the faces whose boxes meet the other's [m]; of all where none does.
  double edge_near(Skin const& other, Mesh const& mesh) const {
    int const points = node_count(mesh.kind) - 1;
    double near = 0, all = 0;
    int count = 0;
    for (auto const& nodes_of : face) {
      double edge = 0;
      Vec3 from = mesh.nodes[nodes_of[0]], to = from;
      for (int i = 0; i < points; ++i) {
        Vec3 const &one = mesh.nodes[nodes_of[i]], &next = mesh.nodes[nodes_of[(i + 1) % points]];
        edge += (next - one).norm() / points;
        from = from.cwiseMin(one), to = to.cwiseMax(one);
      }
      all += edge;
      double const margin = 0.2 * edge;
      if (((from - other.high).array() > margin).any() || ((other.low - to).array() > margin).any()) continue;
      near += edge, ++count;
    }
    return count > 0 ? near / count : face.empty() ? 0 : all / static_cast<double>(face.size());
  }

 private:
  static Vec3 outward(Mesh const& mesh, Face const& face) {
    Vec3 const along = mesh.nodes[face.node[1]] - mesh.nodes[face.node[0]];
    if (node_count(mesh.kind) == 3) return {along[1], -along[0], 0};
    return along.cross(mesh.nodes[face.node[2]] - mesh.nodes[face.node[0]]);
  }
};

struct Nearest {
  double off = INFINITY, within = 0;  // how far it lies, and may lie, from the face [m]
  int face = -1;
};

/// Ties at work on a mesh.
class Tying {
 public:
  Tying(scene::Scene const& scene, Mesh& mesh) : scene_(scene), mesh_(mesh), place_(mesh.nodes.size(), -1) {}

  void tie(int number) {
    auto const& tie = scene_.ties[number];
    Skin const one(scene_, mesh_, tie.bodies[0]), other(scene_, mesh_, tie.bodies[1]);
    double const edges[2] = {one.edge_near(other, mesh_), other.edge_near(one, mesh_)};
    bool const first_hangs = edges[0] < 0.999 * edges[1];  // of like edges the second
    Skin const &hung = first_hangs ? one : other, &carrier = first_hangs ? other : one;
    std::string const hanging = name(tie, first_hangs ? 0 : 1), carrying = name(tie, first_hangs ? 1 : 0);
    if (carrier.on_demand)
      refuse(tie,
             fmt::format("{} has the larger cells there ({:.3g} and {:.3g} m), so that the other one would hang on "
                         "it, and its joints are inserted on demand: what others hang on must keep its vertices; "
                         "give it the smaller cells, or insertion = \"intrinsic\"",
                         carrying, edges[first_hangs ? 1 : 0], edges[first_hangs ? 0 : 1]));
    std::vector<std::size_t> asked;  // of hung.nodes
    for (std::size_t k = 0; k < hung.nodes.size(); ++k) {
      Vec3 const& x = mesh_.nodes[hung.nodes[k]];
      if (!tie.inside || tie.inside(x[0], x[1], x[2])) asked.push_back(k);
    }
    if (asked.empty()) refuse(tie, "its function said true for none of the nodes on the surface of " + hanging);
    auto const nearest = find_nearest(hung, asked, carrier, tie.within);
    int found = 0, taken = 0;
    double least = INFINITY;
    for (std::size_t k = 0; k < asked.size(); ++k) {
      least = std::min(least, nearest[k].off);
      if (!(nearest[k].off <= nearest[k].within)) continue;
      hang(hung.nodes[asked[k]], carrier.cell[nearest[k].face], number) ? ++found : ++taken;
    }
    if (found >= node_count(mesh_.kind) - 1) return;
    if (found + taken >= node_count(mesh_.kind) - 1)
      refuse(tie, fmt::format("what it would tie of {} hangs already, by a tie before it", hanging));
    refuse(tie,
           fmt::format("{} of the nodes of {} lie against {}, to within {}{}; bodies must meet where they are tied, "
                       "surface on surface{}",
                       found + taken, hanging, carrying,
                       tie.within ? fmt::format("{:.3g} m", *tie.within) : "a fifth of an edge",
                       std::isfinite(least) ? fmt::format(" (the nearest is {:.3g} m away)", least) : "",
                       tie.within ? "" : ", or `within` must be larger"));
  }

 private:
  std::string name(scene::Tie const& tie, int which) const {
    return fmt::format("body \"{}\"", scene_.bodies[tie.bodies[which]].name);
  }
  [[noreturn]] void refuse(scene::Tie const& tie, std::string const& text) const {
    throw Error(tie.source, fmt::format("tie \"{}\": {}", tie.name, text));
  }

  /// Of some nodes, among faces that face them; sorted along the axis that the nodes reach farthest on.
  std::vector<Nearest> find_nearest(Skin const& hung, std::vector<std::size_t> const& asked, Skin const& carrier,
                                    std::optional<double> within) const {
    std::vector<std::size_t> order(asked.size());
    std::iota(order.begin(), order.end(), 0);
    int axis = 0;
    (hung.high - hung.low).maxCoeff(&axis);
    auto const place = [&](std::size_t k) -> Vec3 const& { return mesh_.nodes[hung.nodes[asked[k]]]; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(place(a)[axis], a) < std::pair(place(b)[axis], b);
    });

    std::vector<Nearest> nearest(asked.size());
    int const points = node_count(mesh_.kind) - 1;
    for (std::size_t f = 0; f < carrier.face.size(); ++f) {
      auto const corner = [&](int i) -> Vec3 const& { return mesh_.nodes[carrier.face[f][i]]; };
      Vec3 from = corner(0), to = corner(0);
      for (int i = 1; i < points; ++i) from = from.cwiseMin(corner(i)), to = to.cwiseMax(corner(i));
      // Nodes that are too far are looked at as well, by ten times: a message tells how far the nearest is.
      double longest = 0;
      for (int i = 0; i < points; ++i) longest = std::max(longest, (corner(i) - corner((i + 1) % points)).norm());
      double const reach = within.value_or(0.2 * longest), margin = 10 * reach;
      auto at = std::lower_bound(order.begin(), order.end(), from[axis] - margin,
                                 [&](std::size_t k, double x) { return place(k)[axis] < x; });
      for (; at != order.end() && place(*at)[axis] <= to[axis] + margin; ++at) {
        Vec3 const& p = place(*at);
        if (((p - from).array() < -margin).any() || ((p - to).array() > margin).any()) continue;
        auto const& normals = hung.facing[asked[*at]];
        if (std::ranges::none_of(normals, [&](Vec3 const& n) { return n.dot(carrier.normal[f]) < -0.5; })) continue;
        double off = points == 2 ? distance(p, corner(0), corner(1)) : distance(p, corner(0), corner(1), corner(2));
        if (off < nearest[*at].off) nearest[*at] = {off, reach, static_cast<int>(f)};
      }
    }
    return nearest;
  }

  /// False: it hangs already, or what is to carry it hangs on it.
  bool hang(int node, int cell, int tie) {
    if (place_[node] >= 0) return false;
    auto const one = shares(node, cell, tie);
    if (leads_to(one, node)) return false;
    place_[node] = static_cast<int>(mesh_.hung.size());
    mesh_.hung.push_back(one);
    return true;
  }
  bool leads_to(HungNode const& from, int node) const {
    int const corners = node_count(mesh_.kind);
    for (int a = 0; a < corners; ++a) {
      int const carrier = mesh_.cells[static_cast<std::size_t>(from.cell) * corners + a];
      if (!carries(from, a)) continue;
      if (carrier == node || (place_[carrier] >= 0 && leads_to(mesh_.hung[place_[carrier]], node))) return true;
    }
    return false;
  }

  /// Shares in the corners of the cell, so that what moves all of them alike, turns or stretches them, moves the node
  /// with them to the last digit, also where it lies a little beside the cell.
  HungNode shares(int node, int cell, int tie) const {
    int const corners = node_count(mesh_.kind);
    Simplex const simplex(std::span(&mesh_.cells[static_cast<std::size_t>(cell) * corners], corners), mesh_.nodes);
    HungNode hung{node, cell, tie, {}};
    Vec3 const share = simplex.edges().inverse() * (mesh_.nodes[node] - simplex.point[0]);
    hung.share[0] = 1;
    for (int a = 1; a < corners; ++a) hung.share[a] = share[a - 1], hung.share[0] -= share[a - 1];
    return hung;
  }

  scene::Scene const& scene_;
  Mesh& mesh_;
  std::vector<int> place_;  // of each node in Mesh::hung; -1: it does not hang
};

}  // namespace

void tie_bodies(Mesh& mesh, scene::Scene const& scene) {
  Tying tying(scene, mesh);
  for (int k = 0; k < static_cast<int>(scene.ties.size()); ++k) tying.tie(k);
}

}  // namespace fissure::mesh
