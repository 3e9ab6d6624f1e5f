#include "apps/mbk/terminal/questions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iostream>
#include <sstream>

#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/trimmed.h"
#include "mbk/base/system/terminal.h"

namespace mbk::app {

Result<std::string> Questions::ask(const std::string& question, const std::string& by_default,
                                   const CheckAnswer& check) const {
  if (defaults_) {
    if (by_default.empty()) return bad_usage(fmt::format("'{}' has no default", question), "answer it; omit --yes");
    const std::string wrong = check(by_default);
    if (!wrong.empty()) return bad_usage(fmt::format("{}: {}", question, wrong), "answer it; omit --yes");
    return by_default;
  }
  const bool terminal = system::is_terminal(system::kInput);
  while (true) {
    say("{}{}: ", question, by_default.empty() ? "" : fmt::format(" [{}]", by_default));
    std::string line;
    if (!std::getline(std::cin, line)) {
      say("\n");
      return bad_usage(fmt::format("input ended before '{}' was answered", question),
                       "pass --yes to accept the defaults");
    }
    if (!terminal) say("{}\n", line);
    std::string answer(trimmed(line, " \t\r"));
    if (answer.empty()) answer = by_default;
    const std::string wrong = answer.empty() ? "an answer is needed" : check(answer);
    if (wrong.empty()) return answer;
    if (!terminal) return bad_usage(fmt::format("{}: {}", question, wrong), "correct this answer");
    say("  {}\n", wrong);
  }
}

CheckAnswer word_of_these(std::vector<std::string> words) {
  return [words = std::move(words)](const std::string& given) {
    return std::ranges::find(words, given) != words.end()
               ? ""
               : fmt::format("{} is not one of {}", quoted(given), fmt::join(words, ", "));
  };
}

CheckAnswer positive_number() {
  return positive().wrong;
}

CheckAnswer numbers_with_commas(std::size_t count) {
  return [count](const std::string& given) -> std::string {
    std::istringstream stream(given);
    std::size_t numbers = 0;
    const CheckAnswer number = number_within(1e6).wrong;
    for (std::string one; std::getline(stream, one, ',');) {
      std::string word(trimmed(one));
      if (const std::string wrong = number(word); !wrong.empty()) return wrong;
      ++numbers;
    }
    return numbers == count && !given.ends_with(',')
               ? ""
               : fmt::format("{} is not a list of {} numbers separated by commas", quoted(given), count);
  };
}

}  // namespace mbk::app
