#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "mbk/base/document/fields.h"
#include "mbk/validate/misbehaving_robot.h"

namespace mbk::validation {

/// What mbk_misbehaving_robot prints, a line of schema "robot_event" each: where it listens, and what has happened.
[[nodiscard]] std::string listening_line(const std::string& address, std::uint16_t port);
[[nodiscard]] std::string event_line(std::string_view event, const RobotTruth& truth);

void add_robot_event_schema(document::Schemas& schemas);

}  // namespace mbk::validation
