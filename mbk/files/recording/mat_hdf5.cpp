#include "mbk/files/recording/mat_hdf5.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/lines.h"
#include "mbk/files/contents/utf16.h"
#include "mbk/files/recording/hdf5_attributes.h"
#include "mbk/files/recording/hdf5_tree.h"
#include "mbk/files/recording/mat_object.h"
#include "mbk/files/recording/without_ones.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kHeader = "MATLAB 7.3";
constexpr std::size_t kDimensions = 8;                   ///< of an array that is read, at most
constexpr std::size_t kMaxText = std::size_t{64} << 20;  ///< [bytes] of all cell arrays of a file
constexpr int kDeepest = 16;                             ///< references within references
constexpr std::size_t kMaxElements = 1024;               ///< of a structure or cell array that is still read
constexpr std::size_t kMaxReferred = 100'000;            ///< cells and fields of all of them
constexpr auto kClass = "MATLAB_class";

bool is_numeric_class(std::string_view name) {
  return name == "double" || name == "single" || name == "logical" || name.starts_with("int") ||
         name.starts_with("uint");
}

/// One row of text, stored as the numbers of its UTF-16 code units; nothing where it is stored otherwise.
std::optional<std::string> line_of_text(const hdf5::Dataset& dataset) {
  if (dataset.attributes.contains("MATLAB_empty")) return std::string();
  const auto* const units = std::get_if<hdf5::Numbers>(&dataset.value.data);
  const auto& shape = dataset.value.shape;
  if (units == nullptr || shape.size() != 2 || shape[1] != 1) return std::nullopt;
  if (!(units->values.array() >= 0.0 && units->values.array() <= 65535.0).all()) return std::nullopt;
  std::u16string line;
  for (const double unit : units->values) line += static_cast<char16_t>(unit);
  return utf8_from_utf16(line);
}

/// Paths of what the cells or fields hold, where a value has such.
const hdf5::References* references_of(const hdf5::Value& value) {
  return std::get_if<hdf5::References>(&value.data);
}

class MatDecoder {
 public:
  explicit MatDecoder(hdf5::Group& root) : root_(root) { contents.format = "MAT v7.3"; }
  Contents contents;
  SharedNotes notes;

  void group(hdf5::Group& group, const std::string& prefix, int depth = 0) {
    if (!group.damage.empty()) lost(prefix.empty() ? "/" : prefix, group.damage);
    for_each_member(group, [&](const std::string& name, auto& member) {
      if (name.starts_with('#')) return;  // MATLAB's own
      variable(member, prefix.empty() ? printable(name) : prefix + "." + printable(name), depth);
    });
  }

 private:
  template <class Member>
  void variable(Member& member, const std::string& name, int depth) {
    const std::string type = text_attribute(member.attributes, kClass);
    if (member.attributes.contains("MATLAB_object_decode")) {
      if (type == "function_handle") return aside(name, "a function handle");
      return list_object(contents, name, type);
    }
    if (member.attributes.contains("MATLAB_sparse")) return aside(name, "a sparse matrix");
    if constexpr (std::same_as<Member, hdf5::Group>) {
      if (is_structure_array(member)) return structures(member, name, depth);
      group(member, name, depth);
    } else {
      dataset(member, name, type, depth);
    }
  }

  void dataset(hdf5::Dataset& dataset, const std::string& name, const std::string& type, int depth) {
    if (const auto* const unread = std::get_if<hdf5::Unread>(&dataset.value.data)) {
      return unread->damaged ? lost(name, unread->what) : aside(name, unread->what);
    }
    if (type == "char") return text(dataset, name);
    if (dataset.attributes.contains("MATLAB_empty")) return;
    if (type == "cell") return cells(dataset, name, depth);
    if (type.empty() || is_numeric_class(type)) return numbers(dataset, name);
    aside(name, fmt::format("of class '{}'", type));
  }

  void numbers(hdf5::Dataset& dataset, const std::string& name) {
    hdf5::Value& value = dataset.value;
    if (references_of(value) != nullptr) return aside(name, "of references");
    auto* const numbers = std::get_if<hdf5::Numbers>(&value.data);
    if (numbers == nullptr) return aside(name, "not numeric");
    const std::vector<std::uint64_t> sides = value.shape;
    if (const auto squeezed = without_ones(value.shape)) {
      contents.notes.push_back(fmt::format("variable '{}' ({}) was read as {}×{}", name,
                                           fmt::join(value.shape.rbegin(), value.shape.rend(), "×"), (*squeezed)[1],
                                           (*squeezed)[0]));
      value.shape = *squeezed;
    }
    const bool block = value.shape.size() > 2;
    const bool bytes = numbers->stored == hdf5::Stored::int8 || numbers->stored == hdf5::Stored::uint8;  // images
    if (value.shape.size() < 2 || (block && (bytes || value.shape.size() > kDimensions))) {
      return aside(name, fmt::format("an array of {} dimensions", value.shape.size()));
    }
    Array& array = contents.arrays.emplace_back();
    array.name = name;
    apply_attributes(dataset.attributes, *numbers, 1, false, array, notes);
    array.rests = std::move(numbers->rests);
    if (sides.size() > 2) array.shape = {sides.rbegin(), sides.rend()};
    const auto count = static_cast<std::uint64_t>(numbers->values.size());
    array.values = block ? take_columns(*numbers, count, 1) : take_columns(*numbers, value.shape[1], value.shape[0]);
    value.data = hdf5::Unread{fmt::format("the same as '{}'", name)};  // for a second reference to it
  }

