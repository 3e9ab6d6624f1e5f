#include "mbk/study/longitudinal/stretch_curves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "mbk/study/store/test_study.h"

namespace mbk::longitudinal {
namespace {

constexpr double kInRadians = std::numbers::pi / 180.0;

/// Stretches over 10 positions from `first` [°] at 10 °/s and `fast` [°/s]: passive torque `level`, and twice that.
std::string stretches(double level, double fast = 100.0, double first = 90.0) {
  std::string angle, passive, excess;
  for (int k = 0; k < 10; ++k) {
    angle += fmt::format("{}{}", k > 0 ? "," : "", kInRadians * (first + 5.0 * k));
    passive += fmt::format("{}{}", k > 0 ? "," : "", level);
    excess += fmt::format("{}{}", k > 0 ? "," : "", level);
  }
  return fmt::format(
      R"({{"schema":"mbk.explore/1","units":{{"K":"N·m/rad"}},"stretch":{{"axis":0,"directions":[{{"direction":1,)"
      R"("angle":[{}],"passive":[{}],"speeds":[{{"speed":{},"excess":[]}},{{"speed":{},"excess":[{}]}}]}}]}}}})",
      angle, passive, kInRadians * 10.0, kInRadians * fast, excess);
}

/// A study whose participants have such results, in one session each.
class Stretched {
 public:
  explicit Stretched(const std::map<std::int64_t, std::string>& documents) : study_(store::new_study(folder_ / "s")) {
    std::map<std::string, std::string> of_file;
    for (const auto& [person, document] : documents) {
      const auto added = store::add(study_, folder_.file("r.csv", fmt::format("{}", person)), {.participant = person});
      EXPECT_TRUE(added);
      of_file[added->front().recording.sha256] = document;
    }
    const auto units = study_.pending("{}", "1.0", false).value();
    std::vector<store::UnitResult> results;
    for (const store::Unit& unit : units) results.push_back({of_file[unit.sha256], true, ""});
    EXPECT_TRUE(study_.save("{}", "1.0", units, results, store::Role::analyst));
  }

  [[nodiscard]] Result<std::vector<StretchCurves>> curves(const std::set<std::int64_t>& controls) const {
    return stretch_curves(study_, store::list_study(study_, {}).value(), 1, controls);
  }

 private:
  store::TestFolder folder_;
  store::Store study_;
};

std::map<std::int64_t, std::string> people(int controls) {
  std::map<std::int64_t, std::string> all = {{1, stretches(8.0)}};
  for (int p = 2; p <= controls + 1; ++p) all[p] = stretches(1.0 + 0.1 * p);
  return all;
}

TEST(StretchCurves, LieOverTheRangeOfTheControls) {
  const auto found = Stretched(people(5)).curves({2, 3, 4, 5, 6});
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->size(), 1U);
  const StretchCurves& one = found->front();
  EXPECT_EQ(one.position_unit, "°");
  EXPECT_NEAR(one.position[1], 95.0, 1e-9);
  ASSERT_EQ(one.speeds.size(), 2U);
  EXPECT_NEAR(one.speeds[0].speed, 10.0, 1e-9);
  EXPECT_NEAR(one.speeds[0].torque[3], 8.0, 1e-12);
  EXPECT_NEAR(one.speeds[1].torque[3], 16.0, 1e-12);
  for (const StretchCurve& curve : one.speeds) {
    const double factor = &curve == &one.speeds[0] ? 1.0 : 2.0;
    EXPECT_EQ(curve.controls, 5);
    EXPECT_NEAR(curve.mean[3], factor * 1.4, 1e-12);
    // t(0.975, 4) s √(1 + 1/5), s = 0.1 √2.5
    EXPECT_NEAR(curve.high95[3] - curve.mean[3], factor * 0.48089440, 1e-7);
    EXPECT_EQ(curve.above, 1.0);
    EXPECT_EQ(curve.below, 0.0);
  }
}

TEST(StretchCurves, HaveNoRangeOfFewerThanFiveControls) {
  const auto found = Stretched(people(5)).curves({2, 3, 4, 5});
  ASSERT_TRUE(found);
  const StretchCurve& curve = found->front().speeds.front();
  EXPECT_EQ(curve.controls, 4);
  EXPECT_TRUE(curve.mean.array().isNaN().all());
  EXPECT_TRUE(curve.low95.array().isNaN().all());
  EXPECT_TRUE(std::isnan(curve.above));
  EXPECT_TRUE(std::isfinite(curve.torque[0]));
}

TEST(StretchCurves, ControlsOfAnotherSpeedOrElsewhereDoNotCount) {
  auto all = people(7);
  all[2] = stretches(1.2, 130.0);         // not within 10 % of 100 °/s
  all[3] = stretches(1.3, 95.0);          // within
  all[4] = stretches(1.4, 100.0, 105.0);  // covers 7 of 10 positions
  all[5] = stretches(1.5, 100.0, 95.0);   // 9 of 10
  const auto found = Stretched(all).curves({2, 3, 4, 5, 6, 7, 8});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->front().speeds[0].controls, 6);
  EXPECT_EQ(found->front().speeds[1].controls, 5);
  // Where one of those who count was not stretched there is no range.
  EXPECT_TRUE(std::isnan(found->front().speeds[1].low95[0]));
  EXPECT_TRUE(std::isfinite(found->front().speeds[1].low95[1]));
}

TEST(StretchCurves, OfOtherStudiesThereAreNone) {
  EXPECT_TRUE(Stretched({{1, R"({"schema":"mbk.explore/1","emg":{}})"}}).curves({})->empty());
  EXPECT_FALSE(Stretched({{1, R"({"stretch":{"directions":[{}]}})"}}).curves({}));
}

}  // namespace
}  // namespace mbk::longitudinal
