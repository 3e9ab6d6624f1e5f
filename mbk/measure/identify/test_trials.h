#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::identify::testing_support {

inline impedance::Model arm(int axes = 2) {
  impedance::Model model;
  if (axes == 1) {
    model.M = Matrix::Constant(1, 1, 1.3);
    model.B = Matrix::Constant(1, 1, 8.0);
    model.K = Matrix::Constant(1, 1, 120.0);
    model.x0 = Vector::Constant(1, 0.01);
    return model;
  }
  if (axes == 3) {
    model.M = (Matrix(3, 3) << 1.2, -0.5, 0.2, -0.4, 1.6, 0.1, 0.3, -0.1, 0.9).finished();
    model.B = (Matrix(3, 3) << 6.0, -3.0, 1.0, -2.0, 12.0, 2.0, 0.5, 1.0, 9.0).finished();
    model.K = (Matrix(3, 3) << 90.0, -30.0, 20.0, -40.0, 200.0, 10.0, 30.0, -20.0, 150.0).finished();
    model.x0 = (Vector(3) << 0.304, -0.053, 0.121).finished();
    return model;
  }
  model.M = (Matrix(2, 2) << 1.2, -0.5, -0.4, 1.6).finished();
  model.B = (Matrix(2, 2) << 6.0, -3.0, -2.0, 12.0).finished();
  model.K = (Matrix(2, 2) << 90.0, -30.0, -40.0, 200.0).finished();
  model.x0 = (Vector(2) << 0.304, -0.053).finished();
  return model;
}

struct Making {
  int axes = 2;
  Index samples = 40000;
  double sample_time = 0.001;
  double noise = 0.0;  ///< of the force: first-order low-passed at 1.5 Hz, standard deviation [N]
  unsigned seed = 1;
  double validation = 0.2;  ///< share of the samples at the end that is held out
  double highest_hz = 3.0;  ///< of the eight sines of each axis
  double across = 1.0;      ///< the motion's second axis is scaled by it
};

/// A trial whose motion is sines in closed form and whose force obeys the model exactly, but for the noise.
inline PreparedTrial trial(const impedance::Model& model, const Making& making = {}) {
  const Index n = making.samples, axes = making.axes;
  PreparedTrial out;
  out.axes = making.axes;
  out.sample_time = making.sample_time;
  out.recording_rate = 1.0 / making.sample_time;
  out.time.resize(n);
  out.position.setZero(n, axes);
  out.velocity.setZero(n, axes);
  out.acceleration.setZero(n, axes);
  out.force_hand_on_robot.resize(n, axes);
  std::mt19937 random(making.seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  constexpr int kLines = 8;
  for (Index axis = 0; axis < axes; ++axis) {
    const double scale = axis == 1 ? making.across : 1.0;
    for (int line = 1; line <= kLines; ++line) {
      const double omega = 2.0 * M_PI * making.highest_hz * (line - 0.37 * static_cast<double>(axis)) / kLines;
      const double phase = 2.0 * M_PI * uniform(), amplitude = 0.003 * scale;
      for (Index i = 0; i < n; ++i) {
        const double angle = omega * static_cast<double>(i) * making.sample_time + phase;
        out.position(i, axis) += amplitude * std::sin(angle);
        out.velocity(i, axis) += amplitude * omega * std::cos(angle);
        out.acceleration(i, axis) -= amplitude * omega * omega * std::sin(angle);
      }
    }
  }
  const Vector place =
      axes == 1 ? Vector::Constant(1, 0.02) : Vector((Vector(3) << 0.28, 0.02, 0.1).finished().head(axes));
  out.position.rowwise() += place.transpose();
  const double keep = std::exp(-2.0 * M_PI * 1.5 * making.sample_time);
  const auto normal = [&] {
    double sum = -6.0;  // twelve uniform numbers: normal enough, and the same on every platform
    for (int k = 0; k < 12; ++k) sum += uniform();
    return sum;
  };
  Vector noise(axes);
  for (double& value : noise) value = making.noise * normal();
  for (Index i = 0; i < n; ++i) {
    out.time[i] = static_cast<double>(i) * making.sample_time;
    for (double& value : noise) value = keep * value + making.noise * std::sqrt(1.0 - keep * keep) * normal();
    const Vector force = -(model.M * out.acceleration.row(i).transpose() + model.B * out.velocity.row(i).transpose() +
                           model.K * (out.position.row(i).transpose() - model.x0));
    out.force_hand_on_robot.row(i) = (force + noise).transpose();
  }
  const auto split = static_cast<Index>(std::llround(static_cast<double>(n) * (1.0 - making.validation)));
  out.segments.push_back({0, split, Purpose::identification});
  if (split < n) out.segments.push_back({split, n, Purpose::validation});
  out.preparation.protocol = Protocol::sinusoidal;
  out.preparation.cutoff = Hertz(making.highest_hz / 0.6);
  out.preparation.band_high = Hertz(making.highest_hz);
  out.sources.push_back({"trial.csv", "CSV", "00"});
  out.recording_duration = static_cast<double>(n) * making.sample_time;
  return out;
}

}  // namespace mbk::identify::testing_support
