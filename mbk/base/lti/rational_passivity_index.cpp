#include "mbk/base/lti/rational_passivity_index.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/base/lti/half_planes.h"
#include "mbk/base/lti/hermitian.h"
#include "mbk/base/lti/positive_real.h"
#include "mbk/base/numeric/dense.h"

namespace mbk::lti {
namespace {

constexpr double kWidth = 1e-10;  // of the proven bounds, relative
constexpr int kMaxTests = 400;

/// The infimum over ω of λ_min(P(ω))/q(ω), with P Hermitian, q = factor·|d(jω)|² and P/q bounded, in the way of
/// Bruinsma & Steinbuch (1990): a level a little below the lowest value that was seen is tested exactly; where it
/// fails, the bands in which it does are searched for lower values.
class Infimum {
 public:
  Infimum(ComplexPolynomialMatrix P, const Polynomial& denominator, const Rational& factor)
      : P_(std::move(P)), denominator_(denominator), q_(squared_modulus(denominator) * Polynomial{factor}) {}

  [[nodiscard]] Result<PassivityIndex> find() {
    int zeros = 0;
    while (q_.coefficient(zeros).is_zero()) ++zeros;
    look(coefficients(zeros), 0.0);
    look(coefficients(q_.degree()), kInfinity);
    if (!std::isfinite(lowest_)) {
      return fail(ErrorKind::not_usable, "values at zero or infinite frequency exceed the range of a double");
    }
    std::optional<double> proven;
    for (int test = 0; test < kMaxTests; ++test) {
      const double width = scale_ > 0.0 ? kWidth * scale_ : kWidth;
      if (proven && lowest_ - *proven <= 1.5 * width) return PassivityIndex{lowest_, *proven, lowest_, RadPerSec(at_)};
      const double level = proven ? *proven + 0.5 * (lowest_ - *proven) : lowest_ - step_ * width;
      const auto below = bands_below(level);
      if (below.empty()) {
        proven = level;
      } else {
        descend(below, level);
      }
    }
    return fail(ErrorKind::not_usable,
                fmt::format("the minimum over all frequencies did not converge in {} steps", kMaxTests));
  }

 private:
  /// Where λ_min(P/q) < level.
  [[nodiscard]] std::vector<PositiveInterval> bands_below(double level) const {
    ComplexPolynomialMatrix A = P_;
    const Polynomial share = q_ * Polynomial{Rational(level)};
    for (Index i = 0; i < A.size(); ++i) A(i, i).re -= share;
    return indefinite_intervals(A, denominator_);
  }

  void descend(const std::vector<PositiveInterval>& below, double level) {
    for (const PositiveInterval& band : below) {
      const double low = std::sqrt(to_double(band.low.high));
      const double high = band.high ? std::sqrt(to_double(band.high->low)) : kInfinity;
      const double inside = std::sqrt(to_double(band.witness));
      look(inside);
      if (std::isinf(high)) {
        for (const double times : {2.0, 8.0, 64.0}) look(times * inside);
      } else {
        for (const double part : {0.25, 0.5, 0.75}) look(low + part * (high - low));
      }
    }
    if (lowest_ > level) {  // too narrow for a double to be inside: the test alone says that it is lower
      lowest_ = level;
      at_ = std::sqrt(to_double(below.front().witness));
      step_ *= 4.0;
    } else {
      step_ = 1.0;
    }
  }

  /// P and q at a frequency, of which a quotient is taken.
  struct Value {
    std::vector<std::pair<Rational, Rational>> P;
    Rational q;
  };

  void look(double omega) {
    if (!std::isfinite(omega)) return;
    const Rational exact_omega(omega);
    look(value([&](const Polynomial& p) { return p(exact_omega); }), omega);
  }

  /// The limits at zero and infinity are quotients of coefficients.
  [[nodiscard]] Value coefficients(int power) const {
    return value([&](const Polynomial& p) { return p.coefficient(power); });
  }

