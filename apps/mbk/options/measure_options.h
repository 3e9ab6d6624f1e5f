#pragma once

#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/terminal/command.h"
#include "mbk/present/request/measure_request.h"

namespace mbk::app {

using request::add_arm;
using request::measurement_options;
using request::reading_for;

/// What every command takes that measures a limb.
struct MeasureArguments : request::MeasureRequest {
  bool pool = false;
  unsigned threads = 0;
  OutputArguments output;
};

/// What most people need of request::measure_table(), before the sections of --help.
inline constexpr auto kMainMeasureOptions = {"--channels", "--method", "--mode",       "--cutoff",
                                             "--from",     "--to",     "--handle-mass"};

/// Adds FILE, the options of reading, sensor, preprocessing and identification, --pool and --threads.
void add_measure_options(Command command, MeasureArguments& arguments);
/// Adds --ranges, which prints them.
void add_ranges_flag(Command command);

}  // namespace mbk::app
