#include "mbk/validate/one_dimensional_trial.h"

#include <cmath>

#include "mbk/base/dsp/decimate.h"
#include "mbk/base/dsp/difference_equation.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/identify/prediction_error.h"

namespace mbk::validation::one_dimensional {
namespace {

/// y − x̂ over a whole trial; its initial state and its offset are the best ones.
Vector simulation_error(const Attempt& attempt, const SignalPair& whole) {
  Vector F(attempt.f.size() + 1);
  F << 1.0, attempt.f;
  return identify::without_discrete_free_motion(attempt.f,
                                                whole.output - dsp::difference_equation(attempt.b, F, whole.input));
}

}  // namespace

SignalPair first_part(const SignalPair& whole) {
  SignalPair part = whole;
  const auto count = static_cast<Index>(kIdentify * kRate);
  part.time = whole.time.head(count);
  part.input = whole.input.head(count);
  part.output = whole.output.head(count);
  return part;
}

double validation_vaf(const Attempt& attempt, const SignalPair& whole) {
  const auto count = static_cast<Index>(kValidate * kRate);
  return numeric::variance_accounted_for(whole.output.tail(count), simulation_error(attempt, whole).tail(count));
}

Result<Attempt> attempted(const SignalPair& whole) {
  identify::PredictionErrorOptions options;
  options.poles = kPoles;
  options.zeros = kZeros;
  options.threads = 1;
  options.max_iterations = 100;
  auto fit = MBK_TRY(identify::fit_prediction_error({first_part(whole)}, options));
  Attempt attempt{std::move(fit.f), std::move(fit.b), fit.converged, 0.0};
  attempt.vaf = validation_vaf(attempt, whole);
  return attempt;
}

Result<Axis> axis_of(const Recording& recording) {
  const double step = recording.time[1] - recording.time[0];
  const auto begin = static_cast<Index>(kFrom / step), count = static_cast<Index>((kIdentify + kValidate) / step);
  Matrix signals(count, 3);
  signals << recording.find("hand_y")->values.segment(begin, count),
      recording.find("force_y")->values.segment(begin, count),
      recording.find("reference_y")->values.segment(begin, count);
  const Hertz rate(1.0 / step);
  const auto thin = MBK_TRY(dsp::decimate(signals, rate, static_cast<Index>(std::llround(rate.value / kRate))));
  const Index n = thin.rows();
  const Vector time = Vector::LinSpaced(n, 0.0, static_cast<double>(n - 1)) / kRate;
  const auto pair = [&](Index input, Index output) {
    return SignalPair{.time = time, .input = thin.col(input), .output = thin.col(output), .step = 1.0 / kRate};
  };
  return Axis{pair(0, 1), pair(2, 0)};
}

ValidationOutput validation_output(const Attempt& attempt, const SignalPair& whole) {
  const auto count = static_cast<Index>(kValidate * kRate);
  ValidationOutput output;
  output.time = Vector::LinSpaced(count, kIdentify, kIdentify + static_cast<double>(count - 1) / kRate);
  output.measured = whole.output.tail(count);
  output.modelled = output.measured - simulation_error(attempt, whole).tail(count);
  return output;
}

}  // namespace mbk::validation::one_dimensional
