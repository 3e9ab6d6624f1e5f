#include "mbk/measure/analyse/describe_transfer_function.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/polynomial_roots.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/analyse/decimation.h"

namespace mbk::analyse {
namespace {

using std::numbers::pi;

/// √q with P(χ² of two degrees of freedom < q) = 0.95: q = −2 ln 0.05.
const double kRegion95 = std::sqrt(-2.0 * std::log(0.05));

/// Fills in what follows from value, phase and relative covariance.
void describe_uncertainty(FrequencyResponse& response) {
  const Index n = response.size();
  response.magnitude95.resize(n, 2);
  response.phase_half_width.resize(n);
  response.real_half_width.resize(n);
  response.region95.resize(n, 3);
  for (Index i = 0; i < n; ++i) {
    const std::complex<double> h = response.value[i];
    const double magnitude = std::abs(h), angle = std::arg(h);
    const double p = response.relative(i, 0), c = response.relative(i, 1), q = response.relative(i, 2);
    const auto [low, high] = numeric::positive_interval95(magnitude, magnitude * std::sqrt(p));
    response.magnitude95.row(i) << low, high;
    response.phase_half_width[i] = numeric::kNormal95 * std::sqrt(q);
    // δH = H (δln|H| + jδφ): the covariance turned by arg H and scaled by |H|.
    const double real_part = p * h.real() * h.real() - 2.0 * c * h.real() * h.imag() + q * h.imag() * h.imag();
    response.real_half_width[i] = numeric::kNormal95 * std::sqrt(std::max(0.0, real_part));
    const double middle = 0.5 * (p + q), spread = std::hypot(0.5 * (p - q), c);
    response.region95.row(i) << kRegion95 * magnitude * std::sqrt(middle + spread),
        kRegion95 * magnitude * std::sqrt(std::max(0.0, middle - spread)), angle + 0.5 * std::atan2(2.0 * c, p - q);
  }
}

/// (jω)^power · H^sign with sign ±1: relative errors keep their size.
FrequencyResponse transformed(const FrequencyResponse& from, int sign, int power) {
  FrequencyResponse to = from;
  for (Index i = 0; i < from.size(); ++i) {
    const std::complex<double> jw(0.0, 2.0 * pi * from.frequency[i]);
    to.value[i] = std::pow(jw, power) * (sign > 0 ? from.value[i] : 1.0 / from.value[i]);
    to.phase[i] = sign * from.phase[i] + power * 0.5 * pi;
  }
  describe_uncertainty(to);
  return to;
}

}  // namespace

FrequencyResponse frequency_response(const TransferFunction& model, const Matrix& covariance, const Vector& frequency) {
  const bool continuous = model.sample_time == 0.0;
  const Index n = model.poles(), q = model.numerator.size(), count = frequency.size();
  FrequencyResponse response;
  response.frequency = frequency;
  response.value.resize(count);
  response.phase.resize(count);
  response.relative.resize(count, 3);
  double last = 0.0;
  for (Index i = 0; i < count; ++i) {
    const double w = 2.0 * pi * frequency[i];
    const std::complex<double> x = continuous ? std::complex<double>(0.0, w) : std::polar(1.0, -w * model.sample_time);
    const std::complex<double> above = numeric::polynomial_at(model.numerator, x);
    const std::complex<double> below = numeric::polynomial_at(model.denominator, x);
    const std::complex<double> rational = above / below;
    const double angle = std::arg(rational);
    const double turns = i == 0 ? 0.0 : std::round((last - angle) / (2.0 * pi));
    last = angle + 2.0 * pi * turns;
    response.phase[i] = last - w * model.delay;
    response.value[i] = rational * std::polar(1.0, -w * model.delay);
    Matrix gradient(2, n + q);  // of ln|H| and of the phase
    std::complex<double> power = continuous ? 1.0 : x;
    for (Index k = 0; k < n; ++k, power *= x) gradient.col(k) << -(power / below).real(), -(power / below).imag();
    power = 1.0;
    for (Index k = 0; k < q; ++k, power *= x) gradient.col(n + k) << (power / above).real(), (power / above).imag();
    const Eigen::Matrix2d spread = gradient * covariance * gradient.transpose();
    response.relative.row(i) << std::max(0.0, spread(0, 0)), spread(0, 1), std::max(0.0, spread(1, 1));
  }
  describe_uncertainty(response);
  return response;
}

Vector frequencies_of(const TransferFunctionIdentification& found, bool within_band) {
  constexpr double kBeyond = 3.0, kPeriods = 8.0;
  constexpr Index kPoints = 200, kHalfTurn = 24;
  double low = found.band_low, high = found.band_high;
  // A slow or constant part lies below what the record resolves.
  if (low == 0.0 && high > 0.0 && found.samples > 0) {
    low = kPeriods * static_cast<double>(found.experiments) / (static_cast<double>(found.samples) * found.sample_time);
  }
  std::vector<Root> roots = found.poles;
  roots.insert(roots.end(), found.zeros.begin(), found.zeros.end());
  const bool band = low > 0.0 && high > low;
  if (!band || !within_band) {
    for (const Root& root : found.poles) {
      if (!(root.frequency > 0.0)) continue;
      low = low > 0.0 ? std::min(low, root.frequency) : root.frequency;
      high = std::max(high, root.frequency);
    }
    low /= kBeyond;
    high *= kBeyond;
  }
  const double half_rate = 0.5 / found.sample_time;
  if (half_rate > 0.0 && std::isfinite(half_rate)) high = std::min(high, half_rate);
  if (!(low > 0.0)) low = high / 1000.0;
  low = std::min(low, 0.1 * high);
  std::vector<double> all;
  for (Index i = 0; i < kPoints; ++i) {
    all.push_back(low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(kPoints - 1)));
  }
  all.back() = high;
  for (const Root& root : roots) {
    // Of an oscillation equal steps along its circle in the complex plane.
    for (Index k = 1 - kHalfTurn; root.pair && k < kHalfTurn; ++k) {
      const double off = std::tan(0.5 * pi * static_cast<double>(k) / static_cast<double>(kHalfTurn));
      const double f = root.frequency * (1.0 + off * std::min(std::abs(root.damping), 0.1));
      if (f > low && f < high) all.push_back(f);
    }
  }
  std::ranges::sort(all);
  constexpr double kSame = 1e-9;
  const auto same = [](double a, double b) { return b - a <= kSame * b; };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  return Vector::Map(all.data(), std::ssize(all));
}

