#include "mbk/files/c3d/c3d_layout.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace mbk::recording {
namespace {

constexpr double kRateTolerance = 1e-3;   ///< relative: 32-bit reals and rounded digits
constexpr double kScaleTolerance = 1e-5;  ///< relative: 32-bit reals
constexpr double kMaxInWord = 65535.0;
constexpr double kWords = 65536.0;  ///< a count loses multiples of this if its upper word is dropped
constexpr double kMaxFrames = 1e15;
constexpr std::string_view kBySize = "the file size";

/// A number of frames that the file states.
struct Count {
  std::string_view by;
  double frames = 0.0;
  bool word = false;  ///< stored in 16 bits: its upper word may be lost
  bool full = false;  ///< 65535 in 16 bits: there may be more frames

  [[nodiscard]] bool usable() const { return frames >= 1.0 && frames < kMaxFrames && frames == std::floor(frames); }
};

/// A block at which the file says that the data start.
struct Start {
  std::string_view by;
  double block = 0.0;
  bool possible = true;

  [[nodiscard]] std::uint64_t byte() const { return (static_cast<std::uint64_t>(block) - 1) * kC3dBlock; }
};

enum class Fit : std::uint8_t { beyond, within, exact };  ///< of the frames in the file

struct Pick {
  std::uint64_t frames = 0;
  std::string_view by;
  Fit fit = Fit::beyond;
};

/// A value on which header and parameters disagree.
struct Contradiction {
  std::string what;
  double header = 0.0, parameters = 0.0;
  std::string source = {};  ///< of the parameters' value

  [[nodiscard]] std::string text() const {
    return fmt::format("the header states {} {}, the parameters {}{}", header, what, parameters, source);
  }
};

double positive_or_zero(double value) {
  return value > 0.0 && std::isfinite(value) ? value : 0.0;
}

bool same_rate(double a, double b) {
  return std::abs(a - b) <= kRateTolerance * std::max(a, b);
}

class Finder {
 public:
  Finder(const C3dBytes& file, const C3dParameters& parameters, std::uint64_t size, std::vector<std::string>& notes)
      : file_(file), parameters_(parameters), size_(size), notes_(notes) {}

  Result<C3dLayout> run() {
    C3dLayout by_parameters, by_header;
    MBK_TRY(find_shapes(by_parameters, by_header));
    MBK_TRY(find_starts());
    find_counts();
    auto layout = choose(by_parameters, by_header);
    if (!layout) return layout;
    if (layout->frames == 0) {
      return bad_data("the file states 0 frames", "nothing was recorded, or it is damaged");
    }
    set_scale(*layout);
    MBK_TRY(set_rates(*layout));
    layout->first_frame = field("ACTUAL_START_FIELD").value_or(header(4));
    return layout;
  }

 private:
  [[nodiscard]] double header(std::size_t k) const { return file_.word(c3d_header_word(k)); }
  [[nodiscard]] double header_scale() const { return file_.real(c3d_header_word(7)); }
  [[nodiscard]] double header_rate() const { return positive_or_zero(file_.real(c3d_header_word(11))); }
  [[nodiscard]] double rate(std::string_view group) const {
    return positive_or_zero(parameters_.number(group, "RATE").value_or(0.0));
  }
  void note(std::string text) { notes_.push_back(std::move(text)); }

  // ---- points, channels and numbers ----

