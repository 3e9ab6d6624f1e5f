#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace mbk::reliability {

/// A number with its first and second derivatives by so many `Variables`: what is computed with jets has exact
/// derivatives.
template <std::size_t Variables>
struct Jet {
  double value = 0.0;
  std::array<double, Variables> gradient{};
  std::array<double, Variables*(Variables + 1) / 2> hessian{};  ///< the lower triangle, row by row

  Jet() = default;
  Jet(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor): a number is a constant jet

  /// The variable of that index, at that value.
  static Jet variable(double value, std::size_t index) {
    Jet jet(value);
    jet.gradient[index] = 1.0;
    return jet;
  }
  [[nodiscard]] double second(std::size_t i, std::size_t k) const {
    return i >= k ? hessian[i * (i + 1) / 2 + k] : hessian[k * (k + 1) / 2 + i];
  }

  Jet& operator+=(const Jet& b) {
    value += b.value;
    for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] += b.gradient[i];
    for (std::size_t i = 0; i < hessian.size(); ++i) hessian[i] += b.hessian[i];
    return *this;
  }
  Jet& operator-=(const Jet& b) {
    value -= b.value;
    for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] -= b.gradient[i];
    for (std::size_t i = 0; i < hessian.size(); ++i) hessian[i] -= b.hessian[i];
    return *this;
  }
  Jet& operator*=(double factor) {
    value *= factor;
    for (double& one : gradient) one *= factor;
    for (double& one : hessian) one *= factor;
    return *this;
  }
  friend Jet operator+(Jet a, const Jet& b) { return a += b; }
  friend Jet operator-(Jet a, const Jet& b) { return a -= b; }
  friend Jet operator*(Jet a, double b) { return a *= b; }
  friend Jet operator*(double a, Jet b) { return b *= a; }
  friend Jet operator*(const Jet& a, const Jet& b) {
    Jet product(a.value * b.value);
    for (std::size_t i = 0, at = 0; i < Variables; ++i) {
      product.gradient[i] = a.value * b.gradient[i] + b.value * a.gradient[i];
      for (std::size_t k = 0; k <= i; ++k, ++at) {
        product.hessian[at] = a.value * b.hessian[at] + b.value * a.hessian[at] + a.gradient[i] * b.gradient[k] +
                              a.gradient[k] * b.gradient[i];
      }
    }
    return product;
  }
  /// f(a) where f′ and f″ at a are known.
  [[nodiscard]] static Jet chain(const Jet& a, double f, double first, double second) {
    Jet made(f);
    for (std::size_t i = 0, at = 0; i < Variables; ++i) {
      made.gradient[i] = first * a.gradient[i];
      for (std::size_t k = 0; k <= i; ++k, ++at) {
        made.hessian[at] = first * a.hessian[at] + second * a.gradient[i] * a.gradient[k];
      }
    }
    return made;
  }
  friend Jet operator/(const Jet& a, const Jet& b) {
    const double inverse = 1.0 / b.value;
    return a * chain(b, inverse, -inverse * inverse, 2.0 * inverse * inverse * inverse);
  }
  friend Jet log(const Jet& a) { return chain(a, std::log(a.value), 1.0 / a.value, -1.0 / (a.value * a.value)); }
};

}  // namespace mbk::reliability
