// Chunks as the tasks of job arrays of Slurm.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

#include "mbk/base/core/printable.h"
#include "mbk/base/system/command_output.h"
#include "mbk/batch/engines.h"
#include "mbk/files/contents/sha256.h"

namespace mbk::batch {
namespace {

/// For a shell: 'a b'.
std::string shell_quoted(const std::string& word) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-_./=:,@+").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, plain)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

namespace fs = std::filesystem;

constexpr double kAnswer = 60.0;  // [s] until a controller must have answered

/// Runs a command of Slurm.
Result<std::string> ask(const std::vector<std::string>& command) {
  const auto said = MBK_TRY(system::command_output(command, kAnswer));
  if (said.code == 0) return said.out;
  const auto begin = said.error.find("error: ");  // warnings and news may stand before it
  const auto line = said.error.substr(begin == std::string::npos ? 0 : begin);
  const auto cause = line.substr(0, line.find('\n'));
  if (command.front() == "scontrol") {
    return bad_data(fmt::format("Slurm did not answer ('scontrol': {})",
                                cause.empty() ? fmt::format("exit code {}", said.code) : cause),
                    "run this on the cluster, or use --engine local");
  }
  const bool unreachable = cause.empty() || cause.find("ontact") != std::string::npos ||
                           cause.find("onnection") != std::string::npos || cause.find("imed out") != std::string::npos;
  return bad_data(
      fmt::format("{}: {}", command.front(), cause.empty() ? fmt::format("exit code {}", said.code) : cause),
      unreachable ? "check with 'sinfo' whether the controller answers"
                  : "correct what it names: --partition, --account, --memory-mb, --engine-option or --job-folder");
}

/// Where Slurm is to write what the tasks say. In such a path it replaces what follows a '%', and nothing at all if it
/// holds a backslash.
std::string log_pattern(const JobFolder& folder) {
  std::string pattern;
  for (const char c : folder.logs().string()) pattern += c == '%' ? std::string("%%") : std::string(1, c);
  return pattern + "/%A_%a.txt";
}

/// "0-3,7"
std::string as_ranges(std::vector<std::int64_t> numbers) {
  std::ranges::sort(numbers);
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < numbers.size();) {
    std::size_t end = k;
    while (end + 1 < numbers.size() && numbers[end + 1] == numbers[end] + 1) ++end;
    parts.push_back(end == k ? std::to_string(numbers[k]) : fmt::format("{}-{}", numbers[k], numbers[end]));
    k = end + 1;
  }
  return fmt::format("{}", fmt::join(parts, ","));
}

/// Of "JobState=TIMEOUT" the word behind the sign.
std::string field_of(const std::string& text, const std::string& name) {
  const auto at = text.find(" " + name + "=");
  if (at == std::string::npos) return "";
  const auto begin = at + name.size() + 2;
  return text.substr(begin, text.find_first_of(" \n", begin) - begin);
}

/// By which every process finds the tasks of a job.
std::string name_of(const JobFolder& folder) {
  constexpr std::size_t kDigits = 16;
  const std::string text = folder.job().id + folder.folder().string();
  return "mbk-" + recording::sha256(std::as_bytes(std::span(text))).substr(0, kDigits);
}

class SlurmEngine : public Engine {
 public:
  SlurmEngine(const JobFolder& folder, const EngineOptions& options)
      : folder_(folder), options_(options), name_(name_of(folder)) {}

  Result<std::int64_t> max_chunks() override { return max_array_size(); }

  Result<void> submit(std::span<const std::int64_t> chunks) override {
    MBK_TRY(write_script());
    std::vector<std::string> command = {"sbatch", "--parsable"};
    const std::string limit = options_.tasks > 0 ? fmt::format("%{}", options_.tasks) : "";
    command.push_back("--output=" + log_pattern(folder_));
    command.push_back("--array=" + as_ranges({chunks.begin(), chunks.end()}) + limit);
    if (!options_.partition.empty()) command.push_back("--partition=" + options_.partition);
    if (!options_.account.empty()) command.push_back("--account=" + options_.account);
    command.insert(command.end(), options_.extra.begin(), options_.extra.end());
    command.push_back(script().string());
    const auto said = MBK_TRY(ask(command));
    const std::string id = said.substr(0, said.find_first_of(";\n"));
    for (const std::int64_t chunk : chunks) job_of_[chunk] = id;
    std::ofstream(folder_.folder() / "submitted.txt", std::ios::app)
        << id << " --array=" << as_ranges({chunks.begin(), chunks.end()}) << limit << "\n";
    return {};
  }

  Result<std::map<std::int64_t, Alive>> alive() override {
    // By the name of the job, which also those of an earlier process have.
    const auto said = MBK_TRY(ask({"squeue", "--noheader", "--array", "--name=" + name_, "--format=%F %K %T %r"}));
    std::map<std::int64_t, Alive> all;
    std::istringstream lines(said);
    std::string job, state, why;
    std::int64_t chunk = 0;
    while (lines >> job >> chunk >> state && std::getline(lines, why)) {
      if (state != "PENDING" && state != "RUNNING" && state != "SUSPENDED" && state != "CONFIGURING") continue;
      job_of_[chunk] = job;
      all[chunk] = {state != "PENDING", state == "PENDING" ? why.substr(why.find_first_not_of(' ')) : ""};
    }
    return all;
  }

