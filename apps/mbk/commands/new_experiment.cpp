#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <tuple>

#include "apps/mbk/commands/new_commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/report_file.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/questions.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/experiment/protocol/experiment.h"
#include "mbk/experiment/session/plan.h"
#include "mbk/files/recording/write_file.h"
#include "mbk/simulate/laboratory/simulation.h"

namespace mbk::app {
namespace {

/// A perturbation that is offered, with its words for the file.
struct OfferedPerturbation {
  const char *word, *control, *kind, *peak_key, *peak_unit, *peak, *remark;
  bool has_duration;
};

constexpr OfferedPerturbation kOffered[] = {
    {"sines", "position", "multisine", "peak_deg", "deg of a joint", "2", "a sum of sines, the joints follow it", true},
    {"pulses", "position", "pulses", "amplitude_mm", "mm of the hand", "15", "short pulses of position, with pauses",
     false},
    {"force", "force", "multisine", "peak_N", "N at the hand", "3", "a sum of sines, the hand feels it", true},
};

Result<std::string> robot_section(const Questions& questions) {
  const auto robot =
      MBK_TRY(questions.ask("Robot: simulated, or one behind udp", "simulated", word_of_these({"simulated", "udp"})));
  if (robot == "simulated") {
    return std::string(
        "# Without [device] the robot is simulated, with this participant at its handle. See docs/guide/own_robot.md.\n"
        "[participant]\nkind = \"arm\"\nnumber = 1\n");
  }
  const auto address = MBK_TRY(questions.ask("Address of the robot", "127.0.0.1", [](const std::string& given) {
    return given.find_first_not_of("0123456789.") == std::string::npos ? "" : quoted(given) + " is no IPv4 address";
  }));
  const auto port = MBK_TRY(questions.ask("Its port", "25000", whole_number(1, 65535).wrong));
  std::string lengths;
  for (const auto& [question, key, usual] :
       {std::tuple("Length of its first link, shoulder side, mm", "d1_mm", "254"),
        std::tuple("Length of its last link, to the handle, mm", "d2_mm", "266.7")}) {
    const auto length = MBK_TRY(questions.ask(question, usual, positive_number()));
    lengths += fmt::format("{} = {}\n", key, length);
  }
  const auto place = [](const std::string& given) {
    double x = 0.0, y = 0.0;
    char more = 0;
    return std::sscanf(given.c_str(), "%lf , %lf %c", &x, &y, &more) == 2 ? "" : quoted(given) + " is no 'x, y' in mm";
  };
  const auto home = MBK_TRY(questions.ask("Where the hand is measured, x, y in mm from the base", "300, -50", place));
  lengths += fmt::format("home_mm = [{}]\n", home);
  return fmt::format(
      "[robot]                        # angles, inertia and friction: docs/guide/own_robot.md\n{}\n"
      "# Check it before anyone sits down: mbk robot check FILE --live 5\n"
      "[device]\nkind = \"udp\"\naddress = \"{}\"\nport = {}\n",
      lengths, address, port);
}

Result<std::string> trial_sections(const Questions& questions) {
  const auto word = MBK_TRY(questions.ask("Perturbation: sines (position), pulses (position) or force (sines)", "sines",
                                          word_of_these({"sines", "pulses", "force"})));
  const OfferedPerturbation& offered =
      *std::ranges::find_if(kOffered, [&](const OfferedPerturbation& one) { return word == one.word; });
  const auto peak = MBK_TRY(questions.ask(fmt::format("Peak, {}", offered.peak_unit), offered.peak, positive_number()));
  std::string text =
      fmt::format("[control]\nkind = \"{}\"\n\n[perturbation]                 # {}\nkind = \"{}\"\n{} = {}\n",
                  offered.control, offered.remark, offered.kind, offered.peak_key, peak);
  if (!offered.has_duration) return text;
  const auto duration = MBK_TRY(questions.ask("Duration, s", "62.1", positive_number()));
  return text + fmt::format("duration_s = {}\nmoving_in_s = 5              # in which it grows, and fades at the end\n",
                            duration);
}

Result<std::string> experiment_text(const Questions& questions) {
  const auto robot = MBK_TRY(robot_section(questions));
  const auto trial = MBK_TRY(trial_sections(questions));
  const auto condition =
      MBK_TRY(questions.ask("Condition, as it is to stand in the recording", "relaxed", [](const std::string& given) {
        return given.find_first_of("\"\\") == std::string::npos ? "" : "without quotes and backslashes";
      }));
  const auto repetitions = MBK_TRY(questions.ask("Trials of it", "3", whole_number(1, 100).wrong));
  std::string text = fmt::format(
      "# An experiment for 'mbk run'. examples/experiments/study.toml has every key with its default, the limits of\n"
      "# [safety] among them. Look at it first:  mbk run FILE --dry-run\n"
      "[recording]\nrate_hz = 1000\ncondition = \"{}\"\n\n{}\n{}",
      condition, robot, trial);
  for (int k = 1; k <= std::stoi(repetitions); ++k) {
    text += fmt::format(
        "\n[[trial]]\nname = \"trial_{0}\"\n[trial.recording]\nseed = {0}                      # other phases "
        "than the other trials\n",
        k);
  }
  return text;
}

int run(const NewFileArguments& arguments) {
  if (auto ok = check_new_file(arguments.out, "--out", arguments.overwrite, {}); !ok) return report_error(ok.error());
  const auto text = experiment_text(Questions(arguments.yes));
  if (!text) return report_error(text.error());
  const auto trials = protocol::read_experiment(*text, arguments.out, laboratory::read_simulation);
  if (!trials) return report_error(trials.error());
  for (const protocol::Trial& trial : *trials) {
    if (const auto plan = session::make_plan(trial); !plan) return report_error(plan.error());
  }
  if (auto ok = recording::write_file(arguments.out, arguments.overwrite, *text); !ok) return report_error(ok.error());
  say("{}: {} trial{}; next: mbk run {} --dry-run\n", arguments.out.string(), trials->size(),
      trials->size() == 1 ? "" : "s", shell_word(arguments.out.string()));
  return kFine;
}

}  // namespace

Action add_new_experiment(Command group) {
  auto arguments = std::make_shared<NewFileArguments>();
  arguments->out = "experiment.toml";
  const Command command = group.add_command("experiment", "an experiment for 'mbk run', from a few answers");
  command.footer(
      "Examples:\n"
      "  mbk new experiment --out mine.toml\n"
      "      asks for robot, perturbation, condition and trials\n"
      "  mbk new experiment --yes && mbk run experiment.toml --dry-run\n"
      "  printf 'udp\\n192.168.1.10\\n25000\\n300\\n280\\n300,-50\\npulses\\n10\\nrigid\\n5\\n' |\n"
      "      mbk new experiment --out rigid.toml\n\n"
      "The file is written only after it was read as 'mbk run' reads it, and has comments.");
  add_new_file_options(command, *arguments);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
