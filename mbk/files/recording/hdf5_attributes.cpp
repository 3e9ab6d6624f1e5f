#include "mbk/files/recording/hdf5_attributes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/hdf5_tree.h"

namespace mbk::recording {
namespace {

using hdf5::Stored;
constexpr Index kMaxCodes = 16;  ///< number of missing values, each of which is compared with all numbers
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The meaning of an attribute name.
enum class Says {
  nothing,
  unit,
  conversion,
  channel_conversion,
  offset,  ///< with a conversion: added. Alone it may as well be subtracted
  scale_factor,
  add_offset,
  missing,
  valid_min,
  valid_max,
  valid_range,
  factor,  ///< a scale, and the name does not say whether numbers were multiplied by it, are to be, or to be divided
  maybe,   ///< may be a scale or an offset, or describe one
};

std::string letters_of(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    if (c != '_' && c != '-' && c != ' ' && c != '.') {
      letters += static_cast<char>(c >= 'A' && c <= 'Z' ? c + ('a' - 'A') : c);
    }
  }
  return letters;
}

Says meaning_of(std::string_view name) {
  using enum Says;
  constexpr auto kNames = std::to_array<std::pair<std::string_view, Says>>({
      {"unit", unit},
      {"units", unit},
      {"unitstring", unit},
      {"physicalunit", unit},
      {"physicalunits", unit},
      {"engineeringunit", unit},
      {"engineeringunits", unit},
      {"conversion", conversion},
      {"channelconversion", channel_conversion},
      {"offset", offset},
      {"scalefactor", scale_factor},
      {"addoffset", add_offset},
      {"fillvalue", missing},
      {"missingvalue", missing},
      {"validmin", valid_min},
      {"validmax", valid_max},
      {"validrange", valid_range},
      {"scale", factor},
      {"scaling", factor},
      {"scalingfactor", factor},
      {"gain", factor},
      {"factor", factor},
      {"multiplier", factor},
      {"conversionfactor", factor},
      {"calibration", factor},
      {"calibrationfactor", factor},
      {"sensitivity", factor},
      {"slope", factor},
      {kUnapplied, factor},
  });
  constexpr auto kWords = std::to_array<std::string_view>(
      {"scale",  "scaling", "gain", "factor",    "conver",   "calib",  "coef", "slope",      "sensitiv", "multipl",
       "offset", "bias",    "tare", "intercept", "polarity", "invert", "lsb",  "resolution", "delay",    "latency"});
  const std::string letters = letters_of(name);
  const auto found = std::ranges::find(kNames, letters, [](const auto& one) { return one.first; });
  if (found != kNames.end()) return found->second;
  const bool may = std::ranges::any_of(kWords, [&](std::string_view w) { return letters.find(w) != letters.npos; });
  return may ? maybe : nothing;
}

/// The numbers of an attribute, also of one that holds them as text; nothing of any other.
std::optional<Vector> numbers_of(const hdf5::Value& value) {
  if (const auto* const numbers = std::get_if<hdf5::Numbers>(&value.data)) return numbers->values;
  const auto* const texts = std::get_if<hdf5::Texts>(&value.data);
  if (texts == nullptr || texts->empty()) return std::nullopt;
  Vector numbers(static_cast<Index>(texts->size()));
  for (std::size_t k = 0; k < texts->size(); ++k) {
    const auto number = (*texts)[k].empty() ? std::nullopt : general_number((*texts)[k]);
    if (!number) return std::nullopt;
    numbers[static_cast<Index>(k)] = *number;
  }
  return numbers;
}

/// "gain = 4.448", "gain = [2, 3]", "gain = 'x10'".
std::string said(std::string_view name, const hdf5::Value& value) {
  constexpr std::size_t kShown = 6;
  std::string text = printable(std::string(name)) + " = ";
  if (const auto numbers = numbers_of(value)) {
    const auto count = static_cast<std::size_t>(numbers->size());
    const std::span<const double> shown(numbers->data(), std::min(count, kShown));
    if (count == 1) return text + fmt::format("{}", shown[0]);
    return text + fmt::format("[{}{}]", fmt::join(shown, ", "), count > kShown ? ", …" : "");
  }
  if (const auto* const texts = std::get_if<hdf5::Texts>(&value.data); texts != nullptr && !texts->empty()) {
    constexpr std::size_t kLongest = 40;
    return text + fmt::format("'{}'", printable(texts->front().substr(0, kLongest)));
  }
  return text + "…";
}

bool leaves_as_it_is(const std::optional<Vector>& numbers, double identity) {
  return numbers && numbers->size() > 0 && (numbers->array() == identity).all();
}

/// "milliseconds" of "milliseconds since 2024-01-01".
std::string without_begin(std::string text) {
  if (const auto since = text.find(" since "); since != text.npos) text.resize(since);
  return text;
}

/// The units that an attribute says; more than one where columns have units of their own.
std::vector<std::string> units_of(const hdf5::Value& value) {
  std::vector<std::string> units;
  if (const auto* const texts = std::get_if<hdf5::Texts>(&value.data)) {
    for (const std::string& text : *texts) {
      std::string unit = without_begin(printable(text));
      const Unit* const known = find_unit(unit);
      const bool same = std::ranges::any_of(units, [&](const std::string& other) {
        return other == unit || (known != nullptr && find_unit(other) == known);
      });
      if (!unit.empty() && !same) units.push_back(std::move(unit));
    }
  }
  return units;
}

bool is_real(Stored stored) {
  return stored == Stored::float32 || stored == Stored::float64;
}

/// Numbers of that many bits less 2^bits, or the other way round.
double wrap_of(Stored stored) {
  switch (stored) {
    case Stored::int8:
    case Stored::uint8:
      return 0x1p8;
    case Stored::int16:
    case Stored::uint16:
      return 0x1p16;
    case Stored::int32:
    case Stored::uint32:
      return 0x1p32;
    case Stored::int64:
    case Stored::uint64:
      return 0x1p64;
    default:
      return 0.0;
  }
}

/// The netCDF value for unwritten elements (netcdf.h, NC_FILL_…); nothing of single bytes, as there.
std::optional<double> netcdf_fill(Stored stored) {
  switch (stored) {
    case Stored::int16:
      return -32767.0;
    case Stored::uint16:
      return 65535.0;
    case Stored::int32:
      return -2147483647.0;
    case Stored::uint32:
      return 4294967295.0;
    case Stored::int64:
      return -9223372036854775806.0;
    case Stored::uint64:
      return 18446744073709551614.0;
    case Stored::float32:
    case Stored::float64:
      return 9.9692099683868690e+36;
    default:
      return std::nullopt;
  }
}

class Applier {
 public:
  Applier(hdf5::Numbers& numbers, std::uint64_t columns, Array& array, SharedNotes& notes)
      : numbers_(numbers), columns_(static_cast<Index>(columns)), array_(array), notes_(notes) {}

