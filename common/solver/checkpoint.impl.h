// A solver's state, kept and continued; a part of solver.impl.h.
#pragma once
#include <string>

#include "solver/solver.h"

namespace fissure {

template <int D, class Real>
template <class AnyModel, class F>
void Solver<D, Real>::for_each_stored(AnyModel& model, F&& f) {
  f("u", model.vertices.u), f("v", model.vertices.v), f("link", model.interfaces.link),
      f("weight", model.interfaces.area);
  auto const remembered = [&](std::string const& of, auto& joints) {
    f(of + "history", joints.history), f(of + "work", joints.work), f(of + "softening", joints.softening),
        f(of + "friction", joints.stretch), f(of + "tension", joints.tension), f(of + "offset", joints.offset),
        f(of + "whole", joints.whole);
  };
  remembered("", model.interfaces.joints), remembered("block ", model.interfaces.block_joints);
  f("block links", model.interfaces.across), f("block areas", model.interfaces.block_area);
  f("dissipated", model.interfaces.dissipated), f("viscous_work", model.elements.viscous_work);
  f("memory", model.internal.memory), f("plastic_work", model.internal.work);
  for (std::size_t h = 0; h < model.holds.size(); ++h) f("held" + std::to_string(h), model.holds[h].held);
}

template <int D, class Real>
State Solver<D, Real>::save() const {
  State state;
  for_each_stored(model_,
                  [&](std::string const& name, auto const& buffer) { state[name] = state_bytes(buffer.download()); });
  state["scalars"] = state_bytes(std::vector<double>{time_, static_cast<double>(step_), started_ ? 1.0 : 0.0, last_dt_,
                                                     static_cast<double>(settled_), begins_ ? 1.0 : 0.0});
  stable_step_.save(state);
  insertion_.save(state);
  state["ledger"] = state_bytes(std::vector<Ledger>{ledger_});
  // As numbers: the struct has room behind its flag, which holds whatever was there.
  for (auto const& [name, s] : sampled)
    state["sampled " + name] = state_bytes(std::vector<double>{s.latest, s.peak, s.peak_time, s.any ? 1.0 : 0.0});
  removal_.save(state);
  rigid_.save(state);
  springs_.save(state);
  contact_.save(state);
  fracture_.save(state);
  return state;
}

template <int D, class Real>
void Solver<D, Real>::restore(State const& state) {
  for_each_stored(model_, [&](std::string const& name, auto& buffer) {
    using T = std::remove_cvref_t<decltype(*buffer.data())>;
    buffer.upload(state_values<T>(state, name, buffer.size()));
  });
  if (model_.plan.joints) model_.interfaces.host_link = model_.interfaces.link.download();
  for (Index const link : model_.interfaces.link.download())
    check_index("link", link, 4 * static_cast<std::size_t>(model_.elements.count));
  for (Index const vertex : model_.interfaces.across.download())
    check_index("block links", vertex, static_cast<std::size_t>(model_.vertices.count), -1);
  if (model_.plan.patches) model_.place_patches(device_);
  auto const scalars = state_values<double>(state, "scalars", 6);
  time_ = scalars[0], step_ = static_cast<long>(scalars[1]), started_ = scalars[2] != 0, last_dt_ = scalars[3];
  settled_ = static_cast<long>(scalars[4]), begins_ = scalars[5] != 0;
  stable_step_.restore(state);
  insertion_.restore(state);
  ledger_ = state_values<Ledger>(state, "ledger", 1)[0];
  for (auto const& [name, raw] : state)
    if (name.rfind("sampled ", 0) == 0) {
      auto const numbers = state_values<double>(state, name, 4);
      sampled[name.substr(8)] = {numbers[0], numbers[1], numbers[2], numbers[3] != 0};
    }
  removal_.restore(state);
  rigid_.restore(state);
  springs_.restore(state);
  contact_.restore(state);
  fracture_.restore(state);
  booked_step_ = -1;
}

}  // namespace fissure
