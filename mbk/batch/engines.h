#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "mbk/batch/engine.h"

/// The engines, each in a file of its own; nobody outside of this module sees them.
namespace mbk::batch {

/// A folder of more files than that is slow on most shared disks.
inline constexpr std::int64_t kMaxChunks = 20'000;

[[nodiscard]] std::unique_ptr<Engine> make_local_engine(const JobFolder& folder, const EngineOptions& options);
[[nodiscard]] Result<std::unique_ptr<Engine>> make_slurm_engine(const JobFolder& folder, const EngineOptions& options);

/// MaxArraySize of Slurm's controller.   @fails  as make_engine
[[nodiscard]] Result<std::int64_t> max_array_size();

/// "exit code 3: no space left on the disk": the code, and the last line of the log.
[[nodiscard]] std::string why_of_process(int code, const std::filesystem::path& log);
/// The last line of a text that is not blank.
[[nodiscard]] std::string last_line(const std::filesystem::path& log);

}  // namespace mbk::batch
