#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/model/trial/force_comparison.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk {

/// A force that was computed, in short.
struct ForceSummary {
  std::vector<SourceFile> sources;
  ForceSource source = ForceSource::virtual_sensor;
  double lag = 0;                              ///< by which slow forces come late [s]
  std::vector<std::string> axes = {"x", "y"};  ///< of the base, along which it is
  std::string unit = "N";                      ///< of the force: N·m where the hand turns
  Vector rms, peak;                            ///< n [N]
  Vector standard_error;  ///< n, root mean square of what the robot's coefficients leave open [N]; empty: not known
  std::optional<ForceComparison> comparison;  ///< with a sensor, where there was one
  std::vector<std::string> notes;
};

}  // namespace mbk
