#pragma once

#include <future>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/files/contents/disk_pages.h"

namespace mbk::recording {

/// The columns of a table that is read row by row. Those of a long table are written to a file while rows arrive, so
/// that only the last rows are in memory.
class TableColumns {
 public:
  TableColumns() = default;
  /// @param columns  at least one    @param rows  expected number; there may be more
  void expect(Index columns, Index rows);

  /// The current row: the numbers before it are complete.
  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] double& operator[](std::size_t column) { return places_[column][rows_ - begin_]; }
  void next_row() {
    ++rows_;
    if (rows_ == end_) go_on();
  }
  /// The complete rows of a column, to be read.
  [[nodiscard]] Eigen::Ref<const Vector> column(std::size_t column);
  /// The same, moved out.
  [[nodiscard]] Vector take(std::size_t column);

 private:
  [[nodiscard]] bool is_long() const { return numbers_.front().size() > kLong; }
  void go_on();
  void begin_block();
  void write_block();
  /// All complete rows are in `numbers_`, in memory or in their file.
  void settle();
  void wait();

  std::vector<Vector> numbers_;           ///< with room for more rows
  std::vector<double*> places_;           ///< of the row begin_ in each column: in `numbers_`, or in a block
  Index rows_ = 0, begin_ = 0, end_ = 0;  ///< end_: the row before which there is to be room for more
  Index settled_ = 0;                     ///< rows that stand in the `numbers_` of a long table
  Matrix block_, written_;                ///< rows of a long table, and those before that are being written
  DiskPages disk_;
  std::vector<DiskPages::Coming> coming_;  ///< of the columns of a long table
  std::future<void> writing_;              ///< it ends before what it writes is gone
};

}  // namespace mbk::recording
