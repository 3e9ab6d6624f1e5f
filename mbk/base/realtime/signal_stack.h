#pragma once

#include <csignal>
#include <cstddef>
#include <memory>

namespace mbk::realtime {

/// A stack for the signal handlers of the calling thread, as long as it lives: where the thread's own has overflowed,
/// a handler that was installed with SA_ONSTACK still runs. Where it is refused, the thread is as it was before.
class SignalStack {
 public:
  SignalStack();
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;
  ~SignalStack();

 private:
  std::unique_ptr<std::byte[]> bytes_;
  stack_t before_{};
  bool ours_ = false;
};

}  // namespace mbk::realtime
