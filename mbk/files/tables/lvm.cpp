#include "mbk/files/tables/lvm.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "mbk/base/core/trimmed.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/tables/text_rows.h"

namespace mbk::recording {
namespace lvm {

constexpr std::string_view kBegin = "LabVIEW Measurement", kEndOfHeader = "***End_of_Header***",
                           kBeginSpecial = "***Start_Special***", kEndSpecial = "***End_Special***";
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// How the numbers of a file are written.
struct Style {
  char separator = '\t';
  std::optional<char> decimal;  ///< nothing where the header does not say it, as up to version 0.92
  std::string x_columns = "one";
};

/// A line of a header for each of its keys: the values of the columns, the key's place in front.
using Header = std::map<std::string, std::vector<std::string>>;

struct Segment {
  Style style;
  Header header;
  std::vector<std::string> labels;  ///< of the columns, without that of comments
  bool comments = false;            ///< a column of comments follows them
  TextRows rows;
  std::optional<double> start;  ///< [s] when it was begun
  std::string started;          ///< the same, as the file says it
  bool same_header = false;     ///< as the segment before
  std::size_t commented = 0;    ///< lines with a comment

  [[nodiscard]] bool has_one_x() const { return style.x_columns == "one"; }
  [[nodiscard]] bool has_no_x() const { return style.x_columns == "no"; }
  [[nodiscard]] std::string said(const char* key, std::size_t column) const {
    const auto line = header.find(key);
    return line == header.end() || column >= line->second.size() ? "" : line->second[column];
  }
  [[nodiscard]] std::optional<double> number(const char* key, std::size_t column) const {
    std::string text = said(key, column);
    if (text.empty()) return std::nullopt;
    std::ranges::replace(text, ',', '.');
    return general_number(text);
  }
  /// [s] between samples; absent if the file does not state it.
  [[nodiscard]] std::optional<double> interval(std::size_t column) const {
    const auto delta = number("delta_x", column);
    const bool said = delta && *delta > 1e-12 && *delta < 1e9 && *delta != 1.0 && is_in_time(column);
    return said ? delta : std::nullopt;
  }
  [[nodiscard]] bool is_in_time(std::size_t column) const {
    const std::string dimension = in_lower_case(said("x_dimension", column));
    return dimension.empty() || dimension == "time";
  }
  /// The columns that hold signals.
  [[nodiscard]] std::vector<std::size_t> signals() const {
    std::vector<std::size_t> columns;
    for (std::size_t c = 0; c < labels.size(); ++c) {
      if (!is_x(c)) columns.push_back(c);
    }
    return columns;
  }
  [[nodiscard]] bool is_x(std::size_t column) const {
    return column == 0 || (style.x_columns == "multi" && in_lower_case(labels[column]) == "x_value");
  }
  /// The column of X that belongs to a signal.
  [[nodiscard]] std::size_t x_of(std::size_t column) const {
    while (!is_x(column)) --column;
    return column;
  }
};

/// Rows of a segment.
struct Part {
  const Segment* segment;
  std::size_t begin, end;
  double later = 0.0;  ///< [s] than the first part of its record

  [[nodiscard]] double at(std::size_t column, std::size_t row) const { return segment->rows.column(column)[row]; }
  [[nodiscard]] std::size_t size() const { return end - begin; }
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> file) : lines_(text_of(file)), bytes_(file.size()) {}

  Result<void> read() {
    std::optional<TextLine> line = next_line();
    while (line) {
      const std::string_view text = line->text;
      if (text.starts_with(kBeginSpecial)) {
        ++special_blocks;
        while (line && !line->text.starts_with(kEndSpecial)) line = next_line();
        if (line) line = next_line();
        continue;
      }
      if (text.starts_with(kBegin)) {
        MBK_TRY(file_header(*line));
        line = next_line();
        continue;
      }
      if (!is_row(text) && !is_labels(text)) {
        MBK_TRY(segment_header(*line));
        line = next_line();
      }
      line = MBK_TRY(rows(line));
    }
    std::erase_if(segments, [](const Segment& one) { return one.rows.count() == 0; });
    if (segments.empty()) return bad_data("there is no sample after the header", "nothing was recorded");
    return {};
  }