  void cancel(std::span<const std::int64_t> chunks) override {
    for (const std::int64_t chunk : chunks) {
      const auto job = job_of_.find(chunk);
      if (job != job_of_.end()) std::ignore = ask({"scancel", fmt::format("{}_{}", job->second, chunk)});
    }
  }

  void cancel_all() override {
    std::ignore = ask({"scancel", "--name=" + name_});
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < until) {
      const auto left = ask({"squeue", "--noheader", "--name=" + name_, "--format=%i"});
      if (!left || left->empty()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
  }

  std::string why_ended(std::int64_t chunk) override {
    const auto job = job_of_.find(chunk);
    if (job == job_of_.end()) return "";
    const auto said = ask({"scontrol", "--oneliner", "show", "job", fmt::format("{}_{}", job->second, chunk)});
    const std::string line = last_line(folder_.logs() / fmt::format("{}_{}.txt", job->second, chunk));
    if (!said) return line.empty() ? "the controller no longer knows the task" : line;
    const std::string state = field_of(*said, "JobState"), code = field_of(*said, "ExitCode");
    if (state == "TIMEOUT") longer_ *= 2.0;
    if (state == "OUT_OF_MEMORY") larger_ *= 2.0;
    const auto colon = code.find(':');
    if (colon != std::string::npos && code.substr(colon + 1) != "0") {
      return fmt::format("{}: killed by signal {}", state, code.substr(colon + 1));
    }
    return fmt::format("{}: exit code {}{}{}", state, code.substr(0, colon), line.empty() ? "" : ": ", line);
  }

  double interval_s() const override { return 1.0; }
  double settle_s() const override { return options_.settle_s; }
  bool outlives() const override { return true; }

 private:
  fs::path script() const { return folder_.folder() / "array.sbatch"; }

  /// The script that is submitted; it stays, and can be submitted by hand.
  Result<void> write_script() const {
    const Job& job = folder_.job();
    std::vector<std::string> command;
    for (const std::string& word : work_command(folder_, options_)) command.push_back(shell_quoted(word));
    // Three times what was measured, on the slowest of the machines; and time to start.
    constexpr double kSlower = 3.0, kStart = 300.0;
    const auto minutes =
        static_cast<std::int64_t>(std::ceil((kStart + kSlower * options_.longest_chunk_s) * longer_ / 60.0));
    std::string title = printable(job.title);
    const std::string text = fmt::format(
        "#!/bin/bash\n"
        "# {}: {} units in {} chunks.\n"
        "# By hand: sbatch --output={} --array=0-{} {}\n"
        "#SBATCH --job-name={}\n"
        "#SBATCH --open-mode=append\n"
        "#SBATCH --nodes=1 --ntasks=1 --cpus-per-task=1\n"
        "#SBATCH --mem={}M\n"
        "#SBATCH --time={}\n"
        "exec {} --chunk \"$SLURM_ARRAY_TASK_ID\"\n",
        title, job.units, job.chunks, shell_quoted(log_pattern(folder_)), job.chunks - 1,
        shell_quoted(script().string()), name_,
        static_cast<std::int64_t>(std::ceil(static_cast<double>(options_.memory_mb) * larger_)), minutes,
        fmt::join(command, " "));
    std::ofstream stream(script(), std::ios::binary | std::ios::trunc);
    stream << text;
    stream.close();
    if (!stream) return bad_data("cannot be written", "check the disk and the folder", script().string());
    return {};
  }

  const JobFolder& folder_;
  EngineOptions options_;
  std::string name_;
  std::map<std::int64_t, std::string> job_of_;
  double longer_ = 1.0, larger_ = 1.0;
};

}  // namespace

Result<std::int64_t> max_array_size() {
  const auto said = MBK_TRY(ask({"scontrol", "show", "config"}));
  const auto at = said.find("\nMaxArraySize");
  const auto sign = at == std::string::npos ? at : said.find('=', at);
  const std::int64_t size = sign == std::string::npos ? 0 : std::atoll(said.c_str() + sign + 1);
  if (size < 2) return bad_data("Slurm's controller allows no job arrays", "ask its administrator to set MaxArraySize");
  return size;
}

Result<std::unique_ptr<Engine>> make_slurm_engine(const JobFolder& folder, const EngineOptions& options) {
  // They stand in the comments of a script that a shell runs, which a line break would end.
  for (const std::string& path : {folder.folder().string(), options.program.string()}) {
    const bool control = std::ranges::any_of(path, [](char c) { return (c >= 0 && c < ' ') || c == 0x7F; });
    if (!control && path.find('\\') == std::string::npos) continue;
    return fail(
        ErrorKind::usage,
        fmt::format("Slurm cannot use this path: it contains a {}", control ? "control character" : "backslash"),
        path == options.program.string() ? "install mbk elsewhere" : "name another folder with --job-folder", path);
  }
  return std::make_unique<SlurmEngine>(folder, options);
}

}  // namespace mbk::batch
