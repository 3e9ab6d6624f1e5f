#include "mbk/simulate/laboratory/packet_line.h"

#include <gtest/gtest.h>

#include <limits>

namespace mbk::laboratory {
namespace packet_line_test {

constexpr double kTick = 1e-3;

PacketLine line(const PacketLineOptions& options, std::uint64_t seed = 1) {
  return PacketLine::create(options, kTick, seed, 0).value();
}

/// What arrives of packets that say when they were sent, in ticks; −1 where zeros stand.
std::vector<int> arrivals(PacketLine line, int ticks) {
  std::vector<int> arrived;
  for (int n = 0; n < ticks; ++n) {
    const Packet packet = line.step({.position = n + 1.0});
    arrived.push_back(static_cast<int>(packet.position) - 1);
  }
  return arrived;
}

TEST(PacketLine, WithoutDelayGivesThePacketItself) {
  EXPECT_EQ(arrivals(line({}), 4), (std::vector{0, 1, 2, 3}));
}

TEST(PacketLine, DelaysByWholeTicksAndBeginsWithZeros) {
  EXPECT_EQ(arrivals(line({.delay = 2.4e-3}), 5), (std::vector{-1, -1, 0, 1, 2}));
}

TEST(PacketLine, HoldsTheLastPacketOrTakesZeros) {
  PacketLineOptions options{.loss = 0.3};
  const std::vector<int> held = arrivals(line(options), 2000);
  options.on_loss = OnLoss::zero;
  const std::vector<int> zeroed = arrivals(line(options), 2000);
  int lost = 0;
  for (std::size_t n = 1; n < held.size(); ++n) {
    const bool here = held[n] == static_cast<int>(n);
    lost += here ? 0 : 1;
    EXPECT_EQ(held[n], here ? static_cast<int>(n) : held[n - 1]);
    EXPECT_EQ(zeroed[n], here ? static_cast<int>(n) : -1);
  }
  EXPECT_NEAR(lost, 600, 4 * 20.5);  // four standard deviations of 2000 draws of 0.3
}

TEST(PacketLine, CountsWhatItLoses) {
  PacketLine all = line({.loss = 1.0}), none = line({});
  for (int n = 0; n < 10; ++n) {
    EXPECT_EQ(all.step({.position = 1.0}).position, 0.0);
    none.step({});
  }
  EXPECT_EQ(all.sent(), 10);
  EXPECT_EQ(all.lost(), 10);
  EXPECT_EQ(none.lost(), 0);
}

TEST(PacketLine, WithJitterNeverGoesBackAndIsNeverLaterThanThat) {
  const std::vector<int> arrived = arrivals(line({.delay = 3e-3, .jitter = 4e-3}), 1000);
  bool jumped = false;
  for (int n = 7; n < 1000; ++n) {
    const int now = arrived[static_cast<std::size_t>(n)], before = arrived[static_cast<std::size_t>(n - 1)];
    EXPECT_GE(now, before);
    EXPECT_LE(now, n - 3);
    EXPECT_GE(now, n - 7);
    jumped = jumped || now > before + 1;
  }
  EXPECT_TRUE(jumped);
}

TEST(PacketLine, IsTheSameForASeedAndAnotherForAnother) {
  const PacketLineOptions options{.loss = 0.5};
  EXPECT_EQ(arrivals(line(options, 7), 200), arrivals(line(options, 7), 200));
  EXPECT_NE(arrivals(line(options, 7), 200), arrivals(line(options, 8), 200));
}

TEST(PacketLine, RefusesWhatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const PacketLineOptions& wrong : {PacketLineOptions{.delay = -1.0},
                                         {.delay = 1e9},
                                         {.jitter = nan},
                                         {.loss = 1.5},
                                         {.loss = -0.1},
                                         {.loss = nan}}) {
    EXPECT_FALSE(PacketLine::create(wrong, kTick, 1, 0));
  }
  EXPECT_FALSE(PacketLine::create({}, 0.0, 1, 0));
}

}  // namespace packet_line_test
}  // namespace mbk::laboratory
