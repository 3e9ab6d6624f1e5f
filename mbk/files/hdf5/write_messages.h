#pragma once

#include <string_view>
#include <vector>

#include "mbk/files/hdf5/output.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// What an object header can say.
enum class Says : std::size_t {
  dataspace = 1,
  datatype = 3,
  fill_value = 5,
  layout = 8,
  filters = 11,
  attribute = 12,
  symbol_table = 17
};

/// An object header of version 1: what is said about a group or a dataset.
class HeaderOutput {
 public:
  void add(Says what, Output message);
  [[nodiscard]] Output bytes() &&;

 private:
  Output messages_;
  std::size_t count_ = 0;
};

/// How the texts of a value stand in the file.
enum class Stand {
  variable,  ///< strings of any length, in UTF-8
  fixed,     ///< strings of the length of the longest
  letters,   ///< sequences of strings of one byte, as MATLAB has names of fields
};

[[nodiscard]] Stand stand_of(std::string_view attribute);

[[nodiscard]] bool is_ascii(std::string_view text);

/// Length of the longest text, and at least 1.
[[nodiscard]] std::size_t longest(const Texts& texts);

[[nodiscard]] Output dataspace_message(const std::vector<std::uint64_t>& shape);
[[nodiscard]] Output datatype_message(const Value& value, Stand stand);

}  // namespace mbk::hdf5
