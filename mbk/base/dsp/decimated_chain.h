#pragma once

#include <array>
#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/dsp/block_moments.h"
#include "mbk/base/dsp/filter_chain.h"

/// @file
/// Every Nth row of filter_chain, without computing the others. For the sources of this module only.
namespace mbk::dsp {

/// Smoothing and zero-phase low-pass of a signal without ends are one weighted sum, whose weights beyond the smoothing
/// window are exponentials: with the poles p of the low-pass H(z) = κ + Σ ρ_p/(1 − p z⁻¹), c_p = ρ_p H(1/p) and the
/// smoothing weights w_j, j = −h … h,
///   y[i] = Σ_t g(i + h − t) x[t],   g(λ) = Σ_j w_j r(λ + j),   r(l) = Σ_p c_p p^|l| + κ H(∞) δ_l.
/// So y needs the samples near to it, and the sums Σ p^|…| x over all before and all after, which go on from block to
/// block. In a block that is short beside the period of the cutoff, g is a polynomial of third degree to 5·10⁻⁵, and
/// what it is not meets only what the signal is not: the moments of a block stand for its samples to kDecimationError.
///
/// The ends differ from those of a signal that goes on by sums of exponentials, too. Rows before the first are
/// s[−m] = 2 s[0] − s[m] of what has been smoothed (or as the padding says), and then constant; behind the last padded
/// row the way back begins as after a constant of what the way there gave. Both are taken in without any row between:
///   before the start   Σ_p c_p pⁱ Σ_{m<0} p⁻ᵐ (s[m] − ŝ[m])
/// with ŝ what the weighted sum saw there, and likewise behind the end.
class DecimatedChain {
 public:
  /// @returns nothing where blocks of at least kMoments samples are no short ones, where `every` rows are no multiple
  /// or part of a short block, and for a low-pass whose poles lie close together, on the real axis, or are too many.
  /// @param derivatives 1 … kMaxDerivatives    @param every ≥ 1    @fails as savitzky_golay_weights
  [[nodiscard]] static Result<std::optional<DecimatedChain>> plan(const FilterChain& chain,
                                                                  std::span<const int> derivatives, Hertz rate,
                                                                  Index every);

  /// Samples that a signal must have.
  [[nodiscard]] Index shortest() const;

  /// @param values  of row 0, `every`, …: 4·derivatives for each, derivative by derivative
  void run(const FourColumns& columns, Index length, const FourValues& less, double* values) const;

 private:
  using Complex = std::complex<double>;
  /// Four signals at once.
  using FourComplex = Eigen::Array<Complex, static_cast<int>(kLanes), 1>;
  struct Mode {
    Complex p;
    Complex c, rho;
    double weight;  ///< 2 if it also represents its conjugate
  };
  /// One derivative of the smoothing.
  struct Smoothing {
    Vector weights;
    double parity;                        ///< w_{−j} = parity·w_j
    std::vector<std::vector<Complex>> U;  ///< of each mode: Σ_{j ≥ −λ} w_j p^(λ + j) for λ = −h … h
  };
  /// What is beyond an end, seen outwards from it: row −1 is the first beyond it.
  struct End {
    Interleaved samples;               ///< from the end inwards
    std::vector<double> smoothed;      ///< rows 0 … padding, 4·derivatives values each
    std::vector<FourComplex> missing;  ///< Σ_{m<0} p⁻ᵐ (s[m] − ŝ[m]), mode by mode for each derivative
    explicit End(Index count) : samples(count) {}
    [[nodiscard]] auto sample(Index t) const { return Eigen::Map<const Eigen::Array4d>(samples.row(t)); }
  };
  /// Weights of the sums that give one row of a block, of all derivatives for each term.
  struct Row {
    std::vector<double> near, back, ahead;
  };

  [[nodiscard]] static std::optional<std::vector<Mode>> modes_of(const SectionCascade& lowpass, double& kappa);
  [[nodiscard]] bool choose_blocks();
  void prepare_blocks(const Matrix& shapes);
  void prepare_rows(const Matrix& shapes);
  [[nodiscard]] std::vector<double> weights_of_states(double distance, bool ahead) const;
  [[nodiscard]] Vector kernel(const Smoothing& smoothing, Index reach) const;
  [[nodiscard]] End end_of(const FourColumns& columns, Index length, const FourValues& less, bool last,
                           Index filled) const;
  void take_blocks(const FourColumns& columns, Index length, const FourValues& less, Index first, Index end,
                   double* moments) const;
  [[nodiscard]] Eigen::Array4d extended(const End& end, std::size_t derivative, Index i) const;
  [[nodiscard]] std::vector<FourComplex> sums_before(Index n, const double* states, const FourColumns& columns,
                                                     const FourValues& less) const;
  [[nodiscard]] std::vector<FourComplex> behind_end(const End& start, const End& end, Index n,
                                                    const std::vector<FourComplex>& sums) const;
  void add_modes(const std::vector<FourComplex>& amplitudes, Index offset, bool backwards, Index rows,
                 double* values) const;
  template <class Use>
  void for_rows(Index begin, Index behind, Index rows, Use&& use) const;
  /// The last block that ends before sample n.
  [[nodiscard]] Index last_block_before(Index n) const { return (n - first_) / filter_.length - 1; }
  /// The block in which the r-th row is.
  [[nodiscard]] Index block_of(Index r) const { return (half_ + r * every_ - first_) / filter_.length; }

  Index every_ = 1, half_ = 0, rows_per_block_ = 1, blocks_per_row_ = 1;
  Index place_ = 0;               ///< of the first row of a block
  Index first_ = 0;               ///< sample at which the first block begins, ≤ 0
  Index before_ = 0, after_ = 0;  ///< blocks on either side that are near to a row
  Padding padding_;
  std::vector<Mode> modes_;
  double kappa_ = 0.0, direct_ = 0.0;  ///< of H, and κ H(∞)
  std::vector<Smoothing> smoothing_;
  BlockFilter filter_;
  std::vector<Row> rows_;  ///< of each block
};

}  // namespace mbk::dsp
