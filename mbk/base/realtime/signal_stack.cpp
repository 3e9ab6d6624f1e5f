#include "mbk/base/realtime/signal_stack.h"

namespace mbk::realtime {
namespace {

constexpr std::size_t kBytes = std::size_t{64} << 10U;  // the registers of the widest processors take some 12 kB

}  // namespace

SignalStack::SignalStack() : bytes_(std::make_unique<std::byte[]>(kBytes)) {
  stack_t stack{};
  stack.ss_sp = bytes_.get();
  stack.ss_size = kBytes;
  ours_ = sigaltstack(&stack, &before_) == 0;
}

SignalStack::~SignalStack() {
  if (ours_) sigaltstack(&before_, nullptr);
}

}  // namespace mbk::realtime
