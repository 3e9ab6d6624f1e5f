#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "mbk/base/core/linear_algebra.h"

/// What every JSON document of mbk is put together from.
namespace mbk::document {

using Json = nlohmann::ordered_json;

/// null where a number is undefined.
[[nodiscard]] Json number(double value);

[[nodiscard]] Json list(const Vector& values);

inline constexpr int kDigits = 6, kTimeDigits = 9;  ///< of numbers that are there only to be looked at

/// The number with so many digits; null where it is undefined.
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

/// As text that ends with a line end. File and channel names may hold bytes that are not UTF-8, which JSON cannot hold:
/// each becomes U+FFFD.
[[nodiscard]] std::string dumped(const Json& json);

/// The same without blanks and line ends.
[[nodiscard]] std::string compact(const Json& json);

/// A schema that takes null, too.
[[nodiscard]] Json nullable(Json schema);

/// The schema of a number that may be undefined.
[[nodiscard]] Json value_schema();

[[nodiscard]] Json object_schema(const std::string& meaning, Json properties, Json required);

/// A whole schema: draft 7, with its definitions.
[[nodiscard]] Json document_schema(const std::string& title, const Json& object, const Json& definitions);

}  // namespace mbk::document
