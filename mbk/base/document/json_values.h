#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "mbk/base/core/linear_algebra.h"

/// Building blocks of every JSON document of mbk.
namespace mbk::document {

using Json = nlohmann::ordered_json;

/// null for an undefined number.
[[nodiscard]] Json number(double value);

[[nodiscard]] Json list(const Vector& values);

inline constexpr int kDigits = 6, kTimeDigits = 9;  ///< of numbers for display only

/// The number rounded to these digits; null if undefined.
[[nodiscard]] Json rounded(double value, int digits);
[[nodiscard]] Json rounded(const Vector& values, int digits = kDigits);

/// [low, high]
[[nodiscard]] Json interval(const std::pair<double, double>& value, double scale = 1.0);

[[nodiscard]] Json rows(const Matrix& matrix);
[[nodiscard]] Json columns(const Matrix& matrix);
[[nodiscard]] Json rounded_columns(const Matrix& matrix, int digits = kDigits);

/// "mbk 1.0.0"
[[nodiscard]] std::string software();

/// {"schema": schema, "software": software()}
[[nodiscard]] Json header(const std::string& schema);

/// As text that ends with a line break. File and channel names may contain bytes that are not UTF-8, which JSON does
/// not allow: each becomes U+FFFD.
[[nodiscard]] std::string dumped(const Json& json);

/// The same without blanks and line breaks.
[[nodiscard]] std::string compact(const Json& json);

/// A schema that also allows null.
[[nodiscard]] Json nullable(Json schema);

/// The schema of a number that may be undefined.
[[nodiscard]] Json value_schema();

[[nodiscard]] Json object_schema(const std::string& meaning, Json properties, Json required);

/// A whole schema: draft 7, with its definitions.
[[nodiscard]] Json document_schema(const std::string& title, const Json& object, const Json& definitions);

}  // namespace mbk::document
