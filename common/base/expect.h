// Contracts: what must hold where it is written, whatever a user asks. A broken one is a bug: the program says which
// and ends. They are looked at where FISSURE_CONTRACTS is set (presets debug and threads), never on a GPU.
#pragma once
#include <cstdio>
#include <cstdlib>

namespace fissure {

[[noreturn]] inline void broken_contract(char const* what, char const* file, int line) {
  std::fprintf(stderr, "%s:%d: contract broken: %s\n", file, line, what);
  std::abort();
}

}  // namespace fissure

#if defined(FISSURE_CONTRACTS) && !defined(__CUDACC__)
#define FISSURE_EXPECT(condition) \
  ((condition) ? static_cast<void>(0) : ::fissure::broken_contract(#condition, __FILE__, __LINE__))
#else
#define FISSURE_EXPECT(condition) static_cast<void>(0)
#endif
