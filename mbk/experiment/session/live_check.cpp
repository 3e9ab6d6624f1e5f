#include "mbk/experiment/session/live_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/core/units.h"
#include "mbk/base/realtime/clock.h"
#include "mbk/model/robot/workspace.h"

namespace mbk::session {
namespace {

using Eigen::Vector2d;
using Verdict = Finding::Verdict;

constexpr double kMinRate = 0.98;           // of the states that should have come
constexpr double kMuchForce = 2.0;          // at a handle that nobody touches [N]
constexpr double kNoisyForce = 0.5;         // standard deviation [N]
constexpr double kMuchAcceleration = 0.5;   // at rest in a horizontal plane [m/s²]
constexpr double kNoisyAcceleration = 0.5;  // standard deviation [m/s²]

class LiveFindings {
 public:
  void add(bool fine, Verdict otherwise, const std::string& text, const char* remedy) {
    all_.push_back(fine ? Finding{Verdict::fine, text} : Finding{otherwise, fmt::format("{}; {}", text, remedy)});
  }
  [[nodiscard]] std::vector<Finding> take() { return std::move(all_); }

 private:
  std::vector<Finding> all_;
};

/// Signs of a dead sensor.
void check_readings(const char* name, const std::array<Readings, 2>& both, std::uint64_t frozen_after,
                    LiveFindings& findings) {
  for (std::size_t i = 0; i < 2; ++i) {
    const Readings& one = both[i];
    if (one.not_finite > 0) {
      findings.add(false, Verdict::wrong, fmt::format("{} {} was non-finite {} times", name, i + 1, one.not_finite),
                   "check what the robot's program sends");
    }
    if (one.longest_still > frozen_after) {
      findings.add(false, Verdict::doubtful,
                   fmt::format("{} {} was constant for {} samples", name, i + 1, one.longest_still),
                   "a working sensor has noise: check its connection, and whether it is read");
    }
  }
}

}  // namespace

void Readings::add(double value) noexcept {
  if (!std::isfinite(value)) {
    ++not_finite;
    return;
  }
  if (count == 0) {
    low = high = value;
  } else {
    still_ = value == last_ ? still_ + 1 : 0;
    longest_still = std::max(longest_still, still_);
    step_squares_ += (value - last_) * (value - last_);
    step = std::sqrt(step_squares_ / static_cast<double>(count));
  }
  ++count;
  low = std::min(low, value);
  high = std::max(high, value);
  // Welford 1962: the mean and the sum of squares about it, sample by sample.
  const double from_mean = value - mean;
  mean += from_mean / static_cast<double>(count);
  squares_ += from_mean * (value - mean);
  deviation = count > 1 ? std::sqrt(squares_ / static_cast<double>(count - 1)) : 0.0;
  last_ = value;
}

Result<LiveRecord> watch_robot(device::Device& robot, Hertz rate, double seconds) {
  MBK_TRY(robot.start());
  LiveRecord record;
  realtime::WallClock clock(1.0 / rate.value);
  clock.start();
  device::State state;
  std::uint64_t last_sequence = 0, gap = 0;
  double last_time = 0.0;
  const auto ticks = static_cast<std::uint64_t>(std::ceil(seconds * rate.value));
  for (; record.ticks < ticks && record.link; ++record.ticks) {
    clock.wait();
    record.link = robot.read(state);
    robot.write({record.ticks, {0.0, 0.0}, false});
    gap = state.sequence == last_sequence ? gap + 1 : 0;
    record.longest_gap = std::max(record.longest_gap, gap);
    if (gap > 0) continue;
    if (record.fresh > 0) {
      record.lost += state.sequence - last_sequence - 1;
      record.backward += state.time > last_time ? 0 : 1;
    }
    ++record.fresh;
    last_sequence = state.sequence;
    last_time = state.time;
    record.stop_released = record.stop_released || (record.stop_pressed && !state.stop);
    record.stop_pressed = record.stop_pressed || state.stop;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      record.joint[i].add(state.joint[k]);
      record.force[i].add(state.force[k]);
      record.acceleration[i].add(state.acceleration[k]);
    }
  }
  record.duration = clock.now();
  record.missed = clock.missed();
  record.last = state;
  robot.stop();
  return record;
}

