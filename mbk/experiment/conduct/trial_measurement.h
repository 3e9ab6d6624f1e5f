#pragma once

#include <filesystem>
#include <functional>

#include "mbk/base/core/result.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/recording.h"

namespace mbk::conduct {

/// What makes a measurement of what was recorded while the trial perturbed.
using Measure = std::function<Result<Measurement>(const Recording&)>;

/// measurement::measure with no option: everything follows from the recording.   @fails  as that
[[nodiscard]] Result<Measurement> measure_recording(const Recording& recording);

/// Measures the perturbation in the recording of a trial, as `mbk measure` does.
/// @fails  as recording::read and `measure`
[[nodiscard]] Result<Measurement> measure_trial(const std::filesystem::path& recording,
                                                const Measure& measure = measure_recording);

/// Share of the force's variance that a model has to explain on every axis [%].
inline constexpr double kPoor = 50.0;

/// Whether a trial that gave this is worth repeating: it is not usable, or explains less than kPoor on an axis.
[[nodiscard]] bool poor(const Identification& identification);

}  // namespace mbk::conduct
