// The bootstrap's intervals of a simulated recording, beside the delta method and plain quantiles.
#include "mbk/measure/analyse/bootstrap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/files/recording/inspect.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/preprocess/prepare.h"
#include "mbk/model/impedance/ellipse.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace mbk::pipeline {
namespace {

double width(const Interval& interval) {
  return interval.second - interval.first;
}

TEST(BootstrapOfARelaxedArm, AgreesWithTheDeltaMethod) {
  laboratory::PrescribedMotionOptions motion;
  motion.sensors.coloured_force_noise = 0.2;
  measurement::Options options;
  options.identify.bootstrap = 1000;
  const std::vector<Recording> recordings = {generated(motion)};
  const auto measured = measurement::measure(recordings, options);
  ASSERT_TRUE(measured && measured->bootstrap);
  const BootstrapFindings& bootstrap = *measured->bootstrap;
  EXPECT_EQ(bootstrap.replicates, 1000);
  EXPECT_EQ(bootstrap.findings.size(), 14U + 17U + 1U);
  // Some 16 blocks of 2.5 s: each width has a spread of about 1/√32, and they have no bias in common.
  double mean = 0.0;
  for (const BootstrapFinding& one : bootstrap.findings) {
    SCOPED_TRACE(one.name);
    EXPECT_LT(one.interval95.first, one.value);
    EXPECT_GT(one.interval95.second, one.value);
    const double ratio = width(one.interval95) / width(one.delta95);
    EXPECT_GT(ratio, 0.5);
    EXPECT_LT(ratio, 2.0);
    mean += ratio / static_cast<double>(bootstrap.findings.size());
  }
  EXPECT_NEAR(mean, 1.0, 0.3);
}

}  // namespace
}  // namespace mbk::pipeline
