#include "mbk/files/xdf/xdf.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/files/contents/whole_numbers.h"
#include "mbk/files/xdf/xdf_chunks.h"
#include "mbk/files/xdf/xdf_clocks.h"
#include "mbk/files/xdf/xdf_order.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kMaxPartsListed = 3;  ///< segments of a clock that are described one by one
constexpr double kRatesDiffer = 0.1;        ///< relative, beyond which effective and nominal rate do not agree
constexpr double kLongUncovered = 30.0;     ///< [s], from the nearest clock offset
constexpr double kMicroseconds = 1e6;

/// Units as stream headers spell them out, and as mbk writes them.
constexpr auto kSpelledUnits = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"meters", "m"},
    {"metres", "m"},
    {"centimeters", "cm"},
    {"millimeters", "mm"},
    {"micrometers", "um"},
    {"radians", "rad"},
    {"degrees", "deg"},
    {"newtons", "N"},
    {"newton", "N"},
    {"newtonmeters", "N.m"},
    {"seconds", "s"},
    {"milliseconds", "ms"},
    {"volts", "V"},
    {"millivolts", "mV"},
    {"microvolts", "uV"},
    {"N·m", "N.m"},
    {"µV", "uV"},
    {"m/s²", "m/s2"},
});

std::string unit_as_written(const std::string& unit) {
  const auto spelled = std::ranges::find(kSpelledUnits, unit, &std::pair<std::string_view, std::string_view>::first);
  return spelled == kSpelledUnits.end() ? unit : std::string(spelled->second);
}

/// Gives each name once.
class UniqueNames {
 public:
  /// `name`, or with #2, #3, … where it is taken.
  std::string take(const std::string& name) {
    std::string found = name;
    for (std::size_t& next = next_[name]; !taken_.insert(found).second;) found = fmt::format("{}#{}", name, ++next + 1);
    return found;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, std::size_t> next_;  ///< numbers that a name was given, less one
};

/// [s] of a unit of time; 0 of another one.
double seconds_of(std::string_view unit) {
  constexpr auto kTimes = std::to_array<std::pair<std::string_view, double>>({
      {"s", 1.0},
      {"seconds", 1.0},
      {"ms", 1e-3},
      {"milliseconds", 1e-3},
      {"us", 1e-6},
      {"µs", 1e-6},
      {"microseconds", 1e-6},
      {"ns", 1e-9},
      {"nanoseconds", 1e-9},
  });
  const auto found = std::ranges::find(kTimes, unit, &std::pair<std::string_view, double>::first);
  return found == kTimes.end() ? 0.0 : found->second;
}

/// The number that a marker is; 0 where it is a word.
double number_in(std::string_view text) {
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size() && std::isfinite(value) ? value : 0.0;
}

/// "+20.000 ms", "-3.000 s".
std::string signed_duration(double seconds) {
  if (std::abs(seconds) < 1.0) return fmt::format("{:+.3f} ms", seconds * kMilliseconds);
  return fmt::format("{:+.6f} s", seconds);
}

class Decoder {
 public:
  explicit Decoder(XdfFile file) : file_(std::move(file)) {}

  Result<Contents> run() {
    contents_.format = "XDF";
    contents_.notes = std::move(file_.notes);
    if (!file_.recorded.empty()) contents_.metadata["start"] = file_.recorded;
    UniqueNames names;
    for (XdfStream& stream : file_.streams) {
      stream.name = names.take(stream.name.empty() ? fmt::format("stream_{}", stream.id) : stream.name);
      take(stream);
    }
    std::ranges::move(details_, std::back_inserter(contents_.notes));
    std::ranges::stable_sort(contents_.events, {}, &Event::time);
    if (contents_.arrays.empty() && contents_.events.empty()) {
      return bad_data(file_.streams.empty() ? "the file contains no stream" : "none of its streams has a sample",
                      contents_.notes.empty() ? "nothing was recorded" : contents_.notes.front());
    }
    return std::move(contents_);
  }