  Result<void> find_shapes(C3dLayout& by_parameters, C3dLayout& by_header) {
    const auto said = parameters_.number("POINT", "SCALE");
    const auto is_scale = [](double scale) { return std::isfinite(scale) && scale != 0.0; };
    const double own = header_scale();
    if (!is_scale(own) && !is_scale(said.value_or(0.0))) {
      return bad_data(fmt::format("POINT:SCALE is {}, so it is unknown whether the values are integers or reals",
                                  said.value_or(own)),
                      std::string(kC3dRemedy));
    }
    by_parameters.real = (is_scale(said.value_or(0.0)) ? *said : own) < 0.0;
    by_header.real = is_scale(own) ? own < 0.0 : by_parameters.real;

    const double points = parameters_.number("POINT", "USED").value_or(header(2));
    const double numbers = header(3);
    const double point_rate = rate("POINT") > 0.0 ? rate("POINT") : header_rate();
    const double ratio = point_rate > 0.0 ? std::round(rate("ANALOG") / point_rate) : 0.0;
    const bool whole = ratio >= 1.0 && same_rate(ratio * point_rate, rate("ANALOG"));
    const double samples_in_header = header(10) > 0.0 ? header(10) : std::max(ratio, 1.0);
    const double samples = whole ? ratio : samples_in_header;
    const double channels = parameters_.number("ANALOG", "USED").value_or(std::floor(numbers / samples_in_header));
    if (std::max({points, channels, samples}) > kMaxInWord || channels != std::floor(channels) ||
        points != std::floor(points) || std::min(points, channels) < 0.0) {
      return bad_data(fmt::format("{} points and {} analog channels of {} samples per frame are not possible", points,
                                  channels, samples),
                      std::string(kC3dRemedy));
    }
    set_shape(by_parameters, points, channels, samples);
    const bool confirmed = channels * samples == numbers;
    if (confirmed || channels * samples > kMaxInWord) {  // or the header has no room for the product
      set_shape(by_header, header(2), channels, samples);
      if (confirmed && channels > 0.0 && samples != samples_in_header) {
        note(
            fmt::format("the header states {} analog samples per frame; {} is used, which agrees with ANALOG:USED, "
                        "ANALOG:RATE and the {} analog values per frame",
                        samples_in_header, samples, numbers));
      }
    } else {
      set_shape(by_header, header(2), std::floor(numbers / samples_in_header), samples_in_header);
      const bool other_samples = channels > 0.0 && by_header.channels != by_parameters.channels &&
                                 std::fmod(numbers, channels) == 0.0 && !(whole && ratio == samples_in_header);
      header_ambiguous_ =
          by_header.channels * by_header.samples != static_cast<std::uint64_t>(numbers) || other_samples;
    }
    find_contradiction(by_parameters, by_header, channels * samples_in_header == numbers);
    return {};
  }

  static void set_shape(C3dLayout& shape, double points, double channels, double samples) {
    shape.points = static_cast<std::uint64_t>(points);
    shape.channels = static_cast<std::uint64_t>(channels);
    shape.samples = channels > 0.0 ? static_cast<std::uint64_t>(samples) : 1;
  }

  /// @param only_samples  header and parameters have the same number of channels
  void find_contradiction(const C3dLayout& by_parameters, const C3dLayout& by_header, bool only_samples) {
    const auto numbers = [](const C3dLayout& shape) { return static_cast<double>(shape.channels * shape.samples); };
    if (by_parameters.real != by_header.real) {
      contradiction_ = {"as the point scale, whose sign distinguishes reals from integers", header_scale(),
                        parameters_.number("POINT", "SCALE").value_or(0.0)};
    } else if (by_parameters.points != by_header.points) {
      contradiction_ = {"points", static_cast<double>(by_header.points), static_cast<double>(by_parameters.points)};
    } else if (by_parameters.samples != by_header.samples && only_samples) {
      contradiction_ = {"analog samples per frame", static_cast<double>(by_header.samples),
                        static_cast<double>(by_parameters.samples),
                        fmt::format(" (ANALOG:RATE is {} Hz, POINT:RATE {} Hz)", rate("ANALOG"), rate("POINT"))};
    } else if (by_parameters.channels != by_header.channels || by_parameters.samples != by_header.samples ||
               header_ambiguous_) {
      contradiction_ = {"analog values per frame", header(3), numbers(by_parameters)};
    }
  }

  // ---- where the data begin ----

