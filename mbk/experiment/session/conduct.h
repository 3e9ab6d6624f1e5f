#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/experiment/device/device.h"
#include "mbk/experiment/protocol/experiment.h"
#include "mbk/experiment/safety/motors_off.h"
#include "mbk/experiment/safety/trip.h"
#include "mbk/experiment/session/plan.h"
#include "mbk/experiment/session/session.h"
#include "mbk/files/journal/tick.h"
#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/recording.h"

namespace mbk::session {

/// An experiment that can begin: its trials, each planned once, and where they are recorded.
struct Experiment {
  std::vector<Plan> plans;    ///< in the order of the trials
  std::filesystem::path out;  ///< empty: PROTOCOL.h5

  /// Recording of a trial: `out`, or where there are several trials relaxed.h5 → relaxed_NAME.h5.
  [[nodiscard]] std::filesystem::path target(std::size_t index) const;
};

/// Plans every trial.   @param file  how messages call the experiment
/// @fails  as make_plan and check_target.
[[nodiscard]] Result<Experiment> plan_experiment(const std::vector<protocol::Trial>& trials,
                                                 const std::filesystem::path& out, std::string_view file);

/// Where a trial is recorded that may be a repeated one: relaxed.h5, relaxed_2.h5, … the first that is not there yet.
[[nodiscard]] std::filesystem::path next_free(const std::filesystem::path& target);

/// What makes a measurement of what was recorded while the trial perturbed.
using Measure = std::function<Result<Measurement>(const Recording&)>;

/// measurement::measure with no option: everything follows from the recording.   @fails  as that
[[nodiscard]] Result<Measurement> measure_recording(const Recording& recording);

/// Share of the force's variance that a model has to explain on every axis [%].
inline constexpr double kPoor = 50.0;

/// Whether a trial with this result is worth repeating: it is not usable, or explains less than kPoor on an axis.
[[nodiscard]] bool poor(const Identification& identification);

/// A trial that is about to begin.
struct Attempt {
  std::size_t index;  ///< of the trial in its experiment
  const Plan& plan;
  std::filesystem::path target;  ///< of the recording
  device::Device& robot;
};

/// A trial that is over, and recorded unless its outcome says why not.
struct Performed {
  const Attempt& attempt;
  TrialOutcome outcome;
  std::optional<Result<Measurement>> measured;  ///< absent: the trial was stopped, or is only recorded

  /// The gate has tripped.
  [[nodiscard]] bool stopped() const { return outcome.trip.reason != safety::Reason::none; }
  /// It could not be measured, or what was found is poor.
  [[nodiscard]] bool poor() const { return measured && (!*measured || session::poor((*measured)->identification)); }
};

/// What comes after a trial.
enum class Next { go_on, repeat, end };

/// Lives from before the robot moves until it is at rest: a line that shows how far a trial is, keys that stop it.
class Watcher {
 public:
  Watcher() = default;
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;
  virtual ~Watcher() = default;

  /// As Watch.
  virtual void watch(std::span<const journal::Tick> ticks) = 0;
};

/// Who conducts an experiment: is told what happens, and decides what comes next. As it stands here nobody looks and
/// nobody is there: after a stop no trial follows, and none is repeated.
class Operator {
 public:
  Operator() = default;
  Operator(const Operator&) = delete;
  Operator& operator=(const Operator&) = delete;
  virtual ~Operator() = default;

  /// A trial begins.   @returns  what is to live as long as it runs; may be null
  [[nodiscard]] virtual std::unique_ptr<Watcher> begin(const Attempt& /*attempt*/) { return nullptr; }

  /// The robot is at rest: first of all what it says of its motors. While a trial runs, from another thread: that no
  /// tick comes from the robot's driver (`missing`), and that ticks come again (`waiting`).
  virtual void motors(const safety::MotorsOff& /*motors*/) {}

  /// What a robot that is not simulated says until the next trial, each time that it changes. From another thread.
  virtual void idle(const IdleState& /*seen*/) {}

  /// The robot's driver does not return, and the trial was given up: nothing follows until it does. From another
  /// thread.
  virtual void given_up(const TrialOutcome& /*outcome*/) {}

  /// Remarks for the recording: asked when the robot is at rest, before the file is written. From another thread if the
  /// trial was given up.
  [[nodiscard]] virtual std::vector<std::string> notes() { return {}; }

  /// The trial is over. It is recorded, and will be measured next, unless the outcome says why not.
  virtual void recorded(const TrialOutcome& /*outcome*/) {}

  /// Called when the trial is complete.   @fails  with any error; no further trial follows
  [[nodiscard]] virtual Result<void> judged(const Performed& /*performed*/) { return {}; }

  /// What comes next. After a stop a trial follows only where the gate was reset (Session::reset).
  [[nodiscard]] virtual Next next(Session& /*session*/, const Performed& performed) {
    return performed.stopped() ? Next::end : Next::go_on;
  }
};

/// How an experiment ended.
struct Conclusion {
  bool completed = false;        ///< after its last trial
  std::optional<Error> failure;  ///< why it could not go on
  safety::Trip trip;             ///< of the trial that was the last because of it; Reason::none: there was none
  safety::MotorsOff motors;      ///< of that trial
};

/// Performs the trials of an experiment in their order, each behind the gate into a file of its own, and measures what
/// was recorded. Between two trials the robot is told "motors off" (IdleWatch). None follows one whose ticks were lost,
/// nor a request to end (LoopFlags::end_session).
/// @param measure  after each trial that was not stopped; empty: trials are only recorded
/// @returns  with a failure as make_device, Session::perform and Operator::judged; data: ticks were lost
[[nodiscard]] Conclusion conduct(const Experiment& experiment, Session& session, Operator& conductor,
                                 const Measure& measure = measure_recording);

}  // namespace mbk::session
