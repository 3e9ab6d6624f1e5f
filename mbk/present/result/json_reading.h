#pragma once

#include <fmt/format.h>

#include <string>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/nan.h"
#include "mbk/base/document/json_values.h"

/// How documents of mbk are read back. For the sources of this module only.
namespace mbk::result {

using document::Json;

/// What stands in a document and cannot be; thrown within a reading function only.
struct Malformed {
  std::string message;
};

inline bool has_schema(const Json& json, const char* schema) {
  if (!json.is_object()) return false;
  const auto found = json.find("schema");
  return found != json.end() && found->is_string() && *found == schema;
}

inline double number_from(const Json& json) {
  if (json.is_null()) return kNaN;
  if (!json.is_number())
    throw Malformed{fmt::format("a number was expected, but the value has type '{}'", json.type_name())};
  return json.get<double>();
}

inline Matrix matrix_from(const Json& object, const char* name, Index expected_rows, Index expected_columns) {
  const auto found = object.find(name);
  if (found == object.end()) throw Malformed{fmt::format("'{}' is missing", name)};
  const auto wrong = [&] {
    return Malformed{fmt::format("'{}' is not a {}×{} matrix", name, expected_rows, expected_columns)};
  };
  if (!found->is_array() || static_cast<Index>(found->size()) != expected_rows) throw wrong();
  Matrix matrix(expected_rows, expected_columns);
  for (Index i = 0; i < expected_rows; ++i) {
    const Json& row = (*found)[static_cast<std::size_t>(i)];
    // A vector (expected_columns = 1) is written as a plain list.
    if (expected_columns == 1 && !row.is_array()) {
      matrix(i, 0) = number_from(row);
      continue;
    }
    if (!row.is_array() || static_cast<Index>(row.size()) != expected_columns) throw wrong();
    for (Index j = 0; j < expected_columns; ++j) matrix(i, j) = number_from(row[static_cast<std::size_t>(j)]);
  }
  return matrix;
}

inline Vector list_from(const Json& object, const char* name, Index size) {
  return matrix_from(object, name, size, 1);
}

}  // namespace mbk::result
