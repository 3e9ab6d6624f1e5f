#include "mbk/present/result/springs_json.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/schemas.h"

namespace mbk::result {
namespace {

using nlohmann::json;

SpringField field() {
  SpringField field;
  field.springs = {{120.0, 0.09, {0.565, 0.183}, {0.01, 0.0}}, {80.0, 0.1, {0.215, 0.0}}};
  field.equilibrium = {0.39, -0.01};
  field.K << 300, -20, -20, 100;
  field.lengths = {0.2, 0.18};
  field.tensions = {13.2, 6.4};
  field.linearisation = {0.03, 0.1, 10.0, 0.004};
  return field;
}

TEST(SpringsJson, FieldHasEveryNumberInSi) {
  const json read = schemas::parsed(to_json(field()));
  EXPECT_EQ(read["schema"], "mbk.springs/1");
  EXPECT_EQ(read["what"], "field");
  EXPECT_EQ(read["equilibrium"], json({0.39, -0.01}));
  EXPECT_EQ(read["K"], json({{300, -20}, {-20, 100}}));
  EXPECT_EQ(read["springs"][0]["hole"], json({0.01, 0.0}));
  EXPECT_EQ(read["springs"][1]["tension"], 6.4);
  EXPECT_DOUBLE_EQ(read["linearisation"]["relative_error"].get<double>(), 0.01);
  EXPECT_FALSE(read.contains("grid"));
}

TEST(SpringsJson, DesignHasItsTargetAndTheEyes) {
  SpringDesign design{field(), {2, 5}, Eigen::Matrix2d::Identity(), {0.39, 0.0}, 0.5, {2.0, 3.0}};
  json read = schemas::parsed(to_json(design));
  EXPECT_EQ(read["what"], "find");
  EXPECT_EQ(read["target"]["K"], json({{1, 0}, {0, 1}}));
  EXPECT_EQ(read["springs"][1]["eye"], 5);
  EXPECT_EQ(read["natural_frequencies_hz"], json({2.0, 3.0}));
  design.payload.reset();
  EXPECT_FALSE(schemas::parsed(to_json(design)).contains("natural_frequencies_hz"));
}

TEST(SpringsJson, ConstantsSayNullForWhatIsUndefinedAndNothingOfHooksThatAreNotSeen) {
  SpringConstant constant;
  constant.straight.stiffness = constant.whole.stiffness = 120.0;
  constant.whole.stiffness_error = std::numeric_limits<double>::quiet_NaN();
  const json read = schemas::parsed(to_json(std::vector{constant}))["constants"][0];
  EXPECT_EQ(read["straight"]["stiffness"], 120.0);
  EXPECT_TRUE(read["whole"]["stiffness_standard_error"].is_null());
  EXPECT_EQ(read["bias_of_whole"], 0.0);
  EXPECT_FALSE(read.contains("hooks"));
}

}  // namespace
}  // namespace mbk::result
