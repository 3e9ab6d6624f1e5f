#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/readers.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// Adds a recording to a BIDS data set, which is created if the folder is new or empty. Existing files remain: README
/// and description are not changed; participants.tsv and scans.tsv get one more line.
/// @param name  "sub-07_ses-2_task-reach_run-1" (parse_bids_name)    @param title  of a new data set
/// @returns  the path of the motion.tsv that was written
/// @fails  usage: the name; the run exists and `overwrite` is false; the folder contains other files. data: the
/// recording
///         cannot be written; a table of the data set is damaged; the folder cannot be written.
[[nodiscard]] Result<std::filesystem::path> write_bids(const Recording& recording, const std::filesystem::path& folder,
                                                       std::string_view name, bool overwrite,
                                                       Readers readers = Readers::owner, std::string_view title = {});

/// Data that cannot be stored there or are withheld, one sentence each.
[[nodiscard]] std::vector<std::string> lost_in_bids(const Recording& recording);

}  // namespace mbk::recording
