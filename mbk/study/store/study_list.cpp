#include "mbk/study/store/study_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace mbk::store {

std::int64_t StudyList::count(RecordingState state) const {
  return std::ranges::count(recordings, state, &ListedRecording::state);
}

std::int64_t StudyList::participants() const {
  std::set<std::int64_t> all;
  for (const ListedRecording& one : recordings) all.insert(one.recording.participant);
  return std::ssize(all);
}

bool StudyList::has_raters() const {
  return std::ranges::any_of(recordings, [](const ListedRecording& one) { return !one.recording.rater.empty(); });
}

Result<StudyList> list_study(const Store& study, std::optional<std::int64_t> analysis) {
  StudyList list;
  auto facts = MBK_TRY(study.facts());
  list.facts = std::move(facts);
  auto analyses = MBK_TRY(study.analyses());
  list.analyses = std::move(analyses);
  if (analysis) {
    const auto found = std::ranges::find(list.analyses, *analysis, &Analysis::number);
    if (found == list.analyses.end()) {
      return bad_usage(fmt::format("there is no analysis {}", *analysis), "'mbk study list' shows the existing ones");
    }
    list.analysis = *found;
  } else {
    list.analysis = MBK_TRY(study.latest_analysis());
  }
  std::map<std::int64_t, StoredResult> results;
  if (list.analysis) {
    auto all = MBK_TRY(study.results(list.analysis->number));
    for (StoredResult& one : all) results.emplace(one.recording, std::move(one));
  }
  auto recordings = MBK_TRY(study.recordings());
  for (StoredRecording& recording : recordings) {
    ListedRecording one{.recording = std::move(recording)};
    const auto result = results.find(one.recording.number);
    if (result != results.end()) {
      one.result = result->second.number;
      one.reason = result->second.reason;
      one.state = result->second.failed   ? RecordingState::failed
                  : result->second.usable ? RecordingState::usable
                                          : RecordingState::not_usable;
    }
    if (one.recording.excluded_why) {
      one.state = RecordingState::excluded;
      one.reason = *one.recording.excluded_why;
    }
    list.recordings.push_back(std::move(one));
  }
  return list;
}

Result<ShownRecording> show_recording(const Store& study, std::int64_t number) {
  ShownRecording shown;
  auto recording = MBK_TRY(study.recording(number));
  shown.recording = std::move(recording);
  const auto analyses = MBK_TRY(study.analyses());
  auto results = MBK_TRY(study.results_of(number));
  for (StoredResult& result : results) {
    auto outcomes = MBK_TRY(study.outcomes(result.number));
    const auto analysis = std::ranges::find(analyses, result.analysis, &Analysis::number);
    shown.results.push_back(
        {std::move(result), analysis == analyses.end() ? Analysis() : *analysis, std::move(outcomes)});
  }
  return shown;
}

}  // namespace mbk::store
