#include "mbk/batch/engine.h"

#include <fmt/format.h>

#include <fstream>

#include "mbk/base/core/printable.h"
#include "mbk/batch/engines.h"

namespace mbk::batch {

std::vector<std::string> work_command(const JobFolder& folder, const EngineOptions& options) {
  return {options.program.string(), "work", folder.folder().string(), "--heartbeat",
          fmt::format("{:g}", options.heartbeat_s)};
}

Result<std::unique_ptr<Engine>> make_engine(const JobFolder& folder, const EngineOptions& options) {
  if (options.kind == EngineKind::slurm) return make_slurm_engine(folder, options);
  return make_local_engine(folder, options);
}

Result<std::int64_t> max_chunks(const EngineOptions& options) {
  if (options.kind != EngineKind::slurm) return kMaxChunks;
  const auto size = max_array_size();
  return size ? Result<std::int64_t>(std::min(*size, kMaxChunks)) : size;
}

std::string last_line(const std::filesystem::path& log) {
  constexpr std::streamoff kTail = 4096;
  std::ifstream stream(log, std::ios::binary | std::ios::ate);
  if (!stream) return "";
  const std::streamoff size = stream.tellg();
  stream.seekg(std::max<std::streamoff>(0, size - kTail));
  std::string line, last;
  while (std::getline(stream, line)) {
    if (line.find_first_not_of(" \r\t-=") != std::string::npos) last = line;  // a line of dashes says nothing
  }
  return printable(last);
}

std::string why_of_process(int code, const std::filesystem::path& log) {
  constexpr int kSignals = 128;
  if (code > kSignals) return fmt::format("killed by signal {}", code - kSignals);
  const std::string line = last_line(log);
  return fmt::format("exit code {}{}{}", code, line.empty() ? "" : ": ", line);
}

}  // namespace mbk::batch
