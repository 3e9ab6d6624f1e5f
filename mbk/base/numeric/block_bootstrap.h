#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/numeric/least_squares.h"

namespace mbk::numeric {

/// RᵀZ and RᵀY over some rows.
struct Moments {
  Matrix regressors;  ///< p×p
  Matrix outputs;     ///< p×q
};

/// Draws samples of rows as long as the data from blocks of rows that follow each other, with replacement, so that the
/// correlation within a block is preserved (moving blocks, Künsch 1989). Blocks overlap and never cross a break; a
/// range that is not longer than a block is one block, as pulses are. Ranges are drawn in proportion to their rows. The
/// moments of any block are a difference of two cumulative sums, so that a sample costs nothing that grows with the
/// rows.
class BlockResampler {
 public:
  /// @param Z N×p    @param R N×p, instruments; Z itself for least squares    @param Y N×q
  /// @param ranges rows that count, in order    @param block_rows L    Holds 8 N p (p + q) bytes.
  /// @fails shapes differ; a range is not in the rows; L < 1; a value is not finite; fewer than two blocks.
  [[nodiscard]] static Result<BlockResampler> make(const Matrix& Z, const Matrix& R, const Matrix& Y,
                                                   const std::vector<RowRange>& ranges, Index block_rows);

  /// The rows of one sample: the same for the same seed and number on every machine, whatever else was drawn.
  [[nodiscard]] std::vector<RowRange> draw(std::uint64_t seed, std::uint32_t number) const;

  /// Over the rows of every range, repeated ranges counted repeatedly.
  [[nodiscard]] Moments moments(const std::vector<RowRange>& rows) const;

  [[nodiscard]] const std::vector<RowRange>& ranges() const { return ranges_; }

  /// How many blocks the data hold beside each other.
  [[nodiscard]] double blocks() const { return weights_.back(); }

 private:
  Index p_ = 0, q_ = 0, block_rows_ = 0, rows_ = 0;
  std::vector<RowRange> ranges_;
  std::vector<double> weights_;  ///< cumulative: blocks up to and with each range
  Matrix sums_;                  ///< p(p + q)×(N + 1), of all rows before each
};

struct BlockBootstrapOptions {
  Index block_rows = 1;  ///< L; longer than the residuals are correlated
  int replicates = 1000;
  std::uint64_t seed = 1;
  unsigned threads = 1;  ///< 0: number of cores; the results do not depend on it
};

/// The coefficients as they would have come out in other experiments of the same kind.
struct BlockBootstrap {
  Vector estimate;      ///< φ of the data themselves, k; without a structure vec(θ), pq
  Matrix coefficients;  ///< k×replicates
  double blocks = 0;    ///< that the data hold beside each other; below about 15 the spread is too small
};

/// Regression θ = (RᵀZ)⁻¹RᵀY of every sample, tied by θ = S φ as in LinearFit: φ = (Sᵀ(I ⊗ RᵀZ)S)⁻¹Sᵀvec(RᵀY).
/// Right for coloured residuals; their variance may depend on the regressors.
/// @param S pq×k, full column rank; empty = nothing tied
/// @fails usage: replicates < 1; S does not fit. data: as BlockResampler. not usable: in the data or in a sample the
/// terms cannot be distinguished.
[[nodiscard]] Result<BlockBootstrap> block_bootstrap(const Matrix& Z, const Matrix& R, const Matrix& Y, const Matrix& S,
                                                     const std::vector<RowRange>& ranges,
                                                     const BlockBootstrapOptions& options);

/// The interval between quantiles of the replicates, linear between order statistics, moved for a bias of the median
/// (Efron 1981): with z₀ = Φ⁻¹(share of replicates below the
/// estimate) its quantiles are Φ(2 z₀ ± z). It follows any monotone change of scale, as from a stiffness to its
/// logarithm. Where all replicates are on one side of the estimate it is the smallest or largest of them alone.
[[nodiscard]] std::pair<double, double> bias_corrected_interval(double estimate, const Vector& replicates,
                                                                double confidence);

}  // namespace mbk::numeric
