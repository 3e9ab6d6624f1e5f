#pragma once

#include <string_view>

namespace mbk {

/// "1.0.0"
[[nodiscard]] std::string_view version();

/// Day of this version's release: "2026-11-30".
[[nodiscard]] std::string_view release_date();

}  // namespace mbk
