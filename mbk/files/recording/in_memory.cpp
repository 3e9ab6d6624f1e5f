#include "mbk/files/recording/in_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mbk/base/core/requester.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/assemble.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/own_samples.h"

namespace mbk::recording {
namespace {

constexpr const char* kFormat = "arrays in memory";

bool without_options(const ReadOptions& o) {
  return o.channels.empty() && o.requested.empty() && !o.rate && o.axes == 0 && o.variable.empty() && o.clock.empty() &&
         o.trial.empty() && o.arm.empty();
}

/// The numbers of a signal where they stand. Nothing that reads contents writes into them: a channel is a copy.
SharedMatrix shared(const InMemory::Signal& signal) {
  auto keeper = std::make_shared<Samples>(signal.values);
  auto* const at = const_cast<double*>(signal.values.data());
  const Index count = signal.values.size();
  const Index rows = signal.rows == 0 ? count : signal.rows;
  return {at, rows, count / std::max<Index>(rows, 1), std::move(keeper)};
}

/// Options that only files have.
Result<void> check_options(const ReadOptions& options) {
  const auto refused = [](const char* option) {
    return bad_usage(fmt::format("{} applies to files, not to arrays in memory", option),
                     fmt::format("omit {}", option));
  };
  if (!options.trial.empty()) return refused("--trial");
  if (!options.arm.empty()) return refused("--side");
  return {};
}

}  // namespace

Result<InMemory> InMemory::of(std::vector<Signal> signals, double rate_hz, std::map<std::string, std::string> metadata,
                              std::vector<Event> events) {
  if (signals.empty()) return bad_usage("no signal was given", "name the arrays: time, x, Fx, …");
  if (!(rate_hz >= 0.0) || !std::isfinite(rate_hz)) {
    return bad_usage(fmt::format("rate {} Hz is not a positive number", rate_hz), "give the sample rate in Hz");
  }
  const auto samples_of = [](const Signal& s) { return s.rows > 0 ? s.values.size() / s.rows : s.values.size(); };
  for (std::size_t k = 0; k < signals.size(); ++k) {
    const Signal& signal = signals[k];
    if (signal.name.empty()) return bad_usage("a signal has no name", "name each signal: time, x, Fx, …");
    for (std::size_t i = 0; i < k; ++i) {
      if (signals[i].name == signal.name) {
        return bad_usage(fmt::format("two signals are called '{}'", signal.name), "give each signal a unique name");
      }
    }
    if (signal.values.size() == 0) return bad_data(fmt::format("'{}' is empty", signal.name), "nothing was recorded");
    const Signal& first = signals.front();
    if (signal.rows == 0 && first.rows == 0 && samples_of(signal) != samples_of(first)) {
      return bad_data(fmt::format("'{}' has {} samples, but '{}' has {}", first.name, samples_of(first), signal.name,
                                  samples_of(signal)),
                      "give signals of equal length");
    }
  }
  InMemory made;
  made.signals_ = std::move(signals);
  made.rate_hz_ = rate_hz;
  made.metadata_ = std::move(metadata);
  made.events_ = std::move(events);
  return made;
}

InMemory InMemory::of(Recording recording) {
  InMemory made;
  made.recording_ = std::make_shared<const Recording>(std::move(recording));
  const Recording& whole = *made.recording_;
  const auto shared = [&](const Vector& values) { return Samples(values.data(), values.size(), made.recording_); };
  made.signals_.push_back({"time", "s", shared(whole.time), 0});
  for (const Channel& channel : whole.channels) {
    made.signals_.push_back({channel.name, channel.unit, shared(channel.values), 0});
  }
  made.metadata_ = metadata_with_joints(whole);
  made.events_ = whole.events;
  return made;
}

Contents InMemory::contents() const {
  Contents contents;
  contents.format = kFormat;
  contents.table = std::ranges::all_of(signals_, [](const Signal& signal) { return signal.rows == 0; });
  for (const Signal& signal : signals_) {
    Array array{.name = signal.name, .values = shared(signal)};
    array.unit = signal.unit;
    array.signal = true;
    array.rests = signal.rests;
    array.rate_hz = rate_hz_;
    contents.arrays.push_back(std::move(array));
  }
  contents.metadata = metadata_;
  contents.events = events_;
  return contents;
}

Result<Recording> InMemory::read(const ReadOptions& options) const {
  if (recording_ && without_options(options)) {
    return options.own_samples ? at_own_samples(*recording_, options.commands) : *recording_;
  }
  MBK_TRY(check_options(options));
  auto recording = assemble(contents(), options);
  if (recording && recording_) recording->sources = recording_->sources;
  return recording;
}

const InMemory::Signal* InMemory::find(std::string_view name) const {
  const auto named = std::ranges::find(signals_, name, &Signal::name);
  if (named != signals_.end()) return &*named;
  const auto requested = kinds_called(name);
  const auto same = std::ranges::find_if(signals_, [&](const Signal& signal) {
    const auto kinds = kinds_called(signal.name);
    return std::ranges::any_of(kinds,
                               [&](const auto* kind) { return std::ranges::find(requested, kind) != requested.end(); });
  });
  return same == signals_.end() ? nullptr : &*same;
}

std::shared_ptr<const InMemory> held_recording(const std::filesystem::path& word) {
  const auto* const holder = dynamic_cast<const RecordingHolder*>(Requester::current());
  return holder == nullptr ? nullptr : holder->recording(word);
}

}  // namespace mbk::recording
