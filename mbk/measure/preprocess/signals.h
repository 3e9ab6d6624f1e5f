#pragma once

#include "mbk/base/core/columns.h"
#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// The channels for a fit, as views into the recording.
struct Signals {
  int axes = 2;                 ///< n
  Columns position;             ///< N×n [m or rad]
  Columns force_hand_on_robot;  ///< N×n [N or N·m]
  Columns force_sensitivity;    ///< N×(n·p) of a force that was computed, or empty
  Columns reference;            ///< N×n; empty if not recorded
  ReferenceQuantity reference_quantity = ReferenceQuantity::unknown;
  Columns acceleration;  ///< N×n [m/s² or rad/s²]; empty unless requested
  Motion motion = Motion::translation;
};

/// Finds them in a recording, which must stay as long as they are used.
/// @param axes 1, 2, 3, or 0 = by the channels that are there
/// @fails a channel is missing (it is named, with those that are there); with one axis, position and reaction in units
/// that do not belong together.
[[nodiscard]] Result<Signals> select_signals(const Recording& recording, int axes, bool acceleration_from_sensor);

}  // namespace mbk::preprocess
