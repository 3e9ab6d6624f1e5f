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

/// An option as it would be typed: its long name without dashes, and its values. A flag has none.
struct CallOption {
  std::string name;
  std::vector<std::string> values;

  bool operator==(const CallOption&) const = default;
};

/// A command of the program, to be run in this process: nothing is printed, and its inputs may be in memory.
struct Call {
  std::string command;  ///< "measure", "robot identify"
  std::vector<CallOption> options;
  std::vector<std::string> words;  ///< arguments that would be typed besides the options: file names, STUDY, …
  std::vector<std::shared_ptr<const recording::InMemory>> recordings;  ///< stand where `words` or a value name them
                                                                       ///< (`recording_word`); those that none names
                                                                       ///< come before the words
  std::vector<std::string> documents;  ///< results as JSON, in the same way (`document_word`)
  std::function<bool()> stop = {};     ///< asked often, from several threads: whether the answer is no longer wanted
  std::function<void(std::string_view what, double fraction)> progress = {};  ///< from 0 to 1, from any thread, one at
                                                                              ///< a time
};

/// The word that refers to the k-th (from 0) recording or document of a call instead of a file name.
[[nodiscard]] std::string recording_word(std::size_t k);
[[nodiscard]] std::string document_word(std::size_t k);

/// The output of a command.
struct Answer {
  std::string text;   ///< its standard output: the document of --json, or text for people
  bool json = false;  ///< whether it is a document
  int exit_code = 0;
  std::vector<Error> errors;          ///< of inputs that could not be read or measured
  std::vector<std::string> messages;  ///< its messages on standard error
};

/// Runs a command. Options, defaults, checks and messages are those of the command line. A command with --json answers
/// with a document unless that flag is given with the value "false". From any thread.
/// @fails  usage: an unknown command, or one that cannot be called; unknown options. The error of the command if it has
///         no output.
/// @throws  Stopped if `stop` returned true
[[nodiscard]] Result<Answer> call(const Call& call);

/// Code and text of every warning in the document of an answer. The text is "message; advice".
[[nodiscard]] std::vector<std::pair<std::string, std::string>> warnings_of(const Answer& answer);

/// Reads every recording of the files that `words` name, with the options for reading. `command` is ignored.
/// @fails   usage: options that are not for reading; as recording::read
/// @throws  Stopped if `stop` returned true
[[nodiscard]] Result<std::vector<std::shared_ptr<const recording::InMemory>>> read(const Call& call);

/// Whether a command ("robot identify") can be called in a process.
[[nodiscard]] bool can_be_called(std::string_view command);

/// Every command with its options: the document of `mbk manual --json`, to the last byte.
[[nodiscard]] std::string describe_commands();

}  // namespace mbk::app
