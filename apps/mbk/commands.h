#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace mbk::app {

/// What a command does once its options are parsed; returns the exit code.
using Action = std::function<int()>;

/// Each adds one subcommand to `app` and gives the action to run when it was chosen.
Action add_measure(CLI::App& app);
Action add_identify(CLI::App& app);
Action add_ellipse(CLI::App& app);
Action add_info(CLI::App& app);
Action add_simulate(CLI::App& app);
Action add_springs(CLI::App& app);
Action add_validate(CLI::App& app);
Action add_robot(CLI::App& app);

/// These two speak of the whole tree below `app`, as it is when they run.
Action add_completion(CLI::App& app);
Action add_manual(CLI::App& app);

}  // namespace mbk::app
