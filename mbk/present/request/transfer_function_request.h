#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/option_table.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/measurement/identify_transfer_function.h"
#include "mbk/model/trial/transfer_function.h"
#include "mbk/present/request/read_request.h"

namespace mbk::request {

/// From which recordings a transfer function is found, and how.
struct TransferFunctionRequest {
  ReadRequest reading;
  std::vector<std::filesystem::path> held_out;                ///< recordings that only judge the fit
  std::string input = "input", output = "output", reference;  ///< as signals are named (signal_names.h)
  std::optional<Hertz> resample;                              ///< put the samples on an even clock first
  std::optional<Index> poles, zeros;
  std::string orders;                      ///< "2:5" or "4/1,4/2": poles and zeros to choose from
  std::string delay = "0";                 ///< [s], or "auto"
  std::string sample_rate;                 ///< [Hz], or "recorded"; "": as options.sample_rate_hz says
  std::vector<double> start_poles_hz;      ///< at which the search begins too
  std::optional<AdmittanceOutput> invert;  ///< also the inverse
  measurement::TransferFunctionMeasurement options;
};

/// --resample and --sample-rate.
[[nodiscard]] const OptionTable<TransferFunctionRequest>& transfer_function_clock_table();
/// --input, --output and --reference.
[[nodiscard]] const OptionTable<TransferFunctionRequest>& transfer_function_signal_table();
/// Those of the model, but --start-pole.
[[nodiscard]] const OptionTable<TransferFunctionRequest>& transfer_function_model_table();

/// The options of a request; its signals are placed (place_signals), for which its channels may change.
/// @fails  usage: inconsistent options, or an unknown word.
[[nodiscard]] Result<measurement::TransferFunctionMeasurement> transfer_function_options(
    TransferFunctionRequest& request);

}  // namespace mbk::request
