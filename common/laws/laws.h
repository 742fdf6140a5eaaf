// Every law there is. A new law is one file and one line here: the input language, its reference page, the kernels and the
// law tests all read these lists.
#pragma once
#include <variant>

#include "laws/contact.h"
#include "laws/joint.h"
#include "laws/munjiza.h"
#include "laws/neo_hookean.h"

namespace fissure::laws {

using AnyBulk = std::variant<Munjiza, NeoHookean>;
using AnyJoint = std::variant<MunjizaJoint, LinearJoint>;

}  // namespace fissure::laws
