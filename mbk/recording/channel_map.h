#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mbk/core/result.h"

namespace mbk::recording {

/// One entry of --channels: the channel that a source of the file is.
struct ChannelSource {
  std::string channel;  ///< full name; "x" and "xr" stay as they are until the number of axes is known
  std::string source;   ///< 1-based column (or row of a wide matrix), or a name in the file; NAME@HZ is thinned
  std::string unit;     ///< unit in the file, "" where not said: then SI, or what the column's own name says
  bool negate = false;  ///< the sign is flipped
};

/// Reads "x=2:mm,y=3,Fx=-10,time=clock:ms". Entries are CHANNEL=[-]SOURCE[:UNIT]; names and aliases of the channel
/// table.
/// @fails  usage: empty; no "="; no source; a channel twice; an unknown channel (the nearest known one is named).
///         data: a unit that this channel cannot have (the possible ones are named). What stands behind the last colon
/// and is no unit stays with the source, whose name may hold colons.
[[nodiscard]] Result<std::vector<ChannelSource>> parse_channel_map(std::string_view text);

}  // namespace mbk::recording
