#include "mbk/measure/preprocess/exclusions.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "mbk/base/core/nan.h"

namespace mbk::preprocess {
namespace {

bool take(std::string_view word, std::string_view& text) {
  if (!text.starts_with(word)) return false;
  text.remove_prefix(word.size());
  return true;
}

bool take(double& number, std::string_view& text) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

/// "1.5-4 s: " at the beginning of the text, which is taken from it.
std::optional<ExcludedWindow> take_window(std::string_view& text) {
  ExcludedWindow window;
  std::string_view rest = text;
  if (!take(window.from_s, rest) || !take("-", rest) || !take(window.to_s, rest) || !take(" s:", rest)) {
    return std::nullopt;
  }
  take(" ", rest);
  text = rest;
  return window;
}

/// The samples of a window.
Segment samples_of(const ExcludedWindow& window, const Clock& clock, double origin_s) {
  const double from = std::max(0.0, window.from_s - origin_s), to = std::min(clock.duration(), window.to_s - origin_s);
  if (!(from <= to)) return {};
  return {clock.sample(from), std::min(clock.sample(to) + 1, clock.samples())};
}

/// [begin, end) without the excluded samples, which are in order.
std::vector<Cut> pieces_of(const Cut& cut, const std::vector<Segment>& excluded) {
  std::vector<Cut> pieces;
  Index begin = cut.begin;
  const auto add = [&](Index end) {
    if (begin >= end) return;
    Cut piece{begin, end, {}};
    for (Segment keep : cut.keep) {
      keep.begin = std::max(keep.begin, begin);
      keep.end = std::min(keep.end, end);
      if (keep.begin < keep.end) piece.keep.push_back(keep);
    }
    pieces.push_back(std::move(piece));
  };
  for (const Segment& window : excluded) {
    add(std::min(window.begin, cut.end));
    begin = std::max(begin, window.end);
  }
  add(cut.end);
  return pieces;
}

std::string window_text(const ExcludedWindow& window) {
  return fmt::format("{:g} s to {:g} s", window.from_s, window.to_s);
}

}  // namespace

Result<void> check_consent(const Recording& recording) {
  const auto withdrawn = recording.metadata.find("withdrawn");
  if (withdrawn == recording.metadata.end() || withdrawn->second != "yes") return {};
  return with_code("withdrawn", bad_data("the participant has withdrawn: these data must not be used",
                                         "omit the file and delete it"));
}

std::string excluded_windows_text(std::span<const ExcludedWindow> windows) {
  std::string text;
  for (const ExcludedWindow& one : windows) {
    text += fmt::format("{}{:g}-{:g} s: {}", text.empty() ? "" : "; ", one.from_s, one.to_s, one.why);
  }
  return text;
}

Result<std::vector<ExcludedWindow>> parse_excluded_windows(std::string_view text) {
  constexpr std::string_view kBetween = "; ";
  std::vector<ExcludedWindow> windows;
  while (!text.empty()) {
    const std::string_view given = text;
    auto window = take_window(text);
    if (!window || !(window->from_s < window->to_s)) {
      return bad_data(fmt::format("its excluded windows cannot be read: '{}'", given),
                      "write them in the metadata as '1.5-4 s: why; 7-9 s: why'");
    }
    std::size_t end = text.find(kBetween);
    for (; end != std::string_view::npos; end = text.find(kBetween, end + 1)) {
      std::string_view next = text.substr(end + kBetween.size());
      if (take_window(next)) break;
    }
    window->why = text.substr(0, end);
    windows.push_back(std::move(*window));
    text.remove_prefix(std::min(end == std::string_view::npos ? end : end + kBetween.size(), text.size()));
  }
  return windows;
}

Result<std::vector<ExcludedWindow>> excluded_windows(const Recording& recording) {
  return parse_excluded_windows(recording.noted(kExcludedWindows));
}

std::string why_excluded(const Recording& recording) {
  return recording.noted(kExcluded);
}

std::string exclusions_text(const Recording& recording) {
  std::string text;
  const auto add = [&](const std::string& what, const std::string& why) {
    text += fmt::format("{}{}excluded: {}", text.empty() ? "" : "; ", what, why);
  };
  if (const std::string why = why_excluded(recording); !why.empty()) add("", why);
  const auto windows = excluded_windows(recording);
  if (!windows) return text + (text.empty() ? "" : "; ") + windows.error().message;
  for (const ExcludedWindow& one : *windows) add(window_text(one) + " ", one.why);
  return text;
}

Result<void> leave_out(std::span<const ExcludedWindow> windows, const Clock& clock, double origin_s, bool displacements,
                       WindowPlan& plan) {
  constexpr double kShortest = 2.0;  // [s]; the filters lose a tenth of it
  std::vector<Segment> excluded;
  std::string omitted;
  const Index first = plan.cuts.front().begin, last = plan.cuts.back().end;
  for (const ExcludedWindow& window : windows) {
    const Segment samples = samples_of(window, clock, origin_s);
    if (samples.size() == 0 || samples.end <= first || samples.begin >= last) continue;
    excluded.push_back(samples);
    omitted += fmt::format("; omitted: {}, excluded: {}", window_text(window), window.why);
  }
  if (excluded.empty()) return {};
  std::ranges::sort(excluded, {}, &Segment::begin);
  std::vector<Cut> left;
  for (const Cut& cut : plan.cuts) {
    std::vector<Cut> pieces = pieces_of(cut, excluded);
    const auto counts = [&](const Cut& piece) {
      if (displacements) return piece.end - piece.begin == cut.end - cut.begin;
      return static_cast<double>(piece.end - piece.begin) >= kShortest * clock.rate().value;
    };
    std::ranges::copy_if(pieces, std::back_inserter(left), counts);
  }
  const bool any = std::ranges::any_of(left, [](const Cut& cut) { return !cut.keep.empty(); });
  if (!any) {
    return bad_data(fmt::format("no data are left after the exclusions of the operator{}", omitted),
                    "measure another trial, or choose --from and --to where nothing was excluded");
  }
  plan.cuts = std::move(left);
  plan.excluded = std::move(excluded);
  plan.rule += omitted;
  return {};
}

Recording blanked(const Recording& recording, std::span<const ExcludedWindow> windows) {
  Recording blank = recording;
  for (Index i = 0; i < blank.samples(); ++i) {
    const double time = blank.time[i];
    const auto holds = [time](const ExcludedWindow& one) { return time >= one.from_s && time <= one.to_s; };
    if (std::ranges::none_of(windows, holds)) continue;
    for (Channel& channel : blank.channels) {
      if (!channel.name.starts_with("reference")) channel.values[i] = kNaN;
    }
  }
  return blank;
}

}  // namespace mbk::preprocess
