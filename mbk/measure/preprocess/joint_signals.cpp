#include "mbk/measure/preprocess/joint_signals.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "mbk/measure/preprocess/recording_checks.h"
#include "mbk/model/robot/dynamic_model.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {
namespace {

std::string there(const Recording& recording) {
  std::vector<std::string> names;
  for (const Channel& channel : recording.channels) names.push_back(channel.name);
  return names.empty() ? "there are no channels" : fmt::format("the channels are {}", fmt::join(names, ", "));
}

std::string quoted(const std::vector<std::string>& names) {
  return fmt::format("'{}'", fmt::join(names, "', '"));
}

/// The channels joint_k, torque_k or reference_joint_k of a robot's joints: by the names of the joints where both robot
/// and recording have them, and else by number.
class JointChannels {
 public:
  JointChannels(const Recording& recording, const robot::Mechanism& mechanism, std::string prefix)
      : recording_(recording), robot_(mechanism.joint_names()), prefix_(std::move(prefix)) {
    for (const Channel& channel : recording.channels) {
      const bool counts = channel.name.starts_with(prefix_) && !channel.origin.joint.empty();
      if (counts) named_.push_back(&channel);
    }
  }

  [[nodiscard]] bool by_name() const { return !named_.empty() && !robot_.empty(); }

  /// @fails  data: there is no joint of that name, or there are two; a robot without names has fewer joints than the
  /// recording.
  [[nodiscard]] Result<void> check(int joints) const {
    std::vector<std::string> there;
    for (const Channel* channel : named_) there.push_back(channel->origin.joint);
    if (robot_.empty() && std::ssize(there) > joints) {
      return bad_data(fmt::format("the recording has the joints {}, but the robot has {} without names", quoted(there),
                                  joints == 1 ? "one" : fmt::format("{}", joints)),
                      fmt::format("select those of the robot with --channels, as in q1=NAME,tau1=NAME"));
    }
    if (!by_name()) return {};
    for (int k = 0; k < joints; ++k) {
      const std::string& name = robot_[static_cast<std::size_t>(k)];
      const auto count = std::ranges::count(there, name);
      if (count == 1 || (count == 0 && unnamed(k) != nullptr && in_order(joints))) continue;
      return bad_data(fmt::format("the recording has {} joint '{}'; its joints are {}, those of the robot {}",
                                  count == 0 ? "no" : "more than one", name, quoted(there), quoted(robot_)),
                      "correct the names in the description of the robot, or assign the joints with --channels, "
                      "as in q1=NAME,tau1=NAME");
    }
    return {};
  }

  /// The channel of a joint; nullptr where there is none.
  [[nodiscard]] const Channel* of(int joint) const {
    if (!by_name()) return recording_.find(numbered(joint));
    const auto named = std::ranges::find(named_, robot_[static_cast<std::size_t>(joint)],
                                         [](const Channel* channel) { return channel->origin.joint; });
    return named == named_.end() ? unnamed(joint) : *named;
  }

  /// Whether every joint has the channel of its number.
  [[nodiscard]] bool in_order(int joints) const {
    for (int k = 0; k < joints; ++k) {
      if (of(k) != nullptr && of(k)->name != numbered(k)) return false;
    }
    return true;
  }

  [[nodiscard]] std::string numbered(int joint) const { return fmt::format("{}{}", prefix_, joint + 1); }

 private:
  /// That of its number, where it says no name.
  [[nodiscard]] const Channel* unnamed(int joint) const {
    const Channel* const channel = recording_.find(numbered(joint));
    return channel != nullptr && channel->origin.joint.empty() ? channel : nullptr;
  }

  const Recording& recording_;
  std::vector<std::string> robot_;
  std::string prefix_;
  std::vector<const Channel*> named_;
};

/// @param channel  nullptr: it is missing    @param unit  that the joint has
Result<void> check_unit(const Recording& recording, const Channel* channel, const std::string& name, const char* unit) {
  if (channel == nullptr) {
    return bad_data(fmt::format("channel '{}' is missing; {}{}", name, there(recording), why_missing(recording, name)),
                    fmt::format("name it with --channels, as in {}=6", name));
  }
  if (!channel->unit.empty() && channel->unit != unit) {
    const std::string& joint = channel->origin.joint;
    return bad_data(fmt::format("channel '{}' is in {}, but this joint{} needs {}", channel->name, channel->unit,
                                joint.empty() ? "" : fmt::format(" ('{}')", joint), unit),
                    fmt::format("state the unit in the file with --channels, as in {}=6:{}", name, unit));
  }
  return {};
}

/// All of a kind side by side, or nothing where one is missing.
Matrix gather(const Recording& recording, const std::vector<std::string>& names, std::string_view unit) {
  Matrix columns(recording.samples(), static_cast<Index>(names.size()));
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Channel* channel = recording.find(names[k]);
    if (channel == nullptr || channel->unit != unit) return {};
    columns.col(static_cast<Index>(k)) = channel->values;
  }
  return columns;
}

