#pragma once

#include "apps/mbk/commands.h"

/// The commands of `mbk robot`, one file each.
namespace mbk::app {

Action add_robot_describe(CLI::App& group);
Action add_robot_identify(CLI::App& group);
Action add_robot_force(CLI::App& group);
Action add_robot_check(CLI::App& group);

}  // namespace mbk::app
