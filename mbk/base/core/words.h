#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string_view>
#include <type_traits>

namespace mbk {

/// A value of an enumeration and the one word for it, in options, files, JSON and text alike.
template <class Enum>
struct Word {
  Enum value;
  std::string_view word;
};

/// An enumeration that has words: its namespace contains their table, in the order in which an option or a message
/// lists them.
///   [[nodiscard]] constexpr auto word_table(Verdict) {
///     using enum Verdict;
///     return std::to_array<Word<Verdict>>({{passive, "passive"}, {active, "active"}, {undecided, "undecided"}});
///   }
/// The compiler checks that each value has one word, and each word one value.
template <class Enum>
concept HasWords = std::is_enum_v<Enum> && requires(Enum value) {
  word_table(value);
};

namespace word_checks {

/// Whether an enumerator has that value; the compilers write `passive` for one, `(mbk::Verdict)7` for a bare number.
template <auto kValue>
[[nodiscard]] consteval bool is_enumerator() {
  const std::string_view name = __PRETTY_FUNCTION__;
  return name.rfind(':') > name.rfind(')');
}

/// Whether the table has each of 0, 1 … n − 1 once, and no enumerator follows.
template <HasWords Enum>
[[nodiscard]] consteval bool each_value_once() {
  constexpr auto kTable = word_table(Enum{});
  std::array<bool, kTable.size()> seen{};
  for (const auto& [value, word] : kTable) {
    const auto index = static_cast<std::size_t>(value);
    if (index >= kTable.size() || seen[index]) return false;
    seen[index] = true;
  }
  return !is_enumerator<static_cast<Enum>(kTable.size())>();
}

template <HasWords Enum>
[[nodiscard]] consteval bool each_word_once() {
  constexpr auto kTable = word_table(Enum{});
  for (std::size_t i = 0; i < kTable.size(); ++i) {
    for (std::size_t k = i + 1; k < kTable.size(); ++k) {
      if (kTable[i].word == kTable[k].word) return false;
    }
  }
  return true;
}

}  // namespace word_checks

/// The table of an enumeration.
template <HasWords Enum>
inline constexpr auto kWords = [] {
  static_assert(word_checks::each_value_once<Enum>(), "a value has no word, or two");
  static_assert(word_checks::each_word_once<Enum>(), "two values have the same word");
  return word_table(Enum{});
}();

/// Former words, which are still read: the namespace may contain a table of them too.
///   [[nodiscard]] constexpr auto former_word_table(WarningCode) {
///     return std::to_array<Word<WarningCode>>({{WarningCode::held_out_fit_poor, "held-back-fit-poor"}});
///   }
template <class Enum>
concept HasFormerWords = HasWords<Enum> && requires(Enum value) {
  former_word_table(value);
};

/// The word of a value; "unknown" for a number outside the enumeration, as in a file of a newer version.
template <HasWords Enum>
[[nodiscard]] constexpr std::string_view word_of(Enum value) {
  for (const auto& [known, word] : kWords<Enum>) {
    if (known == value) return word;
  }
  return "unknown";
}

/// The value of a word or of a former word, if there is one.
template <HasWords Enum>
[[nodiscard]] constexpr std::optional<Enum> value_of(std::string_view given) {
  for (const auto& [value, word] : kWords<Enum>) {
    if (word == given) return value;
  }
  if constexpr (HasFormerWords<Enum>) {
    for (const auto& [value, word] : former_word_table(Enum{})) {
      if (word == given) return value;
    }
  }
  return std::nullopt;
}

/// The former word of a value; empty if it has not changed.
template <HasFormerWords Enum>
[[nodiscard]] constexpr std::string_view former_word_of(Enum value) {
  for (const auto& [known, word] : former_word_table(Enum{})) {
    if (known == value) return word;
  }
  return "";
}

/// Every word, in the order of the table.
template <HasWords Enum>
inline constexpr auto kWordList = [] {
  std::array<std::string_view, kWords<Enum>.size()> words;
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = kWords<Enum>[i].word;
  return words;
}();

}  // namespace mbk
