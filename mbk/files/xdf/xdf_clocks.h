#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/files/xdf/xdf_steps.h"

namespace mbk::recording {

/// [s] A larger stamp or offset is not a time.
inline constexpr double kLargestTime = 1e12;
inline constexpr double kLargestRate = 1e9;  ///< [Hz]
inline constexpr double kManySamples = 5.0;  ///< larger deviations, in samples, are not jitter

/// Clock comparison by the recorder: recorder = sender + value.
struct ClockOffset {
  double time = 0.0;         ///< [s], on the sender's clock
  double value = 0.0;        ///< [s]
  Index samples_before = 0;  ///< of the stream, that stand before it in the file
};

/// The straight line a + b·time fitted to values with Huber's loss, which is linear beyond `threshold`.
struct RobustLine {
  double offset = 0.0;  ///< at `at`
  double slope = 0.0;
  double at = 0.0;  ///< [s], the mean of the times
};
[[nodiscard]] RobustLine huber_line(const Vector& time, const Vector& values, double threshold);

/// Correction added to stamps of a sender's clock: a straight line, or a curve if its drift changes.
struct ClockCorrection {
  RobustLine line;
  Vector times, values;           ///< [s], points of the curve; empty if the line is added
  double begin = 0.0, end = 0.0;  ///< [s/s], slopes of the curve before its first point and behind its last one
  double bend = 0.0;              ///< [s], between curve and line, at most
  Index outliers = 0;             ///< offsets that are more than 1 ms and six standard deviations off
  double doubt = 0.0;             ///< [s], by which offsets contradict each other; 0 where they do not

  [[nodiscard]] double at(double stamp) const;
};

/// Fits a correction to the offsets of one clock.
///
/// The line is that of Huber's loss, linear beyond 0.1 ms. A line steeper than 200 µs/s, beyond any quartz, is accepted
/// only if there are at least four offsets and half of them are within 5 % of its rise; otherwise the median offset is
/// added.
///
/// The drift changes where the median of nine residuals in a row is beyond 0.1 ms and two standard deviations of single
/// offsets. Then the offsets are smoothed, by lines through the medians of half of them, of a quarter, … of nine, until
/// this is no longer so. Offsets that only repeat the previous one were not measured and are ignored.
[[nodiscard]] ClockCorrection fit_correction(const Vector& times, const Vector& values);

/// Samples first … last without a reset of the sender's clock, and the correction added to their stamps.
struct ClockSegment {
  Index first = 0, last = -1;
  ClockCorrection correction;
};

struct Synchronised {
  Vector time;                         ///< [s], on the recorder's clock
  Vector stamps;                       ///< [s], on the sender's, with its steps taken out
  std::vector<ClockSegment> segments;  ///< in the order of samples; empty where there is no offset
  std::vector<ClockStep> steps;        ///< in the order of samples
  bool last_was_corrupt = false;       ///< the last offset was ignored
  std::size_t not_finite = 0;          ///< non-finite offsets, which were ignored
  double uncovered = 0.0;              ///< [s], of stamps that are before the first offset or behind the last one

  /// Stamps on the sender's clock, its steps taken out, on that of the recorder.
  [[nodiscard]] Vector on_recorder(const Vector& sender) const;
  /// Samples at which another break begins that the stamps may not show: increasing.
  [[nodiscard]] std::vector<Index> breaks() const;
};

/// Converts stamps of the sender's clock to that of the recorder.
///
/// The last offset is corrupt, and ignored, if there are more samples than the footer of the stream states, three
/// offsets or more, and it comes after more than ten times the median interval or is more than ten standard deviations
/// (1.4826 of the median absolute deviation) from the median of the others, and by more than 0.1 ms.
///
/// The sender's clock was reset if the time of the offsets runs backward, or if both their time and value jump: the
/// interval is off its median by more than 5 s and five median absolute deviations, and the step of the value by more
/// than 1 s and ten of them. A sample belongs to the segment among whose offsets it appears in the file; between the
/// last offset of one and the first of the next, to that whose offsets are nearer in time. Where the file has the
/// offsets before or behind all samples, time alone decides. In each segment steps are taken out (`take_out_steps`),
/// and the correction that fits the offsets (`fit_correction`) is added.
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
  double lasting_shift = 0.0;  ///< [s], of those of two seconds (at least 100) on average, at most
};

/// Replaces the stamps of a stream by the straight line of least squares on their index, between breaks. A break is
/// - where two stamps differ by more than 1 s and 500 samples;
/// - where an interval is off the median one by more than five of these, and the stamps stay off: their distance from
///   an even grid, on average over 0.25 s (at least 100 samples), then changes by half of that or more, and by more
///   than six standard deviations of such changes. Samples were lost there, or the clock was set.
/// @param nominal_hz  > 0
/// @param breaks      samples at which one more begins, rising
[[nodiscard]] Dejittered dejitter(const Vector& time, double nominal_hz, std::span<const Index> breaks);

}  // namespace mbk::recording
