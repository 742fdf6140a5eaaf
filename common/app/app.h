// The command line, the same in both programs.
#pragma once
#include <memory>
#include <string>

#include "backend/device.h"
#include "mesh/mesher.h"
#include "solver/simulation.h"

namespace fissure::app {

/// What a program brings along: everything else is common.
struct Program {
  std::string name;   // "fissure2d"
  int dimension = 0;  // numbers in a vector of its scenes
  mesh::Mesher const* mesher = nullptr;
  std::unique_ptr<Simulation> (*make_simulation)(Device&, scene::Scene const&, mesh::Mesh const&, Precision) = nullptr;
  // what a scene is a section of, in words; none: it is the whole
  std::string (*section)(scene::Scene const&) = nullptr;
};

/// 0: done and every expectation met; 1: an expectation failed; 2: an error, said on standard error; 130: interrupted.
int main(Program const& program, int argc, char** argv);

}  // namespace fissure::app
