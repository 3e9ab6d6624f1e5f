#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "mbk/base/core/columns.h"
#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::recording {

/// A column of so many samples is long: not all of it has to be in memory at a time.
inline constexpr Index kLong = 1 << 20;

/// A file without a name, in TMPDIR or else /var/tmp, that holds the numbers of long columns. Their memory becomes a
/// private view of that file: whoever reads them finds them where they stood, and what nobody reads takes no memory.
/// The file is gone with its last view. Where it cannot be made or the disk is full, numbers stay in memory.
class DiskPages {
 public:
  DiskPages() = default;
  DiskPages(const DiskPages&) = delete;
  DiskPages& operator=(const DiskPages&) = delete;
  DiskPages(DiskPages&&) = delete;
  DiskPages& operator=(DiskPages&&) = delete;
  ~DiskPages();

  /// Takes the whole pages among `count` numbers.
  /// @returns  how many numbers it is done with; the next ones are to be given from there on
  Index take(double* first, Index count);
  /// Takes the signals of a trial.
  void take(PreparedTrial& trial);

  /// Numbers that come piece by piece and go to the file at once, without having been where they are to stand.
  struct Coming {
    double* first = nullptr;  ///< where they are to stand
    Index count = 0;          ///< as many as can come
    Index come = 0;
    std::size_t offset = 0;  ///< of the first whole page in the file
    bool on_disk = false;    ///< what has come of the whole pages is in the file alone
  };
  [[nodiscard]] Coming expect(double* first, Index count);
  /// From then on those that have come are to be read by `arrived` alone.
  void add(Coming& coming, const double* from, Index count);
  /// All that have come stand where they are to stand. No more may come.
  /// @throws std::bad_alloc  where they cannot be brought back from the file
  void arrived(Coming& coming);

 private:
  [[nodiscard]] bool open();
  [[nodiscard]] bool read_back(void* to, std::size_t count, std::size_t offset) const;

  int descriptor_ = -1;
  bool failed_ = false;
  std::size_t size_ = 0;
};

/// The numbers are read no more for now: those that stand unchanged in a file leave the memory, and come back when they
/// are read. With all others nothing happens.
void let_go(const double* first, Index count);
inline void let_go(const Eigen::Ref<const Vector>& numbers) {
  let_go(numbers.data(), numbers.size());
}
/// Of the signals of a trial.
void let_go(const PreparedTrial& trial);

/// Calls use(part, begin) with one piece of a column after another, and lets go of each. A short column is one piece.
/// @param overlap  numbers that a piece has in common with the next
template <class Use>
void in_pieces(const Eigen::Ref<const Vector>& numbers, Index overlap, const Use& use) {
  constexpr Index kAtOnce = 1 << 19;
  for (Index begin = 0; begin + overlap < numbers.size(); begin += kAtOnce) {
    const auto part = numbers.segment(begin, std::min(kAtOnce + overlap, numbers.size() - begin));
    use(part, begin);
    let_go(part);
  }
}

/// For a walk along a column: lets go of what lies before the number that it has reached.
[[nodiscard]] inline std::function<void(Index)> let_go_behind(const Eigen::Ref<const Vector>& numbers) {
  return [first = numbers.data(), count = numbers.size(), done = Index{0}](Index reached) mutable {
    constexpr Index kAtOnce = 1 << 18;
    if (reached < count && reached - done < kAtOnce) return;
    let_go(first + done, reached - done);
    done = reached;
  };
}

/// Lets go of what lies behind a walk along columns.
class InPassing {
 public:
  explicit InPassing(std::vector<Columns> columns, Index begin = 0) : columns_(std::move(columns)), done_(begin) {}
  /// The rows before that one were read; a walk may begin anew.
  void reached(Index row) {
    if (row < done_) done_ = row;
    if (row - done_ >= kAtOnce) let_go_before(row);
  }
  /// The walk ends before that row.
  void let_go_before(Index row);

 private:
  static constexpr Index kAtOnce = 1 << 18;
  std::vector<Columns> columns_;
  Index done_;
};

}  // namespace mbk::recording
