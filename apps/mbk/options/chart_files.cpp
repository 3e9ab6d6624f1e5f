#include "apps/mbk/options/chart_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/mbk/options/output.h"
#include "mbk/base/core/counted.h"

namespace mbk::app {
namespace chart_files {

/// The file's name and its trial, of characters that every system takes in a name.
std::string name_of(const SourceFile& source) {
  std::string name = std::filesystem::path(source.path).stem().string();
  if (!source.trial.empty()) name += "-" + source.trial;
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  std::ranges::replace_if(
      name, [&](char c) { return kPlain.find(c) == std::string_view::npos; }, '_');
  return name;
}

}  // namespace chart_files

Result<void> ChartFiles::check(const std::filesystem::path& folder, const ChartFormat& format, bool overwrite,
                               const std::vector<std::filesystem::path>& inputs,
                               std::initializer_list<const char*> names) {
  MBK_TRY(format.check());
  std::error_code ignored;
  if (!std::filesystem::exists(folder, ignored)) return {};
  if (!std::filesystem::is_directory(folder, ignored)) {
    return fail(ErrorKind::usage, "--charts names a file, not a folder",
                "name a folder; it is created if it does not exist", folder.string());
  }
  for (const std::filesystem::path& input : inputs) {
    for (const char* const name : names) {
      const std::string file = format.file(fmt::format("{}-{}", chart_files::name_of({input.string(), "", ""}), name));
      MBK_TRY(check_new_file(folder / file, "--charts", overwrite, {}));
    }
  }
  return {};
}

Result<ChartFiles> ChartFiles::in(const std::filesystem::path& folder, const ChartFormat& format, bool overwrite,
                                  std::vector<std::filesystem::path> sources) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(ErrorKind::usage, error.message(), "name a folder that can be created", folder.string());
  ChartFiles files;
  files.folder_ = folder;
  files.format_ = format;
  files.sources_ = std::move(sources);
  files.overwrite_ = overwrite;
  return files;
}

Result<void> ChartFiles::write(const SourceFile& source, const std::vector<report::NamedChart>& charts) {
  const std::string name = chart_files::name_of(source);
  std::string unique = name;
  for (int k = 2; std::ranges::find(begun_, unique) != begun_.end(); ++k) unique = fmt::format("{}-{}", name, k);
  begun_.push_back(unique);
  for (const report::NamedChart& one : charts) {
    MBK_TRY(write({fmt::format("{}-{}", unique, one.name), one.chart, one.beside}));
  }
  return {};
}

Result<void> ChartFiles::write(const report::NamedChart& chart) {
  MBK_TRY(format_.write(folder_ / format_.file(chart.name), chart, overwrite_, sources_));
  ++written_;
  return {};
}

void ChartFiles::say_written(bool quiet) const {
  app::say_written(fmt::format("{} to {}", counted(written_, "chart", "charts"), folder_.string()), quiet);
}

}  // namespace mbk::app
