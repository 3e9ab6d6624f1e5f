// The published procedure's pipeline and nothing else, from arrays in memory to M, B and K, in one thread:
// eight signals (x, ẋ, ẍ and F of two axes) and least squares on the first 40,000 of them. For pipeline.py, which
// starts it once and asks for a turn with each line on standard input; the answer is one line of JSON.
#include <malloc.h>
#include <time.h>

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/filter_chain.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/files/recording/read.h"

namespace {

using namespace mbk;

constexpr Index kBegin = 11999, kEnd = 62000, kIdentify = 40000;  // samples of the published window
const Hertz kRate(1000.0);

template <class Value>
Value value_of(Result<Value> result) {
  if (result) return std::move(*result);
  std::fputs((result.error().line() + "\n").c_str(), stderr);
  std::exit(1);
}

/// Processor time of this process: what else the machine does leaves it alone.
double seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// @param every 1: sample for sample; more: what default mode does with the same filters
nlohmann::json run(const std::vector<dsp::Column>& columns, Index every) {
  const double start = seconds();
  const dsp::FilterChain chain{{6, 101}, value_of(dsp::butterworth_lowpass(5, Hertz(5.0), kRate)), {}};
  const std::vector<dsp::FilterOutput> outputs = {{0, 2}, {1, 2}, {0, 1}, {1, 1}, {0, 0}, {1, 0}, {2, 0}, {3, 0}};
  Matrix signals = value_of(dsp::smooth_then_lowpass(chain, columns, outputs, kRate, every));
  const double filtered = seconds();
  const Index rows = (kIdentify - 1) / every + 1;
  const Matrix negative_force = -signals.topRightCorner(rows, 2);
  signals.col(6).setOnes();  // beside the six signals, where the force was
  const auto fit = value_of(numeric::fit_least_squares(signals.topLeftCorner(rows, 7), negative_force));
  const double done = seconds();
  nlohmann::json json = {{"filters_s", filtered - start}, {"all_s", done - start}};
  const char* const names[] = {"M", "B", "K"};
  for (Index k = 0; k < 3; ++k) {
    for (Index j = 0; j < 2; ++j) {
      json[names[k]].push_back({fit.coefficients(2 * k, j), fit.coefficients(2 * k + 1, j)});
    }
  }
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: bench_pipeline LOG.mat; see pipeline.py\n", stderr);
    return 2;
  }
  const Recording log = value_of(recording::read(argv[1], {}));
  std::vector<dsp::Column> columns;
  for (const char* name : {"hand_x", "hand_y", "force_x", "force_y"}) {
    const Channel* channel = log.find(name);
    if (channel == nullptr || channel->values.size() < kEnd) {
      std::fputs("bench_pipeline: needs a log of two axes of 62 s\n", stderr);
      return 3;
    }
    columns.emplace_back(channel->values.data() + kBegin + 1, kEnd - kBegin - 2);  // one sample is lost at each end
  }
  constexpr Index kEvery = 20;  // what default mode chooses for 5 Hz at 1 kHz
  for (std::string line; std::getline(std::cin, line);) {
    std::cout << nlohmann::json{{"exact", run(columns, 1)}, {"default", run(columns, kEvery)}}.dump() << std::endl;
  }
}
