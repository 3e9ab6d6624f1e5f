#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// Bytes of one number.
[[nodiscard]] std::size_t size_of(Stored stored);

[[nodiscard]] bool is_float(Stored stored);
[[nodiscard]] bool is_signed(Stored stored);

/// The first value that its stored type cannot hold exactly; NaN and infinities fit every floating type.
[[nodiscard]] std::optional<double> first_misfit(const Numbers& numbers);

/// The numbers as they stand in a file, least significant byte first.
[[nodiscard]] std::string bytes_of(const Numbers& numbers);

/// Numbers in pieces of equal size, each shuffled and deflated.
struct Chunks {
  std::vector<std::uint64_t> shape;  ///< of one piece
  struct Piece {
    std::vector<std::uint64_t> offset;  ///< of its first number
    std::string packed;
  };
  std::vector<Piece> pieces;  ///< in the order of the file
};

/// @param shape  not empty, of as many numbers as there are bytes for
[[nodiscard]] Chunks pack(const std::string& bytes, const std::vector<std::uint64_t>& shape, std::size_t size);

}  // namespace mbk::hdf5
