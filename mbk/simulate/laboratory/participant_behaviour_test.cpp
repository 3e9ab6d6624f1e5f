#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "mbk/experiment/control/laws.h"
#include "mbk/model/perturbation/multisine.h"
#include "mbk/model/perturbation/underdamped_pulse.h"
#include "mbk/simulate/laboratory/closed_loop.h"
#include "mbk/simulate/participant/arm.h"

/// Does the simulated arm generate and absorb energy where people do (Dyck 2013, figs. 4.3–4.5)? One class of arm, in
/// two states (relaxed, rigid), meets perturbations of different kind and size; nothing in it knows which. Its numbers
/// were tuned, not fitted, so this shows that the mechanism suffices, not that people work so.
namespace mbk::laboratory {
namespace participant_behaviour_test {

using participant::ArmOptions;

constexpr double kTick = 1e-3;
constexpr double kHandleMass = 0.194;  // [kg]
constexpr double kDryFriction = 0.45;  // at the hand [N]
constexpr double kQuiet = 16.0;        // before the first pulse [s]
constexpr int kSeeds = 4;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Vector2d kHome(0.30, -0.05);

/// The first is the default arm; the others are participants 3 and 5, of medium and of high stiffness.
ArmOptions with_limb(ArmOptions options, int arm) {
  constexpr std::array<int, 3> kParticipant = {0, 3, 5};
  const int number = kParticipant[static_cast<std::size_t>(arm)];
  if (number > 0) options.limb = participant::participant_limb(number).value();
  return options;
}

/// What the motors do at a time, given the loop.
using Drive = std::function<Vector2d(const ClosedLoop<2>&, double)>;

/// E, the energy that the arm has absorbed at the end of a trial: what passed the sensor less what the handle keeps
/// [J].
double energy_absorbed(const ArmOptions& options, double dry_friction, double duration, const Drive& drive) {
  participant::Arm arm = participant::Arm::create(options, kTick).value();
  ClosedLoop<2>::Options loop_options;
  loop_options.handle_mass = kHandleMass;
  for (robot::JointFriction& joint : loop_options.robot.friction) {
    joint.coulomb = dry_friction * loop_options.robot.geometry.d1;
  }
  ClosedLoop<2> loop = ClosedLoop<2>::create(loop_options, kHome, arm).value();
  TrueState<2> last;
  for (int i = 0; i * kTick < duration; ++i) {
    last = loop.hold(drive(loop, i * kTick), kTick);
    loop.advance();
  }
  return last.energy.absorbed - 0.5 * kHandleMass * last.velocity.squaredNorm();
}

perturbation::PulseSchedule pulse_schedule(double amplitude, std::uint64_t seed) {
  perturbation::PulseSchedule::Options options;
  options.amplitude = amplitude;
  options.seed = seed;
  options.quiet = kQuiet;
  return perturbation::PulseSchedule::create(options).value();
}

double duration_of(const perturbation::PulseSchedule& pulses) {
  return pulses.pulses().back().offset + 3.0;
}

/// Two signals of ten lines, 0.3 to 3 Hz, each with the given peak.
std::array<perturbation::Multisine, 2> ten_lines(double peak, std::uint64_t seed) {
  const double period = 10.0;
  const std::vector<int> harmonics = {3, 6, 9, 12, 15, 18, 21, 24, 27, 30};
  const auto one = [&](std::uint32_t stream) {
    const auto flat =
        perturbation::Multisine::with_random_phases(period, harmonics, std::vector<double>(10, 1.0), seed, stream)
            .value();
    double largest = 0.0;
    for (double t = 0.0; t < period; t += 0.002) largest = std::max(largest, std::abs(flat.at(t).value));
    return flat.scaled(peak / largest);
  };
  return {one(10), one(11)};
}

double force_pulses(const ArmOptions& options, double amplitude, std::uint64_t seed, double friction = kDryFriction) {
  const auto pulses = pulse_schedule(amplitude, seed);
  const control::ForceControl force{robot::Geometry{}};
  return energy_absorbed(options, friction, duration_of(pulses), [&](const ClosedLoop<2>& loop, double t) {
    return force.step(loop.motor_angle(), pulses.at(t).value);
  });
}

double force_multisine(const ArmOptions& options, double peak, std::uint64_t seed) {
  const auto lines = ten_lines(peak, seed);
  const control::ForceControl force{robot::Geometry{}};
  return energy_absorbed(options, kDryFriction, 50.0, [&](const ClosedLoop<2>& loop, double t) {
    return force.step(loop.motor_angle(), {lines[0].at(t).value, lines[1].at(t).value});
  });
}

double position_multisine(const ArmOptions& options, std::uint64_t seed) {
  const auto lines = ten_lines(2.0 * std::numbers::pi / 180.0, seed);  // a range of 4° at each joint
  auto position = control::JointPositionControl::create({}, kTick).value();
  const Vector2d home = robot::joint_angles({}, kHome).value();
  return energy_absorbed(options, kDryFriction, 50.0, [&](const ClosedLoop<2>& loop, double t) {
    const auto first = lines[0].at(t), second = lines[1].at(t);
    return position.step(loop.motor_angle(), home + Vector2d(first.value, second.value), {first.first, second.first});
  });
}

double position_pulses(const ArmOptions& options, std::uint64_t seed) {
  const auto pulses = pulse_schedule(0.005, seed);
  auto position = control::JointPositionControl::create({}, kTick).value();
  return energy_absorbed(options, kDryFriction, duration_of(pulses), [&](const ClosedLoop<2>& loop, double t) {
    const auto pulse = pulses.at(t);
    const Vector2d theta = robot::joint_angles({}, kHome + pulse.value).value();
    return position.step(loop.motor_angle(), theta, robot::jacobian({}, theta).inverse() * pulse.first);
  });
}

struct Energies {
  double mean = 0.0, smallest = kInfinity, largest = -kInfinity;
};

/// Over the seeds, each of which is another person's noise and another perturbation. Prints its row of the table.
Energies over_seeds(const std::string& name, int arm, const ArmOptions& options,
                    const std::function<double(const ArmOptions&, std::uint64_t)>& trial) {
  Energies energies;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    ArmOptions seeded = with_limb(options, arm);
    seeded.seed = 100 + seed;
    const double energy = trial(seeded, seed);
    energies.mean += energy / kSeeds;
    energies.smallest = std::min(energies.smallest, energy);
    energies.largest = std::max(energies.largest, energy);
  }
  fmt::print("arm {}  {:34} E {:6.2f} J  [{:6.2f}, {:6.2f}]\n", arm, name, energies.mean, energies.smallest,
             energies.largest);
  return energies;
}

class ArmBehaviour : public testing::TestWithParam<int> {
 protected:
  Energies pulses(const std::string& name, double amplitude, const ArmOptions& options,
                  double friction = kDryFriction) const {
    return over_seeds(name, GetParam(), options, [&](const ArmOptions& arm, std::uint64_t seed) {
      return force_pulses(arm, amplitude, seed, friction);
    });
  }
  const ArmOptions relaxed = participant::relaxed_arm_options(), rigid = participant::rigid_arm_options();
};

TEST_P(ArmBehaviour, RelaxedArmAbsorbsEnergy) {
  EXPECT_GT(over_seeds("relaxed, multisine of 4 degrees", GetParam(), relaxed, position_multisine).smallest, 0.0);
  EXPECT_GT(over_seeds("relaxed, 5 mm pulses", GetParam(), relaxed, position_pulses).smallest, 0.0);
}

TEST_P(ArmBehaviour, RigidArmGeneratesEnergyUnderSmallPulsesAndAbsorbsItUnderLarge) {
  Energies last;
  double below = 0.0, crossover = std::numeric_limits<double>::quiet_NaN();
  for (const double amplitude : {2.0, 3.0, 4.0, 5.0, 8.0}) {
    const Energies now = pulses(fmt::format("rigid, {} N pulses", amplitude), amplitude, rigid);
    if (amplitude == 2.0) {
      EXPECT_LT(now.largest, 0.0);
    }
    if (last.mean < 0.0 && now.mean >= 0.0) {
      crossover = below + (amplitude - below) * last.mean / (last.mean - now.mean);
    }
    below = amplitude;
    last = now;
  }
  EXPECT_GT(last.smallest, 0.0);
  fmt::print("arm {}  crossover at {:.1f} N\n", GetParam(), crossover);
  EXPECT_GT(crossover, 3.0);
  EXPECT_LT(crossover, 5.0);
}

TEST_P(ArmBehaviour, RigidArmAbsorbsEnergyInAMultisine) {
  const auto trial = [](const ArmOptions& arm, std::uint64_t seed) { return force_multisine(arm, 6.0, seed); };
  EXPECT_GT(over_seeds("rigid, 6 N multisine", GetParam(), rigid, trial).smallest, 0.0);
}

TEST_P(ArmBehaviour, OnlyTheControllerGenerates) {
  ArmOptions off = rigid;
  off.controller.position_gain = 0.0;
  EXPECT_GT(pulses("2 N pulses, controller off", 2.0, off).smallest, 0.0);
}

TEST_P(ArmBehaviour, ALaterAnswerGeneratesMore) {
  ArmOptions early = rigid, late = rigid;
  early.controller.delay = 0.05;
  late.controller.delay = 0.25;
  EXPECT_GT(pulses("2 N pulses, delay 0.05 s", 2.0, early).mean,
            pulses("2 N pulses, delay 0.25 s", 2.0, late).mean + 0.1);
}

TEST_P(ArmBehaviour, DryFrictionOfTheRobotTurnsTheSignOfTheEnergy) {
  EXPECT_GT(pulses("2 N pulses, no dry friction", 2.0, rigid, 0.0).smallest, 0.0);
  EXPECT_LT(pulses("2 N pulses, dry friction 0.6 N", 2.0, rigid, 0.6).largest, 0.0);
}

INSTANTIATE_TEST_SUITE_P(ThreeArms, ArmBehaviour, testing::Values(0, 1, 2));

}  // namespace participant_behaviour_test
}  // namespace mbk::laboratory
