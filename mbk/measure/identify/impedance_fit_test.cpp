#include "mbk/measure/identify/impedance_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/measure/identify/test_trials.h"

namespace mbk::identify {
namespace impedance_fit_test {

using testing::HasSubstr;
using testing_support::arm;
using testing_support::Making;
using testing_support::trial;

/// Rounding of 40,000 rows through a regression whose condition is about 20.
constexpr double kExact = 1e-11;

Vector flat(const impedance::Model& model) {
  Vector values(3 * model.M.size() + model.x0.size());
  values << Vector(model.M.transpose().reshaped()), Vector(model.B.transpose().reshaped()),
      Vector(model.K.transpose().reshaped()), model.x0;
  return values;
}

void expect_model(const impedance::Model& got, const impedance::Model& expected, double tolerance) {
  EXPECT_LE((got.M - expected.M).norm(), tolerance * expected.M.norm()) << got.M;
  EXPECT_LE((got.B - expected.B).norm(), tolerance * std::max(1.0, expected.B.norm())) << got.B;
  EXPECT_LE((got.K - expected.K).norm(), tolerance * expected.K.norm()) << got.K;
  EXPECT_LE((got.x0 - expected.x0).norm(), tolerance * expected.x0.norm()) << got.x0;
}

Identification identified(const std::vector<PreparedTrial>& trials, const Options& options = {}) {
  auto result = identify_impedance(trials, options);
  EXPECT_TRUE(result) << result.error().line();
  return result ? *result : Identification{};
}

TEST(IdentifyImpedance, RecoversTwoAxesExactlyFromDataWithoutNoise) {
  const Identification id = identified({trial(arm())});
  expect_model(id.model, arm(), kExact);
  EXPECT_NEAR(id.fit.vaf.minCoeff(), 100.0, 1e-9);
  EXPECT_LE(id.fit.rmse.maxCoeff(), 1e-10);
  EXPECT_LE(flat(id.standard_error).maxCoeff(), 1e-9);
}

TEST(IdentifyImpedance, RecoversOneAxisExactly) {
  const Identification id = identified({trial(arm(1), {.axes = 1})});
  expect_model(id.model, arm(1), kExact);
  EXPECT_EQ(id.parameters, (std::vector<std::string>{"m", "b", "k", "x0"}));
  EXPECT_EQ(id.covariance.rows(), 4);
}

TEST(IdentifyImpedance, RecoversThreeAxesExactly) {
  const Identification id = identified({trial(arm(3), {.axes = 3})});
  expect_model(id.model, arm(3), kExact);
  EXPECT_EQ(id.covariance.rows(), 30);
  ASSERT_EQ(id.parameters.size(), 30U);
  EXPECT_EQ(id.parameters[1], "m_xy");
  EXPECT_EQ(id.parameters[26], "k_zz");
  EXPECT_EQ(id.parameters[29], "z0");
}

/// The trial as it is in a frame whose axes are the rows of R.
PreparedTrial turned(PreparedTrial made, const Matrix& R) {
  for (Matrix* signal : {&made.position, &made.velocity, &made.acceleration, &made.force_hand_on_robot}) {
    *signal = Matrix(*signal * R.transpose());
  }
  return made;
}

TEST(IdentifyImpedance, InAnotherFrameIsTheSameModelTurned) {
  const Eigen::Matrix3d R = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized().toRotationMatrix();
  const PreparedTrial made = trial(arm(3), {.axes = 3, .noise = 0.3});
  const Identification id = identified({made}), other = identified({turned(made, R)});
  const impedance::Model& m = id.model;
  const Matrix back = R.transpose();
  expect_model(other.model, {R * m.M * back, R * m.B * back, R * m.K * back, R * m.x0}, 1e-9);
  // Their covariance turns with them: of Z' = R Z Rᵀ, row by row.
  Matrix turn = Matrix::Zero(9, 9);
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 3; ++j) turn.block<3, 3>(3 * i, 3 * j) = R(i, j) * R;
  }
  const Matrix here = other.covariance.topLeftCorner(9, 9), there = id.covariance.topLeftCorner(9, 9);
  EXPECT_LE((here - turn * there * turn.transpose()).norm(), 1e-6 * there.norm());
}

