#include "mbk/files/recording/hdf5_recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/lines.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/hdf5/read_hdf5.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/hdf5_tree.h"
#include "mbk/files/recording/mat_hdf5.h"
#include "mbk/files/recording/without_ones.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kLongestNumbers = 64;  ///< of an attribute that becomes metadata

/// What a value says, in one line; nothing where it is neither text nor a few numbers.
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
    group(root, "");
  }

 private:
  void group(hdf5::Group& group, const std::string& prefix) {
    if (!group.damage.empty()) lost(prefix.empty() ? "/" : prefix, group.damage);
    if (!group.columns.empty()) hand_units_on(group);
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
    if (value.shape.empty()) return aside(path, "a single number");
    if (const auto squeezed = without_ones(value.shape)) {
      contents.notes.push_back(
          fmt::format("'{}' ({}) was read as {}", path, fmt::join(value.shape, "×"), fmt::join(*squeezed, "×")));
      value.shape = *squeezed;
    }
    const std::size_t rank = value.shape.size();
    if (rank > 2) return aside(path, fmt::format("an array of {} dimensions", rank));
    auto& numbers = std::get<hdf5::Numbers>(value.data);
    std::string unit = text_attribute(dataset.attributes, "unit");
    if (unit.empty()) unit = text_attribute(dataset.attributes, "units");
    const std::uint64_t columns = rank == 2 ? value.shape[1] : 1;
    const std::string name = name_of(path);
    check_frame(name, text_attribute(dataset.attributes, "frame"));
    const bool signal = own_layout_ && (path == "time" || path.starts_with("channels/"));
    contents.arrays.push_back({name, take_rows(numbers, value.shape[0], columns), std::move(unit), signal});
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

  /// mbk takes a channel in the frame of its table. What says otherwise is not believed in silence.
  void check_frame(const std::string& name, const std::string& frame) {
    const auto kinds = kinds_called(name);
    if (frame.empty() || kinds.size() != 1 || kinds.front()->frame == frame) return;
    contents.notes.push_back(fmt::format(
        "'{}' says that its frame is '{}'; mbk takes it {}", name, frame,
        kinds.front()->frame.empty() ? "as it stands" : fmt::format("in the frame '{}'", kinds.front()->frame)));
  }

  /// The units of a table, one for all of its columns or one for each, become those of the columns.
  static void hand_units_on(hdf5::Group& table) {
    for (const char* const name : {"unit", "units"}) {
      const auto said = table.attributes.find(name);
      if (said == table.attributes.end()) continue;
      const auto* const texts = std::get_if<hdf5::Texts>(&said->second.data);
      if (texts == nullptr || (texts->size() != 1 && texts->size() != table.columns.size())) continue;
      for (std::size_t k = 0; k < table.columns.size(); ++k) {
        const auto column = table.datasets.find(table.columns[k]);
        if (column != table.datasets.end()) {
          column->second.attributes.try_emplace("unit",
                                                hdf5::Value{{}, hdf5::Texts{(*texts)[texts->size() == 1 ? 0 : k]}});
        }
      }
    }
  }

  void lost(const std::string& name, const std::string& why) {
    contents.notes.push_back(lost_note(fmt::format("'{}'", name), why));
    contents.damaged.emplace(name, why);
  }

  void aside(const std::string& path, std::string_view what) {
    contents.notes.push_back(fmt::format("'{}' is {}; ignored", path, what));
  }

  bool own_layout_ = false;  ///< as encode_hdf5 writes it
  std::vector<std::string> in_root_;
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
  auto root = hdf5::read(file, {.bytes = largest_claim(file.size()), .available = available_memory()});
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
