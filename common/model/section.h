// What a flat model assumes of the third direction.
#pragma once
#include <numbers>
#include <string>
#include <vector>

namespace fissure::model {

/// Plane strain, plane stress, or the half section of what turns about the y axis; in 3D none of these.
struct Section {
  enum class Kind { plane_strain, plane_stress, axisymmetric };
  Kind kind = Kind::plane_strain;
  double thickness = 1;       // out of plane [m]; where x is the radius, all that has a volume goes once around
  std::vector<char> on_axis;  // mesh nodes; empty without axisymmetry

  Section() = default;
  /// `word`: the scene's two_d. Dimensions that are not flat know none of these.
  template <class Dim>
  Section(Dim, std::string const& word, double thickness) : thickness(thickness) {
    if (Dim::has_plane_stress && word == "plane stress") kind = Kind::plane_stress;
    if (Dim::can_revolve && word == "axisymmetric") kind = Kind::axisymmetric;
  }
  bool plane_stress() const { return kind == Kind::plane_stress; }
  bool axisymmetric() const { return kind == Kind::axisymmetric; }
  /// How far what lies at a mean radius reaches out of the plane [m].
  double reach(double mean_radius) const { return axisymmetric() ? 2 * std::numbers::pi * mean_radius : thickness; }
};

}  // namespace fissure::model
