// Reference mode against the published procedure in 113-bit arithmetic, which shares no filter with mbk.
#include <gtest/gtest.h>

#include "mbk/files/recording/read.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/reference/quad_procedure.h"

namespace mbk::pipeline {
namespace reference_mode_test {

/// What is promised of reference mode; filters in double leave 1e-11 and less.
constexpr double kPromised = 1e-9;

std::vector<double> samples(const Recording& recording, const char* channel) {
  const Vector& values = recording.find(channel)->values;
  return {values.begin(), values.end()};
}

reference::Log as_log(const Recording& r) {
  return {samples(r, "hand_x"),         samples(r, "hand_y"),        samples(r, "force_x"),
          samples(r, "force_y"),        samples(r, "reference_x"),   samples(r, "reference_y"),
          samples(r, "acceleration_x"), samples(r, "acceleration_y")};
}

/// Noise and quantisation as on the robot, and an arm that is not symmetric.
laboratory::PrescribedMotionOptions noisy(mbk::Protocol protocol, std::uint64_t seed) {
  laboratory::PrescribedMotionOptions options;
  options.protocol = protocol;
  options.seed = seed;
  options.limb.M(0, 1) += 0.1;
  options.sensors.coloured_force_noise = 0.2;
  return options;
}

struct Case {
  const char* name;
  mbk::Protocol protocol;
  Procedure procedure;
  std::optional<double> handle_mass;
};

void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

class ReferenceMode : public testing::TestWithParam<Case> {
 protected:
  static measurement::Options options_of_mbk(ParametersFrom samples) {
    measurement::Options options;
    options.preprocess.mode = Mode::reference;
    options.preprocess.procedure = GetParam().procedure;
    options.identify.handle_mass = GetParam().handle_mass.value_or(0.0);
    options.identify.parameters_from = samples;
    return options;
  }
  static reference::Settings settings_of_twin() {
    return {.procedure = GetParam().procedure == Procedure::chapter3 ? reference::Procedure::chapter3
                                                                     : reference::Procedure::chapter5,
            .protocol = GetParam().protocol == mbk::Protocol::sinusoidal ? reference::Protocol::sinusoidal
                                                                         : reference::Protocol::underdamped,
            .handle_mass = GetParam().handle_mass};
  }
};
INSTANTIATE_TEST_SUITE_P(
    Logs, ReferenceMode,
    testing::Values(Case{"Chapter3Sinusoidal", mbk::Protocol::sinusoidal, Procedure::chapter3, {}},
                    Case{"Chapter3Underdamped", mbk::Protocol::underdamped, Procedure::chapter3, {}},
                    Case{"Chapter5Sinusoidal", mbk::Protocol::sinusoidal, Procedure::chapter5, 0.194},
                    Case{"Chapter5Underdamped", mbk::Protocol::underdamped, Procedure::chapter5, 0.194}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_P(ReferenceMode, AgreesWithTheTwin) {
  const Recording recording = generated(noisy(GetParam().protocol, 7));
  const auto expected = reference::identify(as_log(recording), settings_of_twin());
  ASSERT_TRUE(expected) << expected.error().line();
  for (const auto& [samples, answer] :
       {std::pair(ParametersFrom::identification, expected->split), std::pair(ParametersFrom::all, expected->all)}) {
    SCOPED_TRACE(word_of(samples));
    const auto got = measurement::measure({&recording, 1}, options_of_mbk(samples));
    ASSERT_TRUE(got) << got.error().line();
    const Identification& id = got->identification;
    const std::pair<const char*, double> differences[] = {{"M", difference(id.model.M, matrix2(answer.M))},
                                                          {"B", difference(id.model.B, matrix2(answer.B))},
                                                          {"K", difference(id.model.K, matrix2(answer.K))},
                                                          {"x0", difference(id.model.x0, vector2(answer.x0))},
                                                          {"VAF", difference(id.fit.vaf, vector2(answer.VAF))}};
    for (const auto& [what, value] : differences) {
      EXPECT_LE(value, kPromised) << what;
      // digits that agree
      RecordProperty(fmt::format("{}_{}", what, word_of(samples)), std::to_string(-std::log10(value + 1e-300)));
    }
    EXPECT_LT(id.fit.vaf.minCoeff(), 99.99);  // noise is there
  }
  EXPECT_NE(expected->split.M, expected->all.M);
}

TEST(ReferenceModeOfChapter5, TakesTheHandleOffTheDiagonalOnly) {
  const Recording recording = generated(noisy(mbk::Protocol::sinusoidal, 3));
  measurement::Options options;
  options.preprocess.mode = Mode::reference;
  options.preprocess.procedure = Procedure::chapter5;
  const Matrix with = measurement::measure({&recording, 1}, options)->identification.model.M;
  options.identify.handle_mass = 0.194;
  const Matrix without = measurement::measure({&recording, 1}, options)->identification.model.M;
  EXPECT_LE((with - without - 0.194 * Matrix::Identity(2, 2)).cwiseAbs().maxCoeff(), 1e-15);
}

class Golden : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Logs, Golden, testing::Values("sinusoidal", "underdamped"),
                         [](const auto& one) { return std::string(one.param); });

TEST_P(Golden, ReferenceModeAgreesWithItsExpectedNumbers) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "MBK_DATA_DIR is not set";
  const auto golden = *folder / "golden";
  const auto expected = nlohmann::json::parse(std::ifstream(golden / "expected.json"))[GetParam()]["quad"];
  const auto recording = recording::read(golden / (std::string(GetParam()) + ".mat"), {});
  ASSERT_TRUE(recording) << recording.error().line();
  measurement::Options options;
  options.preprocess.mode = Mode::reference;
  const auto got = measurement::measure({&*recording, 1}, options);
  ASSERT_TRUE(got) << got.error().line();
  const Identification& id = got->identification;
  EXPECT_EQ(word_of(id.preparations[0].protocol), GetParam());
  const auto numbers = [&](const char* name) { return expected[name].get<std::vector<double>>(); };
  EXPECT_LE(difference(id.model.M, matrix2(numbers("M"))), kPromised);
  EXPECT_LE(difference(id.model.B, matrix2(numbers("B"))), kPromised);
  EXPECT_LE(difference(id.model.K, matrix2(numbers("K"))), kPromised);
  EXPECT_LE(difference(id.model.x0, vector2(numbers("x0"))), kPromised);
  EXPECT_LE(difference(id.fit.vaf, vector2(numbers("VAF"))), kPromised);
}

}  // namespace reference_mode_test
}  // namespace mbk::pipeline
