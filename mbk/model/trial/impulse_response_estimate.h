#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk {

/// VAF of one axis: 100 (1 − var(f − f̂)/var f) [%], with the RMSE beside it.
struct ExplainedForce {
  double vaf = 0, vaf_half_width = 0;  ///< [%], of the 95 % interval
  double rmse = 0;                     ///< [N or N·m]
};

/// M, B and K fitted to an impulse response, and the unexplained rest of the response.
struct ResponseModel {
  Matrix M, B, K;                                   ///< n×n
  Matrix M_half_width, B_half_width, K_half_width;  ///< n×n, of the 95 % intervals
  bool identifiable = false;                        ///< fewer than 3 n directions are excited: these values are absent
  bool M_identifiable = false, B_identifiable = false,
       K_identifiable = false;            ///< its interval is smaller than its value
  double statistic = 0;                   ///< F of the part of the response that M, B and K do not explain
  double numerator = 0, denominator = 0;  ///< its degrees of freedom
  double p_value = 1;                     ///< of the largest over the axes, with Bonferroni's bound
  bool enough = true;                     ///< p is not below 10⁻⁵
};

/// Two-sided impulse response from motion to force, −F_h(t) = Σ_l h(l) x(t − l) T + c, without a model of it.
struct ImpulseResponseEstimate {
  int axes = 1;
  double sample_time = 0;        ///< T [s]
  double memory = 0;             ///< lags reach from −memory to memory [s]
  bool memory_at_limit = false;  ///< the longest tried: the true value may be larger
  std::string memory_rule;
  Vector lag;            ///< 2L+1 [s]
  Matrix response;       ///< (2L+1)×n²: column i + j n is from axis j of the motion to axis i of the force [N/(m·s)]
  Matrix half_width;     ///< of the 95 % interval of its excited part
  Matrix excited;        ///< (2L+1)×n: excited share of a unit response at that lag of that input, 0 … 1
  Index rank = 0;        ///< number of retained directions of past and future motion
  Index directions = 0;  ///< total number of directions
  bool instruments = false;                        ///< the reference was used as instrument: valid in closed loop
  bool held_out = false;                           ///< the fit is judged on held-out rows
  std::vector<ExplainedForce> explained;           ///< n, by the response
  std::vector<ExplainedForce> explained_by_model;  ///< n, by M, B and K fitted to the same rows directly
  ResponseModel model;
};

}  // namespace mbk
