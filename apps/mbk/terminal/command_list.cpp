#include "apps/mbk/terminal/command_list.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace mbk::app {
namespace {

using Commands = std::vector<std::pair<std::string_view, std::function<Action(Command)>>>;

/// Every command, in the order of --help.
Commands all_commands(const std::string& typed) {
  return {
      {"measure", [typed](Command app) { return add_measure(app, typed); }},
      {"identify", add_identify},
      {"explore", [typed](Command app) { return add_explore(app, typed); }},
      {"movement", add_movement},
      {"tf", [typed](Command app) { return add_tf(app, typed); }},
      {"ellipse", add_ellipse},
      {"passivity", add_passivity},
      {"compare", [typed](Command app) { return add_compare(app, typed); }},
      {"info", add_info},
      {"new", add_new},
      {"convert", add_convert},
      {"simulate", add_simulate},
      {"run", add_run},
      {"recover", add_recover},
      {"springs", add_springs},
      {"teleop", add_teleop},
      {"sensor", add_sensor},
      {"robot", add_robot},
      {"study", add_study},
      {"work", add_work},
      {"validate", add_validate},
      {"reproduce", add_reproduce},
      {"completion", add_completion},
      {"manual", add_manual},
  };
}

}  // namespace

Actions add_commands(std::string_view first, Command app, const std::string& typed) {
  app.footer(
      "Examples:\n"
      "  mbk measure log.mat\n"
      "      M, B, K and x0 from a recording, with confidence intervals and ellipses\n"
      "  mbk info log.mat\n"
      "      the channels, duration and problems of a recording\n"
      "  mbk measure --help\n"
      "      the options of a command, with examples");
  const Commands all = all_commands(typed);
  const bool one = first != "completion" && first != "manual" &&
                   std::ranges::any_of(all, [&](const auto& command) { return command.first == first; });
  Actions made;
  if (first == "--version" || first == "--cite") return made;
  for (const auto& [name, add] : all) {
    if (!one || name == first) made.emplace_back(name, add(app));
  }
  return made;
}

}  // namespace mbk::app
