#include "mbk/experiment/session/robot_check.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "mbk/base/config/document.h"
#include "mbk/base/core/units.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/model/robot/workspace.h"
#include "mbk/model/robot_file/planar_keys.h"
#include "mbk/model/robot_file/robot_file.h"

namespace mbk::session {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Verdict = Finding::Verdict;

constexpr double kMillimetre = 1e-3, kMicrometre = 1e-6;
constexpr double kShortestLink = 0.05, kLongestLink = 2.0;   // [m]: a robot for an arm
constexpr double kMinMass = 0.05, kMaxMass = 20.0;           // of the robot at the hand [kg]
constexpr double kFineCount = 100e-6, kCoarseCount = 1e-3;   // at the hand [m]
constexpr double kCoarseForce = 0.05;                        // [N]: a quarter of the published sensor's noise
constexpr double kLongWatchdog = 0.2;                        // [s]
constexpr double kSmallCommand = 1e-3, kLargeCommand = 1e3;  // of the largest torque, in units of command
constexpr double kUnevenGain = 5.0;                          // ratio of a force sensor's axes

class Findings {
 public:
  void add(Verdict verdict, std::string text) { all_.push_back({verdict, std::move(text)}); }
  /// `remedy` is added unless the verdict is fine.
  void judge(Verdict verdict, const std::string& text, const char* remedy) {
    add(verdict, verdict == Verdict::fine ? text : fmt::format("{}; {}", text, remedy));
  }
  [[nodiscard]] std::vector<Finding> take() { return std::move(all_); }

