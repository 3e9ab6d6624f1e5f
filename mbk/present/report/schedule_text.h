#pragma once

#include <string>

#include "mbk/model/perturbation/schedule.h"

namespace mbk::report {

/// What a schedule demands: peaks, speed, acceleration, crest factor and band, in mm, degrees or N.
[[nodiscard]] std::string schedule_text(const perturbation::Schedule& schedule);

}  // namespace mbk::report
