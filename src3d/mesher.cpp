// What the mesher knows in three dimensions.
#include "shapes.h"

namespace fissure::mesh {
namespace {

class Mesher3d final : public Mesher {
 public:
  CellKind kind() const override { return CellKind::tetrahedron; }
  std::string_view cell_word() const override { return "tet"; }
  double cells_per_size() const override { return 4.5; }
  double thickness(scene::Scene const&) const override { return 1; }
  Drawer const* drawer() const override { return drawer_3d(); }
};

}  // namespace

Mesher const& mesher_3d() {
  static Mesher3d const mesher;
  return mesher;
}

}  // namespace fissure::mesh
