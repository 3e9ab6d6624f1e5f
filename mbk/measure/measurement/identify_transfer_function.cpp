#include "mbk/measure/measurement/identify_transfer_function.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mbk/base/dsp/cross_spectrum.h"
#include "mbk/base/dsp/decimate.h"
#include "mbk/base/dsp/fourier.h"
#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/channel_table.h"

namespace mbk::measurement {
namespace {

constexpr double kGap = 1.5;      // median intervals
constexpr double kUneven = 0.05;  // of an interval, by which a sample of an even clock may be off

/// Samples [begin, end) of a recording.
struct Piece {
  Index begin = 0, end = 0;
};

/// Part of a recording, from its first sample [s].
struct Block {
  double from = 0.0, to = 0.0;
  bool held_out = false;
};

/// How much of the power of two signals, each of power 1, lies in the same third octaves: 0 to 1. Constant ones are
/// alike.
double common_power(const Vector& a, const Vector& b) {
  constexpr int kBands = 48;
  constexpr double kLines = 2.0, kInOctave = 3.0;
  const double lowest = kLines / static_cast<double>(std::min(a.size(), b.size()));  // of the sample rate
  const auto in_bands = [&](const Vector& signal) -> Vector {
    const Index n = dsp::fast_length_below(signal.size());
    Vector x = signal.head(n).array() - signal.head(n).mean();
    x.array() *= dsp::hann_window(n).array();
    const Eigen::VectorXcd X = dsp::fourier_transform(x);
    Vector power = Vector::Zero(kBands + 2);
    for (Index k = 1; k < X.size(); ++k) {
      const double octaves = std::log2(static_cast<double>(k) / static_cast<double>(n) / lowest);
      power[std::clamp(static_cast<int>(std::floor(kInOctave * octaves)) + 2, 1, kBands)] += std::norm(X[k]);
    }
    // A line at the edge of a band is in both beside it.
    return power.segment(1, kBands) + 0.5 * (power.head(kBands) + power.tail(kBands));
  };
  const Vector of_a = in_bands(a), of_b = in_bands(b);
  if (!(of_a.sum() > 0.0 && of_b.sum() > 0.0)) return 1.0;
  return (of_a / of_a.sum()).cwiseMin(of_b / of_b.sum()).sum();
}

/// Whether every sample of the piece is where an even clock has it.
bool is_even(const Vector& time, Piece piece) {
  const Index n = piece.end - piece.begin;
  if (n < 2) return true;
  const double step = (time[piece.end - 1] - time[piece.begin]) / static_cast<double>(n - 1);
  for (Index i = 0; i < n; ++i) {
    if (std::abs(time[piece.begin + i] - time[piece.begin] - step * static_cast<double>(i)) > kUneven * step)
      return false;
  }
  return true;
}

/// Segments without a gap, and whether their clock is even; an uneven clock has no gaps.
std::pair<std::vector<Piece>, bool> pieces_of(const Vector& time) {
  const Index n = time.size();
  std::vector<double> steps;
  for (Index i = 1; i < n; ++i) steps.push_back(time[i] - time[i - 1]);
  const double median = numeric::upper_median(std::move(steps));
  std::vector<Piece> pieces = {{0, n}};
  for (Index i = 1; i < n; ++i) {
    if (time[i] - time[i - 1] <= kGap * median) continue;
    pieces.back().end = i;
    pieces.push_back({i, n});
  }
  if (std::ranges::all_of(pieces, [&](Piece piece) { return is_even(time, piece); })) return {pieces, true};
  return {{{0, n}}, false};
}

Result<const Channel*> channel_of(const Recording& recording, const std::string& name) {
  if (const Channel* const channel = recording.find(name)) return channel;
  for (const auto* const kind : recording::kinds_called(name)) {
    if (const Channel* const channel = recording.find(kind->name)) return channel;
  }
  std::vector<std::string> names;
  for (const Channel& channel : recording.channels) names.push_back(channel.name);
  return bad_data(fmt::format("channel '{}' is missing; the channels are {}", name, fmt::join(names, ", ")),
                  "name a channel, a column (number or name) or a variable");
}

class Preparer {
 public:
  explicit Preparer(const TransferFunctionMeasurement& options) : options_(options) {}

