// What candidates and cracks will be like once they press; a part of contact_stage.impl.h.
#pragma once
#include <algorithm>

#include "contact/contact_stage.h"

namespace fissure {

/// Bare faces of the elements that are asked for, where they are now, and how stiff what presses on them is.
template <int D, class Real>
class PressedFaces {
 public:
  static constexpr int C = D + 1;
  struct Face {
    Vec<double, D> middle, outward;     // centroid [m]; normal
    double altitude = 0, area = 0;      // in the plane [m], [m^(D-1)]
    double mass = 0;                    // of its corners [kg]
    double stiffness = 0, pressed = 0;  // as SpringBed
    bool rubs = false;

    void press(double k, double share, double pressed_share, bool with_friction) {
      stiffness = std::max(stiffness, share * k * area);
      pressed = std::max(pressed, pressed_share * k * area);
      rubs = rubs || with_friction;
    }
    /// Faces that press lie before each other, or little behind; those that are hardly opposed slide past each other.
    bool opposes(Face const& other) const {
      Vec<double, D> const way = other.middle - middle;
      return outward.dot(other.outward) < -0.05 && way.dot(outward) > -0.5 * altitude &&
             way.dot(other.outward) < 0.5 * other.altitude;
    }
  };

  /// `place`: -1 for every element, now and in the end.
  PressedFaces(model::Model<D, Real> const& model, Bonds<D, Real> const& bonds, std::vector<Index>& place)
      : model_(model), bonds_(bonds), u_(model.vertices.u.look(u_copy_)), place_(place) {
    place_.resize(model.elements.count, -1);
  }
  PressedFaces(PressedFaces const&) = delete;
  ~PressedFaces() {
    for (Index const e : elements_) place_[e] = -1;
  }

  using Faces = std::array<Face, C>;
  Faces& of(Index e);
  void press_each_other(Index a, Index b, laws::ContactLaw const& law);
  double press_on_rigid(Index e, laws::ContactLaw const& law);
  SpringBed<D> bed(FaceId at, Face const& face) const {
    SpringBed<D> bed;
    for (int i = 0; i < D; ++i) bed.vertex[i] = model_.face_vertex(at, i), bed.normal[i] = face.outward[i];
    bed.stiffness = face.stiffness, bed.pressed = face.pressed, bed.rubs = face.rubs;
    return bed;
  }
  std::vector<SpringBed<D>> beds() const {
    std::vector<SpringBed<D>> beds;
    for (Index const e : elements_)
      for (int a = 0; a < C; ++a)
        if (auto const& face = faces_[place_[e]][a]; face.stiffness > 0) beds.push_back(bed({e, a}, face));
    return beds;
  }

