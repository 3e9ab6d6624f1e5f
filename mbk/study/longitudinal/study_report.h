#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/study/longitudinal/course.h"
#include "mbk/study/store/study_list.h"

namespace mbk::longitudinal {

/// What a page says of a study, or of one of its people.
struct StudyReport {
  std::string command;  ///< that makes it again
  std::string note;     ///< of whoever made it; may be empty
  store::StudyList list;
  store::OutcomeColumns columns;
  statistics::StudyStatistics statistics;
  std::vector<OutcomeCourses> courses;
  std::string primary;  ///< the outcome that is shown first
};

/// The outcome that a page shows first unless it is asked for another: the largest stiffness [N/m], or else that of
/// an axis; "" where nothing was measured.
[[nodiscard]] std::string primary_outcome(const store::OutcomeColumns& columns);

/// The list of courses, for one person that of them alone.
/// @fails  usage: there is no such outcome; the participant has no recording.
[[nodiscard]] Result<StudyReport> study_report(store::StudyList list, store::OutcomeColumns columns,
                                               statistics::StudyStatistics statistics,
                                               std::optional<std::int64_t> participant, const std::string& outcome);

/// Schema "mbk.study_report/1".
[[nodiscard]] std::string study_report_json(const StudyReport& report);

/// Schema "mbk.participant_report/1". Of other people it holds no number but those that describe all of them together.
[[nodiscard]] std::string participant_report_json(const StudyReport& report, std::int64_t participant);

}  // namespace mbk::longitudinal
