#pragma once

#include "apps/mbk/commands.h"

namespace mbk::app {

/// The parts of 'mbk new'. Each adds itself to the group.
Action add_new_channels(CLI::App& group);
Action add_new_experiment(CLI::App& group);
Action add_new_robot(CLI::App& group);

}  // namespace mbk::app
