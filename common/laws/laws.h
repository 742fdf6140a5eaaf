// Every law there is. A new law is one file and one line here: the input language, its reference page, the kernels and
// the law tests all read these lists.
#pragma once
#include <algorithm>
#include <concepts>
#include <type_traits>
#include <variant>

#include "laws/cohesive.h"
#include "laws/contact.h"
#include "laws/damping.h"
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

/// Damping of what deforms: a stress against the rate of strain, and what it does to the step (laws/damping.h).
template <class Law>
concept Damping = requires(Law const law, Mat<double, 3> const rate, double const x) {
  { law.on() } -> std::same_as<bool>;
  { law.kirchhoff(rate, x) } -> std::same_as<Mat<double, 3>>;
  { law.slowness(x, x) } -> std::same_as<double>;
  { law.per_squared_frequency(x) } -> std::same_as<double>;
};

/// Elastoplasticity: brings the trial stress of a point back to its yield surface, and tells how near it is.
template <class Law>
concept FlowLaw = Described<Law> && requires(Law const law, ElasticConstants const elastic, FlowStep<double> const step,
                                             FlowPoint<double, Law::has_back> point, double const J) {
  law.flow(elastic, step, point);
  law.yield_ratio(point, J);
};

/// A cohesive joint: a spring of stiffness k [Pa/m] that opening and slip [m] damage. Of packs it is asked whether they
/// damage it further (holds) and what it then carries (spring, stored, rubbing, undamaged), of scalars the rest.
template <class Law>
concept JointLaw = Described<Law> && std::is_base_of_v<JointConstants, Law> &&
    requires(Law law, double k, double gap, typename Law::template History<double> history, JointEnergy<double> energy,
             Tension<double> const tension, JointGap<double> (*begun)()) {
  law.prepare();
  { law.past_peak(k, gap, gap) } -> std::same_as<bool>;
  { law.holds(k, gap, gap, history, tension) } -> std::same_as<bool>;
  { law.soften(k, gap, gap, history, energy, begun, tension) } -> std::same_as<JointTraction<double>>;
  { law.give_way(k, gap, gap, history, energy) } -> std::same_as<JointTraction<double>>;
  { law.spring(k, gap, history) } -> std::same_as<JointTraction<double>>;
  { law.stored(k, gap, gap, history) } -> std::same_as<double>;
  { law.reach(gap, gap) } -> std::same_as<double>;
  { law.rubbing(gap) } -> std::same_as<double>;
  { law.undamaged(k, gap, gap) } -> std::same_as<double>;
  requires std::same_as<decltype(history.damage), double>;
  requires sizeof(typename Law::template History<double>) == Law::template History<double>::numbers * sizeof(double);
  { history.broken() } -> std::same_as<typename Law::template History<double>>;
};

/// Contact: a penalty [Pa] and a friction coefficient [-] for two touching materials.
template <class Law>
concept ContactLike = Described<Law> && requires(Law const a, Law const b) {
  { Law::between(a, b) } -> std::same_as<Law>;
  { a.rubs() } -> std::same_as<bool>;
  { a.most(1.0) } -> std::same_as<double>;
  requires std::same_as<decltype(a.penalty + a.friction), double>;
};

using AnyBulk = std::variant<NeoHookean, Munjiza>;
using AnyFlow = FlowLaws<std::variant>;  // the list stands in laws/plastic.h
using AnyJoint = std::variant<CohesiveJoint>;

/// Numbers that the history of a joint's point has room for: as many as the law needs that remembers most.
template <class... Joints>
constexpr int most_numbers(std::variant<Joints...>*) {
  return std::max({Joints::template History<double>::numbers...});
}
inline constexpr int joint_numbers = most_numbers(static_cast<AnyJoint*>(nullptr));

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
              ContactLike<ContactLaw> && Damping<Viscosity>);

}  // namespace fissure::laws
