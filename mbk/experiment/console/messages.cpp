#include "mbk/experiment/console/messages.h"

#include <cmath>

#include "mbk/experiment/control/sequencer.h"
#include "mbk/experiment/safety/trip.h"
#include "mbk/present/result/result_document.h"

namespace mbk {

using document::Fields;
using document::Json;
using document::Number;
using document::through;

namespace console {
namespace {

constexpr std::size_t kLongestText = 600;  // of each sentence [bytes]

/// At most so much of it, cut between two characters of UTF-8.
std::string beginning(std::string text) {
  if (text.size() <= kLongestText) return text;
  std::size_t end = kLongestText;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  text.resize(end);
  return text + " …";
}

template <class Get>
auto beginning_of(Get get) {
  return [get](const auto& from) { return beginning(std::invoke(get, from)); };
}

/// Where a trip has a value, its sentence is whole only with the outcome.
std::string sentence_of(const safety::Trip& trip) {
  if (trip.reason == safety::Reason::none) return "";
  const bool whole = safety::unit(trip.reason).empty() || trip.limit != 0.0 || trip.value != 0.0;
  return whole ? safety::sentence(trip) : std::string(word_of(trip.reason));
}

/// From, to [µs] and count of each that is not empty.
Json bins(const realtime::CycleRecord& record) {
  Json all = Json::array();
  for (int bin = 0; bin < std::ssize(record.bins()); ++bin) {
    const std::uint64_t count = record.bins()[static_cast<std::size_t>(bin)];
    if (count > 0) all.push_back({1e-3 * record.edge(bin), 1e-3 * record.edge(bin + 1), count});
  }
  return all;
}

}  // namespace
}  // namespace console

namespace realtime {

void describe(Fields<CycleRecord>& fields) {
  using From = const CycleRecord&;
  fields.type("Times");
  fields.add_number(
      "median_us", [](From record) { return 1e-3 * record.quantile(0.5); }, "[µs]");
  fields.add_number(
      "p999_us", [](From record) { return 1e-3 * record.quantile(0.999); }, "99.9 % are within [µs]");
  fields.add_number(
      "worst_us", [](From record) { return 1e-3 * static_cast<double>(record.worst()); }, "[µs]");
  fields.add_form<std::vector<std::array<Number, 3>>>("bins", &console::bins, "from, to [µs], count");
}

}  // namespace realtime

namespace preprocess {

void describe(Fields<ExcludedWindow>& fields) {
  fields.type("ExcludedWindow", "A part of a trial that is not to be used.");
  fields.add_number("from_s", &ExcludedWindow::from_s, "on the trial's clock [s]");
  fields.add_number("to_s", &ExcludedWindow::to_s, "[s]");
  fields.add("why", console::beginning_of(&ExcludedWindow::why));
}

}  // namespace preprocess

namespace console {

void describe(Fields<ListedTrial>& fields) {
  fields.type("ListedTrial");
  fields.add("name", &ListedTrial::name);
  fields.add("condition", &ListedTrial::condition);
  fields.add_number("duration_s", &ListedTrial::duration, "of the perturbation [s]");
  fields.add(
      "home_m",
      [](const ListedTrial& trial) {
        return std::array{Number{trial.home[0]}, Number{trial.home[1]}};
      },
      "[m]");
  fields.add_choice("reference_unit", &ListedTrial::force, "N", "m");
  fields.add_as("task", {{"enum", {"relax", "hold", "reach"}}}, &ListedTrial::task,
                "of the participant: the key of its text");
  fields.add("progress", &ListedTrial::progress);
  fields.add("recording", &ListedTrial::recording, "file; empty: none yet");
  fields.add("ending", beginning_of(&ListedTrial::ending), "how it ended");
  fields.add("report", &ListedTrial::report, "its number in /report/; 0: none");
  fields.add("report_missing", beginning_of(&ListedTrial::report_missing), "why there is none");
}

void describe(Fields<RobotStatus>& fields) {
  fields.type("RobotState", "What is known of the robot itself, between trials too.");
  fields.add("motors", &RobotStatus::motors);
  fields.add_or_null("confirmed_off", &RobotStatus::confirmed_off, "after a stop; null: nothing to confirm");
  fields.add("stop_button", &RobotStatus::stop_button);
  fields.add("link", &RobotStatus::link);
  fields.add("fault", &RobotStatus::fault, "its code");
  fields.add("sentence", beginning_of(&RobotStatus::sentence));
}

void describe(Fields<Console::Times>& fields) {
  fields.add("compute", &Console::Times::compute);
  fields.add("lateness", &Console::Times::lateness);
}

void describe(Fields<Server::Status>& fields) {
  fields.add("viewers", &Server::Status::viewers);
  fields.add("dropped_frames", &Server::Status::dropped_frames);
  fields.add("refused", &Server::Status::refused);
}

void describe(Fields<Console>& fields) {
  using From = const Console&;
  fields.type("State");
  fields.constant("type", "state");
  fields.add("protocol", &Console::protocol_);
  fields.add("software", [](From) { return document::software(); });
  fields.add("trials", &Console::trials_);
  fields.add("current", &Console::current_, "place in `trials`");
  fields.add("running", &Console::running_);
  fields.add("phase", [](From one) { return word_of(static_cast<control::Phase>(one.last_.phase)); });
  fields.add("perturbing", [](From one) { return one.running_ && one.last_.perturbing(); });
  fields.add_number("time_s", through(&Console::last_, &journal::Tick::time), "on the trial's clock [s]");
  fields.add_number("perturbation_s", through(&Console::last_, &journal::Tick::perturbation_time), "[s]");
  fields.add_number("duration_s", &Console::expected_duration_, "[s]");
  fields.add("ticks", &Console::ticks_);
  fields.add("over", &Console::over_, "the session is");
  fields.add("question", &Console::question_);
  fields.add("reset_code", &Console::reset_code_, "to confirm a reset with; empty: ask first");
  fields.add("said", beginning_of(&Console::said_));
  fields.group("safety", [](Fields<Console>& safety) {
    using safety::Reason;
    safety.add("tripped", [](From one) { return one.trip_.reason != Reason::none || one.held(); });
    safety.add("reason", [](From one) { return word_of(one.held() ? Reason::operator_stop : one.trip_.reason); });
    safety.add("sentence", [](From one) {
      return one.held() ? "stopped while nothing ran: nothing begins before a reset" : sentence_of(one.trip_);
    });
    safety.add(
        "cut", [](From one) { return one.last_.cut != 0; }, "the motors are");
    safety.add(
        "enabled", [](From one) { return one.last_.enabled != 0; }, "the motors are");
  });
  fields.add("robot", &Console::robot_);
  fields.add("times", &Console::times_);
  fields.add("dropped_ticks", &Console::dropped_ticks_);
  fields.add("skipped_samples", &Console::skipped_samples_);
  fields.add("disk_free_bytes", &Console::disk_free_);
  fields.add(
      "notes", [](From one) { return std::vector(one.shown_notes_.begin(), one.shown_notes_.end()); }, "the last ones");
  fields.add("note_count", &Console::note_count_, "of all");
  fields.with([](From one) { return one.server_ ? one.status() : Server::Status{}; });
  fields.add(
      "participant", [](From one) { return one.server_ ? one.participant_address() : ""; }, "address");
  fields.add(
      "viewing", [](From one) { return one.server_ ? one.viewing_address() : ""; }, "address");
}

void describe(Fields<PerformedTrial>& fields) {
  const auto judgement = &PerformedTrial::judgement;
  fields.type("PerformedTrial");
  fields.add("number", &PerformedTrial::number, "in the session");
  fields.add("trial", &PerformedTrial::trial, "place in the `trials` of a state");
  fields.add("name", &PerformedTrial::name);
  fields.add("recording", &PerformedTrial::recording, "file");
  fields.add_number("duration_s", &PerformedTrial::duration, "[s]; 0: it runs");
  fields.add("grade", through(judgement, &Judgement::grade),
             "empty: it runs, or is not judged yet; recorded: it is not measured");
  fields.add("why", beginning_of(through(judgement, &Judgement::why)), "it is not good");
  fields.add_form<std::vector<Number>>("vaf", through(judgement, &Judgement::vaf),
                                       "variance accounted for on each axis [%]; empty: not measured");
  fields.add("excluded", beginning_of(&PerformedTrial::excluded), "why; empty: it is not");
  fields.add("windows", &PerformedTrial::windows);
}

void describe(Fields<PerformedTrials>& fields) {
  fields.type("PerformedTrials",
              "The trials that were begun, each repetition too: of a long session the last ones. Where something "
              "changes.");
  fields.constant("type", "session");
  fields.add("attempts", &PerformedTrials::attempts);
}

void describe(Fields<Texts>& fields) {
  fields.type("ConsoleTexts", "What the participant's page says.");
  fields.constant("type", "texts");
  fields.add("language", &Texts::language, "as BCP 47 names it");
  fields.add("sentences", &Texts::sentences);
  fields.add("trials", &Texts::trials, "in place of `sentences`, in the trial of that name");
}

void describe(Fields<NewestEstimate>& fields) {
  const auto estimate = [](auto get) {
    return [get](const NewestEstimate& one) {
      using Given = std::remove_cvref_t<decltype(get(*one.estimate))>;
      return one.estimate != nullptr ? get(*one.estimate) : Given();
    };
  };
  using From = const LiveEstimate::Estimate&;
  const auto to_milliseconds = [](double time) { return std::round(1e3 * time) / 1e3; };
  fields.type("LiveEstimate", "An estimate while a trial runs; nothing but its type where a trial begins.");
  fields.constant("type", "estimate");
  fields.add("final", estimate([](From one) { return std::optional(one.final); }), "of the whole perturbation");
  fields.add_number("from_s", estimate([=](From one) { return std::optional(to_milliseconds(one.from)); }),
                    "of the perturbation, from which on it counts: above 0 where the limb changed [s]");
  fields.add_number("perturbed_s", estimate([=](From one) { return std::optional(to_milliseconds(one.perturbed)); }),
                    "[s]");
  fields.add("result", estimate([](From one) { return one.measured ? &*one.measured : nullptr; }));
  fields.add("why", estimate([](From one) {
               return one.measured ? std::nullopt : std::optional(one.measured.error().line());
             }),
             "there is none yet");
}

void describe(Fields<You>& fields) {
  fields.type("You", "What this page may do. Every page may stop.");
  fields.constant("type", "you");
  fields.add_as("control", {{"enum", {"here", "elsewhere", "kept", "nobody"}}}, &You::control,
                "which page controls: this one, another one, one that has gone a moment ago, none");
  fields.add("may_control", &You::may_control, "it has the operator's token");
  fields.add("dropped_frames", &You::dropped_frames);
}

void describe(Fields<Refused>& fields) {
  fields.type("Refused");
  fields.constant("type", "refused");
  fields.add("why", &Refused::why);
}

void add_schemas(document::Schemas& schemas) {
  schemas["console"] = document::schema_of_one<Console, PerformedTrials, Texts, NewestEstimate, You, Refused>(
      "ConsoleMessage",
      "What the console of `mbk run` sends to its pages as text, over a WebSocket. Samples come as bytes: "
      "mbk/experiment/console/frame.h.");
  schemas["console_command"] = document::schema_of<Command>();
}

}  // namespace console
}  // namespace mbk
