#include "mbk/measure/identify/fit_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/identify/test_trials.h"

namespace mbk::identify {
namespace fit_checks_test {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::arm;
using testing_support::trial;

Identification identified(const PreparedTrial& prepared, const Options& options = {}) {
  return identify_impedance({prepared}, options).value();
}

std::vector<std::string> codes(const Identification& id) {
  std::vector<std::string> all;
  for (const Warning& warning : id.warnings) all.emplace_back(word_of(warning.code));
  return all;
}

TEST(Warnings, AGoodTrialRaisesNone) {
  for (const int axes : {1, 2}) {
    const Identification id = identified(trial(arm(axes), {.axes = axes, .noise = 0.3}), {.decimate_check = true});
    EXPECT_THAT(codes(id), IsEmpty());
    EXPECT_TRUE(id.usable);
  }
}

TEST(Warnings, EveryOneSaysWhatToTry) {
  impedance::Model odd = arm();
  odd.M(0, 0) = -1.0;
  odd.K(1, 1) = -50.0;
  odd.B *= -1.0;
  const Identification id = identified(trial(odd, {.samples = 4000, .validation = 0.0, .across = 0.01}));
  EXPECT_GE(id.warnings.size(), 5u);
  for (const Warning& warning : id.warnings) {
    EXPECT_FALSE(warning.message.empty()) << word_of(warning.code);
    EXPECT_FALSE(warning.remedy.empty()) << word_of(warning.code);
  }
}

/// A good model of instrumental variables, found from a force.
Identification by_instruments(double strength) {
  Identification id = identified(trial(arm(), {.noise = 0.3}));
  id.method = Method::instrumental_variables;
  id.instrument = InstrumentCheck{ReferenceQuantity::force, Vector::Constant(6, strength), Vector::Zero(2)};
  return id;
}

Identification judged(Identification id) {
  add_warnings(id);
  return id;
}

TEST(Warnings, InstrumentsWhoseIntervalsDoNotHoldAreNotUsable) {
  EXPECT_THAT(codes(judged(by_instruments(105.0))), IsEmpty());
  const Identification weak = judged(by_instruments(61.0));
  EXPECT_THAT(codes(weak), ElementsAre("weak-instruments"));
  EXPECT_FALSE(weak.usable);
  EXPECT_FALSE(judged(by_instruments(std::nan(""))).usable);
}

TEST(Warnings, AResponseToEachPulseMakesInstrumentsUnusableAndBiasesLeastSquares) {
  Identification id = by_instruments(500.0);
  const Vector none = Vector::Zero(2), much = Eigen::Vector2d(0.02, 0.4);
  id.response = UnmodelledResponse{none, none};
  EXPECT_THAT(codes(judged(id)), IsEmpty());
  id.response = UnmodelledResponse{none, much};
  EXPECT_THAT(codes(judged(id)), ElementsAre("unmodelled-response", "invalid-instruments"));
  EXPECT_FALSE(judged(id).usable);
  id.response = UnmodelledResponse{much, Vector()};  // what is linear in a multisine is found apart from mechanics
  EXPECT_THAT(codes(judged(id)), ElementsAre("unmodelled-response"));
  EXPECT_TRUE(judged(id).usable);
  id.method = Method::least_squares;
  id.instrument.reset();
  id.response = UnmodelledResponse{none, much};
  EXPECT_THAT(codes(judged(id)), ElementsAre("unmodelled-response"));
  EXPECT_TRUE(judged(id).usable);
}

TEST(Warnings, LeastSquaresIsCalledBiasedOnlyByInstrumentsThatHold) {
  const Identification iv = by_instruments(500.0);
  const Disagreement differs{"m_yy", 1.4, 0.3, 0.55, true};
  Identification ls = identified(trial(arm(), {.noise = 0.3}));
  warn_of_closed_loop(iv, differs, ls);
  EXPECT_THAT(codes(ls), ElementsAre("closed-loop-bias"));
  ls.warnings.clear();
  Disagreement same = differs;
  same.significant = false;
  warn_of_closed_loop(iv, same, ls);
  Identification weak = iv;
  weak.usable = false;
  warn_of_closed_loop(weak, differs, ls);
  EXPECT_THAT(codes(ls), IsEmpty());
}

TEST(Warnings, PooledTrialsOfDifferentConditionsAreNamed) {
  PreparedTrial relaxed = trial(arm()), rigid = trial(arm(), {.seed = 2}), silent = trial(arm(), {.seed = 3});
  relaxed.conditions.condition = "relaxed";
  rigid.conditions.condition = "rigid";
  EXPECT_THAT(codes(identify_impedance({relaxed, silent, rigid}, {}).value()), ElementsAre("mixed-conditions"));
  rigid.conditions.condition = "relaxed";
  EXPECT_THAT(codes(identify_impedance({relaxed, silent, rigid}, {}).value()), IsEmpty());
}

TEST(HandleMass, IsWhatTheRecordingSaysInDefaultModeUnlessAnotherIsGiven) {
  PreparedTrial prepared = trial(arm(), {.noise = 0.3});
  const double whole = identified(prepared).model.M(0, 0);
  prepared.recorded_handle_mass = 0.194;
  const Identification recorded = identified(prepared);
  EXPECT_NEAR(recorded.model.M(0, 0), whole - 0.194, 1e-12);
  EXPECT_EQ(recorded.handle_mass_from, HandleMassSource::recording);
  EXPECT_EQ(identified(prepared, {.handle_mass = 0.5}).handle_mass, 0.5);
  EXPECT_EQ(identified(prepared, {.handle_mass = 0.0}).model.M(0, 0), whole);
  PreparedTrial published = prepared;
  published.preparation.mode = Mode::reference;
  EXPECT_EQ(identified(published).handle_mass, 0.0);
  EXPECT_EQ(identified(published).handle_mass_from, HandleMassSource::none);
  PreparedTrial other = prepared;
  other.recorded_handle_mass = 0.2;
  EXPECT_FALSE(identify_impedance({prepared, other}, {}));
  EXPECT_TRUE(identify_impedance({prepared, other}, {.handle_mass = 0.2}));
  prepared.recorded_handle_mass = std::nan("");
  EXPECT_FALSE(identify_impedance({prepared}, {}));
}

TEST(Warnings, InertiaNotPositiveMakesItUnusable) {
  impedance::Model model = arm();
  model.M = (Matrix(2, 2) << 1.0, 1.2, 1.2, 1.0).finished();  // eigenvalues 2.2 and −0.2
  const Identification id = identified(trial(model));
  EXPECT_THAT(codes(id), ElementsAre("inertia-not-positive"));
  EXPECT_FALSE(id.usable);
}

TEST(Warnings, StiffnessNotPositiveMakesItUnusable) {
  impedance::Model model = arm();
  model.K(0, 0) = -10.0;
  const Identification id = identified(trial(model));
  EXPECT_THAT(codes(id), ElementsAre("stiffness-not-positive"));
  EXPECT_FALSE(id.usable);
}

TEST(Warnings, DampingNotPositiveLeavesItUsable) {
  impedance::Model model = arm();
  model.B(0, 0) = -1.0;
  const Identification id = identified(trial(model));
  EXPECT_THAT(codes(id), ElementsAre("damping-not-positive"));
  EXPECT_TRUE(id.usable);
}

TEST(Warnings, MassAndSpringWithoutDampingIsNotWarnedOfItsDamping) {
  impedance::Model model = arm();
  model.M = Matrix::Identity(2, 2);
  model.B.setZero();
  model.K(1, 0) = model.K(0, 1);
  EXPECT_THAT(codes(identified(trial(model), {.structure = Structure::mass_spring})), IsEmpty());
}

TEST(Warnings, AFilterThatCutsIntoTheBandIsNamed) {
  PreparedTrial prepared = trial(arm());
  prepared.preparation.band_high = Hertz(12.0);
  prepared.preparation.cutoff = Hertz(5.0);
  EXPECT_THAT(codes(identified(prepared)), ElementsAre("band-too-narrow"));
  prepared.preparation.cutoff = Hertz(6.1);
  EXPECT_THAT(codes(identified(prepared)), IsEmpty());
  prepared.preparation.cutoff.reset();
  EXPECT_THAT(codes(identified(prepared)), IsEmpty());
}

TEST(Warnings, AFilterThatCutsIntoTheBandOfAnyPooledTrialIsNamed) {
  PreparedTrial cut = trial(arm(), {.seed = 2});
  cut.preparation.band_high = Hertz(12.0);
  cut.preparation.cutoff = Hertz(5.0);
  EXPECT_THAT(codes(identify_impedance({trial(arm()), cut}, {}).value()), ElementsAre("band-too-narrow"));
}

TEST(Warnings, AnInertiaThatCannotBeToldFromZeroIsABandTooNarrow) {
  // Below 0.3 Hz the force of 0.1 kg is 1e-4 N in a noise of 0.3 N. Of the seeds, those whose estimate is positive.
  impedance::Model light = arm(1);
  light.M.setConstant(0.1);
  int positive = 0, named = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Identification id = identified(trial(light, {.axes = 1, .noise = 0.3, .seed = seed, .highest_hz = 0.3}));
    if (!(id.model.M(0, 0) > 0.0)) continue;
    ++positive;
    for (const std::string& code : codes(id)) named += code == "band-too-narrow" ? 1 : 0;
  }
  EXPECT_GT(positive, 3);
  EXPECT_GE(named, positive - 2);  // of 20 intervals of 95 %, one or two may leave out zero by chance
}

TEST(Warnings, MotionOnOneLineIsNamed) {
  EXPECT_THAT(codes(identified(trial(arm(), {.across = 0.04}))), ElementsAre("motion-on-one-line"));
  EXPECT_THAT(codes(identified(trial(arm(), {.across = 0.2}))), IsEmpty());
}

TEST(Warnings, TermsThatCannotBeToldApartMakeItUnusable) {
  PreparedTrial one_sine = trial(arm(1), {.axes = 1});
  for (Index i = 0; i < one_sine.time.size(); ++i) {  // ẍ = −ω² x exactly
    const double omega = 6.0, angle = omega * one_sine.time[i];
    one_sine.position(i, 0) = 0.01 * std::sin(angle);
    one_sine.velocity(i, 0) = 0.01 * omega * std::cos(angle);
    one_sine.acceleration(i, 0) = -omega * omega * one_sine.position(i, 0);
  }
  one_sine.force_hand_on_robot = -(1.3 * one_sine.acceleration + 8.0 * one_sine.velocity + 120.0 * one_sine.position);
  const Identification id = identified(one_sine);
  EXPECT_THAT(codes(id), Contains("poorly-conditioned"));
  EXPECT_GT(id.excitation.condition, 1e10);
  EXPECT_FALSE(id.usable);
}

TEST(Warnings, NoMotionAtAllIsUnusable) {
  PreparedTrial still = trial(arm());
  still.position.setConstant(0.3);
  still.velocity.setZero();
  still.acceleration.setZero();
  const auto result = identify_impedance({still}, {});
  ASSERT_TRUE(result) << result.error().line();
  EXPECT_FALSE(result->usable);
  EXPECT_THAT(codes(*result), Contains("poorly-conditioned"));
}

TEST(Warnings, AFitThatFallsOnHeldOutDataIsNamed) {
  PreparedTrial changed = trial(arm());
  const Segment held = changed.segments[1];
  changed.force_hand_on_robot.middleRows(held.begin, held.size()) *= 2.0;  // VAF 75 %
  EXPECT_THAT(codes(identified(changed)), ElementsAre("held-out-fit-poor"));
}

TEST(Warnings, APoorFitIsNamedAndStaysUsable) {
  const Identification id = identified(trial(arm(), {.noise = 1.3}));
  EXPECT_LT(id.fit.vaf.minCoeff(), 70.0);
  EXPECT_GT(id.fit.vaf.minCoeff(), 0.0);
  EXPECT_THAT(codes(id), Contains("fit-poor"));
  EXPECT_TRUE(id.usable);
}

TEST(Warnings, APoorFitInSampleIsNamedThoughHeldOutDataHideIt) {
  Identification id = identified(trial(arm(), {.noise = 0.3}));
  id.fit.vaf_in_sample.setConstant(66.0);
  id.fit.vaf.setConstant(73.0);
  const Identification poor = judged(id);
  EXPECT_THAT(codes(poor), ElementsAre("fit-poor"));
  EXPECT_NE(poor.warnings.front().message.find("66.0 %"), std::string::npos);
}

TEST(Warnings, AModelWorseThanTheMeanIsUnusable) {
  PreparedTrial changed = trial(arm());
  const Segment held = changed.segments[1];
  changed.force_hand_on_robot.middleRows(held.begin, held.size()) *= -1.0;
  const Identification id = identified(changed);
  EXPECT_THAT(codes(id), ElementsAre("held-out-fit-poor", "fit-poor"));
  EXPECT_FALSE(id.usable);
}

TEST(Warnings, AForceThatIsConstantWhereItIsHeldOutIsUnusable) {
  for (const Index axis : {0, 1}) {
    PreparedTrial dead = trial(arm());
    const Segment held = dead.segments[1];
    dead.force_hand_on_robot.col(axis).segment(held.begin, held.size()).setConstant(0.5);  // VAF is 0/0
    const Identification id = identified(dead);
    EXPECT_TRUE(std::isnan(id.fit.vaf[axis]));
    EXPECT_THAT(codes(id), Contains("fit-poor")) << "axis " << axis;
    EXPECT_FALSE(id.usable);
  }
}

TEST(Warnings, NoHeldOutDataIsNamed) {
  const Identification id = identified(trial(arm(), {.validation = 0.0}));
  EXPECT_THAT(codes(id), ElementsAre("no-held-out-data"));
  EXPECT_FALSE(id.fit.held_out);
  EXPECT_EQ(id.fit.vaf, id.fit.vaf_in_sample);
}

TEST(Warnings, TooLittleDataIsNamed) {
  EXPECT_THAT(codes(identified(trial(arm(), {.samples = 10000}))), ElementsAre("too-little-data"));  // 8 s identify
  EXPECT_THAT(codes(identified(trial(arm(), {.samples = 15100}))), IsEmpty());                       // 12.08 s
}

TEST(Warnings, DecimationThatChangesTheModelIsNamed) {
  PreparedTrial prepared = trial(arm());
  // Every tenth sample of the force, and no other, is off: what 100 Hz sees is not what 1 kHz sees.
  for (Index i = 0; i < prepared.time.size(); i += 10) {
    prepared.force_hand_on_robot.row(i) -= 30.0 * (prepared.position.row(i) - Eigen::RowVector2d(0.28, 0.02));
  }
  const Identification id = identified(prepared, {.decimate_check = true});
  EXPECT_GT(id.decimation->largest_change, 0.05);
  EXPECT_THAT(codes(id), Contains("decimation-changes-model"));
}

TEST(Warnings, OfTheTrialsAreKept) {
  PreparedTrial prepared = trial(arm());
  prepared.warnings.push_back({WarningCode::clock_jitter, "jitter", "another clock"});
  EXPECT_THAT(codes(identified(prepared)), ElementsAre("clock-jitter"));
}

TEST(Excitation, OfUncorrelatedEqualAxesHasNoWeakDirection) {
  const Identification id = identified(trial(arm()));
  EXPECT_EQ(id.excitation.rank, 7);
  EXPECT_NEAR(id.excitation.motion_ratio, 1.0, 0.05);
  // Eight sines of 3 mm: √(8/2) · 3 mm.
  EXPECT_NEAR(id.excitation.motion, 0.006, 0.0003);
  EXPECT_LT(id.excitation.condition, 100.0);
  EXPECT_GT(id.excitation.inertia_share, 0.0);
}

TEST(Excitation, DoesNotDependOnTheUnitsOfOneAxis) {
  const Identification one = identified(trial(arm(1), {.axes = 1}));
  PreparedTrial millimetres = trial(arm(1), {.axes = 1});
  millimetres.position *= 1000.0;
  millimetres.velocity *= 1000.0;
  millimetres.acceleration *= 1000.0;
  EXPECT_NEAR(identified(millimetres).excitation.condition / one.excitation.condition, 1.0, 1e-9);
  EXPECT_EQ(one.excitation.motion_ratio, 1.0);
}

}  // namespace fit_checks_test
}  // namespace mbk::identify
