#include "mbk/base/dsp/fourier.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "mbk/base/dsp/spectrum.h"

namespace mbk::dsp {
namespace {

Eigen::VectorXcd directly(const Vector& signal) {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  Eigen::VectorXcd transform;
  fft.fwd(transform, signal);
  return transform;
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
  Eigen::VectorXcd turned = Eigen::VectorXcd::Zero(length), kernel = Eigen::VectorXcd::Zero(length), a, b;
  turned.head(n) = signal.cwiseProduct(chirp.conjugate());
  kernel.head(lines) = chirp.head(lines);
  kernel.tail(n - 1) = chirp.tail(n - 1).reverse();  // indices below zero
  Eigen::FFT<double> fft;
  fft.fwd(a, turned);
  fft.fwd(b, kernel);
  fft.inv(turned, Eigen::VectorXcd(a.cwiseProduct(b)));
  return turned.head(lines).cwiseProduct(chirp.head(lines).conjugate());
}

}  // namespace

Eigen::VectorXcd fourier_transform(const Vector& signal) {
  const Index n = signal.size();
  return n > 1 && fast_length_below(n) == n ? directly(signal) : by_chirp(signal);
}

}  // namespace mbk::dsp
