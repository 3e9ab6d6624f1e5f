#include "mbk/files/tables/octave_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/contents/said_rates.h"
#include "mbk/files/contents/text_lines.h"

namespace mbk::recording {
namespace {

/// What "# key: value" says, where the line says that.
std::optional<std::string_view> said(const TextLine& line, std::string_view key) {
  std::string_view text = line.text;
  if (!text.starts_with("# ") && !text.starts_with("% ")) return std::nullopt;
  text.remove_prefix(2);
  if (!text.starts_with(key) || text.size() <= key.size() || text[key.size()] != ':') return std::nullopt;
  text.remove_prefix(key.size() + 1);
  return text.starts_with(' ') ? text.substr(1) : text;
}

std::optional<double> octave_number(std::string_view word) {
  if (word == "NA") return std::numeric_limits<double>::quiet_NaN();
  return general_number(word);
}

class OctaveDecoder {
 public:
  explicit OctaveDecoder(std::string_view text) : lines_(text), room_for_ranges_(largest_claim(text.size()) / 4) {}

  Result<Contents> run() {
    contents_.format = "Octave text";
    for (line_ = lines_.next(); line_;) {
      const auto name = said(*line_, "name");
      if (!name) {
        line_ = lines_.next();
        continue;
      }
      MBK_TRY(variable(printable(std::string(*name)), 0));
    }
    give_rates(contents_);
    return std::move(contents_);
  }

 private:
  static constexpr int kDeepest = 16;

  /// The value behind "# name: …", which is the line that is worked on. Afterwards that is the first behind it.
  Result<void> variable(const std::string& name, int depth) {
    line_ = lines_.next();
    const auto type = line_ ? said(*line_, "type") : std::nullopt;
    if (!type) return cut(name);
    std::string kind(*type);
    if (kind.starts_with("global ")) kind.erase(0, 7);
    const auto is = [&](std::string_view one) { return kind == one; };
    const bool integer = kind.starts_with("int") || kind.starts_with("uint");
    if (is("scalar") || is("float scalar") || is("bool") || (integer && kind.ends_with("scalar"))) return scalar(name);
    if (is("matrix") || is("float matrix") || is("bool matrix") || (integer && kind.ends_with("matrix"))) {
      return matrix(name);
    }
    if (is("range") || is("double_range")) return range(name);
    if (is("string") || is("sq_string")) return texts(name);
    if (is("scalar struct") && depth < kDeepest) return structure(name, depth);
    if (depth == 0 || !discarding_) {
      contents_.notes.push_back(fmt::format("variable '{}' is of the kind '{}', which is not read; ignored", name,
                                            printable(kind.substr(0, 40))));
    }
    if ((is("cell") || is("struct")) && depth < kDeepest) return discard(name, depth, is("cell"));
    return skip();
  }

  /// What holds variables of its own.
  Result<void> discard(const std::string& name, int depth, bool cells) {
    Contents kept = std::move(contents_);
    const bool outer = std::exchange(discarding_, true);
    contents_ = {};
    auto done = cells ? elements(name, depth) : structure(name, depth);
    contents_ = std::move(kept);
    discarding_ = outer;
    return done;
  }

  Result<void> elements(const std::string& name, int depth) {
    std::uint64_t number = 1;
    for (const std::string_view key : {"rows", "columns"}) {
      line_ = lines_.next();
      if (line_ && said(*line_, "ndims")) {  // more than two dimensions stand in a line of their own
        const auto sizes = lines_.next();
        for (const std::string_view word : words(sizes ? sizes->text : std::string_view())) {
          const auto length = MBK_TRY(whole(name, word));
          number = std::min(number * std::min<std::uint64_t>(length, lines_.left() + 1), lines_.left() + 1);
        }
        break;
      }
      const auto value = line_ ? said(*line_, key) : std::nullopt;
      if (!value) return cut(name);
      const auto length = MBK_TRY(whole(name, *value));
      number = std::min(number * std::min<std::uint64_t>(length, lines_.left() + 1), lines_.left() + 1);
    }
    line_ = lines_.next();
    for (std::uint64_t k = 0; k < number; ++k) {
      while (line_ && !said(*line_, "name")) line_ = lines_.next();
      if (!line_) return cut(name);
      MBK_TRY(variable(name, depth + 1));
    }
    return {};
  }

  /// To the next variable.
  Result<void> skip() {
    for (line_ = lines_.next(); line_ && !said(*line_, "name");) line_ = lines_.next();
    return {};
  }

  static tl::unexpected<Error> cut(const std::string& name) {
    return bad_data("it is cut short", "save it again", fmt::format("variable '{}'", name));
  }