  Result<void> find_starts() {
    const auto said = parameters_.number("POINT", "DATA_START");
    if (said) starts_.push_back({"POINT:DATA_START", *said});
    if (!said || *said != header(9)) starts_.push_back({"the header", header(9)});
    for (Start& start : starts_) {
      start.possible = start.block >= 2.0 && start.block <= kMaxInWord && start.block == std::floor(start.block) &&
                       (start.byte() < parameters_.begin() || start.byte() >= parameters_.end());
    }
    if (std::ranges::any_of(starts_, &Start::possible)) return {};
    return bad_data(fmt::format("the data cannot start at block {} ({}): the parameters occupy bytes {} to {}",
                                starts_.front().block, starts_.front().by, parameters_.begin(), parameters_.end()),
                    std::string(kC3dRemedy));
  }

  /// The end of the data section that starts at `begin`: that of the file, or the next section.
  [[nodiscard]] std::uint64_t end_of_data(std::uint64_t begin) const {
    std::uint64_t end = size_;
    if (parameters_.begin() > begin) end = std::min<std::uint64_t>(end, parameters_.begin());
    const double rotations = parameters_.number("ROTATION", "DATA_START").value_or(0.0);
    if (rotations >= 2.0 && rotations <= kMaxInWord) {
      const std::uint64_t at = Start{"", rotations}.byte();
      if (at > begin) end = std::min(end, at);
    }
    return std::max(end, begin);
  }

  // ---- how many frames ----

  /// A frame number in two words, the lower first.
  [[nodiscard]] std::optional<double> field(std::string_view name) const {
    const auto words = parameters_.numbers("TRIAL", name, true);
    if (words.empty()) return std::nullopt;
    return words[0] + (words.size() > 1 ? kWords * words[1] : 0.0);
  }

  /// In order of precedence: POINT:LONG_FRAMES overrides POINT:FRAMES, and the header may count the raw data from which
  /// the file was made (C3D User Guide, "Reading the frame count").
  void find_counts() {
    if (const auto frames = parameters_.number("POINT", "LONG_FRAMES")) {
      counts_.push_back({"POINT:LONG_FRAMES", *frames});
    }
    if (const auto frames = parameters_.number("POINT", "FRAMES")) {
      const bool word = parameters_.find("POINT", "FRAMES")->type == C3dParameter::Type::word;
      counts_.push_back({"POINT:FRAMES", *frames, word, word && *frames == kMaxInWord});
    }
    const auto first = field("ACTUAL_START_FIELD"), last = field("ACTUAL_END_FIELD");
    if (first && last && *last >= *first) counts_.push_back({"TRIAL:ACTUAL_END_FIELD", *last - *first + 1.0});
    const double from = header(4), to = header(5);
    counts_.push_back({"the header", to >= from ? to - from + 1.0 : 0.0, true, to == kMaxInWord});
  }

  /// False also if `file_` does not hold all of these bytes.
  [[nodiscard]] bool all_zero(std::uint64_t begin, std::uint64_t end) const {
    if (begin > end || end > file_.view.size()) return false;
    const auto bytes = file_.view.part(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin)).bytes;
    return std::ranges::all_of(bytes, [](std::byte b) { return b == std::byte{0}; });
  }

