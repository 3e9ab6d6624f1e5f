#include "apps/mbk/options/report_file.h"

#include <iterator>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/chart_format.h"
#include "mbk/files/recording/write_file.h"
#include "mbk/measure/analyse/posture.h"
#include "mbk/present/report/html.h"

namespace mbk::app {
std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string command_line(std::span<const std::string> words) {
  std::string line = "mbk";
  for (const std::string& word : words) line += " " + shell_word(word);
  return line;
}

result::RecordingFacts facts_of(const Recording& recording, const Identification& identification, std::size_t which) {
  const Preparation& how = identification.preparations[which];
  return {recording.metadata, analyse::posture(recording, how.from_s, how.to_s)};
}

std::string report_json(const std::string& typed, const std::string& note,
                        const std::vector<result::RecordingFacts>& facts, const std::vector<Measurement>& measured,
                        const std::vector<std::optional<Diagnostics>>& diagnostics, const SeveralTrials* together) {
  result::Report report{{}, together == nullptr ? std::nullopt : std::optional(*together), typed, note};
  auto next = facts.begin();
  for (std::size_t k = 0; k < measured.size(); ++k) {
    const Measurement& one = measured[k];
    result::ReportedResult reported{one, {}, diagnostics[k]};
    const auto count = std::ssize(one.identification.preparations);
    reported.recordings.assign(next, next + count);
    next += count;
    report.results.push_back(std::move(reported));
  }
  return result::to_json(report);
}

Result<void> write_page(const ReportArguments& arguments, const OutputArguments& output, std::string_view report_json,
                        const report::StaticReport& plain, const std::vector<std::filesystem::path>& sources) {
  std::string page = MBK_TRY(report::page(report_json, plain));
  if (is_pdf(*arguments.file)) page = MBK_TRY(page_as_pdf(page));
  MBK_TRY(recording::write_derived(*arguments.file, output.to.overwrite, page, sources));
  say_written(arguments.file->string(), output.quiet);
  return {};
}

}  // namespace mbk::app
