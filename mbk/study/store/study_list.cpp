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

Result<StudyList> list_study(const Store& study, std::optional<std::int64_t> analysis) {
  StudyList list;
  auto facts = study.facts();
  if (!facts) return tl::unexpected(facts.error());
  list.facts = std::move(*facts);
  auto analyses = study.analyses();
  if (!analyses) return tl::unexpected(analyses.error());
  list.analyses = std::move(*analyses);
  if (analysis) {
    const auto found = std::ranges::find(list.analyses, *analysis, &Analysis::number);
    if (found == list.analyses.end()) {
      return bad_usage(fmt::format("there is no analysis {}", *analysis),
                       "'mbk study list' shows those that there are");
    }
    list.analysis = *found;
  } else {
    auto latest = study.latest_analysis();
    if (!latest) return tl::unexpected(latest.error());
    list.analysis = std::move(*latest);
  }
  std::map<std::int64_t, StoredResult> results;
  if (list.analysis) {
    auto all = study.results(list.analysis->number);
    if (!all) return tl::unexpected(all.error());
    for (StoredResult& one : *all) results.emplace(one.recording, std::move(one));
  }
  auto recordings = study.recordings();
  if (!recordings) return tl::unexpected(recordings.error());
  for (StoredRecording& recording : *recordings) {
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
  auto recording = study.recording(number);
  if (!recording) return tl::unexpected(recording.error());
  shown.recording = std::move(*recording);
  const auto analyses = study.analyses();
  if (!analyses) return tl::unexpected(analyses.error());
  auto results = study.results_of(number);
  if (!results) return tl::unexpected(results.error());
  for (StoredResult& result : *results) {
    auto outcomes = study.outcomes(result.number);
    if (!outcomes) return tl::unexpected(outcomes.error());
    const auto analysis = std::ranges::find(*analyses, result.analysis, &Analysis::number);
    shown.results.push_back(
        {std::move(result), analysis == analyses->end() ? Analysis() : *analysis, std::move(*outcomes)});
  }
  return shown;
}

}  // namespace mbk::store
