#pragma once

#include <memory>

#include "mbk/base/config/document.h"
#include "mbk/experiment/protocol/experiment.h"
#include "mbk/simulate/laboratory/simulated_device.h"

namespace mbk::laboratory {

/// The planar robot of an experiment with whoever its file describes at the handle; see protocol::ReadSimulation.
[[nodiscard]] Result<std::shared_ptr<const protocol::Simulation>> read_simulation(const config::Section& root,
                                                                                  const protocol::Trial& trial);

/// What is simulated in a trial whose simulation read_simulation made: the scenario of its file, with everything that
/// stands in both as the trial has it now.
/// @fails  usage: the trial has no such simulation.
[[nodiscard]] Result<Scenario> scenario_of(const protocol::Trial& trial);

/// The robot of such a trial.   @fails  as scenario_of and SimulatedDevice::create
[[nodiscard]] Result<std::unique_ptr<SimulatedDevice>> simulated_robot(const protocol::Trial& trial);

}  // namespace mbk::laboratory
