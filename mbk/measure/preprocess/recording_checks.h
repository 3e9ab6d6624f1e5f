#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/measure/preprocess/signals.h"
#include "mbk/measure/preprocess/trial_clock.h"
#include "mbk/measure/preprocess/windows.h"
#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/warning.h"

namespace mbk::preprocess {

/// Rejects invalid filter settings before memory is allocated from them.
[[nodiscard]] Result<void> check_choices(const Options& options);

/// The note of the reader on a missing channel, to append to a message: "; '/ft' was not used as force_x: …"; "" if
/// there is none.
[[nodiscard]] std::string why_missing(const Recording& recording, std::string_view channel);

/// About three for each parameter of one axis.
inline constexpr Index kMinSamples = 20;

/// Checks for enough samples and increasing time.
[[nodiscard]] Result<void> check_length(Index samples, const Inspection& inspection);

/// Time inside the cuts must be even enough to be called even: it neither repeats nor runs backwards nor leaves a gap
/// that inspection found. Lesser jitter is left as it is, and warned of from 1 % on.
[[nodiscard]] Result<void> check_clock(const Clock& clock, const Inspection& inspection, const WindowPlan& plan,
                                       std::vector<Warning>& warnings);

/// No sample may be missing (NaN in every channel) within the limits: samples lost by a session are not interpolated.
[[nodiscard]] Result<void> check_missing(const Clock& clock, const std::vector<MissingSamples>& missing,
                                         const WindowLimits& limits);

/// The windows are read off the reference, so that it must be finite throughout the limits.
[[nodiscard]] Result<void> check_reference(const Clock& clock, const Signals& signals, const WindowLimits& limits);

/// Position, force and acceleration must be finite inside the cuts; the first channel and sample that is not is named,
/// with what the recording's warnings say of it.
[[nodiscard]] Result<void> check_finite(const Clock& clock, const Signals& signals, const WindowPlan& plan,
                                        const std::vector<Warning>& warnings);

/// A constant force means a dead sensor; a constant position means no motion.
[[nodiscard]] Result<void> check_alive(const Signals& signals, const WindowPlan& plan);

/// The position must move well beyond the steps in which it is recorded.
void warn_of_small_motion(const Signals& signals, const WindowPlan& plan, std::vector<Warning>& warnings);

/// The force must not suddenly vanish while the motion continues, as when the hand leaves the handle: its standard
/// deviation over a second falls below 10 % of the median, for at least two seconds (or pulses), and the motion stays
/// alike.
void warn_of_lost_contact(const Clock& clock, const Signals& signals, const WindowPlan& plan,
                          std::vector<Warning>& warnings);

}  // namespace mbk::preprocess