TEST(IdentifyImpedance, OfAPlaneWithinSpaceIsThatOfThePlane) {
  impedance::Model model = arm(3);
  for (Matrix* Z : {&model.M, &model.B, &model.K}) {
    Z->row(2).head(2).setZero();
    Z->col(2).head(2).setZero();
  }
  const PreparedTrial space = trial(model, {.axes = 3});
  PreparedTrial plane = space;
  plane.axes = 2;
  for (Matrix* signal : {&plane.position, &plane.velocity, &plane.acceleration, &plane.force_hand_on_robot}) {
    signal->conservativeResize(Eigen::NoChange, 2);
  }
  const Identification of_space = identified({space}), of_plane = identified({plane});
  EXPECT_LE((of_space.model.K.topLeftCorner(2, 2) - of_plane.model.K).norm(), 1e-9 * of_plane.model.K.norm());
  EXPECT_LE((of_space.model.M.topLeftCorner(2, 2) - of_plane.model.M).norm(), 1e-9 * of_plane.model.M.norm());
}

TEST(IdentifyImpedance, CoversTheTruthInThreeAxes) {
  constexpr int kRuns = 60;
  int covered = 0, all = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Identification id =
        identified({trial(arm(3), {.axes = 3, .samples = 6000, .sample_time = 0.01, .noise = 0.5, .seed = seed})});
    const Vector error = (flat(id.model) - flat(arm(3))).cwiseAbs();
    covered += static_cast<int>((error.array() < 1.959963984540054 * flat(id.standard_error).array()).count());
    all += static_cast<int>(error.size());
  }
  // 1,800 intervals of which those of one trial are related: 95 % ± 2 %.
  EXPECT_NEAR(static_cast<double>(covered) / all, 0.95, 0.02);
}

TEST(IdentifyImpedance, OfThreeAxesThatMoveInOnePlaneWarns) {
  PreparedTrial made = trial(arm(3), {.axes = 3, .noise = 0.3});
  const auto flatten = [](Matrix& signal) { signal.col(2) = 0.02 * (signal.col(2).array() - signal.col(2).mean()); };
  flatten(made.position);
  flatten(made.velocity);
  flatten(made.acceleration);
  const auto warnings = identified({made}).warnings;
  EXPECT_EQ(std::ranges::count(warnings, WarningCode::motion_on_one_line, &Warning::code), 1);
}

/// A trial whose force rests on two coefficients of a robot, and what is known of them.
PreparedTrial of_robot(bool exact) {
  PreparedTrial made = trial(arm(), {.samples = 2000, .sample_time = 0.02, .noise = exact ? 0.0 : 0.2});
  made.robot_covariance = (Matrix(2, 2) << 4e-4, -1e-4, -1e-4, 9e-4).finished();
  made.force_sensitivity.resize(made.time.size(), 4);
  made.force_sensitivity.col(0) = 3.0 * made.acceleration.col(0) + made.velocity.col(1);
  made.force_sensitivity.col(1) = (20.0 * made.velocity.col(0).array()).tanh();
  made.force_sensitivity.col(2) = made.acceleration.col(1) - made.acceleration.col(0);
  made.force_sensitivity.col(3) = 0.3 + (20.0 * made.velocity.col(1).array()).tanh();
  return made;
}

/// The same where the robot's coefficients are off by `error`.
PreparedTrial with_error(PreparedTrial made, const Vector& error) {
  for (Index axis = 0; axis < 2; ++axis) {
    made.force_hand_on_robot.col(axis) += made.force_sensitivity.middleCols(2 * axis, 2) * error;
  }
  return made;
}

