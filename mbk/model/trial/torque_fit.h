#pragma once

#include <optional>

namespace mbk {

/// How well the torque of one joint is explained; NaN where no torque of it counts.
struct TorqueFit {
  double vaf = 0, rmse = 0;                      ///< [%], [N·m or N]; held out where anything was
  double vaf_in_sample = 0, rmse_in_sample = 0;  ///< on the data behind the coefficients
  std::optional<double> vaf_smoothed;            ///< of vaf's data, predicted from the smoothed motion
};

}  // namespace mbk
