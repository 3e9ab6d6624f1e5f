#include "apps/mbk/terminal/messages.h"

#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <mutex>
#include <span>
#include <system_error>
#include <thread>

#include "apps/mbk/caller.h"
#include "mbk/base/realtime/rest.h"
#include "mbk/base/system/files.h"
#include "mbk/base/system/terminal.h"

namespace mbk::app {
namespace {

constexpr std::size_t kMaxWaiting = 512;
constexpr int kNotRead = -1, kNoMemory = -2;  // beside the numbers of errno

/// Never destroyed: a thread that blocks in its last message outlives main.
struct Messages {
  std::mutex mutex;
  std::condition_variable came;
  std::deque<std::string> waiting;
  bool background = false, writing = false;
  std::uint64_t lost = 0;
  int error = 0;  // of the last one lost

  void lose(std::uint64_t count, int why) noexcept {
    lost += count;
    error = why;
  }
};

Messages& messages() {
  static Messages& all = *new Messages;
  return all;
}

/// @returns  0, or the error
int write_whole(std::string_view text) noexcept {
  while (true) {
    std::size_t wrote = 0;
    const int error = system::write_all(system::kError, std::as_bytes(std::span(text)), &wrote);
    if (error != EAGAIN) return error;
    text.remove_prefix(wrote);  // another process that shares it made it non-blocking
    constexpr std::chrono::milliseconds kPatience(200);
    if (!system::wait_for_room(system::kError, kPatience)) return kNotRead;
  }
}

/// Until the queue is closed and empty.
void write_waiting() {
  Messages& all = messages();
  std::unique_lock lock(all.mutex);
  while (true) {
    all.came.wait(lock, [&] { return !all.waiting.empty() || !all.background; });
    if (all.waiting.empty()) return;
    const std::string text = std::move(all.waiting.front());
    all.waiting.pop_front();
    all.writing = true;
    lock.unlock();
    const int error = write_whole(text);
    lock.lock();
    all.writing = false;
    if (error != 0) all.lose(1, error);
  }
}

std::string reason(int error) {
  if (error == kNotRead) return "the reader of the pipe does not read";
  if (error == kNoMemory) return std::strerror(ENOMEM);
  return std::strerror(error);
}

}  // namespace

void say_text(std::string_view text) noexcept {
  try {
    if (Caller* const caller = Caller::current(); caller != nullptr) {
      caller->say(text);
      return;
    }
    Messages& all = messages();
    {
      const std::scoped_lock lock(all.mutex);
      if (all.background) {
        if (all.waiting.size() < kMaxWaiting) {
          all.waiting.emplace_back(text);
        } else {
          all.lose(1, kNotRead);
        }
        all.came.notify_one();
        return;
      }
    }
    const int error = write_whole(text);
    const std::scoped_lock lock(all.mutex);
    if (error != 0) all.lose(1, error);
  } catch (...) {  // no memory for the queue
    if (write_whole(text) != 0) count_lost_message();
  }
}

void count_lost_message() noexcept {
  try {
    Messages& all = messages();
    const std::scoped_lock lock(all.mutex);
    all.lose(1, kNoMemory);
  } catch (...) {  // the mutex cannot be locked: the message cannot even be counted
  }
}

bool flush_messages(std::chrono::milliseconds longest) noexcept {
  try {
    Messages& all = messages();
    const auto are_written = [&] {
      const std::scoped_lock lock(all.mutex);
      return all.waiting.empty() && !all.writing;
    };
    if (realtime::rest(longest, are_written)) return true;
    const std::scoped_lock lock(all.mutex);
    if (!all.waiting.empty()) all.lose(all.waiting.size(), kNotRead);
    all.waiting.clear();
  } catch (...) {
    count_lost_message();
  }
  return false;
}

LostMessages take_lost_messages() {
  flush_messages();
  Messages& all = messages();
  const std::scoped_lock lock(all.mutex);
  if (all.lost == 0) return {};
  return {std::exchange(all.lost, 0), reason(all.error)};
}

BackgroundMessages::BackgroundMessages() {
  {
    const std::scoped_lock lock(messages().mutex);
    messages().background = true;
  }
  try {
    std::thread(write_waiting).detach();  // it may block in its last message for ever
  } catch (const std::system_error&) {    // no thread available: callers write and wait
    messages().background = false;
  }
}

BackgroundMessages::~BackgroundMessages() {
  if (!flush_messages()) return;  // later messages are lost too, but block no thread
  const std::scoped_lock lock(messages().mutex);
  messages().background = false;
  messages().came.notify_all();
}

}  // namespace mbk::app
