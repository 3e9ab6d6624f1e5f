#include <cmath>

#include "mbk/base/core/units.h"
#include "mbk/present/result/exploration_parts_json.h"

namespace mbk {

using document::Fields;

void describe(Fields<SignalLabel>& fields) {
  fields.type("SignalLabel");
  fields.add("name", &SignalLabel::name, "channel; −force_x is the force of the robot on the hand");
  fields.add("unit", &SignalLabel::unit, "empty where the recording does not say");
}

void describe(Fields<Distortion>& fields) {
  fields.type("Distortion",
              "The output at lines that the perturbation leaves empty, relative to that at excited lines (root mean "
              "squares).");
  fields.add("lines", &Distortion::lines);
  fields.add("relative", &Distortion::relative, "without what the input carries there times the response");
  fields.add("uncorrected", &Distortion::uncorrected, "with it");
  fields.add("noise", &Distortion::noise, "of the mean output, as the periods show it");
  fields.add("residual_noise", &Distortion::residual_noise,
             "the same without what the noise of the input explains of it");
  fields.add("output_amplitude", &Distortion::output_amplitude,
             "what they are relative to: root mean square of the transform over its length at the excited lines");
  fields.add("p", &Distortion::p, "probability of so much where the noise of the output is all there is");
  fields.add("residual_p", &Distortion::residual_p, "the same where residual_noise is all there is");
  fields.add("trace", &Distortion::trace, "residual_p below 0.01, but not detected");
  fields.add("detected", &Distortion::detected, "p and residual_p below 0.01");
}

void describe(Fields<PeriodicFacts>& fields) {
  fields.type("PeriodicFacts", "How a periodic perturbation was taken apart.");
  fields.add_number("period_s", &PeriodicFacts::period_s);
  fields.add("period_found", &PeriodicFacts::period_found, "otherwise it was given");
  fields.add("realisations", &PeriodicFacts::realisations, "different ones");
  fields.add("periods", &PeriodicFacts::periods, "of the realisation that has fewest");
  fields.add("dropped_periods", &PeriodicFacts::dropped_periods, "at the beginnings of realisations: transients");
  fields.add("orthogonal", &PeriodicFacts::orthogonal, "experiments in groups with orthogonal references");
  fields.add("skipped_lines", &PeriodicFacts::skipped_lines, "excited, but not along every input, or weakly");
  fields.add("weak_lines", &PeriodicFacts::weak_lines, "of these the ones with too little of the perturbation's power");
  fields.add("odd_lines_only", &PeriodicFacts::odd, "excited: odd multiples of 1/period alone");
  const auto total = [](Fields<PeriodicFacts>& part) {
    part.add_or_null("ratio", &PeriodicFacts::total_over_noise);
    part.add("p", &PeriodicFacts::total_over_noise_p, "probability of so much where the limb is linear");
  };
  fields
      .group("total_over_noise", total,
             "variance of the response over realisations over that over periods; 1 where the limb is linear")
      .only_if([](const PeriodicFacts& facts) { return facts.total_over_noise.has_value(); });
  fields.add("even_distortion", &PeriodicFacts::even);
  fields.add("odd_distortion", &PeriodicFacts::odd_lines);
}

namespace {

/// From one input to one output.
struct Response {
  std::string input, output;
  Vector magnitude;
  Matrix magnitude95;
  Vector phase;
  Matrix phase95;
  Vector real, imaginary, standard_error;
  Vector radius95, noise, nonlinear, coherence;
};

Response response_of(const FrequencyResponseEstimate& found, Index i, Index j) {
  const Index entry = j * std::ssize(found.outputs) + i;
  Eigen::VectorXcd G(found.size());
  Vector deviation(found.size());
  for (Index k = 0; k < found.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    G[k] = found.response[at](i, j);
    deviation[k] = std::sqrt(std::max(0.0, found.covariance[at](entry, entry).real()));
  }
  Response one;
  one.input = found.inputs[static_cast<std::size_t>(j)].name;
  one.output = found.outputs[static_cast<std::size_t>(i)].name;
  one.magnitude = G.cwiseAbs();
  one.magnitude95.resize(found.size(), 2);
  one.magnitude95 << found.magnitude_low.col(entry), found.magnitude_high.col(entry);
  const Vector phase = G.array().arg();
  one.phase = kDegrees * phase;
  one.phase95.resize(found.size(), 2);
  one.phase95 << kDegrees * (phase - found.phase_half_width.col(entry)),
      kDegrees * (phase + found.phase_half_width.col(entry));
  one.real = G.real();
  one.imaginary = G.imag();
  one.standard_error = deviation;
  one.radius95 = found.radius95.col(entry);
  if (!found.noise_covariance.empty()) {
    one.noise.resize(found.size());
    Vector nonlinear(found.size());
    for (Index k = 0; k < found.size(); ++k) {
      const double variance = std::max(0.0, found.noise_covariance[static_cast<std::size_t>(k)](entry, entry).real());
      one.noise[k] = std::sqrt(variance);
      nonlinear[k] = std::sqrt(found.averages * std::max(0.0, deviation[k] * deviation[k] - variance));
    }
    if (found.method == FrequencyResponseMethod::robust) one.nonlinear = std::move(nonlinear);
  }
  if (found.partial_coherence.size() > 0) one.coherence = found.partial_coherence.col(entry);
  return one;
}

void describe(Fields<Response>& fields) {
  const auto there = [](Vector Response::*member) {
    return [member](const Response& one) { return (one.*member).size() > 0; };
  };
  fields.type("Response", "From one input to one output.");
  fields.add("input", &Response::input);
  fields.add("output", &Response::output);
  fields.add("magnitude", &Response::magnitude);
  fields.add_columns("magnitude_interval95", &Response::magnitude95, "low and high ends");
  fields.add("phase_deg", &Response::phase);
  fields.add_columns("phase_interval95_deg", &Response::phase95,
                     "low and high ends; ±180° around the phase where the magnitude's interval reaches 0");
  fields.add("real", &Response::real);
  fields.add("imaginary", &Response::imaginary);
  fields.add("standard_error", &Response::standard_error, "√E|δG|², of the complex response");
  fields.add("region95_radius", &Response::radius95,
             "of the disc around the estimate that holds the response with 95 %");
  fields.add_if(there(&Response::noise), "noise_standard_error", &Response::noise,
                "of noise alone, as it changes from period to period");
  fields.add_if(there(&Response::nonlinear), "nonlinear_standard_deviation", &Response::nonlinear,
                "of stochastic nonlinear distortion in the response from one realisation");
  fields.add_if(there(&Response::coherence), "partial_coherence", &Response::coherence,
                "of this output and input without what the other inputs explain of both");
}

}  // namespace

void describe(Fields<FrequencyResponseEstimate>& fields) {
  using Found = FrequencyResponseEstimate;
  using From = const Found&;
  fields.type("FrequencyResponseEstimate",
              "Responses of the outputs to the inputs, Y = G U + V, with one entry of every list for each frequency. "
              "Of motion and force, G is the dynamic stiffness −F/X; the impedance is G/(jω).");
  fields.add("method", &Found::method);
  fields.add("method_rule", &Found::method_rule, "why that method, in words");
  fields.add("intervals_assume", &Found::assumes);
  fields.add("by_reference", &Found::by_reference, "projected on the reference, which holds in closed loop");
  fields.add("averages", &Found::averages, "independent segments or experiments that were averaged");
  fields.add("inputs", &Found::inputs);
  fields.add("outputs", &Found::outputs);
  fields.add("frequency_hz", &Found::frequency);
  fields.add("degrees_of_freedom", &Found::degrees_of_freedom, "complex ones, of the standard errors");
  fields.add("periodic", &Found::periodic);
  fields.add("responses", [](From found) {
    std::vector<Response> all;
    for (Index j = 0; j < std::ssize(found.inputs); ++j) {
      for (Index i = 0; i < std::ssize(found.outputs); ++i) all.push_back(response_of(found, i, j));
    }
    return all;
  });
  fields
      .add_columns("multiple_coherence", &Found::multiple_coherence,
                   "of each output with all inputs or, by local polynomials with a reference, with that")
      .only_if([](From found) { return found.multiple_coherence.size() > 0; });
}

}  // namespace mbk
