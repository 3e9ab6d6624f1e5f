#include "mbk/experiment/session/viewer.h"

#include <fmt/format.h>

#include <array>
#include <exception>
#include <utility>

#include "mbk/base/realtime/signal_stack.h"

namespace mbk::session {
namespace {

using journal::Tick;

constexpr std::size_t kAtATime = 256;  // ticks
constexpr int kShow = 1, kStop = 2;    // asked of the thread

}  // namespace

Viewer::Viewer(Watch watch, std::size_t room, Pace pace)
    : watch_(std::move(watch)), ring_(pace == Pace::skips ? room : 1) {
  if (watch_ && pace == Pace::skips) thread_ = std::thread([this] { hand_on(); });
}

Viewer::~Viewer() {
  stop();
}

void Viewer::show(std::span<const Tick> ticks) noexcept {
  if (ticks.empty()) return;
  if (!thread_.joinable()) {
    call(ticks);
    return;
  }
  for (const Tick& tick : ticks) ring_.push(tick);
  wake_up_.ask(kShow);
}

void Viewer::call(std::span<const Tick> ticks) noexcept {
  if (!watch_) return;
  try {
    try {
      watch_(ticks);
    } catch (const std::exception& error) {
      watch_ = nullptr;
      failure_ = fmt::format("the display failed at tick {}: {}", ticks.front().number, error.what());
    }
  } catch (...) {  // of another kind, or no memory to say so
    watch_ = nullptr;
  }
}

void Viewer::hand_on() noexcept {
  const realtime::SignalStack stack;
  std::array<Tick, kAtATime> ticks;
  while (true) {
    const int asked = wake_up_.wait();
    while (const std::size_t count = ring_.pop(ticks.data(), ticks.size())) call(std::span(ticks).first(count));
    if ((asked & kStop) != 0) return;
  }
}

void Viewer::stop() noexcept {
  if (!thread_.joinable()) return;
  wake_up_.ask(kStop);
  thread_.join();
}

std::string Viewer::finish() {
  stop();
  if (failure_.empty() && ring_.dropped() > 0) {
    return fmt::format("{} ticks were not shown because the display did not keep up", ring_.dropped());
  }
  return std::move(failure_);
}

}  // namespace mbk::session
