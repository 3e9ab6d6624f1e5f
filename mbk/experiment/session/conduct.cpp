#include "mbk/experiment/session/conduct.h"

#include <fmt/format.h>

#include <utility>

#include "mbk/experiment/session/idle_watch.h"
#include "mbk/files/recording/own_samples.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/measure/preprocess/perturbation_only.h"

namespace mbk::session {
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

/// Whether M, B and K can be estimated: no stop, a recording, and a perturbation about one position.
bool can_be_measured(const Performed& performed) {
  return !performed.stopped() && performed.outcome.recorded && performed.attempt.plan.schedule.reaches() == nullptr;
}

/// Measures and judges a finished trial.   @returns  what comes next
Result<Next> judge(Performed performed, Session& session, Operator& conductor, const Measure& measure) {
  const auto asked_to_end = [&] { return session.flags().end_session.load(); };
  TrialOutcome& outcome = performed.outcome;
  if (measure && can_be_measured(performed) && !asked_to_end()) {
    performed.measured =
        measure(preprocess::perturbation_only(recording::at_own_samples(*std::exchange(outcome.recorded, {}))));
  }
  outcome.recorded.reset();
  MBK_TRY(conductor.judged(performed));
  if (outcome.unrecorded) return tl::unexpected(*outcome.unrecorded);
  if (outcome.incomplete) {
    return bad_data(outcome.ended, "check the disk before the next trial; the journal is kept",
                    performed.attempt.target.string());
  }
  return asked_to_end() ? Next::end : conductor.next(session, performed);
}

}  // namespace

fs::path Experiment::target(std::size_t index) const {
  return recording_of(plans[index].trial, out, plans.size() > 1);
}

Result<Experiment> plan_experiment(const std::vector<protocol::Trial>& trials, const fs::path& out,
                                   std::string_view file) {
  Experiment experiment;
  experiment.out = out;
  for (const protocol::Trial& trial : trials) {
    auto plan = make_plan(trial);
    if (!plan) return tl::unexpected(plan.error().in(file));
    experiment.plans.push_back(std::move(*plan));
    MBK_TRY(check_target(experiment.plans.back(), recording_of(trial, out, trials.size() > 1)));
  }
  return experiment;
}

fs::path next_free(const fs::path& target) {
  fs::path free = target;
  std::error_code ignored;  // a name that cannot be looked at is refused where it is made
  for (int k = 2; fs::exists(free, ignored); ++k) free = with_suffix(target, k);
  return free;
}

Result<Measurement> measure_recording(const Recording& recording) {
  return measurement::measure({&recording, 1}, {});
}

bool poor(const Identification& identification) {
  return !identification.usable || identification.fit.vaf.minCoeff() < kPoor;
}

Conclusion conduct(const Experiment& experiment, Session& session, Operator& conductor, const Measure& measure) {
  Conclusion conclusion;
  const auto failed = [&](const Error& error) {
    conclusion.failure = error;
    return conclusion;
  };
  for (std::size_t index = 0; index < experiment.plans.size();) {
    conclusion = {};
    if (session.flags().end_session) return conclusion;
    const Plan& plan = experiment.plans[index];
    const auto robot = protocol::make_device(plan.trial);
    if (!robot) return failed(robot.error());
    const Attempt attempt{index, plan, next_free(experiment.target(index)), **robot};
    auto watcher = conductor.begin(attempt);
    if (session.flags().end_session) return conclusion;
    auto outcome = session.perform(
        **robot, plan, attempt.target,
        [&](std::span<const journal::Tick> ticks) {
          if (watcher) watcher->watch(ticks);
        },
        {[&](const safety::MotorsOff& motors) { conductor.motors(motors); },
         [&](const TrialOutcome& given_up) { conductor.given_up(given_up); }, [&] { return conductor.notes(); }});
    watcher.reset();
    if (!outcome) return failed(outcome.error());
    conclusion.trip = outcome->trip;
    conclusion.motors = outcome->motors;
    conductor.motors(conclusion.motors);
    std::optional<IdleWatch> idle;  // until the next trial begins
    if (!plan.trial.device.simulated()) {
      idle.emplace(**robot, [&](const IdleState& seen) {
        session.see_idle(seen);
        conductor.idle(seen);
      });
    }
    conductor.recorded(*outcome);
    const auto next = judge({attempt, std::move(*outcome), std::nullopt}, session, conductor, measure);
    if (!next) return failed(next.error());
    if (*next == Next::end) return conclusion;
    if (*next == Next::go_on) ++index;
  }
  conclusion = {};
  conclusion.completed = true;
  return conclusion;
}

}  // namespace mbk::session
