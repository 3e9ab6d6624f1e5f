#pragma once

#include <vector>

#include "mbk/base/dsp/butterworth.h"

namespace mbk::dsp {

/// A cascade that runs sample by sample and only knows the past, in transposed direct form II; of each section
///   y[k] = b0 u[k] + s1,  s1 ← b1 u[k] − a1 y[k] + s2,  s2 ← b2 u[k] − a2 y[k].
/// An empty cascade lets everything pass. Allocates when it is made, never in `settle` or `step`.
class CausalFilter {
 public:
  /// At rest: all inputs so far were zero.
  explicit CausalFilter(SectionCascade sections = {});

  /// As if the input had always been this.
  void settle(double input) noexcept;

  /// The next output.
  double step(double input) noexcept;

 private:
  struct Section {
    SecondOrderSection coefficients;
    double s1, s2;
  };
  std::vector<Section> sections_;
};

/// Delay of slow signals, −dφ/dω at ω = 0: Σ [(b1 + 2 b2)/(b0 + b1 + b2) − (a1 + 2 a2)/(1 + a1 + a2)] T   [s]
/// For a Butterworth low-pass far below Nyquist this is Σ cos φ_k/(π f_c) over the pairs of poles (order 4:
/// 2.613/(2π f_c)), times (π f_c/f_s)/tan(π f_c/f_s) near it.
/// @param filter  a low-pass: a section whose gain at zero is 0 has no delay there
[[nodiscard]] double delay_at_zero(const SectionCascade& filter, Hertz sample_rate);

}  // namespace mbk::dsp
