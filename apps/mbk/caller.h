#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mbk/call.h"
#include "mbk/base/core/requester.h"
#include "mbk/files/recording/in_memory.h"

namespace mbk::app {

/// The caller of a command within the process: receives its output, and provides inputs in memory.
class Caller : public Requester, public recording::RecordingHolder {
 public:
  /// @param call  outlives this
  explicit Caller(const Call& call) : call_(call) {}

  /// The caller of this thread; nullptr: the command was typed.
  [[nodiscard]] static Caller* current() noexcept;

  [[nodiscard]] bool stopped() override;

  /// In place of standard error.
  void say(std::string_view text);
  /// In place of standard output.
  void write(std::string_view text);
  void fail(const Error& error);
  /// @param fraction  of the work that is done; negative if unknown
  void reached(std::string_view what, double fraction);

  /// The input that a word refers to; nullptr if it is a file name.
  [[nodiscard]] std::shared_ptr<const recording::InMemory> recording(const std::filesystem::path& word) const override;
  [[nodiscard]] const std::string* document(const std::filesystem::path& word) const override;

  /// Moves the output out.   @param wrote  whether there was any output
  [[nodiscard]] Answer take(int exit_code, bool& wrote);

 private:
  const Call& call_;
  std::mutex mutex_;
  std::atomic<bool> stopped_ = false;
  bool wrote_ = false;
  std::string output_;
  std::vector<Error> errors_;
  std::vector<std::string> messages_;
};

}  // namespace mbk::app
