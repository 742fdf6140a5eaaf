// Every law there is. A new law is one file and one line here: the input language, its reference page, the kernels and
// the law tests all read these lists.
#pragma once
#include <concepts>
#include <type_traits>
#include <variant>

#include "laws/contact.h"
#include "laws/joint.h"
#include "laws/munjiza.h"
#include "laws/neo_hookean.h"
#include "laws/plastic.h"

namespace fissure::laws {

/// What the input language and its reference page ask of every law.
template <class Law>
concept Described = requires {
  { Law::name } -> std::convertible_to<char const*>;
  Law::parameters();
};

/// Elasticity of an isotropic solid: Kirchhoff stress [Pa] and stored energy [J/m^3] from H = F - I and j = J - 1.
template <class Law>
concept BulkLaw = Described<Law> && std::is_base_of_v<ElasticConstants, Law> &&
    requires(Law const law, Mat<double, 3> const H, double const j) {
  { law.kirchhoff(H, j) } -> std::same_as<Mat<double, 3>>;
  { law.energy(H, j) } -> std::same_as<double>;
};

/// Elastoplasticity: brings the trial stress of a point back to its yield surface, and tells how near it is.
template <class Law>
concept FlowLaw = Described<Law> && requires(Law const law, ElasticConstants const elastic, FlowStep<double> const step,
                                             FlowPoint<double, Law::has_back> point, double const J) {
  law.flow(elastic, step, point);
  law.yield_ratio(point, J);
};

/// A cohesive joint: traction and damage from opening and slip [m] of a spring of stiffness k [Pa/m].
template <class Law>
concept JointLaw = Described<Law> &&
    requires(Law law, double const k, double const gap, JointHistory<double> history, JointEnergy<double> energy) {
  law.prepare();
  { law.past_peak(k, gap, gap) } -> std::same_as<bool>;
  { law.soften(k, gap, gap, history, energy) } -> std::same_as<JointTraction<double>>;
  { law.stored(k, gap, gap, history) } -> std::same_as<double>;
  { law.reach(gap, gap) } -> std::same_as<double>;
  requires std::same_as<decltype(law.penalty + law.tension + law.shear + law.residual), double>;
};

/// Contact: a penalty [Pa] and a friction coefficient [-] for two touching materials.
template <class Law>
concept ContactLike = Described<Law> && requires(Law const a, Law const b) {
  { Law::between(a, b) } -> std::same_as<Law>;
  requires std::same_as<decltype(a.penalty + a.friction), double>;
};

using AnyBulk = std::variant<NeoHookean, Munjiza>;
using AnyFlow = FlowLaws<std::variant>;  // the list stands in laws/plastic.h
using AnyJoint = std::variant<CohesiveJoint>;

// One law at a time, so that the compiler says which one lacks what.
template <BulkLaw Law>
constexpr bool is_bulk_law = true;
template <FlowLaw Law>
constexpr bool is_flow_law = true;
template <JointLaw Law>
constexpr bool is_joint_law = true;
template <class... Bulk, class... Flow, class... Joint>
constexpr bool complete(std::variant<Bulk...>*, std::variant<Flow...>*, std::variant<Joint...>*) {
  return (is_bulk_law<Bulk> && ...) && (is_flow_law<Flow> && ...) && (is_joint_law<Joint> && ...);
}
static_assert(complete(static_cast<AnyBulk*>(nullptr), static_cast<AnyFlow*>(nullptr),
                       static_cast<AnyJoint*>(nullptr)) &&
              ContactLike<ContactLaw>);

}  // namespace fissure::laws