 private:
  std::vector<Finding> all_;
};

Verdict doubtful_unless(bool fine) {
  return fine ? Verdict::fine : Verdict::doubtful;
}

Verdict wrong_unless(bool fine) {
  return fine ? Verdict::fine : Verdict::wrong;
}

double largest_singular_value(const Matrix2d& matrix) {
  return numeric::singular_values(matrix)[0];
}

void check_links(const RobotSetup& setup, Findings& findings) {
  const robot::Geometry& g = setup.trial.robot.geometry;
  const auto in_range = [](double d) { return d >= kShortestLink && d <= kLongestLink; };
  findings.judge(doubtful_unless(in_range(g.d1) && in_range(g.d2)),
                 fmt::format("links of {:.4g} and {:.4g} mm", g.d1 / kMillimetre, g.d2 / kMillimetre),
                 "links of an arm robot are 50 to 2000 mm: check that d1_mm and d2_mm are in millimetres");
}

void check_inertia(const RobotSetup& setup, const Vector2d& theta, Findings& findings) {
  const auto mass = setup.trial.robot.inertia_at_hand(theta);
  if (!mass) {
    findings.add(Verdict::wrong, mass.error().line());
    return;
  }
  const Vector2d eigenvalues = numeric::symmetric_eigenvalues(*mass);
  const std::string text =
      fmt::format("the robot's mass at the hand is {:.3g} to {:.3g} kg", eigenvalues[0], eigenvalues[1]);
  if (eigenvalues[0] <= 0.0) {
    findings.judge(Verdict::wrong, text, "this is physically impossible: check alpha_kg_m2 and its order α₁, α₂, α₃");
  } else {
    findings.judge(doubtful_unless(eigenvalues[0] >= kMinMass && eigenvalues[1] <= kMaxMass), text,
                   "check that alpha_kg_m2 is in kg·m²");
  }
}

/// @returns  the posture in which the robot is checked: home, or the middle of the joints' ranges
std::optional<Vector2d> check_places(const RobotSetup& setup, Findings& findings) {
  const robot::Geometry& g = setup.trial.robot.geometry;
  const auto workspace = robot::workspace(g);
  if (!workspace) {
    findings.add(Verdict::wrong, "no workspace: " + workspace.error().line());
    return std::nullopt;
  }
  findings.judge(doubtful_unless(workspace->area >= 1e-2),
                 fmt::format("the hand reaches {:.0f} cm²", 1e4 * workspace->area),
                 "this is smaller than a palm: check theta1_deg, theta2_deg and smallest_opening_deg");
  if (!setup.has_home) {
    const std::vector<Vector2d> corners = robot::joint_space_corners(g.limits);
    Vector2d middle = Vector2d::Zero();
    for (const Vector2d& corner : corners) middle += corner / static_cast<double>(corners.size());
    return middle;
  }
  const Vector2d& home = setup.trial.home;
  const auto theta = robot::check_hand(g, home);
  if (!theta) {
    findings.add(Verdict::wrong, "home cannot be reached: " + theta.error().line());
    return std::nullopt;
  }
  const double margin = robot::margin(g.limits, *theta);
  const bool inside = (home.array() >= setup.trial.limits.workspace_low.array()).all() &&
                      (home.array() <= setup.trial.limits.workspace_high.array()).all();
  findings.judge(
      wrong_unless(margin > setup.trial.limits.joint_margin && inside),
      fmt::format("home is at {:.1f}, {:.1f} mm, {:.1f}° from the nearest joint limit{}", home[0] / kMillimetre,
                  home[1] / kMillimetre, margin / kDegree, inside ? "" : ", outside the safety workspace"),
      "move home_mm, or check [safety] joint_margin_deg and workspace_low_mm");
  return *theta;
}

void check_encoders(const RobotSetup& setup, const Vector2d& theta, Findings& findings) {
  if (!setup.trial.device.counts) return;
  const device::Wiring& w = setup.trial.device.fittings.wiring;
  const double count =
      largest_singular_value(robot::jacobian(setup.trial.robot.geometry, theta) * w.radians_per_count.asDiagonal());
  findings.judge(count > kCoarseCount ? Verdict::wrong : doubtful_unless(count <= kFineCount),
                 fmt::format("one count of an encoder is at most {:.3g} µm at the hand", count / kMicrometre),
                 "velocities and accelerations will be rough: check counts_per_turn (after the gear, all four edges)");
  const double jump = setup.trial.limits.encoder_jump / w.radians_per_count.cwiseAbs().maxCoeff();
  findings.judge(jump < 2.0 ? Verdict::wrong : doubtful_unless(jump >= 5.0),
                 fmt::format("the gate treats {:.3g} counts within a tick as a jump", jump),
                 "raise [safety] encoder_jump_deg, so that encoder resolution does not trip the gate");
}

void check_force(const RobotSetup& setup, Findings& findings) {
  const drivers::Fittings& f = setup.trial.device.fittings;
  if (!f.has_force) {
    findings.add(Verdict::doubtful, "no force sensor: measure with --force-source virtual");
    return;
  }
  const Vector2d gains = numeric::singular_values(f.wiring.force_gain);
  findings.judge(doubtful_unless(gains[0] <= kUnevenGain * gains[1]),
                 fmt::format("the force sensor gives {:.4g} to {:.4g} N per unit", gains[1], gains[0]),
                 "its axes differ strongly, or are nearly parallel: check force_gain_N_per_unit");
  if (setup.trial.device.force_step) {
    const double step = gains[0] * *setup.trial.device.force_step;
    findings.judge(doubtful_unless(step <= kCoarseForce), fmt::format("its smallest step is {:.3g} mN", 1e3 * step),
                   "this is coarse for an arm's forces: use more of the converter's range");
  }
}

void check_motors(const RobotSetup& setup, const Vector2d& theta, Findings& findings) {
  const device::Wiring& w = setup.trial.device.fittings.wiring;
  const Vector2d most = setup.trial.limits.joint_torque.cwiseQuotient(w.torque_per_command).cwiseAbs();
  findings.judge(doubtful_unless(most.minCoeff() >= kSmallCommand && most.maxCoeff() <= kLargeCommand),
                 fmt::format("the largest torques, {:g} and {:g} N·m, are {:.3g} and {:.3g} units of command",
                             setup.trial.limits.joint_torque[0], setup.trial.limits.joint_torque[1], most[0], most[1]),
                 "check torque_per_command_Nm and gear");
  const Matrix2d J = robot::jacobian(setup.trial.robot.geometry, theta);
  const Vector2d unit = J.transpose().inverse() * Vector2d(w.torque_per_command[0], 0.0);
  findings.add(Verdict::fine,
               fmt::format("one unit of command to motor 1 pushes the hand with {:.3g}, {:.3g} N", unit[0], unit[1]));
}

void check_times(const RobotSetup& setup, Findings& findings) {
  const auto watchdog = [&](double seconds) {
    const double tick = 1.0 / setup.trial.rate.value;
    const std::string text = fmt::format("the robot's watchdog is {:g} ms", 1e3 * seconds);
    if (seconds < 3.0 * tick) {
      findings.judge(Verdict::wrong, text, "it would expire at the first late tick: choose 20 to 100 ms");
    } else {
      findings.judge(doubtful_unless(seconds <= kLongWatchdog), text,
                     "motors that continue this long can injure: choose 20 to 100 ms");
    }
  };
  if (const auto* udp = std::get_if<drivers::UdpOptions>(&setup.trial.device.kind)) watchdog(udp->watchdog);
  if (const auto* plugin = std::get_if<drivers::PluginOptions>(&setup.trial.device.kind)) watchdog(plugin->watchdog);
}

std::string device_text(const protocol::DevicePlan& plan) {
  if (const auto* udp = std::get_if<drivers::UdpOptions>(&plan.kind)) {
    return fmt::format("UDP {}:{}{}", udp->address, udp->port, udp->lock_step ? ", in lock-step" : "");
  }
  if (const auto* plugin = std::get_if<drivers::PluginOptions>(&plan.kind)) {
    return fmt::format("plug-in {}", plugin->library.string());
  }
  return "simulated";
}

std::string frame_text(device::Wiring::Frame frame) {
  return frame == device::Wiring::Frame::base ? "the base" : "the last link";
}

}  // namespace

