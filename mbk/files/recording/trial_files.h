#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// Stands in the name of a file to write for the name of each trial.
inline constexpr std::string_view kTrialPlace = "{trial}";

/// The files that the trials of a recording are written to: `pattern` with the name of each trial in the place of
/// {trial}. Of a name whatever cannot stand in that of a file (a slash, blanks, control characters) becomes "_".
/// @param trials  names of the trials; one with the name "" is a file that holds one record
/// @fails  usage: several trials and no {trial} in the last part of the name; {trial} and one record that has no name;
///         two trials would go to one file.
[[nodiscard]] Result<std::vector<std::filesystem::path>> files_of_trials(const std::filesystem::path& pattern,
                                                                         std::span<const std::string> trials);

}  // namespace mbk::recording
