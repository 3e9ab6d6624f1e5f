#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/read.h"
#include "mbk/present/result/json.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace mbk::pipeline {
namespace {

using measurement::examine;
using measurement::Examined;

Examined examined(const Recording& recording, const measurement::Options& options = {}) {
  return examine({&recording, 1}, options).value();
}

const Recording& sines() {
  static const Recording recording = generated({});
  return recording;
}

/// The values that are numbers; a break between two segments is a row of NaN.
Vector known(const Vector& values) {
  std::vector<double> kept;
  for (const double value : values) {
    if (!std::isnan(value)) kept.push_back(value);
  }
  return Eigen::Map<const Vector>(kept.data(), static_cast<Index>(kept.size()));
}

TEST(Diagnostics, PredictTheForceAsTheFitSays) {
  // At 10 rows for each period of the cutoff nothing is decimated for display, so the VAF can be had from the rows.
  for (const Protocol protocol : {Protocol::sinusoidal, Protocol::underdamped}) {
    laboratory::PrescribedMotionOptions making;
    making.protocol = protocol;
    making.sensors.force_noise = 0.3;
    measurement::Options options;
    options.identify.parameters_from = ParametersFrom::identification;
    options.identify.handle_mass = 0.2;
    options.preprocess.every = protocol == Protocol::underdamped ? 10 : 20;
    const Examined one = examined(generated(making), options);
    const ForcePrediction& shown = one.diagnostics[0].prediction;
    EXPECT_TRUE(shown.held_out);
    for (Index axis = 0; axis < 2; ++axis) {
      const double vaf =
          numeric::variance_accounted_for(known(shown.measured.col(axis)), known(shown.residual.col(axis)));
      EXPECT_NEAR(vaf, one.measured.identification.fit.vaf[axis], 1e-9);
      EXPECT_NEAR(numeric::root_mean_square(known(shown.residual.col(axis))),
                  one.measured.identification.fit.rmse[axis], 1e-12);
    }
  }
}

TEST(Diagnostics, PredictHeldOutDataWithoutHavingSeenThem) {
  // The parameters that are reported come from all pulses; the fit, and what is shown of it, from half against half.
  laboratory::PrescribedMotionOptions making;
  making.protocol = Protocol::underdamped;
  making.sensors.force_noise = 0.3;
  measurement::Options options;
  options.preprocess.every = 10;
  const Examined one = examined(generated(making), options);
  const Identification& id = one.measured.identification;
  ASSERT_EQ(id.parameters_from, ParametersFrom::all);
  EXPECT_NE(id.judged.K, id.model.K);
  const ForcePrediction& shown = one.diagnostics[0].prediction;
  for (Index axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(numeric::variance_accounted_for(known(shown.measured.col(axis)), known(shown.residual.col(axis))),
                id.fit.vaf[axis], 1e-9);
  }
}

TEST(Diagnostics, OfPooledRecordingsAreEachAgainstTheCommonModel) {
  laboratory::PrescribedMotionOptions making;
  making.sensors.force_noise = 0.3;
  making.seed = 5;
  const std::vector<Recording> both = {sines(), generated(making)};
  const Examined pooled = examine(both, {}).value();
  ASSERT_EQ(pooled.diagnostics.size(), 2U);
  for (std::size_t k = 0; k < both.size(); ++k) {
    const Diagnostics alone = examined(both[k]).diagnostics[0];
    // What does not ask the model is the same; what does differs a little.
    EXPECT_EQ(pooled.diagnostics[k].spectra.force, alone.spectra.force);
    EXPECT_TRUE(pooled.diagnostics[k].prediction.measured.cwiseEqual(alone.prediction.measured).count() > 1000);
    const Vector here = known(pooled.diagnostics[k].prediction.predicted.col(0)),
                 there = known(alone.prediction.predicted.col(0));
    EXPECT_LT((here - there).norm(), 0.05 * there.norm());
    EXPECT_GT((here - there).norm(), 0.0);
  }
}

TEST(Diagnostics, OfAResampledRecordingAreOnItsNewClock) {
  measurement::Options options;
  options.resample = Hertz(500.0);
  const Examined one = examined(sines(), options), plain = examined(sines());
  const Spectra &spectra = one.diagnostics[0].spectra, &want = plain.diagnostics[0].spectra;
  ASSERT_NEAR(spectra.frequency[1], want.frequency[1], 0.01 * want.frequency[1]);
  // The motion's power stands where it was: within half a per cent of the lines' power.
  const double step = want.frequency[1];
  EXPECT_NEAR(spectra.position.col(0).sum() * spectra.frequency[1], want.position.col(0).sum() * step,
              0.02 * want.position.col(0).sum() * step);
  Index peak = 0, want_peak = 0;
  spectra.position.col(0).maxCoeff(&peak);
  want.position.col(0).maxCoeff(&want_peak);
  EXPECT_NEAR(spectra.frequency[peak], want.frequency[want_peak], step);
}

TEST(Diagnostics, IntegrateTheAccelerationBackToThePosition) {
  // §3.5.1: "the two signals agree exceptionally well".
  for (const Protocol protocol : {Protocol::sinusoidal, Protocol::underdamped}) {
    laboratory::PrescribedMotionOptions making;
    making.protocol = protocol;
    const DoubleIntegral integral = examined(generated(making)).diagnostics[0].double_integral;
    EXPECT_LT(integral.rms_difference.maxCoeff(), 1e-5);  // of millimetres, and of positions that count by 2 µm
    for (Index axis = 0; axis < 2; ++axis) {  // a pulse may stand across an axis, which then has no variance
      EXPECT_TRUE(integral.vaf[axis] > 99.99 || integral.rms_difference[axis] < 1e-12);
    }
  }
}

TEST(Diagnostics, OfAccelerometersThatMissTheMotionSaySo) {
  Recording recording = sines();
  for (Channel& channel : recording.channels) {
    if (channel.name == "acceleration_y") channel.values *= -1.0;
  }
  const auto agreement = examined(recording).diagnostics[0].acceleration;
  ASSERT_TRUE(agreement);
  EXPECT_GT(agreement->vaf[0], 99.0);
  EXPECT_LT(agreement->vaf[1], -200.0);  // 1 − 2²: four times the variance is left
  measurement::Options options;
  options.preprocess.acceleration = AccelerationSource::sensor;
  EXPECT_LT(examined(recording, options).diagnostics[0].double_integral.vaf[1], 0.0);
}

TEST(Diagnostics, LeaveOutAnAccelerometerWithoutNumbers) {
  Recording recording = sines();
  for (Channel& channel : recording.channels) {
    if (channel.name == "acceleration_x") channel.values.setConstant(std::nan(""));
  }
  EXPECT_FALSE(examined(recording).diagnostics[0].acceleration);
}

TEST(Diagnostics, ResidualHasThePowerThatItsSpectrumSays) {
  laboratory::PrescribedMotionOptions making;
  making.sensors.coloured_force_noise = 0.3;
  measurement::Options options;
  options.preprocess.every = 20;
  const Examined one = examined(generated(making), options);
  const Spectra& spectra = one.diagnostics[0].spectra;
  const Vector residual = known(one.diagnostics[0].prediction.residual.col(0));
  const double power = spectra.residual.col(0).sum() * spectra.frequency[1];
  // The spectrum is of all data, the rows are the last fifth; the noise has some twenty correlation times in them.
  EXPECT_NEAR(power / numeric::variance(residual), 1.0, 0.6);
  // Well above the residual where the limb is moved: the force's variance is of newtons, the noise's of 0.3 N.
  EXPECT_NEAR(spectra.residual.col(0).sum() * spectra.frequency[1], 0.09, 0.05);
}

TEST(Diagnostics, AreDecimatedToWhatCanBeSeen) {
  measurement::Options options;
  options.preprocess.every = 1;
  const Diagnostics shown = examined(sines(), options).diagnostics[0];
  EXPECT_LE(shown.prediction.time.size(), 2001);
  EXPECT_GT(shown.prediction.time.size(), 1000);
  EXPECT_LE(shown.time.size(), 2001);
  EXPECT_EQ(shown.position.rows(), shown.time.size());
  EXPECT_EQ(shown.force.rows(), shown.time.size());
  EXPECT_EQ(shown.reference.rows(), shown.time.size());
}

TEST(Diagnostics, LoseNoSpikeOfTheRecording) {
  Recording recording = sines();
  for (Channel& channel : recording.channels) {
    if (channel.name == "force_x") channel.values[31234] = 77.0;
  }
  const Diagnostics shown = examined(recording).diagnostics[0];
  EXPECT_EQ(shown.force.col(0).maxCoeff(), 77.0);
}

TEST(Diagnostics, SeeThatTheForceFollowsTheMotionInTheExcitedBand) {
  laboratory::PrescribedMotionOptions making;
  making.sensors.force_noise = 0.1;
  const Spectra spectra = examined(generated(making)).diagnostics[0].spectra;
  double in_band = 0.0, far_above = 0.0;
  Index lines_in = 0, lines_above = 0;
  for (Index i = 0; i < spectra.frequency.size(); ++i) {
    if (spectra.frequency[i] > 2.0 && spectra.frequency[i] < 2.8) {
      in_band += spectra.coherence.row(i).mean();
      ++lines_in;
    } else if (spectra.frequency[i] > 8.0) {
      far_above += spectra.coherence.row(i).mean();
      ++lines_above;
    }
  }
  EXPECT_GT(in_band / static_cast<double>(lines_in), 0.98);
  EXPECT_LT(far_above / static_cast<double>(lines_above), 0.5);
  EXPECT_GT(spectra.segments, 8);
  EXPECT_GT(spectra.coherence_significant, 0.2);
  EXPECT_LT(spectra.coherence_significant, 0.6);
}

TEST(Diagnostics, KnowTheColourOfTheResidual) {
  laboratory::PrescribedMotionOptions making;
  making.sensors.force_noise = 0.0;
  making.sensors.coloured_force_noise = 0.3;  // first order, 0.5 Hz: e^(−t/τ) with τ = 0.32 s
  making.sensors.coloured_force_bandwidth = Hertz(0.5);
  const Autocorrelation residual = examined(generated(making)).diagnostics[0].autocorrelation;
  EXPECT_NEAR(residual.value(0, 0), 1.0, 1e-12);
  for (Index axis = 0; axis < 2; ++axis) EXPECT_NEAR(residual.time_constant[axis], 0.32, 0.2);
  EXPECT_LE(residual.lag[residual.lag.size() - 1], 2.0 + 1e-9);
  EXPECT_LT(residual.white95, 0.1);
}

TEST(Diagnostics, ShowFiltersThatAreIdealInTheBandAndFallBeyondIt) {
  const Examined one = examined(sines());
  const FilterResponse& filters = one.diagnostics[0].filters;
  const double band = one.measured.identification.preparations[0].band_high.value;
  for (Index k = 0; k < filters.frequency.size(); ++k) {
    const double f = filters.frequency[k];
    EXPECT_NEAR(filters.first_ideal[k], 2.0 * std::numbers::pi * f, 1e-9 * f);
    if (f <= band) {
      EXPECT_NEAR(filters.smoothing[k], 1.0, 0.01) << f;
      EXPECT_NEAR(filters.first[k] / filters.first_ideal[k], 1.0, 0.01) << f;
      EXPECT_NEAR(filters.second[k] / filters.second_ideal[k], 1.0, 0.01) << f;
    } else if (f > 5.0 * band) {
      EXPECT_LT(filters.smoothing[k], 1e-4) << f;
    }
  }
}

TEST(Diagnostics, CompareTheDerivativeWithTheAccelerometer) {
  laboratory::PrescribedMotionOptions making;
  making.sensors.acceleration_noise = 0.02;
  const auto agreement = examined(generated(making)).diagnostics[0].acceleration;
  ASSERT_TRUE(agreement);
  for (Index axis = 0; axis < 2; ++axis) {
    EXPECT_GT(agreement->vaf[axis], 99.9);
    EXPECT_LT(agreement->rms_difference[axis], 0.01);
  }
  // The same whichever of the two the fit took.
  measurement::Options options;
  options.preprocess.acceleration = AccelerationSource::sensor;
  const auto other = examined(generated(making), options).diagnostics[0].acceleration;
  EXPECT_TRUE(other->sensor.isApprox(agreement->sensor, 1e-12));
  Recording without = generated(making);
  std::erase_if(without.channels, [](const Channel& channel) { return channel.name.starts_with("acceleration"); });
  EXPECT_FALSE(examined(without).diagnostics[0].acceleration);
}

TEST(Diagnostics, HoldForOneAxisAndWithoutAModel) {
  laboratory::PrescribedMotionOptions making;
  making.limb = laboratory::relaxed_arm_one_axis();
  making.home = Vector(making.home.tail(1));
  const Examined one = examined(generated(making));
  EXPECT_EQ(one.diagnostics[0].spectra.coherence.cols(), 1);
  EXPECT_FALSE(one.measured.findings);

  Recording line = sines();  // y follows x: nothing can be distinguished
  for (const auto& [to, from] : {std::pair{"hand_y", "hand_x"}, {"reference_y", "reference_x"}}) {
    const Vector values = line.find(from)->values;
    for (Channel& channel : line.channels) {
      if (channel.name == to) channel.values = values;
    }
  }
  const Diagnostics unknown = examined(line).diagnostics[0];
  EXPECT_EQ(unknown.prediction.time.size(), 0);
  EXPECT_EQ(unknown.autocorrelation.lag.size(), 0);
  EXPECT_TRUE(unknown.spectra.coherence.array().isNaN().all());
}

TEST(Diagnostics, AreThoseOfTheSameMeasurement) {
  const auto plain = measurement::measure({&sines(), 1}, {}).value();
  EXPECT_EQ(result::to_json(plain), result::to_json(examined(sines()).measured));
}

TEST(Diagnostics, OfARealAnkle) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "MBK_DATA_DIR is not set";
  recording::ReadOptions reading;
  reading.axes = 1;
  reading.channels = recording::parse_channel_map("x=position_rad,F=torque_Nm").value();
  const Recording ankle = recording::read(*folder / "ankle" / "z_df.csv", reading).value();
  measurement::Options options;
  options.preprocess.window.split_s = 40.0;
  const Examined one = examined(ankle, options);
  EXPECT_NEAR(one.measured.identification.fit.vaf[0], 86.1, 0.2);
  // Broad-band random perturbations: coherent throughout the band but for the joint's antiresonance.
  const Diagnostics& shown = one.diagnostics[0];
  const double band = one.measured.identification.preparations[0].band_high.value;
  std::vector<double> coherence;
  for (Index i = 1; i < shown.spectra.frequency.size() && shown.spectra.frequency[i] < band; ++i) {
    coherence.push_back(shown.spectra.coherence(i, 0));
  }
  ASSERT_GT(coherence.size(), 50U);
  std::nth_element(coherence.begin(), coherence.begin() + static_cast<std::ptrdiff_t>(coherence.size() / 2),
                   coherence.end());
  EXPECT_GT(coherence[coherence.size() / 2], 0.85);
  EXPECT_LT(shown.spectra.coherence_significant, 0.1);
  EXPECT_GT(shown.autocorrelation.time_constant[0], 0.0);
  EXPECT_GT(shown.double_integral.vaf[0], 99.9);
}

}  // namespace
}  // namespace mbk::pipeline
