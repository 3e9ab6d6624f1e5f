#pragma once

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/robot/mechanism.h"

namespace mbk::robot {

/// Velocity of the joints from their measured positions: backward differences with a first-order low-pass,
///   ω ← a ω + (1 − a) Δq/T,   a = e^{−2π f_c T}                                [rad/s or m/s]
/// The first call takes the velocity as zero. Allocation-free.
class VelocityEstimate {
 public:
  /// @fails  usage: T or f_c is not above zero.
  [[nodiscard]] static Result<VelocityEstimate> create(double sample_time, Hertz cutoff);

  /// @param position  of every joint [rad or m]; as many in every call
  const JointVector& step(const JointVector& position) noexcept;

  /// The next call is the first again.
  void restart() noexcept { last_.resize(0); }

  /// a, of the low-pass.
  [[nodiscard]] double memory() const { return memory_; }

 private:
  VelocityEstimate(double sample_time, double memory) : sample_time_(sample_time), memory_(memory) {}
  double sample_time_, memory_;
  JointVector last_, velocity_;  // `last_` is empty before the first call
};

}  // namespace mbk::robot