  template <class Take>
  [[nodiscard]] Value value(const Take& take) const {
    Value result{{}, take(q_)};
    for (Index i = 0; i < P_.size(); ++i) {
      for (Index j = 0; j < P_.size(); ++j) result.P.emplace_back(take(P_(i, j).re), take(P_(i, j).im));
    }
    return result;
  }

  void look(const Value& value, double omega) {
    if (value.q.is_zero()) return;  // a pole
    const Index n = P_.size();
    Eigen::MatrixXcd quotient(n, n);
    for (Index i = 0; i < n * n; ++i) {
      const auto& [re, im] = value.P[static_cast<std::size_t>(i)];
      quotient(i / n, i % n) = {to_double(re / value.q), to_double(im / value.q)};
    }
    if (!quotient.allFinite()) return;
    const Vector eigenvalues = numeric::hermitian_eigenvalues(quotient);
    const double smallest = eigenvalues[0];
    scale_ = std::max(scale_, eigenvalues.cwiseAbs().maxCoeff());
    if (smallest < lowest_) {
      lowest_ = smallest;
      at_ = omega;
    }
  }

  ComplexPolynomialMatrix P_;
  Polynomial denominator_, q_;
  double lowest_ = kInfinity, at_ = 0.0, scale_ = 0.0, step_ = 1.0;
};

tl::unexpected<Error> does_not_exist(const std::string& index, const std::string& why) {
  return fail(ErrorKind::not_usable, fmt::format("the {} does not exist: {}", index, why));
}

/// ν of a matrix under the name by which it is asked for.
Result<PassivityIndex> min_hermitian_part(const RationalMatrix& G, const std::string& name, const std::string& of) {
  const auto judged = MBK_TRY(positive_real(G));
  for (const auto condition :
       {PositiveRealCondition::no_right_poles, PositiveRealCondition::simple_poles, PositiveRealCondition::residues}) {
    if (!judged[condition].holds()) return does_not_exist(name, of + judged[condition].line());
  }
  const Polynomial denominator = common_denominator(G);
  return Infimum(scaled_hermitian_part(G, denominator), denominator, 2).find();
}

}  // namespace

Result<PassivityIndex> input_passivity_index(const RationalMatrix& G) {
  return min_hermitian_part(G, "input passivity index", "");
}

Result<PassivityIndex> output_passivity_index(const RationalMatrix& G) {
  const auto inverted = inverse(G);
  if (!inverted) return does_not_exist("output passivity index", inverted.error().message);
  return min_hermitian_part(*inverted, "output passivity index", "of the inverse, ");
}

Result<PassivityIndex> relative_passivity_index(const RationalMatrix& G) {
  const std::string name = "relative passivity index";
  if (G.size() < 1 || G.size() > kMaxPorts) {
    return bad_usage(fmt::format("the matrix has {} rows, but must have 1 to {}", G.size(), kMaxPorts));
  }
  const RationalMatrix one = RationalMatrix::scalar(G.size(), 1);
  const auto inverted = inverse(one + G);
  if (!inverted) return does_not_exist(name, "I + G has no inverse at any frequency");
  const RationalMatrix S = (one - G) * *inverted;
  const Polynomial denominator = common_denominator(S);
  const HalfPlaneCount poles = count_half_planes(denominator);
  if (poles.axis + poles.right > 0) return does_not_exist(name, "I + G has a zero with Re s ≥ 0");
  for (Index i = 0; i < S.size(); ++i) {
    for (Index j = 0; j < S.size(); ++j) {
      if (!S(i, j).is_proper()) return does_not_exist(name, "I + G is singular at infinite frequency");
    }
  }
  // R² = −inf λ_min(−S*S)
  const ComplexPolynomialMatrix minus_N = numerators_on_axis(RationalMatrix(S.size()) - S, denominator);
  const auto squared = MBK_TRY(Infimum(adjoint(minus_N) * numerators_on_axis(S, denominator), denominator, 1).find());
  const auto root = [](double value) { return std::sqrt(std::max(0.0, -value)); };
  return PassivityIndex{root(squared.value), root(squared.at_most), root(squared.at_least), squared.frequency};
}

}  // namespace mbk::lti
