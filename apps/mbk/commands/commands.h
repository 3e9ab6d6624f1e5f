#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// Runs a command after its options are parsed; returns the exit code.
using Action = std::function<int()>;

/// The command line as it was typed, quoted for a shell, to run it again.
std::string command_line(std::span<const std::string> words);

/// The action of each subcommand, by name.
using Actions = std::vector<std::pair<std::string, Action>>;

/// Runs the action of the subcommand that was typed; kWrongUsage if there is none.
int run_chosen(Command parent, const Actions& actions);

/// Each adds one subcommand to `app` and returns its action.
/// @param typed the command line, which a report repeats
Action add_measure(Command app, const std::string& typed);
Action add_identify(Command app);
Action add_explore(Command app, const std::string& typed);
Action add_movement(Command app);
Action add_tf(Command app, const std::string& typed);
Action add_ellipse(Command app);
Action add_passivity(Command app);
Action add_compare(Command app, const std::string& typed);
Action add_info(Command app);
Action add_new(Command app);
Action add_convert(Command app);
Action add_simulate(Command app);
Action add_run(Command app);
Action add_recover(Command app);
Action add_springs(Command app);
Action add_sensor(Command app);
Action add_teleop(Command app);
Action add_validate(Command app);
Action add_reproduce(Command app);
Action add_robot(Command app);
Action add_study(Command app);
Action add_work(Command app);

/// These two speak of the whole tree below `app`, as it is when they run.
Action add_completion(Command app);
Action add_manual(Command app);

}  // namespace mbk::app
