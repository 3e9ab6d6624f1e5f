#include "mbk/experiment/session/idle_watch.h"

#include <chrono>
#include <optional>

#include "mbk/base/realtime/clock.h"
#include "mbk/base/realtime/rest.h"
#include "mbk/base/realtime/signal_stack.h"

namespace mbk::session {
namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds(20);

}  // namespace

IdleWatch::IdleWatch(device::Device& robot, std::function<void(const IdleState&)> seen)
    : robot_(robot), seen_(std::move(seen)), thread_([this] { watch(); }) {}

IdleWatch::~IdleWatch() {
  over_ = true;
  thread_.join();
}

void IdleWatch::watch() noexcept {
  const realtime::SignalStack stack;
  device::State state;
  robot_.read(state);
  const std::uint64_t answered_before = state.answered;
  std::uint64_t last = state.sequence;
  std::int64_t fresh_at = realtime::monotonic_ns();
  std::optional<IdleState> told;
  for (std::uint64_t number = 0;; ++number) {
    const bool writes = robot_.write({number, {0.0, 0.0}, false});
    if (realtime::rest(kBetweenLooks, [this] { return over_.load(); })) return;
    const bool reads = robot_.read(state);
    const std::int64_t now = realtime::monotonic_ns();
    if (state.sequence != last) fresh_at = now;
    last = state.sequence;
    IdleState seen;
    seen.link = reads && writes && 1e-9 * static_cast<double>(now - fresh_at) < IdleState::kSilence;
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
