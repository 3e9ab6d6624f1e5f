#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mbk/base/core/option_table.h"
#include "mbk/base/core/result.h"
#include "mbk/files/recording/read.h"

namespace mbk::request {

/// Which recordings are read, and how.
struct ReadRequest {
  std::vector<std::filesystem::path> files;
  bool parts = false;              ///< the files are numbered parts of one record
  std::string channels;            ///< channel map, as it is typed
  recording::ReadOptions options;  ///< but for the channel map

  ReadRequest() { options.own_samples = true; }
};

/// --channels, --variable, --trial, --side, --clock, --rate, --axes, --parts.
[[nodiscard]] const OptionTable<ReadRequest>& read_table();

/// With the channel map.   @fails  as parse_channel_map
[[nodiscard]] Result<recording::ReadOptions> read_options(const ReadRequest& request);

}  // namespace mbk::request
