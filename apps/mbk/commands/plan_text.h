#pragma once

#include <string>

#include "mbk/experiment/session/plan.h"

namespace mbk::app {

/// Schedule, times, limits and what a rehearsal came to, for people.
[[nodiscard]] std::string plan_text(const session::Plan& plan, const session::Rehearsal& rehearsal);

}  // namespace mbk::app