  std::vector<Segment> segments;
  std::size_t special_blocks = 0;
  std::vector<std::string> notes;

 private:
  /// The next line that holds anything between its separators.
  std::optional<TextLine> next_line() {
    for (auto line = lines_.next_filled(); line; line = lines_.next_filled()) {
      if (line->text.find_first_not_of(std::array{' ', '\t', style_.separator, '\0'}.data()) != line->text.npos)
        return line;
    }
    return std::nullopt;
  }
  [[nodiscard]] bool is_number(std::string_view cell) const {
    return cell_number(cell).has_value() || (style_.separator != ',' && comma_number(cell).has_value());
  }
  [[nodiscard]] std::string_view first_cell(std::string_view line) const {
    return mbk::trimmed(line.substr(0, line.find(style_.separator)), " ");
  }
  [[nodiscard]] bool is_row(std::string_view line) const { return is_number(first_cell(line)); }
  [[nodiscard]] bool is_labels(std::string_view line) const { return in_lower_case(first_cell(line)) == "x_value"; }

  /// Behind the first line of the file up to the end of its header.
  Result<void> file_header(const TextLine& first) {
    style_ = {};
    Header header;
    std::vector<TextLine> of_header;
    for (auto line = next_line();; line = next_line()) {
      if (!line) return unending(first);
      if (line->text.starts_with(kEndOfHeader)) break;
      of_header.push_back(*line);
      constexpr std::string_view kSeparator = "separator";
      const std::string lower = in_lower_case(line->text);
      if (lower.size() > kSeparator.size() && lower.starts_with(kSeparator)) {
        style_.separator = lower[kSeparator.size()];  // the key is followed by what it says
      }
    }
    for (const TextLine& line : of_header) add(header, line.text);
    const auto said = [&](const char* key) {
      const auto found = header.find(key);
      return found == header.end() || found->second.size() < 2 ? std::string() : found->second[1];
    };
    const std::string decimal = said("decimal_separator");
    if (!decimal.empty()) style_.decimal = decimal.front();
    const auto parted = header.find("decimal_separator");  // "Decimal_Separator,,"
    if (decimal.empty() && parted != header.end() && style_.separator == ',' && parted->second.size() > 2) {
      style_.decimal = ',';
    }
    if (style_.separator == ',' && style_.decimal == ',') {
      return bad_data("commas separate columns and are also decimal points", "write it with tabs between the columns",
                      line_place(first.number));
    }
    if (const std::string columns = in_lower_case(said("x_columns")); !columns.empty()) style_.x_columns = columns;
    header_ = {};
    file_header_ = std::move(header);
    same_header_ = false;
    return {};
  }

  /// From its first line on up to its end.
  Result<void> segment_header(const TextLine& first) {
    header_.clear();
    same_header_ = false;
    for (std::optional<TextLine> line = first; !line->text.starts_with(kEndOfHeader);) {
      if (is_row(line->text) && line->number != first.number) {
        return bad_data("the header of a segment contains numbers", std::string(kWriteAgain), line_place(line->number));
      }
      add(header_, line->text);
      line = next_line();
      if (!line) return unending(first);
    }
    return {};
  }

  [[nodiscard]] tl::unexpected<Error> unending(const TextLine& first) const {
    return bad_data(fmt::format("'{}' begins a header, but no {} follows",
                                label_of(first_cell(first.text).substr(0, 40)), kEndOfHeader),
                    "the file may be truncated: write it again with LabVIEW", line_place(first.number));
  }

  void add(Header& header, std::string_view line) const {
    std::vector<std::string> cells;
    for (const std::string_view cell : split(line, style_.separator)) cells.push_back(label_of(cell));
    header[in_lower_case(cells.front())] = std::move(cells);
  }

