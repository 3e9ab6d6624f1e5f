#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/option_table.h"
#include "mbk/base/core/result.h"
#include "mbk/batch/job_request.h"
#include "mbk/present/request/explore_request.h"

/// Exploring many recordings, each by itself, in this process or as the units of a job.
namespace mbk::workflow {

inline constexpr std::string_view kExploreKind = "explore";

/// The exploration requested for each recording.
struct ExploringEach {
  request::ExploreRequest request;
  OptionTexts given;  ///< the options, as they were typed
  bool json = false;  ///< what is wanted of each: JSON, or text for a terminal
};

/// What exploring one recording gave. One that cannot be explored costs only itself.
struct ExploredRecord {
  bool failed = false, usable = false;
  std::string text;  ///< as JSON (mbk.explore/1), or for a terminal
  Error error;       ///< where it failed
};

/// In the order of the recordings.
/// @param progress  is told how many are done, of how many, and the last one's file
/// @fails  usage: the options; a file that holds trials without the one asked for.
[[nodiscard]] Result<std::vector<ExploredRecord>> explored_here(
    const ExploringEach& each, unsigned threads,
    const std::function<void(int done, int of, const std::string& file)>& progress);

/// The same as a job; its folder is to be set.   @fails  as explored_here; usage: a folder among the files.
[[nodiscard]] Result<batch::JobRequest> explore_request(const ExploringEach& each);
/// What the finished job gave.   @fails  as batch::results_of
[[nodiscard]] Result<std::vector<ExploredRecord>> explored_of(const batch::JobFolder& job);

/// Each unit is a recording.   @fails  data: no such specification; what it names has changed.
[[nodiscard]] Result<batch::UnitFunction> explore_units(const nlohmann::json& specification);

}  // namespace mbk::workflow
