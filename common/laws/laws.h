// Every law there is. A new law is one file and one line here: the input language, its reference page, the kernels and
// the law tests all read these lists.
#pragma once
#include <variant>

#include "laws/contact.h"
#include "laws/joint.h"
#include "laws/munjiza.h"
#include "laws/neo_hookean.h"
#include "laws/plastic.h"

namespace fissure::laws {

using AnyBulk = std::variant<NeoHookean, Munjiza>;
using AnyFlow = FlowLaws<std::variant>;  // the list stands in laws/plastic.h
using AnyJoint = std::variant<CohesiveJoint>;

}  // namespace fissure::laws
