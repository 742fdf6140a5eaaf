// What the mesher knows in two dimensions.
#include "shapes.h"

namespace fissure::mesh {
namespace {

class Mesher2d : public Mesher {
 public:
  Mesher const& assuming(scene::Scene const& scene) const override;
  CellKind kind() const override { return CellKind::triangle; }
  std::string_view cell_word() const override { return "tri"; }
  double cells_per_size() const override { return 2.6; }
  double thickness(scene::Scene const& scene) const override { return scene.out_of_plane; }
  Drawer const* drawer() const override { return drawer_2d(); }
};

class AxisymmetricMesher final : public Mesher2d {
 public:
  bool revolves() const override { return true; }
  Drawer const* drawer() const override { return axisymmetric_drawer(); }
};

Mesher const& Mesher2d::assuming(scene::Scene const& scene) const {
  static AxisymmetricMesher const revolving;
  return scene.two_d == "axisymmetric" ? revolving : *this;
}

}  // namespace

Mesher const& mesher_2d() {
  static Mesher2d const mesher;
  return mesher;
}

}  // namespace fissure::mesh
