#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/readers.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// Adds a recording to a BIDS data set, which is made where the folder is new or empty. What is there stays: README and
/// description are not touched, participants.tsv and scans.tsv have one line more.
/// @param name  "sub-07_ses-2_task-reach_run-1" (parse_bids_name)
/// @returns  what was written for this recording: the path of its motion.tsv
/// @fails  usage: the name; the run is there and `overwrite` is false; the folder holds other things. data: the
/// recording
///         cannot be written; a table of the data set is damaged; the folder cannot be written.
[[nodiscard]] Result<std::filesystem::path> write_bids(const Recording& recording, const std::filesystem::path& folder,
                                                       std::string_view name, bool overwrite,
                                                       Readers readers = Readers::owner);

/// What has no place there, or is withheld, in words.
[[nodiscard]] std::vector<std::string> lost_in_bids(const Recording& recording);

}  // namespace mbk::recording
