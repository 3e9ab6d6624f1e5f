#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/core/words.h"

/// The options of a stage as a table: one row gives the command line, its help, the analysis key of a study and the
/// names in Python and MATLAB.
namespace mbk {

/// The given values, by the name of the option ("--cutoff"); a flag has none.
using OptionTexts = std::map<std::string, std::vector<std::string>>;

/// The description of an option.
struct OptionFacts {
  std::string name;           ///< "--cutoff"
  std::string value;          ///< placeholder, often the unit: "HZ", "S"; "": a flag. An enumeration fills it in itself
  std::string help;           ///< with the default in brackets
  OptionCheck check = {};     ///< which values it may have. An enumeration fills it in itself
  std::string needs = {};     ///< another option that it needs
  std::string group = {};     ///< heading in --help; "": before all headings
  std::string excludes = {};  ///< another option that excludes it
  bool names_file = false;    ///< its value is a file: a result depends on the contents, not on the name
  bool takes_several = false;  ///< values separated by commas
  bool repeats = false;        ///< may be given several times
};

namespace option_values {

template <class Type>
inline constexpr bool kIsOptional = false;
template <class Type>
inline constexpr bool kIsOptional<std::optional<Type>> = true;
template <class Type>
inline constexpr bool kIsSet = false;
template <class Type>
inline constexpr bool kIsSet<std::set<Type>> = true;

inline constexpr std::string_view kAuto = "auto";  ///< the word for "no choice", for options that offer it

/// The enumeration of a value or of a set of values; void if there is none.
template <class Value>
struct ChoiceOf {
  using Type = std::conditional_t<std::is_enum_v<Value>, Value, void>;
};
template <class Value>
struct ChoiceOf<std::optional<Value>> : ChoiceOf<Value> {};
template <class Value>
struct ChoiceOf<std::set<Value>> : ChoiceOf<Value> {};

/// Sets `value` from a text that passed its check.   @param scale  of a number: text = scale · value
template <class Value>
void set(Value& value, const std::string& text, double scale) {
  if constexpr (kIsOptional<Value>) {
    value.reset();
    if (text != kAuto || !HasWords<typename Value::value_type>) set(value.emplace(), text, scale);
  } else if constexpr (std::is_same_v<Value, bool>) {
    value = true;
  } else if constexpr (HasWords<Value>) {
    value = value_of<Value>(text).value_or(value);
  } else if constexpr (std::is_same_v<Value, Hertz>) {
    set(value.value, text, scale);
  } else if constexpr (std::is_arithmetic_v<Value>) {
    const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
    std::from_chars(begin, text.data() + text.size(), value);
    if constexpr (std::is_floating_point_v<Value>) value /= scale;
  } else {
    value = text;
  }
}

template <class Value>
void set(Value& value, const std::vector<std::string>& texts, double scale) {
  if constexpr (kIsSet<Value>) {
    for (const std::string& text : texts) value.insert(*value_of<typename Value::value_type>(text));
  } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
    value.insert(value.end(), texts.begin(), texts.end());
  } else {
    set(value, texts.empty() ? std::string() : texts.back(), scale);
  }
}

}  // namespace option_values

/// A number in its shortest form: 5 for 5.0 and 05. Other texts are unchanged.
[[nodiscard]] std::string canonical_text(const std::string& value);

template <class Options>
class OptionTable {
 public:
  struct Row {
    OptionFacts facts;
    std::function<void(Options&, const std::vector<std::string>&)> set;  ///< receives texts that passed the check
    std::function<bool(const Options&)> is_default;
  };

  /// Heading of --help for the rows that follow.
  OptionTable& group(std::string heading) {
    group_ = std::move(heading);
    return *this;
  }