 private:
  model::Model<D, Real> const& model_;
  Bonds<D, Real> const& bonds_;
  std::vector<Real> u_copy_;
  std::span<Real const> u_;
  std::vector<Index>& place_;    // of an element among those asked for
  std::vector<Index> elements_;  // these
  std::vector<Faces> faces_;     // of these
};

template <int D, class Real>
typename PressedFaces<D, Real>::Faces& PressedFaces<D, Real>::of(Index e) {
  if (place_[e] >= 0) return faces_[place_[e]];
  place_[e] = static_cast<Index>(faces_.size());
  elements_.push_back(e);
  Mat<double, D> const edges = model_.moved_edges(u_, e), inverse = edges.inverse();
  double const volume = std::abs(edges.determinant()) * Dim<D>::simplex_share;
  auto& faces = faces_.emplace_back();
  for (int a = 0; a < C; ++a) {
    Vec<double, D> const gradient =
        a == 0 ? Vec<double, D>(-inverse.colwise().sum().transpose()) : Vec<double, D>(inverse.row(a - 1).transpose());
    faces[a].altitude = 1 / gradient.norm();
    faces[a].outward = -gradient.normalized();
    faces[a].area = D * volume / faces[a].altitude;
    faces[a].middle.setZero();
    for (int i = 0; i < D; ++i) {
      Index const vertex = model_.face_vertex({e, a}, i);
      faces[a].mass += model_.vertices.inertia[vertex];
      for (int c = 0; c < D; ++c)
        faces[a].middle[c] += (model_.vertices.reference[vertex][c] + u_[static_cast<std::size_t>(vertex) * D + c]) / D;
    }
  }
  return faces;
}

/// Where faces approach each other, the potentials of both elements, (D+1) p z/H at the depth z below a face of the
/// altitude H, act on both.
template <int D, class Real>
void PressedFaces<D, Real>::press_each_other(Index a, Index b, laws::ContactLaw const& law) {
  of(a), of(b);
  auto &of_a = of(a), &of_b = of(b);
  for (int i = 0; i < C; ++i)
    for (int j = 0; j < C && bonds_.bare({a, i}); ++j) {
      if (!bonds_.bare({b, j}) || !of_a[i].opposes(of_b[j])) continue;
      double const k = C * law.penalty * std::min(model_.out_of_plane(a), model_.out_of_plane(b)) *
                       (1 / of_a[i].altitude + 1 / of_b[j].altitude);
      double const ratio = of_a[i].mass / of_a[i].area * of_b[j].area / of_b[j].mass;
      of_a[i].press(k, 1 + ratio, 2, law.friction > 0), of_b[j].press(k, 1 + 1 / ratio, 2, law.friction > 0);
    }
}

/// Of a rigid body and an element one potential acts. Returns the stiffness of all the element's faces [N/m].
template <int D, class Real>
double PressedFaces<D, Real>::press_on_rigid(Index e, laws::ContactLaw const& law) {
  double sum = 0;
  for (int a = 0; a < C; ++a)
    if (auto& face = of(e)[a]; bonds_.bare({e, a})) {
      double const k = C * law.penalty * model_.out_of_plane(e) / face.altitude;
      face.press(k, 1, 1, law.friction > 0);
      sum += k * face.area;
    }
  return sum;
}

/// A contact is stiff from its first touch, and a step that is too long for it puts energy in at once: so every bare
/// face of a candidate counts as pressed as a whole.
template <int D, class Real>
void ContactStage<D, Real>::place_beds() {
  beds_are_stale_ = false;
  PressedFaces<D, Real> faces(model_, bonds_, place_of_faces_);
  auto const material = [&](Index e) { return scene_.bodies[model_.elements.body[e]].material; };
  auto const n = scene_.materials.size();
  auto const between = laws_.of_pairs().download();
  for (auto const& [a, b] : near_.all()) faces.press_each_other(a, b, between[material(a) * n + material(b)]);
  auto const rigid = [&](std::vector<contact::ElementPair> const& pairs, Buffer<laws::ContactLaw> const& of_body,
                         std::size_t bodies) {
    std::vector<double> below(bodies, 0);  // of all that each of them may touch [N/m]
    auto const laws = of_body.download();
    for (auto const& [e, body] : pairs)
      below[body] += faces.press_on_rigid(e, laws[static_cast<std::size_t>(body) * n + material(e)]);
    return below;
  };
  auto const below_plates = rigid(plate_.pairs, laws_.of_plates(), scene_.plates.size());
  rigid(wall_.pairs, laws_.of_walls(), scene_.walls.size());
  // A plate that is no wall but a mass on these springs: the top of both together is not above the sum of each alone.
  light_plate_ = 0;
  std::size_t lightest = 0;
  for (std::size_t p = 0; p < below_plates.size(); ++p)
    if (scene_.plates[p].mass > 0 && below_plates[p] / scene_.plates[p].mass > light_plate_)
      light_plate_ = below_plates[p] / scene_.plates[p].mass, lightest = p;
  beds_.faces = faces.beds();
  add_beds(faces, cracks_.download());
  beds_.joined = 0;
  if (light_plate_ > 0 && !warned_of_light_) warn_of_light(scene_.plates[lightest]);
}

/// The faces of a broken joint press with its own stiffness, corner on corner.
template <int D, class Real>
void ContactStage<D, Real>::add_beds(PressedFaces<D, Real>& faces,
                                     std::vector<kernels::CrackFace<D, Real>> const& cracks) {
  ++beds_.list;
  beds_.joined = beds_.faces.size();
  for (auto const& crack : cracks) {
    double most = 0;
    for (Real const weight : crack.weight) most = std::max(most, static_cast<double>(weight));
    for (FaceId const at : {FaceId{crack.element, crack.face}, FaceId{crack.other, crack.other_face}}) {
      auto bed = faces.bed(at, faces.of(at.element)[at.face]);
      bed.stiffness = bed.pressed = 2 * D * most * static_cast<double>(crack.stiffness);
      bed.rubs = crack.friction > 0, bed.at_corners = true;
      beds_.faces.push_back(bed);
    }
  }
}

/// What has just broken; against others its faces have beds when the list knows them.
template <int D, class Real>
void ContactStage<D, Real>::add_beds(std::vector<kernels::CrackFace<D, Real>> const& cracks) {
  PressedFaces<D, Real> faces(model_, bonds_, place_of_faces_);
  add_beds(faces, cracks);
}

/// A plate that is lighter than what its contacts ask of the stiffest vertex sets the step.
template <int D, class Real>
void ContactStage<D, Real>::warn_of_light(scene::Plate const& plate) {
  auto const rows = beds_.rows(model_.vertices.inertia, &SpringBed<D>::pressed);
  double const stiffest = *std::max_element(rows.begin(), rows.end());
  if (!(light_plate_ > 3 * stiffest)) return;
  warned_of_light_ = true;
  model_.warnings.push_back(fmt::format(
      "{}plate \"{}\": {:.3g} kg are little for the stiffness of all that it may touch, and steps get about "
      "{:.2g} times as short; from {:.2g} kg on they do not",
      plate.source.prefix(), plate.name, plate.mass, std::sqrt(light_plate_ / stiffest),
      plate.mass * light_plate_ / stiffest));
}

/// Each touched vertex is told what the step has room for.
template <int D, class Real>
void ContactStage<D, Real>::tell_room() {
  pressed_rows_.resize(model_.vertices.inertia.size(), 0);
  beds_.add_rows(model_.vertices.inertia, &SpringBed<D>::pressed, pressed_rows_);
  std::vector<double> of_touched;
  for (Index const vertex : slots_.vertices()) of_touched.push_back(pressed_rows_[vertex]);
  for (auto const& bed : beds_.faces)
    for (Index const vertex : bed.vertex) pressed_rows_[vertex] = 0;
  slots_.set_room(device_, of_touched);
}

}  // namespace fissure
