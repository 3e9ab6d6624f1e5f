#include "mbk/present/report/sensor_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::report {
namespace {

using testing::HasSubstr;
using testing::Not;

SensorCalibration calibration() {
  SensorCalibration c;
  c.sources = {{"loads.csv", "CSV", "abc"}};
  c.rows = 132;
  c.axes.resize(2);
  c.axes[0].name = "x";
  c.axes[1].name = "y";
  for (SensorAxis& axis : c.axes) {
    axis.full_scale = 50.0;
    axis.nonlinearity = 0.25;
    axis.published = {-8.56, 0.03, 0.54, 0.06, 0.9996};
  }
  c.axes[0].step = 20.0 / 4096.0;
  c.slope = (Matrix(2, 2) << -8.56, 0.1, 0.2, -8.15).finished();
  c.slope_error = Matrix::Constant(2, 2, 0.03);
  c.crosstalk = (Matrix(2, 2) << 0.0, 0.025, 0.01, 0.0).finished();
  c.crosstalk_error = Matrix::Constant(2, 2, 0.001);
  return c;
}

TEST(SensorText, SaysSlopesCrosstalkResolutionAndThePublishedForm) {
  const std::string text = sensor_text(calibration());
  for (const char* words :
       {"132 rows", "-8.560 ± 0.059", "0.25 (0.5 %)", "4.883 (0.0418)", "0.012", "2.50 ± 0.20 %", " 0.5 N", " 20 N",
        "Fx = (-8.560 ± 0.059) Vx + (0.54 ± 0.12), R² = 0.9996", "--lever-arm-mm"}) {
    EXPECT_THAT(text, HasSubstr(words));
  }
  EXPECT_THAT(text, HasSubstr("95 %"));
  EXPECT_THAT(text, Not(HasSubstr("delay")));
}

TEST(SensorText, SaysWhatWasNotFittedAndEveryWarningWithWhatToTry) {
  SensorCalibration c = calibration();
  c.crosstalk = Matrix();
  c.delay = 0.0086;
  c.lever_arm = 0.0688;
  c.warnings = {{SensorWarningCode::one_sided_loads, "all pull", "push"}};
  const std::string text = sensor_text(c);
  for (const char* words : {"crosstalk", "8.6 ms", "68.8 mm", "  ! one-sided-loads: all pull\n    try: push\n"}) {
    EXPECT_THAT(text, HasSubstr(words));
  }
}

}  // namespace
}  // namespace mbk::report
