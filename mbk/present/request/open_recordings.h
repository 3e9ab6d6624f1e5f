#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/measurement/recording_reader.h"
#include "mbk/model/trial/recording.h"
#include "mbk/present/request/read_request.h"
#include "mbk/present/request/sensor_request.h"

namespace mbk::request {

/// Recordings in files, or in memory under the names of files.
/// @fails  usage: the options; the calibration of --sensor cannot be read.
[[nodiscard]] Result<measurement::RecordingReader> open_recordings(const ReadRequest& request,
                                                                   const SensorRequest& sensor = {});

/// Every file as a recording; with --parts all of them as one. Where --sensor is given, the force is that of its
/// voltages.
[[nodiscard]] Result<std::vector<Recording>> read_recordings(const ReadRequest& request,
                                                             const SensorRequest& sensor = {});

/// The same, of sessions' recordings only the perturbation.
/// @fails  as read_recordings; data: the person has withdrawn.
[[nodiscard]] Result<std::vector<Recording>> read_perturbations(const ReadRequest& request,
                                                                const SensorRequest& sensor = {});

}  // namespace mbk::request
