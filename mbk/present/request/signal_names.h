#pragma once

#include <span>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/present/request/read_request.h"

namespace mbk::request {

/// A signal as the command line names it, and what it is then called.
struct SignalName {
  const std::string& given;  ///< empty: there is none
  const char* channel;       ///< that it becomes where the map has to say where it stands
  std::string& to;           ///< the channel of the recording
  double* sign;              ///< becomes −1 where a minus stands before it; nullptr: it has none
};

/// Where the signals stand: channels under their own names (position, Fx), or else columns, rows or variables of the
/// file, which the map then makes `input`, `output` and `drive`.
[[nodiscard]] Result<void> place_signals(ReadRequest& reading, std::span<const SignalName> signals);

/// How a signal was named, without what converts it: "-2:mm" is −2.
[[nodiscard]] std::string shown_name(const std::string& given);

}  // namespace mbk::request