 private:
  void take(XdfStream& stream) {
    const bool text = stream.value == XdfValue::string;
    std::vector<std::string> doubts, said;
    Vector raw = stream.stamps;
    fill_missing_stamps(stream, said);
    if (stream.nominal_hz > 0.0 && !text) put_in_order(stream, raw, doubts);
    const Synchronised clock = synchronise(stream.stamps, stream.offsets, stream.total);
    say_clock(stream, clock, doubts, said);
    say_steps(stream, clock.steps, doubts);
    Vector time = clock.time;
    double effective_hz = 0.0;
    if (stream.nominal_hz > 0.0 && time.size() > 0) {
      Dejittered even = evened(stream, clock);
      effective_hz = even.effective_hz;
      if (stream.can_drop_samples) {
        said.emplace_back("its stamps were not dejittered, because it declares that it can drop samples");
      } else {
        say_dejittered(stream, clock.time, even, doubts, said);
        say_backward(clock.time, even, said);
        time = std::move(even.time);
      }
    }
    details_.push_back(summary(stream, effective_hz));
    const auto note = [&](const std::string& what) { return fmt::format("'{}': {}", stream.name, what); };
    std::ranges::transform(doubts, std::back_inserter(contents_.notes), note);
    std::ranges::transform(said, std::back_inserter(details_), note);
    if (text) {
      if (time.size() > 0) take_markers(stream, time);
      return;
    }
    leave_out_unsure(stream, clock.steps, raw, time);
    if (time.size() > 0) take_numbers(stream, raw, std::move(time));
  }

  /// Puts samples in the order of their stamps where the file holds groups of them out of order.
  static void put_in_order(XdfStream& stream, Vector& raw, std::vector<std::string>& doubts) {
    const std::vector<Index> order = order_by_stamps(stream.stamps);
    if (order.empty()) return;
    for (Vector* values : {&raw, &stream.stamps}) *values = Vector((*values)(order));
    for (Vector& values : stream.values) values = Vector(values(order));
    Index moved = 0;
    for (std::size_t k = 0; k < order.size(); ++k) moved += order[k] != static_cast<Index>(k);
    doubts.push_back(
        fmt::format("groups of samples are out of order in the file: {} of {} samples were sorted by time stamp", moved,
                    order.size()));
  }

  /// Stamps of the recorder's clock, evened out on the clock on which they are more even: where the drift of the
  /// sender's changes, its samples are even on one of the two alone.
  static Dejittered evened(const XdfStream& stream, const Synchronised& clock) {
    const std::vector<Index> breaks = clock.breaks();
    Dejittered even = dejitter(clock.time, stream.nominal_hz, breaks);
    const auto bends = [](const ClockSegment& segment) { return segment.correction.bend > 0.0; };
    if (std::ranges::none_of(clock.segments, bends)) return even;
    Dejittered of_sender = dejitter(clock.stamps, stream.nominal_hz, breaks);
    if ((of_sender.time - clock.stamps).squaredNorm() >= (even.time - clock.time).squaredNorm()) return even;
    of_sender.time = clock.on_recorder(of_sender.time);
    of_sender.effective_hz = even.effective_hz;
    of_sender.largest_shift = (of_sender.time - clock.time).cwiseAbs().maxCoeff();
    return of_sender;
  }

  /// Omits samples that may be before or after a step of a clock.
  static void leave_out_unsure(XdfStream& stream, const std::vector<ClockStep>& steps, Vector& raw, Vector& time) {
    std::vector<Index> kept;
    Index next = 0;
    for (const ClockStep& step : steps) {
      while (next < step.first - step.unsure) kept.push_back(next++);
      next = std::max(next, step.first);
    }
    if (kept.empty() && next == 0) return;
    while (next < time.size()) kept.push_back(next++);
    if (std::ssize(kept) == time.size()) return;
    for (Vector* values : {&raw, &time}) *values = Vector((*values)(kept));
    for (Vector& values : stream.values) values = Vector(values(kept));
  }

  static void fill_missing_stamps(XdfStream& stream, std::vector<std::string>& said) {
    const double step = stream.nominal_hz > 0.0 ? 1.0 / stream.nominal_hz : 0.0;
    double last = 0.0;
    Index missing = 0;
    for (double& stamp : stream.stamps) {
      if (std::isnan(stamp)) {
        stamp = last + step;
        ++missing;
      }
      last = stamp;
    }
    if (missing == 0) return;
    said.push_back(fmt::format(
        "{} of {} samples have no time stamp: {}", missing, stream.stamps.size(),
        step > 0.0 ? fmt::format("each was placed {:.6g} ms after the previous sample", step * kMilliseconds)
                   : "each was given the stamp of the previous sample"));
  }

