#include "mbk/measure/analyse/judge_passivity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/model/impedance/passivity_index.h"

namespace mbk::analyse {
namespace judge_passivity_test {

using numeric::Random;
using testing::HasSubstr;

constexpr double kOneSided = 1.959963984540054;  // Φ⁻¹(0.975)
const PassivityBand kBand{Hertz(0.3), Hertz(3.0), "as asked"};

/// P1 of Dyck 2013 with antisymmetric stiffness k_a, and independent errors that are a share of each matrix.
Identification arm(double k_a = 2.0, double share = 0.01) {
  Identification id;
  id.model.M = Matrix{{1.326, -0.935}, {-0.935, 1.883}};
  id.model.B = Matrix{{5.76, -2.14}, {-2.14, 10.56}};
  id.model.K = Matrix{{42.4, -28.6 + k_a}, {-28.6 - k_a, 125.3}};
  id.model.x0 = Vector::Zero(2);
  Vector errors(14);
  errors << Vector::Constant(4, 2.0), Vector::Constant(4, 10.0), Vector::Constant(4, 100.0), 0.1, 0.1;
  id.covariance = (share * errors).cwiseAbs2().asDiagonal();
  return id;
}

ModelPassivity judged(const Identification& id, const PassivityBand& band = kBand) {
  auto result = model_passivity(id, band);
  EXPECT_TRUE(result) << result.error().line();
  return result ? *result : ModelPassivity{};
}

TEST(ModelPassivity, OfASureArmIsPassive) {
  const ModelPassivity model = judged(arm());
  EXPECT_EQ(model.verdict(), Verdict::passive);
  EXPECT_EQ(model.symmetric, Verdict::passive);
  EXPECT_EQ(model.antisymmetric, Verdict::passive);
  EXPECT_TRUE(model.published_rule);
  ASSERT_EQ(model.conditions.size(), 7U);
  EXPECT_EQ(model.conditions[1].unit, "N·s/m");
  EXPECT_NEAR(model.excess->corrected, 4.95, 0.01);
  EXPECT_NEAR(model.excess->published, 5.69, 0.01);
}

TEST(ModelPassivity, HasThreeOutcomesAndSaysPassiveExactlyWhereEveryLowerBoundIsPositive) {
  Random random(1);
  std::array<int, 3> count{};
  for (int i = 0; i < 600; ++i) {
    Identification id = arm(random.uniform(-25.0, 25.0), random.uniform(0.001, 0.08));
    id.model.B -= random.uniform(0.0, 7.0) * Matrix::Identity(2, 2);
    const ModelPassivity model = judged(id);
    bool passive = true, active = false;
    const double z = numeric::normal_quantile(1.0 - 0.025 / 7.0);
    for (const PassivityCondition& c : model.conditions) {
      passive = passive && c.value - kOneSided * c.standard_error > 0.0;  // NaN is not
      active = active || c.value + z * c.standard_error < 0.0;
      if (std::isnan(c.value)) continue;
      EXPECT_NEAR(c.upper, c.value + z * c.standard_error, 1e-5 * c.standard_error);
      EXPECT_NEAR(c.lower, c.value - kOneSided * c.standard_error, 1e-12);
    }
    EXPECT_EQ(model.verdict(), passive ? Verdict::passive : active ? Verdict::active : Verdict::undecided);
    ++count[static_cast<std::size_t>(model.verdict())];
  }
  EXPECT_GT(*std::ranges::min_element(count), 30);
}

TEST(ModelPassivity, IsUndecidedWhereOneConditionAloneIsUnsure) {
  Identification id = arm();
  id.covariance(8, 8) = 100.0 * 100.0;  // k_xx
  const ModelPassivity model = judged(id);
  EXPECT_EQ(model.verdict(), Verdict::undecided);
  EXPECT_EQ(model.conditions[2].verdict, Verdict::undecided);
  EXPECT_EQ(std::ranges::count(model.conditions, Verdict::passive, &PassivityCondition::verdict), 6);
}

// Too much for √det B below 0.36 Hz: the band decides, and the symmetric part says nothing of it.
TEST(ModelPassivity, HangsOnTheBandWhereTheStiffnessIsNotSymmetric) {
  const Identification id = arm(17.0);
  EXPECT_EQ(judged(id, {Hertz(0.1), Hertz(3.0), ""}).verdict(), Verdict::active);
  const ModelPassivity above = judged(id, {Hertz(0.6), Hertz(3.0), ""});
  EXPECT_EQ(above.verdict(), Verdict::passive);
  EXPECT_NEAR(above.circular_hz->first, 17.0 / (2.0 * std::numbers::pi * std::sqrt(5.76 * 10.56 - 2.14 * 2.14)), 1e-12);
  const ModelPassivity below = judged(id, {Hertz(0.1), Hertz(3.0), ""});
  EXPECT_EQ(below.symmetric, Verdict::passive);
  EXPECT_EQ(below.antisymmetric, Verdict::active);
  EXPECT_TRUE(below.published_rule);
  EXPECT_EQ(below.smallest_at.value, 0.1);
  EXPECT_NEAR(below.smallest_index, impedance::passivity_index(id.model, 0.2 * std::numbers::pi).value, 1e-12);
}

// Either by itself leaves room, both together do not.
TEST(ModelPassivity, AddsAntisymmetricInertiaAndStiffness) {
  const auto with = [](double m_a, double k_a) {
    Identification id = arm(k_a, 0.001);
    id.model.M(0, 1) += m_a;
    id.model.M(1, 0) -= m_a;
    return judged(id, {Hertz(0.5), Hertz(0.6), ""}).verdict();
  };
  EXPECT_EQ(with(1.5, 0.0), Verdict::passive);
  EXPECT_EQ(with(0.0, 15.0), Verdict::passive);
  EXPECT_EQ(with(-1.5, 15.0), Verdict::active);
  EXPECT_EQ(with(1.5, 15.0), Verdict::passive);
}

TEST(ModelPassivity, PropagatesTheCovarianceAsManyDrawsDo) {
  Identification id = arm(7.7, 0.02);
  Matrix mixing = Matrix::Identity(14, 14);
  mixing(4, 7) = 0.6;
  mixing(9, 10) = -0.8;
  mixing(5, 9) = 0.02;
  id.covariance = (mixing * id.covariance * mixing.transpose()).eval();
  const ModelPassivity model = judged(id, {Hertz(0.2), Hertz(3.0), ""});
  const Matrix root = numeric::Cholesky(id.covariance).upper().transpose();
  Random random(2);
  constexpr int kDraws = 20'000;
  const double omega = 2.0 * std::numbers::pi * model.smallest_at.value;
  Vector index(kDraws), damping(kDraws);
  for (int k = 0; k < kDraws; ++k) {
    Vector noise(14);
    for (double& value : noise) value = random.normal();
    const impedance::Model drawn = impedance::unstacked(impedance::stacked(id.model) + root * noise, 2);
    index[k] = impedance::passivity_index(drawn, omega).value;
    damping[k] = impedance::smallest_eigenvalue(drawn, 1).value;
  }
  // The second order bends what the delta method takes as straight; 20000 draws give a deviation to 0.5 %.
  const double error = (model.smallest_index95.second - model.smallest_index95.first) / (2.0 * numeric::kNormal95);
  EXPECT_NEAR(error, std::sqrt(numeric::variance(index)), 0.05 * error);
  EXPECT_NEAR(index.mean(), model.smallest_index, 0.15 * error);
  EXPECT_NEAR(model.conditions[1].standard_error, std::sqrt(numeric::variance(damping)),
              0.05 * model.conditions[1].standard_error);
}

TEST(ModelPassivity, OfOneAxisHasThreeConditions) {
  Identification id;
  id.axes = 1;
  id.model = impedance::unstacked((Vector(4) << 1.0, 5.0, 100.0, 0.0).finished(), 1);
  id.covariance = Matrix(Vector{{0.01, 0.1, 10.0, 1e-4}}.asDiagonal());
  const ModelPassivity model = judged(id);
  EXPECT_EQ(model.conditions.size(), 3U);
  EXPECT_EQ(model.verdict(), Verdict::passive);
  EXPECT_EQ(model.smallest_index, 5.0);
  EXPECT_FALSE(model.circular_hz.has_value());
  EXPECT_FALSE(model.antisymmetric.has_value());
  id.model.K(0, 0) = -100.0;
  const ModelPassivity active = judged(id);
  EXPECT_EQ(active.verdict(), Verdict::active);
  EXPECT_FALSE(active.published_rule);
  EXPECT_FALSE(active.excess.has_value());
}

TEST(ModelPassivity, WithoutErrorsIsUndecided) {
  Identification id = arm();
  id.covariance.setConstant(kNaN);
  EXPECT_EQ(judged(id).verdict(), Verdict::undecided);
}

TEST(ModelPassivity, RefusesWhatIsNoModelAndWhatIsNoBand) {
  Identification id = arm();
  for (const auto& [low, high] : {std::pair{0.0, 1.0},
                                  {2.0, 1.0},
                                  {-1.0, 1.0},
                                  {kNaN, 1.0},
                                  {1.0, kNaN},
                                  {1.0, std::numeric_limits<double>::infinity()}}) {
    EXPECT_FALSE(model_passivity(id, {Hertz(low), Hertz(high), ""})) << low << ":" << high;
  }
  EXPECT_TRUE(model_passivity(id, {Hertz(1.0), Hertz(1.0), ""}));
  id.model.B(0, 1) = kNaN;
  EXPECT_FALSE(model_passivity(id, kBand));
  EXPECT_FALSE(model_passivity(Identification{}, kBand));
}

TEST(Instruments, ArePreferredOnlyIfStrongAndDifferent) {
  Identification id = arm();
  const Disagreement yes{"k_xx", 10.0, 1.0, 40.0, true}, no{"k_xx", 1.0, 1.0, 40.0, false};
  EXPECT_FALSE(prefer_instruments(id, yes));
  id.instrument = InstrumentCheck{ReferenceQuantity::force, Vector::Constant(6, kStrongInstruments + 0.1), {}};
  EXPECT_TRUE(prefer_instruments(id, yes));
  EXPECT_FALSE(prefer_instruments(id, no));
  EXPECT_FALSE(prefer_instruments(id, std::nullopt));
  id.instrument->strength[4] = kStrongInstruments - 0.1;
  EXPECT_FALSE(prefer_instruments(id, yes));
  id.instrument->strength[4] = kNaN;
  EXPECT_FALSE(prefer_instruments(id, yes));
}

EnergyAccount energy_of(double absorbed, double low, double high) {
  EnergyAccount account;
  account.absorbed = absorbed;
  account.absorbed95 = {low, high};
  account.verdict = verdict_of(account.absorbed95);
  return account;
}

TEST(Trial, IsSaidByTheEnergyAloneWhateverTheModel) {
  Identification id = arm();
  for (const bool usable : {true, false}) {
    id.usable = usable;
    const auto absorbed = trial_passivity(id, energy_of(1.16, 1.03, 1.29));
    ASSERT_TRUE(absorbed);
    EXPECT_EQ(absorbed->energy.verdict, Verdict::passive);
    EXPECT_EQ(absorbed->statement, "in this trial the hand absorbed 1.16 J (95 %: 1.03 to 1.29 J)");
    const auto delivered = trial_passivity(id, energy_of(-0.5, -0.7, -0.3));
    EXPECT_EQ(delivered->energy.verdict, Verdict::active);
    EXPECT_EQ(delivered->statement, "in this trial the hand delivered 0.5 J (95 %: 0.3 to 0.7 J)");
    const auto open = trial_passivity(id, energy_of(0.1, -0.2, 0.4));
    EXPECT_EQ(open->energy.verdict, Verdict::undecided);
    EXPECT_THAT(open->statement, HasSubstr("includes zero"));
  }
  id.axes = 1;
  EXPECT_THAT(trial_passivity(id, energy_of(1.0, 0.9, 1.1))->statement, HasSubstr("the limb absorbed"));
}

// A force of the other sign turns what was absorbed into what was delivered.
TEST(Trial, IsNotSaidWhereTheSignalsAreNotPlausible) {
  for (const WarningCode code : {WarningCode::force_sign_reversed, WarningCode::torque_unit}) {
    Identification id = arm();
    id.warnings.push_back({code, "", ""});
    EXPECT_FALSE(trial_passivity(id, energy_of(-1.16, -1.29, -1.03)));
  }
  EXPECT_FALSE(trial_passivity(arm(), energy_of(kNaN, kNaN, kNaN)));
}

TEST(Trial, NamesTheLinesAtWhichEnergyWasDelivered) {
  const auto trial = trial_passivity(arm(), energy_of(1.0, 0.9, 1.1),
                                     {{Hertz(0.1), 50.0, -0.1, {-0.2, -0.05}},
                                      {Hertz(0.4), 50.0, 0.5, {0.4, 0.6}},
                                      {Hertz(0.7), 50.0, -0.1, {-0.3, 0.1}}});
  EXPECT_THAT(trial->statement, HasSubstr("delivered energy at 0.1 Hz"));
}

PassivityPrediction predicted(const Identification& id, bool usable = true) {
  return predict_passivity({judged(id)}, usable, kBand);
}

TEST(Prediction, IsThatOfTheModelForStraightAndForCircularMotion) {
  const PassivityPrediction passive = predicted(arm());
  EXPECT_EQ(passive.verdict, Verdict::passive);
  EXPECT_EQ(passive.symmetric, Verdict::passive);
  EXPECT_EQ(passive.antisymmetric, Verdict::passive);
  EXPECT_FALSE(passive.extrapolated);
  EXPECT_THAT(passive.statement, HasSubstr("from 0.3 to 3 Hz"));
  EXPECT_THAT(passive.statement, HasSubstr("straight and in circular motion"));
  const PassivityPrediction active = predicted(arm(40.0));
  EXPECT_EQ(active.verdict, Verdict::active);
  EXPECT_EQ(active.symmetric, Verdict::passive);
  EXPECT_EQ(active.antisymmetric, Verdict::active);
  EXPECT_THAT(active.statement,
              HasSubstr("can generate energy in circular motion below 0.85 Hz; it absorbs energy in straight motion"));
  Identification unsure = arm();
  unsure.covariance(8, 8) = 1e4;
  const PassivityPrediction undecided = predicted(unsure);
  EXPECT_EQ(undecided.verdict, Verdict::undecided);
  EXPECT_THAT(undecided.statement, HasSubstr("smallest eigenvalue of K"));
}

TEST(Prediction, IsNoneWhereTheResultOrTheModelIsNotUsable) {
  Identification id = arm();
  EXPECT_FALSE(predicted(id, false).verdict);
  id.usable = false;
  const PassivityPrediction none = predicted(id);
  EXPECT_FALSE(none.verdict || none.symmetric || none.antisymmetric);
  EXPECT_THAT(none.statement, HasSubstr("not usable"));
  EXPECT_FALSE(predict_passivity({}, true, kBand).verdict);
}

TEST(Prediction, IsUndecidedAtMostWhereTheModelFitsPoorlyOrDoesNotHoldOrNoBandIsLeft) {
  for (const double k_a : {2.0, 40.0}) {  // passive and active otherwise
    for (const WarningCode code :
         {WarningCode::fit_poor, WarningCode::held_out_fit_poor, WarningCode::missing_dynamics,
          WarningCode::nonlinear_stiffness, WarningCode::dry_friction, WarningCode::stiffness_changes,
          WarningCode::damping_changes, WarningCode::memory, WarningCode::even_nonlinearity, WarningCode::lack_of_fit,
          WarningCode::inertia_not_symmetric}) {
      Identification id = arm(k_a);
      id.warnings.push_back({code, "", ""});
      const PassivityPrediction poor = predicted(id);
      EXPECT_EQ(poor.verdict, Verdict::undecided);
      EXPECT_EQ(poor.symmetric, Verdict::undecided);
      EXPECT_EQ(poor.antisymmetric, Verdict::undecided);
      EXPECT_EQ(judged(id).symmetric, Verdict::passive) << "what the method itself says stays beside its VAF";
    }
    EXPECT_EQ(predict_passivity({judged(arm(k_a))}, true, std::nullopt).verdict, Verdict::undecided);
  }
}

TEST(Prediction, IsNotPassiveOverALineAtWhichTheLimbDeliveredEnergy) {
  const auto with = [](double hz, Interval absorbed95) {
    return predict_passivity({judged(arm())}, true, kBand, {{Hertz(hz), 50.0, -0.07, absorbed95}});
  };
  const PassivityPrediction within = with(1.75, {-0.116, -0.025});
  EXPECT_EQ(within.verdict, Verdict::undecided);
  EXPECT_EQ(within.symmetric, Verdict::undecided);
  EXPECT_THAT(within.statement, HasSubstr("1.75 Hz"));
  EXPECT_EQ(with(1.75, {-0.116, 0.025}).verdict, Verdict::passive);
  EXPECT_EQ(with(3.5, {-0.116, -0.025}).verdict, Verdict::passive) << "beyond the band";
}

TEST(Prediction, IsNotActiveByItsAntisymmetryAloneWhereTheResidualFollowsThePerturbation) {
  Identification id = arm(40.0);
  id.instrument = InstrumentCheck{ReferenceQuantity::force, Vector::Constant(6, 100.0), Vector::Constant(2, 0.3)};
  EXPECT_EQ(predicted(id).verdict, Verdict::undecided);
  id.instrument->coherent_residual.setConstant(0.1);
  EXPECT_EQ(predicted(id).verdict, Verdict::active);
}

TEST(Prediction, SaysWhereItIsExtrapolated) {
  const auto asked = [](double low, double high) {
    const PassivityBand band = asked_band(Hertz(low), Hertz(high), kBand);
    return predict_passivity({judged(arm(), band)}, true, kBand);
  };
  EXPECT_FALSE(asked(0.5, 2.0).extrapolated);
  EXPECT_FALSE(asked(0.299, 3.01).extrapolated) << "as printed";
  for (const auto& [low, high] : {std::pair{0.2, 2.0}, {0.5, 4.0}, {0.1, 10.0}}) {
    const PassivityPrediction beyond = asked(low, high);
    EXPECT_TRUE(beyond.extrapolated);
    EXPECT_THAT(beyond.statement, HasSubstr("extrapolated beyond"));
  }
  EXPECT_TRUE(asked_band(Hertz(0.5), Hertz(2.0), std::nullopt).extrapolated);
}

/// Noise between two frequencies: many sines of random frequency and phase, of standard deviation 1.
Vector noise_between(Random& random, const Vector& time, double low, double high) {
  constexpr int kSines = 200;
  Vector sum = Vector::Zero(time.size());
  for (int k = 0; k < kSines; ++k) {
    const double f = random.uniform(low, high), phase = random.uniform(0.0, 2.0 * std::numbers::pi);
    sum.array() += (2.0 * std::numbers::pi * f * time.array() + phase).sin();
  }
  return sum * std::sqrt(2.0 / kSines);
}

/// Reference, position and force are alike from 0.1 to 6 Hz; noise comes to the force between two frequencies.
PreparedTrial noisy_trial(double noise_low, double noise_high) {
  constexpr Index kRows = 10'000;
  PreparedTrial trial;
  trial.sample_time = 0.02;
  trial.time = Vector::LinSpaced(kRows, 0.0, 0.02 * (kRows - 1));
  Random random(3);
  trial.reference_motion = Matrix::Zero(kRows, 6);
  trial.force_hand_on_robot.resize(kRows, 2);
  for (Index j = 0; j < 2; ++j) {
    trial.reference_motion.col(4 + j) = noise_between(random, trial.time, 0.1, 6.0);
    trial.force_hand_on_robot.col(j) =
        -trial.reference_motion.col(4 + j) + 3.0 * noise_between(random, trial.time, noise_low, noise_high);
  }
  trial.position = trial.reference_motion.rightCols(2);
  trial.preparation.band_low = Hertz(0.2);
  trial.preparation.band_high = Hertz(5.0);
  trial.segments = {{0, kRows, Purpose::identification, 0}};
  return trial;
}

TEST(PassivityBand, IsWhereThePerturbationExplainsPositionAndForce) {
  constexpr double kLines = 0.5;  // of the coherence, which a window smears over two or three
  const PassivityBand above = *coherent_band({noisy_trial(0.05, 1.5)});
  EXPECT_NEAR(above.low.value, 1.5, kLines);
  EXPECT_EQ(above.high.value, 5.0);
  const PassivityBand below = *coherent_band({noisy_trial(3.0, 6.0)});
  EXPECT_EQ(below.low.value, 0.2);
  EXPECT_NEAR(below.high.value, 3.0, kLines);
  EXPECT_THAT(below.rule, HasSubstr("0.8"));
}

TEST(PassivityBand, IsNoneWhereThereIsNoCoherence) {
  EXPECT_FALSE(coherent_band({noisy_trial(0.05, 8.0)}));
  const PassivityBand left = excited_band({noisy_trial(0.05, 8.0)});
  EXPECT_EQ(left.low.value, 0.2);
  EXPECT_EQ(left.high.value, 5.0);
  EXPECT_TRUE(left.extrapolated);
}

// Noise of the force is no answer to the motion, whether a reference was recorded or not.
TEST(PassivityBand, IsWhereTheMotionExplainsTheForceWithoutAReference) {
  PreparedTrial trial = noisy_trial(0.05, 1.5);
  trial.reference_motion.resize(0, 0);
  const PassivityBand unknown = coherent_band({trial}).value();
  EXPECT_NEAR(unknown.low.value, 1.5, 0.5);
  EXPECT_EQ(unknown.high.value, 5.0);
  EXPECT_THAT(unknown.rule, HasSubstr("no reference"));
}

TEST(PassivityBand, IsNoneWhereOneLineOfMotionIsAllThatThereIs) {
  PreparedTrial trial = noisy_trial(3.0, 6.0);
  trial.reference_motion.col(5) = 0.5 * trial.reference_motion.col(4);
  EXPECT_FALSE(coherent_band({trial}));
  trial = noisy_trial(3.0, 6.0);
  trial.position.col(1) = 0.5 * trial.position.col(0);
  trial.reference_motion.resize(0, 0);
  EXPECT_FALSE(coherent_band({trial}));
}

TEST(PassivityBand, HoldsForEveryTrialAndNotBelowOnePeriod) {
  PreparedTrial one = noisy_trial(3.0, 6.0), other = one;
  other.preparation.band_low = Hertz(0.4);
  other.preparation.band_high = Hertz(2.0);
  const PassivityBand both = *coherent_band({one, other});
  EXPECT_EQ(both.low.value, 0.4);
  EXPECT_EQ(both.high.value, 2.0);
  one.reference_motion.resize(0, 0);
  one.segments = {{0, 100, Purpose::identification, 0}, {200, 300, Purpose::validation, 200}};
  EXPECT_EQ(excited_band({one}).low.value, 0.5);  // 100 rows of 20 ms
}

}  // namespace judge_passivity_test
}  // namespace mbk::analyse
