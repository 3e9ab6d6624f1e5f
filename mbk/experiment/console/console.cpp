#include "mbk/experiment/console/console.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <thread>
#include <utility>

#include "mbk/base/realtime/rest.h"
#include "mbk/experiment/console/frame.h"
#include "mbk/experiment/console/messages.h"
#include "mbk/experiment/console/page.h"
#include "mbk/experiment/safety/trip.h"

namespace mbk::console {
namespace {

using journal::Tick;

constexpr std::size_t kMaxPending = 8192;  // samples of a frame, at most
constexpr std::uint64_t kStateBeats = 12;  // a state at least so often
constexpr std::uint64_t kDiskBeats = 120;
constexpr std::size_t kMaxReports = 30;  // that can still be opened: of a session of months the last ones
constexpr std::size_t kShownNotes = 20;  // in a state, and their bytes
constexpr std::size_t kShownNoteBytes = 8 << 10;
constexpr std::size_t kMaxWindows = 20;  // that are excluded of a trial

bool answers(Question question, Action action) {
  switch (question) {
    case Question::none:
      return false;
    case Question::begin:
      return action == Action::start || action == Action::abort;
    case Question::after:
      return action == Action::repeat || action == Action::next || action == Action::abort;
    case Question::reset:
      return action == Action::reset || action == Action::abort;
  }
  return false;
}

std::string axis_name(Eigen::Index axis) {
  return axis == 0 ? "x" : "y";
}

/// Why session::poor is true of it.
std::string weakness(const Identification& found) {
  std::string why;
  for (Eigen::Index axis = 0; axis < found.fit.vaf.size(); ++axis) {
    if (found.fit.vaf[axis] >= session::kPoor) continue;
    why += fmt::format("{}{:.0f} % of the force in {}", why.empty() ? "the model explains " : " and ",
                       found.fit.vaf[axis], axis_name(axis));
  }
  if (found.usable) return why;
  why += why.empty() ? "the result is not usable" : "; it is not usable";
  for (const Warning& warning : found.warnings) {
    why += (&warning == &found.warnings.front() ? ": " : "; ") + warning.message;
  }
  return why;
}

}  // namespace

Judgement Judgement::of(const session::Performed& performed) {
  using safety::Reason;
  if (performed.stopped()) {
    const Reason reason = performed.outcome.trip.reason;
    const bool person = reason == Reason::operator_stop || reason == Reason::stop_button;
    return {person ? Grade::stopped : Grade::tripped, safety::sentence(performed.outcome.trip), {}};
  }
  if (!performed.measured) return {Grade::recorded, "it was not measured", {}};
  if (!*performed.measured) return {Grade::poor, "not measured: " + performed.measured->error().line(), {}};
  const Identification& found = (*performed.measured)->identification;
  Judgement judgement{performed.poor() ? Grade::poor : Grade::good, performed.poor() ? weakness(found) : "", {}};
  for (const double share : found.fit.vaf) {
    if (std::isfinite(share)) judgement.vaf.push_back(share);
  }
  return judgement;
}

Console::Console(const std::vector<session::Plan>& plans, session::LoopFlags& flags)
    : flags_(flags), protocol_(plans.empty() ? "" : plans.front().trial.protocol) {
  for (const session::Plan& plan : plans) {
    const protocol::Trial& trial = plan.trial;
    ListedTrial listed;
    listed.name = trial.name.empty() ? trial.protocol : trial.name;
    listed.condition = trial.condition;
    listed.home = trial.home;
    listed.force = !std::holds_alternative<control::PositionMode>(trial.control);
    listed.task = plan.schedule.reaches() != nullptr ? "reach" : listed.force ? "hold" : "relax";
    listed.duration = plan.schedule.duration();
    trials_.push_back(std::move(listed));
  }
  if (const auto html = operator_page()) operator_page_ = make_page(std::string(*html));
  for (auto* ticks : {&pending_, &sending_}) ticks->reserve(kMaxPending);
  live_ = std::make_unique<LiveEstimate>([this](const LiveEstimate::Estimate& one) { estimated(one); });
}

Console::~Console() {
  if (server_) server_->stop();
}

Result<std::unique_ptr<Console>> Console::open(std::uint16_t port, const std::vector<session::Plan>& plans,
                                               session::LoopFlags& flags, std::function<void(const std::string&)> log,
                                               ServerTimes times) {
  std::unique_ptr<Console> console(new Console(plans, flags));
  Console& self = *console;
  auto server = MBK_TRY(Server::listen(
      port,
      {[&self](std::string_view path) { return self.page(path); },
       [&self](const Command& command) { return self.command(command); }, [&self] { self.beat(); }, std::move(log)},
      times));
  const std::scoped_lock lock(self.mutex_);
  self.server_ = std::move(server);
  return console;
}

std::string Console::address() const {
  return fmt::format("http://127.0.0.1:{}/?token={}", server_->port(), server_->token());
}

std::string Console::viewing_address() const {
  return fmt::format("http://127.0.0.1:{}/?token={}", server_->port(), server_->viewing_token());
}

std::string Console::participant_address() const {
  return fmt::format("http://127.0.0.1:{}/participant?token={}", server_->port(), server_->viewing_token());
}

void Console::begin(std::size_t index, const journal::Header& header, const std::filesystem::path& target,
                    double duration) {
  live_->begin(header, {});
  const std::scoped_lock lock(mutex_);
  current_ = index;
  geometry_ = header.geometry;
  expected_duration_ = duration;
  target_ = target;
  pending_.clear();
  last_ = {};
  robot_ = {};  // what it said before the trial holds no longer
  ticks_ = dropped_ticks_ = skipped_samples_ = next_number_ = 0;
  times_ = {};
  times_apart_ = {};
  trip_ = {};
  recording_notes_ = notes_.size();
  recording_note_bytes_ = 0;
  for (const std::string& note : notes_) recording_note_bytes_ += note.size();
  estimate_ = message(NewestEstimate{});
  ListedTrial& listed = trials_[index];
  listed.progress = Progress::running;
  listed.recording = target.string();
  listed.ending.clear();
  listed.report = 0;
  const int number = attempts_.empty() ? 1 : attempts_.back().number + 1;
  attempts_.push_back({.number = number, .trial = index, .name = listed.name, .recording = target.string()});
  if (attempts_.size() > kMaxAttempts) attempts_.pop_front();
  running_ = changed_ = session_changed_ = true;
  said_.clear();
}

void Console::watch(std::span<const Tick> ticks) noexcept {
  try {
    watch_throwing(ticks);
  } catch (...) {  // no memory: the pages miss these, the recording does not
    const std::scoped_lock lock(mutex_);
    skipped_samples_ += ticks.size();
  }
}

void Console::watch_throwing(std::span<const Tick> ticks) {
  bool tripped = false;
  {
    const std::scoped_lock lock(mutex_);
    Times& apart = times_apart_[server_->status().viewers > 0 ? 1 : 0];
    for (const Tick& tick : ticks) {
      dropped_ticks_ += tick.number - next_number_;
      next_number_ = tick.number + 1;
      for (Times* times : {&times_, &apart}) {
        if (tick.number > 0) times->compute.add(static_cast<std::int64_t>(1e9 * static_cast<double>(tick.compute)));
        times->lateness.add(static_cast<std::int64_t>(1e9 * tick.late));
      }
      const auto reason = static_cast<safety::Reason>(tick.reason);
      if (reason != trip_.reason) {
        trip_ = {reason, tick.time, tick.number, 0.0, 0.0};
        tripped = true;
      }
      changed_ = changed_ || tick.phase != last_.phase || tick.reason != last_.reason || tick.enabled != last_.enabled;
      last_ = tick;
      ++ticks_;
    }
    const std::size_t room = kMaxPending - std::min(kMaxPending, pending_.size());
    const auto taken = ticks.first(std::min(ticks.size(), room));
    pending_.insert(pending_.end(), taken.begin(), taken.end());
    skipped_samples_ += ticks.size() - taken.size();
  }
  if (tripped) server_->beat();
  live_->add(ticks);
}

void Console::finish(const session::TrialOutcome& outcome) {
  live_->finish();
  const std::scoped_lock lock(mutex_);
  ListedTrial& listed = trials_[current_];
  trip_ = outcome.trip;
  listed.progress = trip_.reason == safety::Reason::none ? Progress::done : Progress::stopped;
  listed.recording = outcome.recording.string();
  listed.ending = outcome.ended;
  if (!attempts_.empty()) {
    attempts_.back().recording = listed.recording;
    attempts_.back().duration = last_.time;
    attempts_.back().over = true;
    session_changed_ = true;
  }
  dropped_ticks_ = outcome.ending.dropped;
  running_ = false;
  changed_ = true;
}

void Console::judge(Judgement judgement) {
  const std::scoped_lock lock(mutex_);
  if (!attempts_.empty()) attempts_.back().judgement = std::move(judgement);
  session_changed_ = true;
}

void Console::show_texts(const Texts& texts) {
  const std::scoped_lock lock(mutex_);
  texts_ = message(texts);
}

Console::Times Console::times(bool watched) {
  const std::scoped_lock lock(mutex_);
  return times_apart_[watched ? 1 : 0];
}

void Console::show_report(std::string html, std::string why) {
  Page page = html.empty() ? Page{} : make_page(std::move(html));
  const std::scoped_lock lock(mutex_);
  if (page.html) {
    reports_[++last_report_] = std::move(page);
    trials_[current_].report = last_report_;
  }
  trials_[current_].report_missing = std::move(why);
  while (reports_.size() > kMaxReports) {
    const int oldest = reports_.begin()->first;
    reports_.erase(reports_.begin());
    const auto of = std::ranges::find(trials_, oldest, &ListedTrial::report);
    if (of == trials_.end()) continue;  // the trial was repeated
    of->report = 0;
    of->report_missing = "no longer kept here; 'mbk measure --report' makes it again";
  }
  changed_ = true;
}

Action Console::ask(Question question) {
  std::unique_lock lock(mutex_);
  question_ = flags_.operator_stop ? Question::reset : question;
  decision_.reset();
  reset_code_.clear();
  changed_ = true;
  lock.unlock();
  constexpr auto kLook = std::chrono::milliseconds(100);
  const auto is_decided = [&] {
    const std::scoped_lock looking(mutex_);
    return decision_.has_value();
  };
  while (!realtime::rest(kLook, is_decided)) {
    const std::scoped_lock ending(mutex_);
    if (flags_.end_session) decision_ = Action::abort;
  }
  lock.lock();
  question_ = Question::none;
  reset_code_.clear();
  changed_ = true;
  if (*decision_ == Action::reset) trip_ = {};
  return *decision_;
}

void Console::say(std::string message) {
  const std::scoped_lock lock(mutex_);
  said_ = std::move(message);
  changed_ = true;
}

void Console::show_robot(const RobotStatus& robot) {
  {
    const std::scoped_lock lock(mutex_);
    if (robot == robot_) return;
    robot_ = robot;
    changed_ = true;
  }
  server_->beat();
}

void Console::wait_until_left() {
  {
    const std::scoped_lock lock(mutex_);
    over_ = changed_ = true;
  }
  constexpr auto kLook = std::chrono::milliseconds(200);
  constexpr int kGrace = 15;  // a page that is loaded again is away for a moment
  for (int away = 0; away < kGrace && !flags_.end_session; away = status().viewers > 0 ? 0 : away + 1) {
    std::this_thread::sleep_for(kLook);
  }
}

std::vector<std::string> Console::take_notes() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(notes_, {});
}

