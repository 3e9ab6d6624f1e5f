#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/model/trial/force_comparison.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk {

/// Summary of a computed force.
struct ForceSummary {
  std::vector<SourceFile> sources;
  ForceSource source = ForceSource::virtual_sensor;
  double lag = 0;                              ///< delay of slow forces [s]
  std::vector<std::string> axes = {"x", "y"};  ///< of the base, along which it is
  std::string unit = "N";                      ///< of the force: N·m where the hand turns
  Vector rms, peak;                            ///< n [N]
  Vector standard_error;  ///< n, root-mean-square uncertainty from the robot coefficients [N]; empty: unknown
  std::optional<ForceComparison> comparison;  ///< comparison with a sensor, if there was one
  std::vector<std::string> notes;
};

}  // namespace mbk