  static void say_clock(const XdfStream& stream, const Synchronised& clock, std::vector<std::string>& doubts,
                        std::vector<std::string>& said) {
    if (clock.not_finite > 0)
      said.push_back(fmt::format("{} clock offsets that are not finite were ignored", clock.not_finite));
    if (clock.last_was_corrupt) {
      said.push_back(
          fmt::format("the last of {} clock offsets is corrupt and was ignored: there are more samples than the footer "
                      "states, and it is far from the others",
                      stream.offsets.size() - clock.not_finite));
    }
    if (stream.stamps.size() == 0) return;
    if (clock.segments.empty()) {
      said.emplace_back(
          "there is no clock offset: its time is that of the sender's clock, which other streams may not share");
      return;
    }
    if (const std::size_t resets = clock.segments.size() - 1; resets > 0) {
      doubts.push_back(fmt::format("the sender's clock was reset {}: each part was synchronised separately",
                                   resets == 1 ? "once" : fmt::format("{} times", resets)));
    }
    for (std::size_t k = 0; k < std::min(clock.segments.size(), kMaxPartsListed); ++k) {
      const ClockSegment& segment = clock.segments[k];
      const ClockCorrection& correction = segment.correction;
      const std::string where =
          clock.segments.size() == 1 ? "" : fmt::format(" of samples {} to {}", segment.first + 1, segment.last + 1);
      said.push_back(fmt::format("time stamps{} were converted to the recorder's clock: {:+.6f} s, drift {:+.3g} µs/s",
                                 where, correction.line.offset, correction.line.slope * kMicroseconds));
      if (correction.bend > 0.0) {
        said.push_back(
            fmt::format("its drift{} changes: a curve through the clock offsets was added, which deviates by up to "
                        "{:.2g} ms from a straight line",
                        where, correction.bend * kMilliseconds));
      }
      if (correction.outliers > 0) {
        said.push_back(
            correction.outliers == 1
                ? fmt::format("one clock offset{} is an outlier and has little weight", where)
                : fmt::format("{} clock offsets{} are outliers and have little weight", correction.outliers, where));
      }
      if (correction.doubt > 0.0) {
        doubts.push_back(
            fmt::format("its clock offsets{} differ by more than clock drift ({:.0f} µs/s) for an unknown reason: "
                        "their median was added, and its time may be off by {:.3g} ms",
                        where, kLargestDrift * kMicroseconds, correction.doubt * kMilliseconds));
      } else if (std::abs(correction.line.slope) > kLargestDrift) {
        doubts.push_back(fmt::format(
            "its clock{} drifts by {:+.3g} µs/s, more than a quartz clock ({:.0f} µs/s): check the clock of the sender",
            where, correction.line.slope * kMicroseconds, kLargestDrift * kMicroseconds));
      }
    }
    if (clock.uncovered > kLongUncovered) {
      said.push_back(fmt::format(
          "its nearest clock offset is up to {:.0f} s from its samples: the drift was extrapolated", clock.uncovered));
    }
  }

  static void say_steps(const XdfStream& stream, const std::vector<ClockStep>& steps,
                        std::vector<std::string>& doubts) {
    for (std::size_t k = 0; k < std::min(steps.size(), kMaxPartsListed); ++k) {
      const ClockStep& step = steps[k];
      if (step.unsure == 0) {
        doubts.push_back(
            fmt::format("the sender's clock jumped by {} after sample {} (seen in its clock offsets); later time "
                        "stamps were corrected",
                        signed_duration(-step.size), step.first));
        continue;
      }
      doubts.push_back(
          fmt::format("its clock offsets step by {}, and its time stamps do not show at which of samples {} to {}: {}",
                      signed_duration(step.size), step.first - step.unsure + 1, step.first,
                      stream.value == XdfValue::string ? "their times may be off by as much" : "these were omitted"));
    }
    if (steps.size() > kMaxPartsListed) {
      doubts.push_back(fmt::format("its clock offsets show {} such steps", steps.size()));
    }
  }

  static void say_dejittered(const XdfStream& stream, const Vector& before, const Dejittered& even,
                             std::vector<std::string>& doubts, std::vector<std::string>& said) {
    const std::size_t breaks = even.segments.size() - 1;
    const double shift = even.largest_shift * kMilliseconds;
    std::string moved = fmt::format("time stamps were dejittered, which moved them by {}",
                                    shift < 1e-3 ? "less than 0.001 ms" : fmt::format("at most {:.3g} ms", shift));
    const double samples = even.lasting_shift * stream.nominal_hz;
    const bool wander = samples > kManySamples && even.lasting_shift > even.largest_shift / 2.0;  // and do not jitter
    if (wander) {
      moved += fmt::format(
          ", and for at least two seconds by {:.0f} samples: if samples were lost, the times of later samples are "
          "wrong; compare with '{}.raw_time'",
          samples, stream.name);
    }
    (wander ? doubts : said).push_back(std::move(moved));
    if (breaks == 0) return;
    std::string what = breaks == 1 ? std::string("a break of") : fmt::format("{} breaks in its time:", breaks);
    for (std::size_t k = 0; k < std::min(breaks, kMaxPartsListed); ++k) {
      const Index last = even.segments[k].last;
      what += fmt::format("{} {:.6g} s after sample {}", k == 0 ? "" : ",", before[last + 1] - before[last], last + 1);
    }
    if (breaks > kMaxPartsListed) what += ", …";
    doubts.push_back(what + "; each part was dejittered separately");
  }