TEST(IdentifyImpedance, CarriesTheUncertaintyOfARobotIntoTheModelAsRefitsDo) {
  for (const Structure structure : {Structure::full, Structure::symmetric}) {
    const PreparedTrial made = of_robot(false);
    const Options options{.structure = structure};
    const Identification id = identified({made}, options);
    Matrix slope(14, 2);
    constexpr double kStep = 1e-5;
    for (Index k = 0; k < 2; ++k) {
      const Vector step = kStep * Vector::Unit(2, k);
      slope.col(k) = (flat(identified({with_error(made, step)}, options).model) -
                      flat(identified({with_error(made, -step)}, options).model)) /
                     (2.0 * kStep);
    }
    const Vector expected = (slope * made.robot_covariance * slope.transpose()).diagonal().cwiseSqrt();
    ASSERT_TRUE(id.standard_error_of_robot);
    EXPECT_LE((flat(*id.standard_error_of_robot) - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.maxCoeff());
  }
}

TEST(IdentifyImpedance, AddsTheUncertaintyOfARobotToThatOfTheNoise) {
  PreparedTrial made = of_robot(false);
  const Identification whole = identified({made});
  ASSERT_TRUE(whole.standard_error_of_robot);
  made.force_sensitivity.resize(0, 0);
  const Identification noise_alone = identified({made});
  EXPECT_FALSE(noise_alone.standard_error_of_robot);
  const Vector squares =
      flat(noise_alone.standard_error).cwiseAbs2() + flat(*whole.standard_error_of_robot).cwiseAbs2();
  EXPECT_LE((flat(whole.standard_error).cwiseAbs2() - squares).cwiseAbs().maxCoeff(), 1e-12 * squares.maxCoeff());
}

TEST(IdentifyImpedance, SpreadsOverRobotsAsItsStandardErrorSays) {
  const PreparedTrial made = of_robot(true);
  const Vector said = flat(identified({made}).standard_error_of_robot.value());
  const Matrix root = numeric::Cholesky(made.robot_covariance).upper().transpose();
  numeric::Random random(3);
  constexpr int kRobots = 300;
  Vector squares = Vector::Zero(14);
  for (int k = 0; k < kRobots; ++k) {
    const Vector error = root * Eigen::Vector2d(random.normal(), random.normal());
    squares += (flat(identified({with_error(made, error)}).model) - flat(arm())).cwiseAbs2();
  }
  const Vector spread = (squares / kRobots).cwiseSqrt();
  constexpr double kScatter = 0.15;  // 1/√(2·300) is 4 %
  for (Index k = 0; k < 12; ++k) EXPECT_NEAR(spread[k], said[k], kScatter * said[k] + kExact) << k;
}

TEST(IdentifyImpedance, SymmetricStructureRecoversASymmetricArmAndTiesItsElements) {
  impedance::Model symmetric = arm();
  symmetric.M(1, 0) = symmetric.M(0, 1);
  symmetric.K(1, 0) = symmetric.K(0, 1);
  expect_model(identified({trial(symmetric)}, {.structure = Structure::symmetric}).model, symmetric, kExact);
  const Identification tied = identified({trial(arm(), {.noise = 0.3})}, {.structure = Structure::symmetric});
  EXPECT_EQ(tied.model.M(0, 1), tied.model.M(1, 0));
  EXPECT_EQ(tied.model.K(0, 1), tied.model.K(1, 0));
  EXPECT_NE(tied.model.B(0, 1), tied.model.B(1, 0));
  EXPECT_DOUBLE_EQ(tied.standard_error.K(0, 1), tied.standard_error.K(1, 0));
}

TEST(IdentifyImpedance, MassSpringRecoversAMassOnSprings) {
  for (const int axes : {1, 2}) {
    impedance::Model springs = arm(axes);
    springs.M = 0.9 * Matrix::Identity(axes, axes);
    springs.B.setZero();
    if (axes == 2) springs.K(1, 0) = springs.K(0, 1);
    const Identification id = identified({trial(springs, {.axes = axes})}, {.structure = Structure::mass_spring});
    expect_model(id.model, springs, kExact);
    EXPECT_TRUE(id.model.B.isZero(0.0));
    EXPECT_TRUE(id.standard_error.B.isZero(0.0));
    EXPECT_TRUE(id.usable);
  }
}

TEST(IdentifyImpedance, EquilibriumSolvesTheModelAtRest) {
  const Identification id = identified({trial(arm(), {.noise = 0.3})});
  PreparedTrial still = trial(arm());
  const Identification shifted = [&] {
    PreparedTrial moved = trial(arm(), {.noise = 0.3});
    moved.position.col(0).array() += 5.0;  // another origin moves x₀ with it and nothing else
    return identified({moved});
  }();
  EXPECT_NEAR(shifted.model.x0[0] - id.model.x0[0], 5.0, 1e-9);
  EXPECT_NEAR(shifted.model.x0[1], id.model.x0[1], 1e-9);
  EXPECT_LE((shifted.model.K - id.model.K).norm(), 1e-9 * id.model.K.norm());
  EXPECT_NEAR(shifted.standard_error.x0[0] / id.standard_error.x0[0], 1.0, 1e-6);
}

TEST(IdentifyImpedance, PooledFitIsTheFitOfTheConcatenation) {
  const Making noisy{.samples = 20000, .noise = 0.3, .validation = 0.0};
  const PreparedTrial a = trial(arm(), noisy),
                      b = trial(arm(), {.samples = 20000, .noise = 0.3, .seed = 2, .validation = 0.0});
  PreparedTrial both = a;
  const auto below = [](Matrix& top, const Matrix& bottom) {
    Matrix joined(top.rows() + bottom.rows(), top.cols());
    joined << top, bottom;
    top = joined;
  };
  below(both.position, b.position);
  below(both.velocity, b.velocity);
  below(both.acceleration, b.acceleration);
  below(both.force_hand_on_robot, b.force_hand_on_robot);
  both.time.resize(40000);
  both.time << a.time, b.time.array() + 100.0;  // a break
  both.segments = {{0, 20000, Purpose::identification}, {20000, 40000, Purpose::identification}};
  const Identification pooled = identified({a, b}), joined = identified({both});
  expect_model(pooled.model, joined.model, kExact);
  EXPECT_LE((flat(pooled.standard_error) - flat(joined.standard_error)).norm(),
            1e-9 * flat(joined.standard_error).norm());
  EXPECT_EQ(pooled.samples, 40000);
}

TEST(IdentifyImpedance, StandardErrorsDoNotReachAcrossABreak) {
  PreparedTrial unbroken = trial(arm(), {.noise = 0.3, .validation = 0.0});
  PreparedTrial broken = unbroken;
  broken.segments = {{0, 20000, Purpose::identification}, {20000, 40000, Purpose::identification}};
  const Vector whole = flat(identified({unbroken}).standard_error);
  const auto moved = [&] {
    return (flat(identified({broken}).standard_error) - whole).cwiseQuotient(whole).cwiseAbs().maxCoeff();
  };
  EXPECT_LE(moved(), 1e-9);  // neighbours without a break are one range
  broken.time.tail(20000).array() += 10.0;
  EXPECT_GT(moved(), 1e-3);
  EXPECT_LE((flat(identified({broken}).model) - flat(identified({unbroken}).model)).norm(), 1e-9);
}

TEST(IdentifyImpedance, TrialsPooledInAnotherOrderGiveTheSame) {
  const PreparedTrial a = trial(arm(), {.noise = 0.3}), b = trial(arm(), {.noise = 0.3, .seed = 2});
  const Identification ab = identified({a, b}), ba = identified({b, a});
  expect_model(ab.model, ba.model, kExact);
  EXPECT_LE((flat(ab.standard_error) - flat(ba.standard_error)).norm(), 1e-9 * flat(ba.standard_error).norm());
}

TEST(IdentifyImpedance, ParametersFromAllUseEverySegmentAndTheFitStaysThatOfTheSplit) {
  const PreparedTrial noisy = trial(arm(), {.noise = 0.3});
  const Identification half = identified({noisy}, {.parameters_from = ParametersFrom::identification});
  const Identification all = identified({noisy}, {.parameters_from = ParametersFrom::all});
  EXPECT_EQ(half.samples, 32000);
  EXPECT_EQ(all.samples, 40000);
  EXPECT_NE(flat(half.model), flat(all.model));
  EXPECT_EQ(half.fit.vaf, all.fit.vaf);
  EXPECT_EQ(half.fit.rmse, all.fit.rmse);
  PreparedTrial undivided = noisy;
  undivided.segments = {{0, 40000, Purpose::identification}};
  expect_model(all.model, identified({undivided}).model, kExact);
}

TEST(IdentifyImpedance, VafIsOfTheHeldOutPart) {
  PreparedTrial changed = trial(arm());
  const Segment held = changed.segments[1];
  changed.force_hand_on_robot.middleRows(held.begin, held.size()) *= 2.0;  // the arm became twice as stiff
  const Identification id = identified({changed});
  // Residual F of a force 2F: VAF = 100 (1 − 1/4).
  EXPECT_NEAR(id.fit.vaf[0], 75.0, 1e-6);
  EXPECT_NEAR(id.fit.vaf_in_sample[0], 100.0, 1e-6);
  EXPECT_TRUE(id.fit.held_out);
}

TEST(IdentifyImpedance, PulsesInDefaultModeTakeAllForTheParameters) {
  PreparedTrial pulses = trial(arm(), {.noise = 0.3});
  pulses.preparation.protocol = Protocol::underdamped;
  EXPECT_EQ(identified({pulses}).parameters_from, ParametersFrom::all);
  pulses.preparation.mode = Mode::reference;
  EXPECT_EQ(identified({pulses}).parameters_from, ParametersFrom::identification);
}

TEST(IdentifyImpedance, HandleMassComesOffTheDiagonalOfTheInertiaOnly) {
  const PreparedTrial noisy = trial(arm(), {.noise = 0.3});
  const Identification with = identified({noisy}), without = identified({noisy}, {.handle_mass = 0.194});
  EXPECT_LE((with.model.M - without.model.M - 0.194 * Matrix::Identity(2, 2)).norm(), 1e-15);
  EXPECT_EQ(with.model.B, without.model.B);
  EXPECT_EQ(with.model.K, without.model.K);
  EXPECT_EQ(with.model.x0, without.model.x0);
  EXPECT_EQ(with.standard_error.M, without.standard_error.M);
}

TEST(IdentifyImpedance, CovarianceOfTheEquilibriumIsThatOfItsDerivatives) {
  // x₀ = −K⁻¹c about the same data: a change dK of the stiffness with the force kept at x̄ moves it by −K⁻¹ dK (x₀ − x̄).
  // Checked as a whole: Var x₀ from Var [K, c] needs Cov(c), so it is checked by Monte Carlo here.
  constexpr int kRuns = 200;
  Matrix values(kRuns, 14);
  Vector claimed = Vector::Zero(14);
  for (int run = 0; run < kRuns; ++run) {
    const Identification id = identified({trial(arm(), {.samples = 6000,
                                                        .sample_time = 0.005,
                                                        .noise = 0.3,
                                                        .seed = 100u + static_cast<unsigned>(run),
                                                        .validation = 0.0})});
    values.row(run) = flat(id.model).transpose();
    claimed += flat(id.standard_error) / kRuns;
  }
  const Matrix centred = values.rowwise() - values.colwise().mean();
  const Vector spread = (centred.cwiseAbs2().colwise().sum() / (kRuns - 1.0)).cwiseSqrt().transpose();
  // A deviation from 200 runs is known to 5 %, four of those are 20 %; the standard errors are widened by
  // newey_west_widening (5 % here) and short of the far lags by as much.
  for (Index k = 0; k < 14; ++k)
    EXPECT_NEAR(claimed[k] / spread[k], 1.0, 0.25) << parameter_names(2)[static_cast<std::size_t>(k)];
  const Vector bias =
      (values.colwise().mean().transpose() - flat(arm())).cwiseQuotient(spread / std::sqrt(double{kRuns}));
  EXPECT_LE(bias.cwiseAbs().maxCoeff(), 4.0);
}

TEST(IdentifyImpedance, StandardErrorsAreProportionalToTheNoise) {
  const Vector quiet = flat(identified({trial(arm(), {.noise = 0.1})}).standard_error);
  const Vector loud = flat(identified({trial(arm(), {.noise = 0.3})}).standard_error);
  // The noise is the same but for its factor. x₀ is exactly so only to first order.
  EXPECT_LE((loud.head(12).cwiseQuotient(quiet.head(12)).array() - 3.0).abs().maxCoeff(), 1e-6);
  EXPECT_LE((loud.tail(2).cwiseQuotient(quiet.tail(2)).array() - 3.0).abs().maxCoeff(), 0.3);
}

TEST(IdentifyImpedance, StandardErrorsShrinkWithTheRootOfTheDuration) {
  Vector shorter = Vector::Zero(14), longer = Vector::Zero(14);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    shorter += flat(
        identified({trial(arm(), {.samples = 6000, .sample_time = 0.005, .noise = 0.3, .seed = seed})}).standard_error);
    longer += flat(identified({trial(arm(), {.samples = 24000, .sample_time = 0.005, .noise = 0.3, .seed = seed})})
                       .standard_error);
  }
  // Ten runs of some 30 correlation times: 5 %; the widening differs by 5 % more.
  EXPECT_NEAR(shorter.cwiseQuotient(longer).mean(), 2.0, 0.2);
}

