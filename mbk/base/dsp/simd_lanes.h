#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/savitzky_golay.h"

/// @file
/// The inner loops of filter_chain: four signals side by side, sample by sample. For the sources of this module only.
namespace mbk::dsp {

inline constexpr std::size_t kLanes = 4;
using FourValues = std::array<double, kLanes>;

/// Rows of four values, one after the other in memory.
class Interleaved {
 public:
  /// Not set to anything.
  explicit Interleaved(Index rows)
      : rows_(rows), values_(std::make_unique_for_overwrite<double[]>(kLanes * static_cast<std::size_t>(rows))) {}
  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] double* row(Index i) { return values_.get() + kLanes * static_cast<std::size_t>(i); }
  [[nodiscard]] const double* row(Index i) const { return values_.get() + kLanes * static_cast<std::size_t>(i); }

 private:
  Index rows_;
  std::unique_ptr<double[]> values_;
};

/// Four columns of equal length, less a constant each, into the rows from `first` on.
void interleave(const std::array<const double*, kLanes>& columns, Index count, const FourValues& less, double* to);

/// Adds a constant to each and writes four columns; a column that is nullptr is left out.
void separate(const double* from, Index count, const FourValues& plus, const std::array<double*, kLanes>& columns);

/// Runs a cascade over the rows in place, forward and then backward, each time from the steady state for a constant
/// input: `settled` forward, and the last output backward.
void filter_both_ways(const SectionCascade& filter, double* rows, Index count, const FourValues& settled);

inline constexpr std::size_t kMaxSums = 7;

/// Savitzky–Golay filters of one window by running sums M_k[i] = Σ_j C(j, k) x[i + j], j = −h … h.
struct RunningSums {
  Index half = 0;                ///< h
  std::size_t sums = 0;          ///< N + 1; a number that `has_running_sums` allows
  std::vector<double> binomial;  ///< C(j, k), (2h + 2)×(N + 1), from j = −h to h + 1
  std::vector<double> shares;    ///< derivative×(N + 1): what each sum contributes
};

/// Whether running sums exist for that order, and pay for that window.
[[nodiscard]] bool has_running_sums(const SavitzkyGolay& filter);

/// @param derivatives 1 … kMaxDerivatives of them    @param rate samples per second
[[nodiscard]] Result<RunningSums> running_sums(const SavitzkyGolay& filter, std::span<const int> derivatives,
                                               double rate);
inline constexpr std::size_t kMaxDerivatives = 3;

/// Where the results of `smooth` go: row i of `to` takes four of its derivative×lane values.
struct Destination {
  double* to;
  std::array<std::size_t, kLanes> from;  ///< 4·derivative + lane
};

/// Every result for `count` positions of the window, the first of which begins at `rows`.
void smooth(const RunningSums& sums, const double* rows, Index count, std::span<const Destination> destinations);

/// Σ_j w_d[j] x[i·step + j] for i = 0 … count − 1: 4·derivatives values for each i, one after the other.
/// @param weights derivative×W
void correlate_every(std::span<const double> weights, std::size_t derivatives, const double* rows, Index step,
                     Index count, double* to);

}  // namespace mbk::dsp
