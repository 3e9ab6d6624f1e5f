#pragma once

#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk {

/// Several trials of one limb in one condition, side by side.
struct Summary {
  int trials = 0;
  Motion motion = Motion::translation;
  impedance::Model mean;                          ///< element by element
  impedance::Model between_trial_standard_error;  ///< standard deviation over trials / √trials
};

}  // namespace mbk