Result<RobotSetup> read_robot_setup(std::string_view text, const std::filesystem::path& file,
                                    const protocol::ReadSimulation& simulation) {
  const auto document = MBK_TRY(config::Document::parse(text, file.string()));
  const config::Section root = document.root();
  RobotSetup setup;
  setup.has_device = root.has("device");
  if (root.has("control") || root.has("perturbation") || root.has("trial")) {
    auto trials = MBK_TRY(protocol::read_experiment(text, file, simulation));
    setup.trial = std::move(trials.front());
    setup.has_device = setup.has_home = true;
    return setup;
  }
  const config::Section robot = root.section("robot");
  if (robot.text("kind", "planar") != "planar") {
    return tl::unexpected(robot.error("kind", "only planar robots can be driven and checked so far",
                                      "for others, use 'mbk robot describe'"));
  }
  // The whole description is judged by its own reader, which knows every key.
  MBK_TRY(robot_file::parse_robot_description(text, "", file.string()));
  setup.trial.robot = robot_file::read_planar_robot(robot);
  setup.trial.device = protocol::read_device(root.section("device"), file.parent_path());
  root.leave_to_others("robot");
  root.leave_to_others("drive");
  MBK_TRY(document.finish());
  return setup;
}

Finding::Verdict worst(const std::vector<Finding>& findings) {
  Verdict most = Verdict::fine;
  for (const Finding& one : findings) most = std::max(most, one.verdict);
  return most;
}

std::vector<Finding> check_setup(const RobotSetup& setup) {
  Findings findings;
  check_links(setup, findings);
  const auto theta = check_places(setup, findings);
  if (theta) check_inertia(setup, *theta, findings);
  if (auto ok = safety::check(setup.trial.limits); !ok) findings.add(Verdict::wrong, ok.error().line());
  if (setup.trial.device.simulated() || !theta) return findings.take();
  check_encoders(setup, *theta, findings);
  check_force(setup, findings);
  check_motors(setup, *theta, findings);
  check_times(setup, findings);
  if (const std::string assumed = protocol::assumptions_text(setup.trial); !assumed.empty()) {
    findings.judge(Verdict::doubtful, assumed, "write your robot's values");
  }
  for (const std::string& one : safety::weakened(setup.trial.limits)) findings.add(Verdict::doubtful, one);
  return findings.take();
}

std::string setup_text(const RobotSetup& setup) {
  const robot::Geometry& g = setup.trial.robot.geometry;
  const robot::JointLimits& l = g.limits;
  std::string text = fmt::format("robot      d₁ {:.1f} mm, d₂ {:.1f} mm\n", g.d1 / kMillimetre, g.d2 / kMillimetre);
  text += fmt::format("joints     θ₁ {:.1f} to {:.1f}°, θ₂ {:.1f} to {:.1f}°, smallest opening {:.1f}°\n",
                      l.theta1_low / kDegree, l.theta1_high / kDegree, l.theta2_low / kDegree, l.theta2_high / kDegree,
                      l.smallest_opening / kDegree);
  text +=
      "angles     y                x = d₁ cos θ₁ + d₂ sin θ₂\n"
      "           |     o hand     y = d₁ sin θ₁ − d₂ cos θ₂\n"
      "           |    /  d₂: θ₂ from −y\n"
      "           |   o elbow\n"
      "           |  /  d₁: θ₁ from +x\n"
      "           base ---- x\n";
  text += fmt::format("device     {}\n", setup.has_device ? device_text(setup.trial.device) : "none");
  if (!setup.has_device || setup.trial.device.simulated()) return text;
  const drivers::Fittings& f = setup.trial.device.fittings;
  const device::Wiring& w = f.wiring;
  if (setup.trial.device.counts) {
    text += fmt::format("encoders   {:+.6g} and {:+.6g}° per count, θ = 0 at counts {:g} and {:g}\n",
                        w.radians_per_count[0] / kDegree, w.radians_per_count[1] / kDegree, w.count_offset[0],
                        w.count_offset[1]);
  } else {
    text += fmt::format("encoders   angles in rad, signs {:+g} and {:+g}\n", w.radians_per_count[0],
                        w.radians_per_count[1]);
  }
  const auto sensor = [&](const char* name, bool fitted, const char* unit, const Matrix2d& gain, const Vector2d& offset,
                          device::Wiring::Frame frame) {
    text += fitted ? fmt::format("{:<11}[{:g} {:g}; {:g} {:g}] {} per unit, zero at {:g} and {:g}, axes of {}\n", name,
                                 gain(0, 0), gain(0, 1), gain(1, 0), gain(1, 1), unit, offset[0], offset[1],
                                 frame_text(frame))
                   : fmt::format("{:<11}not fitted\n", name);
  };
  sensor("force", f.has_force, "N", w.force_gain, w.force_offset, w.force_frame);
  sensor("accel.", f.has_acceleration, "m/s²", w.acceleration_gain, w.acceleration_offset, w.acceleration_frame);
  if (f.force_latency > 0) text += fmt::format("latency    force and acceleration are {} ticks old\n", f.force_latency);
  text += fmt::format("motors     {:+g} and {:+g} N·m per unit of command\n", w.torque_per_command[0],
                      w.torque_per_command[1]);
  return text;
}

}  // namespace mbk::session
