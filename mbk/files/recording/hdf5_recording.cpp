#include "mbk/files/recording/hdf5_recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "mbk/base/core/printable.h"
#include "mbk/base/system/mapping.h"
#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/lines.h"
#include "mbk/files/hdf5/read_hdf5.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/hdf5_attributes.h"
#include "mbk/files/recording/hdf5_tree.h"
#include "mbk/files/recording/mat_hdf5.h"
#include "mbk/files/recording/without_ones.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kLongestNumbers = 64;  ///< of an attribute that becomes metadata
constexpr std::size_t kMaxDimensions = 8;    ///< of an array that is read

/// A value in one line; nothing if it is neither text nor a few numbers.
/// @param count  lines that it has in the file
std::optional<std::string> line_of(const hdf5::Value& value, std::size_t& count) {
  if (const auto* const texts = std::get_if<hdf5::Texts>(&value.data)) {
    std::vector<std::string> lines;
    for (const std::string& text : *texts) {
      for (std::string& line : printable_lines(text)) lines.push_back(std::move(line));
    }
    count = lines.size();
    return fmt::format("{}", fmt::join(lines, "; "));
  }
  const auto* const numbers = std::get_if<hdf5::Numbers>(&value.data);
  if (numbers == nullptr || static_cast<std::size_t>(numbers->values.size()) > kLongestNumbers) return {};
  return fmt::format("{}", fmt::join(numbers->values, "; "));
}

class Decoder {
 public:
  Contents contents;

  void run(hdf5::Group& root) {
    contents.format = "HDF5";
    own_layout_ = text_attribute(root.attributes, "format") == kLayout;
    for (const auto& [name, value] : root.attributes) {
      std::size_t lines = 1;
      auto line = line_of(value, lines);
      const bool of_the_writer = name == "format" || (name == "software" && line && line->starts_with("mbk "));
      if (!line || (own_layout_ && of_the_writer)) continue;
      contents.metadata[printable(name)] = std::move(*line);
      if (lines > 1) contents.notes.push_back(several_lines_note(printable(name), lines));
    }
    for (const auto& [name, dataset] : root.datasets) in_root_.push_back(name);
    netcdf_ = root.attributes.contains("_NCProperties");
    group(root, "");
    const auto is_named_time = [](const Array& array) {
      const auto kinds = parse_column_name(array.name.substr(array.name.rfind('/') + 1)).kinds;
      return !kinds.empty() && kinds.front()->name == "time";
    };
    if (std::ranges::any_of(contents.arrays, is_named_time)) {  // which then is meant
      for (Array& array : contents.arrays) {
        if (array.means == "time") array.means.clear();
      }
    }
    for (std::string& line : notes_.lines()) contents.notes.push_back(std::move(line));
    give_rates(contents, std::move(rates_));
  }

 private:
  void group(hdf5::Group& group, const std::string& prefix) {
    if (!group.damage.empty()) lost(prefix.empty() ? "/" : prefix, group.damage);
    if (!group.columns.empty()) hand_attributes_on(group);
    if (!(own_layout_ && prefix.empty())) {  // those are metadata
      for (SaidRate& rate : rates_of_group(group.attributes, prefix)) rates_.push_back(std::move(rate));
      if (group.columns.empty()) note_unapplied(group.attributes, prefix, notes_);
    }
    find_clock(group, prefix);
    for_each_member(group, [&](const std::string& name, auto& member) {
      const std::string path = prefix.empty() ? printable(name) : prefix + "/" + printable(name);
      if constexpr (std::same_as<std::remove_cvref_t<decltype(member)>, hdf5::Group>) {
        this->group(member, path);
      } else {
        dataset(member, path);
      }
    });
  }

