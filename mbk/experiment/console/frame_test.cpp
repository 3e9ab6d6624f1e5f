#include "mbk/experiment/console/frame.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace mbk::console {
namespace {

template <class Value>
Value at(const std::string& bytes, std::size_t place) {
  Value value{};
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

TEST(Frame, HoldsEverySampleWhereItsDescriptionSays) {
  std::vector<journal::Tick> ticks(3);
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    journal::Tick& tick = ticks[k];
    tick.number = 5000 + k;
    tick.time = 5.0 + 0.001 * static_cast<double>(k);
    tick.joint = {0.3, 1.2};
    tick.force = {1.5, -2.5};
    tick.reference = {0.31, -0.04};
    tick.acceleration = {0.25, 0.5};
    tick.torque = {-0.75, 4.0};
    tick.compute = 12e-6F;
    tick.late = 3e-6;
  }
  const robot::Geometry geometry;
  const std::string bytes = frame(ticks, geometry, 2);
  ASSERT_EQ(bytes.size(), kFrameHeader + 3 * kFrameColumns * sizeof(float));
  EXPECT_EQ(bytes.substr(0, 4), "MBKF");
  EXPECT_EQ(at<std::uint16_t>(bytes, 4), 1);
  EXPECT_EQ(at<std::uint16_t>(bytes, 6), kFrameColumns);
  EXPECT_EQ(at<std::uint32_t>(bytes, 8), 3U);
  EXPECT_EQ(at<std::uint32_t>(bytes, 12), 2U);
  EXPECT_EQ(at<double>(bytes, 16), 5.0);
  EXPECT_EQ(at<double>(bytes, 24), 5000.0);
  const auto hand = robot::hand_position(geometry, {0.3, 1.2});
  const std::vector<double> expected = {0.002, hand[0], hand[1], 1.5, -2.5, 0.31, -0.04,
                                        0.25,  0.5,     -0.75,   4.0, 12.0, 3.0};
  for (std::size_t column = 0; column < kFrameColumns; ++column) {
    const float value = at<float>(bytes, kFrameHeader + (2 * kFrameColumns + column) * sizeof(float));
    EXPECT_NEAR(value, expected[column], 1e-6 * std::max(1.0, std::abs(expected[column]))) << column;
  }
}

}  // namespace
}  // namespace mbk::console
