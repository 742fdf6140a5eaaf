// run.json: what was asked, what is modelled of it with which means, and what came of it.
#pragma once
#include "app/balance.h"

namespace fissure::app {

/// What is known before the first step.
void record_experiment(output::Json& record, Program const& program, Experiment const& experiment);

/// What the bodies have become: energies, pieces, what was removed, how far the balance closes.
void record_state(output::Json& record, Simulation const& simulation, EnergyBalance const& balance);

}  // namespace fissure::app
