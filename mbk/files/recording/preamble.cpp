#include "mbk/files/recording/preamble.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/trimmed.h"
#include "mbk/files/contents/cells.h"

namespace mbk::recording {
namespace preamble {

constexpr std::size_t kLongest = 2000;  ///< characters of a line that are looked at
constexpr std::string_view kSeparators = ",;\t|", kBlank = " \t\"'";

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// "samplingfrequency" of "Sampling_Frequency (Hz)": the letters in front of a bracket, small.
std::string squeezed(std::string_view key) {
  std::string letters;
  for (const char c : key.substr(0, std::min(key.find_first_of("(["), key.size()))) {
    if (is_letter(c)) letters += c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  }
  return letters;
}

/// "Hz" of "Sampling rate (Hz)".
std::string_view in_brackets(std::string_view text) {
  const auto open = text.find_first_of("([");
  if (open == text.npos) return {};
  const auto close = text.find_first_of(")]", open);
  return mbk::trimmed(text.substr(open + 1, std::min(close, text.size()) - open - 1), kBlank);
}

template <std::size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::ranges::find(words, word) != words.end();
}

constexpr auto kRateKeys = std::to_array<std::string_view>({"fs",
                                                            "rate",
                                                            "samplerate",
                                                            "samplingrate",
                                                            "samplefrequency",
                                                            "samplefreq",
                                                            "samplingfreq",
                                                            "sfreq",
                                                            "samplingfrequency",
                                                            "srate",
                                                            "datarate",
                                                            "updaterate",
                                                            "scanrate",
                                                            "acquisitionrate",
                                                            "acquisitionfrequency",
                                                            "framerate",
                                                            "fps",
                                                            "exportframerate",
                                                            "recordingrate",
                                                            "recordingfrequency",
                                                            "loggingrate",
                                                            "lograte",
                                                            "sampledat",
                                                            "recordedat",
                                                            "samplespersecond",
                                                            "abtastrate",
                                                            "abtastfrequenz",
                                                            "samplefrequenz",
                                                            "dataratehz",
                                                            "samplingratehz"});
constexpr auto kIntervalKeys = std::to_array<std::string_view>(
    {"dt", "deltat", "sampletime", "samplingtime", "sampleinterval", "samplinginterval", "sampleperiod",
     "samplingperiod", "timestep", "timeinterval", "interval", "abtastzeit", "tastzeit"});
constexpr auto kRateUnits = std::to_array<std::pair<std::string_view, double>>({{"hz", 1.0},
                                                                                {"khz", 1e3},
                                                                                {"mhz", 1e6},
                                                                                {"sps", 1.0},
                                                                                {"ksps", 1e3},
                                                                                {"1/s", 1.0},
                                                                                {"s/s", 1.0},
                                                                                {"sa/s", 1.0},
                                                                                {"samples/s", 1.0},
                                                                                {"samples/sec", 1.0},
                                                                                {"samples/second", 1.0},
                                                                                {"samples per second", 1.0},
                                                                                {"frames/s", 1.0},
                                                                                {"frames per second", 1.0},
                                                                                {"fps", 1.0}});
/// Other words allowed in a sentence about a unit.
constexpr auto kQuantities =
    std::to_array<std::pair<std::string_view, Dimension>>({{"angle", Dimension::angle},
                                                           {"angles", Dimension::angle},
                                                           {"rotation", Dimension::angle},
                                                           {"rotations", Dimension::angle},
                                                           {"position", Dimension::length},
                                                           {"positions", Dimension::length},
                                                           {"length", Dimension::length},
                                                           {"lengths", Dimension::length},
                                                           {"distances", Dimension::length},
                                                           {"displacement", Dimension::length},
                                                           {"displacements", Dimension::length},
                                                           {"coordinates", Dimension::length},
                                                           {"force", Dimension::force},
                                                           {"forces", Dimension::force},
                                                           {"torque", Dimension::torque},
                                                           {"torques", Dimension::torque},
                                                           {"moment", Dimension::torque},
                                                           {"moments", Dimension::torque},
                                                           {"time", Dimension::time},
                                                           {"times", Dimension::time}});
constexpr auto kFillers = std::to_array<std::string_view>({"all", "the", "joint", "is", "are", "given", "measured",
                                                           "expressed", "recorded", "saved", "values", "data", "and"});
constexpr auto kSuspicious = std::to_array<std::string_view>(
    {"hz",      "khz",     "rate", "frequency", "frequenz",    "sampling",    "abtastrate",
     "degree",  "degrees", "unit", "units",     "einheit",     "einheiten",   "scale",
     "scaling", "factor",  "gain", "offset",    "sensitivity", "calibration", "multiplier"});
constexpr auto kDateKeys =
    std::to_array<std::string_view>({"date", "datum", "datetime", "recorded", "recordedon", "created", "createdon",
                                     "starttime", "startdate", "timestamp", "capturestarttime", "recordingtime",
                                     "recordingdate", "dateofrecording", "dateandtime", "starttimestamp"});

std::string small_letters(std::string_view text) {
  std::string small(text);
  std::ranges::transform(small, small.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return small;
}

/// The statements of a line, or of a part of it.
struct Statement {
  std::optional<double> rate_hz;
  std::vector<const Unit*> units;
  bool sure = true;  ///< no header says this
};

/// The text without the marks of a comment.
std::string_view bare(std::string_view line) {
  line = mbk::trimmed(line.substr(0, kLongest), kBlank);
  while (line.starts_with('#') || line.starts_with('%') || line.starts_with('/')) line.remove_prefix(1);
  return mbk::trimmed(line, kBlank);
}

/// A positive number with a unit or without one, and nothing more.
struct Quantity {
  double value;
  std::string_view unit;
};
std::optional<Quantity> quantity(std::string_view text) {
  text = mbk::trimmed(text, kBlank);
  const std::size_t end = std::min(text.find_first_not_of("0123456789.+-eE"), text.size());
  std::size_t length = end;
  // "5E" of "5 E…" is not a number.
  while (length > 0 && !is_digit(text[length - 1]) && text[length - 1] != '.') --length;
  const auto value = general_number(text.substr(0, length));
  if (length == 0 || !value || !(*value > 0.0) || !std::isfinite(*value)) return std::nullopt;
  return Quantity{*value, mbk::trimmed(text.substr(length), " \t()[]\"'")};
}

bool is_rate_unit(std::string_view unit) {
  return std::ranges::find(kRateUnits, small_letters(mbk::trimmed(unit, "()[]")),
                           &std::pair<std::string_view, double>::first) != kRateUnits.end();
}

std::optional<double> rate_of(std::string_view key, std::string_view value) {
  constexpr double kMin = 1e-2, kMax = 1e7;
  const auto said = quantity(value);
  if (!said) return std::nullopt;
  const std::string_view unit = said->unit.empty() ? in_brackets(key) : said->unit;
  const std::string squeezed_key = squeezed(key);
  std::optional<double> rate;
  if (is_one_of(squeezed_key, kRateKeys)) {
    const auto known = std::ranges::find(kRateUnits, small_letters(unit), &std::pair<std::string_view, double>::first);
    if (unit.empty()) rate = said->value;
    if (known != kRateUnits.end()) rate = said->value * known->second;
  } else if (is_one_of(squeezed_key, kIntervalKeys)) {
    constexpr double kSurelySeconds = 0.05;  // 50 ms and less: of ms it would be 20 kHz and more
    const Unit* const known = find_unit(unit);
    if (known != nullptr && known->dimension == Dimension::time) rate = 1.0 / known->to_si(said->value);
    if (unit.empty() && said->value <= kSurelySeconds) rate = 1.0 / said->value;
  }
  return rate && *rate >= kMin && *rate <= kMax ? rate : std::nullopt;
}

/// The units of "mm", "mm N", "(mm, N)"; none if a word is not a unit.
std::vector<const Unit*> all_units(std::string_view text) {
  std::vector<const Unit*> units;
  if (const Unit* const whole = find_unit(mbk::trimmed(text, " \t()[]\"'."))) return {whole};
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(" \t,;|"), text.size());
    if (const auto word = mbk::trimmed(text.substr(0, end), " \t()[]\"'"); !word.empty() && word != "and") {
      const Unit* const unit = find_unit(word);
      if (unit == nullptr) return {};
      units.push_back(unit);
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return units;
}

std::optional<Dimension> quantity_called(std::string_view word) {
  const auto found = std::ranges::find(kQuantities, word, &std::pair<std::string_view, Dimension>::first);
  return found == kQuantities.end() ? std::nullopt : std::optional(found->second);
}

/// "angles are in degrees", "position in mm": a quantity, "in", and a unit of it.
const Unit* unit_of_sentence(std::string_view text) {
  const std::string small = small_letters(text);
  const auto in = small.rfind(" in ");
  if (in == small.npos) return nullptr;
  const Unit* const unit = find_unit(mbk::trimmed(text.substr(in + 4), " \t.\"'"));
  if (unit == nullptr) return nullptr;
  bool fits = false;
  for (std::string_view left = std::string_view(small).substr(0, in); !left.empty();) {
    const std::size_t end = std::min(left.find_first_of(" \t"), left.size());
    const std::string_view word = left.substr(0, end);
    const auto quantity = quantity_called(word);
    if (quantity && *quantity != unit->dimension) return nullptr;
    fits = fits || quantity;
    if (!quantity && !word.empty() && !is_one_of(word, kFillers)) return nullptr;
    left.remove_prefix(std::min(end + 1, left.size()));
  }
  return fits ? unit : nullptr;
}

bool says_yes(std::string_view value) {
  const std::string small = small_letters(mbk::trimmed(value, kBlank));
  return small == "yes" || small == "true" || small == "1" || small == "y";
}

/// The statement of "key" and "value".
std::optional<Statement> statement_of(std::string_view key, std::string_view value) {
  const std::string name = squeezed(key);
  if (name.empty()) return std::nullopt;
  if (const auto rate = rate_of(key, value)) return Statement{rate};
  if (name == "indegrees") return says_yes(value) ? Statement{{}, {find_unit("deg")}} : Statement{};
  const bool of_units = name.ends_with("unit") || name.ends_with("units") || name.starts_with("einheit");
  auto quantity = quantity_called(name);
  if (!of_units && !quantity) return std::nullopt;
  Statement statement{{}, all_units(value), of_units};
  if (const auto end = name.rfind("unit"); of_units && end != name.npos) {
    quantity = quantity_called(std::string_view(name).substr(0, end));  // "force" of "force units"
    if (quantity == Dimension::force && mbk::trimmed(value, kBlank) == "g") statement.units = {find_unit("gf")};
  }
  if (statement.units.empty()) return std::nullopt;
  if (quantity && (statement.units.size() > 1 || statement.units.front()->dimension != *quantity ||
                   (!of_units && statement.units.front()->name == "in"))) {
    return std::nullopt;  // "Position: in" may be a door's
  }
  return statement;
}

/// [Hz] of "2 msec/sample", "500 samples/s".
std::optional<double> rate_per_sample(std::string_view text) {
  constexpr std::string_view kPerSample = "/sample", kSamplesPer = "sample";
  const auto said = quantity(text);
  if (!said) return std::nullopt;
  const std::string unit = small_letters(said->unit);
  if (unit.ends_with(kPerSample)) return rate_of("dt", text.substr(0, text.rfind('/')));
  return unit.starts_with(kSamplesPer) && is_rate_unit(unit) ? rate_of("rate", text) : std::nullopt;
}

/// "Fs 1000", "sampled at 500 Hz": a key and a value without a sign between them.
std::optional<Statement> unsigned_statement(std::string_view text) {
  if (const auto rate = rate_per_sample(text)) return Statement{rate};
  const std::size_t number = text.find_first_of("0123456789");
  if (number == text.npos || text.find_first_of("=:-+") < number) return std::nullopt;
  const auto rate = rate_of(text.substr(0, number), text.substr(number));
  return rate ? std::optional(Statement{rate}) : std::nullopt;
}

/// All that a line says.
struct Said {
  std::vector<double> rates_hz;
  std::vector<const Unit*> units;
  bool any = false;   ///< something was understood
  bool sure = false;  ///< no header says this
};

Said said_in(std::string_view line) {
  Said said;
  const auto take = [&](const std::optional<Statement>& one) {
    if (!one) return false;
    if (one->rate_hz) said.rates_hz.push_back(*one->rate_hz);
    said.units.insert(said.units.end(), one->units.begin(), one->units.end());
    said.any = true;
    said.sure = said.sure || one->sure;
    return true;
  };
  std::vector<std::string_view> cells;
  std::vector<std::size_t> places;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find_first_of(kSeparators, begin), line.size());
    cells.push_back(mbk::trimmed(line.substr(begin, end - begin), kBlank));
    places.push_back(end);
    begin = end + 1;
  }
  // A comma may be a decimal or a thousands separator: "1,000 Hz".
  const auto goes_on_with_digits = [&](std::size_t k) {
    return places[k] + 1 < line.size() && line[places[k]] == ',' && is_digit(line[places[k] + 1]) &&
           !cells[k].empty() && is_digit(cells[k].back());
  };
  for (std::size_t k = 0; k < cells.size(); ++k) {
    std::string_view cell = cells[k], value;
    const std::size_t sign = cell.find_first_of("=:");
    std::string_view key = cell.substr(0, sign);
    std::size_t last = k;  // of the value's cells
    if (sign != cell.npos) value = mbk::trimmed(cell.substr(sign + 1), kBlank);
    if (value.empty()) {
      while (last + 1 < cells.size() && value.empty()) value = cells[++last];
    }
    if (goes_on_with_digits(last)) continue;
    std::string with_unit;
    if (const auto number = quantity(value); number && number->unit.empty() && last + 1 < cells.size()) {
      const std::string_view next = cells[last + 1];
      if (!next.empty() && is_digit(next.front())) continue;  // of several, which?
      if (is_rate_unit(next) || find_unit(mbk::trimmed(next, "()[]")) != nullptr) {
        with_unit = fmt::format("{} {}", value, next);
        if (take(statement_of(key, with_unit))) {
          k = last + 1;
          continue;
        }
      }
      const auto behind = std::find_if(cells.begin() + static_cast<std::ptrdiff_t>(last) + 2, cells.end(),
                                       [](std::string_view other) { return !other.empty(); });
      if (!next.empty() && next.find_first_of("=:") == next.npos && behind == cells.end())
        continue;  // a unit that is not known, as no key is alone
    }
    // Units of several columns follow each other.
    std::size_t end = last + 1;
    while (end < cells.size() && !cells[end].empty() && find_unit(mbk::trimmed(cells[end], "()[]")) != nullptr) ++end;
    if (end > last + 1) {
      const std::size_t from = static_cast<std::size_t>(value.data() - line.data());
      if (take(statement_of(key, line.substr(from, places[end - 1] - from)))) {
        k = end - 1;
        continue;
      }
    }
    if (take(statement_of(key, value))) {
      k = last;
      continue;
    }
    if (goes_on_with_digits(k)) continue;
    if (const Unit* const unit = unit_of_sentence(cell)) {
      take(Statement{{}, {unit}, false});
    } else {
      take(unsigned_statement(cell));
    }
  }
  return said;
}

