#include "mbk/files/recording/hdf5_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/byte_view.h"

namespace mbk::recording {
namespace {

/// A side of a matrix. Beside a side of 0 a damaged file can state one that no number of ours can hold.
Index side(std::uint64_t length) {
  return static_cast<Index>(std::min<std::uint64_t>(length, std::numeric_limits<Index>::max()));
}

}  // namespace

SharedMatrix take_columns(hdf5::Numbers& numbers, std::uint64_t rows, std::uint64_t columns) {
  const auto kept = std::make_shared<Vector>(std::move(numbers.values));
  numbers.values.resize(0);
  return {kept->data(), side(rows), side(columns), kept};
}

SharedMatrix take_rows(hdf5::Numbers& numbers, std::uint64_t rows, std::uint64_t columns) {
  if (rows == 1 || columns == 1) return take_columns(numbers, rows, columns);
  SharedMatrix matrix = Matrix(numbers.values.reshaped<Eigen::RowMajor>(side(rows), side(columns)));
  numbers.values.resize(0);
  return matrix;
}

Rests take_rests(hdf5::Numbers& numbers, std::uint64_t rows, std::uint64_t columns) {
  Rests stored = std::move(numbers.rests);
  if (stored.empty() || rows == 1 || columns == 1) return stored;
  Rests by_columns;
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) by_columns.put(c * rows + r, stored[r * columns + c], rows * columns);
  }
  return by_columns;
}

std::string text_attribute(const hdf5::Attributes& attributes, std::string_view name) {
  const auto found = attributes.find(std::string(name));
  if (found == attributes.end()) return {};
  const auto* const texts = std::get_if<hdf5::Texts>(&found->second.data);
  return texts != nullptr && texts->size() == 1 ? printable(texts->front()) : std::string();
}

hdf5::Group* find_group(hdf5::Group& root, std::string_view path) {
  hdf5::Group* group = &root;
  while (path.starts_with('/')) {
    path.remove_prefix(1);
    const std::size_t end = std::min(path.find('/'), path.size());
    if (end == 0) continue;
    const auto inner = group->groups.find(std::string(path.substr(0, end)));
    if (inner == group->groups.end()) return nullptr;
    group = &inner->second;
    path.remove_prefix(end);
  }
  return path.empty() ? group : nullptr;
}

hdf5::Dataset* find_dataset(hdf5::Group& root, std::string_view path) {
  const std::size_t slash = path.rfind('/');
  if (slash == path.npos) return nullptr;
  hdf5::Group* const group = find_group(root, path.substr(0, slash));
  if (group == nullptr) return nullptr;
  const auto dataset = group->datasets.find(std::string(path.substr(slash + 1)));
  return dataset == group->datasets.end() ? nullptr : &dataset->second;
}

std::string lost_note(std::string_view what, std::string_view why) {
  return fmt::format("{} is damaged and was ignored: {}; the rest of the file was read", what, why);
}

}  // namespace mbk::recording
