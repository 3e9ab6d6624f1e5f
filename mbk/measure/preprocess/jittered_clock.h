#pragma once

#include <optional>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/warning.h"

namespace mbk::preprocess {

/// How far the samples follow the deviations δ of their time stamps from an even clock: the slope of fourth differences
/// of the position on those of v δ. 1 where they were taken at the recorded times, 0 where they were taken evenly and
/// only the stamps jitter; neither motion slower than some samples nor noise biases it.
struct StampEvidence {
  double slope = 0.0;           ///< NaN if no position moves
  double standard_error = 0.0;  ///< infinite there
};

/// @param recording  without gaps; time rises
[[nodiscard]] StampEvidence stamp_evidence(const Recording& recording);

/// A recording with a jittering clock, as it is analysed.
struct EvenRecording {
  Recording recording;
  Warning warning;  ///< clock_jitter, with what was done and why
};

/// Whether jitter is the only problem of the clock: the intervals vary by more than 1 % (standard deviation), but there
/// is no gap, no repeated, backward or non-finite time and no missing sample.
[[nodiscard]] bool jitters_only(const Inspection& inspection);

/// The recording on an even clock at its mean rate. Recorded time is taken for true, and the samples are put on the
/// even clock by straight lines between them, unless stamp_evidence() shows with 95 % confidence that the slope is
/// under ½: then the samples stay and the stamps are made even.
/// @param inspection  for which jitters_only()
[[nodiscard]] Result<EvenRecording> on_even_clock(const Recording& recording, const Inspection& inspection);

/// What is analysed in place of a recording whose clock is not the one that it is analysed on.
struct Reclocked {
  std::optional<Recording> recording;  ///< absent: the recording as it is
  std::optional<Warning> warning;      ///< clock_jitter, if that is the reason
};

/// The recording at `rate` if given (resample), otherwise on_even_clock() if its clock jitters_only().
/// @fails  as resample
[[nodiscard]] Result<Reclocked> reclocked(const Recording& recording, const Inspection& inspection,
                                          std::optional<Hertz> rate);

}  // namespace mbk::preprocess
