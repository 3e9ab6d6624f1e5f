#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/study/reliability/support.h"

namespace mbk::reliability {

/// A limit of agreement with its interval [unit of the numbers].
struct AgreementLimit {
  double value = 0;
  Interval interval95;
};

/// Agreement of two measurements of the same people after Bland & Altman (1986), second − first.
struct BlandAltman {
  Support support = Support::enough;
  int people = 0;
  double bias = 0;  ///< d̄
  Interval bias95;
  double standard_deviation = 0;  ///< s of the differences
  AgreementLimit lower, upper;    ///< d̄ ∓ 1.96 s
  /// d̄ ± k s: with 95 % confidence 95 % of all differences lie inside; unlike the outer ends of the two intervals
  /// above, which hold each limit by itself.
  Interval tolerance95;
};

/// Limits of agreement with exact intervals (Carkeet 2015): of n normal differences, (d̄ + 1.96 s·…) is a pivot of the
/// noncentral t, and the limit μ + z σ lies with 95 % between
///   d̄ + s t(0.025; n−1, z√n)/√n and d̄ + s t(0.975; n−1, z√n)/√n
/// They are not symmetric about d̄ + z s. Differences whose spread grows with their size: take logarithms first.
/// Support: too few people below kMinPeople; no variation where all differences are alike.
/// @param first, second  one entry a person, in the same order
/// @fails  data: lengths differ; a value is not finite.
[[nodiscard]] Result<BlandAltman> bland_altman(const Vector& first, const Vector& second);

/// The factor k of a two-sided normal tolerance interval x̄ ± k s, which holds `content` of the population with
/// probability `confidence` (Odeh 1978; exact but for quadrature to about ten digits).
/// @param count ≥ 2    @param content, confidence in (0, 1)
[[nodiscard]] double tolerance_factor(int count, double content, double confidence);

}  // namespace mbk::reliability
