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

TEST(Units, KnowWeightsAndInchesHoweverTheyAreWritten) {
  const auto in_si = [](std::string_view name, Dimension dimension) {
    const Unit* const unit = find_unit(name);
    EXPECT_NE(unit, nullptr) << name;
    if (unit == nullptr) return 0.0;
    EXPECT_EQ(unit->dimension, dimension) << name;
    return unit->to_si(1.0);
  };
  for (const char* name : {"lb", "lbs", "LBS", "lbf", "Lbf", "pounds", "Pound"}) {
    EXPECT_EQ(in_si(name, Dimension::force), 4.4482216152605) << name;
  }
  for (const char* name : {"kg", "Kg", "kgf", "kp", "kilograms"})
    EXPECT_EQ(in_si(name, Dimension::force), 9.80665) << name;
  for (const char* name : {"gf", "gram", "Grams"}) EXPECT_DOUBLE_EQ(in_si(name, Dimension::force), 9.80665e-3) << name;
  for (const char* name : {"oz", "ozf", "ounces"}) {
    EXPECT_DOUBLE_EQ(in_si(name, Dimension::force), 4.4482216152605 / 16) << name;
  }
  EXPECT_EQ(in_si("mN", Dimension::force), 1e-3);
  EXPECT_EQ(in_si("kN", Dimension::force), 1e3);
  for (const char* name : {"in", "inch", "Inches"}) EXPECT_EQ(in_si(name, Dimension::length), 0.0254) << name;
  for (const char* name : {"ft", "Feet", "foot"}) EXPECT_EQ(in_si(name, Dimension::length), 0.3048) << name;
  for (const char* name : {"mil", "mils", "thou"}) EXPECT_DOUBLE_EQ(in_si(name, Dimension::length), 2.54e-5) << name;
  EXPECT_DOUBLE_EQ(in_si("ft-lb", Dimension::torque), 12 * in_si("in-lbs", Dimension::torque));
  EXPECT_DOUBLE_EQ(in_si("lbf.in", Dimension::torque), 4.4482216152605 * 0.0254);
  EXPECT_EQ(in_si("g", Dimension::acceleration), 9.80665);
  EXPECT_EQ(find_unit("MN"), nullptr);
  EXPECT_EQ(units().back().name, "uV");  // nobody's numbers are taken for ounces
}

}  // namespace
}  // namespace mbk::recording
