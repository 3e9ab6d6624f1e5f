#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mbk/model/trial/energy.h"

namespace mbk::analyse {

/// Sums since some sample.
struct EnergySums {
  double squared_velocity = 0;  ///< S = ∫ v·v dt
  double absorbed = 0;          ///< E
};

/// One block of a window: the sums at each of its samples, since its begin.
struct EnergyBlock {
  double duration = 0;            ///< [s]
  std::vector<EnergySums> sums;   ///< after each interval; S never falls. The last are those of the block.
  std::vector<std::size_t> next;  ///< for each of `sums` the next at which λ can be larger; the last vertex has its own
};

/// A block with the upper hulls of its points (S, −E): of all of them, and of those from any one on. Before the block
/// are S₀ and E₀. λ = (−E₀ − E)/(S₀ + S) is the slope of the line from (−S₀, E₀), to the left of them all, and the
/// steepest such line touches the upper hull at a vertex.
/// @param sums  not empty
[[nodiscard]] EnergyBlock energy_block(double duration, std::vector<EnergySums> sums);

/// The largest λ(t) = −E/S of blocks one after another, among all samples at which S has reached `first_share` of its
/// end and is above 0; NaN where there is none.
/// @param order  numbers of the blocks; a block may come more than once
[[nodiscard]] double largest_shortage(const std::vector<EnergyBlock>& blocks, const std::vector<std::size_t>& order,
                                      double first_share);

/// Sums, shortages, bootstrap intervals and verdict of blocks in their order.
/// @param perturbations  what the blocks are called in the reason
[[nodiscard]] EnergyAccount account_of(const std::vector<EnergyBlock>& blocks, bool perturbations, double first_share,
                                       int replicates, std::uint64_t seed);

}  // namespace mbk::analyse
