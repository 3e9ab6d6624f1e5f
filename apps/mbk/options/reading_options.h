#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/options/sensor_options.h"
#include "apps/mbk/terminal/command.h"
#include "mbk/base/core/result.h"
#include "mbk/measure/measurement/recording_reader.h"
#include "mbk/model/trial/recording.h"

namespace mbk::app {

/// Which recordings, and where in them what stands.
struct ReadingArguments {
  std::vector<std::filesystem::path> files;
  bool parts = false;
  std::string channels, variable, clock, trial, arm;
  std::vector<std::string> requested;  ///< channels that are taken by name, beside those of the map; empty: all
  std::vector<std::string> joints;     ///< of the robot; no option: commands that know a robot set it
  std::vector<std::string> commands;   ///< channels that may be commands, which are rightly held
  std::optional<double> rate_hz;
  int axes = 0;
  bool untimed = false;      ///< rows without a time are welcome
  bool as_recorded = false;  ///< held and missing samples stay as they are: for whoever shows or copies a recording

  [[nodiscard]] bool operator==(const ReadingArguments&) const = default;
};

/// Adds FILE… and how to read it: --channels, --variable, --rate, --axes, --parts.
void add_reading_options(Command command, ReadingArguments& arguments);

using measurement::RecordingReader;

/// @fails  usage: the options; the calibration of --sensor cannot be read.
[[nodiscard]] Result<RecordingReader> open_recordings(const ReadingArguments& arguments,
                                                      const SensorArguments& with_sensor = {});

/// Every FILE as a recording; with --parts all of them as one. Where --sensor is given, the force is that of its
/// voltages.
[[nodiscard]] Result<std::vector<Recording>> read_recordings(const ReadingArguments& arguments,
                                                             const SensorArguments& with_sensor = {});

/// The same, of sessions' recordings only the perturbation.
/// @fails  as read_recordings; data: the person has withdrawn.
[[nodiscard]] Result<std::vector<Recording>> read_perturbations(const ReadingArguments& arguments,
                                                                const SensorArguments& with_sensor = {});

/// Says what the operator excluded of a recording, for commands whose results have no place for it.
/// @param leaves_windows_out  whether the command does so
void say_exclusions(const Recording& recording, bool leaves_windows_out);

}  // namespace mbk::app
