#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "mbk/files/hdf5/output.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// Texts of a tree whose lengths vary: they stand in global heaps, and values only point to them.
class TextHeaps {
 public:
  /// Appends all texts of `root`, which must stay where it is.
  void write(const Group& root, Output& out);

  /// Puts what points to one of these texts.
  void put_pointer(const std::string& text, Output& out) const;

 private:
  struct Place {
    std::uint64_t heap = 0;
    std::size_t index = 0;
  };
  std::unordered_map<const std::string*, Place> places_;
};

}  // namespace mbk::hdf5