/// "2024-03-01", "01.03.2024", "3/1/24".
bool holds_date(std::string_view text) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (!is_digit(text[k]) || (k > 0 && is_digit(text[k - 1]))) continue;
    std::array<std::size_t, 3> digits{};
    std::size_t at = k;
    char sign = 0;
    std::size_t part = 0;
    for (; part < digits.size(); ++part) {
      const std::size_t begin = at;
      while (at < text.size() && is_digit(text[at])) ++at;
      digits[part] = at - begin;
      if (part == 2 || digits[part] == 0 || at == text.size()) break;
      if (std::string_view("-./").find(text[at]) == text.npos || (sign != 0 && text[at] != sign)) break;
      sign = text[at++];
    }
    const bool year = digits[0] == 4 || digits[2] == 4 || (sign == '/' && digits[2] == 2);
    if (part == 2 && year && digits[1] >= 1 && digits[1] <= 2 && std::min(digits[0], digits[2]) <= 2) return true;
  }
  return false;
}

/// Whether a line speaks of a rate, a unit, a gain or a date.
bool is_suspicious(std::string_view line) {
  if (holds_date(line)) return true;
  for (std::size_t k = 0; k < line.size();) {
    if (!is_letter(line[k])) {
      ++k;
      continue;
    }
    std::size_t end = k;
    while (end < line.size() && (is_letter(line[end]) || line[end] == '/' || line[end] == '.' || line[end] == '^'))
      ++end;
    const std::string_view word = mbk::trimmed(line.substr(k, end - k), "./^");
    const bool bracketed = k > 0 && (line[k - 1] == '[' || line[k - 1] == '(') && end < line.size() &&
                           (line[end] == ']' || line[end] == ')');
    const bool unit = (word.size() > 1 || bracketed) && word != "in" && word != "second" && find_unit(word) != nullptr;
    if (unit || is_one_of(small_letters(word), kSuspicious)) return true;
    k = end;
  }
  for (std::size_t begin = 0; begin < line.size();) {
    const std::size_t end = std::min(line.find_first_of(",;\t|=:", begin), line.size());
    const std::string key = squeezed(line.substr(begin, end - begin));
    if (is_one_of(key, kDateKeys) || is_one_of(key, kRateKeys) || is_one_of(key, kIntervalKeys)) return true;
    begin = end + 1;
  }
  return false;
}

