#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::recording {
class InMemory;
}

namespace mbk::app {

/// An option as it would be typed: its long name without the dashes, and its values. A flag has none.
struct CallOption {
  std::string name;
  std::vector<std::string> values;

  bool operator==(const CallOption&) const = default;
};

/// A command of the program, to be run in this process: nothing is printed, and what it reads may be in memory.
struct Call {
  std::string command;  ///< "measure", "robot identify"
  std::vector<CallOption> options;
  std::vector<std::string> words;  ///< what would be typed beside the options: names of files, STUDY, …
  std::vector<std::shared_ptr<const recording::InMemory>> recordings;  ///< stand where `words` or a value name them
                                                                       ///< (`recording_word`); those that none names
                                                                       ///< come before the words
  std::vector<std::string> documents;  ///< results as JSON, in the same way (`document_word`)
  std::function<bool()> stop = {};     ///< asked often, from several threads: whether the answer is no longer wanted
  std::function<void(std::string_view what, double fraction)> progress = {};  ///< from 0 to 1, from any thread, one at
                                                                              ///< a time
};

/// The word that stands for the k-th (from 0) recording or document of a call where a file would be named.
[[nodiscard]] std::string recording_word(std::size_t k);
[[nodiscard]] std::string document_word(std::size_t k);

/// What a command found.
struct Answer {
  std::string text;   ///< what it would have printed: the document of --json, or text for people
  bool json = false;  ///< which of both
  int exit_code = 0;
  std::vector<Error> errors;          ///< what could not be read or measured beside what could
  std::vector<std::string> messages;  ///< what it would have said on standard error
};

/// Runs a command. Options, defaults, checks and messages are those of the command line; where the command has --json,
/// that is what it answers unless the flag is among the options with the value "false". From any thread.
/// @fails  usage: there is no such command, or none that can be called; options that it does not take. Where the
///         command gives no answer: why.
/// @throws  Stopped where `stop` said so
[[nodiscard]] Result<Answer> call(const Call& call);

/// Code and text of every warning in the document of an answer. The text is "message; advice".
[[nodiscard]] std::vector<std::pair<std::string, std::string>> warnings_of(const Answer& answer);

/// Every recording of the files that `words` name, with the options of reading alone. `command` says nothing.
/// @fails   usage: options that reading does not take; as recording::read
/// @throws  Stopped where `stop` said so
[[nodiscard]] Result<std::vector<std::shared_ptr<const recording::InMemory>>> read(const Call& call);

/// Whether a command ("robot identify") runs in a process that calls it.
[[nodiscard]] bool can_be_called(std::string_view command);

/// Every command with its options: the document of `mbk manual --json`, to the last byte.
[[nodiscard]] std::string describe_commands();

}  // namespace mbk::app
