#include "mbk/base/realtime/signal_stack.h"

// Windows has no handlers of signals that run on a stack of their own.
namespace mbk::realtime {

struct SignalStack::Before {};

SignalStack::SignalStack() = default;
SignalStack::~SignalStack() = default;

}  // namespace mbk::realtime
