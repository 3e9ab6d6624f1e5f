#include "mbk/measure/calibration/spring_design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/measure/calibration/spring_array.h"

namespace mbk::calibration {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using ::testing::HasSubstr;

constexpr double kStiffnessMet = 1e-6;  // of the largest entry of K
constexpr double kPlaceMet = 1e-6;      // [m], a fiftieth of what the encoders resolve

struct Published {
  const char* name;
  double kxx, kyy, ks, x0_mm, y0_mm;
};

/// Stiffness fields of Dyck 2013, tables 3.1 and 5.1, as printed [N/m], [mm].
constexpr Published kPublished[] = {
    {"3.1, 1", 443.86, 232.34, 16.74, 393, -55},  {"3.1, 2", 427.08, 273.83, 37.87, 407, 35},
    {"3.1, 3", 310.43, 306.69, -101.75, 448, 61}, {"3.1, 4", 402.95, 262.68, -69.14, 418, -53},
    {"3.1, 5", 260.70, 404.66, -73.49, 343, 29},  {"3.1, 6", 233.32, 464.70, -17.40, 420, -8},
    {"5.1, K1", 421.57, 213.35, -18.87, 364, -9}, {"5.1, K2", 476.38, 248.71, -16.02, 375, -8},
    {"5.1, K3", 239.54, 421.29, -12.52, 394, 53}, {"5.1, K4", 190.26, 406.39, -2.08, 390, 36},
    {"5.1, K5", 373.81, 377.10, 73.16, 332, -61},
};

SpringRequest request_for(const Published& field) {
  SpringRequest request;
  request.K << field.kxx, field.ks, field.ks, field.kyy;
  request.equilibrium = Vector2d(field.x0_mm, field.y0_mm) / 1000.0;
  return request;
}

class EveryPublishedField : public ::testing::TestWithParam<Published> {};

TEST_P(EveryPublishedField, IsMadeExactlyBySpringsThatStayInTension) {
  for (const bool disc : {false, true}) {
    SpringRequest request = request_for(GetParam());
    if (disc) {
      for (const Vector2d& eye : request.eyes) request.holes.push_back(facing_hole(eye, kFrameCentre));
    }
    const auto design = design_springs(request);
    ASSERT_TRUE(design) << GetParam().name << ": " << design.error().line();
    const SpringField& field = design->field;
    EXPECT_LT((field.K - request.K).cwiseAbs().maxCoeff(), kStiffnessMet * request.K.maxCoeff()) << GetParam().name;
    EXPECT_LT((field.equilibrium - request.equilibrium).norm(), kPlaceMet) << GetParam().name;
    EXPECT_GE(field.linearisation.smallest_extension, request.min_extension - kPlaceMet) << GetParam().name;
    for (const Spring& spring : field.springs) {
      EXPECT_GE(spring.stiffness, request.stiffness.first - 1e-6);
      EXPECT_LE(spring.stiffness, request.stiffness.second + 1e-6);
      EXPECT_GE(spring.rest_length, request.rest_length.first - 1e-8);
      EXPECT_LE(spring.rest_length, request.rest_length.second + 1e-8);
    }
    RecordProperty(disc ? "error_percent_disc" : "error_percent",
                   std::to_string(100.0 * field.linearisation.relative_error()));
  }
}

INSTANTIATE_TEST_SUITE_P(SpringDesign, EveryPublishedField, ::testing::ValuesIn(kPublished));

/// Mean square of F + K δ over a fine grid of the circle [N²].
double mean_square_deviation(const std::vector<Spring>& springs, const SpringRequest& request) {
  const auto array = SpringArray::create(springs);
  double sum = 0.0;
  int count = 0;
  for (int ring = 1; ring <= 3; ++ring) {
    for (int k = 0; k < 16; ++k, ++count) {
      const double angle = 2 * std::numbers::pi * k / 16;
      const Vector2d delta = request.travel * ring / 3 * Vector2d(std::cos(angle), std::sin(angle));
      sum += (array->force(request.equilibrium + delta) + request.K * delta).squaredNorm();
    }
  }
  return sum / count;
}

TEST(SpringDesign, IsStraighterThanTheRandomArraysWithTheSameStiffness) {
  // Arrays drawn at random have some stiffness and equilibrium; the design for these must be at least as straight.
  numeric::Random random(5);
  int compared = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<Spring> springs;
    for (const Vector2d& eye : frame_eyes(kFrameCentre)) {
      springs.push_back({random.uniform(25.0, 200.0), random.uniform(0.065, 0.100), eye});
    }
    const auto array = SpringArray::create(springs);
    const auto field = spring_field(*array, kFrameCentre, 0.03);
    if (!field || field->linearisation.smallest_extension < 0.002) continue;
    SpringRequest request;
    request.K = field->K;
    request.equilibrium = field->equilibrium;
    const auto design = design_springs(request);
    ASSERT_TRUE(design) << design.error().line();
    // 1 %: the ridge of the program, which keeps springs moderate where the deviation leaves them open
    EXPECT_LE(mean_square_deviation(design->field.springs, request), 1.01 * mean_square_deviation(springs, request));
    ++compared;
  }
  EXPECT_GE(compared, 20);
}

