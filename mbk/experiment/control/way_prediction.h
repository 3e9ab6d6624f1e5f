#pragma once

#include <Eigen/Core>

#include "mbk/model/perturbation/jet.h"

namespace mbk::control {

using Eigen::Vector2d;

/// The undisturbed way of a hand after a trigger, from its own way before it, in real time: a linear predictor that
/// learns from every undisturbed reach. φ holds 1 and the places of the past 200 ms, Y the places of the future, both
/// from the place at the trigger; of the reaches so far
///   A = Σ φ φᵀ,   C = Σ φ Yᵀ,   Ŷ = Cᵀ w,   w = (A + n σ² I')⁻¹ φ                     (ridge regression)
/// with I' the identity without the 1's row: places tell nothing of the future that is finer than σ. Only sums of fixed
/// size are kept, so that learning and predicting take bounded time and no memory. The offline measurement uses a
/// predictor of its own (explore::ReachPrediction), from all reaches.
class WayPrediction {
 public:
  static constexpr int kLags = 4;           ///< places of the past, one every kLag
  static constexpr double kLag = 0.05;      ///< [s]
  static constexpr int kKnots = 64;         ///< places of the future, one every kStep
  static constexpr double kStep = 0.01;     ///< [s]
  static constexpr double kSigma = 0.0002;  ///< σ [m]
  static constexpr int kFeatures = 1 + 2 * kLags;

  using Past = Eigen::Matrix<double, kFeatures, 1>;  ///< φ: 1, then places kLag, 2 kLag, … before [m]
  using Future = Eigen::Matrix<double, 2, kKnots>;   ///< places kStep, 2 kStep, … after the trigger [m]

  /// How the hand goes on from the place at the trigger.
  class Way {
   public:
    /// Place from that at the trigger and velocity at t [s] after it, base frame [m], by a cubic through the knots
    /// (Catmull & Rom 1974). Beyond the last knot it stays there.
    [[nodiscard]] perturbation::Jet<Vector2d> at(double t) const noexcept;

    /// φᵀ w, the leverage: 1/n for the mean reach; above 1 for one that is unlike all that were learned from.
    [[nodiscard]] double leverage() const noexcept { return leverage_; }

   private:
    friend class WayPrediction;
    [[nodiscard]] Vector2d knot(int k) const noexcept;
    Vector2d before_ = {0.0, 0.0};  // kStep before the trigger
    Future places_ = Future::Zero();
    double leverage_ = 0.0;
  };

  void learn(const Past& past, const Future& future) noexcept;

  /// Of how many reaches it has learned.
  [[nodiscard]] int learned() const noexcept { return learned_; }

  /// @param before  place kStep before the trigger, from that at the trigger [m]
  /// A reach must have been learned from before.
  [[nodiscard]] Way predict(const Past& past, const Vector2d& before) const noexcept;

 private:
  int learned_ = 0;
  Eigen::Matrix<double, kFeatures, kFeatures> A_ = Eigen::Matrix<double, kFeatures, kFeatures>::Zero();
  Eigen::Matrix<double, kFeatures, 2 * kKnots> C_ = Eigen::Matrix<double, kFeatures, 2 * kKnots>::Zero();
};

}  // namespace mbk::control
