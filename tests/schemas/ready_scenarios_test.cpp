// What is written of every ready scenario fits the schemas.
#include "mbk/simulate/laboratory/ready_scenarios.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <variant>
#include <vector>

#include "mbk/files/recording/inspect.h"
#include "mbk/measure/analyse/posture.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/present/result/json.h"
#include "mbk/present/result/report_json.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "tests/support/schemas.h"

namespace mbk {
namespace {

using schemas::fits_its_schema;

class ReadyScenario : public testing::TestWithParam<std::string_view> {};

std::vector<std::string_view> names() {
  std::vector<std::string_view> all;
  for (const laboratory::ReadyScenario& one : laboratory::ready_scenarios()) all.push_back(one.name);
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, ReadyScenario, testing::ValuesIn(names()),
                         [](const auto& one) { return std::string(one.param); });

/// The recording of its first trial; that of a multisine or a binary sequence is over sooner.
Recording recorded(std::string_view name) {
  laboratory::Scenario scenario =
      laboratory::read_scenarios(laboratory::find_ready_scenario(name)->text, std::string(name) + ".toml")
          .value()
          .front();
  auto& kind = scenario.perturbation.kind;
  if (auto* sines = std::get_if<perturbation::MultisinePlan>(&kind)) sines->duration = 12.0;
  if (auto* binary = std::get_if<perturbation::RandomBinaryPlan>(&kind)) binary->duration = 12.0;
  if (auto* ramps = std::get_if<perturbation::RampPlan>(&kind)) ramps->ramps.repetitions = 1;
  if (auto* stretches = std::get_if<perturbation::StretchPlan>(&kind)) {
    stretches->stretches.speeds = {1.0, 3.0};
    stretches->stretches.repetitions = 1;
  }
  return laboratory::simulate(scenario).value().recording;
}

TEST_P(ReadyScenario, EveryDocumentOfItFitsItsSchema) {
  const Recording recording = recorded(GetParam());
  const std::vector<Inspection> inspections = {recording::inspect(recording)};
  EXPECT_TRUE(fits_its_schema(result::to_json(std::vector{recording}, inspections)));
  EXPECT_TRUE(fits_its_schema(result::to_json(std::vector{recording, recording}, {inspections[0], inspections[0]})));

  for (const Method method : {Method::least_squares, Method::instrumental_variables}) {
    measurement::Options options;
    options.identify.method = method;
    const auto examined = measurement::examine({&recording, 1}, options);
    if (method == Method::instrumental_variables && !examined) continue;  // without a reference there is no instrument
    ASSERT_TRUE(examined) << examined.error().line();
    const Measurement& measured = examined->measured;
    EXPECT_TRUE(fits_its_schema(result::to_json(measured)));
    EXPECT_TRUE(fits_its_schema(result::to_json({measured, measured}, {{}, "two of one", {}})));
    ASSERT_TRUE(measured.passivity);
    EXPECT_TRUE(fits_its_schema(result::to_json(std::array{
        result::PassivityDocument{measured.identification.sources, *measured.passivity, measured.energies}})));
    if (measured.findings || measured.spatial) {
      EXPECT_TRUE(fits_its_schema(result::ellipses_json({&measured, 1})));
    }
    const Preparation& how = measured.identification.preparations.front();
    const result::RecordingFacts facts = {recording.metadata, analyse::posture(recording, how.from_s, how.to_s)};
    EXPECT_TRUE(fits_its_schema(result::to_json(
        result::Report{{{measured, {facts}, examined->diagnostics.front()}}, {}, "mbk measure", "a note"})));
  }
}

}  // namespace
}  // namespace mbk
