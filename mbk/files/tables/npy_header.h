#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// Numbers of one kind in the elements of a NumPy array.
struct NpyField {
  std::string name;      ///< "" where the array has no fields; "outer.inner" within another
  char kind = 'f';       ///< 'f', 'i', 'u', 'b'; 'M' dates, 'm' durations; 'S', 'U' texts; others are not read
  std::size_t size = 0;  ///< [bytes] of one number
  bool big_endian = false;
  std::size_t offset = 0;   ///< [bytes] in the element
  std::uint64_t count = 1;  ///< numbers in each element
  std::string type;         ///< as in the file: "<f8", "<M8[ns]"
};

/// Contents of the header of a NumPy array.
struct NpyHeader {
  std::vector<NpyField> fields;
  bool structured = false;
  std::size_t element = 0;  ///< [bytes]
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
};

/// Reads the Python literal that the header is, as "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }".
/// @fails  data: it is damaged.
[[nodiscard]] Result<NpyHeader> parse_npy_header(std::string_view text);

}  // namespace mbk::recording
