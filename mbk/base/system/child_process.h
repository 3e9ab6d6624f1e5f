#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::system {

/// What a process is told.
enum class Signal { interrupt, terminate, kill };

/// A program that runs beside this one; it is killed where it still runs when this goes, and asked to end (SIGTERM)
/// where the thread that started it ends, whatever ends it.
class ChildProcess {
 public:
  /// @param command  the program, in the folders of PATH where it names none, and its arguments
  /// @param output  file that gets its standard output and standard error; it reads nothing
  /// @fails  data: it cannot be begun.
  [[nodiscard]] static Result<ChildProcess> start(const std::vector<std::string>& command,
                                                  const std::filesystem::path& output);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();

  void send(Signal signal) const;
  [[nodiscard]] int id() const { return id_; }

  /// Until it ends, at most so long [s].
  /// @returns  its exit code; 128 and the signal's number where one ended it; absent where it still runs
  [[nodiscard]] std::optional<int> wait(double longest);

 private:
  explicit ChildProcess(int id) : id_(id) {}
  int id_;
  std::optional<int> ended_;
};

}  // namespace mbk::system
