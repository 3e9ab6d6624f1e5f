#include "mbk/recording/mat_writer.h"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "mbk/recording/annotations.h"
#include "mbk/recording/channel_table.h"
#include "mbk/recording/utf16.h"
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

using MatVariable = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;
using Metadata = std::map<std::string, std::string>;

/// A matio variable of any class; matio copies the data. nullptr where it has no memory.
matvar_t* create(const char* name, matio_classes array_class, matio_types type, std::array<std::size_t, 2> shape,
                 const void* data) {
  return Mat_VarCreate(name, array_class, type, 2, shape.data(), const_cast<void*>(data), 0);
}

matvar_t* create_text(const std::string& text) {
  const std::u16string units = utf16_from_utf8(text);
  return create(nullptr, MAT_C_CHAR, MAT_T_UINT16, {units.empty() ? 0u : 1u, units.size()}, units.data());
}

MatVariable create_struct(const char* name, const std::vector<const char*>& fields) {
  std::array<std::size_t, 2> one{1, 1};
  return {Mat_VarCreateStruct(name, 2, one.data(), const_cast<const char**>(fields.data()),
                              static_cast<unsigned>(fields.size())),
          Mat_VarFree};
}

MatVariable create_metadata(const Metadata& metadata) {
  std::vector<const char*> keys;
  for (const auto& [key, value] : metadata) keys.push_back(key.c_str());
  MatVariable structure = create_struct("metadata", keys);
  if (!structure) return structure;
  for (const auto& [key, value] : metadata) {
    Mat_VarSetStructFieldByName(structure.get(), key.c_str(), 0, create_text(value));
  }
  return structure;
}

MatVariable create_events(const std::vector<Event>& events) {
  MatVariable structure = create_struct("events", {"time", "name", "value"});
  const std::array<std::size_t, 2> column{events.size(), 1};
  matvar_t* names = create(nullptr, MAT_C_CELL, MAT_T_CELL, column, nullptr);
  if (!structure || names == nullptr) return {nullptr, Mat_VarFree};
  std::vector<double> times, values;
  for (std::size_t k = 0; k < events.size(); ++k) {
    times.push_back(events[k].time);
    values.push_back(events[k].value);
    Mat_VarSetCell(names, static_cast<int>(k), create_text(events[k].name));
  }
  const auto numbers = [&](const std::vector<double>& data) {
    return create(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, column, data.data());
  };
  Mat_VarSetStructFieldByName(structure.get(), "time", 0, numbers(times));
  Mat_VarSetStructFieldByName(structure.get(), "name", 0, names);
  Mat_VarSetStructFieldByName(structure.get(), "value", 0, numbers(values));
  return structure;
}

bool write_variables(const fs::path& file, std::vector<Variable>& variables, const Metadata& metadata,
                     const std::vector<Event>& events) {
  const std::unique_ptr<mat_t, int (*)(mat_t*)> mat(
      Mat_CreateVer(file.c_str(), "MATLAB 5.0 MAT-file, written by mbk", MAT_FT_MAT5), Mat_Close);
  if (!mat) return false;
  const auto write = [&](const MatVariable& data) {
    return data && Mat_VarWrite(mat.get(), data.get(), MAT_COMPRESSION_ZLIB) == 0;
  };
  const bool written = std::ranges::all_of(variables, [&](Variable& variable) {
    Matrix& values = variable.values;
    std::array<std::size_t, 2> shape{static_cast<std::size_t>(values.rows()), static_cast<std::size_t>(values.cols())};
    const MatVariable data(Mat_VarCreate(variable.name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, shape.data(),
                                         values.data(), MAT_F_DONT_COPY_DATA),
                           Mat_VarFree);
    return write(data);
  });
  return written && (metadata.empty() || write(create_metadata(metadata))) &&
         (events.empty() || write(create_events(events)));
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
  const auto metadata = metadata_to_write(recording);
  if (!metadata) return tl::unexpected(metadata.error().in(file.string()));
  std::vector<Variable> variables = variables_of(recording);
  return write_file(file, overwrite, [&](const fs::path& temporary) {
    return write_variables(temporary, variables, *metadata, recording.events);
  });
}

}  // namespace mbk::recording
