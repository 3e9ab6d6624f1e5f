#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "mbk/base/realtime/bounded_ring.h"
#include "mbk/base/realtime/wake_up.h"
#include "mbk/experiment/session/loop.h"
#include "mbk/experiment/session/viewer.h"
#include "mbk/files/journal/journal.h"

namespace mbk::session {

/// Takes the loop's ticks to the journal from a thread of its own: a block at least every 50 ms. Another thread waits
/// for the disk and, in real time, a third for whoever watches; with neither of them it shares a lock, so that what is
/// slow, or is kept from running, holds up no recording. Free space, and whether the file is still under its name, is
/// looked at once a second. Where the file fails, or there is no memory for what comes, LoopFlags::recording falls, and
/// what could not be written is tried again at the end. A file that was removed or replaced goes on under another name,
/// with all that it holds. A watch that throws is not called again; the recording goes on.
class Recorder {
 public:
  /// Returns when its thread is ready: what comes into the ring from then on is written in time.
  /// @param in_real_time  the thread that writes goes before all that is not in real time, where that is allowed: a
  ///        machine that is busy must not keep what happened from the file. Ticks that a watch is too slow for are left
  ///        out of what it sees; otherwise it is waited for.
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
  void failed(const char* why) noexcept;
  void write_pending();
  void write_rest();
  void look_after_file();
  void stop_threads();

  realtime::BoundedRing<journal::Tick>& ticks_;
  journal::Writer writer_;
  LoopFlags& flags_;
  Viewer viewer_;
  bool in_real_time_;
  std::vector<journal::Tick> pending_;
  std::uint64_t given_up_ = 0;  // ticks that found no room to wait for the disk
  std::optional<Error> failure_, misplaced_;
  std::string remark_;  // what failed beside the file, or befell it: of the recorder's thread until that is over
  std::atomic<bool> ready_{false}, over_{false};
  realtime::WakeUp disk_;  // of the thread that waits for it
  std::thread recording_, syncing_;
};

}  // namespace mbk::session