  void run(const hdf5::Attributes& attributes, bool netcdf) {
    for (const auto& [name, value] : attributes) collect(name, value);
    if (netcdf && missing_.empty()) {
      if (const auto fill = netcdf_fill(numbers_.stored)) missing_.push_back({"the default netCDF fill value", *fill});
    }
    follow_unsigned(text_attribute(attributes, "_Unsigned"));
    settle_scale();
    mark_missing();
    const bool valid_in_file = !(valid_is_real_ && !is_real(numbers_.stored));
    if (valid_in_file) mark_invalid();
    scale();
    if (!valid_in_file) mark_invalid();
    settle_unit();
    for (const std::string& what : unapplied_) {
      notes_.add(fmt::format("{} was not applied to", what), array_.name);
    }
    array_.unapplied = fmt::format("{}", fmt::join(unapplied_, ", "));
    for (const std::string& what : maybe_) notes_.add(fmt::format("{} was not applied to", what), array_.name);
  }

 private:
  struct Scale {
    std::string name;  ///< of its attribute, as it stands
    Vector values;     ///< one, or one for each column
  };
  struct Missing {
    std::string name;
    double value;
  };

  void collect(const std::string& name, const hdf5::Value& value) {
    const Says says = meaning_of(name);
    if (says == Says::nothing) {
      const auto number = numbers_of(value);
      if (number && number->size() == 1 && array_.rate_hz == 0.0) {
        array_.rate_hz = rate_called(name, (*number)[0], "").value_or(0.0);
        if (array_.rate_hz > 0.0) {
          notes_.add(fmt::format("attribute {} states the sample rate of", said(name, value)), array_.name);
        }
      }
      return;
    }
    if (says == Says::unit) {
      for (std::string& unit : units_of(value)) units_.push_back(std::move(unit));
      return;
    }
    const auto stated = numbers_of(value);
    if (says == Says::maybe) {
      const bool nwb_default = letters_of(name) == "resolution" && leaves_as_it_is(stated, -1.0);
      if (stated && !nwb_default && !leaves_as_it_is(stated, 0.0) && !leaves_as_it_is(stated, 1.0)) {
        maybe_.push_back(said(name, value));
      }
      return;
    }
    if (says == Says::factor) {
      const auto* const texts = std::get_if<hdf5::Texts>(&value.data);
      if (name == kUnapplied && texts != nullptr && texts->size() == 1) {
        unapplied_.push_back(printable(texts->front()));
      } else if (!leaves_as_it_is(stated, 1.0)) {
        (stated ? unapplied_ : maybe_).push_back(said(name, value));
      }
      return;
    }
    if (!stated || stated->size() == 0) {
      unapplied_.push_back(said(name, value));
      return;
    }
    const auto* const as_number = std::get_if<hdf5::Numbers>(&value.data);
    const bool real = as_number == nullptr || is_real(as_number->stored);
    switch (says) {
      case Says::missing:
        if (stated->size() > kMaxCodes) return unapplied_.push_back(said(name, value));
        for (const double one : *stated) missing_.push_back({printable(name), as_stored(one)});
        return;
      case Says::valid_min:
        least_ = as_stored((*stated)[0]), valid_is_real_ = real;
        return;
      case Says::valid_max:
        most_ = as_stored((*stated)[0]), valid_is_real_ = real;
        return;
      case Says::valid_range:
        if (stated->size() != 2) return unapplied_.push_back(said(name, value));
        least_ = as_stored((*stated)[0]), most_ = as_stored((*stated)[1]), valid_is_real_ = real;
        return;
      default:
        break;
    }
    const bool usable = stated->allFinite() && (stated->size() == 1 || stated->size() == columns_);
    const bool multiplies = says == Says::conversion || says == Says::scale_factor || says == Says::channel_conversion;
    if (!usable || (multiplies && (stated->array() == 0.0).any())) return unapplied_.push_back(said(name, value));
    if (leaves_as_it_is(stated, multiplies ? 1.0 : 0.0)) {
      has_conversion_ = has_conversion_ || says == Says::conversion;
      return;
    }
    scales_[static_cast<std::size_t>(says)] = Scale{said(name, value), *stated};
    has_conversion_ = has_conversion_ || says == Says::conversion;
  }

