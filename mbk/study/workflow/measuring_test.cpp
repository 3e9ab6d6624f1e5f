#include "mbk/study/workflow/measuring.h"

#include <gtest/gtest.h>

namespace mbk::workflow {
namespace {

std::string key_of(const OptionTexts& given) {
  const auto measuring = measuring_of(given);
  EXPECT_TRUE(measuring) << measuring.error().line();
  return measuring ? (*measuring)->key : "";
}

// Keys stand in the databases of studies: none may change.
TEST(Measuring, KeysAreThoseOfStoredStudies) {
  EXPECT_EQ(key_of({}), "{}");
  EXPECT_EQ(key_of({{"--mode", {"default"}}, {"--padding", {"15"}}, {"--hac-lag", {"1.0"}}}), "{}");
  EXPECT_EQ(key_of({{"--cutoff", {"05.0"}}, {"--axes", {"1"}}}), R"({"--axes":["1"],"--cutoff":["5"]})");
  EXPECT_EQ(key_of({{"--cutoff", {"none"}}, {"--decimate-check", {}}}),
            R"({"--cutoff":["none"],"--decimate-check":[]})");
  EXPECT_EQ(key_of({{"--mode", {"reference"}}, {"--procedure", {"chapter3"}}}), R"({"--mode":["reference"]})");
  EXPECT_EQ(key_of({{"--force-delay-ms", {"10.2"}}, {"--protocol", {"auto"}}}), R"({"--force-delay-ms":["10.2"]})");
  EXPECT_EQ(key_of({{"--channels", {"x=2:mm,F=3"}}, {"--ignore-range", {"stiffness", "motion"}}}),
            R"({"--channels":["x=2:mm,F=3"],"--ignore-range":["stiffness","motion"]})");
}

TEST(Measuring, SetsWhatIsMeasuredWith) {
  const auto measuring = measuring_of({{"--force-delay-ms", {"10.2"}}, {"--axes", {"1"}}, {"--domain", {"joint"}}});
  ASSERT_TRUE(measuring) << measuring.error().line();
  EXPECT_EQ((*measuring)->options.force_delay, 10.2 / 1000.0);
  EXPECT_EQ((*measuring)->options.preprocess.axes, 1);
  EXPECT_TRUE((*measuring)->options.joint_domain);
}

TEST(Measuring, RefusesOptionsThatDoNotBelongTogether) {
  EXPECT_FALSE(measuring_of({{"--procedure", {"chapter5"}}}));
  EXPECT_FALSE(measuring_of({{"--from", {"5"}}, {"--to", {"4"}}}));
  EXPECT_FALSE(measuring_of({{"--sensor-frame", {"link"}}}));
  EXPECT_FALSE(measuring_of({{"--trial", {"2"}}}));
}

TEST(Measuring, OptionsComeBackFromJson) {
  const OptionTexts given = {{"--cutoff", {"5"}}, {"--decimate-check", {}}};
  const auto back = options_from_json(options_to_json(given));
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, given);
  EXPECT_FALSE(options_from_json("[]"));
}

}  // namespace
}  // namespace mbk::workflow
