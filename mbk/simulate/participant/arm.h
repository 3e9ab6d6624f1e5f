#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "mbk/simulate/participant/cocontraction.h"
#include "mbk/simulate/participant/departures.h"
#include "mbk/simulate/participant/intermittent_controller.h"
#include "mbk/simulate/participant/linear_limb.h"
#include "mbk/simulate/participant/reaching.h"
#include "mbk/simulate/participant/remnant.h"
#include "mbk/simulate/participant/two_link_arm.h"

namespace mbk::participant {

/// Scale factors of the limb's stiffness and damping from this time; constant before the first and after the last,
/// interpolated linearly between.
struct StiffnessAt {
  double time = 0.0;            ///< [s]
  double factor = 1.0;          ///< of the stiffness, ≥ 0
  double damping_factor = 1.0;  ///< ≥ 0
};

/// All parameters of a simulated arm. A relaxed and a rigid arm differ only in these numbers.
struct ArmOptions {
  std::variant<TwoLinkArm::Options, impedance::Model> limb;  ///< two links, or a constant impedance
  IntermittentController::Options controller;
  Cocontraction::Options cocontraction;
  Remnant<2>::Options remnant;
  std::vector<StiffnessAt> stiffness_schedule;    ///< in order of time; empty: constant
  std::optional<Departures::Options> departures;  ///< limb forces other than M, B and K
  std::optional<Reaching::Options>
      reaching;            ///< reaching movements; absent: the hand stays at the limb's rest position
  std::uint64_t seed = 1;  ///< of the controller's errors, the remnant, a tremor and the reaches
};

/// A relaxed arm: no voluntary force, no co-contraction, a little noise.
[[nodiscard]] ArmOptions relaxed_arm_options();

/// An arm that holds its hand in place "as quickly as possible" (Dyck 2013, §4.1): co-contracted, with an intermittent
/// controller of gain 1.4. Its numbers were tuned, not fitted, so that the same arm generates energy when 2 N pulses
/// shake it and absorbs energy at 8 N and in a 6 N multisine, as in figs. 4.3–4.5.
[[nodiscard]] ArmOptions rigid_arm_options();

/// The passive arm of one of the six participants of Dyck (2013), relaxed: joint matrices from tables 3.3 and 3.5 as
/// rebuilt (symmetric parts), links of 0.31 and 0.34 m, the hand 0.52 m ahead of the shoulder. The inertias of the
/// second and the third are not possible for such a chain with a straight elbow, so keep these two near that posture.
/// @param participant  1 … 6
/// @fails  usage: another number.
[[nodiscard]] Result<TwoLinkArm::Options> participant_limb(int participant);

/// `relaxed_arm_options` with the limb of a participant.
/// @fails  as participant_limb
[[nodiscard]] Result<ArmOptions> participant_options(int participant);

/// A person's arm: a passive limb and the person's own forces,
///   F_h = passive limb (stiffness and damping scaled by co-contraction) − departures + F_v + n
/// F_v of an intermittent controller, n a remnant. All three are decided once a tick and held over it. A reaching arm
/// moves the limb's equilibrium along x_d(t) of Reaching and also exerts, independent of the actual motion, the
/// feedforward force for limb and robot,
///   F_d = Λ(x_d) ẍ_d + h(x_d, ẋ_d) + m_c ẍ_d
/// so that F_h = −[Λ (ẍ − ẍ_d) + D (ẋ − ẋ_d) + K (x − x_d)] + m_c ẍ_d + n of a linear limb, m_c the carried mass.
class Arm : public Load<2> {
 public:
  /// @param sample_time  T [s] of the ticks that will follow
  /// @fails  usage: a reaching arm has position correction or departures, which refer to a rest position; as the
  ///         parts.
  [[nodiscard]] static Result<Arm> create(const ArmOptions& options, double sample_time);

  void tick(double t, double sample_time, const HandState<2>& hand, const Vector2d& force_on_robot) override;
  [[nodiscard]] LoadDynamics<2> dynamics(const HandState<2>& hand) const override;

  /// Of the limb, with the co-contraction of the last tick.
  [[nodiscard]] impedance::Model impedance(const Vector2d& hand) const override;

  [[nodiscard]] const Vector2d& voluntary_force() const { return controller_.force(); }  ///< F_v [N]
  [[nodiscard]] const Vector2d& remnant() const { return noise_; }                       ///< n [N]
  [[nodiscard]] double cocontraction() const { return cocontraction_.level(); }          ///< 0 … 1

 private:
  using Limb = std::variant<TwoLinkArm, LinearLimb>;
  Arm(Limb limb, IntermittentController controller, const Cocontraction& cocontraction, const Remnant<2>& remnant,
      std::optional<Departures> departures, std::optional<Reaching> reaching, std::vector<StiffnessAt> schedule);
  void reach(double t);
  void tense(double t);
  [[nodiscard]] double scheduled(double t, double StiffnessAt::*factor) const;

  Limb limb_;
  IntermittentController controller_;
  Cocontraction cocontraction_;
  Remnant<2> remnant_;
  std::optional<Departures> departures_;
  std::optional<Reaching> reaching_;
  std::vector<StiffnessAt> schedule_;
  Vector2d drive_ = {0.0, 0.0};  // F_d
  Vector2d noise_ = {0.0, 0.0};
};

}  // namespace mbk::participant
