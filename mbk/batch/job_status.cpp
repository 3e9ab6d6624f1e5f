#include "mbk/batch/job_status.h"

#include "mbk/base/core/vector4.h"

namespace mbk::batch {

using document::Fields;

void describe(Fields<Job>& fields) {
  fields.type("Job", "job.json in the folder of a job started with --engine.");
  fields.constant("schema", "mbk.job/1");
  fields.add("id", &Job::id, "SHA-256 of everything that a result depends on, and of the units");
  fields.add("title", &Job::title);
  fields.add("kind", &Job::kind, "kind of work: \"measure\", \"simulate\"");
  fields.add("program", &Job::program, "required version and build of mbk");
  fields.add_form<Simd>(
      "simd", [](const Job& job) { return document::Json(job.simd); }, "minimum instruction set of the processors");
  fields.add("units", &Job::units);
  fields.add("chunks", &Job::chunks);
  fields.add("memory_mb", &Job::memory_mb);
  fields.add_as(
      "specification", {{"type", "object"}, {"additionalProperties", true}},
      [](const Job& job) { return document::Json::parse(job.specification); }, "specification, as the kind defines it");
}

void describe(Fields<JobState>& fields) {
  fields.type("JobState", "Output of `mbk work FOLDER --status --json`, and each line of a job's progress.jsonl.");
  fields.constant("schema", "mbk.job_state/1");
  fields.add("chunks", &JobState::chunks);
  fields.add("finished", &JobState::finished);
  fields.add("running", &JobState::running);
  fields.add("waiting", &JobState::waiting);
  fields.add("given_up", &JobState::given_up, "chunks whose processes always ended without a result");
  fields.add("units", &JobState::units);
  fields.add("finished_units", &JobState::finished_units);
  fields.add("failed_units", &JobState::failed_units);
  fields.add_number("elapsed_s", &JobState::elapsed_s);
  fields.add_number("units_per_s", &JobState::units_per_s, "0: unknown");
  fields.add_number("left_s", &JobState::left_s, "estimated; 0: unknown");
  fields.add("losses", &JobState::losses, "processes that ended without a result, by reason");
  fields.add_unless_empty("trouble", &JobState::trouble);
}

void describe(Fields<FinishedTask>& fields) {
  fields.add("chunk", &FinishedTask::chunk);
  fields.add("host", document::through(&FinishedTask::end, &ShardEnd::host));
  fields.add("units", document::through(&FinishedTask::end, &ShardEnd::units));
  fields.add("failed", document::through(&FinishedTask::end, &ShardEnd::failed));
  fields.add_number("expected_s", &FinishedTask::expected_s);
  fields.add_number("wall_s", document::through(&FinishedTask::end, &ShardEnd::wall_s));
  fields.add_number("cpu_s", document::through(&FinishedTask::end, &ShardEnd::cpu_s));
}

void describe(Fields<JobStatus>& fields) {
  fields.with(&JobStatus::state);
  fields.add("folder", &JobStatus::folder);
  fields.add("title", &JobStatus::title);
  fields.add("tasks", &JobStatus::tasks, "finished tasks, by chunk");
}

namespace {

struct StudyStatus {
  std::span<const JobStatus> jobs;
};

void describe(Fields<StudyStatus>& fields) {
  fields.type("StudyStatus", "Output of `mbk study status --json`.");
  fields.constant("schema", "mbk.study_status/1");
  fields.add("jobs", &StudyStatus::jobs);
}

}  // namespace

Result<JobStatus> status_of(const JobFolder& folder) {
  const JobState state = MBK_TRY(state_of(folder));
  return JobStatus{folder.folder().string(), folder.job().title, state, MBK_TRY(finished_tasks(folder))};
}

std::string to_json(const JobState& state) {
  return document::compact(document::written(state));
}

std::string to_json(std::span<const JobStatus> jobs) {
  return document::document(StudyStatus{jobs});
}

void add_schemas(document::Schemas& schemas) {
  schemas["job"] = document::schema_of<Job>();
  schemas["job_state"] = document::schema_of<JobState>();
  schemas["study_status"] = document::schema_of<StudyStatus>();
}

}  // namespace mbk::batch
