// How long each stage of a measurement takes, on a log of two axes, 62.1 s at 1 kHz, in one thread.
//   bench_stages --benchmark_filter=prepare
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "mbk/base/numeric/block_bootstrap.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/files/recording/read.h"
#include "mbk/files/recording/write.h"
#include "mbk/measure/analyse/ellipses.h"
#include "mbk/measure/identify/consistent_model.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/identify/regression.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/measure/preprocess/prepare.h"
#include "mbk/present/report/text.h"
#include "mbk/present/result/json.h"
#include "mbk/simulate/laboratory/prescribed_motion.h"

namespace {

using namespace mbk;

/// The value, or the end: a benchmark of an error would be one of nothing.
template <class Value>
Value value_of(Result<Value> result) {
  if (result) return std::move(*result);
  std::fputs((result.error().line() + "\n").c_str(), stderr);
  std::exit(1);
}

const Recording& recording_of_a_minute() {
  static const Recording recording = value_of(laboratory::record_prescribed_motion({}, Hertz(1000.0)));
  return recording;
}

const Inspection& inspection() {
  static const Inspection facts = recording::inspect(recording_of_a_minute());
  return facts;
}

preprocess::Options options_of(Mode mode) {
  preprocess::Options options;
  options.mode = mode;
  return options;
}

const PreparedTrial& trial(Mode mode) {
  const auto prepared = [](Mode which) {
    return value_of(preprocess::prepare(recording_of_a_minute(), inspection(), options_of(which)));
  };
  static const PreparedTrial published = prepared(Mode::reference), own = prepared(Mode::default_mode);
  return mode == Mode::reference ? published : own;
}

/// The log as a file that goes away with the program.
struct File {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "mbk_bench_stages.mat";
  File() {
    if (const auto ok = recording::write(recording_of_a_minute(), path, recording::Format::mat5, true); !ok)
      std::exit(1);
  }
  ~File() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};
const std::filesystem::path& file() {
  static const File written;
  return written.path;
}

void read_file(benchmark::State& state) {
  const std::filesystem::path& path = file();  // written before the clock runs
  for (auto _ : state) benchmark::DoNotOptimize(value_of(recording::read(path, {})));
}
BENCHMARK(read_file)->Unit(benchmark::kMillisecond);

void sha256_of_4_MB(benchmark::State& state) {
  const std::vector<std::byte> bytes(4'000'000, std::byte{7});
  for (auto _ : state) benchmark::DoNotOptimize(recording::sha256(bytes));
}
BENCHMARK(sha256_of_4_MB)->Unit(benchmark::kMillisecond);

void inspect(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(recording::inspect(recording_of_a_minute()));
}
BENCHMARK(inspect)->Unit(benchmark::kMillisecond);

void prepare(benchmark::State& state, Mode mode) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(value_of(preprocess::prepare(recording_of_a_minute(), inspection(), options_of(mode))));
  }
}
BENCHMARK_CAPTURE(prepare, reference, Mode::reference)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(prepare, default_mode, Mode::default_mode)->Unit(benchmark::kMillisecond);

void identify_with_standard_errors(benchmark::State& state, Mode mode) {
  const std::vector<PreparedTrial> trials = {trial(mode)};
  for (auto _ : state) benchmark::DoNotOptimize(value_of(identify::identify_impedance(trials, {})));
}
BENCHMARK_CAPTURE(identify_with_standard_errors, reference, Mode::reference)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(identify_with_standard_errors, default_mode, Mode::default_mode)->Unit(benchmark::kMillisecond);

void consistent_model(benchmark::State& state, Mode mode) {
  const std::vector<PreparedTrial> trials = {trial(mode)};
  Identification found = value_of(identify::identify_impedance(trials, {}));
  found.model.K(0, 0) -= 100.0;  // so that a cone is in the way
  for (auto _ : state) benchmark::DoNotOptimize(value_of(identify::consistent_model(trials, found)));
}
BENCHMARK_CAPTURE(consistent_model, reference, Mode::reference)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(consistent_model, default_mode, Mode::default_mode)->Unit(benchmark::kMillisecond);

void bootstrap_of_1000_with_blocks_of_2500_ms(benchmark::State& state, Mode mode) {
  const identify::Regression r = identify::stack({trial(mode)});
  const auto rows = identify::joined(r.identification, {});
  const numeric::BlockBootstrapOptions options{.block_rows = std::llround(2.5 / r.sample_time)};
  for (auto _ : state) benchmark::DoNotOptimize(value_of(numeric::block_bootstrap(r.Z, r.Z, r.Y, {}, rows, options)));
}
BENCHMARK_CAPTURE(bootstrap_of_1000_with_blocks_of_2500_ms, reference, Mode::reference)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bootstrap_of_1000_with_blocks_of_2500_ms, default_mode, Mode::default_mode)
    ->Unit(benchmark::kMillisecond);

void ellipses_text_and_json(benchmark::State& state) {
  const Identification found = value_of(identify::identify_impedance({trial(Mode::default_mode)}, {}));
  for (auto _ : state) {
    const Findings findings = value_of(analyse::analyse_ellipses(found));
    benchmark::DoNotOptimize(report::result_text(found, findings));
    benchmark::DoNotOptimize(result::to_json(Measurement{found, findings}));
  }
}
BENCHMARK(ellipses_text_and_json)->Unit(benchmark::kMillisecond);

void measure(benchmark::State& state, Mode mode) {
  measurement::Options options;
  options.preprocess = options_of(mode);
  for (auto _ : state) {
    benchmark::DoNotOptimize(value_of(measurement::measure({&recording_of_a_minute(), 1}, options)));
  }
}
BENCHMARK_CAPTURE(measure, reference, Mode::reference)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(measure, default_mode, Mode::default_mode)->Unit(benchmark::kMillisecond);

void write_mat(benchmark::State& state) {
  for (auto _ : state) {
    if (const auto ok = recording::write(recording_of_a_minute(), file(), recording::Format::mat5, true); !ok)
      std::exit(1);
  }
}
BENCHMARK(write_mat)->Unit(benchmark::kMillisecond);

}  // namespace
