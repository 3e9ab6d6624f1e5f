#include "mbk/files/tables/physiology_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "mbk/base/core/trimmed.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/tables/text_rows.h"

namespace mbk::recording {
namespace physiology {

constexpr double kLongestInterval = 3600.0, kShortestInterval = 1e-8;  ///< [s]

/// A unit of time as a word says it.
struct TimeUnit {
  std::string_view word, unit;
  double seconds;
};
constexpr auto kTimeUnits = std::to_array<TimeUnit>({{"s", "s", 1.0},
                                                     {"sec", "s", 1.0},
                                                     {"second", "s", 1.0},
                                                     {"ms", "ms", 1e-3},
                                                     {"msec", "ms", 1e-3},
                                                     {"millisecond", "ms", 1e-3},
                                                     {"us", "us", 1e-6},
                                                     {"\u00B5s", "us", 1e-6},
                                                     {"\u03BCs", "us", 1e-6},
                                                     {"\xB5s", "us", 1e-6},
                                                     {"usec", "us", 1e-6},
                                                     {"microsecond", "us", 1e-6},
                                                     {"min", "min", 60.0},
                                                     {"minute", "min", 60.0},
                                                     {"h", "h", 3600.0},
                                                     {"hr", "h", 3600.0},
                                                     {"hour", "h", 3600.0}});

const TimeUnit* time_unit(std::string_view word) {
  const std::string lower = in_lower_case(word);
  const auto find = [](std::string_view name) { return std::ranges::find(kTimeUnits, name, &TimeUnit::word); };
  auto found = find(lower);
  if (found == kTimeUnits.end() && lower.ends_with('s'))
    found = find(std::string_view(lower).substr(0, lower.size() - 1));
  return found == kTimeUnits.end() ? nullptr : &*found;
}

std::optional<double> number_of(std::string_view cell, bool decimal_commas) {
  if (const auto value = cell_number(cell)) return value;
  const auto value = decimal_commas ? comma_number(cell) : std::nullopt;
  return value ? std::optional(value->value) : std::nullopt;
}

/// [s] of "0.001 s", "1 ms", "0,001 s"; of a number alone, seconds.
std::optional<double> interval_of(std::string_view text) {
  const auto parts = words(without_quotes(text));
  if (parts.empty() || parts.size() > 2) return std::nullopt;
  const auto value = number_of(parts.front(), true);
  const TimeUnit* const unit = time_unit(parts.size() == 2 ? parts.back() : "s");
  if (!value || unit == nullptr) return std::nullopt;
  const double seconds = *value * unit->seconds;
  return seconds >= kShortestInterval && seconds <= kLongestInterval ? std::optional(seconds) : std::nullopt;
}

/// Names that are filled in and different.
void settle_names(std::vector<std::string>& names) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k].empty()) names[k] = fmt::format("Channel {}", k + 1);
  }
  number_repeated(names);
}

Vector even_times(double first, double interval, std::size_t count) {
  Vector times(static_cast<Index>(count));
  for (Index k = 0; k < times.size(); ++k) times[k] = first + static_cast<double>(k) * interval;
  return times;
}

bool is_digits(std::string_view cell) {
  cell = without_quotes(cell);
  return !cell.empty() && cell.find_first_not_of("0123456789") == cell.npos;
}

// ---- BIOPAC AcqKnowledge ----

/// [s] of "1 msec/sample".
std::optional<double> interval_of_sample(std::string_view line) {
  constexpr std::string_view kPerSample = "/sample";
  line = mbk::trimmed(line, " \t\"");
  if (!line.ends_with(kPerSample)) return std::nullopt;
  return interval_of(line.substr(0, line.size() - kPerSample.size()));
}

/// 2 of "2 channels".
std::optional<std::size_t> channel_count(std::string_view line) {
  const auto parts = words(mbk::trimmed(line, "\""));
  if (parts.size() != 2 || !parts.back().starts_with("channel")) return std::nullopt;
  const auto count = positive_number(parts.front());
  if (!count || *count > static_cast<double>(kMaxTextColumns) || *count != std::trunc(*count)) return std::nullopt;
  return static_cast<std::size_t>(*count);
}

class AcqKnowledge {
 public:
  explicit AcqKnowledge(std::span<const std::byte> file) : lines_(text_of(file)), bytes_(file.size()) {}