TEST(IdentifyImpedance, ParameterNamesStandInTheOrderOfTheCovariance) {
  const Identification id = identified({trial(arm(), {.noise = 0.3})});
  const std::vector<std::string> names = {"m_xx", "m_xy", "m_yx", "m_yy", "b_xx", "b_xy", "b_yx",
                                          "b_yy", "k_xx", "k_xy", "k_yx", "k_yy", "x0",   "y0"};
  EXPECT_EQ(id.parameters, names);
  EXPECT_DOUBLE_EQ(std::sqrt(id.covariance(1, 1)), id.standard_error.M(0, 1));
  EXPECT_DOUBLE_EQ(std::sqrt(id.covariance(10, 10)), id.standard_error.K(1, 0));
  EXPECT_DOUBLE_EQ(std::sqrt(id.covariance(13, 13)), id.standard_error.x0[1]);
  EXPECT_LE((id.covariance - id.covariance.transpose()).cwiseAbs().maxCoeff(), 1e-12 * id.covariance.maxCoeff());
}

TEST(IdentifyImpedance, DecimationOfSmoothDataChangesNothing) {
  const Identification id = identified({trial(arm())}, {.decimate_check = true});
  ASSERT_TRUE(id.decimation);
  EXPECT_DOUBLE_EQ(id.decimation->rate_hz, 100.0);
  EXPECT_LE(id.decimation->largest_change, kExact);
  EXPECT_FALSE(identified({trial(arm())}).decimation);
}

