#include "mbk/base/document/fields.h"

#include <gtest/gtest.h>

#include <limits>

namespace mbk::document {
namespace {

enum class Side { left, right };
[[nodiscard]] constexpr auto word_table(Side) {
  return std::to_array<Word<Side>>({{Side::left, "left"}, {Side::right, "right"}});
}

struct Part {
  double length = 0;
  Side side = Side::left;
};

struct Whole {
  std::vector<Part> parts;
  std::optional<double> mass, ratio;
  int count = 0;
  std::pair<double, double> range;
};

void describe(Fields<Part>& fields) {
  fields.type("Part", "One of it.");
  fields.add("length_m", &Part::length, "[m]");
  fields.add("side", &Part::side);
}

void describe(Fields<Whole>& fields) {
  fields.type("Whole", "All of it.");
  fields.constant("schema", "mbk.whole/1");
  fields.add("parts", &Whole::parts);
  fields.add("mass", &Whole::mass, "absent where it is not known [kg]");
  fields.add_or_null("ratio", &Whole::ratio);
  fields.add_if([](const Whole& whole) { return whole.count > 0; }, "count", &Whole::count);
  fields.add("range", &Whole::range);
}

TEST(Fields, WriteAValueInTheOrderOfItsDescription) {
  const Whole whole{{{0.5, Side::right}, {std::numeric_limits<double>::quiet_NaN()}}, 2.0, {}, 0, {1.0, 2.0}};
  EXPECT_EQ(written(whole).dump(),
            R"({"schema":"mbk.whole/1","parts":[{"length_m":0.5,"side":"right"},{"length_m":null,"side":"left"}],)"
            R"("mass":2.0,"ratio":null,"range":[1.0,2.0]})");
}

TEST(Fields, MakeAClosedSchemaThatNamesEachTypeOnce) {
  const Json schema = schema_of<Whole>();
  EXPECT_EQ(schema.at("title"), "Whole");
  EXPECT_EQ(schema.at("description"), "All of it.");
  EXPECT_EQ(schema.at("additionalProperties"), false);
  EXPECT_EQ(schema.at("required"), (Json{"schema", "parts", "ratio", "range"}));
  const Json& properties = schema.at("properties");
  EXPECT_EQ(properties.at("parts"), (Json{{"type", "array"}, {"items", {{"$ref", "#/definitions/Part"}}}}));
  EXPECT_EQ(properties.at("mass").at("description"), "absent where it is not known [kg]");
  EXPECT_EQ(properties.at("count"), (Json{{"type", "integer"}}));
  const Json& definitions = schema.at("definitions");
  EXPECT_EQ(definitions.at("Part").at("properties").at("side"), (Json{{"$ref", "#/definitions/Side"}}));
  EXPECT_EQ(definitions.at("Side"), (Json{{"enum", {"left", "right"}}}));
  EXPECT_EQ(definitions.at("Interval").at("items"), (Json{{"$ref", "#/definitions/Value"}}));
}

}  // namespace
}  // namespace mbk::document
