// What a scene requires and what it does not: nothing outside the plan allocates memory or launches a kernel.
#pragma once
#include <string>
#include <vector>

#include "backend/device.h"
#include "mesh/mesh.h"
#include "scene/scene.h"

namespace fissure::model {

struct Decision {
  std::string what;  // "joints", "contact between bodies", ...
  bool modelled = false;
  std::string why;
};

struct Plan {
  bool joints = false;          // some material can crack
  bool rubbing_joints = false;  // of those, some rub where they are damaged
  bool insertion = false;       // of those, some are inserted on demand
  bool plastic = false;         // some material flows
  bool patches = false;         // of those, some share the pressure of their nodes
  bool blocks = false;          // some cells are quadrilaterals or hexahedra
  bool shared = false;          // some body cannot crack: its cells share vertices
  bool pairs = false;           // elements can touch elements
  bool plates = false, walls = false;
  bool viscous = false, mass_damping = false, gravity = false;
  bool loads = false, absorbs = false, holds = false;
  std::vector<Decision> decisions;

  bool contact() const { return pairs || plates || walls; }
};

/// Whether joints of this law in a body of these cells begin by Rankine's criterion: not where blocks and simplices
/// meet.
inline bool starts_by_stress(laws::AnyJoint const& any, bool simplices, bool blocks) {
  return !(simplices && blocks) &&
         std::visit([](auto const& joint) { return joint.rankine && !joint.independent; }, any);
}

Plan make_plan(scene::Scene const& scene, mesh::Mesh const& mesh);

/// What a model's arrays take on the device before anything touches, to a few per cent; `real`: bytes of a number (8 or
/// 4).
std::size_t bytes_foreseen(scene::Scene const& scene, mesh::Mesh const& mesh, std::size_t real);
/// Throws Error when that is more than the device has left, and says what would fit.
void require_room(Device const& device, scene::Scene const& scene, mesh::Mesh const& mesh, std::size_t real);

/// A table of the decisions for people.
std::string describe(Plan const& plan);

}  // namespace fissure::model
