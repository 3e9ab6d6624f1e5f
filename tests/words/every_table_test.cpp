#include <gtest/gtest.h>

#include <algorithm>

#include "mbk/base/core/printable.h"
#include "mbk/base/dsp/zero_phase.h"
#include "mbk/experiment/console/command.h"
#include "mbk/experiment/console/console.h"
#include "mbk/experiment/console/refusals.h"
#include "mbk/experiment/control/sequencer.h"
#include "mbk/experiment/device/wiring.h"
#include "mbk/experiment/drivers/bridge_check.h"
#include "mbk/experiment/drivers/datagram.h"
#include "mbk/experiment/protocol/trial_sections.h"
#include "mbk/experiment/safety/motors_off.h"
#include "mbk/experiment/safety/trip.h"
#include "mbk/files/journal/journal.h"
#include "mbk/files/recording/write.h"
#include "mbk/measure/calibration/force_sensor.h"
#include "mbk/model/perturbation/schedule_plan.h"
#include "mbk/model/trial/arm_posture.h"
#include "mbk/model/trial/frequency_response.h"
#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"
#include "mbk/model/trial/prepared_dynamics.h"
#include "mbk/model/trial/readers.h"
#include "mbk/model/trial/reproduction.h"
#include "mbk/model/trial/robot_identification.h"
#include "mbk/model/trial/sensor_calibration.h"
#include "mbk/model/trial/teleoperation.h"
#include "mbk/model/trial/transfer_function.h"
#include "mbk/model/trial/verdict.h"
#include "mbk/model/trial/warning.h"
#include "mbk/study/validation/fault_kinds.h"
#include "mbk/study/validation/virtual_sensor_trials.h"
#include "mbk/teleop/design.h"

namespace mbk {
namespace {

template <class Enum>
class WordsOf : public testing::Test {};

using Enumerations =
    testing::Types<dsp::Extension, perturbation::Quantity, perturbation::LimitedSignal,
                   perturbation::MultisinePlan::Phases, perturbation::MultisinePlan::Axes, AccelerationSource,
                   AdmittanceOutput, Agreement, ArmPosture::Of, ChartSeries::Drawn, DelayedResponse, Exhibit::Kind,
                   ForceSource, FrequencyResponseMethod, InputHold, InstrumentMotion, Method, Mode, MotionOutcome,
                   ParametersFrom, Procedure, Protocol, Provenance, Readers, ReferenceQuantity, RobotMethod,
                   SensorWarningCode, StabilityCondition, StabilityVerdict, Structure, TransferFunctionMethod, Verdict,
                   WarningCode, journal::Ending::How, recording::Format, calibration::SensorFrame, teleop::Architecture,
                   teleop::Form, teleop::SimulatedArm::Kind, control::Phase, device::Motors, device::Wiring::Frame,
                   drivers::Refusal, drivers::BridgeRule, drivers::RuleVerdict, safety::Reason,
                   safety::MotorsOff::State, protocol::Machine, console::Action, console::Question, console::Refusal,
                   ElbowSide, validation::Force, validation::TrialKind>;
TYPED_TEST_SUITE(WordsOf, Enumerations);

TYPED_TEST(WordsOf, GoBothWays) {
  for (const auto& [value, word] : kWords<TypeParam>) {
    EXPECT_EQ(word_of(value), word);
    EXPECT_EQ(value_of<TypeParam>(word), value) << word;
    EXPECT_NE(std::ranges::find(kWordList<TypeParam>, word), kWordList<TypeParam>.end()) << word;
  }
  EXPECT_FALSE(value_of<TypeParam>("no such word"));
}

TYPED_TEST(WordsOf, StandOnOneLineWithoutSpaceAround) {
  for (const std::string_view word : kWordList<TypeParam>) {
    EXPECT_EQ(printable(std::string(word)), word);
    EXPECT_FALSE(word.starts_with(' ') || word.ends_with(' ')) << word;
  }
}

}  // namespace
}  // namespace mbk
