#include "mbk/study/longitudinal/study_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "mbk/study/longitudinal/report_schemas.h"
#include "mbk/study/statistics/summary_document.h"
#include "mbk/study/store/study_documents.h"

namespace mbk::longitudinal {

using document::Fields;

void describe(Fields<SessionMean>& fields) {
  fields.type("SessionMean");
  fields.add("session", &SessionMean::session);
  fields.add("results", &SessionMean::results);
  fields.add("mean", &SessionMean::mean, "of the results; for an orientation, the mean axis");
}

void describe(Fields<Change>& fields) {
  fields.type("SessionChange");
  fields.add("first_session", &Change::first_session);
  fields.add("last_session", &Change::last_session);
  fields.add("first", &Change::first);
  fields.add("last", &Change::last);
  fields.add("difference", &Change::difference);
  fields.add("mdc95", &Change::mdc, "minimal detectable change between means of this many results; null: unknown");
  fields.add("mdc95_interval", &Change::mdc95);
  fields.add("by_others", &Change::by_others,
             "mdc95 is from the variances of all other people, because the difference exceeds that from all");
  fields.add("heavy_tails", &Change::heavy_tails,
             "errors of these people have heavier tails than normal errors: mdc95_interval is not valid, and no "
             "difference is beyond-error");
  fields.add(
      "verdict", &Change::verdict,
      "beyond-error: more than the upper end of mdc95_interval, without heavy_tails; uncertain: more than mdc95; "
      "within-error: at most mdc95; unknown: mdc95 is unknown");
  fields.add_unless_empty("why_not_comparable", &Change::why_not_comparable,
                          "why stretches of these sessions are not comparable, as a clause; mdc95 and verdict are "
                          "then unknown");
}

void describe(Fields<Course>& fields) {
  fields.type("Course");
  fields.add("participant", &Course::participant);
  fields.add("mean", &Course::mean, "of the sessions' means");
  fields.add("interval95", &Course::interval95, "from the variances of all people; null: unknown");
  fields.add("sessions", &Course::sessions);
  fields.add("changes", &Course::changes, "each later session against the first");
  fields.add("latest", &Course::latest, "the last session against the one before, with three sessions or more");
}

void describe(Fields<OutcomeCourses>& fields) {
  fields.type("OutcomeCourses", "One outcome of each person over sessions.");
  fields.add("condition", &OutcomeCourses::condition);
  fields.add("outcome", &OutcomeCourses::outcome);
  fields.add("unit", &OutcomeCourses::unit);
  fields.add("axial", &OutcomeCourses::axial, "an orientation");
  fields.add("repeated_participants", &OutcomeCourses::repeated_participants, "who have two sessions or more");
  fields.add_unless_empty("why_unknown", &OutcomeCourses::why_unknown,
                          "why the minimal detectable change is unknown, as a clause");
  fields.add("mean", &OutcomeCourses::mean, "of the people's means; null in the report of one participant");
  fields.add("interval95", &OutcomeCourses::interval95);
  fields.add("participants", &OutcomeCourses::courses);
}

void describe(Fields<NormalRange>& fields) {
  fields.type("NormalRange", "Of the controls of the study.");
  fields.add("controls", &NormalRange::controls, "people whose numbers it is from");
  fields.add("mean", &NormalRange::mean, "null: fewer than five controls");
  fields.add("range95", &NormalRange::range95,
             "prediction interval of one further control, by Student's t; null: fewer than five controls");
  fields.add("not_comparable", &NormalRange::not_comparable,
             "controls who were stretched to another fastest speed (more than 10 %) or over other positions (less than "
             "80 % in common), on which the outcome depends; they do not count");
}

void describe(Fields<OutcomeRange>& fields) {
  fields.type("OutcomeRange", "One outcome of the participant's last session beside the controls in theirs.");
  fields.add("condition", &OutcomeRange::condition);
  fields.add("outcome", &OutcomeRange::outcome);
  fields.add("unit", &OutcomeRange::unit);
  fields.add("session", &OutcomeRange::session);
  fields.add("results", &OutcomeRange::results);
  fields.add("value", &OutcomeRange::value, "mean of the session's results");
  fields.add("normal", &OutcomeRange::normal);
  fields.add("without", &OutcomeRange::without,
             "controls with a result under this condition that lacks this number; the range does not tell of them");
  fields.add("verdict", &OutcomeRange::verdict, "where the value is beside range95");
  fields.add_unless_empty("why_not_comparable", &OutcomeRange::why_not_comparable,
                          "why no range of comparable stretches applies to the value, as a clause");
}

void describe(Fields<SideDifference>& fields) {
  fields.type("SideDifference", "One outcome of the participant, left less right, in the last session with both.");
  fields.add("left_condition", &SideDifference::left_condition);
  fields.add("right_condition", &SideDifference::right_condition);
  fields.add("outcome", &SideDifference::outcome);
  fields.add("unit", &SideDifference::unit);
  fields.add("session", &SideDifference::session);
  fields.add("left", &SideDifference::left, "mean of the session's results");
  fields.add("right", &SideDifference::right);
  fields.add("difference", &SideDifference::difference, "left − right");
  fields.add("error95", &SideDifference::error, "95 % of errors of the difference are smaller; null: unknown");
  fields.add("error95_interval", &SideDifference::error95, "null unless error_basis is sessions");
  fields.add("error_basis", &SideDifference::basis,
             "sessions: error95 is from how the difference varies between sessions of other people; recordings: from "
             "the standard errors of the results, which do not tell of that; unknown");
  fields.add_unless_empty("why_unknown", &SideDifference::why_unknown,
                          "why the variation between sessions is unknown, as a clause");
  fields.add("heavy_tails", &SideDifference::heavy_tails,
             "other people's differences have heavier tails than normal errors: error95_interval is not valid, and no "
             "difference is beyond-error");
  fields.add("verdict", &SideDifference::verdict,
             "beyond-error: the sides differ by more than the upper end of error95_interval, without heavy_tails; "
             "uncertain: by more than error95; within-error: by at most error95; unknown: error_basis is not sessions");
  fields.add("normal", &SideDifference::normal, "of left − right of the controls");
  fields.add("range_verdict", &SideDifference::range_verdict, "where the difference is beside normal.range95");
  fields.add_unless_empty("why_not_comparable", &SideDifference::why_not_comparable,
                          "why the stretches of left and right are not comparable, as a clause; error95, range and "
                          "verdicts are then unknown");
  fields.add_unless_empty("why_no_comparable_range", &SideDifference::why_no_comparable_range,
                          "why no range of comparable stretches applies to the difference, as a clause");
}

void describe(Fields<StretchCurve>& fields) {
  fields.type("StretchCurve", "Resisting torque over position at one speed.");
  fields.add_rounded("speed", &StretchCurve::speed, document::kDigits, "[position_unit/s]");
  fields.add_rounded("torque", &StretchCurve::torque, document::kDigits, "of the participant, at the positions");
  fields.add("controls", &StretchCurve::controls,
             "who were stretched at this speed (within 10 %) over at least 80 % of the positions");
  fields.add("above", &StretchCurve::above,
             "share of the positions with a range at which torque is above it; null: there is no range");
  fields.add("below", &StretchCurve::below, "the same, below it");
  fields.add_rounded("mean", &StretchCurve::mean, document::kDigits,
                     "of the controls; null: fewer than five, or one of them lacks the position");
  fields.add_rounded("low95", &StretchCurve::low95, document::kDigits,
                     "prediction interval of one further control at each position, by Student's t");
  fields.add_rounded("high95", &StretchCurve::high95, document::kDigits);
}

void describe(Fields<StretchCurves>& fields) {
  fields.type("StretchCurves", "Stretches of the participant's last session beside those of the controls in theirs.");
  fields.add("condition", &StretchCurves::condition);
  fields.add("session", &StretchCurves::session);
  fields.add("results", &StretchCurves::results, "recordings");
  fields.add("direction", &StretchCurves::direction, "1: the position increases, −1: it decreases");
  fields.add("position_unit", &StretchCurves::position_unit);
  fields.add("torque_unit", &StretchCurves::torque_unit);
  fields.add_rounded("position", &StretchCurves::position, document::kDigits);
  fields.add("speeds", &StretchCurves::speeds, "increasing");
}

void describe(Fields<Controls>& fields) {
  fields.type("StudyControls", "People of the study with whom the participant is compared.");
  fields.add("name", &Controls::name);
  fields.add("participants", &Controls::people, "with a usable result, without the participant");
  fields.add("is_one", &Controls::is_one, "the participant is one of them, and is left out of the ranges");
}

void describe(Fields<ParticipantComparison>& fields) {
  fields.add("controls", &ParticipantComparison::controls, "of --group");
  fields.add("stretches", &ParticipantComparison::stretches);
  fields.add("ranges", &ParticipantComparison::ranges, "empty without controls");
  fields.add("sides", &ParticipantComparison::sides,
             "of conditions whose names differ in the words left and right alone");
}

namespace {

/// Above so many values a page does not hold every result, since it would no longer open quickly.
constexpr std::size_t kMaxValues = 400'000;

/// The symmetric part of the mean matrix of a person's session under one condition.
struct SessionMatrix {
  std::string matrix, unit, condition;
  std::int64_t participant = 0, session = 0;
  int results = 0;
  std::array<double, 3> sum{};
};

void describe(Fields<SessionMatrix>& fields) {
  fields.type("SessionMatrix");
  fields.add_as("matrix", {{"enum", {"M", "B", "K"}}}, &SessionMatrix::matrix);
  fields.add("unit", &SessionMatrix::unit);
  fields.add("condition", &SessionMatrix::condition);
  fields.add("participant", &SessionMatrix::participant);
  fields.add("session", &SessionMatrix::session);
  fields.add("results", &SessionMatrix::results);
  fields.add_as(
      "symmetric", {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 3}, {"maxItems", 3}},
      [](const SessionMatrix& one) {
        const auto& [xx, xy, yy] = one.sum;
        return document::Json{xx / one.results, xy / one.results, yy / one.results};
      },
      "xx, (xy + yx)/2 and yy of the mean over the session's results");
}

struct StudyOutcome {
  std::string name, unit;
};

void describe(Fields<StudyOutcome>& fields) {
  fields.type("StudyOutcome");
  fields.add("name", &StudyOutcome::name);
  fields.add("unit", &StudyOutcome::unit);
}

struct StudyResult {
  std::int64_t recording = 0;
  std::vector<double> values, standard_errors;
};

void describe(Fields<StudyResult>& fields) {
  fields.type("StudyResult");
  fields.add("recording", &StudyResult::recording);
  fields.add("values", &StudyResult::values, "in the order of `outcomes`; null: none");
  fields.add("standard_errors", &StudyResult::standard_errors);
}

/// What a page holds: of everybody, or of one participant.
struct Page {
  const StudyReport& report;
  std::optional<std::int64_t> participant;

