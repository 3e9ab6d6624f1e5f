#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/mbk/output.h"
#include "apps/mbk/sensor_options.h"
#include "mbk/base/core/result.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/measurement/measure.h"

namespace mbk::app {

/// What the options of `measure` and `identify` say, as typed.
struct MeasureArguments {
  std::vector<std::filesystem::path> files;
  bool parts = false;
  std::string channels, variable;
  std::vector<std::string> wanted;  ///< channels that are taken by name, beside those of the map; empty: all
  std::optional<double> rate_hz, resample_hz;
  int axes = 0;
  bool untimed = false;  ///< rows without a time are welcome
  SensorArguments sensor;
  std::string mode = "default", procedure, protocol = "auto", method = "ls";
  std::optional<int> sg_window, sg_order;
  std::string force_source = "sensor";
  std::optional<std::filesystem::path> robot;
  std::string cutoff, acceleration, parameters_from, structure = "full", extension = "odd";
  long padding = 15;
  std::optional<long> every;
  double handle_mass = 0.0;
  std::optional<double> from_s, split_s, to_s;
  double hac_lag_s = 1.0;
  bool decimate_check = false, pool = false;
  int bootstrap = 0;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  bool json = false, quiet = false;
  Output output;
  std::string domain = "hand", arm;
  std::optional<std::filesystem::path> report;
  std::string report_note;
};

/// Adds FILE… and how to read it: --channels, --variable, --rate, --parts.
void add_reading_options(CLI::App& command, MeasureArguments& arguments);

/// Adds --from, --split, --to.
void add_window_options(CLI::App& command, MeasureArguments& arguments);

/// Adds --sg-window, --sg-order, --cutoff, --extension, --padding, --every, --resample.
void add_filter_options(CLI::App& command, MeasureArguments& arguments);

/// Adds everything that decides what is measured and how, window and filters too.
void add_measuring_options(CLI::App& command, MeasureArguments& arguments);

/// Adds --json, --out, --overwrite, --quiet.
void add_output_options(CLI::App& command, MeasureArguments& arguments, const std::string& schema);

/// Adds --domain and --arm.
void add_domain_options(CLI::App& command, MeasureArguments& arguments);

/// Adds --report and --report-note; --overwrite then speaks of the report too.
void add_report_options(CLI::App& command, MeasureArguments& arguments);

/// What can be said of --out, --report and --overwrite before the work begins.
[[nodiscard]] Result<void> check_files(const MeasureArguments& arguments);

[[nodiscard]] Result<recording::ReadOptions> read_options(const MeasureArguments& arguments);
/// Window and filters alone.
[[nodiscard]] Result<preprocess::Options> signal_options(const MeasureArguments& arguments);
[[nodiscard]] Result<measurement::Options> measurement_options(const MeasureArguments& arguments);

/// Every FILE as a recording; with --parts all of them as one. Where --sensor is given, the force is that of its
/// voltages.
[[nodiscard]] Result<std::vector<Recording>> read_recordings(const MeasureArguments& arguments);

/// The same, of sessions' recordings only the perturbation; with --arm their metadata hold that arm.
[[nodiscard]] Result<std::vector<Recording>> read_perturbations(const MeasureArguments& arguments);

}  // namespace mbk::app
