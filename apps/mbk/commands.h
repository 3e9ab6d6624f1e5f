#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace mbk::app {

/// What a command does once its options are parsed; returns the exit code.
using Action = std::function<int()>;

/// The command line as it was typed, for whoever wants to run it again: quoted for a shell where it has to be.
std::string command_line(int argc, char** argv);

/// A subcommand of `parent`. The one place that makes one: what CLI11 needs for it is compiled once.
CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& summary);

/// What each subcommand does, by its name.
using Actions = std::vector<std::pair<std::string, Action>>;

/// Runs the action of the subcommand that was typed; kWrongUsage where none was.
int run_chosen(const CLI::App& parent, const Actions& actions);

/// Each adds one subcommand to `app` and gives the action to run when it was chosen.
/// @param typed the command line, which a report repeats
Action add_measure(CLI::App& app, const std::string& typed);
Action add_identify(CLI::App& app);
Action add_explore(CLI::App& app, const std::string& typed);
Action add_movement(CLI::App& app);
Action add_tf(CLI::App& app, const std::string& typed);
Action add_ellipse(CLI::App& app);
Action add_passivity(CLI::App& app);
Action add_compare(CLI::App& app, const std::string& typed);
Action add_info(CLI::App& app);
Action add_new(CLI::App& app);
Action add_convert(CLI::App& app);
Action add_simulate(CLI::App& app);
Action add_run(CLI::App& app);
Action add_recover(CLI::App& app);
Action add_springs(CLI::App& app);
Action add_sensor(CLI::App& app);
Action add_teleop(CLI::App& app);
Action add_validate(CLI::App& app);
Action add_reproduce(CLI::App& app);
Action add_robot(CLI::App& app);
Action add_study(CLI::App& app);
Action add_work(CLI::App& app);

/// These two speak of the whole tree below `app`, as it is when they run.
Action add_completion(CLI::App& app);
Action add_manual(CLI::App& app);

}  // namespace mbk::app
