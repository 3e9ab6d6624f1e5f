#pragma once

#include <string_view>

namespace mbk::recording {

inline constexpr std::string_view kNotAvailable = "n/a";

// What mbk adds to the standard's words.
inline constexpr const char* kMetadataKey = "MbkMetadata";  ///< of motion.json: metadata as they are
inline constexpr std::string_view kRecordedTime =
    "recorded_time";  ///< of events.tsv: on the clock of the recording [s]

}  // namespace mbk::recording
