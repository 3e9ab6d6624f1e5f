#include "mbk/teleop/admissible.h"

#include <algorithm>
#include <array>
#include <utility>

#include "mbk/teleop/llewellyn.h"

namespace mbk::teleop {
namespace {

using lti::Interval;
using lti::RootBracket;

/// The four conditions as polynomials of X = ω² and k, each times a power of |d(jω)|².
std::array<ParametricPolynomial, 4> conditions_of(const ParametricTwoPort& two_port) {
  const ParametricPolynomial X = ParametricPolynomial::of({0, 1});
  const auto constant = [](int value) { return ParametricPolynomial::of({Rational(value)}); };
  struct Value {
    ParametricPolynomial re, im;  // of re + jω im
  };
  const auto on_axis = [](const ParametricPolynomial& p) {
    auto [even, odd] = axis_parts(p);
    return Value{std::move(even), std::move(odd)};
  };
  const auto times = [&](const Value& a, const Value& b) {
    return Value{a.re * b.re - X * a.im * b.im, a.re * b.im + a.im * b.re};
  };
  Value d = on_axis(two_port.denominator);
  d.im = ParametricPolynomial() - d.im;  // conjugate
  const auto& n = two_port.numerator;
  const ParametricPolynomial r11 = times(on_axis(n[0][0]), d).re, r22 = times(on_axis(n[1][1]), d).re;
  const Value p = times(times(on_axis(n[0][1]), d), times(on_axis(n[1][0]), d));
  const ParametricPolynomial r = r11 * r22;
  return {r11, r22, constant(2) * r - p.re, constant(4) * r * (r - p.re) - X * p.im * p.im};
}

/// f(X, k) at this X, as a polynomial of k.
Polynomial at_frequency(const ParametricPolynomial& f, const Rational& X) {
  Polynomial value;
  for (auto c = f.coefficients().rbegin(); c != f.coefficients().rend(); ++c) value = value * Polynomial{X} + *c;
  return value;
}

ParametricPolynomial without_roots_at_zero(const ParametricPolynomial& p) {
  const auto first = std::ranges::find_if(p.coefficients(), [](const Polynomial& c) { return !c.is_zero(); });
  return ParametricPolynomial(std::vector<Polynomial>(first, p.coefficients().end()));
}

/// How far the work is, of parts whose costs are known beforehand.
class Work {
 public:
  explicit Work(const std::function<void(double)>& progress) : progress_(progress) {}

  void expect(double cost) { total_ += cost; }

  /// To be told how much of a part of that cost is done.
  [[nodiscard]] std::function<void(double)> part(double cost) const {
    if (!progress_) return {};
    return [this, cost](double share) { progress_((done_ + share * cost) / total_); };
  }
  void finish(double cost) { done_ += cost; }

 private:
  const std::function<void(double)>& progress_;
  double total_ = 0.0, done_ = 0.0;
};

/// The k at which an answer can change, as roots of polynomials without common or multiple roots.
class CriticalValues {
 public:
  struct Factor {
    Polynomial polynomial;
    bool poles;  // a pole or residue may change there, not only a condition on the axis
  };

  void add(const Polynomial& p, bool poles) {
    if (p.degree() < 1) return;
    Polynomial rest = lti::square_free(p);
    std::vector<Factor> split;
    for (Factor& factor : factors_) {
      const Polynomial common = lti::gcd(rest, factor.polynomial);
      if (common.degree() < 1) continue;
      rest = lti::divide(rest, common).quotient;
      factor.polynomial = lti::divide(factor.polynomial, common).quotient;
      split.push_back({common, factor.poles || poles});
    }
    if (rest.degree() > 0) split.push_back({rest, poles});
    std::erase_if(factors_, [](const Factor& factor) { return factor.polynomial.degree() < 1; });
    factors_.insert(factors_.end(), split.begin(), split.end());
  }

  void add_coefficients(const ParametricPolynomial& p) {
    for (const Polynomial& c : p.coefficients()) add(c, true);
  }

