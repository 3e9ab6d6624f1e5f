// A schema has the words of an enumeration that the code has for it, all of them and no other.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "mbk/experiment/drivers/bridge_check.h"
#include "mbk/model/trial/frequency_response.h"
#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"
#include "mbk/model/trial/prepared_dynamics.h"
#include "mbk/model/trial/robot_identification.h"
#include "mbk/model/trial/sensor_calibration.h"
#include "mbk/model/trial/teleoperation.h"
#include "mbk/model/trial/transfer_function.h"
#include "tests/support/schemas.h"

namespace mbk {
namespace {

template <HasWords Enum>
void expect_words(const std::string& name, const std::string& place, std::set<std::string> expected = {}) {
  const auto& schema = schemas::file(name + ".schema.json").at(nlohmann::json::json_pointer(place));
  for (const auto& [value, word] : kWords<Enum>) expected.emplace(word);
  EXPECT_EQ(schema.at("enum").get<std::set<std::string>>(), expected) << name << place;
}

TEST(WordsOfSchemas, AreThoseOfTheEnumerations) {
  expect_words<RobotMethod>("robot", "/properties/method");
  expect_words<InstrumentMotion>("robot", "/properties/instruments");
  expect_words<SensorWarningCode>("sensor", "/definitions/SensorWarning/properties/code");
  expect_words<TransferFunctionMethod>("tf", "/properties/method");
  expect_words<InputHold>("tf", "/properties/hold");
  expect_words<AdmittanceOutput>("tf", "/definitions/InvertedAdmittance/properties/admittance_to");
  expect_words<FrequencyResponseMethod>("explore", "/definitions/FrequencyResponseEstimate/properties/method");
  expect_words<DelayedResponse>("explore", "/definitions/ParallelCascadeEstimate/properties/delayed_response");
  expect_words<StabilityVerdict>("teleop", "/definitions/Stability/properties/verdict");
  expect_words<StabilityCondition>("teleop", "/definitions/Stability/properties/conditions/items/properties/name");
  expect_words<MotionOutcome>("teleop", "/properties/simulation/properties/runs/items/properties/outcome");
  expect_words<drivers::BridgeRule>("robot_check", "/definitions/BridgeRule");
  expect_words<drivers::RuleVerdict>("robot_check", "/definitions/LinkCheck/properties/rules/items/properties/verdict");
}

}  // namespace
}  // namespace mbk
