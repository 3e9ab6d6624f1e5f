#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/identification.h"

namespace mbk {

/// A trial that is no part of a mean.
struct OmittedTrial {
  std::string file, why;
};

/// Several trials of one limb in one condition, side by side.
struct Summary {
  int trials = 0;                     ///< behind the mean
  std::vector<OmittedTrial> omitted;  ///< the others
  Method method = Method::least_squares;
  Motion motion = Motion::translation;
  impedance::Model mean;                          ///< element by element
  impedance::Model between_trial_standard_error;  ///< standard deviation over trials / √trials
  impedance::Model half_width95;                  ///< of the mean's 95 % interval: Student's t times that
};

/// Findings about several recordings together, beside the result of each.
struct SeveralTrials {
  std::optional<Summary> summary;
  std::string no_summary;     ///< why there is none, in words
  std::vector<Error> failed;  ///< recordings that could not be measured, each with its file in `where`
};

}  // namespace mbk
