#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/core/words.h"
#include "mbk/base/realtime/cycle_record.h"
#include "mbk/experiment/console/live_estimate.h"
#include "mbk/experiment/console/server.h"
#include "mbk/experiment/console/texts.h"
#include "mbk/experiment/device/device.h"
#include "mbk/experiment/session/conduct.h"
#include "mbk/experiment/session/plan.h"
#include "mbk/experiment/session/session.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/measure/preprocess/exclusions.h"

namespace mbk::document {
template <class T>
class Fields;
}

namespace mbk::console {

/// What the run waits for.
enum class Question {
  none,
  begin,  ///< the first trial
  after,  ///< a trial is over: once more, on, or no further
  reset,  ///< after a stop
};

[[nodiscard]] constexpr auto word_table(Question) {
  using enum Question;
  return std::to_array<Word<Question>>({{none, ""}, {begin, "begin"}, {after, "after"}, {reset, "reset"}});
}

/// What a trial is worth that was performed.
enum class Grade {
  none,      ///< it runs, or is not judged yet
  recorded,  ///< and nothing else: it is not measured
  good,
  poor,     ///< could not be measured, or the model is not usable or explains little
  stopped,  ///< by the operator or the robot's stop button
  tripped,  ///< by any other limit of the gate
};

[[nodiscard]] constexpr auto word_table(Grade) {
  using enum Grade;
  return std::to_array<Word<Grade>>(
      {{none, ""}, {recorded, "recorded"}, {good, "good"}, {poor, "poor"}, {stopped, "stopped"}, {tripped, "tripped"}});
}

struct Judgement {
  Grade grade = Grade::none;
  std::string why;          ///< it is not good; a sentence without its full stop
  std::vector<double> vaf;  ///< variance accounted for on each axis [%]; empty: not measured

  [[nodiscard]] static Judgement of(const session::Performed& performed);
};

enum class Progress { waiting, running, done, stopped };

[[nodiscard]] constexpr auto word_table(Progress) {
  using enum Progress;
  return std::to_array<Word<Progress>>(
      {{waiting, "waiting"}, {running, "running"}, {done, "done"}, {stopped, "stopped"}});
}

/// A trial of the session.
struct ListedTrial {
  std::string name, condition;
  double duration = 0.0;  ///< of the perturbation [s]
  Eigen::Vector2d home;   ///< [m]
  bool force = false;     ///< the perturbation is a force
  std::string task;       ///< of the participant: the key of its text
  Progress progress = Progress::waiting;
  std::string recording, ending;
  int report = 0;  ///< its number, from 1; 0: none
  std::string report_missing;
};

/// A trial that was begun; each repetition is another one.
struct PerformedTrial {
  int number;         ///< in the session, from 1
  std::size_t trial;  ///< in the list
  std::string name, recording;
  bool over = false;
  double duration = 0.0;  ///< [s]
  Judgement judgement;
  std::string excluded;                             ///< why; empty: it is not
  std::vector<preprocess::ExcludedWindow> windows;  ///< that are excluded
  bool changed = false;                             ///< and nobody has taken that yet
};

/// What the operator has said of a recording: it is excluded, or windows of it, as metadata have it.
struct Exclusion {
  std::filesystem::path recording;
  std::string excluded;          ///< why; empty: it is not
  std::string excluded_windows;  ///< "1.5-4 s: coughed; 7-9 s: spoke"; empty: none
};

/// Attempts that pages can still see and exclude: of a session of months the last ones.
inline constexpr std::size_t kMaxAttempts = 200;

/// What is known of the robot itself, between trials too.
struct RobotStatus {
  using Motors = device::Motors;
  Motors motors = Motors::unknown;    ///< as the robot reports them
  std::optional<bool> confirmed_off;  ///< after a stop, whether the robot has confirmed it; absent: nothing to confirm
  bool stop_button = false;           ///< is pressed
  bool link = true;                   ///< states of the robot come
  std::uint32_t fault = 0;            ///< the robot's own code; 0: none
  std::string sentence;               ///< more about it, for the operator

  bool operator==(const RobotStatus&) const = default;
};

/// Notes of one recording, all together.
inline constexpr std::size_t kMaxNotes = 200, kMaxNoteBytes = 32 << 10;

/// The pages of a session: what happens is shown, and what is asked for there is done. Fed by the recorder, never by
/// the loop: the loop sees nothing of it but LoopFlags.
class Console {
 public:
  /// @param plans  of the trials, in their order    @param flags  of the session; outlives the console
  /// @param log  one line about what was refused; from the server's thread
  /// @fails  as Server::listen
  [[nodiscard]] static Result<std::unique_ptr<Console>> open(std::uint16_t port,
                                                             const std::vector<session::Plan>& plans,
                                                             session::LoopFlags& flags,
                                                             std::function<void(const std::string&)> log,
                                                             ServerTimes times = {});
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;
  ~Console();