  [[nodiscard]] bool holds(std::int64_t number) const { return !participant || number == *participant; }
  [[nodiscard]] std::vector<store::ListedRecording> recordings() const;
  [[nodiscard]] std::vector<SessionMatrix> matrices() const;
  [[nodiscard]] std::optional<std::vector<std::size_t>> rows() const;
};

std::vector<store::ListedRecording> Page::recordings() const {
  std::vector<store::ListedRecording> own = report.list.recordings;
  std::erase_if(own, [&](const store::ListedRecording& one) { return !holds(one.recording.participant); });
  return own;
}

std::vector<SessionMatrix> Page::matrices() const {
  const store::OutcomeColumns& columns = report.columns;
  std::vector<SessionMatrix> all;
  for (const char* matrix : {"M", "B", "K"}) {
    std::array<const store::OutcomeColumn*, 4> elements{};
    constexpr std::array kElements = {"xx", "xy", "yx", "yy"};
    for (std::size_t k = 0; k < kElements.size(); ++k) {
      const auto found = std::ranges::find(columns.outcomes, fmt::format("{}_{}", matrix, kElements.at(k)),
                                           &store::OutcomeColumn::name);
      elements.at(k) = found == columns.outcomes.end() ? nullptr : &*found;
    }
    if (std::ranges::find(elements, nullptr) != elements.end()) continue;
    const auto spatial = std::ranges::find(columns.outcomes, fmt::format("{}_zz", matrix), &store::OutcomeColumn::name);
    std::map<std::tuple<int, std::int64_t, std::int64_t>, SessionMatrix> sums;  // by condition, participant, session
    for (std::size_t k = 0; k < columns.trials.size(); ++k) {
      const store::TrialRow& trial = columns.trials[k];
      if (!holds(trial.participant)) continue;
      if (spatial != columns.outcomes.end() && std::isfinite(spatial->values[k])) continue;  // no ellipse in a plane
      const auto value = [&](std::size_t element) { return elements.at(element)->values[k]; };
      const double total = value(0) + value(1) + value(2) + value(3);
      if (!std::isfinite(total)) continue;
      SessionMatrix& one = sums[{trial.condition, trial.participant, trial.session}];
      one.sum[0] += value(0);
      one.sum[1] += 0.5 * (value(1) + value(2));
      one.sum[2] += value(3);
      ++one.results;
    }
    for (auto& [key, one] : sums) {
      one.matrix = matrix;
      one.unit = elements[0]->unit;
      one.condition = columns.conditions[static_cast<std::size_t>(std::get<0>(key))];
      std::tie(std::ignore, one.participant, one.session) = key;
      all.push_back(std::move(one));
    }
  }
  return all;
}

/// Of the columns; nothing where they are too many for a page.
std::optional<std::vector<std::size_t>> Page::rows() const {
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < report.columns.trials.size(); ++k) {
    if (holds(report.columns.trials[k].participant)) rows.push_back(k);
  }
  if (rows.size() * report.columns.outcomes.size() > kMaxValues) return std::nullopt;
  return rows;
}

