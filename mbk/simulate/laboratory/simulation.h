#pragma once

#include <memory>

#include "mbk/base/config/document.h"
#include "mbk/experiment/protocol/experiment.h"
#include "mbk/simulate/laboratory/simulated_device.h"

namespace mbk::laboratory {

/// The planar robot of an experiment with the load described in its file; see protocol::ReadSimulation.
[[nodiscard]] Result<std::shared_ptr<const protocol::Simulation>> read_simulation(const config::Section& root,
                                                                                  const protocol::Trial& trial);

/// The scenario of a trial with a simulation from read_simulation: that of its file, with shared values from the
/// current trial.
/// @fails  usage: the trial has no such simulation.
[[nodiscard]] Result<Scenario> scenario_of(const protocol::Trial& trial);

/// The robot of such a trial.   @fails  as scenario_of and SimulatedDevice::create
[[nodiscard]] Result<std::unique_ptr<SimulatedDevice>> simulated_robot(const protocol::Trial& trial);

}  // namespace mbk::laboratory
