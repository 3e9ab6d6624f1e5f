#include "tests/support/schemas.h"

#include <fmt/format.h>
#include <rapidjson/document.h>
#include <rapidjson/schema.h>
#include <rapidjson/stringbuffer.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>

namespace mbk::schemas {
namespace {

using Json = nlohmann::json;

/// What RapidJSON holds documents to, and what it need not know; it ignores any other keyword without a word.
const std::set<std::string, std::less<>> kHeld = {"type",     "enum",     "required", "additionalProperties",
                                                  "minItems", "maxItems", "minimum",  "maximum",
                                                  "items",    "anyOf",    "oneOf",    "properties"};
const std::set<std::string, std::less<>> kSaid = {"$schema", "title", "description", "definitions"};

/// The schema with what it refers to in place of each reference, which RapidJSON would ignore where it is not found.
Json expanded(const Json& schema, const Json& whole, const std::string& in) {
  if (!schema.is_object()) return schema;  // additionalProperties: false
  if (const auto reference = schema.find("$ref"); reference != schema.end()) {
    return expanded(whole.at(Json::json_pointer(reference->get<std::string>().substr(1))), whole, in);
  }
  Json made = Json::object();
  for (const auto& [key, value] : schema.items()) {
    if (kSaid.contains(key)) continue;
    if (!kHeld.contains(key)) throw std::runtime_error(fmt::format("{}: nothing checks '{}'", in, key));
    if (key == "properties") {
      made[key] = Json::object();
      for (const auto& [name, property] : value.items()) made[key][name] = expanded(property, whole, in);
    } else if (key == "anyOf" || key == "oneOf") {
      for (const Json& one : value) made[key].push_back(expanded(one, whole, in));
    } else if (key == "items" || key == "additionalProperties") {
      made[key] = expanded(value, whole, in);
    } else {
      made[key] = value;
    }
  }
  return made;
}

const rapidjson::SchemaDocument& schema(const std::string& name) {
  static std::map<std::string, std::unique_ptr<rapidjson::SchemaDocument>> schemas;
  auto& found = schemas[name];
  if (!found) {
    std::ifstream stream(std::filesystem::path(MBK_SCHEMAS) / (name + ".schema.json"));
    if (!stream) throw std::runtime_error(fmt::format("there is no schema {}", name));
    const Json whole = Json::parse(stream);
    rapidjson::Document document;
    document.Parse(expanded(whole, whole, name).dump().c_str());
    found = std::make_unique<rapidjson::SchemaDocument>(document);
  }
  return *found;
}

}  // namespace

testing::AssertionResult fits(std::string_view document, const std::string& name) {
  rapidjson::Document read;
  read.Parse(document.data(), document.size());
  if (read.HasParseError()) return testing::AssertionFailure() << "no JSON, byte " << read.GetErrorOffset();
  rapidjson::SchemaValidator validator(schema(name));
  if (read.Accept(validator)) return testing::AssertionSuccess();
  rapidjson::StringBuffer where;
  validator.GetInvalidDocumentPointer().StringifyUriFragment(where);
  return testing::AssertionFailure() << name << ".schema.json: '" << validator.GetInvalidSchemaKeyword()
                                     << "' fails at " << where.GetString();
}

testing::AssertionResult fits_its_schema(std::string_view document) {
  const Json json = Json::parse(document, nullptr, false);
  const auto schema = json.is_object() ? json.find("schema") : json.end();
  const std::string named = schema != json.end() && schema->is_string() ? schema->get<std::string>() : "";
  const std::size_t dot = named.find('.'), slash = named.find('/');
  if (dot == std::string::npos || slash == std::string::npos) {
    return testing::AssertionFailure() << "the document names no schema";
  }
  return fits(document, named.substr(dot + 1, slash - dot - 1));
}

Json parsed(std::string_view document) {
  EXPECT_TRUE(fits_its_schema(document));
  return Json::parse(document);
}

}  // namespace mbk::schemas
