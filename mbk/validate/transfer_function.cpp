#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/identify/srivc.h"
#include "mbk/measure/identify/transfer_function_fit.h"
#include "mbk/validate/robot_trials.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

/// Rao & Garnier (2002): (−6400 s + 1600)/(s⁴ + 5 s³ + 408 s² + 416 s + 1600), [a₀ … a₃, b₀, b₁].
const Vector kTruth{{1600.0, 416.0, 408.0, 5.0, 1600.0, -6400.0}};
constexpr const char* kNames[] = {"a0", "a1", "a2", "a3", "b0", "b1"};
/// Spreads of 50 runs as they are published [unit of the coefficient]; some with one digit.
constexpr double kPublishedSpread[] = {6.5, 3.4, 1.0, 0.07, 68.0, 37.0};
constexpr double kSignalToNoise = 10.0;  // of variances: 10 dB

enum class Record { straight_lines, held, held_and_delayed };

/// Of the record that has one [s]: no whole number of samples.
constexpr double kDelay = 0.0237;

/// The system behind a random binary input, 71.6 s at 100 Hz, each value for 70 ms, and white noise.
SignalPair noisy_record(std::uint64_t seed, Record kind) {
  constexpr Index kSamples = 7161, kHold = 7;
  constexpr double kStep = 0.01;
  SignalPair pair;
  pair.step = kStep;
  pair.time = Vector::LinSpaced(kSamples, 0.0, static_cast<double>(kSamples - 1)) * kStep;
  pair.input.resize(kSamples);
  numeric::Random of_input(seed, 1), of_noise(seed, 2);
  for (Index i = 0; i < kSamples; ++i) {
    pair.input[i] = i % kHold == 0 ? (of_input.uniform() < 0.5 ? -1.0 : 1.0) : pair.input[i - 1];
  }
  SignalPair late = pair;
  if (kind != Record::straight_lines) late.held = 1.0;
  if (kind == Record::held_and_delayed) {  // it jumps within the interval behind the third sample
    constexpr Index kWhole = 3;
    late.input << Vector::Constant(kWhole, pair.input[0]), pair.input.head(kSamples - kWhole);
    late.held = kDelay / kStep - (kWhole - 1);
  }
  pair.output = identify::simulate_continuous(kTruth.head(4), kTruth.tail(2), late);
  const double level = std::sqrt((pair.output.array() - pair.output.mean()).square().mean() / kSignalToNoise);
  for (double& y : pair.output) y += level * of_noise.normal();
  return pair;
}

struct Estimate {
  Vector theta, standard_error;
  double delay = 0, delay_standard_error = 0;
  bool input_explains_residual = false;  ///< is said
};

Result<Estimate> estimated(std::uint64_t seed, Record kind) {
  identify::TransferFunctionOptions options;
  options.threads = 1;
  options.poles = 4;
  options.zeros = 1;
  if (kind == Record::straight_lines) options.hold = InputHold::first;  // its steps look like those of a held input
  options.find_delay = kind == Record::held_and_delayed;
  const auto found = MBK_TRY(identify::identify_transfer_function({noisy_record(seed, kind)}, {}, options));
  Estimate made{Vector(kTruth.size()), found.covariance.diagonal().cwiseSqrt(), found.model.delay,
                found.delay_standard_error.value_or(0.0), !found.residuals.independent()};
  made.theta << found.model.denominator.head(4), found.model.numerator;
  return made;
}

struct Run {
  Estimate straight_lines, held, delayed;
  bool right_order = false;
};

Result<Run> identified_run(std::uint64_t seed) {
  Run run;
  for (const auto& [kind, to] :
       {std::pair{Record::straight_lines, &run.straight_lines}, std::pair{Record::held, &run.held},
        std::pair{Record::held_and_delayed, &run.delayed}}) {
    *to = MBK_TRY(estimated(seed, kind));
  }
  identify::TransferFunctionOptions options;
  options.threads = 1;
  options.hold = InputHold::first;
  options.orders = {{2, 0}, {2, 1}, {3, 1}, {3, 2}, {4, 0}, {4, 1}, {4, 2}, {5, 1}};
  const auto chosen =
      MBK_TRY(identify::identify_transfer_function({noisy_record(seed, Record::straight_lines)}, {}, options));
  run.right_order = chosen.model.poles() == 4 && chosen.model.zeros() == 1;
  return run;
}

