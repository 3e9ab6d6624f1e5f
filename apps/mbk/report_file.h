#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mbk/measure_options.h"
#include "mbk/core/result.h"
#include "mbk/result/json.h"
#include "mbk/trial/diagnostics.h"
#include "mbk/trial/recording.h"
#include "mbk/trial/summary.h"

namespace mbk::app {

/// Writes --report: the page with everything in it.
/// @param recordings  one for each result, or all of one pooled result    @param diagnostics  one for each result
/// @param typed       the command line
[[nodiscard]] Result<void> write_report(const MeasureArguments& arguments, const std::string& typed,
                                        const std::vector<Recording>& recordings,
                                        const std::vector<result::Measured>& measured,
                                        const std::vector<std::optional<Diagnostics>>& diagnostics,
                                        const std::optional<Summary>& summary);

/// The same for a document that is ready.
[[nodiscard]] Result<void> write_page(const MeasureArguments& arguments, std::string_view report_json);

}  // namespace mbk::app