  tl::unexpected<Error> wrong(const std::string& name, std::string_view word) const {
    return bad_data(fmt::format("'{}' is not a number", printable(std::string(word.substr(0, 40)))), "save it again",
                    fmt::format("line {}, variable '{}'", line_ ? line_->number : 0, name));
  }

  /// "# key: N" in the next line.
  Result<std::uint64_t> count(const std::string& name, std::string_view key) {
    line_ = lines_.next();
    const auto value = line_ ? said(*line_, key) : std::nullopt;
    if (!value) return cut(name);
    return whole(name, *value);
  }

  Result<std::uint64_t> whole(const std::string& name, std::string_view text) const {
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return wrong(name, text);
    return number;
  }

  Array& add(const std::string& name, std::uint64_t rows, std::uint64_t columns) {
    Array& array = contents_.arrays.emplace_back();
    array.name = name;
    array.values.resize(static_cast<Index>(rows), static_cast<Index>(columns));
    return array;
  }

  Result<void> scalar(const std::string& name) {
    line_ = lines_.next_filled();
    if (!line_) return cut(name);
    const auto found = words(line_->text);
    const auto value = octave_number(found.front());
    if (found.size() != 1 || !value) return wrong(name, line_->text);
    Array& added = add(name, 1, 1);
    added.values(0, 0) = *value;
    added.rests.put(0, rest_of_cell(found.front()));
    line_ = lines_.next();
    return {};
  }

  /// No number takes less than a digit and what parts it from the next.
  Result<void> check_size(const std::string& name, std::uint64_t rows, std::uint64_t columns) const {
    const std::uint64_t room = lines_.left() / 2 + 1;
    if (columns > 0 && rows > room / columns) {
      return bad_data(
          fmt::format("{}×{} numbers need more than the {} bytes that are left", rows, columns, lines_.left()),
          "save it again", fmt::format("variable '{}'", name));
    }
    if (rows > (std::uint64_t{1} << 40) || columns > (std::uint64_t{1} << 40)) return cut(name);
    return check_memory(8 * rows * columns);
  }

  Result<void> matrix(const std::string& name) {
    line_ = lines_.next();
    if (!line_) return cut(name);
    if (said(*line_, "ndims")) return array(name);
    const auto rows_said = said(*line_, "rows");
    if (!rows_said) return cut(name);
    const auto rows = MBK_TRY(whole(name, *rows_said));
    const auto columns = MBK_TRY(count(name, "columns"));
    MBK_TRY(check_size(name, rows, columns));
    Matrix values(static_cast<Index>(rows), static_cast<Index>(columns));
    Rests rests;
    for (Index r = 0; r < (columns > 0 ? values.rows() : 0); ++r) {
      line_ = lines_.next_filled();
      if (!line_) return cut(name);
      const auto found = words(line_->text);
      if (found.size() != columns) {
        return bad_data(fmt::format("{} numbers where {} are expected", found.size(), columns), "save it again",
                        fmt::format("line {}, variable '{}'", line_->number, name));
      }
      for (Index c = 0; c < values.cols(); ++c) {
        const auto value = octave_number(found[static_cast<std::size_t>(c)]);
        if (!value) return wrong(name, found[static_cast<std::size_t>(c)]);
        values(r, c) = *value;
        if (std::abs(*value) >= kExactWhole) {
          rests.put(static_cast<std::size_t>(c * values.rows() + r), rest_of_cell(found[static_cast<std::size_t>(c)]));
        }
      }
    }
    Array& added = contents_.arrays.emplace_back();
    added.name = name;
    added.rests = std::move(rests);
    added.values = SharedMatrix(std::move(values));
    line_ = lines_.next();
    return {};
  }

  /// "# ndims: 2", the dimensions, and then one number a line, column by column.
  Result<void> array(const std::string& name) {
    const auto dimensions = MBK_TRY(whole(name, *said(*line_, "ndims")));
    line_ = lines_.next_filled();
    if (!line_) return cut(name);
    const auto sizes = words(line_->text);
    std::vector<std::uint64_t> lengths;
    for (const std::string_view word : sizes) {
      const auto length = MBK_TRY(whole(name, word));
      lengths.push_back(length);
    }
    if (lengths.size() != dimensions || lengths.size() < 2) return cut(name);
    const std::vector<std::uint64_t> sides = lengths;
    std::uint64_t others = 1;
    for (std::size_t d = 1; d < sides.size(); ++d) {
      if (sides[d] != 0 && others > lines_.left() / sides[d]) return cut(name);
      others *= sides[d];
    }
    MBK_TRY(check_size(name, sides[0], others));
    if (sides.size() > 2) {  // those of 1 count for nothing; of more than two others only slices are signals
      std::erase(lengths, std::uint64_t{1});
      if (lengths.size() > 2) lengths = {sides[0] * others};
      lengths.resize(2, 1);
    }
    Matrix values(static_cast<Index>(lengths[0]), static_cast<Index>(lengths[1]));
    Rests rests;
    std::size_t at = 0;
    for (double& value : values.reshaped()) {
      line_ = lines_.next_filled();
      if (!line_) return cut(name);
      const auto found = words(line_->text);
      const auto number = octave_number(found.front());
      if (found.size() != 1 || !number) return wrong(name, line_->text);
      value = *number;
      if (std::abs(value) >= kExactWhole) rests.put(at, rest_of_cell(found.front()));
      ++at;
    }
    Array& added = contents_.arrays.emplace_back();
    added.name = name;
    added.rests = std::move(rests);
    if (sides.size() > 2) added.shape = sides;
    added.values = SharedMatrix(std::move(values));
    line_ = lines_.next();
    return {};
  }

