#pragma once

#include <array>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/lti/rational.h"

namespace mbk::lti {

/// A real rational matrix Z(s) is positive real, Z(s) + Z(s)* ⪰ 0 wherever Re s > 0, if and only if these hold
/// (Newcomb 1966; Anderson & Vongpanitlerd 1973, theorem 2.7.2). A model of an impedance is passive if and only if its
/// Z is positive real.
enum class PositiveRealCondition {
  no_right_poles,  ///< no pole has a positive real part
  simple_poles,    ///< poles on the imaginary axis, zero and infinity included, are simple
  residues,        ///< their residues (at infinity: lim Z/s) are Hermitian and ⪰ 0; of simple poles only
  hermitian_part,  ///< Z(jω) + Z(jω)* ⪰ 0 for all ω where Z has no pole
};

/// Frequencies ω ≥ 0; an end may be infinite. One frequency where low = high.
struct FrequencyBand {
  RadPerSec low, high;
  RadPerSec witness;  ///< a frequency inside
};

/// One condition, and each place where it is violated: |Im s| of poles, or bands.
struct ConditionOutcome {
  PositiveRealCondition condition = PositiveRealCondition::no_right_poles;
  std::vector<FrequencyBand> violated;  ///< ascending, except for poles; empty: the condition is satisfied

  [[nodiscard]] bool holds() const { return violated.empty(); }
  /// One line: "Z(jω) + Z(jω)* ⪰ 0: violated from 9.9 to 10.1 rad/s".
  [[nodiscard]] std::string line() const;
};

struct PositiveRealness {
  std::array<ConditionOutcome, 4> conditions;  ///< in the order of PositiveRealCondition

  [[nodiscard]] bool holds() const;
  [[nodiscard]] const ConditionOutcome& operator[](PositiveRealCondition condition) const {
    return conditions[static_cast<std::size_t>(condition)];
  }
};

inline constexpr Index kMaxPorts = 6;  ///< the number of principal minors is 2ⁿ − 1

/// Decides every condition exactly, in rational arithmetic; only the frequencies that it names are rounded. Marginal
/// cases, such as a lossless Z or a damping of exactly zero, are positive real.
/// For Z = M s + B + K/s: M = Mᵀ ⪰ 0, K = Kᵀ ⪰ 0 and B + Bᵀ ⪰ 0, which theorem 3.2 of Dyck 2013 misses on its boundary.
/// @fails  usage: Z has no entries or more than kMaxPorts rows.
[[nodiscard]] Result<PositiveRealness> positive_real(const RationalMatrix& Z);

}  // namespace mbk::lti
