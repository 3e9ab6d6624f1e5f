#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// A signal of a file with several clocks, and the clock of its samples.
struct ClockedSignal {
  std::string_view channel;  ///< for messages
  const Clock* clock;
  Vector* values;  ///< one per stamp of the clock; afterwards one per stamp of the common clock
};

/// The part of a clock covered by all signals.
struct CommonClock {
  Vector time;                     ///< [s], unchanged stamps of the chosen clock
  std::vector<std::string> notes;  ///< one sentence each: interpolated, omitted or aliased data
};

/// Converts signals of several streams to the stamps of one of them. Signals of that stream, and of streams with the
/// same stamps, keep their samples exactly; others are interpolated linearly between their two nearest samples in time.
/// Stamps that not every stream covers are omitted. Where a stream has no samples for longer than kLongestBridge median
/// intervals, its values are NaN: gaps are not filled. If all signals belong to the chosen stream, its stamps are
/// unchanged.
/// @fails  data: there are several streams, and the stamps of one run backward, repeat or are NaN; the streams do not
/// overlap; the number of samples of a signal differs from the number of stamps of its clock.
[[nodiscard]] Result<CommonClock> put_on_clock(const Clock& chosen, std::span<const ClockedSignal> signals);

/// Whether the samples of both were taken at the same times, to the bit: they need no common clock.
[[nodiscard]] bool same_stamps(const Clock& a, const Clock& b);

inline constexpr double kLongestBridge = 2.5;

/// [Hz], one over the median interval; 0 where there are fewer than two samples.
[[nodiscard]] double rate_of(const Clock& clock);

}  // namespace mbk::recording
