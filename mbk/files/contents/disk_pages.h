#pragma once

#include <cstddef>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/system/files.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::recording {

/// Number of samples above which a column need not be entirely in memory.
inline constexpr Index kLong = 1 << 20;

/// A file without a name, in TMPDIR or else /var/tmp, that holds the numbers of long columns. Their memory becomes a
/// private view of that file: readers find them at the same address, and the system may reuse the memory of unchanged
/// numbers until they are read. The file disappears with its last view. If it cannot be created or the disk is full,
/// numbers stay in memory.
class DiskPages {
 public:
  DiskPages() = default;
  DiskPages(const DiskPages&) = delete;
  DiskPages& operator=(const DiskPages&) = delete;
  DiskPages(DiskPages&&) = delete;
  DiskPages& operator=(DiskPages&&) = delete;
  ~DiskPages() = default;

  /// Takes the whole pages among `count` numbers.
  /// @returns  number of numbers taken; continue from there
  Index take(double* first, Index count);
  /// Takes the signals of a trial.
  void take(PreparedTrial& trial);

  /// Numbers that arrive in pieces and go directly to the file, without first being at their final address.
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

  system::OpenFile file_;
  bool failed_ = false;
  std::size_t size_ = 0;
};

}  // namespace mbk::recording