std::vector<Exclusion> Console::take_exclusions() {
  const std::scoped_lock lock(mutex_);
  std::vector<Exclusion> taken;
  for (PerformedTrial& attempt : attempts_) {
    if (!std::exchange(attempt.changed, false)) continue;
    taken.push_back({attempt.recording, attempt.excluded, preprocess::excluded_windows_text(attempt.windows)});
  }
  return taken;
}

Page Console::page(std::string_view path) {
  if (path == "/" || path == "/participant") return operator_page_;
  constexpr std::string_view kReport = "/report/";
  if (!path.starts_with(kReport)) return {};
  path.remove_prefix(kReport.size());
  int number = 0;
  const auto [end, error] = std::from_chars(path.data(), path.data() + path.size(), number);
  if (error != std::errc() || end != path.data() + path.size()) return {};
  const std::scoped_lock lock(mutex_);
  const auto found = reports_.find(number);
  return found == reports_.end() ? Page{} : found->second;
}

Result<void> Console::command(const Command& command) {
  if (command.action == Action::stop) flags_.operator_stop = true;
  const std::scoped_lock lock(mutex_);
  changed_ = true;
  switch (command.action) {
    case Action::stop:
      // while nothing runs a stop holds what would come next, until it is reset
      if (question_ != Question::none) question_ = Question::reset;
      return {};
    case Action::end:
      if (!running_) return bad_usage("no trial is running");
      flags_.end_trial = true;
      return {};
    case Action::note:
      return note(command.text);
    case Action::exclude:
    case Action::include:
      return exclude(command);
    default:
      break;
  }
  if (!answers(question_, command.action)) {
    return bad_usage(fmt::format("'{}' is not what is asked for now", word_of(command.action)));
  }
  return command.action == Action::reset ? reset(command.text) : (decide(command.action), Result<void>{});
}

