#include <fmt/format.h>

#include <memory>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/options/table_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/measure/calibration/spring_constant.h"
#include "mbk/measure/calibration/spring_design.h"
#include "mbk/present/report/springs_text.h"
#include "mbk/present/request/spring_request.h"
#include "mbk/present/result/springs_json.h"
#include "mbk/simulate/laboratory/named_scenario.h"

namespace mbk::app {
namespace {

struct FieldArguments : request::SpringFieldRequest {
  std::string scenario, trial;
  bool json = false;
  Output output;
};

struct FindArguments : request::SpringDesignRequest {
  bool json = false;
  Output output;
};

/// The springs of a scenario's [rig].
Result<std::vector<Spring>> springs_of_scenario(const FieldArguments& arguments) {
  const auto scenarios = MBK_TRY(laboratory::read_scenario_argument(arguments.scenario));
  if (arguments.trial.empty() && scenarios.size() > 1) {
    return bad_usage(fmt::format("{} has {} trials", arguments.scenario, scenarios.size()), "choose one with --trial");
  }
  const auto chosen =
      MBK_TRY(arguments.trial.empty() ? scenarios.front() : laboratory::find_trial(scenarios, arguments.trial));
  const auto* planar = std::get_if<laboratory::PlanarTrial>(&chosen.trial);
  const auto* rig = planar == nullptr ? nullptr : std::get_if<laboratory::RigPlan>(&planar->load);
  if (rig == nullptr || rig->springs.empty()) {
    return bad_data("the scenario has no [[rig.spring]]", "add springs; 'mbk springs find' designs them",
                    arguments.scenario);
  }
  return rig->springs;
}

Result<SpringField> field_of(const FieldArguments& arguments) {
  const auto springs =
      MBK_TRY(arguments.scenario.empty() ? request::springs_of(arguments) : springs_of_scenario(arguments));
  return request::spring_field_of(arguments, springs);
}

int run_field(const FieldArguments& arguments) {
  if (arguments.scenario.empty() && arguments.springs.empty()) {
    return report_error(
        {ErrorKind::usage, "no spring is given", "name a scenario file, or pass each spring with --spring", ""});
  }
  if (auto ok = arguments.output.check({arguments.scenario}); !ok) return report_error(ok.error());
  const auto field = field_of(arguments);
  if (!field) return report_error(field.error());
  const std::string text = arguments.json ? result::to_json(*field) : report::spring_field_text(*field);
  if (auto ok = arguments.output.write(text, {}); !ok) return report_error(ok.error());
  return kFine;
}

int run_find(const FindArguments& arguments) {
  if (auto ok = arguments.output.check({}); !ok) return report_error(ok.error());
  const auto request = request::spring_design_of(arguments);
  if (!request) return report_error(request.error());
  const auto design = calibration::design_springs(*request);
  if (!design) return report_error(design.error());
  const std::string text = arguments.json ? result::to_json(*design) : report::spring_design_text(*design);
  if (auto ok = arguments.output.write(text, {}); !ok) return report_error(ok.error());
  return kFine;
}

struct CalibrateArguments {
  ReadRequest reading;
  OutputArguments output;
  calibration::StretchOptions options;
};

int run_calibrate(const CalibrateArguments& arguments) {
  if (auto ok = arguments.output.to.check(arguments.reading.files); !ok) return report_error(ok.error());
  ReadRequest reading = arguments.reading;
  if (reading.options.axes == 0) reading.options.axes = 1;
  const auto recordings = read_recordings(reading);
  if (!recordings) return report_error(recordings.error());
  std::vector<SpringConstant> constants;
  for (const Recording& recording : *recordings) {
    auto constant = calibration::spring_constant_of(recording, arguments.options);
    if (!constant) return report_error(constant.error());
    constants.push_back(std::move(*constant));
  }
  const std::string text =
      arguments.output.json ? result::to_json(constants) : report::spring_constants_text(constants);
  if (auto ok = arguments.output.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return kFine;
}

Action add_field(Command springs) {
  auto arguments = std::make_shared<FieldArguments>();
  const Command command = springs.add_command("field", "compute the equilibrium and stiffness of a spring array");
  command.footer(
      "Examples:\n"
      "  mbk springs field rig.toml\n"
      "      the [[rig.spring]] of a scenario file; --trial selects one of several trials\n"
      "  mbk springs field --spring k=120,l=90mm,anchor=565:183 --spring k=120,l=90,anchor=565:-183 \\\n"
      "      --spring k=150,l=80,anchor=215:0 --grid-step 0.15\n\n"
      "Positions are x:y in mm in the robot's base frame; a hole is the position of the spring in the\n"
      "disc, relative to the hand. K is the negative gradient of the force at the position where the\n"
      "force is zero.");
  const Option scenario = command
                              .add_option("SCENARIO.toml", arguments->scenario,
                                          "a scenario with [[rig.spring]], or the name of a built-in one")
                              .check(suggests(laboratory::ready_scenario_names()));
  command.add_option("--trial", arguments->trial, "the [[trial]] of the scenario").type_name("NAME").needs(scenario);
  add_options(command, request::spring_field_table(), *arguments);
  command.add_flag("--json", arguments->json, "print JSON: schema mbk.springs/1");
  arguments->output.add_options(command);
  return [arguments] { return run_field(*arguments); };
}

Action add_find(Command springs) {
  auto arguments = std::make_shared<FindArguments>();
  const Command command = springs.add_command("find", "design a spring array for a target stiffness and equilibrium");
  command.footer(
      "Examples:\n"
      "  mbk springs find --stiffness 443.86,232.34,16.74 --at 393:-55\n"
      "  mbk springs find --stiffness 300,300,0 --disc --payload 1.031 --spring-stiffness 30:250\n\n"
      "Among the springs within the bounds that give exactly this K, it finds those with the most linear\n"
      "force over the travel. The output lists them as --spring options and as TOML.");
  add_options(command, request::spring_design_table(), *arguments);
  command.get_option("--stiffness").required();
  command.accept_former_name(command.get_option("--min-extension"), "--least-extension");
  command.accept_former_name(command.get_option("--max-springs"), "--most-springs");
  command.add_flag("--json", arguments->json, "print JSON: schema mbk.springs/1");
  arguments->output.add_options(command);
  return [arguments] { return run_find(*arguments); };
}

Action add_springs_calibrate(Command springs) {
  auto arguments = std::make_shared<CalibrateArguments>();
  const Command command = springs.add_command("calibrate", "measure spring constants from slow stretches");
  command.footer(
      "Examples:\n"
      "  mbk springs calibrate spring_1.csv spring_2.csv\n"
      "      columns time, position and reaction; units as in position_mm\n"
      "  mbk springs calibrate --channels time=1,x=2:mm,F=-3 gauge.csv\n"
      "      F is the force of the spring on the machine: it falls as x grows; -3 reverses the sign of a tension "
      "gauge\n\n"
      "The hooks of a spring bend at first. If that shows, the spring constant is the slope beyond it.");
  add_reading_options(command, arguments->reading);
  command
      .add_option("--hac-lag", arguments->options.hac_lag_s,
                  "correlation time of the noise, in seconds, that the intervals allow for (default: 1)")
      .type_name("S")
      .check(not_negative());
  command.add_flag("--json", arguments->output.json, "print JSON: schema mbk.springs/1");
  arguments->output.to.add_options(command);
  return [arguments] { return run_calibrate(*arguments); };
}

}  // namespace

Action add_springs(Command app) {
  const Command command = app.add_command("springs", "analyse, design and calibrate spring arrays for tests");
  command.require_subcommand();
  command.footer(
      "Examples:\n"
      "  mbk springs find --stiffness 443.86,232.34,16.74 --at 393:-55\n"
      "  mbk springs field --help");
  const Actions actions = {
      {"field", add_field(command)}, {"find", add_find(command)}, {"calibrate", add_springs_calibrate(command)}};
  return [command, actions] { return run_chosen(command, actions); };
}

}  // namespace mbk::app
