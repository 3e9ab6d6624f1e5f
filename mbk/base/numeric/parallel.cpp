#include "mbk/base/numeric/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include "mbk/base/core/requester.h"

namespace mbk::numeric {

Result<void> parallel_for(int count, unsigned threads, const std::function<Result<void>(int)>& work,
                          const std::function<void(int)>& done) {
  std::atomic<int> next = 0;
  std::mutex mutex;
  std::optional<std::pair<int, Error>> failure;
  std::exception_ptr thrown;
  const auto take_all_turns = [&] {
    for (int i = next++; i < count; i = next++) {
      stop_if_cancelled();
      const Result<void> outcome = work(i);
      const std::lock_guard lock(mutex);
      if (!outcome) {
        if (!failure || i < failure->first) failure = {i, outcome.error()};
        next = count;
        return;
      }
      if (done) done(i);
    }
  };
  // An exception that left a thread would end the program.
  Requester* const requester = Requester::current();
  const auto take_turns = [&]() noexcept {
    const Requester::Scope same(requester);
    try {
      take_all_turns();
    } catch (...) {
      const std::lock_guard lock(mutex);
      thrown = std::current_exception();
      next = count;
    }
  };
  {
    const unsigned requested = threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::jthread> workers;
    for (unsigned k = 1; k < std::min(requested, static_cast<unsigned>(std::max(count, 0))); ++k) {
      try {
        workers.emplace_back(take_turns);
      } catch (const std::system_error&) {
        break;  // there are no more threads; those that run do what there is to do
      }
    }
    take_turns();
  }
  if (thrown) std::rethrow_exception(thrown);
  if (failure) return tl::unexpected(failure->second);
  return {};
}

}  // namespace mbk::numeric
