#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mbk/base/lti/polynomial.h"

namespace mbk::lti {

/// The open interval (low, high); an end that is not given is infinite.
struct Interval {
  std::optional<Rational> low, high;
};

/// How many different real roots p has in the interval. p must not be zero.
[[nodiscard]] int distinct_roots(const Polynomial& p, const Interval& interval = {});

/// A real root between two fractions: the only one in (low, high), neither end a root; or low = high, and that is it.
/// Zero is never inside.
struct RootBracket {
  Rational low, high;
};

/// Every different real root of p in the interval, ascending, exactly: by Descartes' rule of signs on halved intervals
/// (Collins and Akritas 1976). p must not be zero.
[[nodiscard]] std::vector<RootBracket> isolate_roots(const Polynomial& p, const Interval& interval = {});

/// The bracket of a root of p halved until high − low ≤ 2^−bits |root|.
[[nodiscard]] RootBracket refine(const Polynomial& p, const RootBracket& bracket, int bits = 64);

/// The root of p to the last digit of a double or the one before.
[[nodiscard]] double approximate(const Polynomial& p, const RootBracket& bracket);

/// The sign, −1, 0 or 1, of q at a root of p, exactly. p must not be zero.
[[nodiscard]] int sign_at_root(const Polynomial& q, const Polynomial& p, const RootBracket& bracket);

/// One piece of a set of X > 0: from low to high, both outside, or to infinity. Brackets are 2⁻⁶⁴ of their root wide.
struct PositiveInterval {
  RootBracket low;                  ///< [0, 0] where it begins at zero
  std::optional<RootBracket> high;  ///< none: infinity
  Rational witness;                 ///< a point inside
};

/// {X > 0: at least one p(X) < 0} as the fewest open intervals, ascending. Exact: empty if and only if every p is ≥ 0
/// on all of (0, ∞), be it by a root that only touches zero.
[[nodiscard]] std::vector<PositiveInterval> negative_intervals(std::span<const Polynomial> polynomials);
[[nodiscard]] std::vector<PositiveInterval> negative_intervals(const Polynomial& p);

/// p(X) ≥ 0 for all X in (0, ∞), exactly.
[[nodiscard]] bool is_nonnegative(const Polynomial& p);

}  // namespace mbk::lti