std::optional<std::vector<StudyOutcome>> outcomes_of(const Page& page) {
  if (!page.rows()) return std::nullopt;
  std::vector<StudyOutcome> outcomes;
  for (const store::OutcomeColumn& one : page.report.columns.outcomes) outcomes.push_back({one.name, one.unit});
  return outcomes;
}

std::optional<std::vector<StudyResult>> results_of(const Page& page) {
  const auto rows = page.rows();
  if (!rows) return std::nullopt;
  std::vector<StudyResult> results;
  for (const std::size_t row : *rows) {
    StudyResult result{page.report.columns.trials[row].recording, {}, {}};
    for (const store::OutcomeColumn& one : page.report.columns.outcomes) {
      result.values.push_back(one.values[row]);
      result.standard_errors.push_back(one.standard_errors.empty() ? kNaN : one.standard_errors[row]);
    }
    results.push_back(std::move(result));
  }
  return results;
}

/// What both documents begin with.
template <class View>
void describe_head(Fields<View>& fields, const std::string& schema) {
  fields.header(schema);
  fields.add(
      "command", [](const View& view) { return view.page.report.command; }, "command that reproduces it");
  fields.add_unless_empty("note", [](const View& view) { return view.page.report.note; });
  fields.add(
      "primary", [](const View& view) { return view.page.report.primary; },
      "outcome shown first; \"\": nothing was measured");
}

