
#include "mbk/base/core/units.h"
#include "mbk/present/result/exploration_parts_json.h"

namespace mbk::result {
namespace {

Json labels_json(const std::vector<SignalLabel>& labels) {
  Json array = Json::array();
  for (const SignalLabel& label : labels) array.push_back({{"name", label.name}, {"unit", label.unit}});
  return array;
}

Json distortion_json(const Distortion& distortion) {
  return {{"lines", distortion.lines},
          {"relative", number(distortion.relative)},
          {"uncorrected", number(distortion.uncorrected)},
          {"noise", number(distortion.noise)},
          {"residual_noise", number(distortion.residual_noise)},
          {"output_amplitude", number(distortion.output_amplitude)},
          {"p", number(distortion.p)},
          {"residual_p", number(distortion.residual_p)},
          {"trace", distortion.trace()},
          {"detected", distortion.detected()}};
}

Json periodic_json(const PeriodicFacts& facts) {
  Json json = {{"period_s", number(facts.period_s)},
               {"period_found", facts.period_found},
               {"realisations", facts.realisations},
               {"periods", facts.periods},
               {"dropped_periods", facts.dropped_periods},
               {"orthogonal", facts.orthogonal},
               {"skipped_lines", facts.skipped_lines},
               {"weak_lines", facts.weak_lines},
               {"odd_lines_only", facts.odd}};
  if (facts.total_over_noise) {
    json["total_over_noise"] = {{"ratio", number(*facts.total_over_noise)}, {"p", number(facts.total_over_noise_p)}};
  }
  if (facts.even) json["even_distortion"] = distortion_json(*facts.even);
  if (facts.odd_lines) json["odd_distortion"] = distortion_json(*facts.odd_lines);
  return json;
}

}  // namespace

Json frequency_response_json(const FrequencyResponseEstimate& found) {
  const auto outputs = static_cast<Index>(found.outputs.size());
  const auto inputs = static_cast<Index>(found.inputs.size());
  Json json = {{"method", word_of(found.method)},
               {"method_rule", found.method_rule},
               {"intervals_assume", found.assumes},
               {"by_reference", found.by_reference},
               {"averages", number(found.averages)},
               {"inputs", labels_json(found.inputs)},
               {"outputs", labels_json(found.outputs)},
               {"frequency_hz", list(found.frequency)},
               {"degrees_of_freedom", list(found.degrees_of_freedom)}};
  if (found.periodic) json["periodic"] = periodic_json(*found.periodic);
  json["responses"] = Json::array();
  for (Index j = 0; j < inputs; ++j) {
    for (Index i = 0; i < outputs; ++i) {
      const Index entry = j * outputs + i;
      Eigen::VectorXcd G(found.size());
      Vector deviation(found.size());
      for (Index k = 0; k < found.size(); ++k) {
        const auto at = static_cast<std::size_t>(k);
        G[k] = found.response[at](i, j);
        deviation[k] = std::sqrt(std::max(0.0, found.covariance[at](entry, entry).real()));
      }
      const Vector phase = G.array().arg();
      Json one = {{"input", found.inputs[static_cast<std::size_t>(j)].name},
                  {"output", found.outputs[static_cast<std::size_t>(i)].name},
                  {"magnitude", list(G.cwiseAbs())},
                  {"magnitude_interval95",
                   Json::array({list(found.magnitude_low.col(entry)), list(found.magnitude_high.col(entry))})},
                  {"phase_deg", list(kDegrees * phase)},
                  {"phase_interval95_deg", Json::array({list(kDegrees * (phase - found.phase_half_width.col(entry))),
                                                        list(kDegrees * (phase + found.phase_half_width.col(entry)))})},
                  {"real", list(G.real())},
                  {"imaginary", list(G.imag())},
                  {"standard_error", list(deviation)},
                  {"region95_radius", list(found.radius95.col(entry))}};
      if (!found.noise_covariance.empty()) {
        Vector noise(found.size()), nonlinear(found.size());
        for (Index k = 0; k < found.size(); ++k) {
          const double variance = found.noise_covariance[static_cast<std::size_t>(k)](entry, entry).real();
          noise[k] = std::sqrt(std::max(0.0, variance));
          nonlinear[k] =
              std::sqrt(found.averages * std::max(0.0, deviation[k] * deviation[k] - std::max(0.0, variance)));
        }
        one["noise_standard_error"] = list(noise);
        if (found.method == FrequencyResponseMethod::robust) one["nonlinear_standard_deviation"] = list(nonlinear);
      }
      if (found.partial_coherence.size() > 0) one["partial_coherence"] = list(found.partial_coherence.col(entry));
      json["responses"].push_back(std::move(one));
    }
  }
  if (found.multiple_coherence.size() > 0) {
    json["multiple_coherence"] = Json::array();
    for (Index i = 0; i < outputs; ++i) json["multiple_coherence"].push_back(list(found.multiple_coherence.col(i)));
  }
  return json;
}

}  // namespace mbk::result
