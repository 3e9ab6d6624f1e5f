#include <csignal>

#include "mbk/base/realtime/signal_stack.h"

namespace mbk::realtime {
namespace {

constexpr std::size_t kBytes = std::size_t{64} << 10U;  // the registers of the widest processors take some 12 kB

}  // namespace

struct SignalStack::Before {
  stack_t stack{};
};

SignalStack::SignalStack() : bytes_(std::make_unique<std::byte[]>(kBytes)), before_(std::make_unique<Before>()) {
  stack_t stack{};
  stack.ss_sp = bytes_.get();
  stack.ss_size = kBytes;
  if (sigaltstack(&stack, &before_->stack) != 0) before_.reset();
}

SignalStack::~SignalStack() {
  if (before_) sigaltstack(&before_->stack, nullptr);
}

}  // namespace mbk::realtime
