#include "mbk/experiment/session/recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>

#include "mbk/base/realtime/signal_stack.h"
#include "mbk/base/realtime/thread_setup.h"

namespace mbk::session {
namespace {

using namespace std::chrono_literals;
using journal::Tick;

constexpr auto kBlockTime = 50ms;
constexpr int kPriority = 70;                   // below the loop's
constexpr std::size_t kBlock = 256;             // ticks, where there are many
constexpr std::size_t kMaxPending = 1 << 20;    // ticks kept for a disk that does not take them
constexpr std::uintmax_t kMinSpace = 16 << 20;  // [bytes] beside what is reserved
constexpr int kSync = 1, kEnd = 2;              // asked of the disk

}  // namespace

Recorder::Recorder(realtime::BoundedRing<Tick>& ticks, journal::Writer writer, LoopFlags& flags, Watch watch,
                   bool in_real_time)
    : ticks_(ticks),
      writer_(std::move(writer)),
      flags_(flags),
      viewer_(std::move(watch), ticks.capacity(), in_real_time ? Viewer::Pace::skips : Viewer::Pace::waits),
      in_real_time_(in_real_time) {
  pending_.reserve(journal::Writer::kLongest);  // where no more memory comes, ticks still reach the file
  try {
    recording_ = std::thread([this] { record(); });
    syncing_ = std::thread([this] { keep_syncing(); });
  } catch (...) {
    stop_threads();
    throw;
  }
  ready_.wait(false);
}

Recorder::~Recorder() {
  stop_threads();
}

void Recorder::stop_threads() {
  over_ = true;
  if (recording_.joinable()) recording_.join();
  disk_.ask(kEnd);
  if (syncing_.joinable()) syncing_.join();
}

bool Recorder::drain() {
  const std::size_t before = pending_.size();
  pending_.resize(before + kBlock);
  const std::size_t came = ticks_.pop(pending_.data() + before, kBlock);
  pending_.resize(before + came);
  viewer_.show(std::span(pending_).subspan(before));
  return came == kBlock;
}

void Recorder::failed(const char* why) noexcept {
  flags_.recording = false;
  try {
    remark_ = fmt::format("the recorder failed: {}", why);
  } catch (...) {  // the ticks that are missing tell of it
  }
}

void Recorder::write_pending() {
  if (pending_.empty()) return;
  const std::span<const Tick> all = pending_;
  std::size_t written = 0;
  failure_.reset();
  while (written < all.size() && !failure_) {
    const auto block = all.subspan(written, std::min(all.size() - written, journal::Writer::kLongest));
    if (auto ok = writer_.append(block); !ok) failure_ = ok.error();
    if (!failure_) written += block.size();
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(written));
  if (failure_) {
    flags_.recording = false;
    const std::size_t over = pending_.size() - std::min(pending_.size(), kMaxPending);
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(over));
    given_up_ += over;
  }
  if (written > 0) disk_.ask(kSync);
}

void Recorder::write_rest() {
  while (drain()) write_pending();
  write_pending();
}

void Recorder::look_after_file() {
  using Place = journal::Writer::Place;
  const Place place = writer_.place();
  if (place != Place::here) {
    flags_.recording = false;
    const std::string lost_name = writer_.file().string();
    if (place == Place::cut && remark_.empty()) {
      remark_ = fmt::format("{} was truncated by another program during recording", lost_name);
    } else if (place == Place::gone) {
      const auto saved = writer_.save_elsewhere();
      misplaced_ = saved ? std::nullopt : std::optional(saved.error());
      if (saved) {
        remark_ = fmt::format("{} was removed or replaced during recording; recording continued in {}", lost_name,
                              writer_.file().string());
      }
    }
  }
  const std::filesystem::path folder = writer_.file().parent_path();
  std::error_code error;
  const auto space = std::filesystem::space(folder.empty() ? std::filesystem::path(".") : folder, error);
  if (!error && space.available < kMinSpace) flags_.recording = false;
}

void Recorder::record() noexcept {
  const realtime::SignalStack stack;
  if (in_real_time_) static_cast<void>(realtime::prepare_thread(kPriority));
  ready_ = true;
  ready_.notify_one();
  using Clock = std::chrono::steady_clock;
  auto next_block = Clock::now() + kBlockTime, next_look = Clock::now();
  while (!over_) {
    bool more = false;
    try {
      more = drain();
      if (more || Clock::now() >= next_block) {
        write_pending();
        next_block = Clock::now() + kBlockTime;
      }
      if (Clock::now() >= next_look) {
        next_look = Clock::now() + 1s;
        look_after_file();
      }
    } catch (const std::exception& error) {
      failed(error.what());
      more = false;
    }
    if (!more) std::this_thread::sleep_for(5ms);
  }
  try {
    write_rest();
  } catch (const std::exception& error) {
    failed(error.what());
  }
}

void Recorder::keep_syncing() noexcept {
  const realtime::SignalStack stack;
  while (true) {
    const int asked = disk_.wait();
    if ((asked & kSync) != 0 && !writer_.reaches_disk()) flags_.recording = false;
    if ((asked & kEnd) != 0) return;
  }
}

Result<journal::Ending> Recorder::finish(journal::Ending ending) {
  stop_threads();
  write_rest();
  look_after_file();
  write_pending();  // what failed under the old name
  ending.dropped = ticks_.dropped() + pending_.size() + given_up_;
  for (const std::string& remark : {viewer_.finish(), remark_}) {
    if (!remark.empty()) ending.detail += (ending.detail.empty() ? "" : "; ") + remark;
  }
  const auto ended = writer_.end(ending);
  if (misplaced_) return tl::unexpected(*misplaced_);
  if (!pending_.empty() && failure_) {
    Error error = *failure_;
    error.message = fmt::format("{} ticks were not written: {}", pending_.size(), error.message);
    return tl::unexpected(error);
  }
  if (!ended) return tl::unexpected(ended.error());
  return ending;
}

}  // namespace mbk::session
