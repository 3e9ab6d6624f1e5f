#include "mbk/files/recording/trial_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "mbk/base/core/printable.h"

namespace mbk::recording {
namespace {

std::string file_name(std::string trial) {
  std::ranges::replace_if(
      trial, [](char c) { return c == '/' || c == '\\' || static_cast<unsigned char>(c) <= ' '; }, '_');
  return trial == "." || trial == ".." ? "_" : trial;
}

}  // namespace

Result<std::vector<std::filesystem::path>> files_of_trials(const std::filesystem::path& pattern,
                                                           std::span<const std::string> trials) {
  const std::string last = pattern.filename().string();
  const std::size_t at = last.find(kTrialPlace);
  const bool unnamed = trials.size() == 1 && trials.front().empty();
  if (at == last.npos && trials.size() > 1) {
    const std::string example =
        fmt::format("{}_{}{}", pattern.stem().string(), kTrialPlace, pattern.extension().string());
    return bad_usage(
        fmt::format("{} trials would be written to one file", trials.size()),
        fmt::format("put {} in the file name instead of the trial names, as in {}, or select one with --trial",
                    kTrialPlace, (pattern.parent_path() / example).string()));
  }
  if (at == last.npos) return std::vector<std::filesystem::path>(trials.size(), pattern);
  if (unnamed) {
    return bad_usage(fmt::format("the file contains one record, which has no name to replace {}", kTrialPlace),
                     fmt::format("omit {}", kTrialPlace));
  }
  std::vector<std::filesystem::path> files;
  std::set<std::filesystem::path> taken;
  for (const std::string& trial : trials) {
    std::string name = last;
    name.replace(at, kTrialPlace.size(), file_name(printable(trial)));
    files.push_back(pattern.parent_path() / name);
    if (taken.insert(files.back()).second) continue;
    return bad_usage(
        fmt::format("trial '{}' and another trial would both be written to {}", trial, files.back().string()),
        "convert them separately with --trial");
  }
  return files;
}

}  // namespace mbk::recording
