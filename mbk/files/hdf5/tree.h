#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/rests.h"

namespace mbk::hdf5 {

/// How numbers are stored in a file; in memory they are doubles.
enum class Stored { float64, float32, int8, uint8, int16, uint16, int32, uint32, int64, uint64 };

/// Numbers in the order of the file: the last dimension runs fastest.
struct Numbers {
  Vector values;
  Stored stored = Stored::float64;
  Rests rests = {};  ///< of integers of 64 bits
};

using Texts = std::vector<std::string>;  ///< UTF-8, without the padding of strings of fixed length

/// Other objects of the same file, by their paths ("/#refs#/a"); "" is the null reference.
struct References {
  std::vector<std::string> paths;
};

/// Description of something that this library does not read: "of an opaque type", "compressed with filter 32001".
struct Unread {
  std::string what;
  bool damaged = false;  ///< its bytes are contradictory or missing: `what` describes how, as a sentence
};

/// Contents of a dataset or an attribute.
struct Value {
  std::vector<std::uint64_t> shape;  ///< slowest dimension first, as HDF5 counts; empty: a single value
  std::variant<Numbers, Texts, References, Unread> data;
};

/// A text by itself.
[[nodiscard]] inline Value one_text(std::string text) {
  return {{}, Texts{std::move(text)}};
}

using Attributes = std::map<std::string, Value>;

struct Dataset {
  Value value;
  Attributes attributes;
};

/// A folder of a file with its contents; or a table (a dataset of a compound type) with its columns.
struct Group {
  Attributes attributes;
  std::map<std::string, Dataset> datasets;
  std::map<std::string, Group> groups;
  std::vector<std::string> columns = {};  ///< of a table: their names in the order of the file; empty for a folder
  std::string damage = {};                ///< why parts of it may be missing, as a sentence; "" if it is intact
};

}  // namespace mbk::hdf5
