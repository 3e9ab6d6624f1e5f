#pragma once

#include <string>

namespace mbk::workflow {

/// Whether two documents of JSON say the same but for rounding, as other processors and systems round: equal but for
/// numbers that are equal to 1e-6 of the larger one, or of the largest in their array, or to 1e-9.
/// @returns  false: also where one of them is no JSON
[[nodiscard]] bool same_but_for_rounding(const std::string& one, const std::string& other);

}  // namespace mbk::workflow
