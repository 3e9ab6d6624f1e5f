#pragma once

#include <vector>

#include "mbk/model/trial/transfer_function.h"

namespace mbk::identify {

/// Behaviour of the input between its samples, from its steps. A zero-order hold is assumed if
/// - it is constant, steps from one sample to the next and is constant again (nine tenths of ΣΔu² are steps ten times
/// as
///   large as the changes just before and after), and these steps are large (at least half of the standard deviation of
///   the input) or occur on a regular clock slower than that of the samples; or
/// - it has at most eight values, with equally large steps between them.
/// A staircase of one small step size is a coarse sensor, not a held input. A white sequence that changes at every
/// sample does not show its behaviour between samples: linear interpolation is assumed.
/// @returns zero only if it applies to all experiments; a constant input is ignored
[[nodiscard]] InputHold input_hold(const std::vector<SignalPair>& experiments);

}  // namespace mbk::identify
