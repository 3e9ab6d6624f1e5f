#include "apps/mbk/commands/study_jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <system_error>

#include "mbk/batch/job_efficiency.h"
#include "mbk/files/recording/write_file.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> entries_of(const fs::path& study) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (auto at = fs::directory_iterator(study / "jobs", error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    entries.push_back(at->path());
  }
  std::ranges::sort(entries);
  return entries;
}

/// "measure-73e909d868c8.json", or with a number where there is one already.
fs::path new_record(const fs::path& jobs, const batch::JobFolder& job) {
  constexpr std::size_t kDigits = 12;
  const std::string stem = fmt::format("{}-{}", job.job().kind, job.job().id.substr(0, kDigits));
  std::error_code ignored;
  fs::path file = jobs / (stem + ".json");
  for (int k = 2; fs::exists(file, ignored); ++k) file = jobs / fmt::format("{}-{}.json", stem, k);
  return file;
}

}  // namespace

std::vector<fs::path> job_folders(const fs::path& study) {
  std::vector<fs::path> folders = entries_of(study);
  std::erase_if(folders, [](const fs::path& one) { return !batch::JobFolder::is_there(one); });
  return folders;
}

Result<void> keep_record(const batch::JobFolder& job, const fs::path& study) {
  const auto efficiency = MBK_TRY(batch::job_efficiency(job));
  const fs::path jobs = study / "jobs";
  std::error_code error;
  fs::create_directories(jobs, error);
  if (error) return bad_data(error.message(), "check the permissions of the study", jobs.string());
  return recording::write_file(new_record(jobs, job), false, batch::to_json(efficiency), Readers::owner);
}

Result<std::vector<std::string>> job_documents(const fs::path& study) {
  std::vector<std::string> documents;
  for (const fs::path& file : entries_of(study)) {
    if (file.extension() != ".json") continue;
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) return bad_data("cannot be read", "check its permissions", file.string());
    documents.push_back(text.str());
  }
  for (const fs::path& folder : job_folders(study)) {
    const auto job = MBK_TRY(batch::JobFolder::open(folder));
    const auto efficiency = MBK_TRY(batch::job_efficiency(job));
    documents.push_back(batch::to_json(efficiency));
  }
  return documents;
}

}  // namespace mbk::app
