// What one dimension knows of meshes and does with a shape: the part of the mesher that src2d and src3d fulfil.
#pragma once
#include <string_view>

#include "mesh/mesh.h"

namespace fissure::mesh {

/// Draws shapes with Gmsh's OpenCASCADE kernel, in the model that is current there. Every add() returns the tag of one
/// entity of the program's dimension (a surface or a volume) and throws Error at `at` for sizes that make no sense.
class Drawer {
 public:
  virtual ~Drawer() = default;

  /// Gmsh's options for an attempt, counted from 0: the next is made when one failed or left slivers.
  virtual int attempts() const = 0;
  virtual void choose_algorithms(int attempt) const = 0;

  virtual int add(scene::Box const& box, Source const& at) const = 0;
  virtual int add(scene::Disc const& disc, Source const& at) const = 0;
  virtual int add(scene::Rod const& rod, Source const& at) const = 0;
  virtual int add(scene::Ball const& ball, Source const& at) const = 0;
  virtual int add(scene::Ring const& ring, Source const& at) const = 0;
  virtual int add(scene::Polygon const& polygon, Source const& at) const = 0;
  /// In 2D the section alone.
  virtual int add(scene::Revolved const& revolved, Source const& at) const = 0;
  /// The slot to be taken from a body that reaches from z = back to z = front.
  virtual int add(scene::Notch const& notch, double back, double front, Source const& at) const = 0;
  /// The seam as an entity of one dimension less: in 3D a line reaches beyond z = back and z = front.
  virtual int add(scene::Seam const& seam, double back, double front, Source const& at) const = 0;
};

class Mesher {
 public:
  virtual ~Mesher() = default;

  virtual CellKind kind() const = 0;
  /// What MeshSpec::cells calls them: "tri" or "tet".
  virtual std::string_view cell_word() const = 0;
  /// The one that meshes what `scene` assumes: in axisymmetry half sections of what stands on the axis.
  virtual Mesher const& assuming(scene::Scene const&) const { return *this; }
  /// Whether it is that one: sections turn about the y axis.
  virtual bool revolves() const { return false; }
  /// Out of plane [m].
  virtual double thickness(scene::Scene const& scene) const = 0;
  /// Unstructured cells in a measure of size^d, from experience.
  virtual double cells_per_size() const = 0;
  /// Null in a build without Gmsh.
  virtual Drawer const* drawer() const = 0;
};

/// Refuses what is not a finite number above zero: `disc: radius must be above 0 (it is -1)`.
void require_positive(double value, char const* shape, char const* what, Source const& at);
/// Refuses coordinates that are not finite.
void require_finite(Vec3 const& point, char const* shape, Source const& at);
/// Refuses a ring whose hole is not smaller than itself.
void require_ring(scene::Ring const& ring, Source const& at);
/// The four corners of a notch, counter-clockwise.
std::array<std::array<double, 2>, 4> notch_corners(scene::Notch const& notch, Source const& at);
/// Refuses a seam without length, and a polygon that is not flat or crosses itself.
void require_seam(scene::Seam const& seam, Source const& at);
/// The polygon's corners without a repeated last one; refuses fewer than three, crossing sides and clockwise order.
std::vector<std::array<double, 2>> polygon_corners(scene::Polygon const& polygon, Source const& at,
                                                   char const* shape = "polygon");
/// The same of a section that is revolved; refuses what lies beyond the axis.
std::vector<std::array<double, 2>> section_corners(scene::Revolved const& revolved, Source const& at);

}  // namespace fissure::mesh
