#pragma once

#include <string_view>

#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// Lists a variable of a MATLAB class with an undocumented storage format: adds a note, and an error on request that
/// names software that can read it (Array::obstacle).
/// @param type  its class: "table", "timeseries", …
void list_object(Contents& contents, std::string_view name, std::string_view type);

}  // namespace mbk::recording
