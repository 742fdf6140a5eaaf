// Candidates of contact of one kind: elements with elements, with plates, or with walls.
#pragma once
#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "backend/buffer.h"
#include "contact/broad_phase.h"
#include "kernels/contact.h"
#include "model/state.h"

namespace fissure {

template <int D, class Real>
struct Candidates {
  explicit Candidates(bool rigid) : rigid(rigid) {}

  bool rigid;                               // b of a pair is a plate or a wall
  std::vector<contact::ElementPair> pairs;  // ascending
  Index count = 0, first_slot = 0;
  Buffer<Index> list;  // as pairs; all of the following by pair, as kernels::PairForces and RigidForces
  Buffer<Real> spring, reaction, work, penetration, held;
  Buffer<double> wake;
  Buffer<std::uint8_t> axis;

  /// The list is now this, with the state of these friction springs.
  void set(Device& device, std::vector<contact::ElementPair> now, std::vector<Real> const& springs) {
    pairs = std::move(now);
    count = static_cast<Index>(pairs.size());
    std::vector<Index> ends;
    ends.reserve(2 * pairs.size());
    for (auto const& pair : pairs) ends.push_back(pair.a), ends.push_back(pair.b);
    list = Buffer<Index>(device, "contact candidates", ends);
    spring = Buffer<Real>(device, "contact springs", springs);
    work = Buffer<Real>(device, "contact springs", pairs.size());
    penetration = Buffer<Real>(device, "contact springs", pairs.size());
    wake = Buffer<double>(device, "contact candidates", rigid ? 0 : pairs.size());
    axis = Buffer<std::uint8_t>(device, "contact candidates",
                                std::vector<std::uint8_t>(rigid ? 0 : pairs.size(), kernels::no_axis));
    reaction = Buffer<Real>(device, "contact springs", rigid ? pairs.size() * D : 0);
    held = Buffer<Real>(device, "contact springs", pairs.size());
  }
  /// The list is what was found now, ascending, and what flew apart faster than the buffer, until its friction spring
  /// has let go. Springs stay with their pairs.
  void renew(Device& device, std::vector<contact::ElementPair> const& found) {
    auto all = with_holding(found);
    auto const springs = carried_to(all, spring.download(), 0);
    set(device, std::move(all), springs);
  }
  /// These, and those whose friction springs have not let go.
  std::vector<contact::ElementPair> with_holding(std::vector<contact::ElementPair> const& found) const {
    auto const springs = spring.download();
    std::vector<contact::ElementPair> all, holding;
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (springs[k * kernels::spring_size<D> + D] > 0) holding.push_back(pairs[k]);
    std::set_union(found.begin(), found.end(), holding.begin(), holding.end(), std::back_inserter(all));
    return all;
  }
  /// The springs of these pairs; a new one's potential begins as said (kernels::spring_size).
  std::vector<Real> carried_to(std::vector<contact::ElementPair> const& now, std::vector<Real> const& springs,
                               Real begins) const {
    std::vector<Real> fresh(kernels::spring_size<D>);
    fresh.back() = begins;
    return contact::carry_springs<Real>(fresh, pairs, springs, now);
  }
  /// Only pairs of which keep(pair) is true, with their springs.
  template <class Keep>
  void keep_only(Device& device, Keep const& keep) {
    auto const springs = spring.download();
    std::vector<contact::ElementPair> kept;
    std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(kept), keep);
    set(device, kept, carried_to(kept, springs, 0));
  }
  /// A candidate that does not touch and did not before is left alone by the kernels, so what it left behind must go.
  void forget_last_step() {
    penetration.upload(std::vector<Real>(count, Real(0)));
    work.upload(std::vector<Real>(count, Real(0)));
    reaction.upload(std::vector<Real>(reaction.size(), Real(0)));
    held.upload(std::vector<Real>(held.size(), Real(0)));
  }

  void save(State& state, std::string const& name) const {
    state["contact " + name + "s"] = state_bytes(pairs);
    state[name + " springs"] = state_bytes(spring.download());
    state[name + " penetration"] = state_bytes(penetration.download());
  }
  /// `partners`: how many there are of what b counts.
  void restore(Device& device, State const& state, std::string const& name, std::size_t elements,
               std::size_t partners) {
    auto now = state_values<contact::ElementPair>(state, "contact " + name + "s");
    for (auto const& [element, partner] : now)
      check_index("contact " + name + "s", element, elements), check_index("contact " + name + "s", partner, partners);
    auto const springs = state_values<Real>(state, name + " springs", now.size() * kernels::spring_size<D>);
    set(device, std::move(now), springs);
  }
  /// After slots have been placed, which forgets it.
  void restore_penetration(State const& state, std::string const& name) {
    penetration.upload(state_values<Real>(state, name + " penetration", pairs.size()));
  }
};

}  // namespace fissure
