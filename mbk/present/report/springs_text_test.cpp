#include "mbk/present/report/springs_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

SpringField field() {
  SpringField field;
  field.springs = {{120.0, 0.09, {0.565, -1e-12}, {0.0, 0.0}}, {80.0, 0.1, {0.215, 0.0}, {0.01, -0.002}}};
  field.equilibrium = {0.39, -0.01};
  field.K << 300, -20, -20, 100;
  field.lengths = {0.2, 0.18};
  field.tensions = {13.2, 6.4};
  field.linearisation = {0.03, 0.1, 10.0, 0.004};
  return field;
}

TEST(SpringsText, OptionHasFourDecimalsNoMinusZeroAndAHoleOnlyWhereThereIsOne) {
  EXPECT_EQ(spring_option(field().springs[0]), "k=120.0000,l=90.0000mm,anchor=565.0000:0.0000");
  EXPECT_EQ(spring_option(field().springs[1]), "k=80.0000,l=100.0000mm,anchor=215.0000:0.0000,hole=10.0000:-2.0000");
}

TEST(SpringsText, NamesNoDirectionWhereTheStiffnessHasNone) {
  SpringField one = field();
  EXPECT_THAT(spring_field_text(one), HasSubstr("174.3°"));
  one.K = 300.0 * Eigen::Matrix2d::Identity();
  EXPECT_THAT(spring_field_text(one), AllOf(HasSubstr("300.000 N/m"), Not(HasSubstr("°"))));
}

TEST(SpringsText, SaysWhereASpringGoesSlackWithinTheCircle) {
  SpringField one = field();
  EXPECT_THAT(spring_field_text(one), HasSubstr(" 4.0 mm"));
  one.linearisation.smallest_extension = -0.003;
  const std::string slack = spring_field_text(one);
  EXPECT_THAT(slack, HasSubstr(" 3.0 mm"));
  one.linearisation.smallest_extension = 0.003;
  EXPECT_NE(spring_field_text(one), slack);
}

TEST(SpringsText, SaysWhereTheGridEndsAtItsBorder) {
  SpringField one = field();
  one.grid = GridField{0.001, {0.391, -0.01}, 0.2, one.K, false};
  EXPECT_THAT(spring_field_text(one), testing::ContainsRegex(" 1 mm.* 1 mm"));
  one.grid->at_border = true;
  EXPECT_THAT(spring_field_text(one), HasSubstr("edge"));
}

TEST(SpringsText, ConstantsShowHooksOnlyWhereTheyAreSeen) {
  SpringConstant constant;
  constant.straight.stiffness = 120.0;
  constant.straight.stiffness_error = 0.05;
  constant.whole.stiffness = 114.0;
  constant.rule = "everything";
  EXPECT_THAT(spring_constants_text({constant}), Not(HasSubstr("hooks")));
  constant.hooks = HookFit{120.0, 0.1, 0.1, 0.001, 0.0001, 0.7, 0.01};
  EXPECT_THAT(spring_constants_text({constant}), HasSubstr(" 5.0 %"));
  EXPECT_THAT(spring_constants_text({constant}), HasSubstr("120.000 ± 0.098"));
}

}  // namespace
}  // namespace mbk::report
