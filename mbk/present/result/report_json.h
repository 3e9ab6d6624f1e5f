#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mbk/model/trial/arm_posture.h"
#include "mbk/model/trial/diagnostics.h"
#include "mbk/model/trial/summary.h"
#include "mbk/model/trial/width.h"
#include "mbk/present/result/json.h"

namespace mbk::result {

/// What a report says of one recording beside its numbers.
struct RecordingFacts {
  std::map<std::string, std::string> metadata;
  std::optional<ArmPosture> posture;
};

/// One result with everything that is drawn for it.
struct ReportedResult {
  Measurement measured;
  std::vector<RecordingFacts> recordings;  ///< one, or those that were pooled
  std::optional<Diagnostics> diagnostics;
};

/// Everything in a report.
struct Report {
  std::vector<ReportedResult> results;    ///< at least one
  std::optional<SeveralTrials> together;  ///< absent where one result was asked for
  std::string command;                    ///< as typed
  std::string note;                       ///< of whoever made the report: a date, a name; may be empty
};

/// Schema "mbk.report/1": `result` as `to_json` writes it, and for each result metadata, posture and diagnostics, which
/// have six digits (time and frequency nine), since they are there to be looked at. null where a number is undefined.
[[nodiscard]] std::string to_json(const Report& report);

/// Several results beside each other, and how far each is from the first.
struct ComparisonReport {
  Report compared;                    ///< two results or more, with `together`
  std::vector<std::string> names;     ///< what each result is called
  std::vector<WidthFindings> widths;  ///< of each but the first
};

/// Schema "mbk.compare_report/1": that of a report, with `names`, and in `comparisons` one "mbk.compare/1" for each
/// result but the first.
[[nodiscard]] std::string to_json(const ComparisonReport& report);

}  // namespace mbk::result