std::string quoted(const CsvLine& line) {
  constexpr std::size_t kShown = 80;
  std::string_view text = mbk::trimmed(line.text, ",;\t| \"");  // spreadsheets fill lines up
  return fmt::format("line {}, '{}{}'", line.number, printable(std::string(text.substr(0, kShown))),
                     text.size() > kShown ? "…" : "");
}

/// Lines that say something, and what of it holds.
class Reader {
 public:
  Preamble read(std::span<const CsvLine> lines) {
    for (const CsvLine& line : lines) take(line);
    for (const Found& rate : rates_) {
      if (std::abs(rate.value - rates_.front().value) > kSame * rates_.front().value) return with_notes(true);
    }
    return with_notes(false);
  }

 private:
  static constexpr double kSame = 1e-3;

  struct Found {
    double value;
    const Unit* unit;
    std::string place;
  };

  void leave(const std::string& place) {
    if (std::ranges::find(unused_, place) == unused_.end()) unused_.push_back(place);
  }

  void take(const CsvLine& line) {
    const std::string_view text = bare(line.text);
    const Said said = said_in(text);
    for (const double rate : said.rates_hz) rates_.push_back({rate, nullptr, quoted(line)});
    for (const Unit* unit : said.units) units_.push_back({1.0, unit, quoted(line)});
    if (!said.any && is_suspicious(text)) leave(quoted(line));
  }

