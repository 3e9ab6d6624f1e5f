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

/// Something that this library does not read, in words: "of an opaque type", "packed by filter 32001".
struct Unread {
  std::string what;
  bool damaged = false;  ///< its bytes contradict themselves, or are missing: `what` says how, as a sentence
};

/// What a dataset or an attribute holds.
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

/// A folder of a file, with everything in it; or a table, a dataset of a compound type, whose columns stand in it.
struct Group {
  Attributes attributes;
  std::map<std::string, Dataset> datasets;
  std::map<std::string, Group> groups;
  std::vector<std::string> columns = {};  ///< of a table: their names in the order of the file; empty for a folder
  std::string damage = {};                ///< why something of it may be missing, as a sentence; "" where it is sound
};

}  // namespace mbk::hdf5
