#include "mbk/base/core/words.h"

#include <gtest/gtest.h>

namespace mbk {
namespace {

enum class Colour { red, green, blue };

constexpr auto word_table(Colour) {
  using enum Colour;
  return std::to_array<Word<Colour>>({{green, "green"}, {red, "dark red"}, {blue, "blue"}});
}

constexpr auto former_word_table(Colour) {
  return std::to_array<Word<Colour>>({{Colour::blue, "azure"}});
}

struct Machine {
  enum class State { off, on };
};

constexpr auto word_table(Machine::State) {
  return std::to_array<Word<Machine::State>>({{Machine::State::off, "off"}, {Machine::State::on, "on"}});
}

enum class Short { one, two };
constexpr auto word_table(Short) {
  return std::to_array<Word<Short>>({{Short::one, "one"}});
}

enum class Twice { one, two };
constexpr auto word_table(Twice) {
  return std::to_array<Word<Twice>>({{Twice::one, "one"}, {Twice::one, "two"}});
}

enum class Same { one, two };
constexpr auto word_table(Same) {
  return std::to_array<Word<Same>>({{Same::one, "one"}, {Same::two, "one"}});
}

enum class Wordless { one };

TEST(Words, GoBothWays) {
  for (const Colour colour : {Colour::red, Colour::green, Colour::blue}) {
    EXPECT_EQ(value_of<Colour>(word_of(colour)), colour);
  }
  EXPECT_EQ(word_of(Colour::red), "dark red");
  EXPECT_EQ(word_of(Machine::State::on), "on");
}

TEST(Words, ThatAreNoneHaveNoValue) {
  EXPECT_FALSE(value_of<Colour>("red"));
  EXPECT_FALSE(value_of<Colour>(""));
  EXPECT_FALSE(value_of<Colour>("unknown"));
}

TEST(Words, FormerOnesAreReadAndNeverWritten) {
  EXPECT_EQ(value_of<Colour>("azure"), Colour::blue);
  EXPECT_EQ(word_of(Colour::blue), "blue");
  EXPECT_EQ(former_word_of(Colour::blue), "azure");
  EXPECT_EQ(former_word_of(Colour::red), "");
}

TEST(Words, AreOfferedInTheOrderOfTheTable) {
  EXPECT_EQ(kWordList<Colour>, (std::array<std::string_view, 3>{"green", "dark red", "blue"}));
}

TEST(Words, AValueThatIsNoneIsUnknown) {
  EXPECT_EQ(word_of(static_cast<Colour>(7)), "unknown");
}

TEST(Words, ATableThatLeavesAValueOutOrSaysOneTwiceIsSeen) {
  EXPECT_TRUE(word_checks::each_value_once<Colour>());
  EXPECT_TRUE(word_checks::each_value_once<Machine::State>());
  EXPECT_FALSE(word_checks::each_value_once<Short>());
  EXPECT_FALSE(word_checks::each_value_once<Twice>());
  EXPECT_TRUE(word_checks::each_word_once<Colour>());
  EXPECT_FALSE(word_checks::each_word_once<Same>());
}

TEST(Words, OnlyAnEnumerationWithATableHasThem) {
  EXPECT_TRUE(HasWords<Colour>);
  EXPECT_FALSE(HasWords<Wordless>);
  EXPECT_FALSE(HasWords<int>);
}

}  // namespace
}  // namespace mbk