/// What both end with.
template <class View>
void describe_tail(Fields<View>& fields) {
  fields.add("recordings", [](const View& view) { return view.page.recordings(); });
  fields.add("courses", [](const View& view) { return view.page.report.courses; });
  fields.add("matrices", [](const View& view) { return view.page.matrices(); });
  fields.add("outcomes", [](const View& view) { return outcomes_of(view.page); });
  fields.add(
      "results", [](const View& view) { return results_of(view.page); },
      "every usable result that is not excluded; absent if too many for a page");
}

struct StudyPage {
  Page page;
  std::vector<store::OutcomeSummary> outcomes;
};

void describe(Fields<StudyPage>& fields) {
  fields.type("StudyReport", "Content of the page that `mbk study report` writes.");
  describe_head(fields, "mbk.study_report/1");
  fields.add("summary", [](const StudyPage& view) {
    const StudyReport& report = view.page.report;
    return statistics::StudySummary{report.list, view.outcomes, report.statistics};
  });
  describe_tail(fields);
}

struct ParticipantPage {
  Page page;
};

void describe(Fields<ParticipantPage>& fields) {
  using From = const ParticipantPage&;
  fields.type("ParticipantReport",
              "Content of the page that `mbk study report --participant` writes. About other people it contains only "
              "numbers that describe all of them together.");
  describe_head(fields, "mbk.participant_report/1");
  fields.add("title", [](From view) { return view.page.report.list.facts.title; });
  fields.add_or_null("analysis", [](From view) { return view.page.report.list.analysis; });
  fields.add("participant", [](From view) { return *view.page.participant; });
  fields.add(
      "study_participants",
      [](From view) {
        std::set<std::int64_t> people;
        for (const store::TrialRow& trial : view.page.report.columns.trials) people.insert(trial.participant);
        return people.size();
      },
      "with a usable result");
  fields.with([](From view) -> const ParticipantComparison& { return view.page.report.comparison; });
  describe_tail(fields);
}

}  // namespace

