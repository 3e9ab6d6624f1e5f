#pragma once

#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/perturbation/jet.h"
#include "mbk/model/perturbation/underdamped_filter.h"

namespace mbk::perturbation {

struct RandomBinaryOptions {
  double amplitude = 2.0;                         ///< A [m or N] > 0; the published force is ±2 N (Dyck 2013, §4.4.2)
  double switching_time = 0.5;                    ///< switching time between draws of the sign [s]; not published
  bool zero_mean = false;                         ///< equal numbers of +A and −A, in random order
  double damping_ratio = kPublishedDampingRatio;  ///< ζ
  RadPerSec natural_frequency = kPublishedNaturalFrequency;  ///< ωₙ
  std::uint64_t seed = 1;
};

/// Random binary sequence u = ±A, held for one switching time each, through the underdamped filter G (Dyck 2013,
/// eq. 3.5 and §4.4.2): y = G u from rest at t = 0, exact at any time. Spectral density of u: A² T_s sinc²(f T_s).
class RandomBinary {
 public:
  static constexpr int kMaxIntervals = 1'000'000;

  /// @param duration  of the sequence [s] > 0; the last interval may be cut short by it
  /// @fails  A ≤ 0; T_s ≤ 0; ζ outside (0, 1); ωₙ ≤ 0; T_s above the duration, or below it by more than the factor
  /// kMaxIntervals; zero mean is requested and the duration is not an even multiple of the switching time; a value is
  /// not finite.
  [[nodiscard]] static Result<RandomBinary> create(const RandomBinaryOptions& options, double duration);

  /// y, ẏ, ÿ at t [s]; zero before 0. After the last interval u keeps its last value. Where u switches, ÿ is that
  /// after the switch.
  [[nodiscard]] Jet<double> at(double t) const;

  /// u at t [s]: +A or −A; zero before 0.
  [[nodiscard]] double reference(double t) const;

  /// Highest frequency at which the density of y, sinc²(f T_s) |G|², is half of that at zero frequency.
  [[nodiscard]] Hertz bandwidth() const;

  [[nodiscard]] const RandomBinaryOptions& options() const { return options_; }
  [[nodiscard]] const UnderdampedFilter& filter() const { return filter_; }
  [[nodiscard]] std::size_t size() const { return intervals_.size(); }  ///< number of intervals

 private:
  struct Interval {
    double input;  // u
    double value;  // y at its start
    double rate;   // ẏ at its start
  };

  RandomBinary(const RandomBinaryOptions& options, const UnderdampedFilter& filter)
      : options_(options), filter_(filter) {}
  [[nodiscard]] std::size_t interval_at(double t) const;
  [[nodiscard]] double start_of(std::size_t interval) const {
    return static_cast<double>(interval) * options_.switching_time;
  }

  RandomBinaryOptions options_;
  UnderdampedFilter filter_;
  std::vector<Interval> intervals_;
};

}  // namespace mbk::perturbation
