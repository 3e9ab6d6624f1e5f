#include "mbk/files/recording/named_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/base/core/natural_order.h"
#include "mbk/base/system/files.h"
#include "mbk/files/recording/formats.h"
#include "mbk/files/recording/in_memory.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {
namespace {

namespace fs = std::filesystem;

bool is_recording(const fs::directory_entry& entry) {
  std::error_code ignored;
  std::string extension = entry.path().extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const std::vector<std::string_view> known = format_extensions();
  return entry.is_regular_file(ignored) && !entry.path().filename().string().starts_with('.') &&
         std::ranges::find(known, extension) != known.end();
}

std::vector<fs::path> sorted(std::vector<fs::path> files) {
  std::ranges::sort(files,
                    [](const fs::path& a, const fs::path& b) { return in_natural_order(a.string(), b.string()); });
  return files;
}

Result<std::vector<fs::path>> files_in(const fs::path& folder) {
  const auto set = open(folder);
  if (set && !trials_of(**set).empty()) return std::vector<fs::path>{folder};  // a BIDS data set
  std::vector<fs::path> files;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), last; !code && entry != last; entry.increment(code)) {
    if (is_recording(*entry)) files.push_back(entry->path());
  }
  if (code) return bad_data("the folder cannot be read: " + code.message(), "check its permissions", folder.string());
  if (files.empty()) {
    return bad_data(
        fmt::format("the folder contains no recording ({})", fmt::join(format_extensions(), " ")),
        fmt::format("name the files, or a pattern in quotes such as '{}'", (folder / "*" / "*.mat").string()),
        folder.string());
  }
  return sorted(std::move(files));
}

Result<std::vector<fs::path>> files_like(const std::string& pattern) {
  std::vector<fs::path> files;
  for (fs::path& path : system::matching(pattern)) {
    std::error_code ignored;
    if (!fs::is_directory(path, ignored)) files.push_back(std::move(path));
  }
  if (files.empty()) return bad_data("no file matches this pattern", "check it with 'ls'", pattern);
  return sorted(std::move(files));
}

Result<std::vector<fs::path>> files_of(const fs::path& typed) {
  std::error_code ignored;
  if (held_recording(typed)) return std::vector<fs::path>{typed};
  if (fs::is_directory(typed, ignored)) return files_in(typed);
  const bool pattern = typed.string().find_first_of("*?[") != std::string::npos;
  return pattern && !fs::exists(typed, ignored) ? files_like(typed.string()) : std::vector<fs::path>{typed};
}

}  // namespace

Result<std::vector<std::filesystem::path>> named_files(const std::vector<std::filesystem::path>& typed) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& one : typed) {
    const auto more = MBK_TRY(files_of(one));
    files.insert(files.end(), more.begin(), more.end());
  }
  return files;
}

}  // namespace mbk::recording
