#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/study/longitudinal/course.h"
#include "mbk/study/longitudinal/normal_range.h"
#include "mbk/study/longitudinal/side_difference.h"
#include "mbk/study/longitudinal/stretch_curves.h"
#include "mbk/study/store/study_list.h"

namespace mbk::longitudinal {

/// The people of a study with whom one of its people is compared.
struct Controls {
  std::string name;
  int people = 0;       ///< with a usable result, without the participant
  bool is_one = false;  ///< the participant is one of them, and is left out
};

/// What a page says of one participant beside the courses.
struct ParticipantComparison {
  std::optional<Controls> controls;
  std::vector<StretchCurves> stretches;
  std::vector<OutcomeRange> ranges;  ///< empty without controls
  std::vector<SideDifference> sides;
};

/// What a page says of a study, or of one of its people.
struct StudyReport {
  std::string command;  ///< that makes it again
  std::string note;     ///< of whoever made it; may be empty
  store::StudyList list;
  store::OutcomeColumns columns;
  statistics::StudyStatistics statistics;
  std::vector<OutcomeCourses> courses;
  std::string primary;               ///< the outcome that is shown first
  ParticipantComparison comparison;  ///< of one participant
  StretchExtents extents;            ///< of all results of stretches
};

/// The outcome that a page shows first unless it is asked for another: the largest stiffness [N/m], or else that of
/// an axis, or else the slope of resistance over speed, or else the first; "" where nothing was measured.
[[nodiscard]] std::string primary_outcome(const store::OutcomeColumns& columns);

/// The list of courses, for one person that of them alone.
/// @param statistics  as courses() takes them
/// @fails  usage: there is no such outcome; the participant has no recording.
[[nodiscard]] Result<StudyReport> study_report(store::StudyList list, store::OutcomeColumns columns,
                                               statistics::StudyStatistics statistics,
                                               std::optional<std::int64_t> participant, const std::string& outcome,
                                               StretchExtents extents = {});

/// Compares a participant with the controls, if they are given, and left with right.
/// @fails  usage: nobody else of the controls has a usable result. data: a result cannot be read.
[[nodiscard]] Result<ParticipantComparison> compare_participant(const store::Store& study, const StudyReport& report,
                                                                std::int64_t participant,
                                                                const std::optional<statistics::PeopleGroup>& controls);

/// Schema "mbk.study_report/1".
[[nodiscard]] std::string study_report_json(const StudyReport& report);

/// Schema "mbk.participant_report/1". Of other people it holds no number but those that describe all of them together.
[[nodiscard]] std::string participant_report_json(const StudyReport& report, std::int64_t participant);

}  // namespace mbk::longitudinal
