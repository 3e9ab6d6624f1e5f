#pragma once

// Bytes of NumPy files that the tests write themselves.

#include <zip.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mbk::recording::test {

/// The bytes of a number, as this processor has them.
template <class Value>
std::string raw(Value value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

/// @param type, shape  as Python writes them
inline std::string npy(std::string_view type, std::string_view shape, std::string_view data, bool fortran_order = false,
                       char major = 1) {
  std::string header = "{'descr': " + std::string(type) + ", 'fortran_order': " + (fortran_order ? "True" : "False") +
                       ", 'shape': " + std::string(shape) + ", }\n";
  const auto length = static_cast<std::uint32_t>(header.size());
  const std::string size = major == 1 ? raw(static_cast<std::uint16_t>(length)) : raw(length);
  return std::string("\x93NUMPY") + major + '\0' + size + header + std::string(data);
}

/// An archive whose members are deflated.
inline std::string npz(const std::vector<std::pair<std::string, std::string>>& members) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const source = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_t* const archive = zip_open_from_source(source, ZIP_TRUNCATE, &error);
  if (archive == nullptr) std::abort();
  zip_source_keep(source);
  for (const auto& [name, bytes] : members) {
    zip_file_add(archive, name.c_str(), zip_source_buffer(archive, bytes.data(), bytes.size(), 0), 0);
  }
  zip_close(archive);
  zip_stat_t about;
  zip_source_stat(source, &about);
  std::string bytes(about.size, '\0');
  zip_source_open(source);
  zip_source_read(source, bytes.data(), bytes.size());
  zip_source_close(source);
  zip_source_free(source);
  return bytes;
}

}  // namespace mbk::recording::test
