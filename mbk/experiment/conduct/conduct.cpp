#include "mbk/experiment/conduct/conduct.h"

#include <fmt/format.h>

#include <utility>

#include "mbk/experiment/session/idle_watch.h"

namespace mbk::conduct {
namespace {

namespace fs = std::filesystem;

fs::path with_suffix(const fs::path& file, const auto& suffix) {
  return file.parent_path() / fmt::format("{}_{}{}", file.stem().string(), suffix, file.extension().string());
}

/// Recording of a trial of an experiment.
fs::path recording_of(const protocol::Trial& trial, const fs::path& out, bool several) {
  const fs::path file = out.empty() ? fs::path(trial.protocol + ".h5") : out;
  return several ? with_suffix(file, trial.name) : file;
}

/// One experiment, and how far it has come.
class Run {
 public:
  Run(const Experiment& experiment, session::Session& session, Operator& conductor, const Measure& measure)
      : experiment_(experiment), session_(session), operator_(conductor), measure_(measure) {}

  Conclusion conclude() {
    for (std::size_t index = 0; index < experiment_.plans.size(); ++index) {
      Next next = Next::repeat;
      while (next == Next::repeat) {
        conclusion_ = {};
        if (asked_to_end()) return conclusion_;
        next = perform(index);
      }
      if (next == Next::end) return conclusion_;
    }
    conclusion_ = {};
    conclusion_.completed = true;
    return conclusion_;
  }

 private:
  [[nodiscard]] bool asked_to_end() const { return session_.flags().end_session; }

  Next fail(Error error) {
    conclusion_.failure = std::move(error);
    return Next::end;
  }

  /// One trial: on the robot, into the file, and measured.
  Next perform(std::size_t index) {
    const session::Plan& plan = experiment_.plans[index];
    const auto robot = protocol::make_device(plan.trial);
    if (!robot) return fail(robot.error());
    const Attempt attempt{index, plan, next_free(experiment_.target(index)), **robot};
    auto watcher = operator_.begin(attempt);
    if (asked_to_end()) return Next::end;
    auto outcome = session_.perform(**robot, plan, attempt.target,
                                    [&](std::span<const journal::Tick> ticks) {
                                      if (watcher) watcher->watch(ticks);
                                    },
                                    {[&](const safety::MotorsOff& motors) { operator_.motors(motors); },
                                     [&](const session::TrialOutcome& given_up) { operator_.given_up(given_up); }});
    watcher.reset();
    if (!outcome) return fail(outcome.error());
    conclusion_.trip = outcome->trip;
    conclusion_.motors = outcome->motors;
    operator_.motors(conclusion_.motors);
    std::optional<session::IdleWatch> idle;
    if (!plan.trial.device.simulated()) {
      idle.emplace(**robot, [this](const session::IdleState& seen) {
        session_.see_idle(seen);
        operator_.idle(seen);
      });
    }
    operator_.recorded(*outcome);
    Performed performed{attempt, std::move(*outcome), std::nullopt};
    const bool reaches = plan.schedule.reaches() != nullptr;  // M, B and K about one place are not theirs
    if (!performed.stopped() && measure_ && !reaches && !asked_to_end() && !performed.outcome.unrecorded) {
      performed.measured = measure_trial(performed.outcome.recording, measure_);
    }
    if (auto ok = operator_.judged(performed); !ok) return fail(ok.error());
    if (performed.outcome.unrecorded) return fail(*performed.outcome.unrecorded);
    if (performed.outcome.incomplete) {
      return fail({ErrorKind::data, performed.outcome.ended,
                   "look at the disk before the next trial; the journal is kept", attempt.target.string()});
    }
    return asked_to_end() ? Next::end : operator_.next(session_, performed);
  }

  const Experiment& experiment_;
  session::Session& session_;
  Operator& operator_;
  const Measure& measure_;
  Conclusion conclusion_;
};

}  // namespace

fs::path Experiment::target(std::size_t index) const {
  return recording_of(plans[index].trial, out, plans.size() > 1);
}

Result<Experiment> plan_experiment(const std::vector<protocol::Trial>& trials, const fs::path& out,
                                   std::string_view file) {
  Experiment experiment;
  experiment.out = out;
  for (const protocol::Trial& trial : trials) {
    auto plan = session::make_plan(trial);
    if (!plan) return tl::unexpected(plan.error().in(file));
    experiment.plans.push_back(std::move(*plan));
    const fs::path target = recording_of(trial, out, trials.size() > 1);
    MBK_TRY(session::check_target(experiment.plans.back(), target));
  }
  return experiment;
}

fs::path next_free(const fs::path& target) {
  fs::path free = target;
  std::error_code ignored;  // a name that cannot be looked at is refused where it is made
  for (int k = 2; fs::exists(free, ignored); ++k) free = with_suffix(target, k);
  return free;
}

Conclusion run(const Experiment& experiment, session::Session& session, Operator& conductor, const Measure& measure) {
  return Run(experiment, session, conductor, measure).conclude();
}

}  // namespace mbk::conduct
