#pragma once

#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {

/// Gives the arrays of a file their meaning: which is which channel, in SI. See `read` for the rules and failures.
[[nodiscard]] Result<Recording> assemble(Contents contents, const ReadOptions& options);

}  // namespace mbk::recording
