#include "mbk/measure/preprocess/virtual_force.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mbk/measure/preprocess/band.h"
#include "mbk/measure/preprocess/filters.h"
#include "mbk/measure/preprocess/joint_signals.h"
#include "mbk/measure/preprocess/joint_smoothing.h"
#include "mbk/measure/preprocess/recording_checks.h"
#include "mbk/measure/preprocess/signals.h"
#include "mbk/measure/preprocess/trial_clock.h"
#include "mbk/measure/preprocess/windows.h"
#include "mbk/model/robot/observed_force.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {
namespace {

double rms(const Matrix& values) {
  return std::sqrt(values.cwiseAbs2().mean());
}

/// Torques that are a thousand times too large or too small give forces that no hand exerts.
Result<void> check_torque_unit(const Matrix& force, const Matrix& torque, const Matrix& of_model, bool slides) {
  constexpr double kStrongest = 1000.0;  // [N], rms, of a hand
  constexpr double kMinTorque = 0.02;    // of what the robot's own motion takes
  const char* const unit = slides ? "N" : "N·m";
  if (rms(force) > kStrongest) {
    return bad_data(fmt::format("the force at the hand would be {:.3g} kN (rms): the torques (rms {:.3g}) are probably "
                                "not in {}",
                                1e-3 * rms(force), rms(torque), unit),
                    "state their unit with --channels, as in tau1=14:N.mm,tau2=15:N.mm");
  }
  if (rms(torque) < kMinTorque * rms(of_model)) {
    return bad_data(
        fmt::format("the torques (rms {:.3g} {unit}) are {:.2g} % of those needed for the motion of the robot itself "
                    "({:.3g} {unit}): the torques or the robot's parameters are in another unit",
                    rms(torque), 100.0 * rms(torque) / rms(of_model), rms(of_model), fmt::arg("unit", unit)),
        "state the unit of the torques with --channels, or identify the robot from recordings in the same unit");
  }
  return {};
}

/// Rows before `first` and from `last` on take the value of the nearest that was computed.
Matrix held(const Matrix& computed, Index first, Index samples) {
  const Index last = first + computed.rows();
  Matrix all(samples, computed.cols());
  all.middleRows(first, computed.rows()) = computed;
  all.topRows(first).rowwise() = computed.row(0);
  all.bottomRows(samples - last).rowwise() = computed.row(computed.rows() - 1);
  return all;
}

void put(Recording& recording, const std::string& name, const char* unit, const Vector& values) {
  for (Channel& channel : recording.channels) {
    if (channel.name != name) continue;
    channel.values = values;
    channel.unit = unit;
    return;
  }
  recording.channels.push_back({name, unit, "base", values});
}

/// What the force rests on where the hand may be pushed in other directions, too, than those in which it is measured;
/// "" where it may not.
std::string assumed_of_hand(const robot::Mechanism& mechanism, const robot::JointVector& position) {
  const Index others = mechanism.jacobian_across(position).rows();
  if (others == 0) return {};
  std::string axes;
  for (int k = 0; k < mechanism.hand_axes(); ++k) axes += (k == 0 ? "" : " and ") + mechanism.hand_axis_name(k);
  const Index told = robot::told_across(mechanism, position);
  return fmt::format("the force is along {} of the base frame, assuming that the hand exerts no moment{}", axes,
                     told == others ? "; a force perpendicular to them is estimated and ignored"
                                    : "; a force perpendicular to them is not observable and assumed to be zero");
}

/// Damping at the hand that a tenth of the robot's friction would be, the largest of the axes: friction that changes as
/// the robot warms passes into the computed force, and nothing in the recording shows it.
double damping_of_tenth(const robot::DynamicModel& model, const robot::JointMotion& motion,
                        const std::vector<Matrix>& W) {
  const std::vector<robot::Coefficient> names = model.coefficients();
  const Index n = model.mechanism->joints(), middle = motion.samples() / 2;
  Vector damping = Vector::Zero(n);
  for (Index joint = 0; joint < n; ++joint) {
    const Vector v = motion.velocity.col(joint);
    double power = 0.0;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const std::string& name = names[k].name;
      if (!name.starts_with("viscous") && !name.starts_with("coulomb") && !name.starts_with("stribeck")) continue;
      const auto column = static_cast<Index>(k);
      power += model.parameters[column] * W[static_cast<std::size_t>(joint)].col(column).dot(v);
    }
    if (v.squaredNorm() > 0.0) damping[joint] = 0.1 * power / v.squaredNorm();
  }
  const auto hand = robot::hand_from_joints(*model.mechanism, motion.position.row(middle).transpose());
  if (!hand) return 0.0;
  return (Matrix(*hand) * damping.asDiagonal() * Matrix(*hand).transpose()).diagonal().maxCoeff();
}

}  // namespace

