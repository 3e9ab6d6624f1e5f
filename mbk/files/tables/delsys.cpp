#include "mbk/files/tables/delsys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/trimmed.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/tables/text_rows.h"

namespace mbk::recording {
namespace delsys {

/// "X[s]", "X [s]", "EMG 1 Time Series (s)".
bool is_own_time(const std::string& label) {
  std::string bare = in_lower_case(label);
  std::erase(bare, ' ');
  return bare == "x[s]" || bare == "x(s)" || bare.ends_with("timeseries(s)");
}

bool is_delsys_header(const std::vector<std::string>& labels) {
  return labels.size() > 1 && is_own_time(labels.front()) && !is_own_time(labels[1]);
}

/// "EMG 1 [V]" is EMG 1 in V.
std::pair<std::string, std::string> name_and_unit(const std::string& label) {
  const auto open = label.find_last_of("[(");
  if (open == label.npos || (!label.ends_with(']') && !label.ends_with(')'))) return {label, ""};
  return {std::string(mbk::trimmed(label.substr(0, open))), label.substr(open + 1, label.size() - open - 2)};
}

/// "EMG 1" and "mV" of "Label: EMG 1 Sampling frequency: 1000 … Unit: mV Domain …".
std::optional<std::pair<std::string, std::string>> label_and_unit(std::string_view line) {
  constexpr std::string_view kLabel = "Label:", kRate = "Sampling frequency:", kUnit = " Unit:";
  line = mbk::trimmed(line, " \"");
  const auto rate = line.find(kRate), unit = line.find(kUnit);
  if (!line.starts_with(kLabel) || rate == line.npos || unit == line.npos || rate < kLabel.size()) return std::nullopt;
  const auto after = words(line.substr(unit + kUnit.size()));
  if (after.empty()) return std::nullopt;
  return std::pair(label_of(line.substr(kLabel.size(), rate - kLabel.size())), label_of(after.front()));
}

class DelsysDecoder {
 public:
  explicit DelsysDecoder(std::span<const std::byte> file) : lines_(text_of(file)), bytes_(file.size()) {}

  Result<Contents> run() {
    contents_.format = "Delsys CSV";
    contents_.table = true;
    MBK_TRY(read_header());
    TextRows rows(labels_.size(), bytes_);
    MBK_TRY(read_rows(rows));
    group(rows);
    take(rows);
    if (above_ > 0) {
      contents_.notes.push_back(fmt::format("{} lines of text above its numbers were ignored", above_));
    }
    return std::move(contents_);
  }

 private:
  Result<void> read_header() {
    std::optional<TextLine> line = lines_.next_filled();
    for (; line; line = lines_.next_filled(), ++above_) {
      separator_ = separator_of(line->text);
      labels_ = labels_of(line->text, separator_);
      if (is_delsys_header(labels_)) break;
      if (auto said = label_and_unit(line->text)) units_.insert(std::move(*said));
      // The sensors are above their modes, or above the names.
      if (!in_lower_case(labels_.front()).starts_with("sensor mode")) sensors_ = labels_;
    }
    if (!line) return bad_data("the header has no row of names", std::string(kWriteAgain));
    while (!labels_.empty() && labels_.back().empty()) labels_.pop_back();
    if (labels_.size() > kMaxTextColumns) {
      return bad_data(fmt::format("the header names {} columns", labels_.size()), "export fewer columns");
    }
    return {};
  }

  Result<void> read_rows(TextRows& rows) {
    for (auto line = lines_.next_filled(); line; line = lines_.next_filled()) {
      if (rows.count() == 0 && is_text(line->text)) {
        ++above_;  // as a row of rates
        continue;
      }
      if (is_cut(*line, split(line->text, separator_).size(), labels_.size())) {
        contents_.notes.push_back(note_of_cut(*line));
        break;
      }
      MBK_TRY(add_row(rows, *line, separator_, labels_.size()));
    }
    if (rows.count() == 0) return bad_data("there is no sample below the names", "nothing was recorded");
    return {};
  }

  [[nodiscard]] bool is_text(std::string_view line) const {
    return std::ranges::any_of(split(line, separator_), [this](std::string_view cell) {
      return !cell_number(cell) && (separator_ == ',' || !comma_number(cell));
    });
  }

