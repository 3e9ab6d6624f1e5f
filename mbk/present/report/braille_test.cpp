#include "mbk/present/report/braille.h"

#include <gtest/gtest.h>

namespace mbk::report {
namespace {

TEST(BrailleCanvas, EveryDotHasItsPattern) {
  const char* const patterns[4][2] = {{"⠁", "⠈"}, {"⠂", "⠐"}, {"⠄", "⠠"}, {"⡀", "⢀"}};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 2; ++column) {
      BrailleCanvas canvas(1, 1);
      canvas.dot(column, row);
      EXPECT_EQ(canvas.line(0), patterns[row][column]);
    }
  }
}

TEST(BrailleCanvas, DotsOfOneCharacterAdd) {
  BrailleCanvas canvas(2, 2);
  for (int row = 4; row < 8; ++row) {
    for (int column = 2; column < 4; ++column) canvas.dot(column, row);
  }
  EXPECT_EQ(canvas.line(0), "  ");
  EXPECT_EQ(canvas.line(1), " ⣿");
}

TEST(BrailleCanvas, LeavesAwayWhatIsBeyondIt) {
  BrailleCanvas canvas(2, 1);
  canvas.dot(-1, 0);
  canvas.dot(4, 0);
  canvas.dot(0, -1);
  canvas.dot(0, 4);
  EXPECT_EQ(canvas.line(0), "  ");
}

}  // namespace
}  // namespace mbk::report
