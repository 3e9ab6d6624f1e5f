#pragma once

#include "mbk/model/trial/after_onset_estimate.h"
#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/model/trial/impulse_response_estimate.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"
#include "mbk/model/trial/plateau_stiffness.h"
#include "mbk/model/trial/reach_stiffness.h"
#include "mbk/model/trial/time_course_estimate.h"
#include "mbk/present/result/json_parts.h"

/// Parts of an exploration, one function each in a source of its own. For the sources of this module only.
namespace mbk::result {

[[nodiscard]] Json frequency_response_json(const FrequencyResponseEstimate& found);
[[nodiscard]] Json impulse_response_json(const ImpulseResponseEstimate& found);
[[nodiscard]] Json parallel_cascade_json(const ParallelCascadeEstimate& found);
[[nodiscard]] Json stiffness_regression_json(const StiffnessRegression& fit);
[[nodiscard]] Json plateau_stiffness_json(const PlateauStiffness& found);
[[nodiscard]] Json reach_stiffness_json(const ReachStiffness& found);
[[nodiscard]] Json time_course_json(const TimeCourseEstimate& found);
[[nodiscard]] Json after_onset_json(const AfterOnsetEstimate& found);

}  // namespace mbk::result
