#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/study/store/store.h"
#include "mbk/study/store/study_summary.h"

/// A study as a whole, for whoever shows it.
namespace mbk::store {

/// What is known of a recording under one analysis.
enum class RecordingState { usable, not_usable, failed, not_measured, excluded };

[[nodiscard]] constexpr auto word_table(RecordingState) {
  using enum RecordingState;
  return std::to_array<Word<RecordingState>>({{usable, "usable"},
                                              {not_usable, "not-usable"},
                                              {failed, "failed"},
                                              {not_measured, "not-measured"},
                                              {excluded, "excluded"}});
}

struct ListedRecording {
  StoredRecording recording;
  RecordingState state = RecordingState::not_measured;
  std::string reason;       ///< why it is excluded, not usable or failed
  std::int64_t result = 0;  ///< its number; 0: there is none
};

/// A study under one analysis.
struct StudyList {
  StudyFacts facts;
  std::vector<Analysis> analyses;
  std::optional<Analysis> analysis;  ///< absent: nothing was measured
  std::vector<ListedRecording> recordings;

  [[nodiscard]] std::int64_t count(RecordingState state) const;
  [[nodiscard]] std::int64_t participants() const;
  [[nodiscard]] bool has_raters() const;  ///< of any recording
};

/// @param analysis  its number; absent: the one that the newest result is of
/// @fails  usage: there is no such analysis.
[[nodiscard]] Result<StudyList> list_study(const Store& study, std::optional<std::int64_t> analysis);

/// A recording with all its results.
struct ShownRecording {
  StoredRecording recording;
  struct Shown {
    StoredResult result;
    Analysis analysis;
    std::vector<Outcome> outcomes;
  };
  std::vector<Shown> results;
};

/// @fails  usage: there is no such recording.
[[nodiscard]] Result<ShownRecording> show_recording(const Store& study, std::int64_t number);

/// Schema "mbk.study_list/1".
[[nodiscard]] std::string to_json(const StudyList& list);
/// Schema "mbk.study_show/1".
[[nodiscard]] std::string to_json(const ShownRecording& shown);
/// Schema "mbk.study_log/1".   @param verdict  absent where the log was not verified
[[nodiscard]] std::string to_json(const std::vector<LogLine>& lines, const std::optional<LogVerdict>& verdict);
/// Schema "mbk.study_check/1".
[[nodiscard]] std::string to_json(const CheckReport& report);

/// One row for each number of each result: for R, pandas and spreadsheets. UTF-8, every digit, RFC 4180.
[[nodiscard]] Result<std::string> export_csv(const Store& study, const StudyList& list);
/// Schema "mbk.study_export/1": the same, with the recordings' hashes and the options.
[[nodiscard]] Result<std::string> export_json(const Store& study, const StudyList& list);

}  // namespace mbk::store
