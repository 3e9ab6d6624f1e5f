#include "mbk/teleop/two_port.h"

#include <fmt/format.h>

#include <utility>

namespace mbk::teleop {
namespace {

using lti::RationalFunction;

/// Which of V₁, V₂, I₁, I₂ (0 to 3) a form gives, and from which.
struct Variables {
  std::array<std::size_t, 2> given, from;
};

constexpr Variables variables(Form form) {
  switch (form) {
    case Form::y:
      return {{2, 3}, {0, 1}};
    case Form::h:
      return {{0, 3}, {2, 1}};
    case Form::g:
      return {{2, 1}, {0, 3}};
    case Form::z:
      break;
  }
  return {{0, 1}, {2, 3}};
}

template <class Value>
using Equations = std::array<std::array<Value, 4>, 2>;

/// The columns of `given` solved for: given = −adj/det · columns · from, by Cramer's rule.
template <class Value>
struct Solved {
  std::array<std::array<Value, 2>, 2> numerator;
  Value determinant;
};

template <class Value>
Solved<Value> solve(const Equations<Value>& rows, Form form) {
  const auto [given, from] = variables(form);
  const Value &a = rows[0][given[0]], &b = rows[0][given[1]], &c = rows[1][given[0]], &d = rows[1][given[1]];
  Solved<Value> solved;
  solved.determinant = a * d - b * c;
  for (std::size_t j = 0; j < 2; ++j) {
    const Value &e = rows[0][from[j]], &f = rows[1][from[j]];
    solved.numerator[0][j] = b * f - d * e;
    solved.numerator[1][j] = c * e - a * f;
  }
  return solved;
}

tl::unexpected<Error> no_form(std::string_view form) {
  return fail(ErrorKind::not_usable, fmt::format("the two-port has no {} matrix", form),
              "write it in a form that exists: z, y, h or g");
}

Result<TwoPort> in_form(const Equations<RationalFunction>& rows, Form form) {
  const auto solved = solve(rows, form);
  if (solved.determinant.is_zero()) return no_form(word_of(form));
  TwoPort two_port{form, lti::RationalMatrix(2)};
  for (const Index i : {0, 1}) {
    for (const Index j : {0, 1}) {
      two_port.matrix(i, j) =
          solved.numerator[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] / solved.determinant;
    }
  }
  return two_port;
}

/// M from − given = 0
Equations<RationalFunction> equations(const TwoPort& two_port) {
  const auto [given, from] = variables(two_port.form);
  Equations<RationalFunction> rows;
  for (const std::size_t i : {0, 1}) {
    rows[i][given[i]] = RationalFunction(Polynomial{-1});
    for (const std::size_t j : {0, 1}) {
      rows[i][from[j]] = two_port.matrix(static_cast<Index>(i), static_cast<Index>(j));
    }
  }
  return rows;
}

ParametricPolynomial common_factor(const ParametricPolynomial& a, const ParametricPolynomial& b) {
  if (a.is_zero()) return b;
  if (b.is_zero()) return a;
  return eliminate(a, b).common;
}

}  // namespace

Result<TwoPort> convert(const TwoPort& two_port, Form form) {
  return in_form(equations(two_port), form);
}

TwoPort exchanged(const TwoPort& two_port) {
  const auto other = [](Form form) {
    if (form == Form::h) return Form::g;
    return form == Form::g ? Form::h : form;
  };
  TwoPort turned{other(two_port.form), lti::RationalMatrix(2)};
  for (const Index i : {0, 1}) {
    for (const Index j : {0, 1}) turned.matrix(i, j) = two_port.matrix(1 - i, 1 - j);
  }
  return turned;
}

Result<TwoPort> as_impedance_at(const TwoPort& two_port, Port port) {
  const Form hybrid = port == Port::one ? Form::h : Form::g;
  for (const Form form : {Form::z, hybrid}) {
    if (auto converted = convert(two_port, form)) return converted;
  }
  return no_form(fmt::format("z or {}", word_of(hybrid)));
}

Result<TwoPort> with_shortage(const TwoPort& two_port, Port port, const Rational& a) {
  const Index i = port == Port::one ? 0 : 1;
  auto converted = as_impedance_at(two_port, port);
  if (converted) converted->matrix(i, i) = converted->matrix(i, i) - RationalFunction(Polynomial{a});
  return converted;
}

PortEquations PortEquations::of(const TwoPort& two_port) {
  const auto [given, from] = variables(two_port.form);
  PortEquations result;
  for (const std::size_t i : {0, 1}) {
    const auto& left = two_port.matrix(static_cast<Index>(i), 0);
    const auto& right = two_port.matrix(static_cast<Index>(i), 1);
    const Polynomial shared = lti::gcd(left.denominator(), right.denominator());
    const Polynomial left_factor = lti::divide(right.denominator(), shared).quotient;
    const Polynomial right_factor = lti::divide(left.denominator(), shared).quotient;
    result.rows[i][given[i]] = ParametricPolynomial::of(-(left.denominator() * left_factor));
    result.rows[i][from[0]] = ParametricPolynomial::of(left.numerator() * left_factor);
    result.rows[i][from[1]] = ParametricPolynomial::of(right.numerator() * right_factor);
  }
  return result;
}

PortEquations PortEquations::with_shortage(Port port, const Polynomial& a) const {
  // V = V′ + a I, where V′ is the effort of the passive part of the termination
  const std::size_t effort = port == Port::one ? 0 : 1;
  PortEquations result = *this;
  for (auto& row : result.rows) row[effort + 2] = row[effort + 2] + row[effort] * ParametricPolynomial({a});
  return result;
}

Result<TwoPort> PortEquations::at(const Rational& k) const {
  Equations<RationalFunction> values;
  for (const std::size_t i : {0, 1}) {
    for (std::size_t j = 0; j < 4; ++j) values[i][j] = RationalFunction(rows[i][j].at(k));
  }
  for (const Form form : kForms) {
    if (auto two_port = in_form(values, form)) return two_port;
  }
  return no_form("z, y, h or g");
}

Result<ParametricTwoPort> immittance(const PortEquations& equations) {
  for (const Form form : kForms) {
    auto solved = solve(equations.rows, form);
    if (solved.determinant.is_zero()) continue;
    ParametricPolynomial common = solved.determinant;
    for (const auto& row : solved.numerator) {
      for (const ParametricPolynomial& entry : row) common = common_factor(common, entry);
    }
    common = split_content(common).part;
    if (common.degree() > 0) {
      solved.determinant = quotient(solved.determinant, common);
      for (auto& row : solved.numerator) {
        for (ParametricPolynomial& entry : row) entry = quotient(entry, common);
      }
    }
    return ParametricTwoPort{form, solved.numerator, solved.determinant};
  }
  return no_form("z, y, h or g");
}

Eigen::Matrix2cd immittance(const Eigen::Matrix<std::complex<double>, 2, 4>& equations, Form form) {
  Equations<std::complex<double>> rows;
  for (const std::size_t i : {0, 1}) {
    for (std::size_t j = 0; j < 4; ++j) rows[i][j] = equations(static_cast<Index>(i), static_cast<Index>(j));
  }
  const auto solved = solve(rows, form);
  Eigen::Matrix2cd matrix;
  for (const std::size_t i : {0, 1}) {
    for (const std::size_t j : {0, 1}) {
      matrix(static_cast<Index>(i), static_cast<Index>(j)) = solved.numerator[i][j] / solved.determinant;
    }
  }
  return matrix;
}

}  // namespace mbk::teleop
