// fissure2d: the command line with this dimension's shapes and solver.
#include "app/app.h"
#include "shapes.h"

int main(int argc, char** argv) {
  return fissure::app::main({"fissure2d", 2, &fissure::mesh::mesher_2d(), &fissure::make_simulation<2>}, argc, argv);
}
