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

/// Rows of as many values each, one after the other in memory.
class Interleaved {
 public:
  /// Not set to anything.    @param width values of a row
  explicit Interleaved(Index rows, Index width = static_cast<Index>(kLanes))
      : rows_(rows),
        width_(width),
        values_(std::make_unique_for_overwrite<double[]>(static_cast<std::size_t>(rows * width))) {}
  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index width() const { return width_; }
  [[nodiscard]] double* row(Index i) { return values_.get() + width_ * i; }
  [[nodiscard]] const double* row(Index i) const { return values_.get() + width_ * i; }

 private:
  Index rows_, width_;
  std::unique_ptr<double[]> values_;
};

using FourColumns = std::array<const double*, kLanes>;

/// Four columns of equal length into rows of four: (value − less)·gain.
void interleave(const FourColumns& columns, Index count, const FourValues& less, double gain, double* to);

/// Four values of each row into four columns: value·gain + plus; a column that is nullptr is left out.
/// @param width of the rows
void separate(const double* from, Index width, Index count, double gain, const FourValues& plus,
              const std::array<double*, kLanes>& columns);

/// A cascade over rows of 4, 8 or 12 values, forward or backward, continued from call to call. Each section is direct
/// form II without its gain,
///   w = u − a1 w₁ − a2 w₂,   y = w + b1/b0 w₁ + b2/b0 w₂,
/// which takes the fewest operations, and no sample waits for more than one of them.
class OneWay {
 public:
  OneWay(const SectionCascade& filter, Index width);
  /// Whether it can do that: no b0 is 0.
  [[nodiscard]] static bool can_run(const SectionCascade& filter);
  /// Π b0: what the results are to be multiplied by.
  [[nodiscard]] static double gain(const SectionCascade& filter);

  /// As after a constant that has lasted for ever.
  void settle(const double* row);
  /// In place.    @param step from one row to the next: 1 or −1
  void run(double* at, Index count, Index step);

 private:
  struct Section {
    double a1, a2, n1, n2;  // n: b1/b0, b2/b0
  };
  friend struct OneWayLoops;
  std::vector<Section> sections_;
  std::vector<double> state_;  // for each section w₁ and w₂, `width` values each
  Index width_;
  bool first_is_short_ = false;  // of first order
};

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

/// Every result for `count` positions of the window, the first of which begins at `rows`.
/// @param picks  what a row of `to` is made of: 4·derivative + lane
void smooth(const RunningSums& sums, const double* rows, Index count, std::span<const std::size_t> picks, double* to);

/// Σ_j w_d[j] x[i·step + j] for i = 0 … count − 1: 4·derivatives values for each i, one after the other.
/// @param weights derivative×W
void correlate_every(std::span<const double> weights, std::size_t derivatives, const double* rows, Index step,
                     Index count, double* to);

}  // namespace mbk::dsp
