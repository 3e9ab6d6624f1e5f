// Position with encoder noise → smooth position, velocity and acceleration, with the filters of Dyck (2013, §3.5.1).
//   usage: filter_a_signal
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>

#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/base/dsp/zero_phase.h"
#include "mbk/base/numeric/random.h"

namespace {

int report(const mbk::Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  return 1;
}

}  // namespace

int main() {
  // 20 s at 1 kHz: 10 mm at 0.8 Hz, and 20 µm of white noise, as from a coarse encoder.
  const mbk::Hertz rate(1000.0);
  const double amplitude = 0.010, noise = 20e-6, omega = 2.0 * std::numbers::pi * 0.8;  // [m], [m], [rad/s]
  const mbk::Index samples = 20000;
  mbk::Matrix position(samples, 1);
  mbk::numeric::Random random(1);
  for (mbk::Index i = 0; i < samples; ++i) {
    position(i, 0) = amplitude * std::sin(omega * static_cast<double>(i) / rate.value) + noise * random.normal();
  }

  // A polynomial of order 6 through 101 samples, and its derivatives at the centre.
  const mbk::dsp::SavitzkyGolay smoothing{6, 101};
  const auto cutoff = mbk::dsp::savitzky_golay_cutoff(smoothing, rate);
  if (!cutoff) return report(cutoff.error());
  std::printf("Savitzky-Golay N 6 W 101: -3 dB at %.2f Hz\n", cutoff->value);

  // Then a Butterworth low-pass of order 5 at 5 Hz, forward and backward: no delay, half the amplitude at 5 Hz.
  const auto lowpass = mbk::dsp::butterworth_lowpass(5, mbk::Hertz(5.0), rate);
  if (!lowpass) return report(lowpass.error());

  const char* const names[] = {"position", "velocity", "acceleration"};
  const char* const units[] = {"m", "m/s", "m/s^2"};
  for (int derivative = 0; derivative <= 2; ++derivative) {
    const auto smooth = mbk::dsp::savitzky_golay(smoothing, derivative, position, rate);
    if (!smooth) return report(smooth.error());
    const auto filtered = mbk::dsp::filter_zero_phase(*lowpass, *smooth);
    if (!filtered) return report(filtered.error());

    // Row i belongs to sample i + 50. The truth: the d-th derivative of A sin ωt is A ωᵈ sin(ωt + dπ/2).
    const double scale = amplitude * std::pow(omega, derivative);
    double squares = 0.0;
    const mbk::Index edge = 500;  // half a second at each end, where a zero-phase filter has data on one side only
    for (mbk::Index i = edge; i < filtered->rows() - edge; ++i) {
      const double t = static_cast<double>(i + smoothing.half_window()) / rate.value;
      const double truth = scale * std::sin(omega * t + derivative * std::numbers::pi / 2.0);
      squares += std::pow((*filtered)(i, 0) - truth, 2);
    }
    const double rms = std::sqrt(squares / static_cast<double>(filtered->rows() - 2 * edge));
    std::printf("%-13s amplitude %.5f %s, rms error %.2e %s (%.3f %%)\n", names[derivative], scale, units[derivative],
                rms, units[derivative], 100.0 * rms / scale);
  }
  return 0;
}
