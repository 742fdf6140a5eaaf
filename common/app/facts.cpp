// The only file that knows the commit and the flags of kernels: when these change, no other is compiled anew.
#include "app/facts.h"

#include <fmt/format.h>

#include "commit.h"  // FISSURE_COMMIT, written by scripts/commit.cmake

namespace fissure::app {

std::string build_facts(std::string const& program) {
  std::string const commit = FISSURE_COMMIT;
  std::string text = fmt::format("{} {}\n", program, FISSURE_VERSION);
  auto const line = [&](char const* what, std::string const& is) { text += fmt::format("{:<10} {}\n", what, is); };
  if (!commit.empty()) line("commit", commit);
  line("compiler", FISSURE_COMPILER);
  line("kernels", FISSURE_KERNEL_FLAGS);
  line("precision", "double and single, one chosen by --precision");
  line("cuda", FISSURE_CUDA_FACTS);
  line("meshes", FISSURE_MESH_FACTS);
  return text;
}

}  // namespace fissure::app