/// Row and fraction of a cubic between two samples whose slopes are known (Hermite).
void shift(Matrix& values, const Matrix& slopes, double sample_time, double delay) {
  const Index rows = values.rows();
  if (delay == 0.0 || rows < 2) return;
  const Matrix old = values;
  for (Index i = 0; i < rows; ++i) {
    const double at = static_cast<double>(i) - delay / sample_time;
    const double low = std::clamp(std::floor(at), 0.0, static_cast<double>(rows - 2));
    const auto k = static_cast<Index>(low);
    const double u = at - low;
    if (u < 0.0 || u > 1.0) {
      const Index end = u < 0.0 ? 0 : rows - 1;
      values.row(i) = old.row(end) + (at - static_cast<double>(end)) * sample_time * slopes.row(end);
      continue;
    }
    const double a = u * u * (3.0 - 2.0 * u), b = u * (1.0 - u) * (1.0 - u), c = u * u * (u - 1.0);
    values.row(i) =
        (1.0 - a) * old.row(k) + a * old.row(k + 1) + sample_time * (b * slopes.row(k) + c * slopes.row(k + 1));
  }
}

/// Whether the robot could stand near there: no joint has to move by more than 1 % of its range, or 0.01 rad.
bool nearly_within_limits(const robot::Mechanism& mechanism, robot::JointVector q) {
  constexpr double kShare = 0.01, kLargestAngle = 0.01;  // of the range; [rad]
  robot::JointVector reach = robot::JointVector::Zero(q.size());
  for (int joint = 0; joint < mechanism.joints(); ++joint) {
    const robot::JointRange range = mechanism.joint_range(joint);
    if (!std::isfinite(range.high - range.low)) continue;
    const double share = kShare * (range.high - range.low);
    reach[joint] = mechanism.slides(joint) ? share : std::min(share, kLargestAngle);
    const double inside = std::clamp(q[joint], range.low, range.high);
    if (!(std::abs(q[joint] - inside) <= reach[joint])) return false;
    q[joint] = inside;
  }
  if (mechanism.check_joints(q)) return true;
  for (Index joint = 0; joint < q.size(); ++joint) {  // joints that limit each other
    for (const double sign : {-1.0, 1.0}) {
      robot::JointVector moved = q;
      moved[joint] += sign * reach[joint];
      if (mechanism.check_joints(moved)) return true;
    }
  }
  return false;
}

}  // namespace