  /// Stamps that ran backward before they were evened out, and did not show that samples are out of order.
  static void say_backward(const Vector& before, const Dejittered& even, std::vector<std::string>& said) {
    Index places = 0;
    double farthest = 0.0;
    for (const EvenSegment& segment : even.segments) {
      for (Index k = segment.first + 1; k <= segment.last; ++k) {
        if (before[k] >= before[k - 1]) continue;
        ++places;
        farthest = std::max(farthest, before[k - 1] - before[k]);
      }
    }
    if (places == 0) return;
    said.push_back(
        fmt::format("its time stamps run backward in {} places, by up to {:.3g} ms, which looks like jitter: its "
                    "samples were kept in file order",
                    places, farthest * kMilliseconds));
  }

  static std::string summary(const XdfStream& stream, double effective_hz) {
    std::string text = fmt::format("stream '{}'{}: {} samples of {} {}", stream.name,
                                   stream.type.empty() ? "" : fmt::format(" ({})", stream.type), stream.stamps.size(),
                                   stream.channels.size(), stream.channels.size() == 1 ? "channel" : "channels");
    if (stream.value == XdfValue::string) text += " of text";
    if (stream.nominal_hz == 0.0) return text + ", irregular";
    text += fmt::format(", nominal rate {:.6g} Hz", stream.nominal_hz);
    if (effective_hz == 0.0) return text;
    text += fmt::format(", effective {:.6g} Hz", effective_hz);
    if (std::abs(effective_hz - stream.nominal_hz) > kRatesDiffer * stream.nominal_hz) {
      text += "; they differ by more than 10 %: samples were lost, or the nominal rate is wrong";
    }
    return text;
  }

  void take_numbers(XdfStream& stream, const Vector& raw, Vector time) {
    const int clock = static_cast<int>(contents_.clocks.size());
    contents_.clocks.push_back({stream.name, std::move(time)});
    UniqueNames labels;
    labels.take("raw_time");
    const auto add = [&](const std::string& label, const std::string& unit, Vector values) {
      Array array{fmt::format("{}.{}", stream.name, label), SharedMatrix::of_column(std::move(values)), unit};
      array.signal = true;
      array.clock = clock;
      contents_.arrays.push_back(std::move(array));
    };
    for (std::size_t c = 0; c < stream.channels.size(); ++c) {
      const XdfChannel& channel = stream.channels[c];
      const std::string label = channel.label.empty() ? fmt::format("channel_{}", c + 1) : channel.label;
      const std::string name = labels.take(label);
      if (channel.rounded > 0) say_rounded(fmt::format("{}.{}", stream.name, name), channel);
      add(name, unit_as_written(channel.unit), std::move(stream.values[c]));
    }
    add("raw_time", "s", raw);
  }

  void say_rounded(const std::string& name, const XdfChannel& channel) {
    std::string note = fmt::format("{}: by up to {}", rounded_note(name), channel.rounded);
    if (const double unit = seconds_of(channel.unit); unit > 0.0) {
      note += fmt::format("; as times they are accurate to {:.3g} µs", channel.rounded * unit * kMicroseconds);
    }
    contents_.notes.push_back(std::move(note));
  }

  /// A text is the name of an event; with several channels the channel is added.
  void take_markers(const XdfStream& stream, const Vector& time) {
    const std::size_t channels = stream.channels.size();
    std::size_t taken = 0;
    for (std::size_t k = 0; k < stream.texts.size(); ++k) {
      const std::string& text = stream.texts[k];
      if (text.empty()) continue;
      const std::string& label = stream.channels[k % channels].label;
      std::string name = text;
      if (channels > 1)
        name = fmt::format("{}: {}", label.empty() ? fmt::format("channel_{}", k % channels + 1) : label, text);
      contents_.events.push_back({time[static_cast<Index>(k / channels)], std::move(name), number_in(text)});
      ++taken;
    }
    details_.push_back(fmt::format("the texts of '{}' were read as {} events", stream.name, taken));
  }

  XdfFile file_;
  Contents contents_;
  std::vector<std::string> details_;  ///< notes that are to follow those of what may be wrong
};

}  // namespace

Result<Contents> decode_xdf(std::span<const std::byte> file) {
  auto parsed = MBK_TRY(parse_xdf(file));
  return Decoder(std::move(parsed)).run();
}

}  // namespace mbk::recording
