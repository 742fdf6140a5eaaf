// What a run says that contact cost.
#pragma once

namespace fissure {

/// Pairs of cells near each other, those of them that are looked at in this step and that touch, and lists made so far.
struct ContactCounts {
  long pairs = 0, looked_at = 0, touching = 0, lists = 0;
};

}  // namespace fissure