  /// Where the number and kind of the roots of f in X > 0 can change.
  void add_condition(const ParametricPolynomial& f, const std::function<void(double)>& progress) {
    if (f.is_zero()) return;
    const auto [content, part] = split_content(without_roots_at_zero(f));
    add(content, false);
    if (part.degree() < 1) return;
    Elimination multiple = eliminate(part, part.derivative(), progress);
    const bool repeated = multiple.common.degree() > 0;
    const ParametricPolynomial once = repeated ? quotient(part, multiple.common) : part;
    add(once.leading(), false);
    add(once.coefficients().front(), false);
    if (repeated) multiple = eliminate(once, once.derivative());
    if (once.degree() > 1) add(multiple.resultant, false);
  }

  [[nodiscard]] const std::vector<Factor>& factors() const { return factors_; }

 private:
  std::vector<Factor> factors_;
};

/// n/d in lowest terms over the fractions of k.
struct Ratio {
  ParametricPolynomial numerator, denominator;
};

Ratio reduced(const ParametricPolynomial& n, const ParametricPolynomial& d) {
  if (n.is_zero()) return {n, ParametricPolynomial::of({1})};
  const ParametricPolynomial common = eliminate(n, d).common;
  return common.degree() > 0 ? Ratio{quotient(n, common), quotient(d, common)} : Ratio{n, d};
}

/// Where poles of n/d can change side, order or residue.
Result<void> add_poles(const Ratio& ratio, CriticalValues& critical) {
  critical.add_coefficients(ratio.numerator);
  critical.add_coefficients(ratio.denominator);
  if (ratio.numerator.is_zero() || ratio.denominator.degree() < 1) return {};
  critical.add(eliminate(ratio.numerator, ratio.denominator).resultant, true);
  const auto [even, odd] = axis_parts(without_roots_at_zero(ratio.denominator));
  // a polynomial of s without roots at 0 has an even part; without an odd one all of its roots lie symmetric to the
  // axis
  const Elimination axis = odd.is_zero() ? Elimination{even, {}} : eliminate(even, odd);
  if (axis.common.degree() > 0) {
    return fail(ErrorKind::not_usable, "the network has undamped poles for every value of the parameter",
                "add some damping, or test single values");
  }
  critical.add(axis.resultant, true);
  return {};
}

Result<CriticalValues> critical_values(const ParametricTwoPort& two_port, const std::function<void(double)>& progress) {
  CriticalValues critical;
  const auto conditions = conditions_of(two_port);
  const auto& n = two_port.numerator;
  const ParametricPolynomial& d = two_port.denominator;
  const auto cost_of = [](const ParametricPolynomial& f) { return elimination_cost(f, f.derivative()); };
  const double cost_of_entry = 2.0 * elimination_cost(d, d);
  Work work(progress);
  for (const ParametricPolynomial& f : conditions) work.expect(cost_of(f));
  work.expect(4.0 * cost_of_entry);
  for (const ParametricPolynomial& f : conditions) {
    critical.add_condition(f, work.part(cost_of(f)));
    work.finish(cost_of(f));
  }
  critical.add_coefficients(d);
  for (const auto& row : n) {
    for (const ParametricPolynomial& entry : row) {
      MBK_TRY(add_poles(reduced(entry, d), critical));
      work.finish(cost_of_entry);
    }
  }
  const Ratio determinant = reduced(n[0][0] * n[1][1] - n[0][1] * n[1][0], d * d);
  critical.add_coefficients(determinant.numerator);
  critical.add_coefficients(determinant.denominator);
  return critical;
}

/// A critical value or an end of the range.
struct Boundary {
  RootBracket bracket;
  std::optional<Rational> fraction;  // where it is known as one
  Polynomial of;                     // the polynomial whose root it is
  bool poles = false;
};

Boundary fraction(const Rational& k) {
  return {{k, k}, k, {}, false};
}

std::vector<Boundary> boundaries(const CriticalValues& critical, const Rational& low, const Rational& high) {
  constexpr int kBits = 64;
  std::vector<Boundary> found = {fraction(low)};
  if (low < high) found.push_back(fraction(high));
  for (const auto& [polynomial, poles] : critical.factors()) {
    for (const RootBracket& root : lti::isolate_roots(polynomial, Interval{low, high})) {
      const RootBracket bracket = lti::refine(polynomial, root, kBits);
      const Rational simplest = lti::simplest_between(bracket.low, bracket.high);
      if (polynomial(simplest).is_zero()) {
        found.push_back(fraction(simplest));
      } else {
        found.push_back({bracket, {}, polynomial, poles});
      }
    }
  }
  const auto lower = [](const Boundary& a, const Boundary& b) { return a.bracket.low < b.bracket.low; };
  std::ranges::sort(found, lower);
  for (int bits = 2 * kBits;; bits *= 2) {
    const auto touching = std::ranges::adjacent_find(
        found, [](const Boundary& a, const Boundary& b) { return !(a.bracket.high < b.bracket.low); });
    if (touching == found.end()) return found;
    for (Boundary& boundary : found) {
      if (!boundary.fraction) boundary.bracket = lti::refine(boundary.of, boundary.bracket, bits);
    }
    std::ranges::sort(found, lower);
  }
}

class Search {
 public:
  Search(const PortEquations& equations, const ParametricTwoPort& two_port)
      : equations_(equations), conditions_(conditions_of(two_port)) {}