Result<void> Console::reset(const std::string& code) {
  if (code.empty()) {
    reset_code_ = fmt::format("{}-{}", current_, ticks_);
    return {};
  }
  if (reset_code_.empty() || code != reset_code_) return bad_usage("a reset takes two steps: ask, then confirm");
  decide(Action::reset);
  return {};
}

Result<void> Console::note(const std::string& text) {
  if (recording_notes_ == kMaxNotes || recording_note_bytes_ + text.size() > kMaxNoteBytes) {
    return bad_usage(fmt::format("the recording takes no further note: it has {} of {}, {} of {} bytes",
                                 recording_notes_, kMaxNotes, recording_note_bytes_, kMaxNoteBytes),
                     "write it down elsewhere");
  }
  ++recording_notes_;
  recording_note_bytes_ += text.size();
  notes_.push_back(text);
  ++note_count_;
  shown_notes_.push_back(text);
  shown_note_bytes_ += text.size();
  while (shown_notes_.size() > kShownNotes || shown_note_bytes_ > kShownNoteBytes) {
    shown_note_bytes_ -= shown_notes_.front().size();
    shown_notes_.pop_front();
  }
  wake();
  return {};
}

Result<void> Console::exclude(const Command& command) {
  const int place = attempts_.empty() ? -1 : command.attempt - attempts_.front().number;
  if (place < 0 || place >= std::ssize(attempts_)) {
    return bad_usage(fmt::format("there is no trial number {} on this page", command.attempt));
  }
  PerformedTrial& attempt = attempts_[static_cast<std::size_t>(place)];
  if (!attempt.over) return bad_usage("the trial still runs", "exclude it when it is over");
  if (command.action == Action::include) {
    attempt.excluded.clear();
    attempt.windows.clear();
  } else if (!command.window) {
    attempt.excluded = command.text;
  } else if (command.window->to > attempt.duration) {
    return bad_usage(fmt::format("the window ends at {:g} s, behind the end of the trial at {:.3f} s",
                                 command.window->to, attempt.duration));
  } else if (attempt.windows.size() == kMaxWindows) {
    return bad_usage(fmt::format("{} windows of this trial are excluded already", kMaxWindows), "exclude the trial");
  } else {
    attempt.windows.push_back({command.window->from, command.window->to, command.text});
  }
  attempt.changed = session_changed_ = true;
  wake();
  return {};
}

