#pragma once

#include <span>

#include "mbk/base/document/fields.h"
#include "mbk/study/statistics/study_statistics.h"

/// For the sources of this project only.
namespace mbk::statistics {

/// The document of schema mbk.study_summary/1, which that of a report holds, too.
struct StudySummary {
  const store::StudyList& list;
  std::span<const store::OutcomeSummary> outcomes;
  const StudyStatistics& statistics;
};

void describe(document::Fields<StudySummary>& fields);

/// Adds the schemas of what summary and plan write.
void add_schemas(document::Schemas& schemas);
void add_plan_schema(document::Schemas& schemas);

}  // namespace mbk::statistics
