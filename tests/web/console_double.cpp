// The console without a session: it shows of the robot what its standard input says, so that a test sees in the page
// what no simulated robot does. A line each:
//   robot {"motors": "on", "confirmed_off": false, "stop_button": false, "link": true, "fault": 0, "sentence": ""}
//   ask reset      asks the page and prints its decision; "begin" and "after" too
//   report FILE    the report of its trial
//   judge poor 40 91 WHY    a trial was performed: its grade, what the model explains on each axis [%], why it is not
//   good quit
#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>

#include "mbk/experiment/console/console.h"
#include "mbk/experiment/protocol/experiment.h"
#include "mbk/simulate/laboratory/simulation.h"

namespace {

using mbk::console::Action;
using mbk::console::Console;
using mbk::console::Question;
using mbk::console::RobotStatus;

constexpr const char* kExperiment = R"(
[control]
kind = "position"
[perturbation]
kind = "multisine"
duration_s = 4
moving_in_s = 1
[participant]
kind = "arm"
number = 1
)";

RobotStatus robot_of(const nlohmann::json& said) {
  RobotStatus robot;
  const std::string motors = said.at("motors");
  robot.motors = motors == "on"    ? RobotStatus::Motors::on
                 : motors == "off" ? RobotStatus::Motors::off
                                   : RobotStatus::Motors::unknown;
  if (!said.at("confirmed_off").is_null()) robot.confirmed_off = said.at("confirmed_off").get<bool>();
  robot.stop_button = said.at("stop_button");
  robot.link = said.at("link");
  robot.fault = said.at("fault");
  robot.sentence = said.at("sentence");
  return robot;
}

mbk::console::Judgement judgement_of(const std::string& said) {
  std::istringstream in(said);
  std::string grade;
  mbk::console::Judgement judgement;
  judgement.vaf.resize(2);
  in >> grade >> judgement.vaf[0] >> judgement.vaf[1] >> std::ws;
  judgement.grade = mbk::value_of<mbk::console::Grade>(grade).value_or(mbk::console::Grade::none);
  std::getline(in, judgement.why);
  return judgement;
}

/// A trial that is over as soon as it has begun.
void perform(Console& console, const mbk::session::Plan& plan) {
  console.begin(0, mbk::session::header_of(plan, {}), "trial.h5", 4.0);
  mbk::session::TrialOutcome outcome;
  outcome.recording = "trial.h5";
  outcome.ended = "completed";
  console.finish(outcome);
}

/// Until the page decided other than to write a note.
void ask(Console& console, Question question) {
  Action decided = Action::note;
  while (decided == Action::note) decided = console.ask(question);
  fmt::print("decided {}\n", mbk::word_of(decided));
  std::fflush(stdout);
}

}  // namespace

int main() {
  const auto trials = mbk::protocol::read_experiment(kExperiment, "experiment.toml", mbk::laboratory::read_simulation);
  if (!trials) return 1;
  const auto plan = mbk::session::make_plan(trials->front());
  if (!plan) return 1;
  mbk::session::LoopFlags flags;
  auto console = Console::open(0, {*plan}, flags, [](const std::string& line) { fmt::print(stderr, "{}\n", line); });
  if (!console) return 1;
  fmt::print("console: {}\n", (*console)->address());
  std::fflush(stdout);
  std::thread asking;
  for (std::string line; std::getline(std::cin, line) && line != "quit";) {
    const std::string what = line.substr(0, line.find(' ')), rest = line.substr(line.find(' ') + 1);
    if (what == "robot") {
      (*console)->show_robot(robot_of(nlohmann::json::parse(rest)));
    } else if (what == "judge") {
      perform(**console, *plan);
      (*console)->judge(judgement_of(rest));
    } else if (what == "report") {
      std::ifstream file(rest, std::ios::binary);
      (*console)->show_report(std::string(std::istreambuf_iterator<char>(file), {}));
    } else if (what == "ask" && !asking.joinable()) {
      const Question question = rest == "reset" ? Question::reset : rest == "after" ? Question::after : Question::begin;
      asking = std::thread([&console, question] { ask(**console, question); });
    }
  }
  if (asking.joinable()) asking.join();
  return 0;
}
