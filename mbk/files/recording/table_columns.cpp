#include "mbk/files/recording/table_columns.h"

#include <algorithm>
#include <utility>

namespace mbk::recording {
namespace {

constexpr Index kNumbersAtOnce = 1 << 18;  ///< numbers, about: they stay in a cache until they are written
constexpr Index kMin = 64;                 ///< rows

}  // namespace

void TableColumns::expect(Index columns, Index rows) {
  numbers_.assign(static_cast<std::size_t>(columns), Vector());
  for (Vector& column : numbers_) column.resize(rows);
  places_.resize(numbers_.size());
  begin_block();
}

void TableColumns::begin_block() {
  const Index room = numbers_.front().size();
  if (!is_long()) {
    end_ = room;
    std::ranges::transform(numbers_, places_.begin(), [](Vector& column) { return column.data(); });
    return;
  }
  const auto columns = static_cast<Index>(numbers_.size());
  block_.resize(std::max(kNumbersAtOnce / columns, kMin), columns);
  begin_ = rows_;
  end_ = std::min(room, begin_ + block_.rows());
  for (Index c = 0; c < columns; ++c) places_[static_cast<std::size_t>(c)] = block_.col(c).data();
  if (!coming_.empty()) return;
  for (Vector& column : numbers_) coming_.push_back(disk_.expect(column.data() + rows_, room - rows_));
}

void TableColumns::go_on() {
  if (rows_ < numbers_.front().size()) {
    write_block();
  } else {
    settle();
    for (Vector& column : numbers_) {
      column.conservativeResize(rows_ + rows_ / 4 + 1);
      if (is_long()) disk_.take(column.data(), rows_);
    }
    coming_.clear();
    settled_ = rows_;
  }
  begin_block();
}

void TableColumns::write_block() {
  wait();
  block_.swap(written_);
  // With both, a system that has no thread left does it when it is waited for.
  writing_ = std::async(std::launch::async | std::launch::deferred, [this, count = rows_ - begin_] {
    for (std::size_t c = 0; c < coming_.size(); ++c) {
      disk_.add(coming_[c], written_.col(static_cast<Index>(c)).data(), count);
    }
  });
}

void TableColumns::wait() {
  if (writing_.valid()) writing_.get();
}

void TableColumns::settle() {
  if (!is_long() || settled_ == rows_) return;
  write_block();
  wait();
  for (DiskPages::Coming& coming : coming_) disk_.arrived(coming);
  coming_.clear();
  settled_ = rows_;
  begin_block();
}

Eigen::Ref<const Vector> TableColumns::column(std::size_t column) {
  settle();
  return numbers_[column].head(rows_);
}

Vector TableColumns::take(std::size_t column) {
  settle();
  numbers_[column].conservativeResize(rows_);
  return std::move(numbers_[column]);
}

}  // namespace mbk::recording
