#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/exploration_trial.h"

namespace mbk {

/// How a frequency response is estimated from signals.
enum class FrequencyResponseMethod { welch };

[[nodiscard]] constexpr auto word_table(FrequencyResponseMethod) {
  using enum FrequencyResponseMethod;
  return std::to_array<Word<FrequencyResponseMethod>>({{welch, "welch"}});
}

/// Matrix of responses G(f) from n_u inputs to n_y outputs, Y = G U + V, as the data show it without a model, with one
/// entry of every list for each frequency. Entries of G stand in the order of its columns: response i + j n_y is
/// from input j to output i.
struct FrequencyResponseEstimate {
  FrequencyResponseMethod method = FrequencyResponseMethod::welch;
  std::string method_rule;  ///< why, in words
  std::string assumes;      ///< what the intervals rest on, in words
  std::vector<SignalLabel> inputs, outputs;
  bool by_reference = false;                 ///< projected on the reference, which holds in closed loop too
  Vector frequency;                          ///< N [Hz], rising, > 0
  std::vector<Eigen::MatrixXcd> response;    ///< G, n_y×n_u [unit of the output per unit of the input]
  std::vector<Eigen::MatrixXcd> covariance;  ///< (n_y n_u)², E[δg δgᴴ] of g = vec G, circular: noise and distortion
  Vector degrees_of_freedom;                 ///< complex, of that covariance
  Matrix magnitude_low, magnitude_high;      ///< N×(n_y n_u), ends of the 95 % interval of |G|
  Matrix radius95;                           ///< N×(n_y n_u), of the disc around the estimate that holds G with 95 %
  Matrix multiple_coherence;  ///< N×n_y, γ² of each output with all inputs; empty where the method gives none
  Matrix partial_coherence;   ///< N×(n_y n_u), γ² of output and input without what the other inputs explain
  double averages = 0;        ///< independent segments, or experiments, that were averaged
  [[nodiscard]] Index size() const { return frequency.size(); }
};

}  // namespace mbk
