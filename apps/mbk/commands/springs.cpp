#include <fmt/format.h>

#include <memory>
#include <numbers>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/options/scenario_argument.h"
#include "apps/mbk/options/spring_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/calibration/spring_array.h"
#include "mbk/measure/calibration/spring_constant.h"
#include "mbk/measure/calibration/spring_design.h"
#include "mbk/present/report/springs_text.h"
#include "mbk/present/result/springs_json.h"

namespace mbk::app {
namespace {

struct FieldArguments {
  std::string scenario, trial;
  std::vector<std::string> springs;
  std::string start;
  double radius_mm = 30.0, rotation_deg = 0.0;
  std::optional<double> grid_step_mm;
  bool push = false, json = false;
  Output output;
};

struct FindArguments {
  std::string stiffness, at, frame = "390:0", spring_stiffness = "20:400", spring_length = "60:160";
  std::vector<std::string> eyes;
  double travel_mm = 30.0, min_extension_mm = 2.0;
  int max_springs = 8;
  std::optional<double> payload_kg;
  bool disc = false, json = false;
  Output output;
};

/// The springs of a scenario's [rig].
Result<std::vector<Spring>> springs_of_scenario(const FieldArguments& arguments) {
  const auto scenarios = MBK_TRY(read_scenario_argument(arguments.scenario));
  if (arguments.trial.empty() && scenarios.size() > 1) {
    return bad_usage(fmt::format("{} has {} trials", arguments.scenario, scenarios.size()), "choose one by --trial");
  }
  const auto chosen = MBK_TRY(arguments.trial.empty() ? scenarios.front() : find_trial(scenarios, arguments.trial));
  const auto* planar = std::get_if<laboratory::PlanarTrial>(&chosen.trial);
  const auto* rig = planar == nullptr ? nullptr : std::get_if<laboratory::RigPlan>(&planar->load);
  if (rig == nullptr || rig->springs.empty()) {
    return bad_data("there is no [[rig.spring]]", "'mbk springs find' writes some", arguments.scenario);
  }
  return rig->springs;
}

Result<std::vector<Spring>> springs_of(const FieldArguments& arguments) {
  if (!arguments.scenario.empty()) return springs_of_scenario(arguments);
  std::vector<Spring> springs;
  for (const std::string& given : arguments.springs) {
    const auto spring = MBK_TRY(parse_spring(given));
    springs.push_back(spring);
  }
  return springs;
}

Result<SpringField> field_of(const FieldArguments& arguments) {
  const auto given = MBK_TRY(springs_of(arguments));
  const std::vector<Spring>& springs = given;
  Eigen::Vector2d start = calibration::centre_of_anchors(springs);
  if (!arguments.start.empty()) {
    start = MBK_TRY(parse_place("--start", arguments.start));
  }
  const auto array = MBK_TRY(calibration::SpringArray::create(
      springs, arguments.push ? calibration::Compression::push : calibration::Compression::slack));
  const double radius = arguments.radius_mm / kMillimetres;
  const double rotation = arguments.rotation_deg * std::numbers::pi / 180.0;
  auto field = calibration::spring_field(array, start, radius, rotation);
  if (field && arguments.grid_step_mm) {
    const double step = *arguments.grid_step_mm / kMillimetres;
    const auto grid = MBK_TRY(calibration::grid_field(array, field->equilibrium, radius, step, rotation));
    field->grid = grid;
  }
  return field;
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

Result<calibration::SpringRequest> request_of(const FindArguments& arguments) {
  calibration::SpringRequest request;
  const auto K = MBK_TRY(parse_stiffness(arguments.stiffness));
  request.K = K;
  const auto frame = MBK_TRY(parse_place("--frame", arguments.frame));
  request.equilibrium = frame;
  if (!arguments.at.empty()) {
    request.equilibrium = MBK_TRY(parse_place("--at", arguments.at));
  }
  request.eyes = calibration::frame_eyes(frame);
  if (!arguments.eyes.empty()) request.eyes.clear();
  for (const std::string& given : arguments.eyes) {
    const auto eye = MBK_TRY(parse_place("--eye", given));
    request.eyes.push_back(eye);
  }
  if (arguments.disc) {
    for (const Eigen::Vector2d& eye : request.eyes) request.holes.push_back(calibration::facing_hole(eye, frame));
  }
  const auto stiffness = MBK_TRY(parse_range("--spring-stiffness", arguments.spring_stiffness));
  request.stiffness = stiffness;
  const auto length = MBK_TRY(parse_range("--spring-length", arguments.spring_length));
  request.rest_length = {length.first / kMillimetres, length.second / kMillimetres};
  request.travel = arguments.travel_mm / kMillimetres;
  request.min_extension = arguments.min_extension_mm / kMillimetres;
  request.max_springs = arguments.max_springs;
  request.payload = arguments.payload_kg;
  return request;
}

int run_find(const FindArguments& arguments) {
  if (auto ok = arguments.output.check({}); !ok) return report_error(ok.error());
  const auto request = request_of(arguments);
  if (!request) return report_error(request.error());
  const auto design = calibration::design_springs(*request);
  if (!design) return report_error(design.error());
  const std::string text = arguments.json ? result::to_json(*design) : report::spring_design_text(*design);
  if (auto ok = arguments.output.write(text, {}); !ok) return report_error(ok.error());
  return kFine;
}

Result<SpringConstant> constant_of(const Recording& recording, double hac_lag_s) {
  const std::string file = recording.sources.empty() ? std::string() : recording.sources.front().label();
  const Channel* const position = recording.find("position");
  const Channel* const reaction = recording.find("reaction");
  if (position == nullptr || reaction == nullptr) {
    return bad_data(fmt::format("there is no {} of one axis", position == nullptr ? "position" : "reaction"),
                    "name the columns, as in --channels time=1,x=2:mm,F=3", file);
  }
  if (position->unit == "rad" || reaction->unit == "N.m") {
    return bad_data("it measures an angle or a moment, and a spring is stretched in mm and N",
                    "name the units, as in --channels time=1,x=2:mm,F=3:N", file);
  }
  calibration::StretchOptions options;
  options.hac_lag_s = hac_lag_s;
  auto constant = calibration::fit_spring_constant(recording.time, position->values, reaction->values, options);
  if (!constant) return tl::unexpected(constant.error().in(file));
  constant->sources = recording.sources;
  return constant;
}

struct CalibrateArguments {
  ReadRequest reading;
  OutputArguments output;
  double hac_lag_s = 1.0;
};

int run_calibrate(const CalibrateArguments& arguments) {
  if (auto ok = arguments.output.to.check(arguments.reading.files); !ok) return report_error(ok.error());
  ReadRequest reading = arguments.reading;
  if (reading.options.axes == 0) reading.options.axes = 1;
  const auto recordings = read_recordings(reading);
  if (!recordings) return report_error(recordings.error());
  std::vector<SpringConstant> constants;
  for (const Recording& recording : *recordings) {
    auto constant = constant_of(recording, arguments.hac_lag_s);
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
          .check(suggests(ready_scenario_names()));
  command.add_option("--trial", arguments->trial, "which [[trial]] of it").type_name("NAME").needs(scenario);
  command.add_option("--spring", arguments->springs, "k in N/m, rest length l in mm, anchor, and hole; once for each")
      .type_name("k=K,l=L,anchor=X:Y[,hole=X:Y]")
      .expected(1)
      .take_all()
      .excludes(scenario);
  command.add_option("--radius", arguments->radius_mm, "circle in mm in which K is compared with the force (30)")
      .type_name("MM")
      .check(positive());
  command.add_option("--start", arguments->start, "where the search for the equilibrium begins, mm").type_name("X:Y");
  command.add_option("--rotation", arguments->rotation_deg, "of the disc, degrees anticlockwise (0)").type_name("DEG");
  command
      .add_option("--grid-step", arguments->grid_step_mm,
                  "also the published procedure, on a grid of so many mm (0.15 in Dyck 2013)")
      .type_name("MM")
      .check(positive());
  command.add_flag("--push", arguments->push, "springs shorter than at rest push; otherwise they go slack");
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
  command.add_option("--stiffness", arguments->stiffness, "target kxx, kyy and ks in N/m")
      .type_name("KXX,KYY,KS")
      .required();
  command.add_option("--at", arguments->at, "target equilibrium, mm (the middle of the frame)").type_name("X:Y");
  command.add_option("--frame", arguments->frame, "middle of the frame, mm (390:0)").type_name("X:Y");
  command
      .add_option("--eye", arguments->eyes,
                  "a screw eye, mm; once for each of up to 12 (the published frame: corners and middles of the sides "
                  "of 350 by 366 mm)")
      .type_name("X:Y")
      .expected(1)
      .take_all();
  command.add_flag("--disc", arguments->disc,
                   "hang each spring in the facing hole of the published disc, 2.25 cm across; otherwise all at its "
                   "middle");
  command.add_option("--spring-stiffness", arguments->spring_stiffness, "springs that can be had, N/m (20:400)")
      .type_name("FROM:TO");
  command.add_option("--spring-length", arguments->spring_length, "their rest lengths, mm (60:160)")
      .type_name("FROM:TO");
  command.add_option("--travel", arguments->travel_mm, "radius in mm in which all stay in tension (30)")
      .type_name("MM")
      .check(positive());
  const Option min_extension = command
                                   .add_option("--min-extension", arguments->min_extension_mm,
                                               "by how much each stays longer than at rest in there, mm (2)")
                                   .type_name("MM")
                                   .check(not_negative());
  command.accept_former_name(min_extension, "--least-extension");
  const Option max_springs =
      command.add_option("--max-springs", arguments->max_springs, "no more springs than this (8)")
          .type_name("N")
          .check(whole_number(3, 12));
  command.accept_former_name(max_springs, "--most-springs");
  command.add_option("--payload", arguments->payload_kg, "mass in kg, to see the natural frequencies")
      .type_name("KG")
      .check(positive());
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
  command.add_option("--hac-lag", arguments->hac_lag_s, "reach of the noise's correlation for the intervals, s (1)")
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
