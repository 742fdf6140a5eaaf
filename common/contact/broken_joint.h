// A joint that broke, for the record and the pictures.
#pragma once
#include "base/face_id.h"

namespace fissure {

struct BrokenJoint {
  FaceId side, other;       // faces of elements
  double time = 0;          // when it broke [s]
  double area = 0;          // [m^2]; 2D: times thickness, or once around the axis
  double mode = 0;          // share of slip in the work that softening took
  double out_of_plane = 0;  // share of mode III in the slip
  double work = 0;          // what damage took until it broke [J]
};

}  // namespace fissure
