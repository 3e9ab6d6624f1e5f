#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mbk/options/output_options.h"
#include "mbk/base/core/result.h"
#include "mbk/model/trial/diagnostics.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/summary.h"
#include "mbk/present/report/html.h"
#include "mbk/present/result/json.h"
#include "mbk/present/result/report_json.h"

namespace mbk::app {

/// What a shell takes as one word, as it is or quoted.
[[nodiscard]] std::string shell_word(const std::string& word);

/// The facts about a measured recording for a report.
/// @param identification  of that recording, or of several pooled    @param which  of its recordings this is
[[nodiscard]] result::RecordingFacts facts_of(const Recording& recording, const Identification& identification,
                                              std::size_t which = 0);

/// The document of a report, with everything in it.
/// @param facts  one for each result, or all of one pooled result    @param diagnostics  one for each result
/// @param typed       the command line
/// @param note        of its author
/// @param together    of several recordings; null for a single result
[[nodiscard]] std::string report_json(const std::string& typed, const std::string& note,
                                      const std::vector<result::RecordingFacts>& facts,
                                      const std::vector<Measurement>& measured,
                                      const std::vector<std::optional<Diagnostics>>& diagnostics,
                                      const SeveralTrials* together);

/// Writes --report: the page with that document, and says so.    @param plain  for readers without JavaScript
/// @param output  for --overwrite and --quiet    @param sources  as Output::write
[[nodiscard]] Result<void> write_page(const ReportArguments& arguments, const OutputArguments& output,
                                      std::string_view report_json, const report::StaticReport& plain,
                                      const std::vector<std::filesystem::path>& sources);

}  // namespace mbk::app