  void dataset(hdf5::Dataset& dataset, const std::string& path) {
    hdf5::Value& value = dataset.value;
    if (const auto* const unread = std::get_if<hdf5::Unread>(&value.data)) {
      return unread->damaged ? lost(name_of(path), unread->what) : aside(path, unread->what);
    }
    if (std::holds_alternative<hdf5::References>(value.data)) return aside(path, "of references");
    if (auto* const texts = std::get_if<hdf5::Texts>(&value.data)) {
      for (std::string& text : *texts) text = in_one_line(text);
      contents.texts.push_back({name_of(path), std::move(*texts)});
      return;
    }
    if (value.shape.empty()) return single(dataset, path);
    if (text_attribute(dataset.attributes, "NAME")
            .starts_with("This is a netCDF dimension but not a netCDF variable")) {
      return;  // which has no numbers
    }
    const std::vector<std::uint64_t> sides = value.shape;
    const bool block = sides.size() > 2 && !without_ones(sides);
    if (const auto squeezed = without_ones(value.shape)) {
      contents.notes.push_back(
          fmt::format("'{}' ({}) was read as {}", path, fmt::join(value.shape, "×"), fmt::join(*squeezed, "×")));
      value.shape = *squeezed;
    }
    const std::size_t rank = value.shape.size();
    auto& numbers = std::get<hdf5::Numbers>(value.data);
    if (block && (is_byte(numbers.stored) || rank > kMaxDimensions)) {  // images
      return aside(path, fmt::format("an array of {} dimensions", rank));
    }
    const std::uint64_t columns = rank >= 2 ? value.shape.back() : 1;
    Array& array = contents.arrays.emplace_back();
    array.name = name_of(path);
    array.signal = own_layout_ && (path == "time" || path.starts_with("channels/"));
    apply_attributes(dataset.attributes, numbers, columns, netcdf_, array, notes_);
    check_frame(array.name, text_attribute(dataset.attributes, "frame"));
    if (is_time_scale(dataset.attributes)) array.means = "time";
    if (const auto series = series_.find(path); series != series_.end()) {
      array.clock = series->second.clock;
      array.means = series->second.channel;
    }
    if (sides.size() > 2) array.shape = sides;
    array.row_major = block;
    const std::uint64_t rows = block ? static_cast<std::uint64_t>(numbers.values.size()) : value.shape[0];
    array.rests = take_rests(numbers, rows, block ? 1 : columns);
    array.values = take_rows(numbers, rows, block ? 1 : columns);
  }

  static bool is_byte(hdf5::Stored stored) { return stored == hdf5::Stored::int8 || stored == hdf5::Stored::uint8; }

  /// A scale of a dimension that counts time, by the attributes that CF has for that.
  static bool is_time_scale(const hdf5::Attributes& attributes) {
    if (text_attribute(attributes, "CLASS") != "DIMENSION_SCALE") return false;
    return text_attribute(attributes, "standard_name") == "time" || text_attribute(attributes, "axis") == "T" ||
           text_attribute(attributes, "units").find(" since ") != std::string::npos;
  }

  /// A single number can only be a sample rate.
  void single(const hdf5::Dataset& dataset, const std::string& path) {
    if (single_taken_.contains(path)) return;
    const double number = std::get<hdf5::Numbers>(dataset.value.data).values[0];
    const auto slash = path.rfind('/');
    const std::string scope = slash == path.npos ? "" : path.substr(0, slash);
    std::string unit = text_attribute(dataset.attributes, "unit");
    if (unit.empty()) unit = text_attribute(dataset.attributes, "units");
    if (const auto rate = rate_called(slash == path.npos ? path : path.substr(slash + 1), number, unit)) {
      rates_.push_back({scope, fmt::format("'{}'", path), *rate});
      return;
    }
    aside(path, fmt::format("a single number ({})", number));
  }

  /// A TimeSeries of NWB 2: `data`, whose first dimension is time, and beside them either `timestamps` or
  /// `starting_time` with its attribute `rate`. Its data have a clock of their own.
  void find_clock(hdf5::Group& group, const std::string& path) {
    const auto numbers_of = [&](const char* name) {
      const auto found = group.datasets.find(name);
      return found == group.datasets.end() ? nullptr : std::get_if<hdf5::Numbers>(&found->second.value.data);
    };
    const hdf5::Numbers* const data = numbers_of("data");
    if (data == nullptr || path.empty()) return;
    hdf5::Dataset& dataset = group.datasets["data"];
    const std::string first = path + "/";
    Clock clock{path, {}};
    if (const hdf5::Numbers* const begin = numbers_of("starting_time"); begin != nullptr && begin->values.size() == 1) {
      const auto rate = number_attribute(group.datasets["starting_time"].attributes, "rate");
      if (!rate || !(*rate > 0.0) || !std::isfinite(*rate)) return;
      const auto samples = static_cast<Index>(dataset.value.shape.empty() ? 0 : dataset.value.shape[0]);
      if (samples > data->values.size()) return;
      clock.time.resize(samples);
      for (Index k = 0; k < samples; ++k) clock.time[k] = begin->values[0] + static_cast<double>(k) / *rate;
      single_taken_.insert(first + "starting_time");
      notes_.add(fmt::format("starting_time {} s and its rate {} Hz define the time of", begin->values[0], *rate),
                 first + "data");
    } else if (const hdf5::Numbers* const stamps = numbers_of("timestamps"); stamps != nullptr) {
      const std::string said = text_attribute(group.datasets["timestamps"].attributes, "unit");
      const Unit* const unit = find_unit(said.empty() ? "s" : said);
      const bool nwb = !said.empty() || group.attributes.contains("neurodata_type");
      if (!nwb || unit == nullptr || unit->dimension != Dimension::time) return;
      clock.time = stamps->values.unaryExpr([&](double stamp) { return unit->to_si(stamp); });
      series_[first + "timestamps"] = {static_cast<int>(contents.clocks.size()), ""};
    } else {
      return;
    }
    const std::string name = path.substr(path.rfind('/') + 1);
    series_[first + "data"] = {static_cast<int>(contents.clocks.size()), kinds_called(name).empty() ? "" : name};
    contents.clocks.push_back(std::move(clock));
    if (const auto each = group.datasets.find("channel_conversion"); each != group.datasets.end()) {
      dataset.attributes.try_emplace("channel_conversion", each->second.value);
    }
  }

