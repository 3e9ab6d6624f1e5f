#pragma once

#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {

/// How the messages begin that no channel is recognised.
inline constexpr std::string_view kNothingRecognised = "no channel is recognised";
inline constexpr std::string_view kOnlyTimeRecognised = "no channel but time is recognised";
/// And how the one begins that a clock must be chosen.
inline constexpr std::string_view kSeveralClocks = "the channels come from streams with clocks of their own";

/// Gives the arrays of a file their meaning: which is which channel, in SI. See `read` for the rules and failures.
[[nodiscard]] Result<Recording> assemble(Contents contents, const ReadOptions& options);

}  // namespace mbk::recording
