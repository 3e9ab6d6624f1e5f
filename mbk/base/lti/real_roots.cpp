#include "mbk/base/lti/real_roots.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "mbk/base/lti/integer_polynomial.h"

namespace mbk::lti {
namespace {

/// Sturm's sequence of the square-free part of a polynomial.
class Sturm {
 public:
  explicit Sturm(const Polynomial& p) {
    const Polynomial once = square_free(p);
    sequence_ = signed_remainders(once, once.derivative());
  }

  [[nodiscard]] int sign(const Rational& x) const { return sign_at(sequence_.front(), x); }

  /// A point with what Sturm's theorem needs of it.
  struct Point {
    Rational x;
    int variations;
    bool is_root;
  };

  [[nodiscard]] Point point(const Rational& x) const { return {x, variations(x), sign(x) == 0}; }

  /// Different roots in (low, high).
  [[nodiscard]] static int roots(const Point& low, const Point& high) {
    return low.variations - high.variations - (high.is_root ? 1 : 0);
  }
  [[nodiscard]] int roots(const Rational& low, const Rational& high) const { return roots(point(low), point(high)); }

  /// Every root lies in (−bound, bound): Cauchy's 1 + max |cᵢ/cₙ|, up to the next power of two.
  [[nodiscard]] Rational bound() const {
    const IntegerPolynomial& p = sequence_.front();
    Integer largest = 0;
    for (const Integer& c : p) largest = std::max<Integer>(largest, abs(c));
    const unsigned more = msb(largest) - msb(Integer(abs(p.back()))) + 2;
    return Rational(Integer(1) << more);
  }

 private:
  [[nodiscard]] int variations(const Rational& x) const {
    int count = 0, before = 0;
    for (const IntegerPolynomial& p : sequence_) {
      const int now = sign_at(p, x);
      if (now * before < 0) ++count;
      if (now != 0) before = now;
    }
    return count;
  }

  std::vector<IntegerPolynomial> sequence_;
};

void isolate(const Sturm& sturm, const Sturm::Point& low, const Sturm::Point& high, std::vector<RootBracket>& found) {
  const int count = Sturm::roots(low, high);
  if (count == 0) return;
  const bool across_zero = low.x < 0 && high.x > 0;
  if (count == 1 && !across_zero && !low.is_root && !high.is_root) {
    found.push_back({low.x, high.x});
    return;
  }
  const Sturm::Point middle = sturm.point(across_zero ? Rational(0) : (low.x + high.x) / 2);
  isolate(sturm, low, middle, found);
  if (middle.is_root) found.push_back({middle.x, middle.x});
  isolate(sturm, middle, high, found);
}

/// Where the interval can hold roots; nothing where it cannot.
std::optional<std::pair<Rational, Rational>> finite(const Sturm& sturm, const Interval& interval) {
  const Rational bound = sturm.bound();
  const Rational low = interval.low ? std::max<Rational>(*interval.low, -bound) : -bound;
  const Rational high = interval.high ? std::min<Rational>(*interval.high, bound) : bound;
  if (low >= high) return std::nullopt;
  return std::pair(low, high);
}

/// Halves the bracket once. `p` changes its sign at the root.
void halve(const IntegerPolynomial& p, RootBracket& bracket) {
  const Rational middle = (bracket.low + bracket.high) / 2;
  const int sign = sign_at(p, middle);
  if (sign == 0) {
    bracket = {middle, middle};
  } else if (sign == sign_at(p, bracket.low)) {
    bracket.low = middle;
  } else {
    bracket.high = middle;
  }
}

}  // namespace

int distinct_roots(const Polynomial& p, const Interval& interval) {
  const Sturm sturm(p);
  const auto ends = finite(sturm, interval);
  return ends ? sturm.roots(ends->first, ends->second) : 0;
}

std::vector<RootBracket> isolate_roots(const Polynomial& p, const Interval& interval) {
  std::vector<RootBracket> found;
  const Sturm sturm(p);
  if (const auto ends = finite(sturm, interval)) {
    isolate(sturm, sturm.point(ends->first), sturm.point(ends->second), found);
  }
  return found;
}

RootBracket refine(const Polynomial& p, const RootBracket& bracket, int bits) {
  const IntegerPolynomial once = primitive(square_free(p));
  const Rational share(Integer(1), Integer(1) << static_cast<unsigned>(bits));
  RootBracket finer = bracket;
  while (finer.high - finer.low > share * std::min<Rational>(abs(finer.low), abs(finer.high))) halve(once, finer);
  return finer;
}

double approximate(const Polynomial& p, const RootBracket& bracket) {
  const RootBracket finer = refine(p, bracket);
  return to_double((finer.low + finer.high) / 2);
}

int sign_at_root(const Polynomial& q, const Polynomial& p, const RootBracket& bracket) {
  if (q.is_zero()) return 0;
  if (bracket.low == bracket.high) return q(bracket.low).sign();
  const Polynomial common = gcd(p, q);
  if (common.degree() > 0 && distinct_roots(common, {bracket.low, bracket.high}) > 0) return 0;
  const Sturm sturm(q);
  const IntegerPolynomial once = primitive(square_free(p));
  RootBracket finer = bracket;
  while (finer.low != finer.high && sturm.roots(finer.low, finer.high) > 0) halve(once, finer);
  return q((finer.low + finer.high) / 2).sign();
}

std::vector<PositiveInterval> negative_intervals(std::span<const Polynomial> polynomials) {
  const auto any_negative = [&](const auto& sign) {
    return std::any_of(polynomials.begin(), polynomials.end(), [&](const Polynomial& p) { return sign(p) < 0; });
  };
  Polynomial all{1};  // each root of any of them, once
  for (const Polynomial& p : polynomials) {
    if (p.is_zero()) continue;
    const Polynomial once = square_free(p);
    all = all * divide(once, gcd(all, once)).quotient;
  }
  std::vector<RootBracket> ends{{0, 0}};
  for (const RootBracket& root : isolate_roots(all, {Rational(0), {}})) ends.push_back(refine(all, root));

  std::vector<PositiveInterval> found;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const bool last = i + 1 == ends.size();
    const Rational& begin = ends[i].high;
    const Rational witness = !last ? (begin + ends[i + 1].low) / 2 : begin.is_zero() ? Rational(1) : 2 * begin;
    if (!any_negative([&](const Polynomial& p) { return p(witness).sign(); })) continue;
    const auto high = last ? std::nullopt : std::optional(ends[i + 1]);
    const bool joins = i > 0 && !found.empty() && found.back().high && found.back().high->low == ends[i].low &&
                       any_negative([&](const Polynomial& p) { return sign_at_root(p, all, ends[i]); });
    if (joins) {
      found.back().high = high;
    } else {
      found.push_back({ends[i], high, witness});
    }
  }
  return found;
}

std::vector<PositiveInterval> negative_intervals(const Polynomial& p) {
  return negative_intervals(std::span(&p, 1));
}

bool is_nonnegative(const Polynomial& p) {
  return negative_intervals(p).empty();
}

}  // namespace mbk::lti
