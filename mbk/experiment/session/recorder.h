#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "mbk/base/realtime/bounded_ring.h"
#include "mbk/experiment/session/loop.h"
#include "mbk/files/journal/journal.h"

namespace mbk::session {

/// Called with ticks as they are recorded, from the recorder's thread, in their order. Must not block for long.
using Watch = std::function<void(std::span<const journal::Tick>)>;

/// Takes the loop's ticks to the journal from a thread of its own: a block at least every 50 ms, and a third thread
/// that waits for the disk, so that a slow disk holds nobody up. Free space, and whether the file is still under its
/// name, is looked at once a second. Where the file fails, or there is no memory for what comes, LoopFlags::recording
/// falls, and what could not be written is tried again at the end. A file that was removed or replaced goes on under
/// another name, with all that it holds. A watch that throws is not called again; the recording goes on.
class Recorder {
 public:
  /// @param in_real_time  its threads go before all that is not in real time, where that is allowed: a machine that is
  ///        busy must not keep what happened from the disk
  Recorder(realtime::BoundedRing<journal::Tick>& ticks, journal::Writer writer, LoopFlags& flags, Watch watch,
           bool in_real_time = false);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder();

  /// Takes what is left, writes the ending and closes the journal. The loop is over.
  /// @returns  the ending as it was written: with the ticks that were dropped, and what failed besides
  /// @fails  data: ticks could not be written, or the file is under no name; the message says how many and why.
  [[nodiscard]] Result<journal::Ending> finish(journal::Ending ending);

  /// Where the journal is.
  [[nodiscard]] const std::filesystem::path& journal() const { return writer_.file(); }

 private:
  void record() noexcept;
  void keep_syncing() noexcept;
  bool drain();
  void show(std::span<const journal::Tick> ticks) noexcept;
  void failed(const char* why) noexcept;
  void write_pending();
  void write_rest();
  void look_after_file();
  void stop_threads();

  realtime::BoundedRing<journal::Tick>& ticks_;
  journal::Writer writer_;
  LoopFlags& flags_;
  Watch watch_;
  bool in_real_time_;
  std::vector<journal::Tick> pending_;
  std::uint64_t given_up_ = 0;  // ticks that found no room to wait for the disk
  std::optional<Error> failure_, misplaced_;
  std::string remark_;  // what failed beside the file, or befell it: of the recorder's thread until that is over
  std::atomic<bool> over_{false};
  std::mutex mutex_;
  std::condition_variable wake_;
  bool dirty_ = false, closing_ = false;
  std::thread recording_, syncing_;
};

}  // namespace mbk::session
