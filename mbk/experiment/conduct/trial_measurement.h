#pragma once

#include <filesystem>
#include <functional>

#include "mbk/base/core/result.h"
#include "mbk/experiment/protocol/experiment.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/recording.h"

namespace mbk::conduct {

/// How a trial is measured, while it runs and after it. With a force that the person answers (any control but that of
/// positions) by instrumental variables: least squares takes the answer for noise.
[[nodiscard]] measurement::Options measurement_options(const protocol::Trial& trial);

/// The options for what a session recorded: where ticks were missed it is put on the even clock of `rate`, which the
/// result then warns of (Warning resampled), with the number and length of what a line bridges.
[[nodiscard]] measurement::Options across_missed_ticks(const Recording& recording, Hertz rate,
                                                       measurement::Options options);

/// What makes a measurement of what was recorded while the trial perturbed.
using Measure = std::function<Result<Measurement>(const Recording&, const measurement::Options&)>;

/// measurement::measure, and nothing besides.   @fails  as that
[[nodiscard]] Result<Measurement> measure_recording(const Recording& recording, const measurement::Options& options);

/// Measures the perturbation in the recording of a trial, across missed ticks.
/// @fails  as recording::read and `measure`
[[nodiscard]] Result<Measurement> measure_trial(const std::filesystem::path& recording, const protocol::Trial& trial,
                                                const Measure& measure = measure_recording);

/// Share of the force's variance that a model has to explain on every axis [%].
inline constexpr double kPoor = 50.0;

/// Whether a trial that gave this is worth repeating: it is not usable, or explains less than kPoor on an axis.
[[nodiscard]] bool poor(const Identification& identification);

}  // namespace mbk::conduct