  [[nodiscard]] std::string address() const;              ///< of the operator, with the token
  [[nodiscard]] std::string viewing_address() const;      ///< for those who only watch
  [[nodiscard]] std::string participant_address() const;  ///< for the second screen
  [[nodiscard]] Server::Status status() const { return server_->status(); }

  /// A trial is about to begin.   @param index  in the list
  void begin(std::size_t index, const journal::Header& header, const std::filesystem::path& target, double duration);

  /// What the viewer is to call (session::Watch).
  void watch(std::span<const journal::Tick> ticks) noexcept;

  /// The trial is over. Returns once the last estimate is there.
  void finish(const session::TrialOutcome& outcome);

  /// All is known of the trial that is over.
  void judge(Judgement judgement);

  /// What the participant's page says from now on.
  void show_texts(const Texts& texts);

  /// How long the ticks of the last trial took and how late they came, apart for those while pages were open and for
  /// the others.
  struct Times {
    realtime::CycleRecord compute, lateness;
  };
  [[nodiscard]] Times times(bool watched);

  /// Its report can be opened.   @param html  of report::page; empty: there is none, for a reason that `why` says
  void show_report(std::string html, std::string why = "");

  /// Asks the page, and waits until it decides: start, repeat, next, abort or reset; or a note or an exclusion came
  /// (Action::note for both), and the question is to be asked again. A stop while it waits asks for a reset before
  /// anything else. Where the program is asked to end (LoopFlags::end_session) the answer is abort.
  [[nodiscard]] Action ask(Question question);

  /// What the answer came to, where it could not be done.
  void say(std::string message);

  /// Shows it from now on. What is confirmed not to be off is shown as an alarm. From any thread.
  void show_robot(const RobotStatus& robot);

  /// The session is over: waits until nobody watches any more, or LoopFlags::end_session.
  void wait_until_left();

  /// Remarks that belong to the recording of the trial that is running or was last, and are not in it yet.
  [[nodiscard]] std::vector<std::string> take_notes();

  /// Each recording of which something was excluded or included since the last call, as it is now.
  [[nodiscard]] std::vector<Exclusion> take_exclusions();

  /// What pages get as the state, as JSON. For tests.
  [[nodiscard]] std::string state();

 private:
  /// As pages get it as the state.
  friend void describe(document::Fields<Console>& fields);

  Console(const std::vector<session::Plan>& plans, session::LoopFlags& flags);
  Page page(std::string_view path);
  Result<void> command(const Command& command);
  Result<void> reset(const std::string& code);
  Result<void> note(const std::string& text);
  Result<void> exclude(const Command& command);
  void wake();
  void decide(Action action);
  void beat();
  void estimated(const LiveEstimate::Estimate& estimate);
  void watch_throwing(std::span<const journal::Tick> ticks);
  [[nodiscard]] bool held() const;

  session::LoopFlags& flags_;
  std::string protocol_, reset_code_, said_;
  std::mutex mutex_;
  std::vector<ListedTrial> trials_;
  Page operator_page_;
  std::map<int, Page> reports_;  // the last ones, by number
  int last_report_ = 0;
  std::vector<std::string> notes_;  // not taken yet
  std::deque<std::string> shown_notes_;
  std::size_t shown_note_bytes_ = 0, recording_notes_ = 0, recording_note_bytes_ = 0;  // the last two: of one recording
  std::uint64_t note_count_ = 0;
  std::deque<PerformedTrial> attempts_;  // the last ones; their numbers have no gap
  RobotStatus robot_;
  std::size_t current_ = 0;
  bool running_ = false, changed_ = true, session_changed_ = true, over_ = false;
  Question question_ = Question::none;
  std::optional<Action> decision_;

  robot::Geometry geometry_;
  double expected_duration_ = 0.0;
  std::filesystem::path target_;
  std::vector<journal::Tick> pending_, sending_;
  journal::Tick last_;
  std::uint64_t ticks_ = 0, dropped_ticks_ = 0, skipped_samples_ = 0, next_number_ = 0;
  Times times_;
  std::array<Times, 2> times_apart_;  // without pages, with pages
  safety::Trip trip_;
  Message estimate_, texts_;
  std::uint64_t beats_ = 0;
  std::uintmax_t disk_free_ = 0;
  std::unique_ptr<LiveEstimate> live_;
  std::unique_ptr<Server> server_;  // the last to be made, and the first to go
};

}  // namespace mbk::console
