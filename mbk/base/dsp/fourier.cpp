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

/// With Z the transform of a + j b: A_k = (Z_k + Z*_{n−k})/2, B_k = (Z_k − Z*_{n−k})/(2j).
Eigen::MatrixXcd directly(const Matrix& signals) {
  const Index n = signals.rows(), lines = n / 2 + 1;
  ComplexTransform transform(n);
  const Vector &re = transform.real(), &im = transform.imaginary();
  Eigen::MatrixXcd all(lines, signals.cols());
  for (Index first = 0; first < signals.cols(); first += 2) {
    const bool two = first + 1 < signals.cols();
    transform.real() = signals.col(first);
    if (two) {
      transform.imaginary() = signals.col(first + 1);
    } else {
      transform.imaginary().setZero();
    }
    transform.run();
    if (!two) {
      all.col(first) = lines_of(transform, lines);
      continue;
    }
    for (Index k = 0; k < lines; ++k) {
      const Index mirror = k == 0 ? 0 : n - k;
      all(k, first) = {0.5 * (re[k] + re[mirror]), 0.5 * (im[k] - im[mirror])};
      all(k, first + 1) = {0.5 * (im[k] + im[mirror]), 0.5 * (re[mirror] - re[k])};
    }
  }
  return all;
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
  return fourier_transforms(signal);
}

Eigen::MatrixXcd fourier_transforms(const Matrix& signals) {
  if (fast_length_below(signals.rows()) == signals.rows()) return directly(signals);
  Eigen::MatrixXcd all(signals.rows() / 2 + 1, signals.cols());
  for (Index k = 0; k < signals.cols(); ++k) all.col(k) = by_chirp(signals.col(k));
  return all;
}

}  // namespace mbk::dsp