  Result<Contents> run() {
    contents_.format = "AcqKnowledge text";
    contents_.table = true;
    auto first = MBK_TRY(read_header());
    const std::size_t columns = names_.size() + (time_ != nullptr ? 1 : 0);
    TextRows rows(columns, bytes_);
    bool second_has_point = false;
    for (std::optional<TextLine> line = first; line; line = lines_.next_filled()) {
      if (is_cut(*line, split(line->text, separator_).size(), columns)) {
        contents_.notes.push_back(note_of_cut(*line));
        break;
      }
      if (rows.count() == 1)
        second_has_point = line->text.find_first_of(separator_ == ',' ? "." : ".,") != line->text.npos;
      MBK_TRY(add_row(rows, *line, separator_, columns));
    }
    // Without a column of time nothing but the digits tells the counts from the first sample.
    if (counts_.empty() && is_first_digits_ && rows.count() > 1) {
      std::vector<double> first_row;
      for (std::size_t c = 0; c < columns; ++c) first_row.push_back(rows.column(c).front());
      if (second_has_point || *std::ranges::max_element(first_row) == static_cast<double>(rows.count() - 1)) {
        counts_ = std::move(first_row);
        begin_ = 1;
      }
    }
    if (rows.count() <= begin_) return bad_data("there is no sample below the names", "nothing was recorded");
    take(rows);
    return std::move(contents_);
  }

 private:
  /// @returns  the first row
  Result<TextLine> read_header() {
    std::optional<TextLine> line = lines_.next_filled();
    if (line && !interval_of_sample(line->text)) line = lines_.next_filled();
    interval_ = interval_of_sample(line->text).value_or(1.0);
    contents_.rate_hz = 1.0 / interval_;
    contents_.rate_from = fmt::format("line {}, '{}'", line->number, label_of(line->text));
    line = lines_.next_filled();
    const std::size_t count = channel_count(line->text).value_or(0);
    std::vector<std::string> units;
    for (std::size_t k = 0; k < count; ++k) {
      const auto name = lines_.next();
      const auto unit = lines_.next();
      if (!name || !unit) return bad_data("the header ends before the channel names", std::string(kWriteAgain));
      names_.push_back(label_of(name->text));
      units.push_back(label_of(unit->text));
    }
    settle_names(names_);
    for (std::size_t k = 0; k < count; ++k) add_array(contents_, names_[k], units[k], 0.0);
    line = lines_.next_filled();
    if (!line) return bad_data("there is no sample below the names", "nothing was recorded");
    separator_ = separator_of(line->text);
    auto labels = labels_of(line->text, separator_);
    if (std::ranges::all_of(labels, [](const std::string& label) { return number_of(label, true).has_value(); })) {
      return *line;
    }
    if ((time_ = time_unit(labels.front())) == nullptr && labels.size() > count && !labels.back().empty()) {
      return bad_data(fmt::format("'{}' names a column that is neither time nor a channel", labels.front()),
                      std::string(kWriteAgain), line_place(line->number));
    }
    line = lines_.next_filled();
    if (!line) return bad_data("there is no sample below the names", "nothing was recorded");
    auto cells = split(line->text, separator_);
    while (!cells.empty() && is_blank(cells.back())) cells.pop_back();
    const bool blank_time = time_ != nullptr && !cells.empty() && without_quotes(cells.front()).empty();
    const std::size_t from = blank_time ? 1 : 0;
    is_first_digits_ = time_ == nullptr && cells.size() == count && std::ranges::all_of(cells, is_digits);
    if (!blank_time || cells.size() != count + 1 || !std::all_of(cells.begin() + 1, cells.end(), is_digits))
      return *line;
    for (std::size_t c = from; c < cells.size(); ++c) counts_.push_back(cell_number(cells[c]).value_or(0.0));
    line = lines_.next_filled();
    if (!line) return bad_data("there is no sample below the names", "nothing was recorded");
    return *line;
  }

