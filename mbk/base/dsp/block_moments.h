#pragma once

#include <array>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/dsp/simd_lanes.h"

/// @file
/// The inner loops of decimated_chain, for four signals side by side. For the sources of this module only.
namespace mbk::dsp {

inline constexpr std::size_t kMoments = 4;
inline constexpr std::size_t kMaxModalStates = 8;

/// Blocks of L samples, what is kept of each, and how it goes on from block to block.
///   m_k = Σ_τ φ_k(τ) x(τ),   k = 0 … 3,   with τ from the centre of the block and φ_k(−τ) = (−1)ᵏ φ_k(τ)
/// States are those of the modes pᵗ: a real mode is one state, first, a complex pair two, real and imaginary part.
struct BlockFilter {
  Index length = 0;            ///< L ≥ kMoments
  std::size_t states = 0;      ///< 1 … kMaxModalStates
  std::vector<double> shapes;  ///< φ of the later half, from the end on: of every four samples, four values for each k
  std::vector<double> drive;   ///< kMoments×states: what each moment adds to Σ p⁻ᵗ x
  std::vector<double> power;   ///< pᴸ of each mode: as many values as states
};

/// Moments of blocks that follow each other, four values for each.
/// @param columns  of L·blocks samples    @param less taken from each value
void take_moments(const BlockFilter& filter, const FourColumns& columns, const FourValues& less, Index blocks,
                  double* moments);

/// Which of the other blocks a state is the sum over.
enum class Looking { back, ahead };

/// States of blocks from their moments: Σ p⁻ᵗ x of the block itself, and pᴸ times those of the block before; or
/// Σ pᵗ x, and pᴸ times those of the block behind. That one's row is there, before the first or behind the last.
void advance_modes(const BlockFilter& filter, Looking way, Index blocks, const double* moments, double* states);

/// Terms of a weighted sum that lie one after the other, four values each.
struct Terms {
  const double* at;  ///< of the first sum
  Index count;
  Index apart;  ///< doubles from one sum to the next
};

/// Whether sums take the place of what is there.
enum class Sums { written, added };

/// Σ w_d[term] term for several sums and `derivatives` sets of weights: 4·derivatives values for each sum.
/// @param weights of all derivatives for each term    @param apart  doubles from one result to the next
void weighted_sums(const std::vector<double>& weights, std::size_t derivatives, const Terms& terms, Index sums,
                   Sums how, double* to, Index apart);

}  // namespace mbk::dsp
