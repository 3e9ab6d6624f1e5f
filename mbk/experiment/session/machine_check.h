#pragma once

#include <string>
#include <vector>

#include "mbk/base/realtime/machine.h"
#include "mbk/experiment/session/robot_check.h"

namespace mbk::session {

/// What was measured of the wake-ups of a session's loop, and what of the machine may hold it up, with how to mend it.
/// Nothing is claimed beyond the time that was measured.
[[nodiscard]] std::vector<Finding> check_machine(const realtime::Machine& machine, const realtime::Lateness& lateness);

/// Quantiles and histogram, for people.
[[nodiscard]] std::string lateness_text(const realtime::Machine& machine, const realtime::Lateness& lateness);

}  // namespace mbk::session
