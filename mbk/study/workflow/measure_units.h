#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "mbk/batch/work.h"
#include "mbk/study/workflow/measuring.h"

/// Measuring a study's recordings as the units of a job.
namespace mbk::workflow {

inline constexpr std::string_view kMeasureKind = "measure";

/// @param folder  of the study
[[nodiscard]] std::string measure_specification(const std::filesystem::path& folder, const OptionTexts& options,
                                                const Measuring& measuring);
/// @fails  as measuring_of; data: a file that the options name has changed since the job was begun.
[[nodiscard]] Result<batch::UnitFunction> measure_units(const nlohmann::json& specification);

/// @param folder  of the study
[[nodiscard]] batch::UnitFunction measure_units(std::shared_ptr<const Measuring> measuring,
                                                std::filesystem::path folder);

[[nodiscard]] std::string unit_key(const store::Unit& unit);
/// @fails  data: no such key.
[[nodiscard]] Result<store::Unit> unit_from(const std::string& key);

[[nodiscard]] std::string result_to_bytes(const store::UnitResult& result);
/// @fails  data: no such bytes.
[[nodiscard]] Result<store::UnitResult> result_from(const std::string& bytes);

}  // namespace mbk::workflow
