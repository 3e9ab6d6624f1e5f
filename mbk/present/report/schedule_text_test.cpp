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
  return schedule_text(Schedule::multisine({first, second}, quantity, space, 20.0, 1.0).value());
}

TEST(ScheduleText, SpeaksTheUnitThatPeopleThinkIn) {
  EXPECT_THAT(text_of(Quantity::position, Space::hand),
              testing::ContainsRegex("peak [^\n]* mm [^\n]* 10, [^\n]* 20\n"));
  EXPECT_THAT(text_of(Quantity::position, Space::joint), testing::ContainsRegex("peak [^\n]* 0.573, [^\n]* 1.146\n"));
  EXPECT_THAT(text_of(Quantity::force, Space::hand), testing::ContainsRegex("peak [^\n]* 0.01, [^\n]* 0.02\n"));
}

TEST(ScheduleText, NamesAllAxesOfAHandInSpace) {
  const Multisine axis = Multisine::create(1.0, {{2, 0.01, 0.0}}).value();
  const std::string text = schedule_text(
      Schedule::multisine({axis, axis, axis.scaled(2.0)}, Quantity::position, Space::hand, 20.0, 1.0).value());
  EXPECT_THAT(text, testing::ContainsRegex("peak [^\n]* mm [^\n]*; first axis 10, second 10, third 20\n"));
  EXPECT_THAT(text, testing::ContainsRegex("crest factor  first axis [0-9.]+, second [0-9.]+, third [0-9.]+, with"));
}

TEST(ScheduleText, AForceHasARateAndNoSpeed) {
  const std::string force = text_of(Quantity::force, Space::hand), torque = text_of(Quantity::force, Space::joint);
  EXPECT_THAT(force, testing::ContainsRegex("force rate    peak [0-9.]+ N/s"));
  EXPECT_THAT(torque, testing::ContainsRegex("torque rate   peak [0-9.]+ N·m/s"));
  for (const std::string& text : {force, torque}) {
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("speed")));
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("acceleration")));
  }
  const std::string position = text_of(Quantity::position, Space::hand);
  EXPECT_THAT(position, testing::ContainsRegex("speed         peak [0-9.]+ mm/s "));
  EXPECT_THAT(position, testing::HasSubstr(" mm/s²"));
}

TEST(ScheduleText, NamesTheBand) {
  EXPECT_THAT(text_of(Quantity::force, Space::hand), testing::ContainsRegex("band +2 [^\n]*3 Hz"));
}

}  // namespace
}  // namespace mbk::report
