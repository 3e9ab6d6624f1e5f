#pragma once

#include <optional>

#include "mbk/core/result.h"
#include "mbk/dsp/zero_phase.h"
#include "mbk/preprocess/windows.h"
#include "mbk/trial/inspection.h"
#include "mbk/trial/prepared_trial.h"
#include "mbk/trial/recording.h"

namespace mbk::preprocess {

/// Where ẍ comes from.
enum class AccelerationSource { derivative, sensor };

/// What the user may choose; absent = what the mode, the procedure and the recording say.
struct Options {
  Mode mode = Mode::improved;
  Procedure procedure = Procedure::chapter3;
  std::optional<Protocol> protocol;  ///< absent: detect_protocol
  int axes = 0;                      ///< 1, 2, or 0 = by the channels that are there
  std::optional<int> smoothing_order, smoothing_window;
  std::optional<Hertz> cutoff;
  bool no_lowpass = false;  ///< smoothing only, no Butterworth filter
  std::optional<AccelerationSource> acceleration;
  WindowLimits window;
  dsp::Padding padding;  ///< of the zero-phase filter
};

/// Recording → PreparedTrial: channels, windows, smoothing and derivatives, low-pass. Both modes pass through here;
/// they differ in the windows, in their order with the filter, and in where the settings come from.
/// Motion and force pass through the same linear filters, so that −F = M ẍ + B ẋ + K(x − x₀) survives them.
/// @fails a channel is missing; time repeats, runs backwards or has a gap inside the window; a value in the window is
/// not finite (file, channel, sample and time are named); a window is shorter than the filters need.
[[nodiscard]] Result<PreparedTrial> prepare(const Recording& recording, const Inspection& inspection,
                                            const Options& options);

}  // namespace mbk::preprocess