ValidationRow coverage_row(std::string quantity, const std::vector<Run>& runs, Estimate Run::*of, Index k) {
  const auto held = [&](const Run& run) {
    return std::abs((run.*of).theta[k] - kTruth[k]) <= numeric::kNormal95 * (run.*of).standard_error[k];
  };
  return share_row(std::move(quantity), runs, held, kNominalOrMore);
}

}  // namespace

Result<ValidationTable> transfer_function_study(const StudyOptions& options) {
  const auto ran = MBK_TRY(seeded_runs(options, identified_run));
  const std::vector<Run>& runs = ran;

  ValidationTable table{"transfer-function",
                        "how accurate is the transfer function that mbk identifies, and is its order found?", "error",
                        options.runs, options.seed};
  const auto of_runs = [&](auto&& value) {
    Vector values(options.runs);
    for (Index i = 0; i < values.size(); ++i) values[i] = value(runs[static_cast<std::size_t>(i)]);
    return values;
  };
  constexpr double kBias = 1.0;  // [%]
  for (Index k = 0; k < kTruth.size(); ++k) {
    const Vector error =
        of_runs([&](const Run& run) { return 100.0 * (run.straight_lines.theta[k] / kTruth[k] - 1.0); });
    table.rows.push_back(bias_row(fmt::format("bias of {}", kNames[k]), error, kBias, "%"));
    table.rows.push_back(
        coverage_row(fmt::format("95 % interval of {} holds the truth", kNames[k]), runs, &Run::straight_lines, k));
    const Vector theta = of_runs([&](const Run& run) { return run.straight_lines.theta[k]; });
    table.rows.push_back(
        spread_row(fmt::format("spread of {}, over the published {:g}", kNames[k], kPublishedSpread[k]), theta,
                   kPublishedSpread[k], {0.75, 1.25}));
  }
  for (Index k = 0; k < kTruth.size(); ++k) {
    table.rows.push_back(
        coverage_row(fmt::format("held input: 95 % interval of {} holds the truth", kNames[k]), runs, &Run::held, k));
  }
  for (Index k = 0; k < kTruth.size(); ++k) {
    table.rows.push_back(coverage_row(fmt::format("delay found: 95 % interval of {} holds the truth", kNames[k]), runs,
                                      &Run::delayed, k));
  }
  const auto delay_held = [](const Run& run) {
    return std::abs(run.delayed.delay - kDelay) <= numeric::kNormal95 * run.delayed.delay_standard_error;
  };
  table.rows.push_back(
      share_row("delay found: 95 % interval of the delay holds the truth", runs, delay_held, kNominalOrMore));
  for (const auto& [name, of] : {std::pair{"straight lines", &Run::straight_lines}, std::pair{"held input", &Run::held},
                                 std::pair{"delay found", &Run::delayed}}) {
    table.rows.push_back(share_row(
        fmt::format("{}: input-explains-residual of the right model", name), runs,
        [of = of](const Run& run) { return (run.*of).input_explains_residual; }, kHardlyEver));
  }
  table.rows.push_back(share_row("order (4, 1) chosen of eight", runs, &Run::right_order, kNearlyAlways));
  table.notes.emplace_back(
      "(−6400 s + 1600)/(s⁴ + 5 s³ + 408 s² + 416 s + 1600) of Rao & Garnier (2002), behind a random binary input of "
      "71.6 s at 100 Hz and white noise of a tenth of the output's variance. Six starts each, none near the truth.");
  table.notes.emplace_back(fmt::format(
      "Between the samples the input is a straight line, in the truth as in the model. The rows of the held "
      "input have one that keeps its value until the next sample, which mbk is to see by itself; those of "
      "the delay have the same input {:g} ms late, and mbk looks for the delay up to 100 ms.",
      1e3 * kDelay));
  return table;
}

}  // namespace mbk::validation
