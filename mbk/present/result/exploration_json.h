#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/exploration.h"

namespace mbk::result {

/// Schema "mbk.explore/1": each part of an exploration that is there, under its own name.
[[nodiscard]] std::string to_json(const Exploration& found);

/// Schema "mbk.explorations/1": of several recordings, each by itself.
/// @param explorations  as `to_json` writes them    @param failed  of recordings that could not be explored
[[nodiscard]] std::string to_json(const std::vector<std::string>& explorations, const std::vector<Error>& failed);

/// Schema "mbk.explore_report/1", for the page of web/report: `result` as `to_json` writes it and, where M, B and K
/// were fitted to the impulse response, `model_responses`: the K − Mω² + jωB of those, at the same frequencies and in
/// the same order as the responses.
/// @param command  as typed    @param note  of whoever made the report; may be empty
[[nodiscard]] std::string report_json(const Exploration& found, const std::string& command, const std::string& note);

}  // namespace mbk::result
