#pragma once

#include <cstdint>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/dsp/causal_filter.h"
#include "mbk/simulate/laboratory/noise.h"

namespace mbk::laboratory {

/// The voltage between two surface electrodes.
struct SurfaceEmgOptions {
  double largest = 500e-6;  ///< σ: rms at maximal activation [V] ≥ 0
  double noise = 3e-6;      ///< of electrodes and amplifier, white, standard deviation [V] ≥ 0
  double hum = 0.0;         ///< amplitude of mains hum [V] ≥ 0
  Hertz mains{50.0};        ///< > 0
  Hertz lowest{20.0};       ///< band of the muscle's signal, −3 dB; 0 < lowest < highest < rate/2
  Hertz highest{450.0};
};

/// Raw EMG as modulated noise (Hogan & Mann 1980, IEEE Trans Biomed Eng 27:382):
///   v = σ a w + noise + hum
/// a is the activation from 0 to 1, w Gaussian noise of variance 1 in the band: white noise behind a Butterworth
/// high-pass and a low-pass of fourth order each. The rms of the muscle's signal is proportional to the activation.
class SurfaceEmg {
 public:
  /// @param channel  0 … 9, which has noise of its own; the hum is the same for all
  /// @fails  usage: a limit stated in SurfaceEmgOptions is violated; the rate is not above zero.
  [[nodiscard]] static Result<SurfaceEmg> create(const SurfaceEmgOptions& options, Hertz rate, std::uint64_t seed,
                                                 std::uint32_t channel);

  /// The voltage at the next sample [V].
  double step(double activation) noexcept;

 private:
  SurfaceEmg(const SurfaceEmgOptions& options, Hertz rate, const dsp::SectionCascade& band, std::uint64_t seed,
             std::uint32_t channel);

  SurfaceEmgOptions options_;
  double sample_time_;
  dsp::CausalFilter band_;
  WhiteNoise source_, noise_;
  double samples_ = 0.0;
};

}  // namespace mbk::laboratory
