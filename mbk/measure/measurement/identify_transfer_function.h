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
  /// split: data after it are held out. Absent, and no whole recordings held out: the last fifth; or three blocks of a
  /// fifteenth each if the spectrum of the input at the end differs, as for a chirp.
  preprocess::WindowLimits window;
  /// Rate to which uniform samples are decimated after a low-pass filter (dsp::decimate), rounded to a whole fraction.
  /// Absent: for discrete-time models at most kMaxDiscreteRate, or a rate that keeps 95 % of the output power that
  /// follows the input (lines of significant coherence); other models use every sample. 0: every sample.
  std::optional<double> sample_rate_hz;
  /// Longest delay tried [s]. Absent: that of `fit`, but at most a tenth of the shortest recording.
  std::optional<double> max_delay;
  identify::TransferFunctionOptions fit;
};

/// A discrete-time model of fast samples has its poles crowded at z = 1 and fits dynamics that do not come from the
/// limb.
inline constexpr Hertz kMaxDiscreteRate(100.0);

/// One transfer function from recordings. A gap in a uniform clock starts a new experiment; a non-uniform clock is used
/// as recorded. With a delay, the input of the first samples of a segment was not recorded: unless the system starts at
/// rest, they are omitted, with a note.
/// @param held_out  whole recordings used only for validation
/// @fails  data: a channel is missing; time does not increase; limits outside the recording; as
/// identify_transfer_function; the sample rate is above that of the recording, or its clock is not uniform. The message
/// names the file if a recording has a source.
[[nodiscard]] Result<TransferFunctionIdentification> identify_transfer_function(
    std::span<const Recording> recordings, std::span<const Recording> held_out,
    const TransferFunctionMeasurement& options);

}  // namespace mbk::measurement
