#pragma once

#include <optional>
#include <vector>

#include "mbk/files/hdf5/global_heap.h"
#include "mbk/files/hdf5/object_header.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// References whose paths are found when the whole tree has been walked.
struct OpenReferences {
  References* place;  ///< in the tree; it does not move
  std::vector<std::uint64_t> addresses;
};

/// What reading the values of a file needs and leaves behind.
struct Reading {
  File file;
  GlobalHeap heap;
  std::vector<OpenReferences> references;
};

/// The attributes of an object: its attribute messages, and those in a fractal heap (specification, IV.A.2.m).
/// @param place  where they stay
/// @fails  one of them is broken, or there twice.
[[nodiscard]] Result<void> read_attributes(Reading& reading, const ObjectHeader& header, Attributes& place);

/// The elements of a dataset.
/// @param place  where they stay, or with `Unread` why they are not read
/// @param table  where the columns of a compound type stay instead
/// @fails  they are damaged, or a part of them was never written.
[[nodiscard]] Result<void> read_value(Reading& reading, const ObjectHeader& header, Value& place,
                                      std::optional<Group>& table);

[[nodiscard]] bool is_dataset(const ObjectHeader& header);

}  // namespace mbk::hdf5
