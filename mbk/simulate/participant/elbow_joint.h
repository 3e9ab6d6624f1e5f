#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/numeric/random.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/perturbation/jet.h"

namespace mbk::participant {

/// Activity of a muscle at a fixed time after the start of a fast stretch, such as the short- and long-latency
/// responses. The start is the first sample at which the muscle lengthens.
struct StretchResponse {
  double latency = 0.025;        ///< from the start of the stretch to the activity [s] ≥ 0, rounded to whole samples
  double duration = 0.025;       ///< of the activity, constant in between [s] > 0, rounded likewise
  double activation = 0.1;       ///< its size, as a share of maximal activation, ≥ 0
  double spread = 0.0;           ///< standard deviation of the size over stretches, as a share of it, ≥ 0
  double trigger_speed = 0.349;  ///< slower stretches have no response [rad/s] > 0; reached within the latency
};

/// A muscle whose activation is a share of its maximum, from 0 to 1:
///   a = a₀ + G/T max(0, u (θ + μ θ̇ − λ)) + responses, at most 1,
/// with angle and velocity of the joint a latency ago and u = 1 for the flexor, −1 for the extensor, which shortens
/// when the angle increases. The dynamic threshold of its stretch reflex is thus the angle λ* = λ − μ θ̇
/// (Feldman 1986, J Mot Behav 18:17; Levin & Feldman 1994, Brain Res 657:29).
struct StretchedMuscle {
  double largest_torque = 60.0;     ///< T at maximal activation [N·m] > 0
  double background = 0.0;          ///< a₀, from 0 to 1
  std::optional<double> threshold;  ///< λ, tonic stretch reflex threshold [rad]; absent: no such reflex
  double threshold_spread = 0.0;    ///< standard deviation of λ over stretches [rad] ≥ 0
  double velocity_gain = 0.05;      ///< μ [s] ≥ 0
  double gain = 0.0;                ///< G, torque per angle beyond the threshold [N·m/rad] ≥ 0
  double latency = 0.03;            ///< from the stretch to the activity [s] ≥ 0, rounded to whole samples
  std::vector<StretchResponse> responses;
};

/// An elbow that follows a motion exactly, with flexors and extensors. θ is the angle of the joint, which increases
/// with extension. The torque of the limb on the machine is
///   τ = −(I θ̈ + B θ̇ + K (θ − θ₀)) + W cos(θ − θ_h) − T_f A_f + T_e A_e
/// A is the activation after the electromechanical delay and two first-order lags of equal time constant. Muscles are
/// linear: their torque does not depend on length or velocity, other than by I, B, K and the reflex.
class ElbowJoint {
 public:
  enum Muscle : std::size_t { flexor, extensor };

  struct Options {
    double inertia = 0.076;            ///< I [kg·m²] > 0: forearm and hand of 73 kg (de Leva 1996, table 4, men)
    double viscosity = 0.1;            ///< B [N·m·s/rad] ≥ 0
    double stiffness = 1.0;            ///< K [N·m/rad] ≥ 0
    double rest = 1.5707963267948966;  ///< θ₀ [rad]
    double weight = 0.0;  ///< W, moment of the weight when the forearm is horizontal [N·m] ≥ 0; in a horizontal
                          ///< plane 0, otherwise 2.9 for the same forearm
    double horizontal = 1.5707963267948966;  ///< θ_h: angle at which the forearm is horizontal [rad]
    double electromechanical_delay = 0.03;   ///< [s] ≥ 0, rounded to whole samples
    double activation_time = 0.03;           ///< time constant of each lag [s] > 0
    std::array<StretchedMuscle, 2> muscles;
    std::uint64_t seed = 1;  ///< of differences between stretches
  };

  struct Output {
    double torque = 0.0;               ///< τ [N·m]
    std::array<double, 2> activation;  ///< a of flexor and extensor, as it is in the EMG
  };

  /// @param home  angle at which the joint has been at rest [rad]    @param sample_time  [s] > 0
  /// @fails  usage: a limit stated in the options is violated; a value is not finite.
  [[nodiscard]] static Result<ElbowJoint> create(const Options& options, double home, double sample_time);

  /// The next sample; angle, velocity and acceleration of the joint [rad].
  Output step(const perturbation::Jet<double>& joint);

  /// I, B, K and θ₀, without reflexes.
  [[nodiscard]] impedance::Model impedance() const;

 private:
  /// Values some samples ago.
  class Delay {
   public:
    Delay(double time, double sample_time, double value);
    double step(double value);

   private:
    std::vector<double> values_;
    std::size_t next_ = 0;
  };

  struct Burst {
    std::int64_t from = 0, to = 0;  // [samples]
    double activation = 0.0;
    bool pending = false;  // in this stretch
  };

  /// One muscle and what it remembers.
  struct State {
    State(const StretchedMuscle& options, const Options& elbow, double direction, double home, double sample_time,
          numeric::Random draws);

    double activation(const perturbation::Jet<double>& joint, std::int64_t sample, double sample_time);
    double torque(double activation);

    StretchedMuscle muscle;
    double direction, memory;  // u; of a lag over one sample
    numeric::Random random;
    Delay reflex;  // how far beyond the threshold
    std::vector<Burst> bursts;
    double threshold_shift = 0.0;
    bool lengthening = false;
    std::int64_t started = 0;
    double first_lag, second_lag;
    Delay contraction;
  };

  ElbowJoint(const Options& options, double home, double sample_time);

  Options options_;
  double sample_time_;
  std::int64_t sample_ = 0;
  std::array<State, 2> muscles_;
};

}  // namespace mbk::participant
