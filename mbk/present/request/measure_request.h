#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "mbk/base/core/option_table.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/model/trial/exploration.h"
#include "mbk/model/trial/recording.h"
#include "mbk/present/request/read_request.h"
#include "mbk/present/request/sensor_request.h"

namespace mbk::request {

/// A measurement to perform: the options of every stage, and inputs by name.
struct MeasureRequest {
  ReadRequest reading;
  SensorRequest sensor;
  measurement::Options options;
  std::optional<std::filesystem::path> robot;  ///< whose dynamics a computed force rests on; absent: the thesis's
  std::optional<ExplorationPart> explored;     ///< in a study: this part of `mbk explore` instead of M, B and K
  std::string arm;                             ///< "X,Y,UPPER,FORE[,left|right]"; "": as the recording says
};

/// All of them but FILE, in the order of --help.
[[nodiscard]] const OptionTable<MeasureRequest>& measure_table();
/// --domain and --arm.
[[nodiscard]] const OptionTable<MeasureRequest>& arm_table();

/// What the request says, with the robot that it names.
/// @param draws_arm  the arm is needed for a picture, too
/// @fails  usage: options that do not belong together. As robot_of.
[[nodiscard]] Result<measurement::Options> measurement_options(const MeasureRequest& request, bool draws_arm = false);

/// How to read recordings of the robot that the options name.
[[nodiscard]] ReadRequest reading_for(ReadRequest reading, const measurement::Options& options);

/// With --arm the recording's metadata hold that arm.
void add_arm(const std::string& arm, Recording& recording);

}  // namespace mbk::request
