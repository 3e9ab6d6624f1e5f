#pragma once

#include "mbk/base/core/linear_algebra.h"

namespace mbk {

/// Deviation of an estimated force from a measured one over some rows, for each axis.
struct ForceAgreement {
  Index rows = 0;
  Vector bias;  ///< n, mean of estimated − measured [N]; NaN without rows
  Vector rmse;  ///< n, root mean square of estimated − measured [N], the bias in it; NaN without rows
};

/// An estimated force (virtual sensor) compared with the measured one on the same rows. Every row belongs to one of
/// three parts: friction errors appear at reversals, offsets at rest.
struct ForceComparison {
  double duration = 0;         ///< of the rows [s]
  ForceAgreement all;          ///< every row
  ForceAgreement reversals;    ///< within `reversal_window` of the reversal of a joint
  ForceAgreement rest;         ///< of the others, those where no joint is faster than `rest_speed`
  ForceAgreement motion;       ///< the others
  Vector measured_rms;         ///< n, of the measured force about its mean [N], the scale for the errors
  Vector vaf;                  ///< n, variance of the measured force that is accounted for [%]; blind to the bias
  Vector correlation;          ///< n, at lag 0
  Vector gain;                 ///< n, slope of estimated over measured, by least squares
  Vector lag;                  ///< n, delay of the estimate [s]; NaN if there is no optimum within ±longest_lag
  Vector correlation_at_lag;   ///< n; NaN where the lag is
  double rest_speed = 0;       ///< [rad/s, or m/s where a joint slides]
  double reversal_window = 0;  ///< to each side [s]
  double longest_lag = 0;      ///< that was tried [s]
};

}  // namespace mbk
