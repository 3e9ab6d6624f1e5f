#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/mbk/terminal/command.h"
#include "mbk/base/core/result.h"
#include "mbk/measure/preprocess/options.h"

namespace mbk::app {

/// Which samples count, in seconds from the start of the recording.
struct WindowArguments {
  std::optional<double> from_s, split_s, to_s;

  [[nodiscard]] bool operator==(const WindowArguments&) const = default;
};

/// How signals are filtered.
struct FilterArguments {
  std::optional<int> sg_window, sg_order;
  std::string cutoff;
  dsp::Extension extension = dsp::Extension::odd;
  long padding = 15;
  std::optional<long> every;
  std::optional<double> resample_hz;

  [[nodiscard]] bool operator==(const FilterArguments&) const = default;
};

/// From a recording to a trial that can be identified.
struct PreprocessArguments {
  Mode mode = Mode::default_mode;
  std::optional<Procedure> procedure;
  std::optional<Protocol> protocol;
  WindowArguments window;
  FilterArguments filters;
  std::optional<AccelerationSource> acceleration;
  ForceSource force_source = ForceSource::sensor;
  double force_delay_ms = 0.0;
  double force_rotation_deg = 0.0;
  std::optional<std::filesystem::path> robot;

  [[nodiscard]] bool operator==(const PreprocessArguments&) const = default;
};

/// Adds --from, --split, --to.
void add_window_options(Command command, WindowArguments& arguments);

/// Adds --sg-window, --sg-order, --cutoff, --extension, --padding, --every, --resample.
void add_filter_options(Command command, FilterArguments& arguments);

/// Adds --mode, --procedure, --protocol and the window.
void add_protocol_options(Command command, PreprocessArguments& arguments);

/// Adds the filters, --acceleration, --force-source and --robot.
void add_signal_options(Command command, PreprocessArguments& arguments);

/// @fails  usage: the limits are not in order.
[[nodiscard]] Result<preprocess::WindowLimits> window_limits(const WindowArguments& arguments);

/// Window and filters alone.   @fails  as window_limits
[[nodiscard]] Result<preprocess::Options> signal_options(const WindowArguments& window, const FilterArguments& filters);

}  // namespace mbk::app
