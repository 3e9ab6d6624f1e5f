#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"

namespace mbk::recording {

/// One entry of --channels: assigns a source of the file to a channel.
struct ChannelSource {
  std::string channel;  ///< full name; "x" and "xr" stay as they are until the number of axes is known
  std::string source;   ///< 1-based column (or row of a wide matrix), or a name in the file; `NAME[K]` is column (or
                       ///< row) K of the matrix NAME, `NAME[trial,:,K]` a slice (slices.h); `NAME@HZ` is decimated; may
                       ///< end in *GAIN, +OFFSET and -OFFSET: see `readings`
  std::string unit;     ///< unit in the file; "" if not given: then SI, or the unit in the column name
  bool negate = false;  ///< the sign of the source is flipped, before an offset is added
};

/// One way to read a source that may hold arithmetic: value = gain · name + offset, in the unit of the file.
struct SourceReading {
  std::string_view name;
  double gain = 1.0;
  double offset = 0.0;
  [[nodiscard]] bool is_plain() const { return gain == 1.0 && offset == 0.0; }
};

/// The ways to read a source, the longest name first, since *, + and - may belong to a name: "a*2+1" is the name a*2+1,
/// or a*2 plus 1, or twice a plus 1. Gains and offsets are finite decimal numbers.
[[nodiscard]] std::vector<SourceReading> readings(std::string_view source);

/// A row or column of a matrix, by matrix name and number.
struct CountedSource {
  std::string_view name;
  Index number = 0;  ///< from 1
};

/// Reads "pos[2]"; nothing for other forms. An identical name in the file takes precedence.
[[nodiscard]] std::optional<CountedSource> counted_source(std::string_view source);

/// Reads "x=2:mm,y=3,Fx=-10,time=clock:ms,tau1=current*35.15-0.2:N.m". Entries are
/// CHANNEL=[-]SOURCE[*GAIN][+OFFSET|-OFFSET][:UNIT], where SOURCE is a number, a name or
/// NAME[NUMBER], with `NAME@HZ` decimated; names and aliases of the channel table.
/// @fails  usage: empty; no "="; no source; a channel twice; an unknown channel (the nearest known one is named).
///         data: a unit that this channel cannot have (the possible ones are listed). Text after the last colon that is
///         not a unit belongs to the source, whose name may contain colons.
[[nodiscard]] Result<std::vector<ChannelSource>> parse_channel_map(std::string_view text);

}  // namespace mbk::recording