TEST(SpringDesign, UsesNoMoreSpringsThanAllowed) {
  SpringRequest request = request_for(kPublished[0]);
  request.max_springs = 4;
  const auto design = design_springs(request);
  ASSERT_TRUE(design) << design.error().line();
  EXPECT_LE(design->field.springs.size(), 4u);
  EXPECT_LT((design->field.K - request.K).norm(), kStiffnessMet * request.K.norm());
}

TEST(SpringDesign, GivesNaturalFrequenciesOfThePayload) {
  SpringRequest request = request_for({"round", 300, 300, 0, 390, 0});
  request.payload = 300.0 / std::pow(2 * std::numbers::pi * 3.0, 2);  // 3 Hz
  const auto design = design_springs(request);
  ASSERT_TRUE(design) << design.error().line();
  EXPECT_LT((design->natural_frequency - Vector2d(3, 3)).norm(), 1e-6);
}

TEST(SpringDesign, SaysTheNearestWhereNoSpringsGiveIt) {
  SpringRequest request = request_for({"far too stiff", 9000, 9000, 0, 390, 0});
  const auto design = design_springs(request);
  ASSERT_FALSE(design);
  EXPECT_EQ(design.error().kind, ErrorKind::not_usable);
  EXPECT_THAT(design.error().line(), HasSubstr("kxx"));
  request = request_for(kPublished[0]);
  request.equilibrium = {0.39 + 0.3, 0.0};  // outside the frame: nothing pulls further out
  EXPECT_EQ(design_springs(request).error().kind, ErrorKind::not_usable);
}

TEST(SpringDesign, RefusesWhatCannotBeAsked) {
  const auto line = [](auto change) {
    SpringRequest request = request_for(kPublished[0]);
    change(request);
    const auto design = design_springs(request);
    EXPECT_FALSE(design);
    return design ? std::string() : design.error().line();
  };
  EXPECT_THAT(line([](auto& r) { r.K(0, 1) = 1.0; }), HasSubstr("symmetr"));
  EXPECT_THAT(line([](auto& r) { r.K << 1, 2, 2, 1; }), AllOf(HasSubstr("-1 "), HasSubstr("3 N/m")));
  EXPECT_THAT(line([](auto& r) { r.stiffness = {5, 5}; }), HasSubstr("5 N/m"));
  EXPECT_THAT(line([](auto& r) { r.rest_length = {0.1, 0.05}; }), AllOf(HasSubstr("100"), HasSubstr("50 mm")));
  EXPECT_THAT(line([](auto& r) { r.eyes.resize(2); }), HasSubstr("2 screw eyes"));
  EXPECT_THAT(line([](auto& r) { r.holes.resize(2); }), HasSubstr("2 holes"));
  EXPECT_THAT(line([](auto& r) { r.travel = 0; }), AllOf(HasSubstr("travel"), HasSubstr(" 0 mm")));
  EXPECT_THAT(line([](auto& r) { r.payload = -1.0; }), HasSubstr("-1 kg"));
}

TEST(Frame, HasItsEyesAtCornersAndMiddlesAndTheHolesFaceThem) {
  const auto eyes = frame_eyes({0.39, 0.0});
  ASSERT_EQ(eyes.size(), 8u);
  EXPECT_LT((eyes[1] - Vector2d(0.565, 0.183)).norm(), 1e-12);
  for (const Vector2d& eye : eyes) {
    const Vector2d hole = facing_hole(eye, {0.39, 0.0});
    EXPECT_NEAR(hole.norm(), 0.01125, 1e-12);
    // corners stand at 46.3°, holes at 45°
    EXPECT_GT(hole.normalized().dot((eye - Vector2d(0.39, 0.0)).normalized()), std::cos(0.03));
  }
}

}  // namespace
}  // namespace mbk::calibration
