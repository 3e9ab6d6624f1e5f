#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"

namespace mbk::console {

/// What a page may ask for.
enum class Action {
  stop,     ///< safety stop
  end,      ///< end the perturbation early, and go back
  start,    ///< begin the trial that waits
  repeat,   ///< the trial that is over once more
  next,     ///< on to the next trial; behind the last one: done
  abort,    ///< no further trial
  reset,    ///< of the gate after a stop: first without a code, then with the one that the state gave
  note,     ///< a remark for the recording
  control,  ///< this page controls from now on, in place of another one
  exclude,  ///< a trial that was performed, or a window of it, is not to be used, and why
  include,  ///< nothing of it is excluded any more
};

[[nodiscard]] constexpr auto word_table(Action) {
  using enum Action;
  return std::to_array<Word<Action>>({
      {stop, "stop"},
      {end, "end"},
      {start, "start"},
      {repeat, "repeat"},
      {next, "next"},
      {abort, "abort"},
      {reset, "reset"},
      {note, "note"},
      {control, "control"},
      {exclude, "exclude"},
      {include, "include"},
  });
}

inline constexpr std::size_t kLongestNote = 2000;  ///< [bytes]

/// A part of a trial, on its clock [s].
struct Window {
  double from = 0.0, to = 0.0;
};

/// One message of a page.
struct Command {
  Action action = Action::stop;
  std::string text;              ///< of a note; why something is excluded; the code of a reset, empty at its first step
  int attempt = 0;               ///< of what is excluded or included: its number in the session, from 1
  std::optional<Window> window;  ///< that is excluded; absent: the whole trial
};

/// {"command": "stop"}, {"command": "note", "text": "…"}, {"command": "reset", "code": "…"}, {"command": "exclude",
/// "attempt": 3, "text": "…", "from_s": 1.5, "to_s": 4}, {"command": "include", "attempt": 3}: these keys and no
/// others.
/// @fails  usage: no JSON object; a key that is there twice, so that two readers could take the message for two
///         commands; a list or an object in it; a key or command that is not known; a text that is missing, empty, too
///         long or out of place; an attempt that is no number from 1 on; a window that has one end, or does not go
///         forward from 0 on.
[[nodiscard]] Result<Command> parse_command(std::string_view json);

}  // namespace mbk::console