  void take(TextRows& rows) {
    const std::size_t first = time_ != nullptr ? 1 : 0, count = rows.count() - begin_;
    const double most = counts_.empty() ? 0.0 : *std::ranges::max_element(counts_);
    if (!counts_.empty()) compare_counts(most, count, "samples", contents_);
    for (std::size_t c = 0; c < names_.size(); ++c) {
      Array& array = contents_.arrays[c];
      if (!counts_.empty() && counts_[c] != most) {
        array.obstacle =
            bad_data(fmt::format("'{}' has {} samples, but others have {}: it was recorded at a lower rate", names_[c],
                                 counts_[c], most),
                     "resample it in AcqKnowledge, or export channels of equal rate")
                .value();
        continue;
      }
      array.obstacle = rows.obstacle(first + c);
      const auto numbers = rows.column(first + c).subspan(begin_);
      if (!array.obstacle) {
        array.values = SharedMatrix::of_column(Vector(Eigen::Map<const Vector>(numbers.data(), std::ssize(numbers))));
      }
    }
    note_obstacles("fewer samples than the others", contents_);
    contents_.notes.push_back(
        fmt::format("{}: the sampling rate is {:.6g} Hz", contents_.rate_from, contents_.rate_hz));
    if (time_ != nullptr) take_time(rows.column(0).subspan(begin_));
  }

  /// Minutes with few decimals are coarser than the interval.
  void take_time(std::span<const double> time) {
    bool even = true;
    for (std::size_t k = 0; k < time.size() && even; ++k) {
      const double from_first = (time[k] - time.front()) * time_->seconds;
      even = std::abs(from_first - static_cast<double>(k) * interval_) <= 0.5 * interval_;
    }
    if (even) {
      contents_.notes.push_back(
          fmt::format("its time column, in {}, agrees with that rate and was not used", time_->unit));
      return;
    }
    Array& array = add_array(contents_, "time", std::string(time_->unit), 0.0);
    array.values = SharedMatrix::of_column(Vector(Eigen::Map<const Vector>(time.data(), std::ssize(time))));
  }

  TextLines lines_;
  std::size_t bytes_;
  char separator_ = '\t';
  double interval_ = 0.0;  ///< [s]
  std::vector<std::string> names_;
  const TimeUnit* time_ = nullptr;  ///< of the first column; nullptr where that is a channel
  std::vector<double> counts_;      ///< of samples, as the header says them
  bool is_first_digits_ = false;    ///< the first row may be the counts
  std::size_t begin_ = 0;           ///< rows that are not samples
  Contents contents_;
};

// ---- LabChart ----

class LabChart {
 public:
  explicit LabChart(std::span<const std::byte> file) : lines_(text_of(file)), bytes_(file.size()) {}

  Result<std::vector<NamedContents>> run() {
    for (auto line = lines_.next_filled(); line; line = lines_.next_filled()) {
      const std::string_view key = key_of(line->text);
      if (key.empty()) {
        MBK_TRY(add(*line));
        continue;
      }
      if (rows_) {
        MBK_TRY(end_block());
      }
      MBK_TRY(take_statement(key, *line));
    }
    if (rows_) {
      MBK_TRY(end_block());
    }
    if (records_.empty()) return bad_data("there is no sample below the header", "nothing was recorded");
    for (std::size_t k = 0; k < records_.size() && records_.size() > 1; ++k) {
      auto& notes = records_[k].contents.notes;
      notes.insert(notes.begin(), fmt::format("block {} of {}, each a separate recording", k + 1, records_.size()));
    }
    return std::move(records_);
  }

 private:
  /// "Interval" of "Interval=", "0.001 s"; "" of a row.
  static std::string_view key_of(std::string_view line) {
    line = mbk::trimmed(line, " \"");
    const auto end = line.find('=');
    const bool key = end != line.npos && end > 0 && line.substr(0, end).find_first_of("\t,;#0123456789") == line.npos;
    return key ? line.substr(0, end) : std::string_view();
  }

