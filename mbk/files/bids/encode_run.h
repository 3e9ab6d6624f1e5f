#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/bids/run_name.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// A file of a data set.
struct BidsFile {
  std::string path;  ///< relative to the folder of the data set
  std::string text;
  bool of_run;  ///< it belongs to this recording only; shared files are returned with one more line
};

/// Items of a recording that are not written because they may identify the participant.
[[nodiscard]] std::vector<std::string> withheld_from_bids(const Recording& recording);

/// A recording as files of a BIDS data set (Motion, 1.11), in writing order: the file with the numbers is last.
/// Numbers, time, events and metadata are restored exactly. Time is a channel of type LATENCY, unless the file had
/// none. Angles stay in rad. Items that may identify the participant are omitted; an age of 89 and above is "89+".
/// @param title  of the data set; empty: a general one    @param existing  returns the text of an existing file, or
/// nothing
/// @fails  data: an existing table is malformed.
[[nodiscard]] Result<std::vector<BidsFile>> encode_bids(
    const Recording& recording, const BidsName& name,
    const std::function<std::optional<std::string>(const std::string& path)>& existing, std::string_view title = {});

}  // namespace mbk::recording