  /// "# base, limit, increment" and the three numbers.
  Result<void> range(const std::string& name) {
    line_ = lines_.next();
    if (line_ && line_->text.starts_with("# base")) line_ = lines_.next();
    if (!line_) return cut(name);
    const auto found = words(line_->text);
    std::vector<double> numbers;
    for (const std::string_view word : found) {
      const auto value = octave_number(word);
      if (!value) return wrong(name, word);
      numbers.push_back(*value);
    }
    if (numbers.size() < 3) return cut(name);
    const double steps = (numbers[1] - numbers[0]) / numbers[2];
    if (!(steps >= 0.0 && 8.0 * steps < static_cast<double>(room_for_ranges_))) {
      return bad_data(fmt::format("the range from {} to {} by {} is not read", numbers[0], numbers[1], numbers[2]),
                      "save it as a matrix", fmt::format("variable '{}'", name));
    }
    const auto length = static_cast<Index>(steps * (1.0 + 1e-15) + 1e-9) + 1;
    room_for_ranges_ -= std::min(room_for_ranges_, 8 * static_cast<std::uint64_t>(length));
    Array& array = add(name, 1, static_cast<std::uint64_t>(length));
    for (Index k = 0; k < length; ++k) array.values(0, k) = numbers[0] + static_cast<double>(k) * numbers[2];
    line_ = lines_.next();
    return {};
  }

  Result<void> texts(const std::string& name) {
    const auto elements = MBK_TRY(count(name, "elements"));
    Text text{name, {}};
    for (std::uint64_t k = 0; k < elements; ++k) {
      MBK_TRY(count(name, "length"));
      line_ = lines_.next();
      if (!line_) return cut(name);
      text.lines.push_back(printable(std::string(line_->text)));
    }
    contents_.texts.push_back(std::move(text));
    line_ = lines_.next();
    return {};
  }

  Result<void> structure(const std::string& name, int depth) {
    line_ = lines_.next();
    if (line_ && said(*line_, "ndims")) {
      lines_.next();  // 1 1
      line_ = lines_.next();
    }
    const auto fields_said = line_ ? said(*line_, "length") : std::nullopt;
    if (!fields_said) return cut(name);
    const auto fields = MBK_TRY(whole(name, *fields_said));
    for (std::uint64_t k = 0; k < fields; ++k) {
      while (line_ && !said(*line_, "name")) line_ = lines_.next();
      if (!line_) return cut(name);
      const std::string field = fmt::format("{}.{}", name, printable(std::string(*said(*line_, "name"))));
      MBK_TRY(variable(field, depth + 1));
    }
    return {};
  }

  TextLines lines_;
  std::optional<TextLine> line_;
  Contents contents_;
  bool discarding_ = false;        ///< what is read is kept nowhere
  std::uint64_t room_for_ranges_;  ///< [bytes]: a range stands in a few bytes, whatever its length
};

}  // namespace

bool looks_like_octave_text(std::string_view text) {
  constexpr int kFirst = 4;
  TextLines lines(text.substr(0, std::min<std::size_t>(text.size(), 4096)));
  bool name = false;
  for (int k = 0; k < kFirst; ++k) {
    const auto line = lines.next();
    if (!line) return false;
    if (k == 0 && (line->text.starts_with("# Created by Octave") || line->text.starts_with("% Created by Octave"))) {
      return true;
    }
    if (name) return said(*line, "type").has_value();
    name = said(*line, "name").has_value();
  }
  return false;
}

Result<Contents> decode_octave_text(std::span<const std::byte> file) {
  return OctaveDecoder({reinterpret_cast<const char*>(file.data()), file.size()}).run();
}

}  // namespace mbk::recording