  Result<void> take_statement(std::string_view key, const TextLine& line) {
    std::string_view rest = line.text.substr(line.text.find('=') + 1);
    if (rest.starts_with('"')) rest.remove_prefix(1);
    if (key == "Interval") {
      separator_ = !rest.empty() && (rest.front() == ',' || rest.front() == ';') ? rest.front() : '\t';
    }
    if (rest.starts_with(separator_)) rest.remove_prefix(1);
    auto cells = labels_of(rest, separator_);
    while (!cells.empty() && cells.back().empty()) cells.pop_back();
    if (cells.size() > kMaxTextColumns) {
      return bad_data("the table has too many columns", std::string(kWriteAgain), line_place(line.number));
    }
    if (key == "Interval") {
      const auto differs = [&](const std::string& cell) { return !cell.empty() && cell != cells.front(); };
      interval_ = cells.empty() ? std::nullopt : interval_of(cells.front());
      if (!interval_ || std::ranges::any_of(cells, differs)) {
        return bad_data(fmt::format("'{}' states no interval common to all channels", label_of(line.text)),
                        "export channels of equal rate", line_place(line.number));
      }
      contents_.rate_hz = 1.0 / *interval_;
      contents_.rate_from = fmt::format("line {}, '{}'", line.number, label_of(line.text));
    } else if (key == "ChannelTitle") {
      titles_ = std::move(cells);
    } else if (key == "UnitName") {
      units_ = std::move(cells);
    } else if (key == "Range") {
      ranges_ = std::move(cells);
    } else if (key == "ExcelDateTime" && !cells.empty()) {
      contents_.metadata["recorded"] = cells.back();
    }
    return {};
  }

  Result<void> begin_block(const TextLine& line, std::size_t cells) {
    if (!interval_ || titles_.empty()) {
      return bad_data("there are numbers below a header without Interval= or ChannelTitle=",
                      "export it from LabChart with its block header", line_place(line.number));
    }
    extra_ = std::max(cells, titles_.size()) - titles_.size();
    if (cells < titles_.size() || extra_ > 2) {
      return bad_data(fmt::format("the row has {} cells, but the header has {} titles", cells, titles_.size()),
                      std::string(kWriteAgain), line_place(line.number));
    }
    rows_.emplace(titles_.size() + 1, bytes_);
    return {};
  }

  /// "0.001<tab>1<tab>2<tab>#* a comment".
  Result<void> add(const TextLine& line) {
    auto cells = split(line.text, separator_);
    const auto comment =
        std::ranges::find_if(cells, [](std::string_view cell) { return mbk::trimmed(cell, " \"").starts_with('#'); });
    std::string said;
    if (comment != cells.end()) {
      said = label_of(line.text.substr(static_cast<std::size_t>(comment->data() - line.text.data())));
      cells.erase(comment, cells.end());
    }
    if (!rows_) {
      while (cells.size() > titles_.size() && is_blank(cells.back())) cells.pop_back();
      MBK_TRY(begin_block(line, cells.size()));
      numeric_ = extra_ > 0 && number_of(cells.front(), true).has_value();
    }
    const std::size_t columns = titles_.size() + extra_;
    while (cells.size() > columns && is_blank(cells.back())) cells.pop_back();
    if (cells.size() < columns && !line.terminated) {
      contents_.notes.push_back(note_of_cut(line));
      return {};
    }
    if (cells.size() != columns) {
      return bad_data(fmt::format("the row has {} cells, the rows above have {}", cells.size(), columns),
                      std::string(kWriteAgain), line_place(line.number));
    }
    std::vector<std::string_view> numbers{numeric_ ? cells.front() : std::string_view()};
    numbers.insert(numbers.end(), cells.begin() + static_cast<std::ptrdiff_t>(extra_), cells.end());
    const bool commas = separator_ != ',' &&
                        std::ranges::any_of(numbers, [](std::string_view cell) { return cell.find(',') != cell.npos; });
    MBK_TRY(rows_->add(line, numbers, commas));
    if (!said.empty()) {
      const std::size_t last = rows_->count() - 1;
      contents_.events.push_back(
          {numeric_ ? rows_->column(0)[last] : static_cast<double>(last) * *interval_, said.substr(1), 0.0});
    }
    return {};
  }

