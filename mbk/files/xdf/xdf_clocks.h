#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::recording {

/// [s] A stamp or an offset beyond it is no time.
inline constexpr double kLargestTime = 1e12;
inline constexpr double kLargestRate = 1e9;  ///< [Hz]

/// What the recorder found when it compared clocks: recorder = sender + value.
struct ClockOffset {
  double time = 0.0;         ///< [s], on the sender's clock
  double value = 0.0;        ///< [s]
  Index samples_before = 0;  ///< of the stream, that stand before it in the file
};

/// Samples first … last without a reset of the sender's clock, and what was added to their stamps.
struct ClockSegment {
  Index first = 0, last = -1;
  double offset = 0.0;  ///< [s], added to the stamp in the middle of the offsets
  double slope = 0.0;   ///< [s/s], of it on time
};

struct Synchronised {
  Vector time;                         ///< [s], on the recorder's clock
  std::vector<ClockSegment> segments;  ///< in the order of time; empty where there is no offset
  bool last_was_corrupt = false;       ///< the last offset was left out
  std::size_t not_finite = 0;          ///< offsets that are no numbers, which were left out
};

/// Puts stamps of the sender's clock on that of the recorder.
///
/// The last offset is corrupt, and left out, where there are more samples than the footer of the stream says, three
/// offsets or more, and it comes after more than ten times the median interval or is more than ten standard deviations
/// (1.4826 of the median absolute deviation) from the median of the others, and by more than 0.1 ms.
///
/// The sender's clock was reset where the time of the offsets runs backward, or where both their time and their value
/// jump: the interval is off its median by more than 5 s and five median absolute deviations, and the step of the value
/// by more than 1 s and ten of them. In each segment a straight line is fitted to the offsets, a + b·time, by Huber's
/// loss that is linear beyond 0.1 ms; a + b·stamp is added to the stamps of the segment. A sample belongs to the
/// segment among whose offsets it stands in the file; between the last offset of one and the first of the next, to that
/// whose offsets are nearer in time.
///
/// @param raw    [s], finite
/// @param total  samples, as the footer says
[[nodiscard]] Synchronised synchronise(const Vector& raw, std::span<const ClockOffset> offsets,
                                       std::optional<std::uint64_t> total);

/// Samples first … last without a break.
struct EvenSegment {
  Index first = 0, last = -1;
};

struct Dejittered {
  Vector time;  ///< [s]
  std::vector<EvenSegment> segments;
  double effective_hz = 0.0;   ///< intervals over the duration of all segments; 0 where that is none
  double largest_shift = 0.0;  ///< [s], of any stamp
};

/// Replaces the stamps of a stream by the straight line of least squares on their index, between breaks. A break is
/// where the sender's clock was reset, and where two stamps differ by more than 1 s and 500 samples.
/// @param nominal_hz  > 0
[[nodiscard]] Dejittered dejitter(const Vector& time, double nominal_hz, std::span<const ClockSegment> clock_segments);

/// The straight line a + b·time that fits values by Huber's loss, which is linear beyond `threshold`.
struct RobustLine {
  double offset = 0.0;  ///< at `at`
  double slope = 0.0;
  double at = 0.0;  ///< [s], the mean of the times
};
[[nodiscard]] RobustLine huber_line(const Vector& time, const Vector& values, double threshold);

}  // namespace mbk::recording
