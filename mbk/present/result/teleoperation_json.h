#pragma once

#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/teleoperation.h"

namespace mbk::result {

/// Schema "mbk.teleop/1", in SI units and rad/s. A frequency or end that is infinite is null.
[[nodiscard]] std::string to_json(const TeleoperationFinding& finding);

/// a of an operator whose arm was measured, minus the lower bound of its excess of passivity: of the 95 % interval of
/// λ_min(B_s), which holds at every frequency; or, where the model has no such excess, of the smallest index over the
/// band in which it was judged.
/// @param text  schema mbk.result/1 or mbk.passivity/1, or the list of either with one entry
/// @fails  data: not JSON (the byte is named); another schema; several results; no interval of either kind; a joint
/// that turns, whose excess is in N·m·s/rad.
[[nodiscard]] Result<OperatorShortage> operator_shortage_from_json(std::string_view text);

}  // namespace mbk::result
