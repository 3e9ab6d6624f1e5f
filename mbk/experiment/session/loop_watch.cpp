#include "mbk/experiment/session/loop_watch.h"

#include <chrono>
#include <utility>

#include "mbk/base/realtime/rest.h"
#include "mbk/base/realtime/signal_stack.h"

namespace mbk::session {
namespace {

constexpr std::chrono::milliseconds kLook(20);
constexpr int kSilent = 5, kGivenUp = 50;  // looks without a tick

double seconds(int looks) {
  return std::chrono::duration<double>(looks * kLook).count();
}

}  // namespace

LoopWatch::LoopWatch(LoopFlags& flags, bool by_itself, Told told)
    : flags_(flags), by_itself_(by_itself), told_(std::move(told)), thread_([this] { watch(); }) {}

LoopWatch::~LoopWatch() {
  over_ = true;
  thread_.join();
}

void LoopWatch::watch() noexcept {
  const realtime::SignalStack stack;
  std::uint64_t last = 0;  // beats
  int looks = 0;           // since the last tick
  while (!realtime::rest(kLook, [&] { return over_.load(); })) {
    std::uint64_t beats = flags_.beats.load(std::memory_order_acquire);
    if (beats == 0) continue;  // it has not begun
    if (beats != last) {
      if (flags_.silent.exchange(false)) told_.again(seconds(looks));
      last = beats;
      looks = 0;
      continue;
    }
    ++looks;
    if (looks == kSilent) {
      flags_.silent = true;
      told_.silent(seconds(looks));
    }
    const bool asked = flags_.operator_stop || flags_.end_session;
    if (looks < kSilent || !(asked || (by_itself_ && looks >= kGivenUp))) continue;
    if (!flags_.beats.compare_exchange_strong(beats, LoopFlags::kGivenUp)) continue;
    told_.given_up(seconds(looks));
    return;
  }
}

}  // namespace mbk::session
