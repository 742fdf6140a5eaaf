// Position along a Hilbert curve (Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707, 2004, 381-387).
#pragma once
#include <array>
#include <cstdint>

namespace fissure::mesh {

/// Distance along the curve through the cells of a grid of 2^bits per axis; bits * axes <= 64.
inline std::uint64_t hilbert_index(std::array<std::uint32_t, 3> x, int axes, int bits) {
  // Undo the excess work from the top bit down: where an axis has the bit set invert the first axis' lower bits,
  // otherwise exchange them.
  for (std::uint32_t q = 1u << (bits - 1); q > 1; q >>= 1) {
    std::uint32_t const low = q - 1;
    for (int i = 0; i < axes; ++i) {
      if (x[i] & q) {
        x[0] ^= low;
      } else {
        std::uint32_t const t = (x[0] ^ x[i]) & low;
        x[0] ^= t;
        x[i] ^= t;
      }
    }
  }
  // Gray encode.
  for (int i = 1; i < axes; ++i) x[i] ^= x[i - 1];
  std::uint32_t t = 0;
  for (std::uint32_t q = 1u << (bits - 1); q > 1; q >>= 1)
    if (x[axes - 1] & q) t ^= q - 1;
  for (int i = 0; i < axes; ++i) x[i] ^= t;
  // The index has one bit of every axis in turn.
  std::uint64_t index = 0;
  for (int bit = bits - 1; bit >= 0; --bit)
    for (int i = 0; i < axes; ++i) index = index << 1 | (x[i] >> bit & 1);
  return index;
}

}  // namespace fissure::mesh
