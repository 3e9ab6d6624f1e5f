#pragma once

#include <set>

#include "apps/mbk/options/analyse_options.h"
#include "apps/mbk/terminal/command.h"
#include "apps/mbk/options/identify_options.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/preprocess_options.h"
#include "apps/mbk/options/reading_options.h"
#include "mbk/measure/measurement/measure.h"

namespace mbk::app {

/// What every command takes that measures a limb.
struct MeasureArguments {
  ReadingArguments reading;
  SensorArguments sensor;
  PreprocessArguments preprocess;
  identify::Options identify;
  std::set<PlausibleQuantity> ignored_ranges;
  bool pool = false;
  unsigned threads = 0;
  OutputArguments output;
};

/// Adds the options of reading, sensor, preprocessing and identification, --pool and --threads.
void add_measure_options(Command command, MeasureArguments& arguments);

/// @param draws_arm  the arm is needed for a picture, too
/// @fails  usage: options that do not belong together. As robot_of.
[[nodiscard]] Result<measurement::Options> measurement_options(const MeasureArguments& arguments,
                                                               const AnalyseArguments& analyse = {},
                                                               bool draws_arm = false);

/// How to read recordings of the robot that the options name.
[[nodiscard]] ReadingArguments reading_for(ReadingArguments reading, const measurement::Options& options);

}  // namespace mbk::app