  /// Numbers up to the last that is there.
  static std::span<const double> filled(const TextRows& rows, std::size_t column) {
    std::span<const double> numbers = rows.column(column);
    while (!numbers.empty() && std::isnan(numbers.back())) numbers = numbers.first(numbers.size() - 1);
    return numbers;
  }
  static Vector vector_of(std::span<const double> numbers) {
    return Eigen::Map<const Vector>(numbers.data(), std::ssize(numbers));
  }

  /// Which signals have which times.
  void group(const TextRows& rows) {
    std::size_t own = 0;
    for (std::size_t c = 0; c < labels_.size(); ++c) {
      if (is_own_time(labels_[c])) {
        const auto same = [&](std::size_t other) { return std::ranges::equal(filled(rows, c), filled(rows, other)); };
        own = static_cast<std::size_t>(std::ranges::find_if(times_, same) - times_.begin());
        if (own == times_.size()) times_.push_back(c);
      } else if (!labels_[c].empty()) {
        signals_.push_back({c, own, name_and_unit(labels_[c]).first});
      }
    }
    std::vector<std::string> names;
    for (const Signal& signal : signals_) names.push_back(signal.name);
    std::ranges::sort(names);
    if (std::ranges::adjacent_find(names) != names.end()) {
      std::string sensor;
      for (std::size_t c = 0, k = 0; c < labels_.size() && k < signals_.size(); ++c) {
        if (c < sensors_.size() && !sensors_[c].empty()) sensor = sensors_[c];
        if (signals_[k].column == c) {
          if (!sensor.empty()) signals_[k].name = sensor + ": " + signals_[k].name;
          ++k;
        }
      }
    }
    names.clear();
    for (const Signal& signal : signals_) names.push_back(signal.name);
    number_repeated(names);
    for (std::size_t k = 0; k < names.size(); ++k) signals_[k].name = names[k];
  }

  void take(const TextRows& rows) {
    const bool one = times_.size() == 1;
    if (one) {
      add_array(contents_, "time", "s", 0.0).values = SharedMatrix::of_column(vector_of(filled(rows, times_.front())));
    }
    for (std::size_t t = 0; t < times_.size() && !one; ++t) {
      const auto first = std::ranges::find(signals_, t, &Signal::time);
      contents_.clocks.push_back(
          {first == signals_.end() ? labels_[times_[t]] : first->name, vector_of(filled(rows, times_[t]))});
    }
    for (const Signal& signal : signals_) {
      const auto said = units_.find(signal.name);
      std::string unit = name_and_unit(labels_[signal.column]).second;
      if (unit.empty() && said != units_.end()) unit = said->second;
      Array& array = add_array(contents_, signal.name, std::move(unit), 0.0);
      array.clock = one ? -1 : static_cast<int>(signal.time);
      array.obstacle = rows.obstacle(signal.column);
      const auto count = filled(rows, times_[signal.time]).size();
      if (!array.obstacle) array.values = SharedMatrix::of_column(vector_of(rows.column(signal.column).first(count)));
    }
  }

  struct Signal {
    std::size_t column, time;  ///< `time`: which of `times_`
    std::string name;
  };
  TextLines lines_;
  std::size_t bytes_;
  char separator_ = ',';
  std::vector<std::string> labels_, sensors_;
  std::map<std::string, std::string> units_;  ///< of labels, as lines above say them
  std::size_t above_ = 0;
  std::vector<std::size_t> times_;  ///< columns of time that differ
  std::vector<Signal> signals_;
  Contents contents_;
};

}  // namespace delsys

bool looks_like_delsys(std::string_view text) {
  const auto holds = [](std::string_view where) {
    return where.find("[s]") != where.npos || where.find("(s)") != where.npos;
  };
  if (!holds(text)) return false;
  TextLines lines(text);
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) {
    if (holds(line->text) && delsys::is_delsys_header(labels_of(line->text, separator_of(line->text)))) return true;
  }
  return false;
}

Result<Contents> decode_delsys(std::span<const std::byte> file) {
  return delsys::DelsysDecoder(file).run();
}

}  // namespace mbk::recording