  [[nodiscard]] bool holds(const Rational& k) const {
    const auto two_port = equations_.at(k);
    return two_port && is_absolutely_stable(*two_port);
  }

  /// Whether the boundary belongs to the set, by the pieces on either side of it; none where that does not tell.
  [[nodiscard]] std::optional<bool> holds(const Boundary& boundary, const std::vector<Rational>& beside,
                                          bool beside_holds) const {
    if (boundary.fraction) return holds(*boundary.fraction);
    if (!boundary.poles && beside_holds) return true;
    for (const Rational& sample : beside) {
      if (is_violated(boundary, sample)) return false;
    }
    return std::nullopt;
  }

 private:
  /// A frequency at which a condition is violated beside the boundary is one at which it is violated there too.
  [[nodiscard]] bool is_violated(const Boundary& boundary, const Rational& sample) const {
    return std::ranges::any_of(conditions_, [&](const ParametricPolynomial& f) {
      return std::ranges::any_of(lti::negative_intervals(f.at(sample)), [&](const lti::PositiveInterval& band) {
        return lti::sign_at_root(at_frequency(f, band.witness), boundary.of, boundary.bracket) < 0;
      });
    });
  }

  const PortEquations& equations_;
  std::array<ParametricPolynomial, 4> conditions_;
};

double value_of(const Boundary& boundary) {
  return lti::to_double((boundary.bracket.low + boundary.bracket.high) / 2);
}

}  // namespace

Result<AdmissibleSet> admissible_set(const PortEquations& equations, const Rational& low, const Rational& high,
                                     const std::function<void(double)>& progress) {
  if (low > high) return bad_usage("the upper end of the parameter range is below the lower end", "write LOW:HIGH");
  const auto two_port = MBK_TRY(immittance(equations));
  const auto critical = MBK_TRY(critical_values(two_port, progress));
  const std::vector<Boundary> ends = boundaries(critical, low, high);
  const Search search(equations, two_port);

  std::vector<Rational> samples;
  std::vector<bool> inside;  // whether the piece after each boundary but the last holds
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const Rational &from = ends[i].bracket.high, &to = ends[i + 1].bracket.low;
    const Rational third = (to - from) / 3;
    samples.push_back(lti::simplest_between(from + third, to - third));
    inside.push_back(search.holds(samples.back()));
  }

  AdmissibleSet set;
  set.low = lti::to_double(low);
  set.high = lti::to_double(high);
  bool open = false;  // the last interval continues
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const bool before = i > 0 && inside[i - 1], after = i < inside.size() && inside[i];
    std::vector<Rational> beside;
    if (i > 0) beside.push_back(samples[i - 1]);
    if (i < samples.size()) beside.push_back(samples[i]);
    const std::optional<bool> here = search.holds(ends[i], beside, before || after);
    const bool of_range = i == 0 || i + 1 == ends.size();
    const AdmissibleEnd end{value_of(ends[i]), here, of_range};
    if (!of_range) set.critical.push_back(end.value);
    if (!before && !after && !here) set.undecided.push_back(end.value);
    if (open && before && after && here.value_or(false)) continue;
    if (open) set.intervals.back().high = end;
    open = after;
    if (after) {
      set.intervals.push_back({end, {}});
    } else if (!before && here.value_or(false)) {
      set.intervals.push_back({end, end});
    }
  }
  return set;
}

}  // namespace mbk::teleop