  /// The delay up to which is looked.
  void take_max_delay(std::span<const Recording> recordings);
  void note_left_out();

  /// @param whole  held out altogether
  Result<void> add(const Recording& recording, bool whole, bool hold_back);
  /// To one rate for all, when all have been added.
  Result<void> decimate();

  [[nodiscard]] const identify::TransferFunctionOptions& fit() const { return options_.fit; }

  std::vector<SignalPair> experiments, held_out;
  std::string input_unit, output_unit;
  double recorded_rate_hz = 0.0;  ///< where samples were left out
  std::vector<std::string> notes;

 private:
  [[nodiscard]] double reach() const { return fit().find_delay ? fit().max_delay : fit().delay; }
  [[nodiscard]] bool is_alike_behind(const Recording& recording, double from, double split, double to) const;
  [[nodiscard]] std::vector<Block> blocks(const Recording& recording, double from, double split, double to, bool asked);
  void take_rate_of_model();
  [[nodiscard]] Result<Index> every(const SignalPair& pair) const;
  Result<void> thin_out(SignalPair& pair);
  Result<void> cut(const Recording& recording, Piece piece, bool even, double from, double to,
                   std::vector<SignalPair>& into);

  TransferFunctionMeasurement options_;
  bool left_out_ = false;  ///< the first samples of a segment
  Hertz rate_of_model_ = kMaxDiscreteRate;
};

/// Below which 95 % of that power of the output lies which follows the input, γ² S_yy of the lines whose coherence is
/// significant, as noise is not to decide. Of a record too short for a spectrum nothing is known: 0.
Hertz top_of_response(const SignalPair& pair) {
  constexpr Index kMinSegment = 8, kSegments = 8;
  constexpr double kShare = 0.95;
  constexpr Hertz kResolution(0.5);
  const Hertz rate(1.0 / *pair.step);
  const Index samples = pair.samples(), longest = samples / kSegments;
  if (longest < kMinSegment) return Hertz(0.0);
  Matrix signals(samples, 2);
  signals << pair.input.tail(samples), pair.output.tail(samples);
  const auto spectra = dsp::cross_spectra({signals}, rate, dsp::segment_length(rate, kResolution, longest));
  if (!spectra) return Hertz(0.0);
  const Vector coherence = dsp::multiple_coherence(*spectra, 1).col(0);
  // (1 − c)^(n − 1) = 5 % at one line; of all lines without a relation none is to be above c with 95 %.
  constexpr double kLevel = 0.05;
  const double lines = std::log(kLevel / static_cast<double>(coherence.size())) / std::log(kLevel);
  const double of_one = dsp::significant_coherence(spectra->independent_segments, 1);
  const double significant = 1.0 - std::pow(1.0 - of_one, lines);
  dsp::Spectrum response{spectra->frequency, Vector::Zero(spectra->frequency.size())};
  for (Index k = 0; k < coherence.size(); ++k) {
    const double power = spectra->density[static_cast<std::size_t>(k)](1, 1).real();
    if (coherence[k] > significant) response.density[k] = coherence[k] * power;
  }
  if (!(response.density.sum() > 0.0)) return Hertz(0.0);
  return dsp::power_quantile(response, kShare, Hertz(0.5 * rate.value));
}

void Preparer::note_left_out() {
  if (!left_out_) return;
  notes.push_back(
      fmt::format("the first {:.4g} s were omitted, because the input before them was not recorded", reach()));
}

/// Fast enough that the low-pass leaves the output's response as it is.
void Preparer::take_rate_of_model() {
  if (!is_discrete(options_.fit.method) || options_.sample_rate_hz) return;
  double top = 0.0;
  for (const SignalPair& pair : experiments) {
    if (pair.step) top = std::max(top, top_of_response(pair).value);
  }
  const double rate = 2.0 / dsp::kDecimationCutoff * top;
  if (rate <= kMaxDiscreteRate.value) return;
  rate_of_model_ = Hertz(rate);
  notes.push_back(
      fmt::format("sample rate kept above {:g} Hz: 5 % of the output power that follows the input lies above {:.3g} Hz",
                  kMaxDiscreteRate.value, top));
}

Result<void> Preparer::decimate() {
  take_rate_of_model();
  for (auto* const pairs : {&experiments, &held_out}) {
    for (SignalPair& pair : *pairs) {
      MBK_TRY(thin_out(pair));
    }
  }
  return {};
}

/// One of how many samples is kept.
Result<Index> Preparer::every(const SignalPair& pair) const {
  const auto& requested = options_.sample_rate_hz;
  const bool discrete = is_discrete(options_.fit.method);
  if (requested ? *requested == 0.0 : !discrete) return 1;
  if (!pair.step) {
    if (!requested) return 1;  // the fit says what is wrong
    return bad_usage("unevenly spaced samples cannot be decimated", "resample them with --resample");
  }
  const double rate = 1.0 / *pair.step;
  constexpr double kRounding = 1e-6;
  if (!requested && rate_of_model_ > kMaxDiscreteRate) {
    return std::max<Index>(1, static_cast<Index>(std::floor(rate / rate_of_model_.value)));
  }
  if (!requested) return static_cast<Index>(std::ceil(rate / kMaxDiscreteRate.value * (1.0 - kRounding)));
  if (*requested <= rate * (1.0 + kRounding)) return static_cast<Index>(std::llround(rate / *requested));
  return bad_usage(fmt::format("the sample rate is {:.6g} Hz, so {:g} Hz is not possible", rate, *requested),
                   "choose a lower --sample-rate, or use --resample");
}

Result<void> Preparer::thin_out(SignalPair& pair) {
  const auto every_one = MBK_TRY(every(pair));
  if (every_one == 1) return {};
  if (options_.fit.hold == InputHold::zero) {
    return bad_usage("a zero-order hold does not apply to an input decimated after a low-pass filter",
                     "omit --sample-rate, or use --hold first");
  }
  const Hertz rate(1.0 / *pair.step);
  const Index begin = pair.first % every_one;
  Matrix signals(pair.time.size(), pair.reference.size() > 0 ? 3 : 2);
  signals.leftCols(2) << pair.input, pair.output;
  if (pair.reference.size() > 0) signals.col(2) = pair.reference;
  const auto thin = MBK_TRY(dsp::decimate(signals, rate, every_one, begin));
  pair.time = Vector(pair.time(Eigen::seqN(begin, thin.rows(), every_one)));
  pair.input = thin.col(0);
  pair.output = thin.col(1);
  if (pair.reference.size() > 0) pair.reference = thin.col(2);
  pair.first /= every_one;
  *pair.step *= static_cast<double>(every_one);
  recorded_rate_hz = rate.value;
  return {};
}

Result<void> Preparer::cut(const Recording& recording, Piece piece, bool even, double from, double to,
                           std::vector<SignalPair>& into) {
  const double start = recording.time[0];
  constexpr double kRounding = 1e-9;
  Index begin = piece.begin, end = piece.end;
  while (begin < end && recording.time[begin] - start < from - kRounding) ++begin;
  while (end > begin && recording.time[end - 1] - start >= to - kRounding) --end;
  constexpr Index kMin = 8;
  if (end - begin < kMin) return {};
  constexpr double kShort = 1e-6;  // of an interval
  const auto is_late = [&](Index at) {
    const double step = recording.time[piece.begin + 1] - recording.time[piece.begin];
    return recording.time[at] - recording.time[piece.begin] < reach() - kShort * step;
  };
  if (fit().free_start) {
    const Index first = begin;
    while (begin < end && is_late(begin)) ++begin;
    left_out_ = left_out_ || begin > first;
    if (end - begin < kMin) return {};
  }
  Index past = begin;
  while (past > piece.begin && recording.time[past] > recording.time[begin] - reach()) --past;
  for (const std::string& name : {options_.input, options_.output, options_.reference}) {
    if (name.empty()) continue;
    const Channel& channel = *channel_of(recording, name).value();
    const Index bad = first_non_finite(channel.values.segment(past, end - past));
    if (bad < 0) continue;
    return bad_data(fmt::format("channel '{}' is not a finite number at sample {} ({:.6f} s)", channel.name,
                                past + bad + 1, recording.time[past + bad] - start),
                    "choose a window without it with --from and --to; 'mbk info' names missing samples");
  }
  SignalPair pair;
  const auto taken = [&](const std::string& name) {
    return Vector(channel_of(recording, name).value()->values.segment(past, end - past));
  };
  pair.time = recording.time.segment(past, end - past);
  pair.input = options_.input_sign * taken(options_.input);
  pair.output = options_.output_sign * taken(options_.output);
  if (!options_.reference.empty()) pair.reference = taken(options_.reference);
  pair.first = begin - past;
  if (even) pair.step = (pair.time[pair.time.size() - 1] - pair.time[0]) / static_cast<double>(pair.time.size() - 1);
  into.push_back(std::move(pair));
  return {};
}

void Preparer::take_max_delay(std::span<const Recording> recordings) {
  if (options_.max_delay) {
    options_.fit.max_delay = *options_.max_delay;
    return;
  }
  constexpr double kShare = 0.1;
  for (const Recording& recording : recordings) {
    if (recording.samples() < 2) continue;
    const double last = recording.time[recording.samples() - 1] - recording.time[0];
    const double lasts = std::min(last, options_.window.to_s.value_or(last)) - options_.window.from_s.value_or(0.0);
    options_.fit.max_delay = std::min(options_.fit.max_delay, std::max(kShare * lasts, 0.0));
  }
}

/// Whether the input has the same spectrum behind the split as before it. An uneven clock is taken for an even one.
bool Preparer::is_alike_behind(const Recording& recording, double from, double split, double to) const {
  const Vector& input = channel_of(recording, options_.input).value()->values;
  const auto at = [&](double s) {
    const double* const first = recording.time.data();
    return static_cast<Index>(std::lower_bound(first, first + recording.samples(), recording.time[0] + s) - first);
  };
  const Index begin = at(from), middle = at(split), end = at(to);
  constexpr Index kMin = 16;
  constexpr double kAlike = 0.5;
  if (middle - begin < kMin || end - middle < kMin || !input.segment(begin, end - begin).allFinite()) return true;
  return common_power(input.segment(begin, middle - begin), input.segment(middle, end - middle)) > kAlike;
}

/// What makes the model and what is held out, in turns. Behind a split only where somebody asked for that one, or where
/// the input is alike on both sides; otherwise the model would be asked for frequencies at which it was not made.
std::vector<Block> Preparer::blocks(const Recording& recording, double from, double split, double to, bool asked) {
  std::vector<Block> all;
  if (asked || is_alike_behind(recording, from, split, to)) {
    if (split > from) all.push_back({from, split, false});
    if (split < to) all.push_back({split, to, true});
    return all;
  }
  constexpr int kTimes = 3;
  constexpr double kBefore = 0.4, kHeldOut = 0.2;
  const double each = (to - from) / kTimes;
  double begin = from;
  for (int k = 0; k < kTimes; ++k) {
    const double first = from + each * (k + kBefore), last = first + each * kHeldOut;
    all.push_back({begin, first, false});
    all.push_back({first, last, true});
    begin = last;
  }
  all.push_back({begin, to, false});
  notes.push_back(
      fmt::format("held out: {} blocks of {:.3g} s each, as the input's frequencies at the end are not those "
                  "before",
                  kTimes, each * kHeldOut));
  return all;
}

Result<void> Preparer::add(const Recording& recording, bool whole, bool hold_back) {
  const Index n = recording.samples();
  if (n < 2) return bad_data("the recording has fewer than 2 samples");
  for (Index i = 1; i < n; ++i) {
    if (recording.time[i] > recording.time[i - 1]) continue;
    return bad_data(fmt::format("time does not increase at sample {}", i + 1), "cut the file there");
  }
  const auto input = MBK_TRY(channel_of(recording, options_.input));
  const auto output = MBK_TRY(channel_of(recording, options_.output));
  if (!options_.reference.empty()) {
    MBK_TRY(channel_of(recording, options_.reference));
  }
  input_unit = input->unit;
  output_unit = (output)->unit;
  const auto [pieces, even] = pieces_of(recording.time);
  const double last = recording.time[n - 1] - recording.time[0];
  const double behind = last + last / static_cast<double>(n - 1);
  const double from = whole ? 0.0 : options_.window.from_s.value_or(0.0);
  const double to = whole ? behind : options_.window.to_s.value_or(behind);
  constexpr double kIdentify = 0.8;
  double split = options_.window.split_s.value_or(hold_back ? from + kIdentify * (to - from) : to);
  if (whole) split = from;
  if (!(from < last) || !(split <= behind) || !(to > from)) {
    return bad_data(fmt::format("the recording lasts {:.6g} s, the window is {:g} to {:g} s, split at {:g} s", last,
                                from, to, split),
                    "choose --from, --split and --to within it");
  }
  const bool asked = whole || !hold_back || options_.window.split_s.has_value();
  for (const Block block : blocks(recording, from, split, to, asked)) {
    for (const Piece piece : pieces) {
      auto& into = block.held_out ? held_out : experiments;
      MBK_TRY(cut(recording, piece, even, block.from, block.to, into));
    }
  }
  return {};
}

}  // namespace

Result<TransferFunctionIdentification> identify_transfer_function(std::span<const Recording> recordings,
                                                                  std::span<const Recording> held_out,
                                                                  const TransferFunctionMeasurement& options) {
  Preparer prepared(options);
  prepared.take_max_delay(recordings);
  const auto add = [&](const Recording& recording, bool whole) -> Result<void> {
    auto added = prepared.add(recording, whole, held_out.empty());
    if (!added && !recording.sources.empty()) return tl::unexpected(added.error().in(recording.sources[0].label()));
    return added;
  };
  for (const Recording& recording : recordings) {
    MBK_TRY(add(recording, false));
  }
  for (const Recording& recording : held_out) {
    MBK_TRY(add(recording, true));
  }
  if (prepared.experiments.empty()) {
    return bad_data(options.fit.find_delay || options.fit.delay > 0.0
                        ? "after the delay, no segment of at least 8 samples without a gap is left for identification"
                        : "no segment of at least 8 samples without a gap is left for identification",
                    "choose a longer window");
  }
  prepared.note_left_out();
  MBK_TRY(prepared.decimate());
  auto found = identify::identify_transfer_function(prepared.experiments, prepared.held_out, prepared.fit());
  if (!found) return found;
  found->input = options.input;
  found->output = options.output;
  found->reference = options.reference;
  found->input_unit = prepared.input_unit;
  found->output_unit = prepared.output_unit;
  found->recorded_rate_hz = prepared.recorded_rate_hz;
  found->notes = std::move(prepared.notes);
  for (const Recording& recording : recordings) {
    found->sources.insert(found->sources.end(), recording.sources.begin(), recording.sources.end());
    found->notes.insert(found->notes.end(), recording.notes.begin(), recording.notes.end());
    found->warnings.insert(found->warnings.end(), recording.warnings.begin(), recording.warnings.end());
  }
  return found;
}

}  // namespace mbk::measurement