  /// The number as stored in the file: float32 data are compared with a float32.
  [[nodiscard]] double as_stored(double value) const {
    return numbers_.stored == Stored::float32 ? static_cast<double>(static_cast<float>(value)) : value;
  }

  std::optional<Scale>& scale_of(Says says) { return scales_[static_cast<std::size_t>(says)]; }

  /// Which of the scales hold: those of NWB or those of CF.
  void settle_scale() {
    auto &conversion = scale_of(Says::conversion), &offset = scale_of(Says::offset),
         &factor = scale_of(Says::scale_factor), &addend = scale_of(Says::add_offset);
    const auto give_up = [&](std::optional<Scale>& scale) {
      if (scale) unapplied_.push_back(scale->name);
      scale.reset();
    };
    if (offset && !has_conversion_) give_up(offset);
    const auto same = [](const std::optional<Scale>& a, const std::optional<Scale>& b) {
      return a.has_value() == b.has_value() && (!a || (a->values.size() == b->values.size() && a->values == b->values));
    };
    const bool nwb = conversion || offset || scale_of(Says::channel_conversion), cf = factor || addend;
    if (nwb && cf && same(conversion, factor) && same(offset, addend)) {  // the same in both languages
      factor.reset();
      addend.reset();
    } else if ((nwb && cf) || !unapplied_.empty()) {
      for (std::optional<Scale>& scale : scales_) give_up(scale);
    }
  }

