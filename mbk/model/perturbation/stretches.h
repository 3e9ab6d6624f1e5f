#pragma once

#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/core/words.h"
#include "mbk/model/perturbation/jet.h"
#include "mbk/model/perturbation/minimum_jerk.h"

namespace mbk::perturbation {

/// Stretches of a muscle at constant velocity, as in instrumented tests of spasticity: from rest over an amplitude at
/// each of several speeds, a hold, and a slow return on a minimum-jerk path. The speed v grows and falls smoothly,
///   ṙ = v (3s² − 2s³),  s = t/T,  T = 1.5 v/a
/// so that the acceleration a is its peak, and each change takes the distance v T/2.
class Stretches {
 public:
  static constexpr int kMaxStretches = 10000;

  enum class Order {
    random,  ///< all stretches in random order (Fisher & Yates)
    listed,  ///< the speeds as listed, again for each repetition
  };

  struct Options {
    double amplitude = 1.0471975511965976;  ///< A, 60° [rad]; the sign is the direction, not zero
    std::vector<double> speeds = {0.17453292519943295, 0.5235987755982988, 1.5707963267948966,
                                  3.141592653589793};  ///< v, 10, 30, 90 and 180 °/s [rad/s]; each > 0
    int repetitions = 5;                               ///< of each speed
    Order order = Order::random;
    double acceleration = 52.35987755982989;  ///< a, 3000 °/s² [rad/s²]; > 1.5 v²/|A|
    double hold = 1.0;                        ///< at A [s]; > 0
    double way_back = 3.0;                    ///< duration of the return [s]; > 0
    double shortest_pause = 2.0;              ///< from the end of `quiet`, or of the previous return, to the onset [s]
    double longest_pause = 4.0;               ///< [s]
    double quiet = 2.0;                       ///< before the first pause [s]
    std::uint64_t seed = 1;
  };

  struct Stretch {
    double onset = 0.0;    ///< start of the motion [s]
    double fast = 0.0;     ///< start of constant velocity [s]
    double slowing = 0.0;  ///< end of constant velocity [s]
    double still = 0.0;    ///< end of the motion [s]
    double offset = 0.0;   ///< start of the return [s]
    double speed = 0.0;    ///< v > 0
  };

  /// @fails  usage: a limit stated in Options is violated; a value is not finite; more than kMaxStretches.
  [[nodiscard]] static Result<Stretches> create(const Options& options);

  /// Displacement and its two derivatives at t [s]: exactly A while it is held, exactly zero between the end of a
  /// return and the next onset. Does not allocate.
  [[nodiscard]] Jet<double> at(double t) const;

  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
  [[nodiscard]] const Options& options() const { return options_; }

  /// End of the last return [s].
  [[nodiscard]] double end() const { return stretches_.back().offset + options_.way_back; }

  /// −3 dB of the velocity of the fastest stretch, A sinc(fA/v) · 3 j₁(πfT)/(πfT), or of the return, if that is faster.
  [[nodiscard]] Hertz bandwidth() const;

 private:
  explicit Stretches(const Options& options);

  Options options_;
  MinimumJerk back_;
  std::vector<Stretch> stretches_;  // in time order
};

[[nodiscard]] constexpr auto word_table(Stretches::Order) {
  using enum Stretches::Order;
  return std::to_array<Word<Stretches::Order>>({{random, "random"}, {listed, "listed"}});
}

}  // namespace mbk::perturbation
