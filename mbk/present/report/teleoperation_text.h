#pragma once

#include <string>

#include "mbk/model/trial/teleoperation.h"

namespace mbk::report {

/// What `mbk teleop` prints: the design, every condition, what the verdict means, and what was asked besides; without
/// the charts.
[[nodiscard]] std::string teleoperation_text(const TeleoperationFinding& finding);

}  // namespace mbk::report
