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

/// For a paper, in LaTeX or Markdown: each outcome by condition with the number of people and trials, mean ± standard
/// deviation, ICC(A,1) between sessions with its 95 % interval, SEM and MDC (agreement), and how many recordings are
/// excluded. Where no outcome has reliability, its columns are omitted and a note says so. A table that would be longer
/// than a page becomes one for each condition.
[[nodiscard]] std::string summary_latex(const store::StudyList& list,
                                        const std::vector<store::OutcomeSummary>& outcomes,
                                        const StudyStatistics& statistics);
[[nodiscard]] std::string summary_markdown(const store::StudyList& list,
                                           const std::vector<store::OutcomeSummary>& outcomes,
                                           const StudyStatistics& statistics);

/// The same numbers with all digits, one column each, and the notes of each outcome.
[[nodiscard]] std::string summary_csv(const store::StudyList& list, const std::vector<store::OutcomeSummary>& outcomes,
                                      const StudyStatistics& statistics);

/// What must be known of the study as a whole.
[[nodiscard]] std::string notes_text(const std::vector<std::string>& notes);

}  // namespace mbk::statistics
