#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "mbk/files/contents/utf16.h"
#include "mbk/files/hdf5/deflate.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/mat_variables.h"

namespace mbk::recording {
namespace {

// Types of data elements.
constexpr std::uint32_t kInt8 = 1, kUint16 = 4, kInt32 = 5, kUint32 = 6, kDouble = 9, kMatrix = 14, kCompressed = 15;
// Classes of arrays.
constexpr std::uint32_t kCellClass = 1, kStructClass = 2, kCharClass = 4, kDoubleClass = 6;

constexpr std::uint64_t kLargest = std::uint64_t{1} << 31;  ///< [bytes], since sizes within a v5 file have 32 bits

/// Numbers in the byte order of this machine; the header says which that is.
template <class Number>
std::string raw(const Number* numbers, std::size_t count) {
  std::string bytes(count * sizeof(Number), '\0');
  if (count > 0) std::memcpy(bytes.data(), numbers, bytes.size());
  return bytes;
}

template <class Number>
std::string raw(Number number) {
  return raw(&number, 1);
}

std::string element(std::uint32_t type, const std::string& data) {
  const auto size = static_cast<std::uint32_t>(data.size());
  std::string bytes;
  if (size >= 1 && size <= 4 && type != kMatrix) {  // the data are in the tag itself
    bytes = raw((size << 16) | type) + data;
  } else {
    bytes.reserve(data.size() + 16);
    bytes = raw(type) + raw(size);
    bytes += data;
  }
  if (type != kCompressed) bytes.append((8 - bytes.size() % 8) % 8, '\0');
  return bytes;
}

std::string matrix(const std::string& name, std::uint32_t array_class, std::size_t rows, std::size_t columns,
                   const std::string& content) {
  const std::int32_t size[] = {static_cast<std::int32_t>(rows), static_cast<std::int32_t>(columns)};
  const std::uint32_t flags[] = {array_class, 0};
  return element(kMatrix,
                 element(kUint32, raw(flags, 2)) + element(kInt32, raw(size, 2)) + element(kInt8, name) + content);
}

std::string encoded(const std::string& name, const Matrix& values) {
  return matrix(name, kDoubleClass, static_cast<std::size_t>(values.rows()), static_cast<std::size_t>(values.cols()),
                element(kDouble, raw(values.data(), static_cast<std::size_t>(values.size()))));
}

std::string encoded(const std::string& name, const std::string& text) {
  const std::u16string units = utf16_from_utf8(text);
  return matrix(name, kCharClass, units.empty() ? 0 : 1, units.size(),
                element(kUint16, raw(units.data(), units.size())));
}

std::string encoded(const std::string& name, const MatVariable::Cells& cells) {
  std::string content;
  for (const std::string& cell : cells) content += encoded("", cell);
  return matrix(name, kCellClass, cells.size(), 1, content);
}

std::string encoded(const std::string& name, const MatVariable::Structure& fields) {
  std::size_t longest = 0;
  for (const MatVariable& field : fields) longest = std::max(longest, field.name.size());
  const std::size_t length = longest < 32 ? 32 : 64;
  std::string names, values;
  for (const MatVariable& field : fields) {
    names += field.name;
    names.resize((names.size() / length + 1) * length);
    values += std::visit([](const auto& value) { return encoded("", value); }, field.value);
  }
  return matrix(name, kStructClass, 1, 1,
                element(kInt32, raw(static_cast<std::int32_t>(length))) + element(kInt8, names) + values);
}

std::string header() {
  std::string text = "MATLAB 5.0 MAT-file, written by mbk";
  text.resize(kMatHeaderText, ' ');
  text.append(8, '\0');  // no data of subsystems
  return text + raw(std::uint16_t{0x0100}) + raw(static_cast<std::uint16_t>('M' << 8 | 'I'));
}

}  // namespace

Result<std::string> encode_mat_level5(const Recording& recording) {
  if (static_cast<std::uint64_t>(recording.samples()) * kLogsRows * sizeof(double) >= kLargest) {
    return bad_data(fmt::format("{} samples are too many for a MAT v5 file", recording.samples()),
                    "write it as MAT v7.3 or HDF5");
  }
  const auto variables = MBK_TRY(mat_variables(recording));
  return encode_mat_level5(variables);
}

Result<std::string> encode_mat_level5(const std::vector<MatVariable>& variables) {
  std::string file = header();
  for (const MatVariable& variable : variables) {
    if (const auto* const matrix = std::get_if<Matrix>(&variable.value);
        matrix != nullptr && static_cast<std::uint64_t>(matrix->size()) * sizeof(double) >= kLargest) {
      return bad_data(fmt::format("{}×{} numbers of '{}' are too many for a MAT v5 file", matrix->rows(),
                                  matrix->cols(), variable.name),
                      "write it as MAT v7.3 or HDF5");
    }
    file += element(
        kCompressed,
        hdf5::deflated(std::visit([&](const auto& value) { return encoded(variable.name, value); }, variable.value)));
  }
  return file;
}

}  // namespace mbk::recording
