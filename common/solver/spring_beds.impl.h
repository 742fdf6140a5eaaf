// What candidates and cracks will be like once they press; a part of contact_stage.impl.h.
#pragma once
#include <algorithm>

#include "solver/contact_stage.h"

namespace fissure {

/// A contact is stiff from its first touch, and a step that is too long for it puts energy in at once: so every bare
/// face of a candidate counts as pressed as a whole. Where faces approach each other, the potentials of both elements,
/// (D+1) p z/H at the depth z below a face of the altitude H, act on both; of a rigid body and an element one.
template <int D, class Real>
void ContactStage<D, Real>::place_beds() {
  auto const u = model_.vertices.u.download();
  struct Facing {
    Vec<double, D> middle, outward;     // centroid [m]; normal
    double altitude = 0, area = 0;      // in the plane [m], [m^(D-1)]
    double mass = 0;                    // of its corners [kg]
    double stiffness = 0, pressed = 0;  // as SpringBed
    bool rubs = false;
  };
  std::vector<std::array<Facing, C>> places;
  std::vector<Index> elements, place(model_.elements.count, -1);
  auto const faces_of = [&](Index e) -> std::array<Facing, C>& {
    if (place[e] >= 0) return places[place[e]];
    place[e] = static_cast<Index>(places.size());
    elements.push_back(e);
    Mat<double, D> const edges = model_.moved_edges(u, e), inverse = edges.inverse();
    double const volume = std::abs(edges.determinant()) * Dim<D>::simplex_share;
    auto& faces = places.emplace_back();
    for (int a = 0; a < C; ++a) {
      Vec<double, D> const gradient = a == 0 ? Vec<double, D>(-inverse.colwise().sum().transpose())
                                             : Vec<double, D>(inverse.row(a - 1).transpose());
      faces[a].altitude = 1 / gradient.norm();
      faces[a].outward = -gradient.normalized();
      faces[a].area = D * volume / faces[a].altitude;
      faces[a].middle.setZero();
      for (int i = 0; i < D; ++i) {
        Index const vertex = model_.face_vertex({e, a}, i);
        faces[a].mass += model_.vertices.mass[vertex];
        for (int c = 0; c < D; ++c)
          faces[a].middle[c] +=
              (model_.vertices.reference[vertex][c] + u[static_cast<std::size_t>(vertex) * D + c]) / D;
      }
    }
    return faces;
  };
  auto const bare = [&](Index e, int a) { return bonds_.bare({e, a}); };
  auto const press = [](Facing& face, double k, double share, double pressed, bool rubs) {
    face.stiffness = std::max(face.stiffness, share * k * face.area);
    face.pressed = std::max(face.pressed, pressed * k * face.area);
    face.rubs = face.rubs || rubs;
  };
  // Faces that press lie before each other, or little behind; those that are hardly opposed slide past each other.
  auto const facing = [](Facing const& one, Facing const& other) {
    Vec<double, D> const way = other.middle - one.middle;
    return one.outward.dot(other.outward) < -0.05 && way.dot(one.outward) > -0.5 * one.altitude &&
           way.dot(other.outward) < 0.5 * other.altitude;
  };

  auto const between = between_.download();
  for (auto const& [a, b] : pairs_) {
    auto const material = [&](Index e) { return scene_.bodies[model_.elements.body[e]].material; };
    auto const& law = between[material(a) * scene_.materials.size() + material(b)];
    faces_of(a), faces_of(b);
    auto &of_a = places[place[a]], &of_b = places[place[b]];
    for (int i = 0; i < C; ++i)
      for (int j = 0; j < C && bare(a, i); ++j) {
        if (!bare(b, j) || !facing(of_a[i], of_b[j])) continue;
        double const k = C * law.penalty * std::min(model_.out_of_plane(a), model_.out_of_plane(b)) *
                         (1 / of_a[i].altitude + 1 / of_b[j].altitude);
        double const ratio = of_a[i].mass / of_a[i].area * of_b[j].area / of_b[j].mass;
        press(of_a[i], k, 1 + ratio, 2, law.friction > 0), press(of_b[j], k, 1 + 1 / ratio, 2, law.friction > 0);
      }
  }
  auto const rigid = [&](std::vector<solver::ElementPair> const& pairs, Buffer<laws::ContactLaw> const& of_body) {
    auto const laws = of_body.download();
    for (auto const& [e, body] : pairs) {
      auto const& law = laws[static_cast<std::size_t>(body) * scene_.materials.size() +
                             scene_.bodies[model_.elements.body[e]].material];
      for (int a = 0; a < C; ++a)
        if (auto& face = faces_of(e)[a]; bare(e, a))
          press(face, C * law.penalty * model_.out_of_plane(e) / face.altitude, 1, 1, law.friction > 0);
    }
  };
  rigid(plate_candidates_, plate_between_);
  rigid(wall_candidates_, wall_between_);

  beds_.faces.clear();
  ++beds_.list;
  auto const add = [&](Index e, int a, Facing const& face, bool at_corners) {
    SpringBed<D> bed;
    for (int i = 0; i < D; ++i) bed.vertex[i] = model_.face_vertex({e, a}, i), bed.normal[i] = face.outward[i];
    bed.stiffness = face.stiffness, bed.pressed = face.pressed, bed.rubs = face.rubs, bed.at_corners = at_corners;
    beds_.faces.push_back(bed);
  };
  for (Index const e : elements)
    for (int a = 0; a < C; ++a)
      if (auto const& face = places[place[e]][a]; face.stiffness > 0) add(e, a, face, false);
  // The faces of a broken joint press with its own stiffness, corner on corner.
  for (auto const& crack : cracks_.download()) {
    double most = 0;
    for (Real const weight : crack.weight) most = std::max(most, static_cast<double>(weight));
    for (auto const& [e, a] : {std::pair{crack.element, crack.face}, {crack.other, crack.other_face}}) {
      Facing face = faces_of(e)[a];
      face.stiffness = face.pressed = 2 * D * most * static_cast<double>(crack.stiffness),
      face.rubs = crack.friction > 0;
      add(e, a, face, true);
    }
  }
  expect();
}

/// Each touched vertex is told what the step has room for.
template <int D, class Real>
void ContactStage<D, Real>::expect() {
  auto const rows = beds_.rows(model_.vertices.mass, &SpringBed<D>::pressed);
  std::vector<double> of_touched;
  for (Index const vertex : slots_.vertices()) of_touched.push_back(rows[vertex]);
  slots_.set_room(device_, of_touched);
}

}  // namespace fissure
