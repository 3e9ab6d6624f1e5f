#pragma once

#include <optional>
#include <string>

#include "apps/mbk/terminal/command.h"
#include "apps/mbk/options/preprocess_options.h"
#include "apps/mbk/options/reading_options.h"
#include "mbk/measure/measurement/explore.h"

namespace mbk::app {

/// How recordings are read and explored.
struct ExploringArguments {
  ReadingArguments reading;
  SensorArguments sensor;
  WindowArguments window;
  std::optional<Protocol> protocol;
  std::optional<double> resample_hz;
  double force_delay_ms = 0.0;
  double force_rotation_deg = 0.0;
  std::optional<ExplorationPart> only;
  std::optional<double> after_onset_ms;
  std::string schedule, align, trigger;
  explore::FrequencyResponseOptions response;
  std::optional<double> plateau_from_ms, plateau_to_ms;
  std::string input, output_signal, reference;
};

/// Adds FILE… and every option that a result depends on.
void add_exploring_options(Command command, ExploringArguments& arguments);

/// @param arguments  whose channels then name the signals too, where others than motion and force were asked for
/// @fails  usage: options that do not belong together.
[[nodiscard]] Result<measurement::ExploreOptions> exploring_options(ExploringArguments& arguments);

}  // namespace mbk::app
