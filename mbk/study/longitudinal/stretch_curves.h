#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/nan.h"
#include "mbk/base/core/result.h"
#include "mbk/study/store/study_list.h"

namespace mbk::longitudinal {

/// Resisting torque over position at one speed. Vectors have one entry for each of StretchCurves::position.
struct StretchCurve {
  double speed = 0;                   ///< [position unit/s]
  Vector torque;                      ///< of the participant, mean over the session's recordings
  int controls = 0;                   ///< who were stretched at this speed over at least 80 % of these positions
  double above = kNaN, below = kNaN;  ///< shares of the positions with a range where torque is beyond it; NaN: no range
  Vector mean, low95, high95;  ///< of them, as NormalRange; NaN: fewer than kMinPeople, or one lacks the position
};

/// Stretches of one person in one direction under one condition, in the last session, beside the controls in theirs.
struct StretchCurves {
  std::string condition;
  std::int64_t session = 0;
  int results = 0;                         ///< recordings
  int direction = 1;                       ///< 1: the position increases, −1: it decreases
  std::string position_unit, torque_unit;  ///< "°" and "N·m", or "mm" and "N"
  Vector position;                         ///< common to these recordings, increasing
  std::vector<StretchCurve> speeds;        ///< increasing
};

/// From the stored results of `mbk study defaults --explore stretch`; empty for other studies. A control's speed may
/// differ by 10 %; between a control's positions torque is interpolated linearly. The same controls count at every
/// position, so that nobody's torque follows from a step of the range.
/// @param controls  without the participant
/// @fails  data: a result cannot be read.
[[nodiscard]] Result<std::vector<StretchCurves>> stretch_curves(const store::Store& study, const store::StudyList& list,
                                                                std::int64_t participant,
                                                                const std::set<std::int64_t>& controls);

}  // namespace mbk::longitudinal