  /// The labels and the rows below them.
  /// @returns  the first line behind them
  Result<std::optional<TextLine>> rows(std::optional<TextLine> line) {
    if (!line) return line;
    if (is_labels(line->text)) {
      labels_.clear();
      for (const std::string_view cell : split(line->text, style_.separator)) labels_.push_back(label_of(cell));
      while (!labels_.empty() && labels_.back().empty()) labels_.pop_back();
      has_comments_ = !labels_.empty() && in_lower_case(labels_.back()) == "comment";
      if (has_comments_) labels_.pop_back();
      line = next_line();
    } else if (!is_row(line->text)) {
      return line;
    } else if (labels_.empty()) {
      labels_.resize(filled_cells_of(line->text, style_.separator).size());
    }
    if (labels_.size() < 2 || labels_.size() > kMaxTextColumns) {
      return bad_data(fmt::format("the segment names {} columns", labels_.size()), std::string(kWriteAgain),
                      line ? line_place(line->number) : "");
    }
    if (line && is_row(line->text)) {
      MBK_TRY(begin_segment());
    }
    for (; line && is_row(line->text); line = next_line()) {
      auto more = MBK_TRY(add_row(*line));
      if (!more) return std::nullopt;
    }
    return line;
  }

  Result<void> begin_segment() {
    columns_ += labels_.size();
    if (segments.size() > 8 && columns_ > 1024 + bytes_ / 16) {
      return bad_data(fmt::format("the file contains more than {} segments with hardly any samples", segments.size()),
                      "write it with one header and continuous X values");
    }
    segments.push_back(
        {style_, header_, labels_, has_comments_, TextRows(labels_.size(), bytes_), {}, "", same_header_});
    Segment& segment = segments.back();
    std::string date = segment.said("date", 1), time = segment.said("time", 1);
    if (time.empty() && segments.size() == 1) {
      const auto of_file = [&](const char* key) {
        const auto line = file_header_.find(key);
        return line == file_header_.end() || line->second.size() < 2 ? "" : line->second[1];
      };
      date = of_file("date"), time = of_file("time");
    }
    // Of a comma for decimals in a file of commas the second half is another cell, and whole seconds do.
    if (!same_header_) {
      segment.started = fmt::format("{} {}, ", date, time.substr(0, 12));
      std::ranges::replace(date, '/', '-');
      if (const auto began = instant(date + " " + time); began && began->day) {
        constexpr double kDay = 86'400.0;
        segment.start = kDay * static_cast<double>(*began->day) + began->seconds;
      }
    }
    same_header_ = true;
    return {};
  }

  /// @returns  whether more may follow
  Result<bool> add_row(const TextLine& line) {
    Segment* segment = &segments.back();
    auto cells = split(line.text, segment->style.separator);
    const std::size_t columns = segment->labels.size();
    while (cells.size() > columns && is_blank(cells.back())) cells.pop_back();
    if (cells.size() > columns && !segment->comments) {
      return bad_data(fmt::format("the line has {} cells, but its segment names {} columns", cells.size(), columns),
                      std::string(kWriteAgain), line_place(line.number));
    }
    if (is_cut(line, cells.size(), columns)) {
      notes.push_back(note_of_cut(line));
      return false;
    }
    const bool commented = cells.size() > columns;
    padded_ += columns - std::min(cells.size(), columns);
    if (padded_ > largest_claim(bytes_) / sizeof(double)) {
      return bad_data(fmt::format("most lines contain far fewer numbers than the {} columns of their segment", columns),
                      std::string(kWriteAgain), line_place(line.number));
    }
    cells.resize(std::min(cells.size(), columns));
    if (!style_.decimal) {
      const auto has_comma = [](std::string_view cell) { return cell.find(',') != cell.npos; };
      if (style_.separator != ',' && std::ranges::any_of(cells, has_comma)) style_.decimal = ',';
    }
    segment->style.decimal = style_.decimal;
    if (begins_anew(*segment, cells.front())) {
      MBK_TRY(begin_segment());
      segment = &segments.back();
    }
    MBK_TRY(segment->rows.add(line, cells, style_.decimal == ','));
    segment->commented += commented ? 1 : 0;
    return true;
  }

