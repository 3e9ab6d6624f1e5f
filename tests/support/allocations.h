#pragma once

namespace mbk::testing_support {

/// How often the calling thread has asked for memory so far, by operator new, malloc or what else there is: equal
/// before and after a call that does not allocate. A test that relies on it should also see it count.
[[nodiscard]] long allocations();

}  // namespace mbk::testing_support
