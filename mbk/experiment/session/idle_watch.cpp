#include "mbk/experiment/session/idle_watch.h"

#include <chrono>
#include <optional>

#include "mbk/base/realtime/signal_stack.h"

namespace mbk::session {
namespace {

constexpr auto kLook = std::chrono::milliseconds(20);

}  // namespace

IdleWatch::IdleWatch(device::Device& robot, std::function<void(const IdleState&)> seen)
    : robot_(robot), seen_(std::move(seen)), thread_([this] { watch(); }) {}

IdleWatch::~IdleWatch() {
  {
    const std::scoped_lock lock(mutex_);
    over_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void IdleWatch::watch() noexcept {
  const realtime::SignalStack stack;
  using Clock = std::chrono::steady_clock;
  device::State state;
  robot_.read(state);
  const std::uint64_t answered_before = state.answered;
  std::uint64_t last = state.sequence;
  auto fresh_at = Clock::now();
  std::optional<IdleState> told;
  for (std::uint64_t number = 0;; ++number) {
    const bool writes = robot_.write({number, {0.0, 0.0}, false});
    {
      std::unique_lock lock(mutex_);
      if (wake_.wait_for(lock, kLook, [&] { return over_; })) return;
    }
    const bool reads = robot_.read(state);
    const auto now = Clock::now();
    if (state.sequence != last) fresh_at = now;
    last = state.sequence;
    IdleState seen;
    seen.link = reads && writes && now - fresh_at < std::chrono::duration<double>(IdleState::kSilence);
    seen.stop_button = state.stop;
    seen.motors = state.motors;
    seen.confirmed_off = seen.link && state.motors == device::Motors::off && state.answered > answered_before;
    seen.fault = state.fault;
    if (told == seen) continue;
    told = seen;
    try {
      seen_(seen);
    } catch (...) {  // who listens may fail; the robot is still told "off"
    }
  }
}

}  // namespace mbk::session
