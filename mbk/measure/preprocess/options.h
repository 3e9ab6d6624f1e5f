#pragma once

#include <memory>
#include <optional>

#include "mbk/base/core/units.h"
#include "mbk/base/dsp/zero_phase.h"
#include "mbk/model/robot/dynamic_model.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/protocol.h"

namespace mbk::preprocess {

/// Which samples the user asks for, in seconds from the recording's first sample.
struct WindowLimits {
  std::optional<double> from_s, split_s, to_s;
};

/// Choices of the user; absent: from mode, procedure and recording.
struct Options {
  Mode mode = Mode::default_mode;
  std::optional<Procedure> procedure;  ///< of reference mode; absent: chapter3
  std::optional<Protocol> protocol;    ///< absent: detect_protocol
  int axes = 0;                        ///< 1, 2, 3, or 0 = by the channels that are there
  std::optional<int> smoothing_order, smoothing_window;
  std::optional<Hertz> cutoff;
  bool no_lowpass = false;  ///< smoothing only, no Butterworth filter
  std::optional<AccelerationSource> acceleration;
  WindowLimits window;
  dsp::Padding padding;      ///< of the zero-phase filter
  bool instruments = false;  ///< also filter the reference, for instrumental variables
  ForceSource force_source = ForceSource::sensor;
  std::shared_ptr<const robot::DynamicModel> robot;  ///< for a computed force
  std::optional<Index>
      every;  ///< use every Nth row for the fit; absent: all in reference mode, otherwise from the cutoff
};

}  // namespace mbk::preprocess