  /// Whether X goes back to where the segment began.
  [[nodiscard]] bool begins_anew(const Segment& segment, std::string_view cell) const {
    if (!segment.has_one_x() || segment.rows.count() < 2) return false;
    const auto xs = segment.rows.column(0);
    const auto comma = style_.decimal == ',' ? comma_number(cell) : std::nullopt;
    const double x = comma ? comma->value : cell_number(cell).value_or(kNone);
    return x < xs.back() && x < xs[1];
  }

  TextLines lines_;
  std::size_t bytes_;
  Style style_;
  Header file_header_, header_;
  std::vector<std::string> labels_;
  bool has_comments_ = false, same_header_ = false;
  std::size_t columns_ = 0;   ///< of all segments
  std::uint64_t padded_ = 0;  ///< cells that were missing at the ends of lines
};

/// [s] by how much the samples of `next` are later than those of `first`, where they follow those of `last` as if there
/// were no segments.
std::optional<double> follows(const Part& first, const Part& last, const Part& next) {
  const Segment &a = *last.segment, &b = *next.segment;
  const bool alike = a.labels == b.labels && a.style.x_columns == b.style.x_columns && a.is_in_time(1) &&
                     b.is_in_time(1) && a.interval(1) == b.interval(1) &&
                     a.said("y_unit_label", 1) == b.said("y_unit_label", 1);
  if (b.same_header || !alike || (!a.has_one_x() && !a.has_no_x())) return std::nullopt;
  const auto dt = a.interval(1);
  const double x0_a = a.number("x0", 1).value_or(0.0), x0_b = b.number("x0", 1).value_or(0.0);
  const double end =
      a.has_one_x() ? last.at(0, last.end - 1) : x0_a + static_cast<double>(last.size() - 1) * dt.value_or(0.0);
  const double begin = b.has_one_x() ? next.at(0, next.begin) : x0_b;
  if (a.has_one_x() && dt && std::abs(begin - end - *dt) < 0.5 * *dt) return last.later;  // X is continuous anyway
  if (!a.start || !b.start) return std::nullopt;
  const double apart = *b.start - *a.start, later = *b.start - *first.segment->start;
  if (a.rows.count() == 1 && b.rows.count() == 1 && a.has_one_x() && apart + begin > end) return later;
  return dt && std::abs(apart + begin - end - *dt) < 0.5 * *dt ? std::optional(later) : std::nullopt;
}

/// The records, each of the parts that follow each other.
std::vector<std::vector<Part>> records_of(const std::vector<Segment>& segments) {
  std::vector<std::vector<Part>> records;
  for (const Segment& segment : segments) {
    const std::size_t rows = segment.rows.count();
    const auto samples = segment.number("samples", 1);
    // Without X a single header says how long each segment is.
    const bool several = segment.has_no_x() && samples && *samples >= 2.0 && *samples <= static_cast<double>(rows) &&
                         std::fmod(static_cast<double>(rows), *samples) == 0.0;
    const std::size_t length = several ? static_cast<std::size_t>(*samples) : rows;
    for (std::size_t begin = 0; begin < rows; begin += length) {
      Part part{&segment, begin, begin + length};
      const auto later =
          begin == 0 && !records.empty() ? follows(records.back().front(), records.back().back(), part) : std::nullopt;
      if (later) {
        part.later = *later;
        records.back().push_back(part);
      } else {
        records.push_back({part});
      }
    }
  }
  return records;
}

/// A record as arrays.
class Record {
 public:
  explicit Record(const std::vector<Part>& parts) : parts_(parts), first_(*parts.front().segment) {
    for (const Part& part : parts) samples_ += part.size();
  }

  Contents take() {
    contents_.format = "LVM";
    contents_.table = true;
    if (parts_.size() > 1) {
      contents_.notes.push_back(fmt::format("{} segments without a pause between them were joined", parts_.size()));
    }
    group();
    if (bases_.size() == 1) {
      one_time();
    } else {
      several_times();
    }
    compare();
    note_obstacles("vectors", contents_);
    return std::move(contents_);
  }

