#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <vector>

#include "apps/mbk/commands.h"
#include "mbk/core/version.h"

int main(int argc, char** argv) {
  CLI::App app{
      "mbk measures the mechanical impedance of the human arm with a rehabilitation robot: inertia M, damping B,\n"
      "stiffness K and equilibrium x0 at the hand, M ẍ + B ẋ + K (x − x0) = −F, from force and position while the "
      "robot\n"
      "perturbs it. F is the force that the hand exerts on the robot.\n\n"
      "  mbk measure log.mat                 the main job: recording → M, B, K, x0, ellipses, warnings\n"
      "  mbk info log.mat                    what is in a recording, and what is wrong with it\n"
      "  mbk measure --help                  every command explains itself"};
  app.name("mbk");
  app.set_version_flag("--version", fmt::format("mbk {}", mbk::version()));
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return fmt::format("mbk: {}; see 'mbk --help', or 'mbk COMMAND --help'\n", error.what());
  });

  const std::vector<std::pair<const char*, mbk::app::Action>> commands = {
      {"measure", mbk::app::add_measure(app)},   {"identify", mbk::app::add_identify(app)},
      {"ellipse", mbk::app::add_ellipse(app)},   {"info", mbk::app::add_info(app)},
      {"validate", mbk::app::add_validate(app)},
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  }
  try {
    for (const auto& [name, action] : commands) {
      if (app.got_subcommand(name)) return action();
    }
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "mbk: not enough memory for this recording; choose a part of it with --from and --to\n");
    return 3;
  }
  return 2;
}
