#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// Placeholder for the trial name in the name of an output file.
inline constexpr std::string_view kTrialPlace = "{trial}";

/// The files that the trials of a recording are written to: `pattern` with {trial} replaced by the name of each trial.
/// Characters that a file name cannot contain (a slash, blanks, control characters) become "_".
/// @param trials  names of the trials; one with the name "" is a file that holds one record
/// @fails  usage: several trials and no {trial} in the last part of the name; {trial} and one record that has no name;
///         two trials would go to one file.
[[nodiscard]] Result<std::vector<std::filesystem::path>> files_of_trials(const std::filesystem::path& pattern,
                                                                         std::span<const std::string> trials);

}  // namespace mbk::recording