  /// The fields of a structure array are datasets of references, one to each element, and say no class.
  static bool is_structure_array(const hdf5::Group& group) {
    const auto of_references = [](const auto& member) {
      return references_of(member.second.value) != nullptr && text_attribute(member.second.attributes, kClass).empty();
    };
    return !group.datasets.empty() && group.groups.empty() && std::ranges::all_of(group.datasets, of_references);
  }

  /// The elements as 'name(1).field', 'name(2).field', …
  void structures(const hdf5::Group& group, const std::string& name, int depth) {
    std::size_t count = 0;
    for (const auto& [field, dataset] : group.datasets) {
      count = std::max(count, references_of(dataset.value)->paths.size());
    }
    if (count > kMaxElements) return aside(name, "a large structure array");
    for (std::size_t k = 0; k < count; ++k) {
      for (const auto& [field, dataset] : group.datasets) {
        const auto& paths = references_of(dataset.value)->paths;
        if (k < paths.size()) referred(paths[k], fmt::format("{}({}).{}", name, k + 1, printable(field)), depth + 1);
      }
    }
  }

  /// The target of a reference, elsewhere in the file and possibly with references.
  void referred(const std::string& path, const std::string& name, int depth) {
    if (path.empty()) return;
    if (depth > kDeepest) {
      if (!std::exchange(too_deep_, true)) aside(name, "nested too deeply");
      return;
    }
    if (elements_left_ == 0) return;
    if (--elements_left_ == 0) return aside(name, fmt::format("beyond the limit of {} cells and fields", kMaxReferred));
    if (hdf5::Dataset* const dataset = find_dataset(root_, path)) return variable(*dataset, name, depth);
    if (hdf5::Group* const group = find_group(root_, path)) return variable(*group, name, depth);
  }

  void text(const hdf5::Dataset& dataset, const std::string& name) {
    auto line = line_of_text(dataset);
    if (!line) return aside(name, "text in an unsupported encoding");
    contents.texts.push_back({name, printable_lines(*line)});
  }

  /// A cell array whose cells all are one line of text is read as these lines, any other one as 'name{1}', 'name{2}', …
  /// The cells are elsewhere in the file, and several can be the same one.
  void cells(const hdf5::Dataset& dataset, const std::string& name, int depth) {
    const auto* const references = references_of(dataset.value);
    if (references == nullptr || references->paths.empty()) return aside(name, "a cell array");
    if (lines_of_cells(*references, name)) return;
    if (references->paths.size() > kMaxElements) return aside(name, "a large cell array");
    const std::size_t texts = contents.texts.size();
    for (std::size_t k = 0; k < references->paths.size(); ++k) {
      referred(references->paths[k], fmt::format("{}{{{}}}", name, k + 1), depth + 1);
    }
    if (contents.texts.size() > texts) {
      contents.notes.push_back(fmt::format("texts in the cell array '{}' were ignored", name));
      contents.texts.resize(texts);
    }
  }

  /// Whether all cells were lines of text, or too much of it.
  bool lines_of_cells(const hdf5::References& references, const std::string& name) {
    std::vector<std::string> lines;
    for (const std::string& path : references.paths) {
      const hdf5::Dataset* const cell = find_dataset(root_, path);
      if (cell == nullptr || text_attribute(cell->attributes, kClass) != "char") return false;
      auto line = line_of_text(*cell);
      if (!line) return false;
      if (line->size() > text_left_) {
        aside(name, "a cell array with too much text");
        return true;
      }
      text_left_ -= line->size();
      lines.push_back(in_one_line(*line));
    }
    contents.texts.push_back({name, std::move(lines)});
    return true;
  }

  void lost(const std::string& name, const std::string& why) {
    contents.notes.push_back(lost_note(fmt::format("variable '{}'", name), why));
    contents.damaged.emplace(name, why);
  }

  void aside(const std::string& name, std::string_view what) {
    contents.notes.push_back(fmt::format("variable '{}' is {} and was ignored", name, what));
  }

  hdf5::Group& root_;
  bool too_deep_ = false;  ///< was said
  std::size_t text_left_ = kMaxText, elements_left_ = kMaxReferred;
};

}  // namespace

bool is_mat_hdf5(std::span<const std::byte> file, const hdf5::Group& root) {
  if (file.size() >= kHeader.size() && std::memcmp(file.data(), kHeader.data(), kHeader.size()) == 0) return true;
  const auto says_class = [](const auto& member) { return member.second.attributes.contains(kClass); };
  return std::ranges::any_of(root.datasets, says_class) || std::ranges::any_of(root.groups, says_class);
}

Contents contents_of_mat_hdf5(hdf5::Group root) {
  MatDecoder decoder(root);
  decoder.group(root, "");
  for (std::string& line : decoder.notes.lines()) decoder.contents.notes.push_back(std::move(line));
  give_rates(decoder.contents);
  return std::move(decoder.contents);
}

}  // namespace mbk::recording
