#include "mbk/recording/mat_writer.h"

#include <fmt/format.h>
#include <matio.h>

#include <array>
#include <limits>
#include <memory>

#include "mbk/recording/channel_table.h"
#include "mbk/recording/write_file.h"

namespace mbk::recording {
namespace {

namespace fs = std::filesystem;

Result<Matrix> logs_matrix(const Recording& recording) {
  Matrix logs = Matrix::Constant(kLogsRows, recording.samples(), std::numeric_limits<double>::quiet_NaN());
  logs.row(0) = recording.time.transpose();
  for (const Channel& channel : recording.channels) {
    int row = 0;
    for (const ChannelKind& kind : channel_kinds()) {
      if (kind.name == channel.name) row = kind.logs_row;
    }
    if (row == 0) {
      return bad_usage(fmt::format("channel '{}' has no row in the {}-row logs matrix", channel.name, kLogsRows),
                       "write it in another format, or leave the channel out");
    }
    if (channel.values.size() != recording.samples()) {
      return bad_data(fmt::format("channel '{}' has {} samples, time has {}", channel.name, channel.values.size(),
                                  recording.samples()));
    }
    logs.row(row - 1) = channel.values.transpose();
  }
  return logs;
}

bool write_matrix(const fs::path& file, Matrix& logs) {
  const std::unique_ptr<mat_t, int (*)(mat_t*)> mat(
      Mat_CreateVer(file.c_str(), "MATLAB 5.0 MAT-file, written by mbk", MAT_FT_MAT5), Mat_Close);
  if (!mat) return false;
  std::array<std::size_t, 2> dimensions{static_cast<std::size_t>(logs.rows()), static_cast<std::size_t>(logs.cols())};
  const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(
      Mat_VarCreate("logs", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dimensions.data(), logs.data(), MAT_F_DONT_COPY_DATA),
      Mat_VarFree);
  return variable && Mat_VarWrite(mat.get(), variable.get(), MAT_COMPRESSION_ZLIB) == 0;
}

}  // namespace

Result<void> write_logs(const Recording& recording, const fs::path& file, bool overwrite) {
  if (recording.samples() == 0) return bad_data("a recording without samples is not written", "", file.string());
  constexpr std::uint64_t kLargest = std::uint64_t{1} << 31;  // sizes within a v5 file have 32 bits
  if (static_cast<std::uint64_t>(recording.samples()) * kLogsRows * sizeof(double) >= kLargest) {
    return bad_data(fmt::format("{} samples are too many for a MAT v5 file", recording.samples()),
                    "write it in several parts", file.string());
  }
  auto logs = logs_matrix(recording);
  if (!logs) return tl::unexpected(logs.error().in(file.string()));

  return write_file(file, overwrite, [&](const fs::path& temporary) { return write_matrix(temporary, *logs); });
}

}  // namespace mbk::recording
