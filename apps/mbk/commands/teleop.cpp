#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/chart_format.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/terminal/progress.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/files/contents/read_text.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/teleoperation_text.h"
#include "mbk/present/result/teleoperation_json.h"
#include "mbk/simulate/laboratory/simulate_teleoperation.h"
#include "mbk/teleop/judge.h"

namespace mbk::app {
namespace {

struct TeleopArguments {
  std::filesystem::path design;
  std::filesystem::path operator_result;
  std::string parameter, excess;
  std::filesystem::path charts;
  ChartFormat chart_format;
  bool json = false, simulate = false, quiet = false;
  Output output;
};

/// The last part of the names of the files that --charts writes.
std::vector<std::string> chart_names(const TeleopArguments& arguments) {
  std::vector<std::string> names = {"r11", "r22", "third"};
  if (!arguments.excess.empty()) names.emplace_back("excess");
  if (arguments.simulate) {
    for (int run = 1; run <= laboratory::kMaxRuns; ++run) names.push_back(fmt::format("simulated-{}", run));
  }
  return names;
}

std::filesystem::path chart_file(const TeleopArguments& arguments, const std::string& name) {
  return arguments.chart_format.file(arguments.charts.string() + "_" + name);
}

/// In the order of their names; the last ones may be missing.
std::vector<Chart> charts_of(const TeleoperationFinding& finding) {
  std::vector<Chart> charts = finding.charts;
  if (finding.excess) charts.push_back(finding.excess->chart);
  if (finding.simulation) {
    for (const TeleoperationRun& run : finding.simulation->runs) charts.push_back(run.positions);
  }
  return charts;
}

std::vector<std::filesystem::path> inputs_of(const TeleopArguments& arguments) {
  std::vector<std::filesystem::path> inputs = {arguments.design};
  if (!arguments.operator_result.empty()) inputs.push_back(arguments.operator_result);
  return inputs;
}

Result<void> check(const TeleopArguments& arguments) {
  const std::vector<std::filesystem::path> inputs = inputs_of(arguments);
  if (arguments.output.overwrite && !arguments.output.file && arguments.charts.empty()) {
    return bad_usage("--overwrite requires --out or --charts", "name a file to write");
  }
  MBK_TRY(arguments.output.check(inputs));
  if (arguments.charts.empty()) return {};
  MBK_TRY(arguments.chart_format.check());
  for (const std::string& name : chart_names(arguments)) {
    MBK_TRY(check_new_file(chart_file(arguments, name), "--charts", arguments.output.overwrite, inputs));
  }
  return {};
}

Result<TeleoperationFinding> find(const TeleopArguments& arguments) {
  teleop::Question question;
  if (!arguments.parameter.empty()) {
    auto sweep = MBK_TRY(teleop::parse_sweep(arguments.parameter));
    question.sweep = std::move(sweep);
  }
  if (!arguments.excess.empty()) {
    const auto excess = MBK_TRY(teleop::parse_excess(arguments.excess));
    question.excess = excess;
  }
  if (!arguments.operator_result.empty()) {
    const auto text = MBK_TRY(read_text(arguments.operator_result));
    auto shortage = result::operator_shortage_from_json(text);
    if (!shortage) return tl::unexpected(shortage.error().in(arguments.operator_result.string()));
    shortage->rule = arguments.operator_result.string() + ": " + shortage->rule;
    question.operator_shortage = std::move(*shortage);
  }
  const auto design = MBK_TRY(teleop::read_design(arguments.design));
  Progress progress(arguments.quiet, "teleop: ");
  question.sweep_progress = [&](double share) { progress.reached(share); };
  question.progress = [&](int done, int of) { progress.count(done, of); };
  auto finding = teleop::judge(design, question);
  if (!finding || !arguments.simulate) return finding;
  const std::optional<double> a =
      finding->operator_shortage ? std::optional(finding->operator_shortage->a) : std::nullopt;
  auto simulation = MBK_TRY(laboratory::simulate(design, a, [&](double fraction) { progress.reached(fraction); }));
  finding->simulation = std::move(simulation);
  return finding;
}

int run(const TeleopArguments& arguments) {
  if (auto ok = check(arguments); !ok) return report_error(ok.error());
  const auto finding = find(arguments);
  if (!finding) return report_error(finding.error());
  const std::vector<Chart> charts = charts_of(*finding);
  std::string shown = arguments.json ? result::to_json(*finding) : report::teleoperation_text(*finding);
  if (!arguments.json) {
    for (const Chart& chart : charts) shown += "\n" + report::chart_text(chart);
  }
  const std::vector<std::string> names = chart_names(arguments);
  for (std::size_t i = 0; i < charts.size() && !arguments.charts.empty(); ++i) {
    const auto ok = arguments.chart_format.write(chart_file(arguments, names[i]), {names[i], charts[i]},
                                                 arguments.output.overwrite, inputs_of(arguments));
    if (!ok) return report_error(ok.error());
  }
  const auto written = arguments.json ? arguments.output.write(shown, inputs_of(arguments))
                                      : arguments.output.show(shown, inputs_of(arguments));
  return written ? kFine : report_error(written.error());
}

}  // namespace

Action add_teleop(Command app) {
  auto arguments = std::make_shared<TeleopArguments>();
  const Command command = app.add_command("teleop", "decide the absolute stability of a teleoperator (Llewellyn)");
  command.footer(
      "Examples:\n"
      "  mbk teleop design.toml\n"
      "      Llewellyn's conditions, where they are violated, and the maximum lack of passivity of the operator\n"
      "  mbk teleop design.toml --operator result.json\n"
      "      the modified criterion, with the passivity index that 'mbk measure --json' found; an\n"
      "      unusable result is rejected\n"
      "  mbk teleop design.toml --parameter slave.k=0:1000\n"
      "      intervals of the slave's stiffness in N/m for which the design is stable\n"
      "  mbk teleop design.toml --parameter slave.k=0:1000 --excess 0:10 --operator result.json\n"
      "      those intervals over the operator's excess of passivity, with the measured excess\n"
      "  mbk teleop design.toml --simulate\n"
      "      simulates both arms over the line, with the worst-case hand and environment if the design is unstable\n\n"
      "examples/teleop has complete designs; docs/guide/teleoperation.md lists every key.");
  command.add_option("DESIGN.toml", arguments->design, "a design with an [architecture] or a [two_port]").required();
  command
      .add_option("--operator", arguments->operator_result,
                  "result of the operator's arm; the operator's lack of passivity, a, is the negative lower bound of "
                  "its smallest "
                  "passivity index")
      .type_name("RESULT.json")
      .check(not_empty());
  command
      .add_option("--parameter", arguments->parameter,
                  "find all values of a parameter, in SI units, for which the design is stable: slave.k=0:1000")
      .type_name("NAME=LOW:HIGH")
      .check(not_empty());
  command
      .add_option("--excess", arguments->excess,
                  "find them for operators with these excesses of passivity, in N·s/m: 0:10 or 0:10:21")
      .type_name("LOW:HIGH[:STEPS]")
      .check(not_empty());
  command.add_flag("--simulate", arguments->simulate,
                   "simulate the design over time, with the arms of its [simulation]");
  command
      .add_option("--charts", arguments->charts,
                  "also write the charts: PREFIX_r11.svg, _r22.svg, _third.svg, _excess.svg, _simulated-1.svg, …")
      .type_name("PREFIX")
      .check(not_empty());
  add_chart_format(command, arguments->chart_format);
  command.add_flag("--json", arguments->json, "print JSON: schema mbk.teleop/1");
  command.add_flag("--quiet", arguments->quiet, "no progress on standard error");
  arguments->output.add_options(command);
  const Option overwrite = command.get_option("--overwrite");
  overwrite.remove_needs(command.get_option("--out"));
  overwrite.description("replace existing files of --out and --charts");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
