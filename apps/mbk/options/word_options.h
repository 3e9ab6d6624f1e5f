#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mbk/terminal/command.h"
#include "mbk/base/core/words.h"

namespace mbk::app {

/// Adds an option whose value is one of `words`, which its help and a shell name.   @param take  gets one of them
Option add_word_option(Command command, const std::string& name, std::span<const std::string_view> words,
                       std::function<void(std::string_view)> take, const std::string& help);

/// Adds an option whose value is one of the words of an enumeration.
template <HasWords Enum>
Option add_choice(Command command, const std::string& name, Enum& target, const std::string& help) {
  return add_word_option(
      command, name, kWordList<Enum>, [&target](std::string_view word) { target = *value_of<Enum>(word); }, help);
}

/// The same with only some of the words.
template <HasWords Enum>
Option add_choice(Command command, const std::string& name, Enum& target, std::initializer_list<Enum> among,
                  const std::string& help) {
  std::vector<std::string_view> words;
  for (const Enum value : among) words.push_back(word_of(value));
  return add_word_option(
      command, name, words, [&target](std::string_view word) { target = *value_of<Enum>(word); }, help);
}

/// The same where the option may be left out.
template <HasWords Enum>
Option add_choice(Command command, const std::string& name, std::optional<Enum>& target, const std::string& help) {
  return add_word_option(
      command, name, kWordList<Enum>, [&target](std::string_view word) { target = value_of<Enum>(word); }, help);
}

/// The same, or "auto" for nothing.
template <HasWords Enum>
Option add_choice_or_auto(Command command, const std::string& name, std::optional<Enum>& target,
                          const std::string& help) {
  std::vector<std::string_view> words = {"auto"};
  words.insert(words.end(), kWordList<Enum>.begin(), kWordList<Enum>.end());
  return add_word_option(
      command, name, words, [&target](std::string_view word) { target = value_of<Enum>(word); }, help);
}

}  // namespace mbk::app