  Result<void> end_block() {
    contents_.format = "LabChart text";
    contents_.table = true;
    if (numeric_) rows_->give(0, add_array(contents_, "time", "s", 0.0));
    if (extra_ > 0 && !numeric_)
      contents_.notes.emplace_back("its times of day were ignored: the interval defines the time");
    std::vector<std::string> names = titles_;
    settle_names(names);
    for (std::size_t c = 0; c < names.size(); ++c) {
      std::string unit = c < units_.size() && units_[c] != "*" ? units_[c] : "";
      const auto range = c < ranges_.size() ? words(ranges_[c]) : std::vector<std::string_view>();
      if (unit.empty() && range.size() > 1) unit = std::string(range.back());
      rows_->give(c + 1, add_array(contents_, names[c], std::move(unit), 0.0));
    }
    contents_.notes.push_back(
        fmt::format("{}: the sampling rate is {:.6g} Hz", contents_.rate_from, contents_.rate_hz));
    note_obstacles("vectors", contents_);
    const std::size_t samples = static_cast<std::size_t>(contents_.arrays.back().values.size());
    records_.push_back(
        {{std::to_string(records_.size() + 1), fmt::format("{} samples", samples)}, std::move(contents_)});
    contents_ = {};
    rows_.reset();
    interval_.reset();
    titles_.clear();
    units_.clear();
    ranges_.clear();
    return {};
  }

  TextLines lines_;
  std::size_t bytes_;
  char separator_ = '\t';
  // The block that is read:
  std::optional<double> interval_;  ///< [s]
  std::vector<std::string> titles_, units_, ranges_;
  std::size_t extra_ = 0;  ///< columns before those of the channels: time, perhaps date
  bool numeric_ = false;   ///< the first column is a time
  std::optional<TextRows> rows_;
  Contents contents_;
  std::vector<NamedContents> records_;
};

// ---- Spike2 ----

class Spike2 {
 public:
  explicit Spike2(std::span<const std::byte> file) : lines_(text_of(file)) {}

  Result<Contents> run() {
    contents_.format = "Spike2 text";
    for (auto line = lines_.next_filled(); line; line = lines_.next_filled()) {
      const auto labels = labels_of(line->text, separator_of(line->text));
      if (is_word(line->text, labels, "CHANNEL")) {
        channels_.push_back({labels.size() > 1 ? labels[1] : ""});
      } else if (channels_.empty()) {
        continue;  // INFORMATION, SUMMARY
      } else if (is_word(line->text, labels, "START")) {
        MBK_TRY(start(*line, labels));
      } else
        MBK_TRY(add(*line, labels));
    }
    MBK_TRY(take());
    return std::move(contents_);
  }

 private:
  struct Segment {
    double start, interval;
    std::size_t first = 0;  ///< sample
    bool operator==(const Segment&) const = default;
  };
  struct ChannelSection {
    std::string number;
    std::vector<std::string> header = {};  ///< type, comment, title, unit
    std::vector<Segment> segments = {};
    std::vector<double> values = {};

    [[nodiscard]] bool is_waveform() const { return !segments.empty(); }
    [[nodiscard]] std::string at(std::size_t k) const { return k < header.size() ? header[k] : ""; }
  };

  static bool is_word(std::string_view line, const std::vector<std::string>& labels, std::string_view word) {
    return labels.front() == word && mbk::trimmed(line, " \t").starts_with('"');
  }

  Result<void> start(const TextLine& line, const std::vector<std::string>& labels) {
    ChannelSection& channel = channels_.back();
    const auto begin = labels.size() > 1 ? number_of(labels[1], true) : std::nullopt;
    const auto interval = labels.size() > 2 ? interval_of(labels[2]) : std::nullopt;
    if (!begin || !std::isfinite(*begin) || !interval) {
      return bad_data(fmt::format("'{}' states no start and sampling interval", label_of(line.text)),
                      "export the channels as waveforms, or as MAT", line_place(line.number));
    }
    channel.segments.push_back({*begin, *interval, channel.values.size()});
    return {};
  }

  Result<void> add(const TextLine& line, const std::vector<std::string>& labels) {
    ChannelSection& channel = channels_.back();
    constexpr std::size_t kHeader = 4;
    if (!channel.is_waveform()) {
      if (channel.header.size() < kHeader) channel.header.emplace_back(mbk::trimmed(labels.front()));
      return {};  // the times of events
    }
    const auto value = labels.size() == 1 || is_blank(labels[1]) ? number_of(labels.front(), true) : std::nullopt;
    if (!value && !line.terminated) {
      contents_.notes.push_back(note_of_cut(line));
      return {};
    }
    if (!value) {
      return bad_data(fmt::format("'{}' is not one number", label_of(line.text.substr(0, 40))),
                      "export the channels as text with one number per line, or as MAT", line_place(line.number));
    }
    channel.values.push_back(*value);
    return {};
  }

