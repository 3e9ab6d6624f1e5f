#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/options/study_options.h"
#include "apps/mbk/terminal/command.h"
#include "mbk/study/statistics/study_statistics.h"
#include "mbk/study/store/study_list.h"

/// What the commands share that show a study under one analysis.
namespace mbk::app {

struct AnalysisArguments {
  StudyArguments study;
  OutputArguments output;
  std::optional<std::int64_t> analysis;
};

/// The groups, conditions or sessions to compare.
struct ComparingArguments {
  std::vector<std::string> compare, groups;
};

/// Adds --compare and --group.
void add_comparing_options(Command command, ComparingArguments& arguments);

/// The groups of --group.   @fails  usage: a text that is no group.
[[nodiscard]] Result<std::vector<statistics::PeopleGroup>> people_groups(const ComparingArguments& arguments);

/// @fails  usage: no such comparison; a group that is none, or that nothing compares.
[[nodiscard]] Result<statistics::StatisticsOptions> statistics_options(const ComparingArguments& arguments);

/// Adds --analysis.
void add_analysis_option(Command command, AnalysisArguments& arguments);

/// Opens the study into `study` and lists it.
[[nodiscard]] Result<store::StudyList> listed_study(const AnalysisArguments& arguments,
                                                    std::optional<store::Store>& study);

/// "recording 3: participant 1, session 2, relaxed, rater A, trial 1"
[[nodiscard]] std::string recording_words(const store::StoredRecording& recording);

/// Title, how many recordings there are in which state, and the analyses.
[[nodiscard]] std::string study_head_text(const store::StudyList& list);

}  // namespace mbk::app
