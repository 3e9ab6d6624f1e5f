#include "mbk/base/core/requester.h"

#include <utility>

namespace mbk {
namespace {

thread_local Requester* current_requester = nullptr;

}  // namespace

Requester* Requester::current() noexcept {
  return current_requester;
}

Requester::Scope::Scope(Requester* requester) noexcept : before_(std::exchange(current_requester, requester)) {}

Requester::Scope::~Scope() {
  current_requester = before_;
}

}  // namespace mbk
