#pragma once

// What every fuzz target shares. A target is a file <name>_fuzz.cpp with LLVMFuzzerTestOneInput and, better, `seeds`.

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

/// Valid small inputs to begin from. A target without a definition of its own begins from nothing.
std::vector<std::string> seeds();

/// A recording of two axes with metadata and an event, to be written in any format.
Recording small_recording();

/// Says what does not hold, and aborts.
void require(bool holds, std::string_view what);

/// A line for people: not empty, UTF-8, no control characters.
void require_line(std::string_view line, std::string_view what);
void require_error(const Error& error);

/// What must hold of whatever a decoder made of so many bytes: an error is one line; contents are bounded by the input,
/// and so is what `assemble` makes of them, by itself and with a map.
void check_decoded(Result<recording::Contents> decoded, std::size_t input_size);

inline std::span<const std::byte> bytes_of(const std::uint8_t* data, std::size_t size) {
  return std::as_bytes(std::span(data, size));
}
inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Writes seeds() to files 0, 1, 2, … of a folder, which it makes. False where it could not.
bool write_seeds(const std::string& folder);

}  // namespace mbk::fuzz