Result<InvertedAdmittance> inverted(const TransferFunctionIdentification& found, AdmittanceOutput output) {
  const TransferFunction& model = found.model;
  if (model.delay > 0.0) {
    return bad_usage(fmt::format("the inverse of a delay of {:g} s is not causal", model.delay), "omit --delay");
  }
  const int derivatives = output == AdmittanceOutput::position ? 0 : output == AdmittanceOutput::velocity ? 1 : 2;
  InvertedAdmittance inverse;
  inverse.output = output;
  inverse.motion = found.input_unit == "N"     ? Motion::translation
                   : found.input_unit == "N.m" ? Motion::rotation
                                               : Motion::unknown;
  const FrequencyResponse admittance = frequency_response(model, found.covariance, frequencies_of(found, true));
  inverse.stiffness = transformed(admittance, -1, derivatives);
  inverse.impedance = transformed(admittance, -1, derivatives - 1);
  inverse.unstable = std::ranges::any_of(found.zeros, [](const Root& zero) { return zero.value.real() > 0.0; });
  const Index n = model.poles();
  if (model.sample_time == 0.0 && model.zeros() == 0 && n + derivatives == 2) {
    const double b = model.numerator[0];
    std::optional<Estimate>* const terms[] = {&inverse.K, &inverse.B, &inverse.M};
    for (Index k = 0; k <= n; ++k) {
      Vector gradient = Vector::Zero(n + 1);  // of a_k/b₀
      if (k < n) gradient[k] = 1.0 / b;
      gradient[n] = -model.denominator[k] / (b * b);
      *terms[k + derivatives] =
          Estimate{model.denominator[k] / b, std::sqrt(std::max(0.0, gradient.dot(found.covariance * gradient)))};
    }
  }
  return inverse;
}

Result<TransferFunctionFindings> describe(const TransferFunctionIdentification& found,
                                          std::optional<AdmittanceOutput> admittance_to) {
  TransferFunctionFindings findings;
  findings.response = frequency_response(found.model, found.covariance, frequencies_of(found, false));
  if (admittance_to) {
    auto inverse = MBK_TRY(inverted(found, *admittance_to));
    findings.inverse = std::move(inverse);
  }
  Index samples = 0;
  std::vector<const SimulatedOutput*> shown;  // one after the other: of several recordings with one clock the first
  for (const SimulatedOutput& one : found.simulated) {
    if (one.time.size() == 0 || (!shown.empty() && one.time[0] <= shown.back()->time[shown.back()->time.size() - 1])) {
      continue;
    }
    shown.push_back(&one);
    samples += one.time.size();
  }
  Vector time(samples);
  Matrix values(samples, 2);
  std::vector<Rows> pieces;
  Index row = 0;
  for (const SimulatedOutput* const segment : shown) {
    const SimulatedOutput& one = *segment;
    const Index n = one.time.size();
    time.segment(row, n) = one.time;
    values.block(row, 0, n, 1) = one.measured;
    values.block(row, 1, n, 1) = one.simulated;
    pieces.push_back({row, row + n, row});
    row += n;
  }
  const Series drawn = decimated(time, values, pieces, Decimation::extremes);
  findings.drawn = {drawn.time, drawn.values.col(0), drawn.values.col(1)};
  return findings;
}

}  // namespace mbk::analyse
