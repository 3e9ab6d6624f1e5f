#include "mbk/validate/simulated_limbs.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "mbk/base/dsp/derivative_filter.h"
#include "mbk/base/numeric/random.h"

namespace mbk::validation {

ExplorationTrial simulate_limb(const SimulatedLimb& limb, double duration_s, double rate_hz, std::uint64_t seed) {
  const Index n = limb.M.rows(), N = std::llround(duration_s * rate_hz);
  const double T = 1.0 / rate_hz, pole = 2.0 * std::numbers::pi * limb.bandwidth;
  Matrix x(N, n), v(N, n), a(N, n);
  for (Index k = 0; k < n; ++k) {
    numeric::Random random(seed, static_cast<std::uint32_t>(k));
    Vector input(N);
    double level = limb.amplitude;
    Index until = 0;
    for (Index i = 0; i < N; ++i) {
      if (i >= until) {
        level = random.uniform() < 0.5 ? -limb.amplitude : limb.amplitude;
        until = i + std::llround(random.uniform(0.03, 0.25) * rate_hz);
      }
      input[i] = level;
    }
    dsp::DerivativeFilter filter(Vector{{1.0, 4.0, 6.0, 4.0}}, 1.0);
    Matrix states(4, N);
    filter.run(pole * T, input.data(), N, states);
    x.col(k) = states.row(0).transpose();
    v.col(k) = pole * states.row(1).transpose();
    a.col(k) = pole * pole * states.row(2).transpose();
  }
  Matrix force = a * limb.M.transpose() + v * limb.B.transpose() + x * limb.K.transpose();
  force.array() += limb.cubic * x.array().cube();
  const Vector along = v * limb.direction;
  const Index late = std::llround(limb.delay * rate_hz);
  const auto answer = [&](const Vector& input) {
    Vector delayed = Vector::Zero(N);
    delayed.tail(N - late) = input.head(N - late);
    dsp::DerivativeFilter filter(Vector{{1.0, 2.0 * limb.damping}});
    Matrix states(2, N);
    filter.run(limb.natural * T, delayed.data(), N, states);
    return Vector(states.row(0).transpose());
  };
  if (limb.reflex_gain.size() > 0) force += answer(along.cwiseMax(0.0)) * limb.reflex_gain.transpose();
  if (limb.linear_gain.size() > 0) force += answer(along) * limb.linear_gain.transpose();
  const double keep = std::exp(-2.0 * std::numbers::pi * 1.5 * T);
  for (Index k = 0; k < n; ++k) {
    numeric::Random random(seed, static_cast<std::uint32_t>(100 + k));
    double noise = random.normal();
    for (Index i = 0; i < N; ++i) {
      noise = keep * noise + std::sqrt(1.0 - keep * keep) * random.normal();
      force(i, k) += limb.noise * noise + limb.white * random.normal();
    }
  }
  ExplorationTrial trial;
  trial.axes = static_cast<int>(n);
  trial.sample_time = T;
  trial.input = std::move(x);
  trial.output = std::move(force);
  trial.split = N;
  trial.recording_duration = duration_s;
  return trial;
}

}  // namespace mbk::validation
