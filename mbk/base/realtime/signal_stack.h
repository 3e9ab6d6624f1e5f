#pragma once

#include <cstddef>
#include <memory>

namespace mbk::realtime {

/// A separate stack for the signal handlers of the calling thread, during its lifetime: after a stack overflow a
/// handler that was installed with SA_ONSTACK still runs. If the stack is refused, the thread is unchanged.
class SignalStack {
 public:
  SignalStack();
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;
  ~SignalStack();

 private:
  std::unique_ptr<std::byte[]> bytes_;
  struct Before;
  std::unique_ptr<Before> before_;  ///< where the stack is this one
};

}  // namespace mbk::realtime
