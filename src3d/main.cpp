// fissure3d: the command line with this dimension's shapes and solver.
#include "app/app.h"
#include "shapes.h"

int main(int argc, char** argv) {
  return fissure::app::main({"fissure3d", 3, &fissure::mesh::mesher_3d(), &fissure::make_simulation<3>}, argc, argv);
}