  void follow_unsigned(std::string_view said) {
    const double wrap = wrap_of(numbers_.stored);
    if (wrap == 0.0 || said.empty()) return;
    const bool is_unsigned = said == "true" || said == "True" || said == "TRUE";
    const auto read = [&](double value) {
      if (is_unsigned) return value < 0.0 ? value + wrap : value;
      return value >= wrap / 2 ? value - wrap : value;
    };
    for (double& value : numbers_.values) value = read(value);
    for (Missing& one : missing_) one.value = read(one.value);
    if (least_) least_ = read(*least_);
    if (most_) most_ = read(*most_);
  }

  void mark_missing() {
    for (const Missing& one : missing_) {
      if (std::isnan(one.value)) continue;
      Index count = 0;
      for (double& value : numbers_.values) {
        if (value != one.value) continue;
        value = kNaN;
        ++count;
      }
      if (count == 0) continue;
      notes_.add(fmt::format("{} value{} equal to {} ({}) {} read as missing (NaN) in", count, count == 1 ? "" : "s",
                             one.name, one.value, count == 1 ? "was" : "were"),
                 array_.name);
    }
  }

  void mark_invalid() {
    if (!least_ && !most_) return;
    const double least = least_.value_or(-std::numeric_limits<double>::infinity());
    const double most = most_.value_or(std::numeric_limits<double>::infinity());
    Index count = 0;
    for (double& value : numbers_.values) {
      if (!(value < least || value > most)) continue;
      value = kNaN;
      ++count;
    }
    if (count == 0) return;
    notes_.add(fmt::format("{} value{} outside the valid range, {} to {}, {} read as missing (NaN) in", count,
                           count == 1 ? "" : "s", least, most, count == 1 ? "was" : "were"),
               array_.name);
  }

  void scale() {
    std::vector<std::string> applied;
    for (const Says says :
         {Says::conversion, Says::scale_factor, Says::channel_conversion, Says::offset, Says::add_offset}) {
      const std::optional<Scale>& scale = scale_of(says);
      if (!scale) continue;
      applied.push_back(scale->name);
      const bool adds = says == Says::offset || says == Says::add_offset;
      Vector& values = numbers_.values;
      if (scale->values.size() == 1) {
        if (adds) {
          values.array() += scale->values[0];
        } else {
          values *= scale->values[0];
        }
        continue;
      }
      auto rows = values.reshaped<Eigen::RowMajor>(values.size() / columns_, columns_);
      for (Index c = 0; c < columns_; ++c) {
        if (adds) {
          rows.col(c).array() += scale->values[c];
        } else {
          rows.col(c) *= scale->values[c];
        }
      }
    }
    if (applied.empty()) return;
    if (!numbers_.rests.empty()) {  // no longer integers
      notes_.add("whole numbers above 2^53 were rounded in", array_.name);
      numbers_.rests = {};
    }
    notes_.add(fmt::format("{} {} applied to", fmt::join(applied, ", "), applied.size() == 1 ? "was" : "were"),
               array_.name);
  }

  /// Two different units, of the attributes or of the columns, are both listed, which no channel accepts.
  void settle_unit() {
    std::vector<std::string> different;
    for (std::string& unit : units_) {
      const Unit* const known = find_unit(unit);
      const bool same = std::ranges::any_of(different, [&](const std::string& other) {
        return other == unit || (known != nullptr && find_unit(other) == known);
      });
      if (!same) different.push_back(std::move(unit));
    }
    if (!different.empty()) array_.unit = fmt::format("{}", fmt::join(different, ", "));
  }

  hdf5::Numbers& numbers_;
  Index columns_;
  Array& array_;
  SharedNotes& notes_;
  std::array<std::optional<Scale>, static_cast<std::size_t>(Says::maybe) + 1> scales_;
  bool has_conversion_ = false;  ///< also where it is 1
  std::vector<Missing> missing_;
  std::optional<double> least_, most_;
  bool valid_is_real_ = false;
  std::vector<std::string> units_, unapplied_, maybe_;
};

}  // namespace

