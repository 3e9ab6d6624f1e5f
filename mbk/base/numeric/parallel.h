#pragma once

#include <functional>

#include "mbk/base/core/result.h"

namespace mbk::numeric {

/// Calls work(i) once for each i = 0, …, count − 1, on up to `threads` threads (0: number of cores; fewer
/// where the system has no more), and `done(i)` after each, never two at a time. What the calls write must be apart for
/// each i; then nothing depends on the number of threads or their order.
/// The threads work for whom the caller works for.
/// @fails  where a call fails: with the error of the smallest such i that was reached; no new ones are begun after it.
/// @throws  Stopped before the next turn where that one no longer wants it; what a call threw.
[[nodiscard]] Result<void> parallel_for(int count, unsigned threads, const std::function<Result<void>(int)>& work,
                                        const std::function<void(int)>& done = {});

}  // namespace mbk::numeric
