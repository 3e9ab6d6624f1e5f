// How long the dynamics of the robot take: of a recording of 62 s at 1 kHz, and of one step of the momentum observer.
//   bench_robot_dynamics --benchmark_filter=observer
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "mbk/model/robot/observed_force.h"
#include "mbk/model/robot/planar_mechanism.h"

namespace {

using namespace mbk;

constexpr Index kSamples = 62'000;
constexpr double kTick = 1e-3;

robot::DynamicModel thesis_robot() {
  robot::DynamicModel model{std::make_shared<robot::PlanarMechanism>(robot::PlanarMechanism::Options{}),
                            {.stribeck = true, .cable = true}};
  model.parameters.resize(static_cast<Index>(model.coefficients().size()));
  model.parameters << 0.06929, 0.04217, 0.04416,  // bodies
      0.0651, 0.11, 0.02, 0.3, 0.01,              // viscous, Coulomb, Stribeck, cable, offset of joint 1
      0.0739, 0.10, 0.02, 0.2, -0.01;
  return model;
}

/// Sines of 1 to 3 Hz about a place in the workspace.
robot::JointMotion motion() {
  robot::JointMotion motion{Matrix(kSamples, 2), Matrix(kSamples, 2), Matrix(kSamples, 2)};
  for (Index i = 0; i < kSamples; ++i) {
    for (Index joint = 0; joint < 2; ++joint) {
      const double omega = 6.0 + 9.0 * static_cast<double>(joint), phase = omega * kTick * static_cast<double>(i);
      motion.position(i, joint) = 0.4 + 0.5 * static_cast<double>(joint) + 0.1 * std::sin(phase);
      motion.velocity(i, joint) = 0.1 * omega * std::cos(phase);
      motion.acceleration(i, joint) = -0.1 * omega * omega * std::sin(phase);
    }
  }
  return motion;
}

void inverse_dynamics_of_62_s(benchmark::State& state) {
  const robot::DynamicModel model = thesis_robot();
  const robot::JointMotion moving = motion();
  for (auto _ : state) benchmark::DoNotOptimize(model.torques(moving));
}
BENCHMARK(inverse_dynamics_of_62_s)->Unit(benchmark::kMillisecond);

void regressors_of_62_s(benchmark::State& state) {
  const robot::DynamicModel model = thesis_robot();
  const robot::JointMotion moving = motion();
  for (auto _ : state) benchmark::DoNotOptimize(model.regressors(moving));
}
BENCHMARK(regressors_of_62_s)->Unit(benchmark::kMillisecond);

/// The value, or the end: a benchmark of an error would be one of nothing.
template <class Value>
Value value_of(Result<Value> result) {
  if (result) return std::move(*result);
  std::fputs((result.error().line() + "\n").c_str(), stderr);
  std::exit(1);
}

void observer_step(benchmark::State& state) {
  const robot::DynamicModel model = thesis_robot();
  const robot::JointMotion moving = motion();
  const Matrix torque = model.torques(moving);
  auto observer = value_of(robot::MomentumObserver::create(model, 60.0, kTick));
  Index i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(observer.step(moving.position.row(i).transpose(), moving.velocity.row(i).transpose(),
                                           torque.row(i).transpose()));
    if (++i == kSamples) i = 0;
  }
}
BENCHMARK(observer_step)->Unit(benchmark::kNanosecond);

void encoder_observer_step(benchmark::State& state) {
  const robot::DynamicModel model = thesis_robot();
  const robot::JointMotion moving = motion();
  const Matrix torque = model.torques(moving);
  auto observer = value_of(robot::EncoderMomentumObserver::create(model, {}, kTick));
  Index i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(observer.step(moving.position.row(i).transpose(), torque.row(i).transpose()));
    if (++i == kSamples) i = 0;
  }
}
BENCHMARK(encoder_observer_step)->Unit(benchmark::kNanosecond);

void observed_force_of_62_s(benchmark::State& state) {
  const robot::DynamicModel model = thesis_robot();
  const robot::JointMotion moving = motion();
  const Matrix torque = model.torques(moving);
  for (auto _ : state) {
    benchmark::DoNotOptimize(value_of(robot::observe_force(model, moving.position, torque, {}, kTick)));
  }
}
BENCHMARK(observed_force_of_62_s)->Unit(benchmark::kMillisecond);

}  // namespace
