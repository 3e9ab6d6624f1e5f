// A study as JSON, CSV and LaTeX.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mbk/base/core/table_text.h"
#include "mbk/base/core/version.h"
#include "mbk/study/store/study_list.h"

namespace mbk::store {
namespace {

using Document = nlohmann::ordered_json;

Document new_document(const char* schema) {
  return {{"schema", schema}, {"software", fmt::format("mbk {}", version())}};
}

std::string written(const Document& json) {
  return json.dump(2, ' ', false, Document::error_handler_t::replace) + "\n";
}

Document or_null(double value) {
  return std::isfinite(value) ? Document(value) : Document();
}

Document options_json(const std::string& text) {
  Document json = Document::parse(text, nullptr, false);
  return json.is_object() ? json : Document::object();
}

Document analysis_json(const Analysis& analysis) {
  return {{"number", analysis.number},
          {"options", options_json(analysis.options)},
          {"options_sha256", analysis.options_sha256},
          {"version", analysis.version}};
}

Document recording_json(const StoredRecording& r) {
  Document json = {{"number", r.number},   {"participant", r.participant},
                   {"session", r.session}, {"condition", r.condition},
                   {"trial", r.trial},     {"duration_s", r.duration_s},
                   {"sha256", r.sha256},   {"part", r.part},
                   {"bytes", r.bytes},     {"added", r.added}};
  if (r.origin_sha256 != r.sha256) json["origin_sha256"] = r.origin_sha256;
  if (r.excluded_why) json["excluded_why"] = *r.excluded_why;
  return json;
}

Document outcomes_json(const std::vector<Outcome>& outcomes) {
  Document list = Document::array();
  for (const Outcome& one : outcomes) {
    Document json = {{"name", one.name}, {"value", one.value}, {"unit", one.unit}};
    if (one.standard_error) json["standard_error"] = *one.standard_error;
    list.push_back(std::move(json));
  }
  return list;
}

Document counts_json(const StudyList& list) {
  Document json = {{"recordings", std::ssize(list.recordings)}, {"participants", list.participants()}};
  for (const auto& [state, word] : kWords<RecordingState>) {
    std::string key(word);
    std::ranges::replace(key, '-', '_');
    json[key] = list.count(state);
  }
  return json;
}

/// Three digits of the standard deviation decide how many the mean has.
std::string mean_and_deviation(const OutcomeSummary& one) {
  if (!std::isfinite(one.standard_deviation)) return fmt::format("${:.4g}$", one.mean);
  const double size = one.standard_deviation;
  const int digits = size > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(size))), 0, 9) : 3;
  return fmt::format("${:.{}f} \\pm {:.{}f}$", one.mean, digits, size, digits);
}

/// What a table says of itself, so that nobody has to guess.
std::string caption(const StudyList& list) {
  std::string text = list.facts.title.empty() ? "" : list.facts.title + ". ";
  text += fmt::format(
      "Mean ± standard deviation over participants, each with the mean of their usable results. {} of {} "
      "recordings usable, {} not usable, {} could not be measured, {} not measured, {} excluded; mbk {}",
      list.count(RecordingState::usable), list.recordings.size(), list.count(RecordingState::not_usable),
      list.count(RecordingState::failed), list.count(RecordingState::not_measured),
      list.count(RecordingState::excluded), list.analysis ? list.analysis->version : std::string(version()));
  return text + ".";
}

}  // namespace

std::string to_json(const StudyList& list) {
  Document json = new_document("mbk.study_list/1");
  json["title"] = list.facts.title;
  json["options"] = options_json(list.facts.options);
  json["analyses"] = Document::array();
  for (const Analysis& one : list.analyses) json["analyses"].push_back(analysis_json(one));
  json["analysis"] = list.analysis ? Document(list.analysis->number) : Document();
  json["recordings"] = Document::array();
  for (const ListedRecording& one : list.recordings) {
    Document recording = recording_json(one.recording);
    recording["state"] = word_of(one.state);
    if (!one.reason.empty()) recording["reason"] = one.reason;
    json["recordings"].push_back(std::move(recording));
  }
  return written(json);
}

std::string to_json(const ShownRecording& shown) {
  Document json = new_document("mbk.study_show/1");
  json["recording"] = recording_json(shown.recording);
  json["results"] = Document::array();
  for (const auto& [result, analysis, outcomes] : shown.results) {
    json["results"].push_back({{"analysis", analysis_json(analysis)},
                               {"usable", result.usable},
                               {"failed", result.failed},
                               {"reason", result.reason},
                               {"outcomes", outcomes_json(outcomes)}});
  }
  return written(json);
}

std::string to_json(const StudyList& list, const std::vector<OutcomeSummary>& outcomes, const std::string& statistics) {
  Document json = new_document("mbk.study_summary/1");
  json["title"] = list.facts.title;
  json["analysis"] = list.analysis ? analysis_json(*list.analysis) : Document();
  json["counts"] = counts_json(list);
  json["outcomes"] = Document::array();
  for (const OutcomeSummary& one : outcomes) {
    json["outcomes"].push_back({{"condition", one.condition},
                                {"outcome", one.outcome},
                                {"unit", one.unit},
                                {"results", one.results},
                                {"participants", one.participants},
                                {"mean", one.mean},
                                {"standard_deviation", or_null(one.standard_deviation)},
                                {"minimum", one.minimum},
                                {"maximum", one.maximum}});
  }
  json.update(Document::parse(statistics));
  return written(json);
}

