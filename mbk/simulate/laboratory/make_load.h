#pragma once

#include <memory>

#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {

/// What hangs at the handle of a planar trial, with the scenario's seed and rate.
/// @fails  usage: as the loads.
[[nodiscard]] Result<std::unique_ptr<participant::Load>> make_load(const Scenario& scenario, const PlanarTrial& trial);

}  // namespace mbk::laboratory
