#pragma once

// Bytes of MAT v4 and v5 files that the tests write themselves.

#include <zlib.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::recording::test {

template <class Value>
std::string raw(Value value, bool big_endian = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big_endian != (std::endian::native == std::endian::big)) bytes = {bytes.rbegin(), bytes.rend()};
  return bytes;
}

inline std::string doubles(const Matrix& values, bool big_endian = false) {
  std::string bytes;
  for (const double value : values.reshaped()) bytes += raw(value, big_endian);
  return bytes;
}

/// A MAT v4 variable.
inline std::string mat4(std::string_view name, const Matrix& values, bool big_endian = false) {
  const auto word = [&](std::size_t n) { return raw(static_cast<std::uint32_t>(n), big_endian); };
  return word(big_endian ? 1000 : 0) + word(static_cast<std::size_t>(values.rows())) +
         word(static_cast<std::size_t>(values.cols())) + word(0) + word(name.size() + 1) + std::string(name) + '\0' +
         doubles(values, big_endian);
}

inline std::string element5(std::uint32_t type, std::string data, bool big_endian = false) {
  const std::string tag = raw(type, big_endian) + raw(static_cast<std::uint32_t>(data.size()), big_endian);
  if (type != 15) data.resize((data.size() + 7) / 8 * 8);
  return tag + data;
}

/// A MAT v5 variable of class double; other classes and data by the arguments.
inline std::string matrix5(std::string_view name, std::vector<std::int32_t> dimensions, const std::string& data,
                           std::uint32_t array_class = 6, bool big_endian = false) {
  std::string sizes;
  for (const std::int32_t d : dimensions) sizes += raw(d, big_endian);
  return element5(14,
                  element5(6, raw(array_class, big_endian) + raw(std::uint32_t{0}), big_endian) +
                      element5(5, sizes, big_endian) + element5(1, std::string(name), big_endian) + data,
                  big_endian);
}

inline std::string double5(std::string_view name, const Matrix& values, bool big_endian = false) {
  return matrix5(name, {static_cast<std::int32_t>(values.rows()), static_cast<std::int32_t>(values.cols())},
                 element5(9, doubles(values, big_endian), big_endian), 6, big_endian);
}

/// A v5 structure of one element.
inline std::string struct5(std::string_view name, const std::vector<std::pair<std::string, std::string>>& fields) {
  std::string names, values;
  for (const auto& [field, value] : fields) {
    std::string padded = field;
    padded.resize(16);
    names += padded;
    values += value;
  }
  return matrix5(name, {1, 1}, element5(5, raw(std::int32_t{16})) + element5(1, names) + values, 2);
}

inline std::string header5(bool big_endian = false) {
  std::string header = "MATLAB 5.0 MAT-file, of a test";
  header.resize(124, ' ');
  return header + (big_endian ? std::string("\x01\0MI", 4) : std::string("\0\x01IM", 4));
}

inline std::string compressed5(const std::string& variable) {
  uLongf size = compressBound(variable.size());
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(variable.data()),
           variable.size());
  packed.resize(size);
  return element5(15, packed);
}

/// A 19-row logs matrix: entry (r, k) is r + k/1000, and row 1 a clock of 1 kHz.
inline Matrix logs(Index samples) {
  Matrix values(19, samples);
  for (Index k = 0; k < samples; ++k) {
    for (Index r = 0; r < 19; ++r) values(r, k) = static_cast<double>(r + 1) + static_cast<double>(k) / 1000.0;
    values(0, k) = static_cast<double>(k) / 1000.0;
  }
  return values;
}

}  // namespace mbk::recording::test
