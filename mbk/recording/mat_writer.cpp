#include "mbk/recording/mat_writer.h"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "mbk/recording/channel_table.h"
#include "mbk/recording/write_file.h"

namespace mbk::recording {
namespace {

namespace fs = std::filesystem;

struct Variable {
  std::string name;
  Matrix values;
};

/// 1-based row of a channel in `logs`; 0: it has none.
int logs_row(const Channel& channel) {
  const auto kind = std::ranges::find(channel_kinds(), channel.name, &ChannelKind::name);
  return kind == channel_kinds().end() ? 0 : kind->logs_row;
}

std::vector<Variable> variables_of(const Recording& recording) {
  if (std::ranges::all_of(recording.channels, [](const Channel& channel) { return logs_row(channel) > 0; })) {
    Matrix logs = Matrix::Constant(kLogsRows, recording.samples(), std::numeric_limits<double>::quiet_NaN());
    logs.row(0) = recording.time.transpose();
    for (const Channel& channel : recording.channels) logs.row(logs_row(channel) - 1) = channel.values.transpose();
    return {{"logs", std::move(logs)}};
  }
  std::vector<Variable> variables = {{"time", recording.time}};
  for (const Channel& channel : recording.channels) variables.push_back({channel.name, channel.values});
  return variables;
}

bool write_variables(const fs::path& file, std::vector<Variable>& variables) {
  const std::unique_ptr<mat_t, int (*)(mat_t*)> mat(
      Mat_CreateVer(file.c_str(), "MATLAB 5.0 MAT-file, written by mbk", MAT_FT_MAT5), Mat_Close);
  if (!mat) return false;
  return std::ranges::all_of(variables, [&](Variable& variable) {
    Matrix& values = variable.values;
    std::array<std::size_t, 2> shape{static_cast<std::size_t>(values.rows()), static_cast<std::size_t>(values.cols())};
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> data(
        Mat_VarCreate(variable.name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, shape.data(), values.data(),
                      MAT_F_DONT_COPY_DATA),
        Mat_VarFree);
    return data && Mat_VarWrite(mat.get(), data.get(), MAT_COMPRESSION_ZLIB) == 0;
  });
}

}  // namespace

Result<void> write_mat(const Recording& recording, const fs::path& file, bool overwrite) {
  if (recording.samples() == 0) return bad_data("a recording without samples is not written", "", file.string());
  constexpr std::uint64_t kLargest = std::uint64_t{1} << 31;  // sizes within a v5 file have 32 bits
  if (static_cast<std::uint64_t>(recording.samples()) * kLogsRows * sizeof(double) >= kLargest) {
    return bad_data(fmt::format("{} samples are too many for a MAT v5 file", recording.samples()),
                    "write it in several parts", file.string());
  }
  for (const Channel& channel : recording.channels) {
    if (channel.values.size() == recording.samples()) continue;
    return bad_data(fmt::format("channel '{}' has {} samples, time has {}", channel.name, channel.values.size(),
                                recording.samples()),
                    "", file.string());
  }
  std::vector<Variable> variables = variables_of(recording);
  return write_file(file, overwrite, [&](const fs::path& temporary) { return write_variables(temporary, variables); });
}

}  // namespace mbk::recording