/// Whoever asks looks at notes and exclusions; never instead of an answer.
void Console::wake() {
  if (question_ != Question::none && !decision_) decide(Action::note);
}

void Console::decide(Action action) {
  decision_ = action;
}

void Console::estimated(const LiveEstimate::Estimate& estimate) {
  Message made = message(NewestEstimate{&estimate});
  const std::scoped_lock lock(mutex_);
  estimate_ = std::move(made);
}

std::string Console::state() {
  const std::scoped_lock lock(mutex_);
  return *message(*this);
}

/// A stop while nothing runs.
bool Console::held() const {
  return flags_.operator_stop && trip_.reason == safety::Reason::none && !running_;
}

void Console::beat() {
  sending_.clear();
  Message state, estimate, session, texts;
  std::uint32_t trial = 0;
  robot::Geometry geometry;
  {
    const std::scoped_lock lock(mutex_);
    if (!server_) return;
    sending_.swap(pending_);
    trial = static_cast<std::uint32_t>(current_);
    geometry = geometry_;
    estimate = std::exchange(estimate_, nullptr);
    texts = std::exchange(texts_, nullptr);
    if (std::exchange(session_changed_, false)) {
      PerformedTrials performed;
      for (const PerformedTrial& attempt : attempts_) performed.attempts.push_back(&attempt);
      session = message(performed);
    }
    if (beats_ % kDiskBeats == 0) {
      std::error_code error;
      const auto folder = target_.parent_path();
      const auto space = std::filesystem::space(folder.empty() ? std::filesystem::path(".") : folder, error);
      if (!error) disk_free_ = space.available;
    }
    if (changed_ || beats_ % kStateBeats == 0) state = message(*this);
    changed_ = false;
    ++beats_;
  }
  if (texts) server_->send(Topic::texts, texts);
  if (state) server_->send(Topic::state, state);
  if (session) server_->send(Topic::session, session);
  if (estimate) server_->send(Topic::estimate, estimate);
  if (!sending_.empty()) server_->send_frame(std::make_shared<std::string>(frame(sending_, geometry, trial)));
}

}  // namespace mbk::console
