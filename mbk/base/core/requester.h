#pragma once

#include <filesystem>
#include <string>

namespace mbk {

/// Thrown when the requester cancels the work. This is not a failure of the work, so not an Error: it propagates to the
/// requester as std::bad_alloc does.
struct Stopped {};

/// The requester of a thread's work, which may cancel it: a notebook whose user pressed Ctrl-C. Threads of the program
/// itself have none. `numeric::parallel_for` passes it on to its threads.
class Requester {
 public:
  Requester() = default;
  Requester(const Requester&) = delete;
  Requester& operator=(const Requester&) = delete;
  virtual ~Requester() = default;

  /// Whether the work is cancelled. Called often and from several threads at once.
  [[nodiscard]] virtual bool stopped() = 0;

  /// The text that `word` refers to instead of a file; nullptr: it is a file name.
  [[nodiscard]] virtual const std::string* document(const std::filesystem::path& /*word*/) const { return nullptr; }

  /// The requester of this thread; nullptr: none.
  [[nodiscard]] static Requester* current() noexcept;

  /// During its lifetime this thread works for `requester`.
  class Scope {
   public:
    explicit Scope(Requester* requester) noexcept;
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope();

   private:
    Requester* before_;
  };
};

/// To be called between two steps of long work.   @throws  Stopped if the work is cancelled
inline void stop_if_cancelled() {
  if (Requester* const requester = Requester::current(); requester != nullptr && requester->stopped()) throw Stopped();
}

}  // namespace mbk
