#pragma once

#include <type_traits>
#include <vector>

#include "mbk/base/dsp/butterworth.h"

namespace mbk::dsp {

/// A cascade that runs sample by sample and only knows the past, in transposed direct form II; of each section
///   y[k] = b0 u[k] + s1,  s1 ← b1 u[k] − a1 y[k] + s2,  s2 ← b2 u[k] − a2 y[k].
/// An empty cascade lets everything pass. Allocates when it is made, never in `settle` or `step`.
/// @tparam Value  a double, or an array of them: signals that are filtered side by side, to the same bits as one by one
template <typename Value>
class CausalFilterOf {
 public:
  /// At rest: all inputs so far were zero.
  explicit CausalFilterOf(const SectionCascade& sections = {}) {
    sections_.reserve(sections.size());
    for (const SecondOrderSection& section : sections) sections_.push_back({section, zero(), zero()});
  }

  /// As if the input had always been this.
  void settle(Value input) noexcept {
    for (auto& [s, s1, s2] : sections_) {
      const Value output = s.gain_at_zero() * input;
      s2 = s.b2 * input - s.a2 * output;
      s1 = s.b1 * input - s.a1 * output + s2;
      input = output;
    }
  }

  /// The next output.
  Value step(Value input) noexcept {
    for (auto& [s, s1, s2] : sections_) {
      const Value output = s.b0 * input + s1;
      s1 = s.b1 * input - s.a1 * output + s2;
      s2 = s.b2 * input - s.a2 * output;
      input = output;
    }
    return input;
  }

 private:
  struct Section {
    SecondOrderSection coefficients;
    Value s1, s2;
  };

  static Value zero() {
    if constexpr (std::is_floating_point_v<Value>) {
      return 0.0;
    } else {
      return Value::Zero();
    }
  }

  std::vector<Section> sections_;
};
using CausalFilter = CausalFilterOf<double>;

/// Delay of slow signals, −dφ/dω at ω = 0: Σ [(b1 + 2 b2)/(b0 + b1 + b2) − (a1 + 2 a2)/(1 + a1 + a2)] T   [s]
/// For a Butterworth low-pass far below Nyquist this is Σ cos φ_k/(π f_c) over the pairs of poles (order 4:
/// 2.613/(2π f_c)), times (π f_c/f_s)/tan(π f_c/f_s) near it.
/// @param filter  a low-pass: a section whose gain at zero is 0 has no delay there
[[nodiscard]] double delay_at_zero(const SectionCascade& filter, Hertz sample_rate);

}  // namespace mbk::dsp
