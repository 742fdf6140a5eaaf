// Any text given to the .msh reader is a mesh or an Error: never a crash, a hang or memory out of proportion.
#include <cstddef>
#include <cstdint>

#include "mesh/msh_file.h"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace fissure;
  std::string_view const text(reinterpret_cast<char const*>(data), size);
  for (mesh::CellKind kind : {mesh::CellKind::triangle, mesh::CellKind::tetrahedron}) {
    try {
      mesh::Mesh mesh = mesh::no_bodies(kind);
      mesh::add_body(mesh, mesh::read_msh("fuzz.msh", text, kind), "fuzz", {"scene.lua", 1});
      mesh::quality(mesh);
      mesh::neighbours(mesh);
    } catch (Error const&) {  // the expected answer to nonsense
    }
  }
  return 0;
}