Result<JointSignals> select_joint_signals(const Recording& recording, const robot::Mechanism& mechanism,
                                          bool hand_acceleration) {
  const Index n = mechanism.joints(), axes = mechanism.hand_axes(), samples = recording.samples();
  JointSignals signals;
  signals.position.resize(samples, n);
  signals.torque.resize(samples, n);
  const JointChannels positions(recording, mechanism, "joint_"), torques(recording, mechanism, "torque_"),
      references(recording, mechanism, "reference_joint_");
  for (const JointChannels* channels : {&positions, &torques}) {
    MBK_TRY(channels->check(static_cast<int>(n)));
  }
  // Unnamed channels may be counted beside named ones only if the named ones are in the robot's order.
  const auto count_alike = [&](const JointChannels& a, const JointChannels& b) {
    return a.by_name() == b.by_name() || (a.in_order(static_cast<int>(n)) && b.in_order(static_cast<int>(n)));
  };
  if (!count_alike(positions, torques)) {
    return bad_data(
        fmt::format("only the channels {}… name their joints, and their order differs from that of the robot: {}",
                    positions.by_name() ? "joint_1" : "torque_1", quoted(mechanism.joint_names())),
        "assign the joints with --channels, as in q1=NAME,tau1=NAME");
  }
  std::vector<std::string> joint_references;
  for (int joint = 0; joint < n; ++joint) {
    const bool slides = mechanism.slides(joint);
    const Channel* position = positions.of(joint);
    if (n == 1 && position == nullptr) position = recording.find("position");
    MBK_TRY(check_unit(recording, position, positions.numbered(joint), slides ? "m" : "rad"));
    signals.position.col(joint) = position->values;
    const Channel* const torque = torques.of(joint);
    MBK_TRY(check_unit(recording, torque, torques.numbered(joint), slides ? "N" : "N.m"));
    signals.torque.col(joint) = torque->values;
    const Channel* const reference = references.of(joint);
    joint_references.push_back(reference != nullptr ? reference->name : "");
  }
  if (!count_alike(positions, references)) joint_references.front().clear();
  signals.joint_reference = gather(recording, joint_references, mechanism.slides(0) ? "m" : "rad");
  const int kinds = static_cast<int>(axes);
  const auto at_hand = [&](const QuantityChannels& quantity) {
    std::vector<std::string> names;
    for (Index axis = 0; axis < kinds; ++axis) names.emplace_back(quantity.name(kinds, axis));
    return names;
  };
  const bool slides = !mechanism.hand_turns();
  signals.hand_reference = gather(recording, at_hand(kReferenceChannels), slides ? "m" : "rad");
  if (hand_acceleration) {
    signals.hand_acceleration = gather(recording, at_hand(kAccelerationChannels), slides ? "m/s2" : "rad/s2");
    if (signals.hand_acceleration.size() == 0) {
      return bad_data(
          fmt::format("channel '{}' is missing; {}", kAccelerationChannels.name(kinds, 0), there(recording)),
          "name it with --channels, or use --acceleration derivative");
    }
  }
  return signals;
}

Result<void> check_joint_signals(const JointSignals& signals, const robot::Mechanism& mechanism, const Clock& clock,
                                 const WindowPlan& plan, std::vector<std::string>& notes) {
  const auto at = [&](Index sample) { return fmt::format("sample {} ({:.6f} s)", sample + 1, clock.seconds(sample)); };
  const std::vector<std::string> names = mechanism.joint_names();
  const auto named = [&](Index joint) {
    return names.empty() ? std::string() : fmt::format(" ('{}')", names[static_cast<std::size_t>(joint)]);
  };
  Index beyond = 0;
  std::string first_beyond;
  for (const Cut& cut : plan.cuts) {
    const Index length = cut.end - cut.begin;
    for (Index joint = 0; joint < signals.position.cols(); ++joint) {
      const auto bad = [&](const Matrix& columns, const char* name) -> Result<void> {
        const Index where = first_non_finite(columns.col(joint).segment(cut.begin, length));
        if (where < 0) return {};
        return bad_data(fmt::format("channel '{}_{}'{} is not a number at {}", name, joint + 1, named(joint),
                                    at(cut.begin + where)),
                        "choose a window without it with --from and --to, or correct the recording");
      };
      MBK_TRY(bad(signals.position, "joint"));
      MBK_TRY(bad(signals.torque, "torque"));
    }
    for (Index i = cut.begin; i < cut.end; ++i) {
      const robot::JointVector q = signals.position.row(i).transpose();
      if (auto ok = mechanism.check_joints(q); !ok) {
        Error error = ok.error();
        if (nearly_within_limits(mechanism, q)) {
          if (beyond++ == 0) first_beyond = fmt::format("{} at {}", error.message, at(i));
          continue;
        }
        error.kind = ErrorKind::data;
        error.message = fmt::format("at {}: {}", at(i), error.message);
        error.remedy =
            "check unit, sign and order of the joints in --channels, choose a window with --from and --to, "
            "or give the robot's own limits with --robot";
        return tl::unexpected(std::move(error));
      }
    }
  }
  if (beyond > 0) {
    notes.push_back(fmt::format("{}: {} {} beyond a limit by less than 1 % of the range, which is accepted",
                                first_beyond, beyond, beyond == 1 ? "sample is" : "samples are"));
  }
  for (Index joint = 0; joint < signals.torque.cols(); ++joint) {
    const auto torque = signals.torque.col(joint);
    if (torque.minCoeff() == torque.maxCoeff() && torque[0] == 0.0) {
      return bad_data(
          fmt::format("channel 'torque_{}'{} is zero throughout: the torque was not recorded", joint + 1, named(joint)),
          "name the column of the motor's torque with --channels");
    }
  }
  return {};
}

