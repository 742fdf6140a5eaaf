// The only file that knows the flags of kernels: when these change, no other is compiled anew.
#include "app/facts.h"

#include <fmt/format.h>

namespace fissure::app {

extern char const* const commit;  // in a file of its own, which scripts/commit.cmake writes; "" where it is not known

std::string build_facts(std::string const& program) {
  std::string text = fmt::format("{} {}\n", program, FISSURE_VERSION);
  auto const line = [&](char const* what, std::string const& is) { text += fmt::format("{:<10} {}\n", what, is); };
  if (*commit) line("commit", commit);
  line("compiler", FISSURE_COMPILER);
  line("kernels", FISSURE_KERNEL_FLAGS);
  line("precision", "double and single, one chosen by --precision");
  line("cuda", FISSURE_CUDA_FACTS);
  line("meshes", FISSURE_MESH_FACTS);
  return text;
}

}  // namespace fissure::app
