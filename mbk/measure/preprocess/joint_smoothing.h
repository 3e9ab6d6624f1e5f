#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/measure/preprocess/windows.h"
#include "mbk/model/robot/drive_terms.h"

namespace mbk::preprocess {

/// The smoothing of joints of which dry friction is computed: the shortest window, no longer than that of `plan`, whose
/// velocity has no more noise than 5 % of the velocity over which friction changes its sign. A longer one rounds off
/// the velocity where a joint turns back, and the friction of that is not the friction that acted; all other noise the
/// low-pass takes, on both sides alike. Without dry friction it is `plan`. A sign that changes at once stands for one
/// that changes within a twentieth of the usual velocity.
/// @param position N×n [rad or m]
/// @fails  as savitzky_golay_weights
[[nodiscard]] Result<dsp::SavitzkyGolay> smoothing_of_joints(const dsp::SavitzkyGolay& plan, const Matrix& position,
                                                             const std::vector<Cut>& cuts,
                                                             const robot::DriveTerms& drive, Hertz rate);

}  // namespace mbk::preprocess
