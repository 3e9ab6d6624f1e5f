#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// A signal of a file that has several clocks, and the clock that its samples have.
struct ClockedSignal {
  std::string_view channel;  ///< for messages
  const Clock* clock;
  Vector* values;  ///< one for each stamp of the clock; afterwards one for each that is kept of the common clock
};

/// The part of a clock that all signals cover.
struct CommonClock {
  Vector time;                     ///< [s], stamps of the chosen clock as they are
  std::vector<std::string> notes;  ///< one sentence each: what was interpolated, left out, or folds down
};

/// Puts signals of several streams on the stamps of one of them. Signals of that stream, and of those with
/// the same stamps, keep their samples to the bit;
/// those of the others are interpolated linearly between their two nearest samples in time. Stamps outside what every
/// stream covers are left out, and where a stream has no samples for longer than kLongestBridge of its median
/// intervals, its values are NaN: nothing is made up over a gap. Where all signals are of the chosen stream, its stamps
/// are not touched, whatever they are.
/// @fails  data: there are several streams, and the stamps of one run backward, repeat or are no numbers; the
///         streams do not overlap; a signal has another number of samples than its clock has stamps.
[[nodiscard]] Result<CommonClock> put_on_clock(const Clock& chosen, std::span<const ClockedSignal> signals);

/// Whether the samples of both were taken at the same times, to the bit: they need no common clock.
[[nodiscard]] bool same_stamps(const Clock& a, const Clock& b);

inline constexpr double kLongestBridge = 2.5;

/// [Hz], one over the median interval; 0 where there are fewer than two samples.
[[nodiscard]] double rate_of(const Clock& clock);

}  // namespace mbk::recording
