#pragma once

#include <string>
#include <vector>

#include "mbk/study/statistics/study_statistics.h"
#include "mbk/study/store/study_summary.h"

/// A study's statistics for a terminal of 80 columns. What the data cannot carry is said in words, and has no number.
namespace mbk::statistics {

/// Every outcome by condition: mean, spread, range.
[[nodiscard]] std::string outcomes_text(const std::vector<store::OutcomeSummary>& outcomes);

/// A line for each outcome; with `details` all that is known of each.
[[nodiscard]] std::string reliability_text(const StudyStatistics& statistics, bool details);

/// The comparison, where there is one; with `details` permutation test and mixed model too.
[[nodiscard]] std::string comparison_text(const StudyStatistics& statistics, bool details);

/// How people were resampled, where they were.
[[nodiscard]] std::string bootstrap_text(const StudyStatistics& statistics);

/// What must be known of the study as a whole.
[[nodiscard]] std::string notes_text(const std::vector<std::string>& notes);

}  // namespace mbk::statistics
