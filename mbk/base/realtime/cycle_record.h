#pragma once

#include <array>
#include <cstdint>

namespace mbk::realtime {

/// Histogram of a duration over ticks on a logarithmic scale: 16 bins per doubling from 64 ns on, so that quantiles are
/// accurate to 5 %. Never allocates.
class CycleRecord {
 public:
  void add(std::int64_t nanoseconds) noexcept;

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] std::int64_t worst() const { return worst_; }  ///< [ns]
  /// Quantile of the duration for a fraction of the ticks [ns]; 0 without ticks.
  [[nodiscard]] double quantile(double share) const;

  static constexpr int kSteps = 16, kDoublings = 30;
  /// Lower edge of a bin [ns].
  [[nodiscard]] static double edge(int bin);
  [[nodiscard]] const std::array<std::uint64_t, kSteps * kDoublings>& bins() const { return bins_; }

 private:
  std::array<std::uint64_t, kSteps * kDoublings> bins_{};
  std::uint64_t count_ = 0;
  std::int64_t worst_ = 0;
};

}  // namespace mbk::realtime
