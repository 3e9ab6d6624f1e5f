#include "mbk/files/recording/si_units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace mbk::recording {
namespace {

double in_si(double value, std::string_view unit) {
  const Unit* found = find_unit(unit);
  return found == nullptr ? std::nan("") : found->to_si(value);
}

TEST(Units, ConvertExactlyWhereTheFactorIsAPowerOfTen) {
  EXPECT_EQ(in_si(153, "mm"), 0.153);
  EXPECT_EQ(in_si(7, "ms"), 0.007);
  EXPECT_EQ(in_si(3, "mN"), 0.003);
  EXPECT_EQ(in_si(0.2, "N.mm"), 0.2 / 1000);
}

TEST(Units, ConvertByTheirDefinitions) {
  EXPECT_EQ(in_si(1, "in"), 0.0254);
  EXPECT_EQ(in_si(180, "deg"), std::numbers::pi);
  EXPECT_EQ(in_si(1, "g"), 9.80665);
  EXPECT_NEAR(in_si(1, "lbf"), 0.45359237 * 9.80665, 1e-15);
}

TEST(Units, HaveTheirSpellings) {
  EXPECT_EQ(si_unit(find_unit("Nm")->dimension), "N.m");
  EXPECT_EQ(si_unit(find_unit("N*m")->dimension), "N.m");
  EXPECT_EQ(si_unit(find_unit("m/s^2")->dimension), "m/s2");
}

TEST(Units, MayBeSpelledOutInAnyCase) {
  for (const auto& [name, unit] : {std::pair("seconds", "s"),
                                   {"Sec", "s"},
                                   {"msec", "ms"},
                                   {"Milliseconds", "ms"},
                                   {"meters", "m"},
                                   {"MILLIMETERS", "mm"},
                                   {"Millimetre", "mm"},
                                   {"inches", "in"},
                                   {"degrees", "deg"},
                                   {"Deg", "deg"},
                                   {"Radians", "rad"},
                                   {"Newton", "N"},
                                   {"newtons", "N"},
                                   {"N-m", "N.m"},
                                   {"Newton-meters", "N.m"},
                                   {"m/s^2^", "m/s2"},
                                   {"volts", "V"},
                                   {"kilonewton", "kN"},
                                   {"millivolts", "mV"},
                                   {"m s-2", "m/s2"},
                                   {"minutes", "min"}}) {
    ASSERT_NE(find_unit(name), nullptr) << name;
    EXPECT_EQ(find_unit(name)->name, unit) << name;
  }
  for (const char* none : {"s s", "ss", "metersss", "radix", "secondary", "news", ""}) {
    EXPECT_EQ(find_unit(none), nullptr) << none;
  }
}

TEST(Units, CaseCounts) {
  EXPECT_EQ(find_unit("MN"), nullptr);
  EXPECT_EQ(find_unit("counts"), nullptr);
}

}  // namespace
}  // namespace mbk::recording
