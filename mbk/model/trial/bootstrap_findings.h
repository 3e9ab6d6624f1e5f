#pragma once

#include <string>
#include <vector>

#include "mbk/model/trial/findings.h"

namespace mbk {

/// A quantity derived from a model, with its bootstrap interval and its delta-method interval.
struct BootstrapFinding {
  std::string name;  ///< "k_xx", "stiffness area", "excess of passivity"
  std::string unit;  ///< "" where it has none
  double value = 0;
  Interval interval95;  ///< bootstrap, widened for the number of blocks
  Interval delta95;     ///< delta method, from the covariance
};

/// All such quantities of one identification.
struct BootstrapFindings {
  int replicates = 0;
  double block_s = 0, blocks = 0;
  std::uint64_t seed = 1;
  std::vector<BootstrapFinding> findings;
};

}  // namespace mbk