Vector position_noise(const Matrix& position, const std::vector<Cut>& cuts) {
  constexpr std::array kWeights = {1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0};
  constexpr double kSquares = 924.0;  // of the weights
  Vector sum = Vector::Zero(position.cols());
  Index count = 0;
  for (const Cut& cut : cuts) {
    const Index rows = cut.end - cut.begin - static_cast<Index>(kWeights.size()) + 1;
    if (rows < 1) continue;
    Matrix difference = Matrix::Zero(rows, position.cols());
    for (std::size_t k = 0; k < kWeights.size(); ++k) {
      difference += kWeights[k] * position.middleRows(cut.begin + static_cast<Index>(k), rows);
    }
    sum += difference.colwise().squaredNorm().transpose();
    count += rows;
  }
  return (sum / (kSquares * static_cast<double>(std::max<Index>(count, 1)))).cwiseSqrt();
}

std::vector<bool> standing_joints(const JointSignals& signals, const WindowPlan& plan) {
  constexpr double kStepsEnough = 20.0;
  const Vector noise = position_noise(signals.position, plan.cuts);
  std::vector<bool> stands;
  for (Index joint = 0; joint < signals.position.cols(); ++joint) {
    double step = std::numeric_limits<double>::infinity(), motion = 0.0;
    for (const Cut& cut : plan.cuts) {
      const Vector q = signals.position.col(joint).segment(cut.begin, cut.end - cut.begin);
      motion = std::max(motion, std::sqrt((q.array() - q.mean()).square().mean()));
      for (Index i = 1; i < q.size(); ++i) {
        const double change = std::abs(q[i] - q[i - 1]);
        if (change > 0.0) step = std::min(step, change);
      }
    }
    stands.push_back(motion < kStepsEnough * std::max(step, std::sqrt(12.0) * noise[joint]));
  }
  return stands;
}

Result<robot::JointMotion> smooth_motion(const Eigen::Ref<const Matrix>& position, const dsp::SavitzkyGolay& smoothing,
                                         Hertz rate) {
  robot::JointMotion motion;
  int derivative = 0;
  for (Matrix* part : {&motion.position, &motion.velocity, &motion.acceleration}) {
    *part = MBK_TRY(dsp::savitzky_golay(smoothing, derivative++, position, rate));
  }
  return motion;
}

Result<SmoothedJoints> smooth_joints(const JointSignals& signals, const robot::Mechanism& mechanism, const Cut& cut,
                                     const dsp::SavitzkyGolay& smoothing, Hertz rate, double delay) {
  const Index length = cut.end - cut.begin;
  SmoothedJoints joints;
  auto motion = MBK_TRY(smooth_motion(signals.position.middleRows(cut.begin, length), smoothing, rate));
  joints.motion = std::move(motion);
  const Matrix recorded = signals.torque.middleRows(cut.begin, length);
  auto torque = MBK_TRY(dsp::savitzky_golay(smoothing, 0, recorded, rate));
  auto torque_rate = MBK_TRY(dsp::savitzky_golay(smoothing, 1, recorded, rate));
  joints.torque = std::move(torque);
  joints.torque_rate = std::move(torque_rate);
  shift(joints.torque, joints.torque_rate, 1.0 / rate.value, delay);

  if (signals.hand_acceleration.size() > 0) {
    auto hand =
        MBK_TRY(dsp::savitzky_golay(smoothing, 0, signals.hand_acceleration.middleRows(cut.begin, length), rate));
    for (Index i = 0; i < hand.rows(); ++i) {
      const robot::JointVector q = joints.motion.position.row(i).transpose(),
                               v = joints.motion.velocity.row(i).transpose();
      const auto from_joints = robot::hand_from_joints(mechanism, q);
      if (!from_joints) {
        return tl::unexpected(
            from_joints.error().in(fmt::format("sample {}", cut.begin + smoothing.half_window() + i)));
      }
      joints.motion.acceleration.row(i) =
          (from_joints->transpose() * (hand.row(i).transpose() - mechanism.jacobian_rate(q, v) * v)).transpose();
    }
  }
  return joints;
}

}  // namespace mbk::preprocess
