#include "mbk/base/core/printable.h"

#include <gtest/gtest.h>

namespace mbk {
namespace {

TEST(Printable, IsOneLineWithoutControlCharacters) {
  EXPECT_EQ(printable("a\x1b[2Jb\nc\x7f"), "a?[2Jb?c?");
  EXPECT_EQ(printable("a\xC2\x9B"
                      "2Jb"),
            "a?2Jb")
      << "C1: a terminal may take U+009B for ESC [";
}

TEST(Printable, TakesWhatIsNotUtf8AsLatin1) {
  EXPECT_EQ(printable("M\xFCller"), "M\xC3\xBCller");
  EXPECT_EQ(printable("a\x9B"
                      "2J"),
            "a?2J");
}

TEST(PrintableLines, KeepLinesTabsAndEveryLetter) {
  const std::string text = "k_xx\t46.0 ± 5.0 N·m²\n⣿ ✓ 𝄞\n";
  EXPECT_EQ(printable_lines(text), text);
}

TEST(PrintableLines, AreNotObeyedByATerminal) {
  EXPECT_EQ(printable_lines("a\x1b]0;owned\x07\r\n"), "a?]0;owned??\n");
  EXPECT_EQ(printable_lines("\xC2\x9B"
                            "31mred ±\n"),
            "?31mred ±\n");
}

TEST(PrintableLines, TakeSingleBytesAsLatin1) {
  EXPECT_EQ(printable_lines("M\xFCller ±\n\x9B"), "M\xC3\xBCller ±\n?");
}

}  // namespace
}  // namespace mbk
