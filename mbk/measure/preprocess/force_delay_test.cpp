#include "mbk/measure/preprocess/force_delay.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::preprocess {
namespace force_delay_test {

/// Position t, force sin(2π t) read late.
Recording recording(double delay, Index samples = 1000) {
  Recording made;
  made.time = Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1) * 0.001);
  Channel position{"hand_x", "m", "base", made.time}, force{"force_x", "N", "base", Vector(samples)};
  for (Index i = 0; i < samples; ++i) force.values[i] = std::sin(2.0 * M_PI * (made.time[i] - delay));
  made.channels = {position, force};
  return made;
}

TEST(ForceDelay, IsUndone) {
  for (const double delay : {0.0104, 0.0, -0.0037}) {
    const auto in_time = undo_force_delay(recording(delay), delay);
    ASSERT_TRUE(in_time.has_value());
    const Vector& time = in_time->time;
    EXPECT_EQ(in_time->find("hand_x")->values, time);  // what is no force stays
    for (Index i = 0; i < time.size(); ++i) {
      EXPECT_NEAR(in_time->find("force_x")->values[i], std::sin(2.0 * M_PI * time[i]), 1e-5);
    }
    EXPECT_NEAR(static_cast<double>(1000 - time.size()), std::ceil(std::abs(delay) / 0.001), 1.0);
  }
}

TEST(ForceDelay, WhatCannotBeUndoneIsRefused) {
  EXPECT_FALSE(undo_force_delay(recording(0.0), std::nan("")));
  EXPECT_FALSE(undo_force_delay(recording(0.0), 5.0));
  Recording without = recording(0.0);
  without.channels.pop_back();
  EXPECT_FALSE(undo_force_delay(without, 0.01));
  Recording backward = recording(0.0);
  backward.time[10] = 0.0;
  EXPECT_FALSE(undo_force_delay(backward, 0.01));
}

}  // namespace force_delay_test
}  // namespace mbk::preprocess
