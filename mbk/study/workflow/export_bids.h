#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/study/store/study_list.h"

namespace mbk::workflow {

/// What was written, and what was not.
struct ExportedBids {
  int written = 0;                     ///< recordings
  std::vector<std::int64_t> excluded;  ///< numbers of those that are left out
  std::set<std::string> lost;          ///< what has no place in the format
  std::vector<Error> failed;           ///< recordings that cannot be read
};

/// Writes the recordings of a study that are not excluded as a BIDS data set (Motion), in a folder that is not there
/// yet; it is there when it is whole. What cannot be read costs only itself.
/// @fails  usage: the folder is there; there is nothing to export. data: it cannot be written.
[[nodiscard]] Result<ExportedBids> export_bids(const store::Store& study, const store::StudyList& list,
                                               const std::filesystem::path& folder);

}  // namespace mbk::workflow