TEST(IdentifyImpedance, ReportsWhereItsNumbersComeFrom) {
  const Identification id = identified({trial(arm()), trial(arm(), {.seed = 2})});
  EXPECT_EQ(id.preparations.size(), 2u);
  EXPECT_EQ(id.sources.size(), 2u);
  EXPECT_EQ(id.durations, (std::vector<double>{40.0, 40.0}));
  ASSERT_EQ(id.rates.size(), 2u);
  EXPECT_DOUBLE_EQ(id.rates[0], 1000.0);
  EXPECT_DOUBLE_EQ(id.excitation.duration, 64.0);
  EXPECT_DOUBLE_EQ(id.hac_lag_s, 1.0);
}

// What it refuses.

TEST(IdentifyImpedance, RefusesNoTrial) {
  EXPECT_FALSE(identify_impedance({}, {}));
}

TEST(IdentifyImpedance, RefusesTrialsOfDifferentRates) {
  const auto result = identify_impedance({trial(arm()), trial(arm(), {.sample_time = 0.002})}, {});
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, AllOf(HasSubstr("1000 Hz"), HasSubstr(" 500 Hz")));
}

TEST(IdentifyImpedance, RefusesTrialsOfDifferentAxesOrUnits) {
  EXPECT_FALSE(identify_impedance({trial(arm()), trial(arm(1), {.axes = 1})}, {}));
  PreparedTrial rotation = trial(arm(1), {.axes = 1});
  rotation.motion = Motion::rotation;
  EXPECT_FALSE(identify_impedance({trial(arm(1), {.axes = 1}), rotation}, {}));
}

