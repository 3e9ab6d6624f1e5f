#include "mbk/simulate/laboratory/prescribed_motion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/model/trial/quantity_channels.h"
#include "mbk/simulate/laboratory/noise.h"

namespace mbk::laboratory {
namespace {

using numeric::Random;
using perturbation::AxesVector;
using perturbation::Jet;
using perturbation::Multisine;
using perturbation::PulseSchedule;
using perturbation::Quantity;
using perturbation::Schedule;
using perturbation::Space;

// Streams of the seed; pulses use stream 0, the sines of axis i stream kSines + i, and so on.
constexpr std::uint32_t kSines = 10, kWhiteForce = 20, kColouredForce = 30, kAcceleration = 40;

Result<void> check(const PrescribedMotionOptions& o) {
  if (o.protocol == Protocol::free)
    return bad_usage("protocol free prescribes no motion", "use sinusoidal or underdamped");
  const Index axes = o.limb.axes();
  if (axes < 1 || axes > 3) return bad_usage(fmt::format("a limb cannot have {} axes; 1 to 3 are supported", axes));
  for (const Matrix* matrix : {&o.limb.M, &o.limb.B, &o.limb.K}) {
    if (matrix->rows() != axes || matrix->cols() != axes || !matrix->allFinite()) {
      return bad_usage(fmt::format("M, B and K must be finite {0}×{0} matrices", axes));
    }
  }
  if (o.limb.x0.size() != axes || !o.limb.x0.allFinite()) {
    return bad_usage(fmt::format("x0 must have {} finite entries", axes));
  }
  if (o.home.size() != axes || !o.home.allFinite()) {
    return bad_usage(fmt::format("home must have {} finite entries", axes));
  }
  const std::pair<const char*, double> positive[] = {
      {"radius", o.radius}, {"moving-in time", o.moving_in}, {"duration", o.sinusoidal_duration}, {"tail", o.tail}};
  for (const auto& [name, value] : positive) {
    if (!(value > 0.0 && std::isfinite(value))) return bad_usage(fmt::format("{} {} is not positive", name, value));
  }
  return {};
}

Result<void> check(const PrescribedMotionSensors& s) {
  const std::pair<const char*, double> parts[] = {{"position quantum", s.position_quantum},
                                                  {"force noise", s.force_noise},
                                                  {"coloured force noise", s.coloured_force_noise},
                                                  {"acceleration noise", s.acceleration_noise}};
  for (const auto& [name, value] : parts) {
    if (!(value >= 0.0 && std::isfinite(value))) return bad_usage(fmt::format("{} {} is negative", name, value));
  }
  const double bandwidth = s.coloured_force_bandwidth.value;
  if (!(bandwidth > 0.0 && std::isfinite(bandwidth))) {
    return bad_usage(fmt::format("bandwidth {} Hz of the coloured force noise is not positive", bandwidth));
  }
  return {};
}

/// One multisine per axis with phases of its own, scaled together so that the path reaches the circle and, sampled at
/// 1 ms, stays within it.
Result<std::vector<Multisine>> sines_in_circle(const PrescribedMotionOptions& o) {
  const std::vector<double> equal(o.harmonics.size(), 1.0);
  std::vector<Multisine> axes;
  for (Index i = 0; i < o.limb.axes(); ++i) {
    auto axis =
        Multisine::with_random_phases(o.period, o.harmonics, equal, o.seed, kSines + static_cast<std::uint32_t>(i));
    if (!axis) return tl::unexpected(axis.error());
    axes.push_back(*std::move(axis));
  }
  double largest = 0.0;
  for (int k = 0; k < o.period * 1000.0; ++k) {
    double square = 0.0;
    for (const Multisine& axis : axes) square += std::pow(axis.at(0.001 * k).value, 2);
    largest = std::max(largest, square);
  }
  for (Multisine& axis : axes) axis = axis.scaled(o.radius / std::sqrt(largest));
  return axes;
}

std::string as_text(const Vector& row) {
  std::vector<std::string> entries;
  for (const double value : row) entries.push_back(fmt::format("{:.17g}", value));
  return fmt::format("[{}]", fmt::join(entries, ", "));
}

std::string as_text(const Matrix& matrix) {
  std::vector<std::string> rows;
  for (Index i = 0; i < matrix.rows(); ++i) rows.push_back(as_text(Vector(matrix.row(i).transpose())));
  return fmt::format("[{}]", fmt::join(rows, ", "));
}

std::map<std::string, std::string> metadata(const PrescribedMotionOptions& o) {
  return {{"protocol", std::string(word_of(o.protocol))},
          {"seed", std::to_string(o.seed)},
          {"truth_M", as_text(o.limb.M)},
          {"truth_B", as_text(o.limb.B)},
          {"truth_K", as_text(o.limb.K)},
          {"truth_x0", as_text(o.limb.x0)}};
}

std::map<std::string, std::string> metadata(const PrescribedMotionSensors& sensors, bool turns) {
  const auto number = [](double value) { return fmt::format("{:.17g}", value); };
  if (turns) {
    return {{"position_quantum_rad", number(sensors.position_quantum)},
            {"reaction_noise_Nm", number(sensors.force_noise)},
            {"coloured_noise_Nm", number(sensors.coloured_force_noise)},
            {"coloured_bandwidth_hz", number(sensors.coloured_force_bandwidth.value)}};
  }
  return {{"position_quantum_m", number(sensors.position_quantum)},
          {"force_noise_N", number(sensors.force_noise)},
          {"coloured_force_noise_N", number(sensors.coloured_force_noise)},
          {"coloured_force_bandwidth_hz", number(sensors.coloured_force_bandwidth.value)},
          {"acceleration_noise_m_per_s2", number(sensors.acceleration_noise)}};
}

}  // namespace

impedance::Model relaxed_arm() {
  impedance::Model arm;
  arm.M = (Matrix(2, 2) << 1.326, -0.935, -0.935, 1.883).finished();
  arm.B = (Matrix(2, 2) << 5.76, -2.14, -2.14, 10.56).finished();
  arm.K = (Matrix(2, 2) << 42.4, -28.6 + 7.7, -28.6 - 7.7, 125.3).finished();
  arm.x0 = Eigen::Vector2d(0.284, 0.017);
  return arm;
}

impedance::Model relaxed_arm_one_axis() {
  const impedance::Model arm = relaxed_arm();
  return {arm.M.bottomRightCorner(1, 1), arm.B.bottomRightCorner(1, 1), arm.K.bottomRightCorner(1, 1), arm.x0.tail(1)};
}

Result<PrescribedMotion> PrescribedMotion::create(const PrescribedMotionOptions& options) {
  MBK_TRY(check(options));
  if (options.protocol == Protocol::sinusoidal) {
    auto axes = MBK_TRY(sines_in_circle(options));
    auto schedule = MBK_TRY(Schedule::multisine(std::move(axes), Quantity::position, Space::hand,
                                                options.sinusoidal_duration, options.moving_in));
    return PrescribedMotion(options.home, std::move(schedule));
  }
  PulseSchedule::Options pulses = options.pulses;
  pulses.seed = options.seed;
  if (options.limb.axes() == 1) {
    pulses.repetitions = std::max(1, pulses.directions * pulses.repetitions / 2);
    pulses.directions = 2;
  }
  pulses.axes = options.limb.axes() == 3 ? 3 : 2;
  auto schedule = MBK_TRY(Schedule::pulses(pulses, Quantity::position, options.tail));
  return PrescribedMotion(options.home, std::move(schedule));
}

Jet<AxesVector> PrescribedMotion::at(double t) const {
  const Jet<AxesVector> d = schedule_.at(t);
  return {home_ + d.value.head(axes()), d.first.head(axes()), d.second.head(axes())};
}

AxesVector PrescribedMotion::reference(double t) const {
  return home_ + schedule_.reference(t).head(axes());
}

std::vector<Event> PrescribedMotion::events() const {
  std::vector<Event> events;
  for (const perturbation::ScheduleEvent& event : schedule_.events()) {
    events.push_back({event.time, event.name, event.value});
  }
  return events;
}

Result<Recording> record(const PrescribedMotion& motion, const HandForce& force_of,
                         const PrescribedMotionSensors& sensors, std::uint64_t seed, Hertz rate) {
  if (!(rate.value > 0.0 && std::isfinite(rate.value))) {
    return bad_usage(fmt::format("sample rate {} Hz is not positive", rate.value));
  }
  MBK_TRY(check(sensors));

  const Index axes = motion.axes();
  const auto samples = static_cast<Index>(std::llround(motion.duration() * rate.value));
  Matrix position(samples, axes), force(samples, axes), reference(samples, axes), acceleration(samples, axes);
  Recording recording;
  recording.time.resize(samples);
  for (Index i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i + 1) / rate.value;
    const Jet<AxesVector> x = motion.at(t);
    recording.time[i] = t;
    position.row(i) = x.value.transpose();
    acceleration.row(i) = x.second.transpose();
    reference.row(i) = motion.reference(t).transpose();
    force.row(i) = force_of(x).transpose();
    if (!force.row(i).allFinite()) {
      return bad_data(fmt::format("the force of the limb is not finite at {:.3f} s", t),
                      "make the perturbation smaller, so that the arm can follow it");
    }
  }

