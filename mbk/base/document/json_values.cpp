#include "mbk/base/document/json_values.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "mbk/base/core/version.h"

namespace mbk::document {

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json list(const Vector& values) {
  Json array = Json::array();
  for (const double value : values) array.push_back(number(value));
  return array;
}

Json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  const std::string text = fmt::format("{:.{}g}", value, digits);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

Json rounded(const Vector& values, int digits) {
  Json array = Json::array();
  for (const double value : values) array.push_back(rounded(value, digits));
  return array;
}

Json interval(const std::pair<double, double>& value, double scale) {
  return Json::array({number(scale * value.first), number(scale * value.second)});
}

Json rows(const Matrix& matrix) {
  Json array = Json::array();
  for (Index i = 0; i < matrix.rows(); ++i) array.push_back(list(matrix.row(i).transpose()));
  return array;
}

Json columns(const Matrix& matrix) {
  Json array = Json::array();
  for (Index k = 0; k < matrix.cols(); ++k) array.push_back(list(matrix.col(k)));
  return array;
}

Json rounded_columns(const Matrix& matrix, int digits) {
  Json array = Json::array();
  for (Index k = 0; k < matrix.cols(); ++k) array.push_back(rounded(Vector(matrix.col(k)), digits));
  return array;
}

std::string software() {
  return fmt::format("mbk {}", version());
}

Json header(const std::string& schema) {
  return {{"schema", schema}, {"software", software()}};
}

std::string dumped(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string compact(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json nullable(Json schema) {
  const Json null = {{"type", "null"}};
  if (const auto type = schema.find("type"); type != schema.end() && schema.size() == 1) {
    if (type->is_string()) *type = Json::array({*type, "null"});
    return schema;
  }
  if (const auto words = schema.find("enum"); words != schema.end()) {
    words->push_back(nullptr);
    return schema;
  }
  if (schema == Json{{"$ref", "#/definitions/Value"}}) return schema;
  return {{"anyOf", Json::array({std::move(schema), null})}};
}

Json value_schema() {
  return {{"type", {"number", "null"}}, {"description", "A number; null if undefined."}};
}

Json object_schema(const std::string& meaning, Json properties, Json required) {
  Json schema = {{"type", "object"}};
  if (!meaning.empty()) schema["description"] = meaning;
  schema["properties"] = std::move(properties);
  if (!required.empty()) schema["required"] = std::move(required);
  schema["additionalProperties"] = false;
  return schema;
}

Json document_schema(const std::string& title, const Json& object, const Json& definitions) {
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
  schema.update(object);
  schema["definitions"] = definitions;
  return schema;
}

}  // namespace mbk::document
