#pragma once

#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"

namespace mbk::console {

/// What a page may ask for.
enum class Action {
  stop,    ///< safety stop
  end,     ///< end the perturbation early, and go back
  start,   ///< begin the trial that waits
  repeat,  ///< the trial that is over once more
  next,    ///< on to the next trial; behind the last one: done
  abort,   ///< no further trial
  reset,   ///< of the gate after a stop: first without a code, then with the one that the state gave
  note,    ///< a remark for the recording
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
  });
}

inline constexpr std::size_t kLongestNote = 2000;  ///< [bytes]

/// One message of a page.
struct Command {
  Action action = Action::stop;
  std::string text;  ///< of a note; the code of a reset, empty at its first step
};

/// {"command": "stop"}, {"command": "note", "text": "…"}, {"command": "reset", "code": "…"}: these keys and no others.
/// @fails  usage: no JSON object; a key that is there twice, so that two readers could take the message for two
///         commands; a list or an object in it; a key or command that is not known; a text that is missing, empty, too
///         long or out of place.
[[nodiscard]] Result<Command> parse_command(std::string_view json);

}  // namespace mbk::console
