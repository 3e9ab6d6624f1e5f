#include "mbk/measure/preprocess/jittered_clock.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/measure/preprocess/resample.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {
namespace {

constexpr double kJitter = 0.01;  // of an interval

Vector fourth_differences(const Vector& x) {
  const Index n = x.size() - 4;
  return x.head(n) - 4.0 * x.segment(1, n) + 6.0 * x.segment(2, n) - 4.0 * x.segment(3, n) + x.tail(n);
}

/// Sums of a regression through zero, each channel weighed by its residual.
struct Sums {
  double gg = 0.0, gh = 0.0;
};

Sums regress(const Vector& x, const Vector& delay, double step) {
  constexpr Index kReach = 3;  // samples on either side of a slope
  const Index n = x.size();
  Vector shift = Vector::Zero(n);  // v δ
  const Index inner = n - 2 * kReach;
  shift.segment(kReach, inner) =
      (x.tail(inner) - x.head(inner)).array() / (2.0 * kReach * step) * delay.segment(kReach, inner).array();
  const Vector g = fourth_differences(shift.segment(kReach, inner));
  const Vector h = fourth_differences(x.segment(kReach, inner));
  const double gg = g.squaredNorm();
  if (!(gg > 0.0)) return {};
  const double gh = g.dot(h);
  const double variance = (h - gh / gg * g).squaredNorm() / static_cast<double>(h.size());
  if (!(variance > 0.0)) return {};
  return {gg / variance, gh / variance};
}

/// The even clock that lies nearest to the stamps, by least squares: the first and the last stamp jitter as others do.
Vector even_clock(const Vector& time) {
  const Index n = time.size();
  const Vector number = Vector::LinSpaced(n, -0.5 * static_cast<double>(n - 1), 0.5 * static_cast<double>(n - 1));
  const double step = number.dot(time) / number.squaredNorm();
  return (time.mean() + step * number.array()).matrix();
}

}  // namespace

StampEvidence stamp_evidence(const Recording& recording) {
  constexpr Index kMin = 100;
  // noise of fourth differences is correlated: Σ ρ² over all lags is 12870/4900, whatever the jitter
  constexpr double kCorrelation = 12870.0 / 4900.0;
  StampEvidence none{kNaN, std::numeric_limits<double>::infinity()};
  const Index n = recording.samples();
  if (n < kMin) return none;
  const Vector even = even_clock(recording.time);
  const double step = even[1] - even[0];
  const Vector delay = recording.time - even;
  Sums all;
  for (const int axes : {1, 3, 2}) {
    const Matrix position = recorded(recording, kPositionChannels, axes);
    if (position.size() == 0 || !position.allFinite()) continue;
    for (Index axis = 0; axis < position.cols(); ++axis) {
      const Sums one = regress(position.col(axis), delay, step);
      all.gg += one.gg;
      all.gh += one.gh;
    }
    if (axes == 3) break;  // x and y are among them
  }
  if (!(all.gg > 0.0)) return none;
  return {all.gh / all.gg, std::sqrt(kCorrelation / all.gg)};
}

bool jitters_only(const Inspection& inspection) {
  return inspection.gaps.empty() && inspection.duplicated_times == 0 && inspection.backward_times == 0 &&
         inspection.missing.empty() && inspection.interval_standard_deviation > kJitter * inspection.interval_median &&
         std::isfinite(inspection.duration);
}

Result<EvenRecording> on_even_clock(const Recording& recording, const Inspection& inspection) {
  const Hertz rate(inspection.rate_hz);
  const StampEvidence evidence = stamp_evidence(recording);
  const std::string jitter =
      fmt::format("the clock jitters by {:.2g} ms (standard deviation) around {:.4g} ms",
                  1e3 * inspection.interval_standard_deviation, 1e3 * inspection.interval_median);
  if (evidence.slope + 1.96 * evidence.standard_error < 0.5) {
    Recording even = recording;
    even.time = even_clock(recording.time);
    return EvenRecording{
        std::move(even),
        {WarningCode::clock_jitter,
         jitter + ", but the position moves as if sampled uniformly, so the samples are treated as uniform",
         "record with a steadier clock, or compare with --resample HZ"}};
  }
  auto even = MBK_TRY(resample(recording, rate));
  const bool shown = evidence.slope - 1.96 * evidence.standard_error > 0.5;
  return EvenRecording{
      std::move(even),
      {WarningCode::clock_jitter,
       fmt::format("{}, and the samples were interpolated linearly to a uniform clock of {:.6g} Hz: {}", jitter,
                   rate.value,
                   shown ? "the position moves as if sampled at the recorded times"
                         : "the position does not show whether it was sampled at the recorded times"),
       "record with a steadier clock, or choose another rate with --resample HZ"}};
}

Result<Reclocked> reclocked(const Recording& recording, const Inspection& inspection, std::optional<Hertz> rate) {
  if (rate) {
    auto resampled = MBK_TRY(resample(recording, *rate));
    return Reclocked{std::move(resampled), std::nullopt};
  }
  if (!jitters_only(inspection)) return Reclocked{};
  auto even = MBK_TRY(on_even_clock(recording, inspection));
  return Reclocked{std::move(even.recording), std::move(even.warning)};
}

}  // namespace mbk::preprocess
