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
    return bad_usage(fmt::format("{} has {} trials", arguments.scenario, scenarios.size()), "choose one by --trial");
  }
  const auto chosen =
      MBK_TRY(arguments.trial.empty() ? scenarios.front() : laboratory::find_trial(scenarios, arguments.trial));
  const auto* planar = std::get_if<laboratory::PlanarTrial>(&chosen.trial);
  const auto* rig = planar == nullptr ? nullptr : std::get_if<laboratory::RigPlan>(&planar->load);
  if (rig == nullptr || rig->springs.empty()) {
    return bad_data("there is no [[rig.spring]]", "'mbk springs find' writes some", arguments.scenario);
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
    return report_error({ErrorKind::usage, "no springs", "name a scenario file, or give each by --spring", ""});
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
  const Command command = springs.add_command("field", "equilibrium and stiffness of an array of springs");
  command.footer(
      "Examples:\n"
      "  mbk springs field rig.toml\n"
      "      the [[rig.spring]] of a scenario file; --trial chooses among several\n"
      "  mbk springs field --spring k=120,l=90mm,anchor=565:183 --spring k=120,l=90,anchor=565:-183 \\\n"
      "      --spring k=150,l=80,anchor=215:0 --grid-step 0.15\n\n"
      "Places are x:y in mm in the robot's base frame; a hole is where the spring hangs in the disc, from\n"
      "the hand. K is minus the gradient of the force at the place where the force is zero.");
  const Option scenario =
      command.add_option("SCENARIO.toml", arguments->scenario, "a scenario with [[rig.spring]], or a ready one's name")
          .check(suggests(laboratory::ready_scenario_names()));
  command.add_option("--trial", arguments->trial, "which [[trial]] of it").type_name("NAME").needs(scenario);
  add_options(command, request::spring_field_table(), *arguments);
  command.add_flag("--json", arguments->json, "for machines: schema mbk.springs/1");
  arguments->output.add_options(command);
  return [arguments] { return run_field(*arguments); };
}

Action add_find(Command springs) {
  auto arguments = std::make_shared<FindArguments>();
  const Command command = springs.add_command("find", "springs for a target stiffness and equilibrium");
  command.footer(
      "Examples:\n"
      "  mbk springs find --stiffness 443.86,232.34,16.74 --at 393:-55\n"
      "  mbk springs find --stiffness 300,300,0 --disc --payload 1.031 --spring-stiffness 30:250\n\n"
      "Of all springs within the bounds that give exactly this K there, it finds those whose force is the\n"
      "straightest over the travel. The output has them as --spring options and as TOML.");
  add_options(command, request::spring_design_table(), *arguments);
  command.get_option("--stiffness").required();
  command.accept_former_name(command.get_option("--min-extension"), "--least-extension");
  command.accept_former_name(command.get_option("--max-springs"), "--most-springs");
  command.add_flag("--json", arguments->json, "for machines: schema mbk.springs/1");
  arguments->output.add_options(command);
  return [arguments] { return run_find(*arguments); };
}

Action add_springs_calibrate(Command springs) {
  auto arguments = std::make_shared<CalibrateArguments>();
  const Command command = springs.add_command("calibrate", "spring constants from slow stretches");
  command.footer(
      "Examples:\n"
      "  mbk springs calibrate spring_1.csv spring_2.csv\n"
      "      columns time, position and reaction; units as in position_mm\n"
      "  mbk springs calibrate --channels time=1,x=2:mm,F=-3 gauge.csv\n"
      "      F is what the spring exerts on the machine: it falls as x grows; -3 turns a gauge of tension\n\n"
      "The hooks of a spring bend at first. Where that shows, the constant is the slope beyond it.");
  add_reading_options(command, arguments->reading);
  command
      .add_option("--hac-lag", arguments->options.hac_lag_s,
                  "reach of the noise's correlation for the intervals, s (1)")
      .type_name("S")
      .check(not_negative());
  command.add_flag("--json", arguments->output.json, "for machines: schema mbk.springs/1");
  arguments->output.to.add_options(command);
  return [arguments] { return run_calibrate(*arguments); };
}

}  // namespace

Action add_springs(Command app) {
  const Command command =
      app.add_command("springs", "spring arrays for tests: their field, their design, their springs");
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