  static Vector times_of(const ChannelSection& channel) {
    Vector times(std::ssize(channel.values));
    for (std::size_t s = 0; s < channel.segments.size(); ++s) {
      const Segment& segment = channel.segments[s];
      const std::size_t end = s + 1 < channel.segments.size() ? channel.segments[s + 1].first : channel.values.size();
      times.segment(static_cast<Index>(segment.first), static_cast<Index>(end - segment.first)) =
          even_times(segment.start, segment.interval, end - segment.first);
    }
    return times;
  }

  Result<void> take() {
    std::vector<std::string> names;
    std::vector<const ChannelSection*> clocks;
    std::vector<int> clock_of;
    for (const ChannelSection& channel : channels_) {
      names.push_back(channel.at(2).empty() ? "Channel " + channel.number : channel.at(2));
      const auto same = [&](const ChannelSection* other) {
        return other->segments == channel.segments && other->values.size() == channel.values.size();
      };
      if (!channel.is_waveform()) {
        clock_of.push_back(-1);
        continue;
      }
      const auto known = std::ranges::find_if(clocks, same);
      clock_of.push_back(static_cast<int>(known - clocks.begin()));
      if (known == clocks.end()) clocks.push_back(&channel);
    }
    if (clocks.empty())
      return bad_data("the file contains no CHANNEL section with a START and a sampling interval",
                      "export the channels as waveforms, or as MAT");
    number_repeated(names);
    const bool one = clocks.size() == 1;
    if (one) add_array(contents_, "time", "s", 0.0).values = SharedMatrix::of_column(times_of(*clocks.front()));
    for (const ChannelSection* clock : clocks) {
      if (!one)
        contents_.clocks.push_back({names[static_cast<std::size_t>(clock - channels_.data())], times_of(*clock)});
    }
    for (std::size_t k = 0; k < channels_.size(); ++k) {
      const ChannelSection& channel = channels_[k];
      Array& array = add_array(contents_, names[k], channel.at(3), 0.0);
      array.clock = one ? -1 : clock_of[k];
      array.signal = true;
      if (channel.is_waveform()) {
        array.values = SharedMatrix::of_column(
            Vector(Eigen::Map<const Vector>(channel.values.data(), std::ssize(channel.values))));
        continue;
      }
      array.obstacle = bad_data(fmt::format("'{}' is a channel of {}", names[k],
                                            channel.at(0).empty() ? "events" : "type " + channel.at(0)),
                                "export it as a waveform")
                           .value();
    }
    note_obstacles("no waveform", contents_);
    return {};
  }

  TextLines lines_;
  std::vector<ChannelSection> channels_;
  Contents contents_;
};

}  // namespace physiology

bool looks_like_acqknowledge(std::string_view text) {
  TextLines lines(text);
  auto line = lines.next_filled();
  if (line && !physiology::interval_of_sample(line->text)) line = lines.next_filled();
  if (!line || !physiology::interval_of_sample(line->text)) return false;
  line = lines.next_filled();
  return line && physiology::channel_count(line->text);
}

Result<Contents> decode_acqknowledge(std::span<const std::byte> file) {
  return physiology::AcqKnowledge(file).run();
}

bool looks_like_labchart(std::string_view text) {
  const auto line = TextLines(text).next_filled();
  return line && mbk::trimmed(line->text, " \"").starts_with("Interval=") && text.find("ChannelTitle=") != text.npos;
}

Result<std::vector<NamedContents>> decode_labchart(std::span<const std::byte> file) {
  return physiology::LabChart(file).run();
}

bool looks_like_spike2(std::string_view text) {
  const auto line = TextLines(text).next_filled();
  if (!line) return false;
  const std::string_view first = mbk::trimmed(line->text, " \t");
  return (first.starts_with("\"INFORMATION\"") || first.starts_with("\"SUMMARY\"") ||
          first.starts_with("\"CHANNEL\"")) &&
         (text.find("\"CHANNEL\"") != text.npos || text.find("\"SUMMARY\"") != text.npos);
}

Result<Contents> decode_spike2(std::span<const std::byte> file) {
  return physiology::Spike2(file).run();
}

}  // namespace mbk::recording