  /// The stated number of frames that fits the section best, or the number for which it has room.
  /// @param begin, end  [bytes] of the section; up to 511 of them are padding if it ends with a block
  [[nodiscard]] Pick pick(std::uint64_t begin, std::uint64_t end, std::uint64_t frame_size) const {
    const std::uint64_t room = end - begin, most = room / frame_size;
    const bool padded = end % kC3dBlock == 0;
    const auto fit = [&](double frames) {
      if (frames > static_cast<double>(most)) return Fit::beyond;
      const std::uint64_t rest = room - static_cast<std::uint64_t>(frames) * frame_size;
      return rest < (padded ? kC3dBlock : 1) ? Fit::exact : Fit::within;
    };
    const auto picked = [&](const Count& count) {
      return Pick{static_cast<std::uint64_t>(count.frames), count.by, fit(count.frames)};
    };
    std::vector<Count> counts;
    for (const Count& count : counts_) {
      if (count.usable() && !count.full) counts.push_back(count);
    }
    std::optional<Count> best;
    bool best_padded = false;
    for (const Count& count : counts) {
      if (fit(count.frames) != Fit::exact) continue;
      // Several counts may fit. Padding is zero, so the smallest count with only zeros behind it is right.
      const bool zeros = all_zero(begin + static_cast<std::uint64_t>(count.frames) * frame_size, end);
      if (!best || (zeros && (!best_padded || count.frames < best->frames))) best = count, best_padded = zeros;
    }
    if (best) return picked(*best);
    for (const Count& count : counts) {
      if (!count.word || fit(count.frames) == Fit::beyond) continue;
      const double lost = kWords * std::floor((static_cast<double>(most) - count.frames) / kWords);
      const Count whole{kBySize, count.frames + lost};
      if (fit(whole.frames) == Fit::exact) return picked(whole);
    }
    const bool full = std::ranges::any_of(counts_, [&](const Count& count) {
      return count.full && (count.by == "POINT:FRAMES" || !parameters_.number("POINT", "FRAMES"));
    });
    for (const Count& count : counts) {
      if (!best && fit(count.frames) != Fit::beyond && (!full || count.frames >= kMaxInWord)) best = count;
    }
    for (const Count& count : counts) {  // one that has not lost its upper word
      if (best && count.frames > best->frames && std::fmod(count.frames - best->frames, kWords) == 0.0) best = count;
    }
    if (best) return picked(*best);
    if (full) std::erase_if(counts, [](const Count& count) { return count.frames < kMaxInWord; });
    if (!counts.empty()) return picked(counts.front());
    if (full && static_cast<double>(most) >= kMaxInWord) {
      std::uint64_t frames = most;  // without padding
      const auto last = [&] { return begin + (frames - 1) * frame_size; };
      while (padded && frames > 1 && end - last() < kC3dBlock && all_zero(last(), end)) --frames;
      return {frames, kBySize, Fit::within};
    }
    return full ? picked({"POINT:FRAMES", kMaxInWord}) : Pick{};
  }

  // ---- all of it ----

  /// `shape` with the start of the data and the number of frames that fit the file best.
  [[nodiscard]] std::pair<C3dLayout, Pick> complete(C3dLayout shape) const {
    std::optional<Pick> best;
    for (const Start& start : starts_) {
      if (!start.possible) continue;
      const std::uint64_t end = end_of_data(start.byte());
      const Pick one = pick(start.byte(), end, shape.frame_size());
      if (best && one.fit <= best->fit) continue;
      best = one;
      shape.data = start.byte();
      shape.end = end;
      shape.frames = one.frames;
    }
    return {shape, *best};
  }

  Result<C3dLayout> choose(const C3dLayout& by_parameters, const C3dLayout& by_header) {
    if (by_parameters.frame_size() == 0) return bad_data("the file contains neither points nor analog channels");
    auto [layout, pick] = complete(by_parameters);
    if (contradiction_) {
      const bool fits = pick.fit == Fit::exact;
      const bool other = !header_ambiguous_ && by_header.frame_size() > 0;
      const auto [second, second_pick] = other ? complete(by_header) : std::pair(C3dLayout(), Pick());
      if (fits == (second_pick.fit == Fit::exact)) return bad_data(contradiction_->text(), std::string(kC3dWriteAgain));
      note(fmt::format("{}; only the {} the file size", contradiction_->text(),
                       fits ? "parameters fit" : "header fits"));
      if (!fits) layout = second, pick = second_pick;
    }
    if (!parameters_.terminated() && pick.fit == Fit::within) {
      return bad_data(
          fmt::format("the parameters extend beyond block {}, where the data start", layout.data / kC3dBlock + 1),
          std::string(kC3dRemedy));
    }
    say_start(layout, pick);
    say_frames(layout, pick);
    return layout;
  }