TEST(IdentifyImpedance, RefusesNothingToIdentifyFrom) {
  PreparedTrial held = trial(arm());
  held.segments = {{0, 40000, Purpose::validation}};
  EXPECT_FALSE(identify_impedance({held}, {}));
}

TEST(IdentifyImpedance, RefusesFewerSamplesThanParameters) {
  PreparedTrial few = trial(arm());
  few.segments = {{0, 6, Purpose::identification}};
  const auto result = identify_impedance({few}, {});
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, AllOf(HasSubstr("6 samples"), HasSubstr("7 parameters")));
}

TEST(IdentifyImpedance, RefusesAValueThatIsNotFinite) {
  PreparedTrial bad = trial(arm());
  bad.force_hand_on_robot(100, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(identify_impedance({bad}, {}));
}

TEST(IdentifyImpedance, RefusesAReachOfTheCorrelationThatIsNone) {
  for (const double lag : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto result = identify_impedance({trial(arm(), {.samples = 2000})}, {.hac_lag_s = lag});
    ASSERT_FALSE(result) << lag;
    EXPECT_EQ(result.error().kind, ErrorKind::usage);
  }
}

TEST(IdentifyImpedance, RefusesAHandleMassThatIsNone) {
  for (const double mass : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(identify_impedance({trial(arm(), {.samples = 2000})}, {.handle_mass = mass})) << mass;
  }
}

TEST(IdentifyImpedance, RefusesAReachBeyondTheDataUnlessItIsTheDefault) {
  EXPECT_FALSE(identify_impedance({trial(arm(), {.samples = 2000, .noise = 0.1})}, {.hac_lag_s = 100.0}));
  const Identification id = identified({trial(arm(), {.samples = 500, .noise = 0.1})});
  EXPECT_TRUE(flat(id.standard_error).allFinite());
}

}  // namespace impedance_fit_test
}  // namespace mbk::identify
