// A study as JSON and CSV.
#include <fmt/format.h>

#include <algorithm>

#include "mbk/base/core/table_text.h"
#include "mbk/study/store/study_documents.h"

namespace mbk::store {

using document::Fields;
using document::Json;

namespace {

/// Options that are stored as the text of a JSON object.
template <class T, class Get>
void add_options(Fields<T>& fields, Get text_of) {
  const Json schema = {{"type", "object"},
                       {"additionalProperties", {{"type", "array"}, {"items", {{"type", "string"}}}}}};
  const auto get = [text_of](const T& from) {
    Json json = Json::parse(text_of(from), nullptr, false);
    return json.is_object() ? json : Json::object();
  };
  fields.add_as("options", schema, get, "options of `mbk measure` with their values; flags have none");
}

}  // namespace

void describe(Fields<Analysis>& fields) {
  fields.type("Analysis", "One way of measuring. Files named by options appear as sha256:….");
  fields.add("number", &Analysis::number);
  add_options(fields, [](const Analysis& analysis) { return analysis.options; });
  fields.add("options_sha256", &Analysis::options_sha256);
  fields.add("version", &Analysis::version, "of mbk");
}

void describe(Fields<StoredRecording>& fields) {
  fields.type("Recording");
  fields.add("number", &StoredRecording::number, "its number in the study; never reused");
  fields.add("participant", &StoredRecording::participant);
  fields.add("session", &StoredRecording::session);
  fields.add("condition", &StoredRecording::condition);
  fields.add("trial", &StoredRecording::trial);
  fields.add_unless_empty("rater", &StoredRecording::rater, "code of who measured, if recorded");
  fields.add_number("duration_s", &StoredRecording::duration_s, "[s]");
  fields.add("sha256", &StoredRecording::sha256, "of the stored file");
  fields.add("part", &StoredRecording::part, "record of the file, from 1; 0: its only record");
  fields.add("bytes", &StoredRecording::bytes, "of the stored file");
  fields.add("added", &StoredRecording::added, "UTC, as in 2026-05-04T09:30:12Z");
  fields.add_if([](const StoredRecording& one) { return one.origin_sha256 != one.sha256; }, "origin_sha256",
                &StoredRecording::origin_sha256, "of the original file, if the stored one differs");
  fields.add("excluded_why", &StoredRecording::excluded_why, "if it is excluded");
}

void describe(Fields<ListedRecording>& fields) {
  fields.type("ListedRecording");
  fields.with(&ListedRecording::recording);
  fields.add("state", &ListedRecording::state);
  fields.add_unless_empty("reason", &ListedRecording::reason, "why it is excluded, not usable or failed");
}

void describe(Fields<Counts>& fields) {
  fields.type("Counts", "Recordings by their state.");
  fields.add("recordings", [](const Counts& counts) { return counts.of.recordings.size(); });
  fields.add("participants", [](const Counts& counts) { return counts.of.participants(); });
  for (const auto& [state, word] : kWords<RecordingState>) {
    std::string key(word);
    std::ranges::replace(key, '-', '_');
    fields.add(key, [state = state](const Counts& counts) { return counts.of.count(state); });
  }
}

void describe(Fields<Outcome>& fields) {
  fields.type("Outcome");
  fields.add("name", &Outcome::name, "as in K_xx or stiffness_area");
  fields.add_number("value", &Outcome::value);
  fields.add("unit", &Outcome::unit, "\"\" for a ratio");
  fields.add_number("standard_error", &Outcome::standard_error);
}

void describe(Fields<StudyList>& fields) {
  fields.type("StudyList", "Output of `mbk study list --json`.");
  fields.header("mbk.study_list/1");
  fields.add("title", [](const StudyList& list) { return list.facts.title; });
  add_options(fields, [](const StudyList& list) { return list.facts.options; });
  fields.add("analyses", &StudyList::analyses);
  fields.add_or_null(
      "analysis",
      [](const StudyList& list) { return list.analysis ? std::optional(list.analysis->number) : std::nullopt; },
      "analysis of the results shown; null: nothing was measured");
  fields.add("recordings", &StudyList::recordings);
}

void describe(Fields<ShownRecording::Shown>& fields) {
  using From = const ShownRecording::Shown&;
  fields.add("analysis", &ShownRecording::Shown::analysis);
  fields.add("usable", [](From shown) { return shown.result.usable; });
  fields.add(
      "failed", [](From shown) { return shown.result.failed; }, "it could not be measured");
  fields.add(
      "reason", [](From shown) { return shown.result.reason; }, "why it is not usable or failed");
  fields.add("outcomes", &ShownRecording::Shown::outcomes);
}

void describe(Fields<ShownRecording>& fields) {
  fields.type("StudyShow", "Output of `mbk study show --json` for one recording.");
  fields.header("mbk.study_show/1");
  fields.add("recording", &ShownRecording::recording);
  fields.add("results", &ShownRecording::results);
}

void describe(Fields<LogLine>& fields) {
  fields.add("number", &LogLine::number);
  fields.add("time", &LogLine::time, "UTC");
  fields.add("role", &LogLine::role);
  fields.add("action", &LogLine::action);
  fields.add("recording", &LogLine::recording);
  fields.add("analysis", &LogLine::analysis);
  fields.add("participant", &LogLine::participant);
  fields.add_unless_empty("digest", &LogLine::digest,
                          "SHA-256 of the content and a salt that is deleted when the recording is forgotten");
  fields.add_unless_empty("why", &LogLine::why);
  fields.add("hash", &LogLine::hash);
}

void describe(Fields<CheckReport>& fields) {
  fields.type("StudyCheck", "Output of `mbk study check --json`.");
  fields.header("mbk.study_check/1");
  fields.add("recordings", &CheckReport::recordings);
  fields.add("files", &CheckReport::files, "files with their original hash");
  fields.add("bytes", &CheckReport::bytes);
  fields.add("results", &CheckReport::results);
  fields.add("repeated", &CheckReport::repeated, "results that were measured again and agree");
  fields.add("log_lines", &CheckReport::log_lines);
  fields.add("head", &CheckReport::head);
  fields.add("problems", &CheckReport::problems, "one sentence each; empty: everything is unchanged");
  fields.add("notes", &CheckReport::notes);
}

namespace {

struct StudyLog {
  const std::vector<LogLine>& lines;
  const std::optional<LogVerdict>& verdict;
};

void describe(Fields<StudyLog>& fields) {
  fields.type("StudyLog",
              "Output of `mbk study log --json`. hash is the SHA-256 of the JSON array [\"mbk.study.log/1\", number, "
              "time, role, action, recording, analysis, participant, digest, why, hash of the line before], with null "
              "and \"\" for absent values.");
  fields.header("mbk.study_log/1");
  fields.add("lines", [](const StudyLog& log) { return std::span(log.lines); });
  fields.add(
      "head", [](const StudyLog& log) { return log.lines.empty() ? "" : log.lines.back().hash; },
      "hash of the last line");
  fields.add(
      "problems", [](const StudyLog& log) { return log.verdict ? std::optional(log.verdict->problems) : std::nullopt; },
      "only with --verify");
}

struct ExportedRecording {
  const ListedRecording& listed;
  std::vector<Outcome> outcomes;
};

void describe(Fields<ExportedRecording>& fields) {
  fields.with([](const ExportedRecording& one) -> const ListedRecording& { return one.listed; });
  fields.add("outcomes", &ExportedRecording::outcomes);
}

struct StudyExport {
  const StudyList& list;
  std::vector<ExportedRecording> recordings;
};

void describe(Fields<StudyExport>& fields) {
  fields.type("StudyExport", "Output of `mbk study export --format json`.");
  fields.header("mbk.study_export/1");
  fields.add("title", [](const StudyExport& study) { return study.list.facts.title; });
  fields.add_or_null("analysis", [](const StudyExport& study) { return study.list.analysis; });
  fields.add("counts", [](const StudyExport& study) { return Counts{study.list}; });
  fields.add("recordings", &StudyExport::recordings);
}

}  // namespace

void add_schemas(document::Schemas& schemas) {
  schemas["study_list"] = document::schema_of<StudyList>();
  schemas["study_show"] = document::schema_of<ShownRecording>();
  schemas["study_log"] = document::schema_of<StudyLog>();
  schemas["study_check"] = document::schema_of<CheckReport>();
  schemas["study_export"] = document::schema_of<StudyExport>();
}

std::string to_json(const StudyList& list) {
  return document::document(list);
}

std::string to_json(const ShownRecording& shown) {
  return document::document(shown);
}

std::string to_json(const std::vector<LogLine>& lines, const std::optional<LogVerdict>& verdict) {
  return document::document(StudyLog{lines, verdict});
}

std::string to_json(const CheckReport& report) {
  return document::document(report);
}

Result<std::string> export_csv(const Store& study, const StudyList& list) {
  const bool raters = list.has_raters();
  std::string text = fmt::format(
      "participant,session,condition,trial,{}recording,sha256,analysis,version,state,reason,outcome,value,"
      "standard_error,unit\n",
      raters ? "rater," : "");
  for (const ListedRecording& one : list.recordings) {
    const StoredRecording& r = one.recording;
    const std::string begin = fmt::format(
        "{},{},{},{},{}{},{},{},{},{},{}", r.participant, r.session, csv_field(r.condition), r.trial,
        raters ? r.rater + "," : "", r.number, r.sha256, list.analysis ? fmt::format("{}", list.analysis->number) : "",
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
  StudyExport all{list, {}};
  for (const ListedRecording& one : list.recordings)
    all.recordings.push_back({one, MBK_TRY(study.outcomes(one.result))});
  return document::document(all);
}

}  // namespace mbk::store
