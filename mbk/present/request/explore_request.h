#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/option_table.h"
#include "mbk/measure/measurement/explore.h"
#include "mbk/present/request/read_request.h"
#include "mbk/present/request/sensor_request.h"

namespace mbk::request {

/// How recordings are read and explored.
struct ExploreRequest {
  ReadRequest reading;
  SensorRequest sensor;
  measurement::ExploreOptions options;
  std::string schedule, input, output, reference;  ///< as signals are named (signal_names.h)
  std::vector<std::string> emg_band;               ///< low and high [Hz]
  std::vector<std::string> emg_windows;            ///< rising times [ms]
  std::vector<std::string> mvc;                    ///< "biceps=0.0012" [V]
  std::vector<std::string> muscles;                ///< "biceps" or "emg_biceps"
  std::optional<double> emg_envelope_hz;
};

/// Every option that a result depends on, but FILE.
[[nodiscard]] const OptionTable<ExploreRequest>& explore_table();

/// @param request  whose channels then name the signals too, where others than motion and force were asked for
/// @fails  usage: options that do not belong together.
[[nodiscard]] Result<measurement::ExploreOptions> explore_options(ExploreRequest& request);

}  // namespace mbk::request
