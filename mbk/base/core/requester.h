#pragma once

#include <filesystem>
#include <string>

namespace mbk {

/// Thrown where whoever asked for the work no longer wants it. No failure of the work, so no Error: it passes through
/// everything up to the one who asked, as std::bad_alloc does.
struct Stopped {};

/// Whom a thread is working for, where that one may change their mind: a notebook whose user pressed Ctrl-C. A thread
/// of the program itself works for nobody. `numeric::parallel_for` hands it on to its threads.
class Requester {
 public:
  Requester() = default;
  Requester(const Requester&) = delete;
  Requester& operator=(const Requester&) = delete;
  virtual ~Requester() = default;

  /// Whether the work is no longer wanted. Asked often and from several threads at once.
  [[nodiscard]] virtual bool stopped() = 0;

  /// The text that `word` stands for where a file would be named; nullptr: it is the name of a file.
  [[nodiscard]] virtual const std::string* document(const std::filesystem::path& /*word*/) const { return nullptr; }

  /// That of this thread; nullptr: nobody's.
  [[nodiscard]] static Requester* current() noexcept;

  /// While it lives, this thread works for `requester`.
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

/// Between two steps of long work.   @throws  Stopped where it is no longer wanted
inline void stop_if_cancelled() {
  if (Requester* const requester = Requester::current(); requester != nullptr && requester->stopped()) throw Stopped();
}

}  // namespace mbk
