#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/exploration_trial.h"

namespace mbk {

/// Method of estimating a frequency response from signals.
enum class FrequencyResponseMethod {
  welch,             ///< averaged spectra of segments
  robust,            ///< periods and realisations of a periodic perturbation
  fast,              ///< periods of one realisation, distortion from its empty lines
  local_polynomial,  ///< a polynomial across neighbouring frequencies, any perturbation
};

[[nodiscard]] constexpr auto word_table(FrequencyResponseMethod) {
  using enum FrequencyResponseMethod;
  return std::to_array<Word<FrequencyResponseMethod>>(
      {{welch, "welch"}, {robust, "robust"}, {fast, "fast"}, {local_polynomial, "local-polynomial"}});
}

/// Output at lines that the perturbation does not excite, after subtracting the input there times G. Relative to the
/// output at the excited lines; root mean squares over the lines and outputs, each output relative to its own.
struct Distortion {
  Index lines = 0;
  double relative = 0;          ///< of the corrected output
  double uncorrected = 0;       ///< of the uncorrected output
  double noise = 0;             ///< of the noise in the mean output, from the differences between periods
  double residual_noise = 0;    ///< the same without the part explained by the input noise
  double output_amplitude = 0;  ///< what they are relative to: |Y| of the transform over its length [output's unit]
  double p = 1;                 ///< p-value if there is only output noise (F test)
  double residual_p = 1;        ///< the same by `residual_noise`
  /// Significant against both noises: in a compliant loop, subtracting the input part adds the noise of the input.
  [[nodiscard]] bool detected() const { return p < 0.01 && residual_p < 0.01; }
  /// Significant against the noise that the input does not explain, but not against that of the output.
  [[nodiscard]] bool trace() const { return !detected() && residual_p < 0.01; }
};

/// Periods and realisations of a periodic perturbation.
struct PeriodicFacts {
  double period_s = 0;
  bool period_found = true;                ///< otherwise it was given
  Index realisations = 0;                  ///< different ones
  Index periods = 0;                       ///< of the realisation with the fewest
  Index dropped_periods = 0;               ///< transient periods at the beginning that differ from the others
  bool orthogonal = false;                 ///< experiments belong together in groups of n_u with orthogonal references
  Index skipped_lines = 0;                 ///< excited, but not along every input, or weakly
  Index weak_lines = 0;                    ///< of these, the ones with too little power
  bool odd = false;                        ///< all excited lines are odd multiples of 1/period
  std::optional<double> total_over_noise;  ///< variance over realisations divided by that over periods, ratio of sums
  double total_over_noise_p = 1;           ///< p-value for a linear limb
  std::optional<Distortion> even, odd_lines;  ///< at empty even and odd lines; absent if there are none
};

/// Matrix of responses G(f) from n_u inputs to n_y outputs, Y = G U + V, estimated without a model, with one entry of
/// every list per frequency. Entries of G are in column order: response i + j n_y is from input j to output i.
struct FrequencyResponseEstimate {
  FrequencyResponseMethod method = FrequencyResponseMethod::welch;
  std::string method_rule;  ///< why, in words
  std::string assumes;      ///< basis of the intervals, in words
  std::vector<SignalLabel> inputs, outputs;
  bool by_reference = false;                 ///< projected on the reference, valid also in closed loop
  Vector frequency;                          ///< N [Hz], rising, > 0
  std::vector<Eigen::MatrixXcd> response;    ///< G, n_y×n_u [unit of the output per unit of the input]
  std::vector<Eigen::MatrixXcd> covariance;  ///< (n_y n_u)², E[δg δgᴴ] of g = vec G, circular: noise and distortion
  std::vector<Eigen::MatrixXcd> noise_covariance;  ///< the same for noise only, from the periods; or empty
  std::optional<PeriodicFacts> periodic;
  Vector degrees_of_freedom;             ///< complex, of that covariance
  Matrix magnitude_low, magnitude_high;  ///< N×(n_y n_u), ends of the 95 % interval of |G|
  Matrix phase_half_width;               ///< N×(n_y n_u), of the 95 % interval of arg G [rad], π where it is unknown
  Matrix radius95;                       ///< N×(n_y n_u), radius of the 95 % disc of G around the estimate
  /// N×n_y, γ² of each output with all inputs or, for local polynomials in a loop, with the reference; empty if the
  /// method gives none.
  Matrix multiple_coherence;
  Matrix partial_coherence;  ///< N×(n_y n_u), γ² of output and input without what the other inputs explain
  double averages = 0;       ///< number of independent segments or experiments averaged
  [[nodiscard]] Index size() const { return frequency.size(); }
};

}  // namespace mbk
