#include "mbk/teleop/largest_shortage.h"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "mbk/base/lti/real_roots.h"
#include "mbk/teleop/conditions.h"
#include "mbk/teleop/llewellyn.h"

namespace mbk::teleop {
namespace {

using Real = boost::multiprecision::cpp_bin_float_50;

Real to_real(const Rational& value) {
  return Real(numerator(value)) / Real(denominator(value));
}

class RealPolynomial {
 public:
  explicit RealPolynomial(const Polynomial& p) {
    for (const Rational& c : p.coefficients()) coefficients_.push_back(to_real(c));
  }
  [[nodiscard]] Real operator()(const Real& X) const {
    Real value = 0;
    for (auto c = coefficients_.rbegin(); c != coefficients_.rend(); ++c) value = value * X + *c;
    return value;
  }

 private:
  std::vector<Real> coefficients_;
};

/// The a beyond which a condition fails at one frequency, r_ii − (Re p + |p|)/(2 r_jj), to 50 digits.
class ShortageAtFrequency {
 public:
  ShortageAtFrequency(const ConditionsOnAxis& axis, std::size_t i)
      : resistance_(axis.resistance[i]),
        modulus_(axis.modulus[i]),
        other_(axis.resistance[1 - i] * axis.share),
        p_re_(axis.p_re),
        p_im_(axis.p_im) {}

  [[nodiscard]] Real operator()(const Real& X) const {
    const Real modulus = modulus_(X), own = resistance_(X) / modulus, slope = 2 * modulus * other_(X);
    const Real re = p_re_(X), im = p_im_(X), length = sqrt(re * re + X * im * im);
    const Real coupling = re < 0 ? Real(X * im * im / (length - re)) : Real(re + length);
    return slope > 0 && coupling > 0 ? Real(own - coupling / slope) : own;
  }

 private:
  RealPolynomial resistance_, modulus_, other_, p_re_, p_im_;
};

/// A value about as low as f is in the band: at the lowest of some points, then by golden sections between its
/// neighbours. An open end is looked at far beyond all frequencies.
Real low_value(const ShortageAtFrequency& f, const lti::PositiveInterval& band) {
  constexpr int kPoints = 64, kSections = 90, kFar = 4096, kEnd = 64;
  const Real far = ldexp(Real(1), kFar), end = ldexp(Real(1), kEnd);
  Real lowest = f(to_real(band.witness));
  const auto look = [&](const Real& X) {
    Real value = f(X);
    lowest = std::min(lowest, value);
    return value;
  };
  if (band.low.high.is_zero()) look(1 / far);
  if (!band.high) look(far);
  const Real from = log(band.low.high.is_zero() ? Real(1 / end) : to_real(band.low.high));
  const Real step = (log(band.high ? to_real(band.high->low) : end) - from) / kPoints;
  const auto at = [&](const Real& place) { return look(exp(Real(from + step * place))); };
  std::pair<Real, Real> best{at(0), 0};
  for (int k = 1; k <= kPoints; ++k) best = std::min(best, {at(k), Real(k)});

  const Real golden = (sqrt(Real(5)) - 1) / 2;
  Real low = best.second - 1, high = best.second + 1;
  Real inner = high - golden * (high - low), outer = low + golden * (high - low);
  Real f_inner = at(inner), f_outer = at(outer);
  for (int k = 0; k < kSections; ++k) {
    if (f_inner < f_outer) {
      high = std::exchange(outer, inner);
      f_outer = std::exchange(f_inner, at(inner = high - golden * (high - low)));
    } else {
      low = std::exchange(inner, outer);
      f_inner = std::exchange(f_outer, at(outer = low + golden * (high - low)));
    }
  }
  return lowest;
}

/// Narrows a bracket between an a that is stable and one that is not, by exact decisions only.
class ShortageSearch {
 public:
  ShortageSearch(const ConditionsOnAxis& axis, std::size_t i) : axis_(axis), i_(i), at_frequency_(axis, i) {}

  [[nodiscard]] std::optional<std::pair<Rational, Rational>> bracket() {
    if (!lti::is_nonnegative(axis_.resistance[1 - i_]) || !holds(low_) || holds(high_)) return std::nullopt;
    while (high_ - low_ > finest(high_)) {
      const Rational before = high_ - low_;
      if (const auto guess = lowest_violated()) try_around(*guess);
      if (2 * (high_ - low_) > before) halve();
    }
    return std::pair(low_, high_);
  }

 private:
  static Rational finest(const Rational& a) { return std::max<Rational>(abs(a), 1) / Rational(1ULL << 50U); }

  [[nodiscard]] std::array<Polynomial, 3> conditions(const Rational& a) const {
    const ConditionsOnAxis with = axis_.with_shortage(i_, a);
    return {with.resistance[i_], with.product(), with.squares()};
  }

  [[nodiscard]] bool holds(const Rational& a) const {
    return std::ranges::all_of(conditions(a), [](const Polynomial& f) { return lti::is_nonnegative(f); });
  }

  void decide(const Rational& a) {
    if (low_ < a && a < high_) (holds(a) ? low_ : high_) = a;
  }

  /// A value near the largest a, where the conditions fail at the upper end of the bracket.
  [[nodiscard]] std::optional<Rational> lowest_violated() const {
    std::optional<Real> lowest;
    for (const Polynomial& f : conditions(high_)) {
      for (const lti::PositiveInterval& band : lti::negative_intervals(f)) {
        const Real value = low_value(at_frequency_, band);
        if (!lowest || value < *lowest) lowest = value;
      }
    }
    if (!lowest || !isfinite(*lowest)) return std::nullopt;
    return lowest->convert_to<Rational>();
  }

  void try_around(const Rational& guess) {
    const Rational unit = finest(guess), quarter = unit / 4;
    const Rational middle = lti::simplest_between(guess - quarter, guess + quarter);
    decide(middle);
    if (low_ == middle) {
      decide(lti::simplest_between(middle + unit / 2, middle + unit));
    } else if (high_ == middle) {
      decide(lti::simplest_between(middle - unit, middle - unit / 2));
    }
  }

  void halve() {
    // the simplest fraction of the middle keeps the numbers short
    const Rational quarter = (high_ - low_) / 4;
    decide(lti::simplest_between(low_ + quarter, high_ - quarter));
  }

  static inline const Rational kLargest = Rational(boost::multiprecision::cpp_int(1) << 64U);

  const ConditionsOnAxis& axis_;
  std::size_t i_;
  ShortageAtFrequency at_frequency_;
  Rational low_ = -kLargest, high_ = kLargest;
};

}  // namespace

LargestShortage largest_shortage(const PortEquations& equations, Port port) {
  LargestShortage result;
  result.port = static_cast<int>(port);
  const auto network = equations.at(0);
  if (!network) return result;
  const auto two_port = as_impedance_at(*network, port);
  if (!two_port || !has_passive_poles(two_port->matrix)) return result;
  const ConditionsOnAxis axis = ConditionsOnAxis::of(two_port->matrix);
  if (const auto bracket = ShortageSearch(axis, port == Port::one ? 0 : 1).bracket()) {
    result.exists = true;
    result.at_least = lti::to_double(bracket->first);
    result.at_most = lti::to_double(bracket->second);
  }
  return result;
}

}  // namespace mbk::teleop
