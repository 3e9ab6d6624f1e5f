#include "mbk/present/report/schedule_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::report {
namespace {

using perturbation::Multisine;
using perturbation::Quantity;
using perturbation::Schedule;
using perturbation::Space;

std::string text_of(Quantity quantity, Space space) {
  const Multisine first = Multisine::create(1.0, {{2, 0.01, 0.0}}).value();
  const Multisine second = Multisine::create(1.0, {{3, 0.02, 0.0}}).value();
  return schedule_text(Schedule::multisine(first, second, quantity, space, 20.0, 1.0).value());
}

TEST(ScheduleText, SpeaksTheUnitThatPeopleThinkIn) {
  EXPECT_THAT(text_of(Quantity::position, Space::hand), testing::HasSubstr("first axis 10, second 20"));
  EXPECT_THAT(text_of(Quantity::position, Space::hand), testing::HasSubstr(" mm at "));
  EXPECT_THAT(text_of(Quantity::position, Space::joint), testing::HasSubstr("first axis 0.573, second 1.146"));
  EXPECT_THAT(text_of(Quantity::force, Space::hand), testing::HasSubstr("first axis 0.01, second 0.02"));
}

TEST(ScheduleText, AForceHasARateAndNoSpeed) {
  const std::string force = text_of(Quantity::force, Space::hand), torque = text_of(Quantity::force, Space::joint);
  EXPECT_THAT(force, testing::ContainsRegex("force rate    [0-9.]+ N/s at most"));
  EXPECT_THAT(torque, testing::ContainsRegex("torque rate   [0-9.]+ N·m/s at most"));
  for (const std::string& text : {force, torque}) {
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("speed")));
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("acceleration")));
  }
  const std::string position = text_of(Quantity::position, Space::hand);
  EXPECT_THAT(position, testing::ContainsRegex("speed         [0-9.]+ mm/s at most"));
  EXPECT_THAT(position, testing::HasSubstr(" mm/s² at most"));
}

TEST(ScheduleText, NamesTheBand) {
  EXPECT_THAT(text_of(Quantity::force, Space::hand), testing::HasSubstr("2 to 3 Hz"));
}

}  // namespace
}  // namespace mbk::report
