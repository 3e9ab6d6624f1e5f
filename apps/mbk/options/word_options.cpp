#include "apps/mbk/options/word_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mbk/base/core/option_checks.h"

namespace mbk::app {

Option add_word_option(Command command, const std::string& name, std::span<const std::string_view> words,
                       std::function<void(std::string_view)> take, const std::string& help) {
  const auto given = [take = std::move(take)](const std::string& word) { take(word); };
  return command.add_option_function(name, given, help)
      .type_name(fmt::format("{}", fmt::join(words, "|")))
      .check(one_of({words.begin(), words.end()}));
}

}  // namespace mbk::app
