#pragma once

namespace mbk::testing_support {

/// How often this program has called operator new so far, on any thread: equal before and after a call that does not
/// allocate. A test that relies on it should also see it count.
[[nodiscard]] long allocations();

}  // namespace mbk::testing_support
