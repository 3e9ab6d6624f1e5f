#pragma once

#include "apps/mbk/commands/commands.h"

/// The commands of `mbk robot`, one file each.
namespace mbk::app {

Action add_robot_describe(Command group);
Action add_robot_identify(Command group);
Action add_robot_force(Command group);
Action add_robot_check(Command group);

}  // namespace mbk::app