  Preamble with_notes(bool rates_differ) {
    Preamble found;
    if (!rates_.empty() && !rates_differ) {
      found.rate_hz = rates_.front().value;
      found.rate_from = rates_.front().place;
      found.notes.push_back(fmt::format("{}: the sampling rate is {:.6g} Hz", found.rate_from, *found.rate_hz));
    } else {
      for (const Found& rate : rates_) leave(rate.place);
    }
    for (const Found& one : units_) {
      const auto same = [&](const Found& other) { return other.unit->dimension == one.unit->dimension; };
      const auto first = std::ranges::find_if(units_, same);
      const bool clash = std::ranges::any_of(
          units_, [&](const Found& other) { return same(other) && other.unit->name != one.unit->name; });
      if (clash) {
        leave(one.place);
      } else if (&*first == &one) {
        found.units.push_back(one.unit);
        found.notes.push_back(fmt::format("{}: {} are in {}, unless a column states another unit", one.place,
                                          dimension_name(one.unit->dimension), one.unit->name));
      }
    }
    constexpr std::size_t kListed = 12;
    for (std::size_t k = 0; k < std::min(unused_.size(), kListed); ++k) {
      found.notes.push_back(unused_[k] + ", was not used");
    }
    if (unused_.size() > kListed) {
      found.notes.push_back(fmt::format("{} more such lines were not used", unused_.size() - kListed));
    }
    return found;
  }

  std::vector<Found> rates_, units_;
  std::vector<std::string> unused_;
};

}  // namespace preamble

Preamble read_preamble(std::span<const CsvLine> lines) {
  return preamble::Reader().read(lines);
}

std::optional<std::string> unread_statement(const CsvLine& line) {
  const std::string_view text = preamble::bare(line.text);
  if (!preamble::said_in(text).any && !preamble::is_suspicious(text)) return std::nullopt;
  return preamble::quoted(line) + ", was not used";
}

bool is_statement(const CsvLine& line) {
  return preamble::said_in(preamble::bare(line.text)).sure;
}

}  // namespace mbk::recording