  void say_start(const C3dLayout& layout, const Pick& pick) {
    if (starts_.size() < 2) return;
    const bool first = starts_[0].possible && starts_[0].byte() == layout.data;
    const Start &used = starts_[first ? 0 : 1], &other = starts_[first ? 1 : 0];
    note(fmt::format("the data are read from block {} ({}{}); {} states block {}{}", used.block, used.by,
                     pick.fit == Fit::exact ? ", which fits the file size" : "", other.by, other.block,
                     other.possible ? "" : ", which cannot hold data"));
  }

  void say_frames(const C3dLayout& layout, const Pick& pick) {
    const auto frames = static_cast<double>(layout.frames);
    std::vector<std::string> others;
    for (const Count& count : counts_) {
      if (count.frames == frames || (count.full && frames >= kMaxInWord)) continue;
      others.push_back(fmt::format("{} states {}", count.by, count.frames));
    }
    if (!others.empty()) {
      note(fmt::format("the number of frames is {} ({}{}); {}", frames, pick.by,
                       pick.fit == Fit::exact && pick.by != kBySize ? ", which fits the file size" : "",
                       fmt::join(others, ", ")));
    } else if (pick.by == kBySize && frames > kMaxInWord) {
      note(fmt::format("the file states 65535 frames, the largest number in 16 bits, but holds {}; all are read",
                       frames));
    }
  }

  void set_scale(C3dLayout& layout) const {
    const double own = header_scale(), said = parameters_.number("POINT", "SCALE").value_or(own);
    const auto is_scale = [&](double scale) { return std::isfinite(scale) && scale != 0.0; };
    layout.scale = layout.real ? 1.0 : std::abs(is_scale(said) ? said : own);
    if (layout.real || layout.points == 0 || !is_scale(said) || !is_scale(own) ||
        std::abs(std::abs(own) - std::abs(said)) <= kScaleTolerance * std::abs(said)) {
      return;
    }
    layout.no_scale =
        Error{ErrorKind::data, fmt::format("the header scales points by {}, POINT:SCALE by {}", own, said),
              std::string(kC3dWriteAgain)};
  }

  Result<void> set_rates(C3dLayout& layout) {
    const double said = rate("POINT"), own = header_rate(), samples = static_cast<double>(layout.samples);
    layout.point_rate = said > 0.0 ? said : own;
    layout.analog_rate = layout.channels > 0 ? rate("ANALOG") : 0.0;
    if (said > 0.0 && own > 0.0 && !same_rate(said, own)) {
      const double third = layout.analog_rate / samples;
      if (same_rate(third, said) || same_rate(third, own)) {
        layout.point_rate = same_rate(third, said) ? said : own;
        note(fmt::format("the header states {} Hz, POINT:RATE {} Hz; {} Hz is used, which agrees with ANALOG:RATE", own,
                         said, layout.point_rate));
      } else {
        layout.point_rate = layout.analog_rate = 0.0;
        note(
            fmt::format("the header states {} Hz, POINT:RATE {} Hz; neither is used: pass the correct rate with --rate",
                        own, said));
      }
    }
    if (layout.channels == 0 || layout.point_rate == 0.0) return {};
    const double by_points = layout.point_rate * samples;
    if (layout.analog_rate == 0.0) layout.analog_rate = by_points;
    if (same_rate(layout.analog_rate, by_points)) return {};
    return bad_data(fmt::format("ANALOG:RATE is {} Hz, but a frame holds {} samples and POINT:RATE is {} Hz",
                                layout.analog_rate, samples, layout.point_rate),
                    std::string(kC3dWriteAgain));
  }

  const C3dBytes& file_;
  const C3dParameters& parameters_;
  std::uint64_t size_;
  std::vector<std::string>& notes_;
  std::vector<Start> starts_;
  std::vector<Count> counts_;
  std::optional<Contradiction> contradiction_;
  bool header_ambiguous_ = false;  ///< its analog numbers do not tell the number of channels
};

}  // namespace

Result<C3dLayout> c3d_layout(const C3dBytes& file, const C3dParameters& parameters, std::uint64_t size,
                             std::vector<std::string>& notes) {
  return Finder(file, parameters, size, notes).run();
}

}  // namespace mbk::recording
