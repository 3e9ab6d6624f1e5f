#include "mbk/base/dsp/fourier.h"

#include <cmath>
#include <complex>
#include <numbers>

#include "mbk/base/dsp/complex_transform.h"
#include "mbk/base/dsp/spectrum.h"

namespace mbk::dsp {
namespace {

Eigen::VectorXcd lines_of(ComplexTransform& transform, Index lines) {
  Eigen::VectorXcd values(lines);
  values.real() = transform.real().head(lines);
  values.imag() = transform.imaginary().head(lines);
  return values;
}

Eigen::VectorXcd directly(const Vector& signal) {
  ComplexTransform transform(signal.size());
  transform.real() = signal;
  transform.imaginary().setZero();
  transform.run();
  return lines_of(transform, signal.size() / 2 + 1);
}

/// e^(jπ i²/n), i = 0 … n − 1.
Eigen::VectorXcd chirp_of(Index n) {
  Eigen::VectorXcd chirp(n);
  for (Index i = 0; i < n; ++i) {
    chirp[i] = std::polar(1.0, std::numbers::pi * static_cast<double>(i * i % (2 * n)) / static_cast<double>(n));
  }
  return chirp;
}

Eigen::VectorXcd by_chirp(const Vector& signal) {
  const Index n = signal.size(), lines = n / 2 + 1, length = fast_length_above(n + lines);
  const Eigen::VectorXcd chirp = chirp_of(n);
  ComplexTransform transform(length);
  const auto transformed = [&](const Eigen::VectorXcd& values) {
    transform.real() = values.real();
    transform.imaginary() = values.imag();
    transform.run();
    return lines_of(transform, length);
  };
  Eigen::VectorXcd turned = Eigen::VectorXcd::Zero(length), kernel = Eigen::VectorXcd::Zero(length);
  turned.head(n) = signal.cwiseProduct(chirp.conjugate());
  kernel.head(lines) = chirp.head(lines);
  kernel.tail(n - 1) = chirp.tail(n - 1).reverse();  // indices below zero
  const Eigen::VectorXcd product = transformed(turned).cwiseProduct(transformed(kernel)) / static_cast<double>(length);
  return transformed(product.conjugate()).head(lines).cwiseProduct(chirp.head(lines)).conjugate();  // the inverse
}

}  // namespace

Eigen::VectorXcd fourier_transform(const Vector& signal) {
  const Index n = signal.size();
  return fast_length_below(n) == n ? directly(signal) : by_chirp(signal);
}

}  // namespace mbk::dsp
