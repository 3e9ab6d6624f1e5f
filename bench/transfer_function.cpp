// Transfer functions from arrays in memory, one thread, for bench/transfer_function.py and bench/prediction_error.py to
// compare.
//   bench_transfer_function SIGNALS STEP TURNS                        SRIVC, 4 poles, 1 zero, one start
//   bench_transfer_function SIGNALS STEP TURNS oe|bj POLES ZEROS      all that `mbk tf` does for such a model
//   … F1 … FN                                                         the same from one start, its denominator
// SIGNALS: doubles, all of the input, then all of the output
#include <fmt/format.h>
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include "mbk/measure/identify/prediction_error.h"
#include "mbk/measure/identify/srivc.h"

namespace {

/// Of this process: what else the machine does leaves it alone.
double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// ms, R_T², the variance of the innovations, the orders of C and D, f and b of each turn.
int time_prediction_error(const std::vector<mbk::SignalPair>& pairs, int argc, char** argv) {
  mbk::identify::PredictionErrorOptions options;
  options.noise_model = std::string_view(argv[4]) == "bj";
  options.poles = std::atoi(argv[5]);
  options.zeros = std::atoi(argv[6]);
  options.threads = 1;
  options.start_denominator.resize(argc - 7);
  for (int k = 7; k < argc; ++k) options.start_denominator[k - 7] = std::atof(argv[k]);
  for (int turn = 0; turn < std::atoi(argv[3]); ++turn) {
    const double begin = cpu_ms();
    const auto fit = mbk::identify::fit_prediction_error(pairs, options);
    const double taken = cpu_ms() - begin;
    if (!fit || !fit->converged) return 4;
    fmt::print("{} {:.17g} {:.17g} {} {}", taken, fit->fit, fit->variance, fit->noise_denominator.size() - 1,
               fit->noise_numerator.size() - 1);
    for (const mbk::Vector* part : {&fit->f, &fit->b}) {
      for (const double value : *part) fmt::print(" {:.17g}", value);
    }
    fmt::print("\n");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 && argc < 7) return 2;
  std::ifstream file(argv[1], std::ios::binary | std::ios::ate);
  const auto count = static_cast<mbk::Index>(static_cast<std::size_t>(file.tellg()) / (2 * sizeof(double)));
  std::vector<mbk::SignalPair> pairs(1);
  mbk::SignalPair& pair = pairs[0];
  pair.input.resize(count);
  pair.output.resize(count);
  file.seekg(0);
  const auto bytes = static_cast<std::streamsize>(static_cast<std::size_t>(count) * sizeof(double));
  file.read(reinterpret_cast<char*>(pair.input.data()), bytes);
  file.read(reinterpret_cast<char*>(pair.output.data()), bytes);
  if (!file) return 3;
  pair.step = std::atof(argv[2]);
  pair.time = mbk::Vector::LinSpaced(count, 0.0, static_cast<double>(count - 1)) * *pair.step;
  if (argc > 4) return time_prediction_error(pairs, argc, argv);
  mbk::identify::ContinuousFitOptions options;
  options.poles = 4;
  options.zeros = 1;
  options.start_poles = {20.0};
  options.only_given_starts = true;
  options.free_start = false;
  options.refine = false;
  options.threads = 1;
  for (int turn = 0; turn < std::atoi(argv[3]); ++turn) {
    const double begin = cpu_ms();
    const auto fit = mbk::identify::fit_continuous(pairs, options);
    const double taken = cpu_ms() - begin;
    if (!fit || !fit->converged) return 4;
    fmt::print("{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", taken, fit->starts[0].iterations, fit->a[0],
               fit->a[1], fit->a[2], fit->a[3], fit->b[0], fit->b[1]);
  }
  return 0;
}
