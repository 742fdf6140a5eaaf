// How this program was built.
#pragma once
#include <string>

namespace fissure::app {

/// Lines of a name and what it is: version, commit, compiler, kernels, precisions, CUDA, meshes.
std::string build_facts(std::string const& program);

}  // namespace fissure::app
