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
  std::string path;  ///< from the folder of the data set on
  std::string text;
  bool of_run;  ///< it is this recording's own; others may be there already and are given back with one line more
};

/// What of a recording is not written, since it may tell who the participant is, in words.
[[nodiscard]] std::vector<std::string> withheld_from_bids(const Recording& recording);

/// A recording as files of a BIDS data set (Motion, 1.11), in the order in which they are to be written: that with the
/// numbers is the last. Numbers, time, events and metadata come back to the last bit. Time stands as a channel of type
/// LATENCY, but where the file held none. Angles stay in rad. What may tell who the participant is is left out, and an
/// age from 89 on is "89+".
/// @param existing  gives the text of a file that is there already, or nothing
/// @fails  data: a table that is there already is none.
[[nodiscard]] Result<std::vector<BidsFile>> encode_bids(
    const Recording& recording, const BidsName& name,
    const std::function<std::optional<std::string>(const std::string& path)>& existing);

}  // namespace mbk::recording