std::string to_json(const std::vector<LogLine>& lines, const std::optional<LogVerdict>& verdict) {
  Document json = new_document("mbk.study_log/1");
  json["lines"] = Document::array();
  for (const LogLine& line : lines) {
    Document one = {
        {"number", line.number}, {"time", line.time}, {"role", word_of(line.role)}, {"action", word_of(line.action)}};
    if (line.recording) one["recording"] = *line.recording;
    if (line.analysis) one["analysis"] = *line.analysis;
    if (line.participant) one["participant"] = *line.participant;
    if (!line.digest.empty()) one["digest"] = line.digest;
    if (!line.why.empty()) one["why"] = line.why;
    one["hash"] = line.hash;
    json["lines"].push_back(std::move(one));
  }
  json["head"] = lines.empty() ? "" : lines.back().hash;
  if (verdict) json["problems"] = verdict->problems;
  return written(json);
}

std::string to_json(const CheckReport& report) {
  Document json = new_document("mbk.study_check/1");
  json["recordings"] = report.recordings;
  json["files"] = report.files;
  json["bytes"] = report.bytes;
  json["results"] = report.results;
  json["repeated"] = report.repeated;
  json["log_lines"] = report.log_lines;
  json["head"] = report.head;
  json["problems"] = report.problems;
  json["notes"] = report.notes;
  return written(json);
}

Result<std::string> export_csv(const Store& study, const StudyList& list) {
  std::string text =
      "participant,session,condition,trial,recording,sha256,analysis,version,state,reason,outcome,value,standard_error,"
      "unit\n";
  for (const ListedRecording& one : list.recordings) {
    const StoredRecording& r = one.recording;
    const std::string begin =
        fmt::format("{},{},{},{},{},{},{},{},{},{}", r.participant, r.session, csv_field(r.condition), r.trial,
                    r.number, r.sha256, list.analysis ? fmt::format("{}", list.analysis->number) : "",
                    list.analysis ? list.analysis->version : "", word_of(one.state), csv_field(one.reason));
    const auto outcomes = MBK_TRY(study.outcomes(one.result));
    if (outcomes.empty()) text += begin + ",,,,\n";
    for (const Outcome& outcome : outcomes) {
      text += fmt::format("{},{},{},{},{}\n", begin, outcome.name, outcome.value,
                          outcome.standard_error ? fmt::format("{}", *outcome.standard_error) : "",
                          csv_field(outcome.unit));
    }
  }
  return text;
}

Result<std::string> export_json(const Store& study, const StudyList& list) {
  Document json = new_document("mbk.study_export/1");
  json["title"] = list.facts.title;
  json["analysis"] = list.analysis ? analysis_json(*list.analysis) : Document();
  json["counts"] = counts_json(list);
  json["recordings"] = Document::array();
  for (const ListedRecording& one : list.recordings) {
    const auto outcomes = MBK_TRY(study.outcomes(one.result));
    Document recording = recording_json(one.recording);
    recording["state"] = word_of(one.state);
    if (!one.reason.empty()) recording["reason"] = one.reason;
    recording["outcomes"] = outcomes_json(outcomes);
    json["recordings"].push_back(std::move(recording));
  }
  return written(json);
}

std::string export_latex(const StudyList& list, const std::vector<OutcomeSummary>& outcomes) {
  std::vector<std::string> conditions;
  for (const OutcomeSummary& one : outcomes) {
    if (std::ranges::find(conditions, one.condition) == conditions.end()) conditions.push_back(one.condition);
  }
  std::string text = "% Needs \\usepackage{booktabs}.\n\\begin{table}\n\\caption{" + latex_text(caption(list)) + "}\n";
  text += "\\begin{tabular}{ll" + std::string(conditions.size(), 'r') + "}\n\\toprule\nOutcome & Unit";
  for (const std::string& condition : conditions) text += " & " + latex_text(condition.empty() ? "all" : condition);
  text += " \\\\\n\\midrule\n";
  std::vector<std::string> names;
  for (const OutcomeSummary& one : outcomes) {
    if (std::ranges::find(names, one.outcome) == names.end()) names.push_back(one.outcome);
  }
  for (const std::string& name : names) {
    std::string row = latex_text(name), unit;
    for (const std::string& condition : conditions) {
      const auto found = std::ranges::find_if(
          outcomes, [&](const OutcomeSummary& one) { return one.outcome == name && one.condition == condition; });
      row += " & " +
             (found == outcomes.end() ? "--" : mean_and_deviation(*found) + fmt::format(" ({})", found->participants));
      if (found != outcomes.end()) unit = found->unit;
    }
    row.insert(latex_text(name).size(), " & " + latex_text(unit));
    text += row + " \\\\\n";
  }
  return text + "\\bottomrule\n\\end{tabular}\n\\end{table}\n";
}

}  // namespace mbk::store
