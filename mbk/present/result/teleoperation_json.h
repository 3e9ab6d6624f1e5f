#pragma once

#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/teleoperation.h"

namespace mbk::result {

/// Schema "mbk.teleop/1", in SI units and rad/s. A frequency or end that is infinite is null.
[[nodiscard]] std::string to_json(const TeleoperationFinding& finding);

/// a of an operator whose arm was measured: minus the lowest lower bound of the 95 % intervals of the passivity index
/// over the band in which the model that predicts was judged. The antisymmetric part is in it.
/// @param text  schema mbk.result/2 or mbk.passivity/2, either's first version, or the list of either with one entry
/// @fails  not usable: the result is not, its model fits poorly, or there is no band in which it holds.  data: not JSON
/// (the byte is named); another schema; several results; no index; a joint that turns, whose index is in N·m·s/rad.
[[nodiscard]] Result<OperatorShortage> operator_shortage_from_json(std::string_view text);

}  // namespace mbk::result
