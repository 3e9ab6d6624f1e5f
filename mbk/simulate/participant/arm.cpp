#include "mbk/simulate/participant/arm.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/option_limits.h"

namespace mbk::participant {
namespace {

constexpr std::uint32_t kControllerStream = 1, kRemnantStream = 2, kDeparturesStream = 3, kReachingStream = 4;

/// Symmetric parts [xx, yy, xy] of a hand impedance.
struct HandImpedance {
  std::array<double, 3> M, B, K;
};

/// From area and shape of the published ellipses (Dyck 2013, tables 3.3 and 3.5): λmax = √(A R/π), λmin = √(A/(πR)).
constexpr std::array<HandImpedance, 6> kParticipants = {{
    {{1.326, 1.883, -0.935}, {5.76, 10.56, -2.14}, {42.4, 125.3, -28.6}},
    {{1.301, 1.357, -0.807}, {5.78, 9.10, -2.57}, {45.2, 112.1, -34.2}},
    {{1.536, 1.717, -0.958}, {6.01, 10.48, -3.34}, {39.5, 108.3, -28.0}},
    {{1.419, 1.885, -1.025}, {4.75, 9.56, -3.17}, {36.6, 151.6, -43.3}},
    {{1.275, 2.082, -0.951}, {4.80, 11.95, -2.54}, {39.0, 165.1, -28.3}},
    {{1.105, 1.659, -0.770}, {3.16, 8.21, -1.31}, {22.7, 93.4, -23.7}},
}};

Matrix symmetric(const std::array<double, 3>& parts) {
  return (Matrix2d() << parts[0], parts[2], parts[2], parts[1]).finished();
}

/// Where the limb rests.
Vector2d rest_of(const ArmOptions& options) {
  struct Rest {
    Vector2d operator()(const TwoLinkArm::Options& arm) const { return arm.equilibrium; }
    Vector2d operator()(const impedance::Model& limb) const { return limb.x0; }
  };
  return std::visit(Rest{}, options.limb);
}

/// Whether two links can take the hand to its target, with a twentieth of their length to spare for reaches that go
/// farther.
Result<void> check_target(const ArmOptions& options) {
  const auto* arm = std::get_if<TwoLinkArm::Options>(&options.limb);
  if (arm == nullptr) return {};
  const Vector2d target = options.reaching->start + options.reaching->reach;
  const double length = arm->geometry.upper_arm + arm->geometry.forearm;
  const double distance = (target - arm->geometry.shoulder).norm();
  if (distance <= 0.95 * length) return {};
  return bad_usage(fmt::format("the target of the reach is {:.3g} m from the shoulder, but the arm is {:.3g} m long",
                               distance, length),
                   "move the shoulder, or shorten the reach");
}

}  // namespace

ArmOptions relaxed_arm_options() {
  ArmOptions options;
  options.remnant.floor = 0.10;
  return options;
}

ArmOptions rigid_arm_options() {
  ArmOptions options;
  options.controller.position_gain = 1.4;
  options.cocontraction.rest = 0.4;
  options.cocontraction.slope = 0.6;
  return options;
}

Result<TwoLinkArm::Options> participant_limb(int participant) {
  if (participant < 1 || participant > 6) {
    return bad_usage(fmt::format("participant {} does not exist; choose 1 to 6", participant));
  }
  const HandImpedance& hand = kParticipants[static_cast<std::size_t>(participant - 1)];
  TwoLinkArm::Options options;
  const auto joints = MBK_TRY(joint_parameters(
      options.geometry, {symmetric(hand.M), symmetric(hand.B), symmetric(hand.K), options.equilibrium}));
  options.joints = joints;
  return options;
}

Result<ArmOptions> participant_options(int participant) {
  const auto limb = MBK_TRY(participant_limb(participant));
  ArmOptions options = relaxed_arm_options();
  options.limb = limb;
  return options;
}

Result<Arm> Arm::create(const ArmOptions& options, double sample_time) {
  struct CreateLimb {
    Result<Limb> operator()(const TwoLinkArm::Options& arm) const { return TwoLinkArm::create(arm).map(as_limb); }
    Result<Limb> operator()(const impedance::Model& model) const { return LinearLimb::create(model).map(as_limb); }
    static Limb as_limb(const Limb& limb) { return limb; }
  };
  auto limb = MBK_TRY(std::visit(CreateLimb{}, options.limb));
  auto controller =
      MBK_TRY(IntermittentController::create(options.controller, sample_time, options.seed, kControllerStream));
  const auto cocontraction = MBK_TRY(Cocontraction::create(options.cocontraction, sample_time));
  const auto remnant = MBK_TRY(Remnant<2>::create(options.remnant, sample_time, options.seed, kRemnantStream));
  for (std::size_t k = 0; k < options.stiffness_schedule.size(); ++k) {
    const auto& [time, factor, damping_factor] = options.stiffness_schedule[k];
    if (auto ok =
            not_negative({{"factor of the stiffness", factor, ""}, {"factor of the damping", damping_factor, ""}});
        !ok) {
      return tl::unexpected(ok.error());
    }
    if (!std::isfinite(time) || (k > 0 && !(time > options.stiffness_schedule[k - 1].time))) {
      return bad_usage("the times of a stiffness schedule do not increase");
    }
  }
  std::optional<Departures> departures;
  if (options.departures) {
    departures = MBK_TRY(
        Departures::create(*options.departures, rest_of(options), sample_time, options.seed, kDeparturesStream));
  }
  std::optional<Reaching> reaching;
  if (options.reaching) {
    if (options.controller.position_gain > 0.0 || options.departures) {
      return bad_usage("an arm that reaches cannot also hold a position or have departures about one",
                       "remove correction.position_gain and departures");
    }
    MBK_TRY(check_target(options));
    reaching = MBK_TRY(Reaching::create(*options.reaching, options.seed, kReachingStream));
  }
  return Arm(std::move(limb), std::move(controller), cocontraction, remnant, std::move(departures), std::move(reaching),
             options.stiffness_schedule);
}

Arm::Arm(Limb limb, IntermittentController controller, const Cocontraction& cocontraction, const Remnant<2>& remnant,
         std::optional<Departures> departures, std::optional<Reaching> reaching, std::vector<StiffnessAt> schedule)
    : limb_(std::move(limb)),
      controller_(std::move(controller)),
      cocontraction_(cocontraction),
      remnant_(remnant),
      departures_(std::move(departures)),
      reaching_(std::move(reaching)),
      schedule_(std::move(schedule)) {
  tense(0.0);
  reach(0.0);
}

double Arm::scheduled(double t, double StiffnessAt::*factor) const {
  if (schedule_.empty()) return 1.0;
  const auto after = std::ranges::upper_bound(schedule_, t, {}, &StiffnessAt::time);
  if (after == schedule_.begin()) return *after.*factor;
  const StiffnessAt& before = *std::prev(after);
  if (after == schedule_.end()) return before.*factor;
  return before.*factor + (t - before.time) / (after->time - before.time) * (*after.*factor - before.*factor);
}

void Arm::tense(double t) {
  const double stiffness = cocontraction_.stiffness_scale() * scheduled(t, &StiffnessAt::factor),
               damping = cocontraction_.damping_scale() * scheduled(t, &StiffnessAt::damping_factor);
  std::visit([&](auto& limb) { limb.scale(stiffness, damping); }, limb_);
}

void Arm::reach(double t) {
  if (!reaching_) return;
  const perturbation::Jet<Vector2d> meant = reaching_->at(t);
  const LoadDynamics<2> there = std::visit(
      [&](auto& limb) {
        limb.rest_at(meant.value);
        return limb.dynamics({meant.value, meant.first, 0.0, 0.0});
      },
      limb_);
  drive_ = there.inertia * meant.second + there.bias + reaching_->options().carried_mass * meant.second;
}

void Arm::tick(double t, double /*sample_time*/, const HandState<2>& hand, const Vector2d& force_on_robot) {
  cocontraction_.step(hand.velocity.norm());
  tense(t);
  reach(t);
  Matrix2d K = Matrix2d::Constant(kNaN);  // where it is not used
  if (controller_.is_to_decide() || departures_) {
    K = std::visit([&](const auto& limb) { return limb.stiffness(hand.position); }, limb_);
  }
  const Vector2d& voluntary = controller_.step(hand.position, force_on_robot, K, cocontraction_.voluntary_weight());
  noise_ = remnant_.step(voluntary.norm());
  if (departures_) departures_->step(t, hand.position, K);
}

LoadDynamics<2> Arm::dynamics(const HandState<2>& hand) const {
  LoadDynamics<2> dynamics = std::visit([&](const auto& limb) { return limb.dynamics(hand); }, limb_);
  dynamics.bias -= controller_.force() + noise_ + drive_;
  if (departures_) dynamics.bias += departures_->force(hand);
  return dynamics;
}

impedance::Model Arm::impedance(const Vector2d& hand) const {
  return std::visit([&](const auto& limb) { return limb.impedance(hand); }, limb_);
}

}  // namespace mbk::participant