void add_schemas(document::Schemas& schemas) {
  schemas["study_report"] = document::schema_of<StudyPage>();
  schemas["participant_report"] = document::schema_of<ParticipantPage>();
}

std::string primary_outcome(const store::OutcomeColumns& columns) {
  for (const char* name : {"stiffness_lambda_max", "K", "K_xx", "stretch_increasing_slope"}) {
    if (std::ranges::find(columns.outcomes, name, &store::OutcomeColumn::name) != columns.outcomes.end()) return name;
  }
  return columns.outcomes.empty() ? "" : columns.outcomes.front().name;
}

Result<StudyReport> study_report(store::StudyList list, store::OutcomeColumns columns,
                                 statistics::StudyStatistics statistics, std::optional<std::int64_t> participant,
                                 const std::string& outcome, StretchExtents extents) {
  StudyReport report;
  const auto is_theirs = [&](const store::ListedRecording& one) { return one.recording.participant == *participant; };
  if (participant && std::ranges::none_of(list.recordings, is_theirs)) {
    return bad_usage(fmt::format("there is no participant {}", *participant),
                     "'mbk study list' shows the participants");
  }
  report.primary = outcome.empty() ? primary_outcome(columns) : outcome;
  if (!outcome.empty() &&
      std::ranges::find(columns.outcomes, outcome, &store::OutcomeColumn::name) == columns.outcomes.end()) {
    return bad_usage(fmt::format("there is no outcome '{}'", outcome),
                     "'mbk study summary' shows the outcomes; example: --outcome K_xx");
  }
  report.courses = courses(columns, statistics, participant, extents);
  report.extents = std::move(extents);
  report.list = std::move(list);
  report.columns = std::move(columns);
  report.statistics = std::move(statistics);
  return report;
}

Result<ParticipantComparison> compare_participant(const store::Store& study, const StudyReport& report,
                                                  std::int64_t participant,
                                                  const std::optional<statistics::PeopleGroup>& controls) {
  ParticipantComparison made;
  std::set<std::int64_t> people;
  if (controls) {
    const auto belongs = [&](std::int64_t number) {
      return std::ranges::find(controls->participants, number) != controls->participants.end();
    };
    for (const store::TrialRow& trial : report.columns.trials) {
      if (trial.participant != participant && belongs(trial.participant)) people.insert(trial.participant);
    }
    if (people.empty()) {
      return bad_usage(fmt::format("nobody else of the group '{}' has a usable result", controls->name),
                       "'mbk study list' shows the participants; example: --group controls=21-30");
    }
    made.controls = {controls->name, static_cast<int>(people.size()), belongs(participant)};
    made.ranges = outcome_ranges(report.columns, participant, people, report.extents);
  }
  made.stretches = MBK_TRY(stretch_curves(study, report.list, participant, people));
  made.sides = side_differences(report.columns, participant, people, report.extents);
  return made;
}

std::string study_report_json(const StudyReport& report) {
  return document::compact(document::written(StudyPage{{report, {}}, store::summarise_outcomes(report.columns)})) +
         "\n";
}

std::string participant_report_json(const StudyReport& report, std::int64_t participant) {
  return document::compact(document::written(ParticipantPage{{report, participant}})) + "\n";
}

}  // namespace mbk::longitudinal
