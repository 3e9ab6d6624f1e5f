#pragma once

#include "apps/mbk/terminal/command.h"
#include "mbk/model/trial/recording.h"
#include "mbk/present/request/open_recordings.h"
#include "mbk/present/request/signal_names.h"

namespace mbk::app {

using measurement::RecordingReader;
using request::open_recordings;
using request::read_perturbations;
using request::read_recordings;
using request::ReadRequest;
using request::SensorRequest;

/// Adds FILE… and how to read it: --channels, --variable, --rate, --axes, --parts, …
void add_reading_options(Command command, ReadRequest& reading);

/// Adds --sensor, --lever-arm-mm, --sensor-zero, --sensor-frame and --sensor-delay.
void add_sensor_options(Command command, SensorRequest& sensor);

/// Adds only FILE….
void add_files_option(Command command, ReadRequest& reading);

/// Reports what the operator excluded of a recording, for commands whose results do not contain it.
/// @param leaves_windows_out  whether the command does so
void say_exclusions(const Recording& recording, bool leaves_windows_out);

}  // namespace mbk::app
