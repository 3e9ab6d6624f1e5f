#include "mbk/present/report/braille.h"

#include <gtest/gtest.h>

#include <limits>

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

TEST(Sparkline, RisesFromTheLowestDotToTheHighest) {
  EXPECT_EQ(sparkline(Vector::LinSpaced(4, -1.0, 1.0), 2), "⡠⠊");
}

TEST(Sparkline, DrawsTheRangeOfSamplesThatShareAColumn) {
  Vector alternating(100);
  for (Index k = 0; k < alternating.size(); ++k) alternating[k] = k % 2 == 0 ? -1.0 : 1.0;
  EXPECT_EQ(sparkline(alternating, 3), "⣿⣿⣿");
}

TEST(Sparkline, IsFlatForAConstantAndBlankWithoutNumbers) {
  EXPECT_EQ(sparkline(Vector::Constant(8, 7.0), 2), "⠒⠒");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(sparkline(Vector::Constant(8, nan), 2), "  ");
  EXPECT_EQ(sparkline(Vector(), 2), "  ");
  Vector gap = Vector::Constant(4, 7.0);
  gap[2] = gap[3] = nan;
  EXPECT_EQ(sparkline(gap, 2), "⠒ ");
}

}  // namespace
}  // namespace mbk::report
