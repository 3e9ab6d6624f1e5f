#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <typeinfo>
#include <vector>

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
#include "mbk/model/trial/emg_estimate.h"
#include "mbk/model/trial/frequency_response.h"
#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"
#include "mbk/model/trial/prepared_dynamics.h"
#include "mbk/model/trial/readers.h"
#include "mbk/model/trial/reproduction.h"
#include "mbk/model/trial/robot_identification.h"
#include "mbk/model/trial/sensor_calibration.h"
#include "mbk/model/trial/stretch_estimate.h"
#include "mbk/model/trial/teleoperation.h"
#include "mbk/model/trial/transfer_function.h"
#include "mbk/model/trial/verdict.h"
#include "mbk/model/trial/warning.h"
#include "mbk/teleop/design.h"
#include "mbk/validate/fault_kinds.h"
#include "mbk/validate/virtual_sensor_trials.h"

namespace mbk {
namespace {

/// What the words of one enumeration do.
struct Row {
  std::string_view word, said;  ///< of a value, and what word_of says of it
  bool comes_back, listed;
};
struct Table {
  std::string type;
  std::vector<Row> rows;
  std::vector<std::string_view> list;
  bool takes_nonsense;
};

template <class Enum>
Table table_of() {
  Table table{typeid(Enum).name(),
              {},
              {kWordList<Enum>.begin(), kWordList<Enum>.end()},
              value_of<Enum>("no such word").has_value()};
  for (const auto& [value, word] : kWords<Enum>) {
    table.rows.push_back(
        {word, word_of(value), value_of<Enum>(word) == value, std::ranges::find(table.list, word) != table.list.end()});
  }
  return table;
}

template <class... Enums>
std::vector<Table> tables_of(std::type_identity<std::tuple<Enums...>> /*of*/) {
  return {table_of<Enums>()...};
}

using Enumerations =
    std::tuple<dsp::Extension, perturbation::Quantity, perturbation::LimitedSignal, perturbation::MultisinePlan::Phases,
               perturbation::MultisinePlan::Axes, perturbation::Stretches::Order, AccelerationSource, AdmittanceOutput,
               Agreement, ArmPosture::Of, CatchFinding, ChartSeries::Drawn, DelayedResponse, EmgChange, EmgProblem,
               Exhibit::Kind, ForceSource, FrequencyResponseMethod, InputHold, InstrumentMotion, Method, Mode,
               MotionOutcome, ParametersFrom, Procedure, Protocol, Provenance, Readers, ReferenceQuantity, RobotMethod,
               SensorWarningCode, StabilityCondition, StabilityVerdict, Structure, TransferFunctionMethod,
               VelocityDependence, Verdict, WarningCode, journal::Ending::How, recording::Format,
               calibration::SensorFrame, teleop::Architecture, teleop::Form, teleop::SimulatedArm::Kind, control::Phase,
               device::Motors, device::Wiring::Frame, drivers::Refusal, drivers::BridgeRule, drivers::RuleVerdict,
               safety::Reason, safety::MotorsOff::State, protocol::Machine, console::Action, console::Question,
               console::Refusal, ElbowSide, validation::Force, validation::TrialKind>;

std::vector<Table> tables() {
  return tables_of(std::type_identity<Enumerations>());
}

TEST(Words, GoBothWays) {
  for (const Table& table : tables()) {
    EXPECT_FALSE(table.rows.empty()) << table.type;
    EXPECT_FALSE(table.takes_nonsense) << table.type;
    for (const Row& row : table.rows) {
      EXPECT_EQ(row.said, row.word) << table.type;
      EXPECT_TRUE(row.comes_back) << table.type << ": " << row.word;
      EXPECT_TRUE(row.listed) << table.type << ": " << row.word;
    }
  }
}

TEST(Words, StandOnOneLineWithoutSpaceAround) {
  for (const Table& table : tables()) {
    for (const std::string_view word : table.list) {
      EXPECT_EQ(printable(std::string(word)), word) << table.type;
      EXPECT_FALSE(word.starts_with(' ') || word.ends_with(' ')) << table.type << ": " << word;
    }
  }
}

}  // namespace
}  // namespace mbk
