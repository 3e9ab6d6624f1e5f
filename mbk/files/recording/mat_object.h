#pragma once

#include <string_view>

#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// Lists a variable of a MATLAB class that is kept in a way that only MATLAB documents: a note, and an error with what
/// can read it for whoever asks for it (Array::obstacle).
/// @param type  its class: "table", "timeseries", …
void list_object(Contents& contents, std::string_view name, std::string_view type);

}  // namespace mbk::recording
