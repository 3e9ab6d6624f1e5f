#pragma once

#include <vector>

#include "mbk/model/trial/transfer_function.h"

namespace mbk::identify {

/// What the input does between its samples, as its steps show it. It is taken as held where
/// - it stands still, jumps from one sample to the next and stands still again (nine tenths of ΣΔu² are jumps ten times
///   as large as what the input does just before and behind), and these jumps are as large as the input itself (half
///   of its standard deviation or more), or come on a clock of their own, slower than that of the samples; or
/// - it takes no more than eight values, and jumps as large among them.
/// A staircase of one and the same small step is a coarse sensor, not a held input. What a white sequence does that
/// changes its value at every sample cannot be seen in it: it is taken for straight lines.
/// @returns zero only if it holds in all experiments; one whose input never changes says nothing
[[nodiscard]] InputHold input_hold(const std::vector<SignalPair>& experiments);

}  // namespace mbk::identify
