#pragma once

#include <memory>

#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {

/// The load at the handle in a trial, with the seed and rate of the scenario.
/// @fails  usage: as the loads.
template <int Axes>
[[nodiscard]] Result<std::unique_ptr<participant::Load<Axes>>> make_load(const Scenario& scenario,
                                                                         const SimulatedTrial<Axes>& trial);

extern template Result<std::unique_ptr<participant::Load<1>>> make_load(const Scenario&, const SimulatedTrial<1>&);
extern template Result<std::unique_ptr<participant::Load<2>>> make_load(const Scenario&, const SimulatedTrial<2>&);

}  // namespace mbk::laboratory
