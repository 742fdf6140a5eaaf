// A face of a simplex, and the number that arrays keep for it: the only place on the host that packs the two.
#pragma once
#include "base/expect.h"
#include "base/lanes.h"

namespace fissure {

/// Face `face` of an element: the one across from its corner of that number. Four to an element in either dimension.
struct FaceId {
  Index element = 0;
  int face = 0;

  static constexpr FaceId unpacked(Index number) { return {number >> 2, number & 3}; }
  constexpr Index packed() const {
    FISSURE_EXPECT(element >= 0 && face >= 0 && face < 4);
    return element * 4 + face;
  }
  /// The element's corner that is corner i of the face.
  constexpr int corner(int i) const { return i + (i >= face); }
  constexpr bool operator==(FaceId const&) const = default;
};

}  // namespace fissure