 private:
  /// The time definition of some signals: a column of X, or start and interval.
  struct Basis {
    std::optional<std::size_t> x;
    double begin = 0.0, interval = 0.0;  ///< 0: not known
    std::vector<std::size_t> signals = {};
  };

  /// All of a column.
  [[nodiscard]] Vector values(std::size_t column) const {
    Vector all(static_cast<Index>(samples_));
    Index at = 0;
    for (const Part& part : parts_) {
      const auto own = part.segment->rows.column(column).subspan(part.begin, part.size());
      std::ranges::copy(own, all.data() + at);
      if (first_.is_x(column)) all.segment(at, std::ssize(own)).array() += part.later;
      at += std::ssize(own);
    }
    return all;
  }

  /// Samples up to the last that is there.
  [[nodiscard]] Index length(std::size_t column) const {
    for (std::size_t p = parts_.size(); p-- > 0;) {
      const auto own = parts_[p].segment->rows.column(column);
      for (std::size_t row = parts_[p].end; row > parts_[p].begin; --row) {
        if (std::isnan(own[row - 1])) continue;
        std::size_t before = row - parts_[p].begin;
        for (std::size_t k = 0; k < p; ++k) before += parts_[k].size();
        return static_cast<Index>(before);
      }
    }
    return 0;
  }

  /// Signals that have their times in common.
  void group() {
    for (const std::size_t column : first_.signals()) {
      Basis basis{std::nullopt, first_.number("x0", column).value_or(0.0), first_.interval(column).value_or(0.0)};
      if (!first_.has_no_x()) basis.x = first_.x_of(column);
      const bool empty = length(column) == 0 && !first_.rows.obstacle(column);
      const auto same = [&](const Basis& other) {
        if (empty) return true;
        if (other.x && basis.x && *other.x != *basis.x) return same_x(*other.x, *basis.x);
        const bool other_interval = other.interval > 0.0 && basis.interval > 0.0 &&
                                    std::abs(other.interval - basis.interval) > 1e-6 * other.interval;
        return !other_interval && (basis.x || std::abs(other.begin - basis.begin) <= 0.5 * basis.interval);
      };
      const auto found = std::ranges::find_if(bases_, same);
      if (found != bases_.end()) {
        found->signals.push_back(column);
        continue;
      }
      // X is that of the first signal; of another interval only the header speaks.
      if (first_.has_one_x() && !bases_.empty()) basis.x.reset();
      basis.signals.push_back(column);
      bases_.push_back(std::move(basis));
    }
  }

  [[nodiscard]] bool same_x(std::size_t a, std::size_t b) const {
    const Vector one = values(a), other = values(b);
    return std::ranges::equal(one, other,
                              [](double u, double v) { return u == v || (std::isnan(u) && std::isnan(v)); });
  }

  Array& add(std::string name, std::string unit, Vector numbers) {
    Array& array = contents_.arrays.emplace_back();
    array.name = std::move(name);
    array.unit = std::move(unit);
    array.values = SharedMatrix::of_column(std::move(numbers));
    return array;
  }

  void add_signal(std::size_t column, Vector numbers, double interval, int clock) {
    Array& array = add(first_.labels[column], first_.said("y_unit_label", column), std::move(numbers));
    array.rate_hz = interval > 0.0 ? 1.0 / interval : 0.0;
    array.clock = clock;
    if (first_.rows.obstacle(column)) {
      array.obstacle = first_.rows.obstacle(column);
      array.values = SharedMatrix();
    }
  }

