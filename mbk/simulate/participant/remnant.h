#pragma once

#include <Eigen/Core>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/numeric/random.h"

namespace mbk::participant {

/// The unexplained part of a person's force: independent noise of one or two axes, each
///   n = (σ₀ + σ₁ |F_v|) z,   z ← a z + √(1 − a²) w,   a = e^{−2π f_c T},   w standard normal
/// so that z has variance 1 from the first tick and is low-pass noise of first order.
template <int Axes>
class Remnant {
 public:
  using Force = Eigen::Matrix<double, Axes, 1>;
  struct Options {
    double floor = 0.15;      ///< σ₀ [N], for one axis [N·m] ≥ 0
    double per_force = 0.08;  ///< σ₁, of the voluntary force ≥ 0
    Hertz cutoff{1.5};        ///< f_c > 0
  };

  /// @param sample_time  T [s] > 0
  /// @fails  usage: a limit stated in Options is violated.
  [[nodiscard]] static Result<Remnant> create(const Options& options, double sample_time, std::uint64_t seed,
                                              std::uint32_t stream = 0);

  /// One tick; |F_v| [N].
  Force step(double voluntary_force);

 private:
  Remnant(const Options& options, double memory, numeric::Random random);
  Force draw();

  Options options_;
  double memory_;
  numeric::Random random_;
  Force shape_;  // z
};

extern template class Remnant<1>;
extern template class Remnant<2>;

}  // namespace mbk::participant
