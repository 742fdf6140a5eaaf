// fissure2d: the command line with this dimension's shapes and solver.
#include <fmt/format.h>

#include "app/app.h"
#include "shapes.h"

namespace {

std::string section(fissure::scene::Scene const& scene) {
  if (scene.two_d == "axisymmetric")
    return "axisymmetric about the y axis; forces, masses and energies are those of a full turn";
  return fmt::format("{}, {:g} m thick", scene.two_d, scene.out_of_plane);
}

}  // namespace

int main(int argc, char** argv) {
  return fissure::app::main({"fissure2d", 2, &fissure::mesh::mesher_2d(), &fissure::make_simulation<2>, &section}, argc,
                            argv);
}