std::vector<Finding> check_live(const RobotSetup& setup, const device::Facts& facts, const LiveRecord& record) {
  LiveFindings findings;
  findings.add(
      record.link, Verdict::wrong,
      record.link ? "the link worked throughout" : fmt::format("the link failed after {:.2f} s", record.duration),
      "check the robot's program and its watchdog");
  const std::uint64_t missed = facts.keeps_time ? record.missed : 0;
  if (missed > 0) {
    findings.add(false, Verdict::doubtful, fmt::format("this computer was late and missed {} ticks", missed),
                 "this is not the robot's fault: end other programs, or use a real-time kernel");
  }
  const double share = static_cast<double>(record.fresh + record.lost) / static_cast<double>(record.ticks + missed);
  findings.add(share >= kMinRate && share <= 2.0 - kMinRate, Verdict::wrong,
               fmt::format("the robot sent {:.1f} states per second, for {:g} ticks of mbk",
                           share * setup.trial.rate.value, setup.trial.rate.value),
               "both must run at the same rate: check rate_hz and the robot's clock");
  const double silence = static_cast<double>(record.longest_gap) / setup.trial.rate.value;
  findings.add(silence <= setup.trial.limits.link_silence, Verdict::wrong,
               fmt::format("the longest silence was {:.0f} ms", 1e3 * silence),
               "the gate would stop: check network, load and [safety] link_silence_ms");
  findings.add(
      (record.lost - std::min(record.lost, missed)) * 1000 <= record.fresh, Verdict::doubtful,
      fmt::format("{} of {} states were lost or shared a tick with another", record.lost, record.fresh + record.lost),
      "use a separate cable and a real-time kernel");
  findings.add(record.backward == 0, Verdict::wrong,
               fmt::format("the robot's clock stopped or went backwards {} times", record.backward),
               "the robot must send the time of each sample");
  findings.add(!record.last.stop, Verdict::wrong,
               record.stop_released ? "the stop button was pressed and released"
               : record.stop_pressed
                   ? "the stop button is pressed"
                   : "the stop button is not pressed; press and release it during the check to test it",
               "release it");
  const auto frozen =
      static_cast<std::uint64_t>(std::max(0.25, setup.trial.limits.frozen_sensor) * setup.trial.rate.value);
  const Vector2d theta(record.joint[0].mean, record.joint[1].mean);
  if (auto ok = robot::check_joints(setup.trial.robot.geometry.limits, theta); !ok) {
    findings.add(false, Verdict::wrong, ok.error().line(),
                 "check encoder_sign, count_offset and counts_per_turn, or move the robot");
  }
  check_readings("joint", record.joint, record.ticks, findings);
  const double jump = std::max(record.joint[0].step, record.joint[1].step);
  findings.add(jump <= 0.1 * setup.trial.limits.encoder_jump, Verdict::doubtful,
               fmt::format("the angles step by {:.3g}° from sample to sample", jump / kDegree),
               "the encoders are noisy, or the robot was moved fast");
  const auto sensor = [&](const char* name, const char* unit, const std::array<Readings, 2>& both, double much,
                          double noisy, const char* offset_key) {
    check_readings(name, both, frozen, findings);
    const double mean = std::hypot(both[0].mean, both[1].mean);
    findings.add(mean <= much, Verdict::doubtful, fmt::format("{} is {:.3g} {} on average", name, mean, unit),
                 offset_key);
    const double deviation = std::max(both[0].deviation, both[1].deviation);
    findings.add(deviation <= noisy, Verdict::doubtful, fmt::format("{} varies by {:.3g} {}", name, deviation, unit),
                 "check shielding and ground, and let nobody touch the handle meanwhile");
  };
  if (facts.has_force) {
    sensor("force", "N", record.force, kMuchForce, kNoisyForce,
           "with nobody at the handle it should be near 0: check force_offset");
  }
  if (facts.has_acceleration) {
    sensor("acceleration", "m/s²", record.acceleration, kMuchAcceleration, kNoisyAcceleration,
           "at rest it should be near 0: check acceleration_offset");
  }
  return findings.take();
}

std::string live_text(const RobotSetup& setup, const device::Facts& facts, const LiveRecord& record) {
  std::string text = fmt::format("{} for {:.2f} s, motors off\n", facts.name, record.duration);
  text += fmt::format("  {:<16}{:>11}{:>11}{:>11}{:>13}\n", "", "mean", "lowest", "highest", "deviation");
  const auto add = [&](const char* name, const char* unit, const std::array<Readings, 2>& both, double scale) {
    for (std::size_t i = 0; i < 2; ++i) {
      const Readings& one = both[i];
      text += fmt::format("  {:<16}{:>11.4f}{:>11.4f}{:>11.4f}{:>13.3g}  {}\n", fmt::format("{} {}", name, i + 1),
                          scale * one.mean, scale * one.low, scale * one.high, scale * one.deviation, unit);
    }
  };
  add("joint", "°", record.joint, 1.0 / kDegree);
  if (facts.has_force) add("force", "N", record.force, 1.0);
  if (facts.has_acceleration) add("acceleration", "m/s²", record.acceleration, 1.0);
  const Vector2d hand =
      robot::hand_position(setup.trial.robot.geometry, Vector2d(record.joint[0].mean, record.joint[1].mean));
  text += fmt::format("  hand at {:.1f}, {:.1f} mm: check with a ruler\n", 1e3 * hand[0], 1e3 * hand[1]);
  text +=
      "  test by hand: run this again and push the handle along +x of your robot, then along +y: x and y must grow\n";
  return text;
}

}  // namespace mbk::session
