// SRIVC from arrays in memory, one start, one thread, for bench/transfer_function.py to compare.
//   bench_transfer_function SIGNALS STEP TURNS   SIGNALS: doubles, all of the input, then all of the output
#include <fmt/format.h>
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <vector>

#include "mbk/measure/identify/srivc.h"

namespace {

/// Of this process: what else the machine does leaves it alone.
double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
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
