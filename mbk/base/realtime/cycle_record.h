#pragma once

#include <array>
#include <cstdint>

namespace mbk::realtime {

/// How long something took, tick by tick, as counts of a logarithmic scale: 16 steps to a doubling from 64 ns on, so
/// that a quantile is right to 5 %. Nothing allocates.
class CycleRecord {
 public:
  void add(std::int64_t nanoseconds) noexcept;

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] std::int64_t worst() const { return worst_; }  ///< [ns]
  /// The time that a share of the ticks kept within [ns]; 0 without ticks.
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
