#pragma once

#include <filesystem>

#include "apps/mbk/options/study_options.h"
#include "mbk/study/store/study_list.h"

namespace mbk::app {

/// Writes the recordings of a study that are not excluded as a BIDS data set (Motion), in a folder that is not there
/// yet; it is there when it is whole. What cannot be read is said, and costs only itself.
/// @returns  the exit code
[[nodiscard]] int export_bids(const store::Store& study, const store::StudyList& list,
                              const std::filesystem::path& folder, bool quiet);

}  // namespace mbk::app
