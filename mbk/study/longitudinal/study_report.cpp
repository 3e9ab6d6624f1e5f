#include "mbk/study/longitudinal/study_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "mbk/base/core/version.h"

namespace mbk::longitudinal {
namespace {

using Document = nlohmann::ordered_json;

/// Above so many values a page does not hold every result, since it would no longer open quickly.
constexpr std::size_t kMostValues = 400'000;

Document number(double value) {
  return std::isfinite(value) ? Document(value) : Document();
}

Document pair(const Interval& interval) {
  return Document::array({number(interval.first), number(interval.second)});
}

Document change_json(const Change& change) {
  return {{"first_session", change.first_session},   {"last_session", change.last_session},
          {"first", number(change.first)},           {"last", number(change.last)},
          {"difference", number(change.difference)}, {"mdc95", number(change.mdc)},
          {"mdc95_interval", pair(change.mdc95)},    {"by_others", change.by_others},
          {"heavy_tails", change.heavy_tails},       {"verdict", word_of(change.verdict)}};
}

Document course_json(const Course& course) {
  Document json = {
      {"participant", course.participant}, {"mean", number(course.mean)}, {"interval95", pair(course.interval95)}};
  json["sessions"] = Document::array();
  for (const SessionMean& one : course.sessions) {
    json["sessions"].push_back({{"session", one.session}, {"results", one.results}, {"mean", number(one.mean)}});
  }
  json["changes"] = Document::array();
  for (const Change& one : course.changes) json["changes"].push_back(change_json(one));
  return json;
}

Document courses_json(const std::vector<OutcomeCourses>& all) {
  Document list = Document::array();
  for (const OutcomeCourses& one : all) {
    Document json = {{"condition", one.condition},
                     {"outcome", one.outcome},
                     {"unit", one.unit},
                     {"axial", one.axial},
                     {"repeated_participants", one.repeated_participants}};
    if (!one.why_unknown.empty()) json["why_unknown"] = one.why_unknown;
    json["mean"] = number(one.mean);
    json["interval95"] = pair(one.interval95);
    json["participants"] = Document::array();
    for (const Course& course : one.courses) json["participants"].push_back(course_json(course));
    list.push_back(std::move(json));
  }
  return list;
}

/// "M" → the symmetric parts of the mean matrix of each person's session under each condition.
Document matrices_json(const store::OutcomeColumns& columns, std::optional<std::int64_t> participant) {
  struct Sum {
    double xx = 0.0, xy = 0.0, yy = 0.0;
    int count = 0;
  };
  constexpr std::array kMatrices = {"M", "B", "K"};
  Document list = Document::array();
  for (const char* matrix : kMatrices) {
    std::array<const store::OutcomeColumn*, 4> elements{};
    constexpr std::array kElements = {"xx", "xy", "yx", "yy"};
    bool all = true;
    for (std::size_t k = 0; k < kElements.size(); ++k) {
      const auto found = std::ranges::find(columns.outcomes, fmt::format("{}_{}", matrix, kElements.at(k)),
                                           &store::OutcomeColumn::name);
      all = all && found != columns.outcomes.end();
      elements.at(k) = found == columns.outcomes.end() ? nullptr : &*found;
    }
    if (!all) continue;
    std::map<std::tuple<int, std::int64_t, std::int64_t>, Sum> sums;  // by condition, participant, session
    for (std::size_t k = 0; k < columns.trials.size(); ++k) {
      const store::TrialRow& trial = columns.trials[k];
      if (participant && trial.participant != *participant) continue;
      const auto value = [&](std::size_t element) { return elements.at(element)->values[k]; };
      const double total = value(0) + value(1) + value(2) + value(3);
      if (!std::isfinite(total)) continue;
      Sum& sum = sums[{trial.condition, trial.participant, trial.session}];
      sum.xx += value(0);
      sum.xy += 0.5 * (value(1) + value(2));
      sum.yy += value(3);
      ++sum.count;
    }
    for (const auto& [key, sum] : sums) {
      const auto& [condition, person, session] = key;
      list.push_back({{"matrix", matrix},
                      {"unit", elements[0]->unit},
                      {"condition", columns.conditions[static_cast<std::size_t>(condition)]},
                      {"participant", person},
                      {"session", session},
                      {"results", sum.count},
                      {"symmetric", {sum.xx / sum.count, sum.xy / sum.count, sum.yy / sum.count}}});
    }
  }
  return list;
}

/// Every number of every usable result; absent where they are too many for a page.
void add_results(Document& json, const store::OutcomeColumns& columns, std::optional<std::int64_t> participant) {
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < columns.trials.size(); ++k) {
    if (!participant || columns.trials[k].participant == *participant) rows.push_back(k);
  }
  if (rows.size() * columns.outcomes.size() > kMostValues) return;
  json["outcomes"] = Document::array();
  for (const store::OutcomeColumn& one : columns.outcomes) {
    json["outcomes"].push_back({{"name", one.name}, {"unit", one.unit}});
  }
  json["results"] = Document::array();
  for (const std::size_t row : rows) {
    Document values = Document::array(), errors = Document::array();
    for (const store::OutcomeColumn& one : columns.outcomes) {
      values.push_back(number(one.values[row]));
      errors.push_back(one.standard_errors.empty() ? Document() : number(one.standard_errors[row]));
    }
    json["results"].push_back({{"recording", columns.trials[row].recording},
                               {"values", std::move(values)},
                               {"standard_errors", std::move(errors)}});
  }
}

Document recordings_json(const store::StudyList& list, std::optional<std::int64_t> participant) {
  Document all = Document::parse(store::to_json(list), nullptr, false)["recordings"];
  if (!participant) return all;
  Document own = Document::array();
  for (Document& one : all) {
    if (one["participant"] == *participant) own.push_back(std::move(one));
  }
  return own;
}

Document begun(const char* schema, const StudyReport& report) {
  Document json = {{"schema", schema}, {"software", fmt::format("mbk {}", version())}, {"command", report.command}};
  if (!report.note.empty()) json["note"] = report.note;
  return json;
}

std::string written(const Document& json) {
  return json.dump(-1, ' ', false, Document::error_handler_t::replace) + "\n";
}

}  // namespace

