#include "mbk/files/recording/mat_hdf5.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/utf16.h"
#include "mbk/files/recording/hdf5_tree.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kHeader = "MATLAB 7.3";
constexpr std::size_t kMaxText = std::size_t{64} << 20;  ///< [bytes] of all cell arrays of a file
constexpr auto kClass = "MATLAB_class";

bool is_numeric_class(std::string_view name) {
  return name == "double" || name == "single" || name == "logical" || name.starts_with("int") ||
         name.starts_with("uint");
}

/// One line of text, stored as the numbers of its UTF-16 code units; nothing where it is stored otherwise.
std::optional<std::string> line_of_text(const hdf5::Dataset& dataset) {
  if (dataset.attributes.contains("MATLAB_empty")) return std::string();
  const auto* const units = std::get_if<hdf5::Numbers>(&dataset.value.data);
  const auto& shape = dataset.value.shape;
  if (units == nullptr || shape.size() != 2 || shape[1] != 1) return std::nullopt;
  if (!(units->values.array() >= 0.0 && units->values.array() <= 65535.0).all()) return std::nullopt;
  std::u16string line;
  for (const double unit : units->values) line += static_cast<char16_t>(unit);
  return printable(utf8_from_utf16(line));
}

class Decoder {
 public:
  explicit Decoder(const hdf5::Group& root) : root_(root) { contents.format = "MAT v7.3"; }
  Contents contents;

  void group(hdf5::Group& group, const std::string& prefix) {
    for_each_member(group, [&](const std::string& name, auto& member) {
      if (name.starts_with('#')) return;  // MATLAB's own
      variable(member, prefix.empty() ? printable(name) : prefix + "." + printable(name));
    });
  }

 private:
  template <class Member>
  void variable(Member& member, const std::string& name) {
    const std::string type = text_attribute(member.attributes, kClass);
    if (member.attributes.contains("MATLAB_object_decode")) {
      return aside(name, type == "function_handle"
                             ? "a function handle"
                             : fmt::format("an object of MATLAB class '{}', which only MATLAB can read", type));
    }
    if (member.attributes.contains("MATLAB_sparse")) return aside(name, "a sparse matrix");
    if constexpr (std::same_as<Member, hdf5::Group>) {
      group(member, name);
    } else {
      dataset(member, name, type);
    }
  }

  void dataset(hdf5::Dataset& dataset, const std::string& name, const std::string& type) {
    if (type == "char") return text(dataset, name);
    if (dataset.attributes.contains("MATLAB_empty")) return;
    if (type == "cell") return cells(dataset, name);
    if (type.empty() || is_numeric_class(type)) return numbers(dataset.value, name);
    aside(name, fmt::format("of class '{}'", type));
  }

  void numbers(hdf5::Value& value, const std::string& name) {
    if (const auto* const unread = std::get_if<hdf5::Unread>(&value.data)) return aside(name, unread->what);
    if (std::holds_alternative<hdf5::References>(value.data)) return aside(name, "a field of a structure array");
    auto* const numbers = std::get_if<hdf5::Numbers>(&value.data);
    if (numbers == nullptr) return aside(name, "not numeric");
    if (value.shape.size() != 2) return aside(name, fmt::format("an array of {} dimensions", value.shape.size()));
    contents.arrays.push_back({name, take_columns(*numbers, value.shape[1], value.shape[0])});
  }

  void text(const hdf5::Dataset& dataset, const std::string& name) {
    auto line = line_of_text(dataset);
    if (!line) return aside(name, "text in a way that is not read");
    contents.texts.push_back({name, {std::move(*line)}});
  }

  /// A cell array is read where each cell is one line of text. The cells are datasets elsewhere in the file, and
  /// several can be the same one.
  void cells(const hdf5::Dataset& dataset, const std::string& name) {
    const auto* const references = std::get_if<hdf5::References>(&dataset.value.data);
    if (references == nullptr || references->paths.empty()) return aside(name, "a cell array");
    std::vector<std::string> lines;
    for (const std::string& path : references->paths) {
      const hdf5::Dataset* const cell = find_dataset(root_, path);
      if (cell == nullptr || text_attribute(cell->attributes, kClass) != "char") return aside(name, "a cell array");
      auto line = line_of_text(*cell);
      if (!line) return aside(name, "a cell array");
      if (line->size() > text_left_) return aside(name, "a cell array of too much text");
      text_left_ -= line->size();
      lines.push_back(std::move(*line));
    }
    contents.texts.push_back({name, std::move(lines)});
  }

  void aside(const std::string& name, std::string_view what) {
    contents.notes.push_back(fmt::format("variable '{}' is {}; ignored", name, what));
  }

  const hdf5::Group& root_;
  std::size_t text_left_ = kMaxText;
};

}  // namespace

bool is_mat_hdf5(std::span<const std::byte> file, const hdf5::Group& root) {
  if (file.size() >= kHeader.size() && std::memcmp(file.data(), kHeader.data(), kHeader.size()) == 0) return true;
  const auto says_class = [](const auto& member) { return member.second.attributes.contains(kClass); };
  return std::ranges::any_of(root.datasets, says_class) || std::ranges::any_of(root.groups, says_class);
}

Contents contents_of_mat_hdf5(hdf5::Group root) {
  Decoder decoder(root);
  decoder.group(root, "");
  return std::move(decoder.contents);
}

}  // namespace mbk::recording