Result<VirtualForce> virtual_force(const Recording& recording, const Inspection& inspection,
                                   const robot::DynamicModel& model, const Options& options) {
  MBK_TRY(check_choices(options));
  const robot::Mechanism& mechanism = *model.mechanism;
  const Index samples = recording.samples(), n = mechanism.joints(), axes = mechanism.hand_axes();
  constexpr Index kMin = 100;
  if (samples < kMin || !(inspection.rate_hz > 0.0)) {
    return bad_data(fmt::format("{} samples cannot show a force", samples), "record longer");
  }
  const Hertz rate(inspection.rate_hz);
  const Clock clock(recording.time, rate);
  const bool published = options.mode == Mode::reference;
  const bool accelerometer =
      options.acceleration.value_or(published && options.procedure == Procedure::chapter5
                                        ? AccelerationSource::sensor
                                        : AccelerationSource::derivative) == AccelerationSource::sensor;
  const auto signals = MBK_TRY(select_joint_signals(recording, mechanism, accelerometer));
  const WindowLimits limits =
      published ? WindowLimits{} : WindowLimits{options.window.from_s, std::nullopt, options.window.to_s};
  const auto plan = MBK_TRY(default_windows(Protocol::free, {}, clock, limits));
  std::vector<Warning> warnings;
  MBK_TRY(check_missing(clock, inspection.missing, limits));
  MBK_TRY(check_clock(clock, inspection, plan, warnings));
  std::vector<std::string> notes;
  MBK_TRY(check_joint_signals(signals, mechanism, clock, plan, notes));
  const Cut cut = plan.cuts.front();
  FilterPlan filters = reference_filters(options);
  if (!published) {
    const auto band = MBK_TRY(excited_band(signals.position, plan.cuts, rate));
    filters = improved_filters(options, band, rate, cut.end - cut.begin);
  }
  dsp::SavitzkyGolay smoothing = filters.smoothing;
  if (filters.cutoff && !published && !options.smoothing_window) {
    const auto shorter =
        MBK_TRY(smoothing_of_joints(filters.smoothing, signals.position, plan.cuts, model.drive, rate));
    smoothing = shorter;
  }
  const auto joints = MBK_TRY(smooth_joints(signals, mechanism, cut, smoothing, rate, model.delay));

  VirtualForce made;
  made.first = cut.begin + smoothing.half_window();
  const Index rows = joints.torque.rows();
  made.last = made.first + rows;
  made.filters = filters;
  const bool observed = options.force_source == ForceSource::observer;
  const bool sure = observed || model.covariance.size() == 0 || model.covariance.isZero(0.0);
  const std::vector<Matrix> W = model.regressors(joints.motion);
  const Index p = model.parameters.size();
  Matrix of_model(rows, n);
  for (Index joint = 0; joint < n; ++joint) of_model.col(joint) = W[static_cast<std::size_t>(joint)] * model.parameters;
  const Matrix missing = of_model - joints.torque;
  Matrix force(rows, axes), sensitivity(sure ? 0 : rows, axes * p), error(sure ? 0 : rows, axes);
  Matrix of_sample(n, p);
  for (Index i = 0; i < rows; ++i) {
    const auto hand = robot::hand_from_joints(mechanism, joints.motion.position.row(i).transpose());
    if (!hand) {
      const Index sample = made.first + i;
      return tl::unexpected(hand.error().in(fmt::format("sample {} ({:.6f} s)", sample + 1, clock.seconds(sample))));
    }
    force.row(i) = (*hand * missing.row(i).transpose()).transpose();
    if (sure) continue;
    for (Index joint = 0; joint < n; ++joint) of_sample.row(joint) = W[static_cast<std::size_t>(joint)].row(i);
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> at_hand = *hand * of_sample;
    sensitivity.row(i) = Eigen::Map<const Eigen::RowVectorXd>(at_hand.data(), at_hand.size());
    error.row(i) = (at_hand * model.covariance * at_hand.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt().transpose();
  }
  if (observed) {
    const Index length = cut.end - cut.begin;
    const auto forces =
        MBK_TRY(robot::observe_force(model, signals.position.middleRows(cut.begin, length),
                                     signals.torque.middleRows(cut.begin, length), {}, 1.0 / rate.value));
    made.lag = forces.lag;
    force = forces.force_hand_on_robot.middleRows(smoothing.half_window(), rows);
  }
  MBK_TRY(check_torque_unit(force, joints.torque, of_model, mechanism.slides(0)));

  made.recording = recording;
  const Matrix whole = held(force, made.first, samples);
  made.joint_velocity = held(joints.motion.velocity, made.first, samples);
  if (!sure) {
    made.sensitivity = held(sensitivity, made.first, samples);
    made.standard_error = held(error, made.first, samples);
  }
  const int kinds = static_cast<int>(axes);
  std::vector<const Channel*> recorded;
  for (Index axis = 0; axis < axes; ++axis) recorded.push_back(recording.find(kForceChannels.name(kinds, axis)));
  if (std::ranges::find(recorded, nullptr) == recorded.end()) {
    made.sensor_force.resize(samples, axes);
    for (Index axis = 0; axis < axes; ++axis) {
      made.sensor_force.col(axis) = recorded[static_cast<std::size_t>(axis)]->values;
    }
  }
  const bool turns = mechanism.hand_turns();
  Matrix place;
  for (Index axis = 0; axis < axes; ++axis) {
    put(made.recording, kForceChannels.name(kinds, axis), turns ? "N.m" : "N", whole.col(axis));
    const char* const hand = kPositionChannels.name(kinds, axis);
    if (recording.find(hand) != nullptr) continue;
    if (place.size() == 0) {
      place.resize(samples, axes);
      for (Index i = 0; i < samples; ++i) {
        place.row(i) = mechanism.hand_position(signals.position.row(i).transpose()).transpose();
      }
    }
    put(made.recording, hand, turns ? "rad" : "m", place.col(axis));
  }
  made.recording.notes.push_back(observed ? fmt::format("the force is not measured: a momentum observer computes it "
                                                        "from motion, torques and a model of the robot, {:.0f} ms late",
                                                        1e3 * made.lag)
                                          : fmt::format("the force is not measured: a virtual sensor computes it from "
                                                        "motor torques, motion and a model of the robot, q̈ {}",
                                                        accelerometer ? "from the accelerometer" : "from the joints"));
  if (const double damping = damping_of_tenth(model, joints.motion, W); damping > 0.0) {
    made.recording.notes.push_back(
        fmt::format("if the friction of the robot is 10 % lower than at identification, for example because it is "
                    "warmer, the damping is up to {:.2g} {} too small, which the recording cannot show",
                    damping, turns ? "N·m·s/rad" : "N·s/m"));
  }
  if (auto assumed = assumed_of_hand(mechanism, joints.motion.position.row(0).transpose()); !assumed.empty()) {
    made.recording.notes.push_back(std::move(assumed));
  }
  made.recording.notes.insert(made.recording.notes.end(), notes.begin(), notes.end());
  return made;
}

}  // namespace mbk::preprocess