void SharedNotes::add(std::string sentence, std::string name) {
  const auto [place, is_new] = places_.try_emplace(sentence, all_.size());
  if (is_new) all_.emplace_back(std::move(sentence), std::vector<std::string>());
  all_[place->second].second.push_back(std::move(name));
}

std::vector<std::string> SharedNotes::lines() const {
  constexpr std::size_t kShown = 12;
  std::vector<std::string> lines;
  for (const auto& [sentence, names] : all_) {
    const std::span<const std::string> shown = std::span(names).first(std::min(names.size(), kShown));
    lines.push_back(fmt::format("{} '{}'{}", sentence, fmt::join(shown, "', '"),
                                names.size() > kShown ? fmt::format(" and {} more", names.size() - kShown) : ""));
  }
  return lines;
}

void apply_attributes(const hdf5::Attributes& attributes, hdf5::Numbers& numbers, std::uint64_t columns, bool netcdf,
                      Array& array, SharedNotes& notes) {
  if (attributes.empty() && !netcdf) return;
  Applier(numbers, columns, array, notes).run(attributes, netcdf);
}

void hand_attributes_on(hdf5::Group& table) {
  for (const auto& [name, value] : table.attributes) {
    const Says says = meaning_of(name);
    if (says == Says::nothing || says == Says::maybe) continue;
    const auto* const texts = std::get_if<hdf5::Texts>(&value.data);
    const auto* const numbers = std::get_if<hdf5::Numbers>(&value.data);
    const std::size_t count = texts != nullptr     ? texts->size()
                              : numbers != nullptr ? static_cast<std::size_t>(numbers->values.size())
                                                   : 0;
    if (count != 1 && count != table.columns.size()) continue;
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
      const auto column = table.datasets.find(table.columns[k]);
      if (column == table.datasets.end()) continue;
      const std::size_t at = count == 1 ? 0 : k;
      hdf5::Value one;
      if (texts != nullptr) {
        one.data = hdf5::Texts{(*texts)[at]};
      } else {
        one.data = hdf5::Numbers{Vector::Constant(1, numbers->values[static_cast<Index>(at)]), numbers->stored};
      }
      const bool of_numbers = says != Says::unit && says != Says::missing;
      const auto kinds = parse_column_name(table.columns[k]).kinds;
      const bool is_time = !kinds.empty() && kinds.front()->name == "time";
      if (of_numbers && count == 1 && count != table.columns.size()) {
        // It is not stated whether one scale applies to every column.
        if (is_time || leaves_as_it_is(numbers_of(one), 1.0) || leaves_as_it_is(numbers_of(one), 0.0)) continue;
        column->second.attributes.try_emplace(std::string(kUnapplied), hdf5::one_text(said(name, one)));
        continue;
      }
      column->second.attributes.try_emplace(name, std::move(one));
    }
  }
}

std::vector<SaidRate> rates_of_group(const hdf5::Attributes& attributes, const std::string& path) {
  std::vector<SaidRate> rates;
  for (const auto& [name, value] : attributes) {
    const auto number = numbers_of(value);
    if (!number || number->size() != 1) continue;
    if (const auto rate = rate_called(name, (*number)[0], "")) {
      rates.push_back(
          {path,
           fmt::format("attribute '{}' of {}", printable(name), path.empty() ? "the file" : fmt::format("'{}'", path)),
           *rate});
    }
  }
  return rates;
}

void note_unapplied(const hdf5::Attributes& attributes, const std::string& path, SharedNotes& notes) {
  for (const auto& [name, value] : attributes) {
    const Says says = meaning_of(name);
    if (says == Says::nothing || says == Says::unit) continue;
    const auto numbers = numbers_of(value);
    if (!numbers || leaves_as_it_is(numbers, 1.0) || leaves_as_it_is(numbers, 0.0)) continue;
    notes.add(fmt::format("{} was not applied to the contents of", said(name, value)), path.empty() ? "/" : path);
  }
}

std::optional<double> number_attribute(const hdf5::Attributes& attributes, std::string_view name) {
  const auto found = attributes.find(std::string(name));
  if (found == attributes.end()) return std::nullopt;
  const auto numbers = numbers_of(found->second);
  return numbers && numbers->size() == 1 ? std::optional((*numbers)[0]) : std::nullopt;
}

}  // namespace mbk::recording
