#pragma once

#include <string>

namespace mbk::report {

/// The plausible ranges of a hand and of a joint (mbk/model/trial/plausible_ranges.h), with where they come from.
[[nodiscard]] std::string ranges_text();

}  // namespace mbk::report
