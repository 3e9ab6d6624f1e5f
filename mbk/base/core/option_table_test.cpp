#include "mbk/base/core/option_table.h"

#include <gtest/gtest.h>

namespace mbk {
namespace {

enum class Shape { round, square };
constexpr auto word_table(Shape) {
  using enum Shape;
  return std::to_array<Word<Shape>>({{round, "round"}, {square, "square"}});
}

struct Inner {
  std::optional<double> length;
  Shape shape = Shape::round;
};

struct Choices {
  Inner inner;
  int count = 3;
  double delay = 0.0;  // [s]
  bool fast = false;
  std::optional<Shape> other;
  std::set<Shape> several;
  std::string file;
};

const OptionTable<Choices>& table() {
  static const auto kTable = [] {
    OptionTable<Inner> inner;
    inner.add({"--length", "M", "", positive()}, &Inner::length).add({"--shape", "", ""}, &Inner::shape);
    OptionTable<Choices> table;
    table.group("All")
        .include(inner, &Choices::inner)
        .add({"--count", "N", "", whole_number(1, 9), "--shape"}, &Choices::count)
        .add({"--delay-ms", "MS", "", number_within(10.0)}, &Choices::delay, kMilliseconds)
        .add({"--fast", "", ""}, &Choices::fast)
        .add({"--other", std::string(option_values::kAuto), ""}, &Choices::other)
        .add({.name = "--several", .value = "NAMES", .help = "", .takes_several = true}, &Choices::several)
        .add({.name = "--file", .value = "FILE", .help = "", .names_file = true}, &Choices::file);
    return table;
  }();
  return kTable;
}

TEST(OptionTable, SetsWhatTextsSay) {
  const auto read = table().read({{"--length", {"2.5"}},
                                  {"--shape", {"square"}},
                                  {"--count", {"4"}},
                                  {"--delay-ms", {"-2.5"}},
                                  {"--fast", {}},
                                  {"--several", {"square", "round"}}});
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(read->inner.length, 2.5);
  EXPECT_EQ(read->inner.shape, Shape::square);
  EXPECT_EQ(read->count, 4);
  EXPECT_EQ(read->delay, -0.0025);
  EXPECT_TRUE(read->fast);
  EXPECT_EQ(read->several.size(), 2U);
}

TEST(OptionTable, LeavesDefaultsOutOfAKey) {
  const OptionTexts given = {{"--length", {"02.50"}}, {"--shape", {"round"}}, {"--count", {"3"}},
                             {"--delay-ms", {"0"}},   {"--other", {"auto"}},  {"--file", {"007"}}};
  const auto read = table().read(given);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(table().without_defaults(given, *read), (OptionTexts{{"--length", {"2.5"}}, {"--file", {"007"}}}));
}

TEST(OptionTable, RefusesWhatTheCommandLineRefuses) {
  for (const OptionTexts& wrong : {OptionTexts{{"--length", {"0"}}}, OptionTexts{{"--shape", {"oval"}}},
                                   OptionTexts{{"--long", {"1"}}}, OptionTexts{{"--count", {"2"}}}}) {
    const auto read = table().read(wrong);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().kind, ErrorKind::usage);
    EXPECT_NE(read.error().message.find(wrong.begin()->first), std::string::npos);
  }
}

TEST(OptionTable, FillsInTheWordsOfAnEnumeration) {
  EXPECT_EQ(table().find("--shape")->facts.value, "round|square");
  EXPECT_EQ(table().find("--other")->facts.value, "auto|round|square");
}

}  // namespace
}  // namespace mbk