  /// Channels go by their own names, and events as in MAT files.
  [[nodiscard]] std::string name_of(const std::string& path) const {
    constexpr std::string_view kChannels = "channels/";
    if (path.starts_with(kChannels)) {
      std::string name = path.substr(kChannels.size());
      const bool taken = std::ranges::find(in_root_, name) != in_root_.end();
      return taken || name.find('/') != name.npos ? path : name;
    }
    if (path == "events/time" || path == "events/value" || path == "events/name") return "events." + path.substr(7);
    return path;
  }

  /// mbk reads a channel in the frame of its table. A different statement is reported in a note.
  void check_frame(const std::string& name, const std::string& frame) {
    const auto kinds = kinds_called(name);
    if (frame.empty() || kinds.size() != 1 || kinds.front()->frame == frame) return;
    if (kinds.front()->frame.empty()) return;  // it has no frame of its own: a joint's, or the sensor's
    contents.notes.push_back(
        fmt::format("the frame of '{}' is '{}'; mbk reads it in the frame '{}'", name, frame, kinds.front()->frame));
  }

  void lost(const std::string& name, const std::string& why) {
    contents.notes.push_back(lost_note(fmt::format("'{}'", name), why));
    contents.damaged.emplace(name, why);
  }

  void aside(const std::string& path, std::string_view what) {
    contents.notes.push_back(fmt::format("'{}' is {}; ignored", path, what));
  }

  /// The owner of the data or time stamps at a path.
  struct Series {
    int clock;
    std::string channel;  ///< Array::means
  };

  bool own_layout_ = false;  ///< as encode_hdf5 writes it
  bool netcdf_ = false;
  std::vector<std::string> in_root_;
  std::map<std::string, Series> series_;
  std::set<std::string> single_taken_;
  std::vector<SaidRate> rates_;
  SharedNotes notes_;
};

/// Whether something of a file is damaged.
bool is_damaged(const hdf5::Group& group) {
  const auto dataset = [](const auto& member) {
    const auto* const unread = std::get_if<hdf5::Unread>(&member.second.value.data);
    return unread != nullptr && unread->damaged;
  };
  return !group.damage.empty() || std::ranges::any_of(group.datasets, dataset) ||
         std::ranges::any_of(group.groups, [](const auto& member) { return is_damaged(member.second); });
}

/// The path of an object as MATLAB says it: "/trial/force" is variable 'trial.force'.
Error in_matlab_words(Error error) {
  if (!error.where.starts_with("/")) return error;
  const std::size_t end = std::min(error.where.find(", "), error.where.size());
  std::string name = error.where.substr(1, end - 1);
  std::ranges::replace(name, '/', '.');
  error.where = fmt::format("variable '{}'{}", name, error.where.substr(end));
  return error;
}

}  // namespace

Contents contents_of_hdf5(hdf5::Group root) {
  Decoder decoder;
  decoder.run(root);
  return std::move(decoder.contents);
}

Result<Contents> decode_hdf5(std::span<const std::byte> file) {
  auto root = hdf5::read(file, {.bytes = largest_claim(file.size()), .available = system::available_memory()});
  if (!root) {
    Error error = root.error();
    error.where = printable(std::move(error.where));  // names of a damaged file can be anything
    return tl::unexpected(is_mat_hdf5(file, {}) ? in_matlab_words(std::move(error)) : error);
  }
  if (is_mat_hdf5(file, *root)) return contents_of_mat_hdf5(std::move(*root));
  const bool own = text_attribute(root->attributes, "format") == kLayout;
  if (own && is_damaged(*root)) {  // of a recording, nothing may be missing
    const Contents contents = contents_of_hdf5(std::move(*root));
    return bad_data(contents.damaged.begin()->second, std::string(kCopyAgain), contents.damaged.begin()->first);
  }
  return contents_of_hdf5(std::move(*root));
}

}  // namespace mbk::recording
