#pragma once

#include <span>
#include <string>
#include <vector>

#include "mbk/base/document/fields.h"
#include "mbk/batch/merge.h"
#include "mbk/batch/run.h"

/// Jobs, and how far they are, as JSON. For the sources of this project only.
namespace mbk::batch {

/// A job with the tasks that are finished.
struct JobStatus {
  std::string folder, title;
  JobState state;
  std::vector<FinishedTask> tasks;  ///< by chunk
};

/// Of job.json: schema "mbk.job/1".
void describe(document::Fields<Job>& fields);

/// @fails  data: the job cannot be read.
[[nodiscard]] Result<JobStatus> status_of(const JobFolder& folder);

/// Schema "mbk.study_status/1".
[[nodiscard]] std::string to_json(std::span<const JobStatus> jobs);

/// Adds the schemas of a job, of its state and of the status of several.
void add_schemas(document::Schemas& schemas);

}  // namespace mbk::batch
