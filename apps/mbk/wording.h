#pragma once

#include <string>

#include "mbk/base/core/result.h"

namespace mbk::app {

/// What the reader of a message calls mbk from.
enum class Language { python, matlab, c };

/// A message for the command line as a message for `language`. An option of --help becomes an argument: "--rate 1000"
/// is `rate=1000` in Python, `'rate', 1000` in MATLAB and `{"rate", "1000"}` in C. A command between single quotes
/// becomes a call: 'mbk info' is `mbk.info()` in Python; if the language has no such function, " in a terminal" follows
/// it. Everything else stays as it is. From any thread.
[[nodiscard]] std::string in_language(Language language, const std::string& text);

[[nodiscard]] Error in_language(Language language, const Error& error);

}  // namespace mbk::app