  const bool turns = motion.turns();
  const auto add = [&](const QuantityChannels& quantity, const char* unit, const Matrix& signals, const auto& sense) {
    for (Index i = 0; i < axes; ++i) {
      Vector signal = signals.col(i);
      sense(signal, static_cast<std::uint32_t>(i));
      recording.channels.push_back({quantity.name(static_cast<int>(axes), i), turns ? unit : quantity.unit,
                                    turns ? "joint" : quantity.frame, std::move(signal)});
    }
  };
  add(kPositionChannels, "rad", position, [&](Vector& s, std::uint32_t) {
    for (double& value : s) value = quantised(value, sensors.position_quantum);
  });
  add(kForceChannels, "N.m", force, [&](Vector& s, std::uint32_t axis) {
    WhiteNoise white(sensors.force_noise, Random(seed, kWhiteForce + axis));
    ColouredNoise coloured(sensors.coloured_force_noise, sensors.coloured_force_bandwidth, 1.0 / rate.value,
                           Random(seed, kColouredForce + axis));
    for (double& value : s) value = value + white.next() + coloured.next();
  });
  add(kReferenceChannels, "rad", reference, [](Vector&, std::uint32_t) {});
  if (!turns) {
    add(kAccelerationChannels, "", acceleration, [&](Vector& s, std::uint32_t axis) {
      WhiteNoise white(sensors.acceleration_noise, Random(seed, kAcceleration + axis));
      for (double& value : s) value += white.next();
    });
  }
  recording.events = motion.events();
  recording.metadata = metadata(sensors, turns);
  return recording;
}

Result<Recording> record_prescribed_motion(const PrescribedMotionOptions& options, Hertz rate) {
  const auto motion = MBK_TRY(PrescribedMotion::create(options));
  using AxesMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
  const AxesMatrix M = options.limb.M, B = options.limb.B, K = options.limb.K;
  const AxesVector x0 = options.limb.x0;
  const auto force = [&](const Jet<AxesVector>& x) -> AxesVector {
    return -(M * x.second + B * x.first + K * (x.value - x0));
  };
  auto recording = MBK_TRY(record(motion, force, options.sensors, options.seed, rate));
  recording.metadata.merge(metadata(options));
  return recording;
}

}  // namespace mbk::laboratory
