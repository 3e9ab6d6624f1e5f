#include "mbk/present/report/teleoperation_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace mbk::report {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Stable for every passive hand at all frequencies, and with an operator up to 500 rad/s.
TeleoperationFinding stable_with_delay() {
  TeleoperationFinding finding;
  finding.stability.verdict = StabilityVerdict::stable;
  finding.grid = FrequencyGrid{RadPerSec(0.0), RadPerSec(kInfinite), 100, true};
  finding.operator_shortage = OperatorShortage{0.5, "given", {}};
  finding.with_operator = finding.stability;
  finding.operator_grid = FrequencyGrid{RadPerSec(0.0), RadPerSec(500.0), 100, true};
  return finding;
}

TEST(TeleoperationText, EachVerdictNamesTheFrequenciesThatItAppliesTo) {
  TeleoperationFinding finding = stable_with_delay();
  EXPECT_THAT(teleoperation_text(finding), ContainsRegex("criterion [^\n]*absolutely stable with the true delay\n"));
  EXPECT_THAT(teleoperation_text(finding),
              ContainsRegex("operator at port[^:]*: absolutely stable\\swith the true delay,\\sup to 500 rad/s"));
  EXPECT_THAT(teleoperation_text(finding), Not(HasSubstr("at these frequencies")));
  finding.operator_grid = FrequencyGrid{RadPerSec(0.01), RadPerSec(kInfinite), 100, true};
  EXPECT_THAT(teleoperation_text(finding), ContainsRegex("with the true delay,\\sfrom 0.01 rad/s"));
  EXPECT_THAT(teleoperation_text(finding), Not(HasSubstr("up to")));
  finding.grid->high = RadPerSec(40.0);
  EXPECT_THAT(teleoperation_text(finding), HasSubstr("at these frequencies no passive hand"));
}

}  // namespace
}  // namespace mbk::report
