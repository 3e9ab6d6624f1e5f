#pragma once

#include <string>

#include "mbk/model/trial/after_onset_estimate.h"
#include "mbk/model/trial/emg_estimate.h"
#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/model/trial/impulse_response_estimate.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"
#include "mbk/model/trial/plateau_stiffness.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/reach_stiffness.h"
#include "mbk/model/trial/stretch_estimate.h"
#include "mbk/model/trial/time_course_estimate.h"

/// @file
/// Parts of an exploration, one function each in a source of its own. For the sources of this module only.
namespace mbk::report {

[[nodiscard]] std::string frequency_response_text(const FrequencyResponseEstimate& found);
[[nodiscard]] std::string impulse_response_text(const ImpulseResponseEstimate& found, Motion motion);
[[nodiscard]] std::string parallel_cascade_text(const ParallelCascadeEstimate& found, Motion motion);
[[nodiscard]] std::string stiffness_regression_text(const StiffnessRegression& fit, Motion motion);
[[nodiscard]] std::string plateau_stiffness_text(const PlateauStiffness& found, Motion motion);
[[nodiscard]] std::string reach_stiffness_text(const ReachStiffness& found, Motion motion);
[[nodiscard]] std::string time_course_text(const TimeCourseEstimate& found, Motion motion);
[[nodiscard]] std::string after_onset_text(const AfterOnsetEstimate& found, Motion motion);
[[nodiscard]] std::string emg_text(const EmgEstimate& found, Motion motion);
[[nodiscard]] std::string stretch_text(const StretchEstimate& found, Motion motion);

}  // namespace mbk::report