std::string primary_outcome(const store::OutcomeColumns& columns) {
  for (const char* name : {"stiffness_lambda_max", "K", "K_xx"}) {
    if (std::ranges::find(columns.outcomes, name, &store::OutcomeColumn::name) != columns.outcomes.end()) return name;
  }
  return columns.outcomes.empty() ? "" : columns.outcomes.front().name;
}

Result<StudyReport> study_report(store::StudyList list, store::OutcomeColumns columns,
                                 const statistics::StudyStatistics& statistics, std::optional<std::int64_t> participant,
                                 const std::string& outcome) {
  StudyReport report;
  const auto is_theirs = [&](const store::ListedRecording& one) { return one.recording.participant == *participant; };
  if (participant && std::ranges::none_of(list.recordings, is_theirs)) {
    return bad_usage(fmt::format("there is no participant {}", *participant), "'mbk study list' shows those there are");
  }
  report.primary = outcome.empty() ? primary_outcome(columns) : outcome;
  if (!outcome.empty() &&
      std::ranges::find(columns.outcomes, outcome, &store::OutcomeColumn::name) == columns.outcomes.end()) {
    return bad_usage(fmt::format("there is no outcome '{}'", outcome),
                     "'mbk study summary' shows those there are, as in --outcome K_xx");
  }
  report.courses = courses(columns, statistics, participant);
  report.list = std::move(list);
  report.columns = std::move(columns);
  return report;
}

std::string study_report_json(const StudyReport& report, const std::string& summary) {
  Document json = begun("mbk.study_report/1", report);
  json["primary"] = report.primary;
  json["summary"] = Document::parse(summary, nullptr, false);
  json["recordings"] = recordings_json(report.list, {});
  json["courses"] = courses_json(report.courses);
  json["matrices"] = matrices_json(report.columns, {});
  add_results(json, report.columns, {});
  return written(json);
}

std::string participant_report_json(const StudyReport& report, std::int64_t participant) {
  Document json = begun("mbk.participant_report/1", report);
  json["primary"] = report.primary;
  const Document list = Document::parse(store::to_json(report.list), nullptr, false);
  json["title"] = list["title"];
  json["analysis"] = Document();
  for (const Document& one : list["analyses"]) {
    if (one["number"] == list["analysis"]) json["analysis"] = one;
  }
  json["participant"] = participant;
  std::set<std::int64_t> people;
  for (const store::TrialRow& trial : report.columns.trials) people.insert(trial.participant);
  json["study_participants"] = people.size();
  json["recordings"] = recordings_json(report.list, participant);
  json["courses"] = courses_json(report.courses);
  json["matrices"] = matrices_json(report.columns, participant);
  add_results(json, report.columns, participant);
  return written(json);
}

}  // namespace mbk::longitudinal