  /// @param access  to the value: a pointer to a member, or a function from Options to a reference
  /// @param scale   of a number: typed number = scale · value, as kMilliseconds
  template <class Access>
  OptionTable& add(OptionFacts facts, Access access, double scale = 1.0) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Access, Options&>>;
    if constexpr (HasWords<typename option_values::ChoiceOf<Value>::Type>) {
      using Enum = typename option_values::ChoiceOf<Value>::Type;
      std::vector<std::string> words(kWordList<Enum>.begin(), kWordList<Enum>.end());
      if (facts.value == option_values::kAuto) words.insert(words.begin(), std::string(option_values::kAuto));
      if (facts.value.empty() || facts.value == option_values::kAuto)
        facts.value = fmt::format("{}", fmt::join(words, "|"));
      facts.check = one_of(words);
    }
    return add_row({std::move(facts),
                    [=](Options& options, const std::vector<std::string>& texts) {
                      option_values::set(std::invoke(access, options), texts, scale);
                    },
                    [=](const Options& options) {
                      const Options usual{};
                      return std::invoke(access, options) == std::invoke(access, usual);
                    }});
  }

  /// A choice of two words, stored as a bool.
  template <class Access>
  OptionTable& add_either(OptionFacts facts, const std::string& word_of_false, const std::string& word_of_true,
                          Access access) {
    facts.value = word_of_false + "|" + word_of_true;
    facts.check = one_of({word_of_false, word_of_true});
    return add_row({std::move(facts),
                    [=](Options& options, const std::vector<std::string>& texts) {
                      std::invoke(access, options) = texts.back() == word_of_true;
                    },
                    [=](const Options& options) { return !std::invoke(access, options); }});
  }

  /// For a value that is not a single member.
  OptionTable& add_row(Row row) {
    if (row.facts.group.empty()) row.facts.group = group_;
    rows_.push_back(std::move(row));
    return *this;
  }

  /// Replaces the check of the previous row.
  OptionTable& check(std::function<std::string(const std::string& given)> wrong) {
    rows_.back().facts.check.wrong = std::move(wrong);
    return *this;
  }

  /// Replaces the test of the previous row for whether its value means the same as its absence.
  OptionTable& is_default_where(std::function<bool(const Options&)> is_default) {
    rows_.back().is_default = std::move(is_default);
    return *this;
  }

  /// The rows of a part of these options.
  template <class Part, class Access>
  OptionTable& include(const OptionTable<Part>& part, Access access) {
    for (const auto& row : part.rows()) {
      rows_.push_back({row.facts,
                       [set = row.set, access](Options& options, const std::vector<std::string>& texts) {
                         set(std::invoke(access, options), texts);
                       },
                       [is_default = row.is_default, access](const Options& options) {
                         return is_default(std::invoke(access, options));
                       }});
    }
    return *this;
  }

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

  [[nodiscard]] const Row* find(const std::string& name) const {
    const auto found = std::ranges::find_if(rows_, [&](const Row& row) { return row.facts.name == name; });
    return found == rows_.end() ? nullptr : &*found;
  }

  /// Options from texts.
  /// @fails  usage: an unknown option; a wrong value; an option that it needs is missing.
  [[nodiscard]] Result<Options> read(const OptionTexts& given) const {
    for (const auto& [name, texts] : given) {
      const Row* const row = find(name);
      if (row == nullptr) return bad_usage(fmt::format("'{}' is not an option of measuring", name));
      for (const std::string& text : texts) {
        const std::string wrong = row->facts.check.wrong ? row->facts.check.wrong(text) : "";
        if (!wrong.empty()) return bad_usage(fmt::format("{}: {}", name, wrong));
      }
      if (!row->facts.needs.empty() && !given.contains(row->facts.needs)) {
        return bad_usage(fmt::format("{} is valid only with {}", name, row->facts.needs));
      }
      if (!row->facts.excludes.empty() && given.contains(row->facts.excludes)) {
        return bad_usage(fmt::format("{} and {} cannot be given together", name, row->facts.excludes));
      }
    }
    Options options{};
    for (const auto& [name, texts] : given) find(name)->set(options, texts);
    return options;
  }

  /// The given options without defaults, numbers in canonical form: equal for equal options.
  [[nodiscard]] OptionTexts without_defaults(OptionTexts given, const Options& options) const {
    for (auto at = given.begin(); at != given.end();) {
      const Row* const row = find(at->first);
      if (row == nullptr || row->is_default(options)) {
        at = given.erase(at);
        continue;
      }
      if (!row->facts.names_file) std::ranges::transform(at->second, at->second.begin(), canonical_text);
      ++at;
    }
    return given;
  }

 private:
  std::string group_;
  std::vector<Row> rows_;
};

/// "--cutoff 5 --mode reference"; "" if none is given.
[[nodiscard]] std::string typed_text(const OptionTexts& given);

}  // namespace mbk
