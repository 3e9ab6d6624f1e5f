#include <cmath>

#include "mbk/base/core/units.h"
#include "mbk/present/result/exploration_parts_json.h"

namespace mbk {

using document::Fields;

void describe(Fields<SignalLabel>& fields) {
  fields.type("SignalLabel");
  fields.add("name", &SignalLabel::name, "channel; −force_x is the force of the robot on the hand");
  fields.add("unit", &SignalLabel::unit, "empty if unknown");
}

void describe(Fields<Distortion>& fields) {
  fields.type("Distortion",
              "The output at lines that the perturbation leaves empty, relative to that at excited lines (root mean "
              "squares).");
  fields.add("lines", &Distortion::lines);
  fields.add("relative", &Distortion::relative, "after subtracting the contribution of the input");
  fields.add("uncorrected", &Distortion::uncorrected, "before subtracting it");
  fields.add("noise", &Distortion::noise, "noise of the mean output, from the periods");
  fields.add("residual_noise", &Distortion::residual_noise, "the same, minus the contribution of input noise");
  fields.add("output_amplitude", &Distortion::output_amplitude,
             "reference of the relative values: root mean square of the transform, divided by its length, at the "
             "excited lines");
  fields.add("p", &Distortion::p, "p-value if there is only output noise");
  fields.add("residual_p", &Distortion::residual_p, "p-value if there is only residual_noise");
  fields.add("trace", &Distortion::trace, "residual_p below 0.01, but not detected");
  fields.add("detected", &Distortion::detected, "p and residual_p below 0.01");
}

void describe(Fields<PeriodicFacts>& fields) {
  fields.type("PeriodicFacts", "Analysis of a periodic perturbation.");
  fields.add_number("period_s", &PeriodicFacts::period_s);
  fields.add("period_found", &PeriodicFacts::period_found, "false: the period was given");
  fields.add("realisations", &PeriodicFacts::realisations, "different ones");
  fields.add("periods", &PeriodicFacts::periods, "of the realisation with the fewest");
  fields.add("dropped_periods", &PeriodicFacts::dropped_periods,
             "omitted at the start of realisations because of transients");
  fields.add("orthogonal", &PeriodicFacts::orthogonal, "experiments in groups with orthogonal references");
  fields.add("skipped_lines", &PeriodicFacts::skipped_lines, "excited, but not along every input, or weakly");
  fields.add("weak_lines", &PeriodicFacts::weak_lines, "those of them with too little power of the perturbation");
  fields.add("odd_lines_only", &PeriodicFacts::odd, "excited: odd multiples of 1/period alone");
  const auto total = [](Fields<PeriodicFacts>& part) {
    part.add_or_null("ratio", &PeriodicFacts::total_over_noise);
    part.add("p", &PeriodicFacts::total_over_noise_p, "p-value for a linear limb");
  };
  fields
      .group("total_over_noise", total,
             "ratio of the variance of the response between realisations to that between periods; 1 for a linear limb")
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
  fields.type("Response", "Response from one input to one output.");
  fields.add("input", &Response::input);
  fields.add("output", &Response::output);
  fields.add("magnitude", &Response::magnitude);
  fields.add_columns("magnitude_interval95", &Response::magnitude95, "low and high ends");
  fields.add("phase_deg", &Response::phase);
  fields.add_columns("phase_interval95_deg", &Response::phase95,
                     "low and high ends; ±180° around the phase if the interval of the magnitude reaches 0");
  fields.add("real", &Response::real);
  fields.add("imaginary", &Response::imaginary);
  fields.add("standard_error", &Response::standard_error, "√E|δG|², of the complex response");
  fields.add("region95_radius", &Response::radius95,
             "radius of the disc around the estimate that contains the response with 95 % confidence");
  fields.add_if(there(&Response::noise), "noise_standard_error", &Response::noise,
                "due to noise, from its variation between periods");
  fields.add_if(there(&Response::nonlinear), "nonlinear_standard_deviation", &Response::nonlinear,
                "of stochastic nonlinear distortion in the response from one realisation");
  fields.add_if(there(&Response::coherence), "partial_coherence", &Response::coherence,
                "coherence of this output and input after removing the contribution of the other inputs");
}

}  // namespace

void describe(Fields<FrequencyResponseEstimate>& fields) {
  using Found = FrequencyResponseEstimate;
  using From = const Found&;
  fields.type("FrequencyResponseEstimate",
              "Responses of the outputs to the inputs, Y = G U + V, with one entry of every list for each frequency. "
              "Of motion and force, G is the dynamic stiffness −F/X; the impedance is G/(jω).");
  fields.add("method", &Found::method);
  fields.add("method_rule", &Found::method_rule, "how the method was chosen");
  fields.add("intervals_assume", &Found::assumes);
  fields.add("by_reference", &Found::by_reference, "projected on the reference, which is valid in closed loop");
  fields.add("averages", &Found::averages, "independent segments or experiments that were averaged");
  fields.add("inputs", &Found::inputs);
  fields.add("outputs", &Found::outputs);
  fields.add("frequency_hz", &Found::frequency);
  fields.add("degrees_of_freedom", &Found::degrees_of_freedom, "complex degrees of freedom of the standard errors");
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
