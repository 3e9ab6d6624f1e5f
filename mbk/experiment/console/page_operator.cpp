#include "mbk/experiment/console/page_operator.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "mbk/experiment/protocol/personal_data.h"
#include "mbk/experiment/session/idle_watch.h"
#include "mbk/measure/preprocess/exclusions.h"

namespace mbk::console {
namespace {

using State = safety::MotorsOff::State;

class PageWatcher : public session::Watcher {
 public:
  explicit PageWatcher(Console& console) : console_(console) {}
  void watch(std::span<const journal::Tick> ticks) override { console_.watch(ticks); }

 private:
  Console& console_;
};

}  // namespace

bool PageOperator::may_begin(session::Session& session, const session::Experiment& experiment) {
  if (!wait_) return true;
  const protocol::Trial& first = experiment.plans.front().trial;
  std::unique_ptr<device::Device> robot;
  std::optional<session::IdleWatch> watch;
  if (!first.device.simulated()) {
    if (auto made = protocol::make_device(first)) robot = std::move(*made);
    if (robot && robot->start()) {
      watch.emplace(*robot, [&](const session::IdleState& seen) {
        session.see_idle(seen);
        idle(seen);
      });
    }
  }
  while (true) {
    const Action decided = console_.ask(Question::begin);
    if (decided == Action::start) return true;
    if (decided == Action::abort) return false;
    if (decided != Action::reset) continue;
    if (auto ok = session.reset(); !ok) console_.say(ok.error().line());
  }
}

std::unique_ptr<session::Watcher> PageOperator::begin(const session::Attempt& attempt) {
  console_.begin(attempt.index, session::header_of(attempt.plan, attempt.robot.facts()), attempt.target,
                 attempt.plan.sequence.duration(0.0));
  if (!attempt.plan.trial.device.simulated()) {
    const std::vector<std::string> weak = safety::weakened(attempt.plan.limits);
    if (!weak.empty()) console_.say(fmt::format("weak limits: {}", fmt::join(weak, "; ")));
  }
  return std::make_unique<PageWatcher>(console_);
}

void PageOperator::motors(const safety::MotorsOff& motors) {
  motors_missing_ = motors.state == State::missing;
  RobotStatus status;
  status.link = motors.state != State::cannot_say;
  if (motors.state == State::confirmed) status.motors = device::Motors::off;
  if (motors.state == State::confirmed || motors_missing_) status.confirmed_off = !motors_missing_;
  status.sentence = safety::sentence(motors);
  console_.show_robot(status);
}

void PageOperator::idle(const session::IdleState& seen) {
  RobotStatus status;
  status.link = seen.link;
  status.stop_button = seen.stop_button;
  status.fault = seen.fault;
  status.motors = seen.motors;
  if (seen.confirmed_off) {
    status.confirmed_off = true;
  } else if (motors_missing_ || seen.motors == device::Motors::on) {
    status.confirmed_off = false;
  }
  console_.show_robot(status);
}

std::vector<std::string> PageOperator::notes() {
  auto notes = console_.take_notes();
  for (const std::string& note : notes) warn_of_names("the note", note);
  return notes;
}

void PageOperator::recorded(const session::TrialOutcome& outcome) {
  recording_ = outcome.recording;
  console_.finish(outcome);
}

Result<void> PageOperator::judged(const session::Performed& performed) {
  console_.judge(Judgement::of(performed));
  return keep_notes();
}

Result<void> PageOperator::keep_notes() {
  for (const Exclusion& one : console_.take_exclusions()) {
    warn_of_names("the reason", one.excluded + one.excluded_windows);
    MBK_TRY(session::set_metadata(
        one.recording, {{preprocess::kExcluded, one.excluded}, {preprocess::kExcludedWindows, one.excluded_windows}}));
  }
  std::error_code ignored;
  if (!std::filesystem::exists(recording_, ignored)) return {};
  const auto noted = notes();
  return noted.empty() ? Result<void>{} : session::annotate(recording_, noted);
}

void PageOperator::warn_of_names(std::string_view what, const std::string& text) {
  const std::string warning = protocol::personal_warning(std::string(what), text, false);
  if (warning.empty()) return;
  if (warn_) warn_(warning);
  console_.say(warning);
}

bool PageOperator::decides(const session::Performed& performed) const {
  return wait_ || ((performed.stopped() || performed.poor()) && console_.status().controlled);
}

session::Next PageOperator::next(session::Session& session, const session::Performed& performed) {
  if (!decides(performed)) return session::Operator::next(session, performed);
  Question question = performed.stopped() ? Question::reset : Question::after;
  while (true) {
    switch (console_.ask(question)) {
      case Action::repeat:
        return session::Next::repeat;
      case Action::next:
        return session::Next::go_on;
      case Action::abort:
        return session::Next::end;
      case Action::note:
        if (auto ok = keep_notes(); !ok) console_.say(ok.error().line());
        break;
      case Action::reset:
        if (auto ok = session.reset(); !ok) {
          console_.say(ok.error().line());
        } else {
          question = Question::after;
        }
        break;
      default:
        break;
    }
  }
}

}  // namespace mbk::console
