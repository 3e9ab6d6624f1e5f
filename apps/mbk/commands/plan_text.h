#pragma once

#include <string>

#include "mbk/experiment/session/plan.h"

namespace mbk::app {

/// Schedule, times, limits and the results of a rehearsal, for people.
[[nodiscard]] std::string plan_text(const session::Plan& plan, const session::Rehearsal& rehearsal);

}  // namespace mbk::app
