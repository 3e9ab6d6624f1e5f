#pragma once

#include <span>
#include <string>

#include "mbk/core/result.h"
#include "mbk/identify/transfer_function_fit.h"
#include "mbk/preprocess/options.h"
#include "mbk/trial/recording.h"

namespace mbk::measurement {

struct TransferFunctionMeasurement {
  std::string input = "input", output = "output";  ///< channels, by name or alias
  double input_sign = 1, output_sign = 1;          ///< −1 flips
  std::string reference;                           ///< channel that drives the loop; empty: none
  preprocess::WindowLimits window;  ///< split: what is behind it is held back; absent: the last fifth, unless whole
                                    ///< recordings are
  identify::TransferFunctionOptions fit;
};

/// From recordings to one transfer function. A gap in an even clock begins a new experiment; an uneven clock is taken
/// as it is.
/// @param held_back  whole recordings that only judge
/// @fails  data: a channel is not there; time runs backward or stands still; limits outside the recording; as
/// identify_transfer_function. Where a recording has a source, the message names its file.
[[nodiscard]] Result<TransferFunctionIdentification> identify_transfer_function(
    std::span<const Recording> recordings, std::span<const Recording> held_back,
    const TransferFunctionMeasurement& options);

}  // namespace mbk::measurement
