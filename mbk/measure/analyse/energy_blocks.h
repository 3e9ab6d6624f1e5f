#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "mbk/model/trial/energy.h"

namespace mbk::analyse {

/// Sums since a start sample.
struct EnergySums {
  double squared_velocity = 0;  ///< S = ∫ v·v dt
  double absorbed = 0;          ///< E
};

/// One block of a window: the sums at each of its samples, since its begin.
struct EnergyBlock {
  double duration = 0;            ///< [s]
  EnergySums total;               ///< at its end
  std::vector<EnergySums> hull;   ///< those of the samples that the upper hull of them all touches, the first included
  std::vector<EnergySums> sums;   ///< after each interval; S never falls. Empty where `again` makes them.
  std::vector<std::size_t> next;  ///< for each of `sums` the next at which λ can be larger; the last vertex has its own
  std::function<std::vector<EnergySums>()> again;  ///< makes `sums`; asked for where a bootstrap cuts the block in two
};

/// A block with the upper hulls of its points (S, −E): of all of them, and of those from any one on. Before the block
/// are S₀ and E₀. λ = (−E₀ − E)/(S₀ + S) is the slope of the line from (−S₀, E₀), to the left of them all, and the
/// steepest such line touches the upper hull at a vertex.
/// @param sums  not empty
[[nodiscard]] EnergyBlock energy_block(double duration, std::vector<EnergySums> sums);

/// The same block without its inner sums, which `again` recomputes on demand.
[[nodiscard]] EnergyBlock outline(EnergyBlock block, std::function<std::vector<EnergySums>()> again);

/// The largest λ(t) = −E/S of blocks one after another, among all samples at which S has reached `first_share` of its
/// end and is above 0; NaN if there is none.
/// @param order  numbers of the blocks; a block may occur more than once
[[nodiscard]] double largest_shortage(const std::vector<EnergyBlock>& blocks, const std::vector<std::size_t>& order,
                                      double first_share);

/// Sums, shortages, bootstrap intervals and verdict of blocks in their order.
/// @param perturbations  whether the blocks are called perturbations in the reason
[[nodiscard]] EnergyAccount account_of(const std::vector<EnergyBlock>& blocks, bool perturbations, double first_share,
                                       int replicates, std::uint64_t seed);

}  // namespace mbk::analyse
