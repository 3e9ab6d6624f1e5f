#pragma once

// Shared by all fuzz targets. A target is a file <name>_fuzz.cpp with LLVMFuzzerTestOneInput and preferably `seeds`.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/model/trial/recording.h"

namespace mbk::fuzz {

/// Small valid inputs to start from. A target without its own definition starts without inputs.
std::vector<std::string> seeds();

/// A recording of two axes with metadata and an event, for writing in any format.
Recording small_recording();

/// Prints the violated condition and aborts.
void require(bool holds, std::string_view what);

/// A line for people: not empty, UTF-8, no control characters.
void require_line(std::string_view line, std::string_view what);
void require_error(const Error& error);

/// Checks the result of a decoder for an input of this size: an error is one line; contents are bounded by the input,
/// and so is the result of `assemble`, automatically and with a map.
void check_decoded(Result<recording::Contents> decoded, std::size_t input_size);

inline std::span<const std::byte> bytes_of(const std::uint8_t* data, std::size_t size) {
  return std::as_bytes(std::span(data, size));
}
inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Writes seeds() to files 0, 1, 2, … of a folder, which it creates. False on failure.
bool write_seeds(const std::string& folder);

}  // namespace mbk::fuzz
