#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/sensor_options.h"
#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"

namespace mbk::app {

/// Which recordings, and where in them what stands.
struct ReadingArguments {
  std::vector<std::filesystem::path> files;
  bool parts = false;
  std::string channels, variable;
  std::vector<std::string> requested;  ///< channels that are taken by name, beside those of the map; empty: all
  std::optional<double> rate_hz;
  int axes = 0;
  bool untimed = false;  ///< rows without a time are welcome
};

/// Adds FILE… and how to read it: --channels, --variable, --rate, --axes, --parts.
void add_reading_options(CLI::App& command, ReadingArguments& arguments);

/// Each FILE by itself: one that cannot be read costs only itself. Its error names it. With --parts all of them are
/// one.
/// @fails  usage: the options; the calibration of --sensor cannot be read.
[[nodiscard]] Result<std::vector<Result<Recording>>> read_each(const ReadingArguments& arguments,
                                                               const SensorArguments& with_sensor = {});

/// The same, of sessions' recordings only the perturbation; whose person has withdrawn is an error.
[[nodiscard]] Result<std::vector<Result<Recording>>> read_each_perturbation(const ReadingArguments& arguments,
                                                                            const SensorArguments& with_sensor = {});

/// All of them, or the first error.
[[nodiscard]] Result<std::vector<Recording>> all_of(Result<std::vector<Result<Recording>>> each);

/// Every FILE as a recording; with --parts all of them as one. Where --sensor is given, the force is that of its
/// voltages.
[[nodiscard]] Result<std::vector<Recording>> read_recordings(const ReadingArguments& arguments,
                                                             const SensorArguments& with_sensor = {});

/// The same, of sessions' recordings only the perturbation.
/// @fails  as read_recordings; data: the person has withdrawn.
[[nodiscard]] Result<std::vector<Recording>> read_perturbations(const ReadingArguments& arguments,
                                                                const SensorArguments& with_sensor = {});

}  // namespace mbk::app
