#pragma once

#include <optional>
#include <span>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/measure/identify/transfer_function_fit.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

struct TransferFunctionMeasurement {
  std::string input = "input", output = "output";  ///< channels, by name or alias
  double input_sign = 1, output_sign = 1;          ///< −1 flips
  std::string reference;                           ///< channel that drives the loop; empty: none
  /// split: what is behind it is held out. Absent, unless whole recordings are: the last fifth; or three blocks of a
  /// fifteenth each where the input has another spectrum there than before, as that of a chirp.
  preprocess::WindowLimits window;
  /// To which even samples are decimated behind a low-pass (dsp::decimate), to the nearest whole share of theirs.
  /// Absent: for discrete-time models to at most kMaxDiscreteRate, or to what keeps 95 % of the output's power that
  /// follows the input (lines of significant coherence); the others take every sample. 0: every sample.
  std::optional<double> sample_rate_hz;
  /// [s] up to which a delay is looked for. Absent: that of `fit`, but no more than a tenth of the shortest recording.
  std::optional<double> max_delay;
  identify::TransferFunctionOptions fit;
};

/// A discrete-time model of fast samples has its poles crowded at z = 1, and spends its fit on what no limb does.
inline constexpr Hertz kMaxDiscreteRate(100.0);

/// From recordings to one transfer function. A gap in an even clock begins a new experiment; an uneven clock is taken
/// as it is. Behind a delay the input of a segment's first samples was not recorded: unless the system begins at rest,
/// they are left out, and a note says so.
/// @param held_out  whole recordings that only judge
/// @fails  data: a channel is not there; time runs backward or stands still; limits outside the recording; as
/// identify_transfer_function; the sample rate is above that of the recording, or its clock is uneven. Where a
/// recording has a source, the message names its file.
[[nodiscard]] Result<TransferFunctionIdentification> identify_transfer_function(
    std::span<const Recording> recordings, std::span<const Recording> held_out,
    const TransferFunctionMeasurement& options);

}  // namespace mbk::measurement
