#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mbk/options/engine_options.h"
#include "apps/mbk/options/explore_options.h"

/// Exploring many recordings, each by itself, in this process or as the units of a job.
namespace mbk::app {

inline constexpr std::string_view kExploreKind = "explore";

/// What is asked of each recording.
struct ExploringEach {
  ExploringArguments arguments;
  std::vector<std::string> words;  ///< the options, as they would be typed
  bool json = false, quiet = false;
};

/// What exploring one recording gave. One that cannot be explored costs only itself.
struct ExploredRecord {
  bool failed = false, usable = false;
  std::string text;  ///< as JSON (mbk.explore/1), or for a terminal
  Error error;       ///< where it failed
};

/// The options of a command that a result depends on, without FILE.
[[nodiscard]] std::vector<std::string> exploring_words(Command command);

/// In the order of the recordings.   @fails  usage: the options; a file that holds trials without the one asked for.
[[nodiscard]] Result<std::vector<ExploredRecord>> explored_here(const ExploringEach& each, unsigned threads);

/// @param code  what the command ends with where the job did not come to its end
/// @fails  as explored_here and carry_out; where `code` is set.
[[nodiscard]] Result<std::vector<ExploredRecord>> explored_elsewhere(const ExploringEach& each,
                                                                     const EngineArguments& engine,
                                                                     std::optional<int>& code);

/// Each unit is a recording.   @fails  data: no such specification; what it names has changed.
[[nodiscard]] Result<batch::UnitFunction> explore_units(const nlohmann::json& specification);

}  // namespace mbk::app
