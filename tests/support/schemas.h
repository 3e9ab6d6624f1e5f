#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

/// Documents of mbk against their JSON Schemas in the folder schemas/ of the build.
namespace mbk::schemas {

/// Whether a document fits schemas/`name`.schema.json; if not, where it does not and which keyword of the schema says
/// so. Not fitting is also what is no JSON.
/// @throws std::runtime_error where there is no such schema, or it says what this check could not hold it to.
[[nodiscard]] testing::AssertionResult fits(std::string_view document, const std::string& name);

/// Whether a document fits the schema that it names: "mbk.result/1" is schemas/result.schema.json.
[[nodiscard]] testing::AssertionResult fits_its_schema(std::string_view document);

/// The document as JSON, with a failure of the running test where it does not fit the schema that it names.
[[nodiscard]] nlohmann::json parsed(std::string_view document);

}  // namespace mbk::schemas
