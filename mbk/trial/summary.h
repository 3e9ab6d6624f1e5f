#pragma once

#include "mbk/impedance/model.h"

namespace mbk {

/// Several trials of one limb in one condition, side by side.
struct Summary {
  int trials = 0;
  impedance::Model mean;                          ///< element by element
  impedance::Model between_trial_standard_error;  ///< standard deviation over trials / √trials
};

}  // namespace mbk
