#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::recording {

/// Numbers that arrive one by one, in blocks, so that existing numbers do not move.
class Column {
 public:
  void add(double value) {
    if (blocks_.empty() || blocks_.back().size() == blocks_.back().capacity()) {
      std::vector<double> block;
      block.reserve(std::clamp(size_, kFirst, kLargest));
      blocks_.push_back(std::move(block));
    }
    blocks_.back().push_back(value);
    ++size_;
  }
  [[nodiscard]] std::size_t size() const { return size_; }

  /// All of them, moved out.
  [[nodiscard]] Vector take() {
    Vector values(static_cast<Index>(size_));
    Index at = 0;
    for (std::vector<double>& block : blocks_) {
      std::copy(block.begin(), block.end(), values.data() + at);
      at += std::ssize(block);
      block = {};
    }
    clear();
    return values;
  }
  void clear() {
    blocks_.clear();
    blocks_.shrink_to_fit();
    size_ = 0;
  }

 private:
  static constexpr std::size_t kFirst = 8, kLargest = 32768;
  std::vector<std::vector<double>> blocks_;
  std::size_t size_ = 0;
};

}  // namespace mbk::recording
