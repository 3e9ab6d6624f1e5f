#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "mbk/files/contents/contents.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::recording {

/// Calls use(name, member) for every dataset and group of a group, in the order of their names.
template <class Group, class Use>
void for_each_member(Group& group, const Use& use) {
  auto dataset = group.datasets.begin();
  auto inner = group.groups.begin();
  while (dataset != group.datasets.end() || inner != group.groups.end()) {
    if (inner == group.groups.end() || (dataset != group.datasets.end() && dataset->first < inner->first)) {
      use(dataset->first, dataset->second);
      ++dataset;
    } else {
      use(inner->first, inner->second);
      ++inner;
    }
  }
}

/// Takes numbers out of the tree as a matrix of that many rows and columns, column by column: they are removed from the
/// tree, so that a large recording is not in memory twice.
[[nodiscard]] SharedMatrix take_columns(hdf5::Numbers& numbers, std::uint64_t rows, std::uint64_t columns);

/// The same, row by row.
[[nodiscard]] SharedMatrix take_rows(hdf5::Numbers& numbers, std::uint64_t rows, std::uint64_t columns);

/// The integer remainders, row by row, for a matrix from take_rows.
[[nodiscard]] Rests take_rests(hdf5::Numbers& numbers, std::uint64_t rows, std::uint64_t columns);

/// The text of an attribute, in UTF-8 without control characters; "" if there is none.
[[nodiscard]] std::string text_attribute(const hdf5::Attributes& attributes, std::string_view name);

/// The group at a path in the form of references ("/#refs#/a"), or nullptr.
[[nodiscard]] hdf5::Group* find_group(hdf5::Group& root, std::string_view path);

/// The dataset at such a path, or nullptr.
[[nodiscard]] hdf5::Dataset* find_dataset(hdf5::Group& root, std::string_view path);

inline constexpr std::string_view kCopyAgain =
    "the file is damaged or truncated: copy it again from where it was recorded";

/// The note on a damaged part of a file that was ignored.
[[nodiscard]] std::string lost_note(std::string_view what, std::string_view why);

}  // namespace mbk::recording