  void one_time() {
    const Basis& basis = bases_.front();
    // Of a segment of one sample Delta_X says nothing.
    const bool meant = !basis.x || first_.number("samples", basis.signals.front()).value_or(2.0) > 1.0;
    if (basis.x) {
      const std::string unit = first_.said("x_unit_label", basis.signals.front());
      const bool time = first_.is_in_time(basis.signals.front());
      Array& x = add(first_.labels[*basis.x], unit.empty() && time ? "s" : unit, values(*basis.x));
      if (time) x.means = "time";
    } else if (basis.interval == 0.0) {
      contents_.notes.emplace_back(
          "the header states no sampling rate (Delta_X is missing or 1, which LabVIEW writes if it is unknown)");
    }
    if (!first_.is_in_time(basis.signals.front())) {
      contents_.notes.push_back(
          fmt::format("its X is '{}', which is not a time", first_.said("x_dimension", basis.signals.front())));
    }
    for (const std::size_t column : basis.signals) {
      add_signal(column, values(column), meant ? basis.interval : 0.0, -1);
    }
  }

  void several_times() {
    for (const Basis& basis : bases_) {
      Index count = 0;
      for (const std::size_t column : basis.signals) count = std::max(count, length(column));
      Clock clock{first_.labels[basis.signals.front()], {}};
      if (basis.x) {
        clock.time = values(*basis.x).head(count);
      } else if (basis.interval > 0.0) {
        clock.time =
            Vector::LinSpaced(count, basis.begin, basis.begin + static_cast<double>(count - 1) * basis.interval);
      }
      const int number = clock.time.size() > 0 ? static_cast<int>(contents_.clocks.size()) : -1;
      if (number >= 0) contents_.clocks.push_back(std::move(clock));
      for (const std::size_t column : basis.signals) {
        add_signal(column, values(column).head(count), number < 0 ? basis.interval : 0.0, number);
      }
    }
    contents_.notes.push_back(fmt::format("its channels have {} different time axes", bases_.size()));
  }

  /// Counts in the header.
  void compare() {
    std::size_t commented = 0;
    for (const Part& part : parts_) {
      commented += part.segment->commented;
      const auto said = part.segment->number("samples", 1);
      if (!said || part.segment->same_header) continue;
      const bool longer = part.segment->has_no_x() && *said < static_cast<double>(part.size()) && *said > 0.0;
      if (*said > static_cast<double>(part.size())) compare_counts(said, part.size(), "samples", contents_);
      if (longer) {
        contents_.notes.push_back(fmt::format(
            "the header states {} samples per segment, but {} follow: pauses between segments cannot be detected",
            *said, part.size()));
      }
    }
    if (commented > 0) contents_.notes.push_back(fmt::format("{} comments at line ends were ignored", commented));
  }

  const std::vector<Part>& parts_;
  const Segment& first_;
  std::size_t samples_ = 0;
  std::vector<Basis> bases_;
  Contents contents_;
};

}  // namespace lvm

bool looks_like_lvm(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text.starts_with(lvm::kBegin);
}

Result<std::vector<NamedContents>> decode_lvm(std::span<const std::byte> file) {
  lvm::Reader reader(file);
  MBK_TRY(reader.read());
  std::vector<NamedContents> records;
  const auto all = lvm::records_of(reader.segments);
  if (all.size() > 1024 + file.size() / 256) {
    return bad_data(fmt::format("the file contains {} segments with hardly any samples", all.size()),
                    "write it with one header and continuous X values");
  }
  for (const std::vector<lvm::Part>& parts : all) {
    std::size_t samples = 0;
    for (const lvm::Part& part : parts) samples += part.size();
    NamedContents& record = records.emplace_back();
    record.name = {std::to_string(records.size()),
                   fmt::format("{}{} samples", parts.front().segment->started, samples)};
    record.contents = lvm::Record(parts).take();
    auto& notes = record.contents.notes;
    if (all.size() > 1) {
      notes.insert(notes.begin(),
                   fmt::format("segment {} of {}, each a separate recording", records.size(), all.size()));
    }
    if (reader.special_blocks > 0) notes.emplace_back("special LabVIEW blocks were ignored");
    if (&parts == &all.back()) notes.insert(notes.end(), reader.notes.begin(), reader.notes.end());
  }
  return records;
}

}  // namespace mbk::recording
