#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/batch/job.h"

/// The jobs of a study, STUDY/jobs: those under way are folders, of finished ones a document stays.
namespace mbk::app {

/// In the order of their names.   @param study  its folder
[[nodiscard]] std::vector<std::filesystem::path> job_folders(const std::filesystem::path& study);

/// Leaves what is known of a job whose results were taken, as STUDY/jobs/NAME.json (batch/job_efficiency.h).
/// @fails  data: the job cannot be read; the document cannot be written.
[[nodiscard]] Result<void> keep_record(const batch::JobFolder& job, const std::filesystem::path& study);

/// Documents of all that there are, finished ones first.   @fails  data: one cannot be read.
[[nodiscard]] Result<std::vector<std::string>> job_documents(const std::filesystem::path& study);

}  // namespace mbk::app
