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
  enum class Finish { rough, smooth };
  double length = 0;
  Side side = Side::left;
};
[[nodiscard]] constexpr auto word_table(Part::Finish) {
  using enum Part::Finish;
  return std::to_array<Word<Part::Finish>>({{rough, "rough"}, {smooth, "smooth"}});
}

struct Box {
  std::optional<Part> lid;
  Part bottom;
  Matrix signals;
  std::array<double, 2> corner = {0.5, 1.5};
  std::string note;
  Part::Finish finish = Part::Finish::smooth;
  std::variant<bool, const Part*> content = true;
  bool open = false;
  std::pair<Hertz, Hertz> band = {Hertz(1), Hertz(2)};
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

void describe(Fields<Box>& fields) {
  fields.type("Box");
  fields.add("lid", [](const Box& box) { return box.lid ? &*box.lid : nullptr; });
  fields.add("bottom_m", through(&Box::bottom, &Part::length)).always = false;
  fields.add_unless_empty("note", &Box::note);
  fields.add("corner", &Box::corner);
  fields.add("finish", &Box::finish);
  fields.add("content", &Box::content);
  fields.add_choice("is", &Box::open, "open", "shut");
  fields.add("band_hz", &Box::band);
  fields.add_columns("signals", &Box::signals);
  fields.add_rounded("shown", &Box::signals, 2);
  fields.group("size", [](Fields<Box>& size) {
    size.type("Size", "Of the bottom.");
    size.add_number("length", through(&Box::bottom, &Part::length));
  });
}

void describe(Fields<List<Box>>& fields) {
  describe_list(fields, "Boxes", "mbk.boxes/1", "Several.");
}

TEST(Fields, TakeFurtherForms) {
  Box box;
  box.signals = Matrix{{1.25, 2.0}, {3.0, 4.0}};
  const std::string closed =
      R"({"bottom_m":0.0,"corner":[0.5,1.5],"finish":"smooth","content":true,"is":"shut","band_hz":[1.0,2.0],)"
      R"("signals":[[1.25,3.0],[2.0,4.0]],"shown":[[1.2,3.0],[2.0,4.0]],"size":{"length":0.0}})";
  EXPECT_EQ(compact(written(box)), closed);
  EXPECT_EQ(one_or_list<Box>({&box, 1}), dumped(Json::parse(closed)));
  box.lid = Part{2.0};
  box.content = &*box.lid;
  box.note = "new";
  const Json json = written(box);
  EXPECT_EQ(json["lid"]["length_m"], 2.0);
  EXPECT_EQ(json["content"], json["lid"]);
  EXPECT_EQ(json["note"], "new");
  const std::array two = {box, box};
  EXPECT_EQ(Json::parse(one_or_list<Box>(two)).at("results").at(1), json);
}

TEST(Fields, FurtherFormsHaveTheirSchema) {
  const Json schema = schema_of<Box>();
  EXPECT_EQ(schema.at("required"), (Json{"corner", "finish", "content", "is", "band_hz", "signals", "shown", "size"}));
  const Json& properties = schema.at("properties");
  EXPECT_EQ(properties.at("lid"), (Json{{"$ref", "#/definitions/Part"}}));
  EXPECT_EQ(properties.at("corner").at("minItems"), 2);
  EXPECT_EQ(properties.at("finish"), (Json{{"$ref", "#/definitions/PartFinish"}}));
  EXPECT_EQ(properties.at("content").at("anyOf").at(1), (Json{{"$ref", "#/definitions/Part"}}));
  EXPECT_EQ(properties.at("is"), (Json{{"enum", {"open", "shut"}}}));
  EXPECT_EQ(properties.at("band_hz"), (Json{{"$ref", "#/definitions/Band"}}));
  EXPECT_EQ(properties.at("signals"), (Json{{"$ref", "#/definitions/Columns"}}));
  EXPECT_EQ(properties.at("shown"), properties.at("signals"));
  const Json& size = schema.at("definitions").at("Size");
  EXPECT_EQ(size.at("properties").at("length"), (Json{{"type", "number"}}));
  EXPECT_EQ(schema_of<List<Box>>().at("properties").at("results").at("items"), (Json{{"$ref", "#/definitions/Box"}}));
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

struct Odd {
  double mass = 0;
  Matrix signals;
  std::array<Side, 2> sides = {};
};

void describe(Fields<Odd>& fields) {
  fields.type("Odd");
  const auto inner = [](Fields<Odd>& part) { part.add_number("mass", &Odd::mass); };
  fields.group("inner", inner, "within").only_if([](const Odd& odd) { return odd.mass > 0; });
  fields.add_columns("signals", &Odd::signals);
  fields.add("sides", &Odd::sides);
  fields.add_form<Vector>("rounded", [](const Odd& odd) { return rounded(Vector::Constant(1, odd.mass)); });
}

TEST(Fields, TakeFormsThatNoMemberHas) {
  Odd odd;
  odd.signals = Matrix{{1.0, 2.0}, {3.0, 4.0}};
  EXPECT_EQ(written(odd).dump(), R"({"signals":[[1.0,3.0],[2.0,4.0]],"sides":["left","left"],"rounded":[0.0]})");
  odd.mass = 1.0 / 3.0;
  EXPECT_EQ(written(odd).at("inner"), (Json{{"mass", 1.0 / 3.0}}));
  EXPECT_EQ(written(odd).at("rounded"), (Json{0.333333}));

  const Json schema = schema_of_one<Odd, Part>("Either", "One of two.");
  EXPECT_EQ(schema.at("oneOf"), (Json{{{"$ref", "#/definitions/Odd"}}, {{"$ref", "#/definitions/Part"}}}));
  const Json& made = schema.at("definitions").at("Odd");
  EXPECT_EQ(made.at("required"), (Json{"signals", "sides", "rounded"}));
  const Json& properties = made.at("properties");
  EXPECT_EQ(properties.at("inner"), (Json{{"type", "object"},
                                          {"properties", {{"mass", {{"type", "number"}}}}},
                                          {"required", {"mass"}},
                                          {"additionalProperties", false},
                                          {"description", "within"}}));
  EXPECT_EQ(properties.at("signals"), (Json{{"$ref", "#/definitions/Columns"}}));
  EXPECT_EQ(properties.at("sides").at("minItems"), 2);
  EXPECT_EQ(properties.at("sides").at("maxItems"), 2);
  EXPECT_EQ(properties.at("rounded"), (Json{{"$ref", "#/definitions/Vector"}}));
}

}  // namespace
}  // namespace mbk::document
