#include "mbk/present/report/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

namespace mbk::report {
namespace picture_test {

using testing::HasSubstr;

impedance::Ellipse ellipse(double lambda_max, double lambda_min, double degrees) {
  impedance::Ellipse e;
  e.lambda_max = lambda_max;
  e.lambda_min = lambda_min;
  e.area = std::numbers::pi * lambda_max * lambda_min;
  e.shape = lambda_max / lambda_min;
  e.orientation = degrees * std::numbers::pi / 180.0;
  return e;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

using Dots = std::set<std::pair<int, int>>;

/// Column and row (upwards) of every Braille dot below the caption.
Dots dots_of(const std::string& picture) {
  constexpr int kBits[8][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}, {1, 2}, {0, 3}, {1, 3}};  // Unicode's order
  Dots dots;
  const std::vector<std::string> lines = lines_of(picture);
  for (std::size_t row = 1; row < lines.size(); ++row) {
    int column = -2;  // the indent
    for (std::size_t i = 0; i < lines[row].size(); ++column) {
      const auto byte = static_cast<unsigned char>(lines[row][i]);
      if (byte < 0x80) {
        ++i;
        continue;
      }
      const unsigned code = ((byte & 0x0Fu) << 12) | ((static_cast<unsigned char>(lines[row][i + 1]) & 0x3Fu) << 6) |
                            (static_cast<unsigned char>(lines[row][i + 2]) & 0x3Fu);
      for (unsigned bit = 0; bit < 8; ++bit) {
        if ((code - 0x2800u) >> bit & 1u) {
          dots.emplace(2 * column + kBits[bit][0], -(4 * static_cast<int>(row - 1) + kBits[bit][1]));
        }
      }
      i += 3;
    }
  }
  return dots;
}

struct Extent {
  double along = 0, across = 0;  ///< largest distance from the centre, in dots
};

/// Of all dots but those of the cross, seen along an angle and across it.
Extent extent(const Dots& dots, double degrees) {
  const double centre_x = 22.5, centre_y = -21.5;
  const double c = std::cos(degrees * std::numbers::pi / 180.0), s = std::sin(degrees * std::numbers::pi / 180.0);
  Extent result;
  for (const auto& [x, y] : dots) {
    const double dx = x - centre_x, dy = y - centre_y;
    if (std::abs(dx) < 1.0 || std::abs(dy) < 1.0) continue;  // the cross
    result.along = std::max(result.along, std::abs(c * dx + s * dy));
    result.across = std::max(result.across, std::abs(-s * dx + c * dy));
  }
  return result;
}

class Drawn : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Orientations, Drawn, testing::Values(20.0, 45.0, 70.0, 110.0, 135.0, 160.0));

TEST_P(Drawn, HasItsRatioOfAxesAndItsOrientation) {
  const double degrees = GetParam();
  const Extent drawn = extent(dots_of(draw_ellipses({{ellipse(1.0, 0.5, degrees), "inertia", "kg"}})), degrees);
  const double kDot = 1.0;  // dots stand on a grid
  EXPECT_NEAR(drawn.along, 21.5, kDot);
  EXPECT_NEAR(drawn.across, 0.5 * 21.5, kDot);
}

TEST_P(Drawn, IsNotItsMirrorImage) {
  const double degrees = GetParam();
  const Extent mirrored = extent(dots_of(draw_ellipses({{ellipse(1.0, 0.3, degrees), "inertia", "kg"}})), -degrees);
  EXPECT_GT(mirrored.across, 0.5 * 21.5);
}

TEST(Picture, StiffnessAlongYStandsUpright) {
  const Dots dots = dots_of(draw_ellipses({{ellipse(100.0, 20.0, 90.0), "stiffness", "N/m"}}));
  const Extent drawn = extent(dots, 90.0);
  EXPECT_GT(drawn.along, 3.0 * drawn.across);
}

TEST(Picture, TheScaleIsARoundNumberAtOrAboveTheLargestEigenvalue) {
  EXPECT_THAT(draw_ellipses({{ellipse(137.0, 20.0, 0.0), "stiffness", "N/m"}}), HasSubstr("stiffness, radius 150 N/m"));
  EXPECT_THAT(draw_ellipses({{ellipse(2.0, 0.6, 0.0), "inertia", "kg"}}), HasSubstr("inertia, radius 2 kg"));
  EXPECT_THAT(draw_ellipses({{ellipse(0.031, 0.01, 0.0), "inertia", "kg"}}), HasSubstr("radius 0.05 kg"));
  EXPECT_THAT(draw_ellipses({{ellipse(8.0, 1.0, 0.0), "damping", "N·s/m"}}), HasSubstr("radius 10 N·s/m"));
}

TEST(Picture, AnIndefiniteMatrixHasNone) {
  const std::string picture = draw_ellipses({{ellipse(3.0, -0.5, 0.0), "inertia", "kg"}});
  EXPECT_EQ(picture, "");
  const double nan = std::nan("");
  EXPECT_EQ(draw_ellipses({{ellipse(nan, nan, nan), "inertia", "kg"}}), "");
}

TEST(Picture, PanelsStandSideBySideInColumnsOfTheSameWidth) {
  const auto lines = lines_of(
      draw_ellipses({{ellipse(3.0, -0.5, 0.0), "inertia", "kg"}, {ellipse(10.0, 5.0, 30.0), "damping", "N·s/m"}}));
  EXPECT_EQ(lines.size(), 12u);
  EXPECT_EQ(columns(lines[0].substr(0, lines[0].find("damping"))), 2u + 26u);
  for (std::size_t k = 1; k < lines.size(); ++k) {
    if (!lines[k].empty()) {
      EXPECT_GE(lines[k].find_first_not_of(' '), 28u);
    }
    EXPECT_LE(columns(lines[k]), 80u);
  }
}

TEST(Picture, HasNoTrailingBlanks) {
  const std::string picture =
      draw_ellipses({{ellipse(10.0, 5.0, 30.0), "damping", "N·s/m"}, {ellipse(3.0, -0.5, 0.0), "inertia", "kg"}});
  for (const std::string& line : lines_of(picture)) EXPECT_FALSE(line.ends_with(' ')) << '"' << line << '"';
}

TEST(Columns, CountsCodePointsAndNotBytes) {
  EXPECT_EQ(columns(""), 0u);
  EXPECT_EQ(columns("N·s/m"), 5u);
  EXPECT_EQ(columns("±⠿°"), 3u);
}

}  // namespace picture_test
}  // namespace mbk::report
