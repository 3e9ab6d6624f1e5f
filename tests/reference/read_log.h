#pragma once

#include <string>

#include "mbk/base/core/result.h"
#include "tests/reference/quad_procedure.h"

namespace mbk::reference {

/// Rows 2–3 (hand), 10–11 (force), 12–13 (reference) and 18–19 (acceleration) of the 19-row real double matrix `logs`
/// in a MAT file.   @fails  no such file, variable, shape or type.
[[nodiscard]] Result<Log> read_log(const std::string& path);

}  // namespace mbk::reference
