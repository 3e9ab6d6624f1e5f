#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/realtime/thread_setup.h"
#include "mbk/experiment/device/device.h"
#include "mbk/experiment/session/idle_watch.h"
#include "mbk/experiment/session/loop.h"
#include "mbk/experiment/session/loop_watch.h"
#include "mbk/experiment/session/plan.h"
#include "mbk/experiment/session/recorder.h"

namespace mbk::session {

/// How time passes.
struct Pace {
  bool virtual_clock = false;        ///< ticks come as fast as the machine can, or `speed` times as fast as real ones
  double speed = 0.0;                ///< of a virtual clock; 0: as fast as it can
  realtime::Clock* clock = nullptr;  ///< where given, this one instead, of the experiment's sample time
};

/// A trial that is over.
struct TrialOutcome {
  std::filesystem::path recording;    ///< the target, or elsewhere if the target's folder was removed
  std::optional<Recording> recorded;  ///< what the file holds, as it reads back
  std::optional<Error> unrecorded;    ///< why the recording could not be made: the journal then still is
  std::filesystem::path journal;      ///< removed once the recording is there and holds every tick
  bool incomplete = false;            ///< not every tick that the loop made came back from the recording
  journal::Damage damage;             ///< of the journal; where there is any, it is kept
  journal::Ending ending;
  std::vector<std::string> notes;  ///< Callbacks::notes, as they stand in the recording
  std::string ended;               ///< the same with what was lost: "completed, but 50 of 67101 ticks were lost"
  safety::Trip trip;               ///< Reason::none where nothing tripped
  safety::MotorsOff motors;        ///< whether the robot has confirmed that they are off
  LoopTimes times;
  realtime::ThreadSetup setup;
};

/// What a trial tells and asks besides its ticks. Each may be empty.
struct Callbacks {
  /// The loop does not come back from the robot: `missing` while no tick comes, `waiting` when ticks come again. By
  /// another thread.
  std::function<void(const safety::MotorsOff&)> motors;
  /// For the same reason the trial is given up: its journal is closed and the recording made. `perform` returns only if
  /// the robot's driver does. By another thread.
  std::function<void(const TrialOutcome&)> given_up;
  /// Remarks for the recording: asked once, before it is written. By another thread if the trial was given up.
  std::function<std::vector<std::string>()> notes;
};

/// Runs trials one after the other. A trip outlives its trial: none begins before `reset`.
class Session {
 public:
  explicit Session(const Pace& pace = {}) : pace_(pace) {}

  /// Everything that can be known to fail is asked before the robot moves, and an error means that it did not move:
  /// from then on there is an outcome, whatever becomes of the recording.
  /// @param target  of the recording (.h5); the journal stands beside it as NAME.h5.journal
  /// @param watch  see Recorder; may be empty
  /// @fails  usage: the person has withdrawn; the target or its journal is there; the gate is tripped; the robot's stop
  ///         button is pressed; the robot keeps its own time and the clock is virtual. data: the robot does
  ///         not answer; the folder, space or disk.
  [[nodiscard]] Result<TrialOutcome> perform(device::Device& robot, const Plan& plan,
                                             const std::filesystem::path& target, const Watch& watch = {},
                                             const Callbacks& callbacks = {});

  /// For other threads, and for signal handlers: a stop, or an early end, of the trial that runs.
  [[nodiscard]] LoopFlags& flags() { return *flags_; }

  /// Of the last trial; null before the first.
  [[nodiscard]] const safety::Gate* gate() const { return gate_ ? &*gate_ : nullptr; }

  /// By the operator, after a trip.   @fails  as Gate::reset
  [[nodiscard]] Result<void> reset();

  /// What IdleWatch saw, so that a reset knows of the stop button and the motors. From any thread.
  void see_idle(const IdleState& state);

 private:
  void conclude(Recorder& recorder, const Callbacks& callbacks, TrialOutcome& outcome) const;
  [[nodiscard]] LoopWatch::Told watched_loop(device::Device& robot, Recorder& recorder, const Callbacks& callbacks,
                                             double sample_time, TrialOutcome& outcome) const;

  Pace pace_;
  std::unique_ptr<std::mutex> gate_mutex_ = std::make_unique<std::mutex>();  // between trials: reset and see_idle
  std::optional<safety::Gate> gate_;
  std::unique_ptr<LoopFlags> flags_ = std::make_unique<LoopFlags>();
};

/// Whether the recording of a trial can be written: its name says a format, it can be made beside its journal, and both
/// find room on the disk.
/// @fails  usage: no format; the file or its journal is there. data: the folder, the name or the space.
[[nodiscard]] Result<void> check_target(const Plan& plan, const std::filesystem::path& target);

/// What a trial's journal says before the first tick.
[[nodiscard]] journal::Header header_of(const Plan& plan, const device::Facts& facts);

/// Adds remarks to the metadata of a recording, as `notes` in one line with " | " between them.
/// @fails  data: the recording cannot be read or written.
[[nodiscard]] Result<void> annotate(const std::filesystem::path& recording, const std::vector<std::string>& notes);

/// Sets metadata of a recording, in one line each; an empty text takes what is there away.
/// @fails  data: the recording cannot be read or written.
[[nodiscard]] Result<void> set_metadata(const std::filesystem::path& recording,
                                        const std::map<std::string, std::string>& metadata);

/// The journal beside a recording: NAME.h5 → NAME.h5.journal.
[[nodiscard]] std::filesystem::path journal_of(const std::filesystem::path& recording);

/// How a journal becomes a recording.
struct RecoverOptions {
  bool overwrite = false;                 ///< a recording that is there
  bool keep = false;                      ///< the journal, in any case
  std::optional<Readers> readers;         ///< instead of the journal's
  std::optional<journal::Ending> ending;  ///< where it is known from elsewhere, instead of the journal's
  std::vector<std::string> notes;         ///< as `annotate` has them
};

/// What a journal gave.
struct Recovered {
  Recording recording;
  Recording read_back;  ///< the same, as the file holds it
  journal::Damage damage;
  std::uint64_t ticks = 0;  ///< that the recording holds
  bool incomplete = false;  ///< ticks were lost, or may have been
  bool removed = false;     ///< the journal
};

/// Makes the recording that a journal holds, reads it back, and removes the journal where it was exactly as it was
/// written and the recording holds it to the bit. A target that is there and holds the same is left as it is.
/// @fails  usage: the journal is being recorded; another target is there and `overwrite` is false. data: as
///         journal::read; the recording cannot be written, or does not read back as it was written, and is then
///         removed.
[[nodiscard]] Result<Recovered> recover(const std::filesystem::path& journal, const std::filesystem::path& target,
                                        const RecoverOptions& options = {});

}  // namespace mbk::session
