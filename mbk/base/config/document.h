#pragma once

#include <Eigen/Core>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "mbk/base/config/range.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"

namespace mbk::config {

struct Node;
class Reading;
class Section;
struct Trial;

/// A TOML file. Its sections return checked values and remember the requested keys. A wrong value is replaced by its
/// fallback, and finish() returns the first problem, so that reading code names each key once, in sequence:
///
///   Section s = document.root().section("perturbation");
///   options.amplitude = s.number("amplitude_mm", options.amplitude, above(0));   // m
///   options.directions = s.integer("directions", options.directions, 1, 64);
///   if (auto ok = document.finish(); !ok) return tl::unexpected(ok.error());
///
/// Numbers are returned in SI units: a key ends with its unit (unit_of_key). Ranges and messages use the unit of the
/// key. Copies share their state.
class Document {
 public:
  /// @param file  its name in messages
  /// @fails  data: as parse_toml, with file, line, column.
  [[nodiscard]] static Result<Document> parse(std::string_view text, std::string_view file);
  /// @fails  data: the same; the file cannot be read.
  [[nodiscard]] static Result<Document> read(const std::filesystem::path& file);

  [[nodiscard]] Section root() const;

  /// The experiments that a file describes: one for each [[trial]], whose keys override those of the file, table by
  /// table; an array is replaced as a whole. Without [[trial]] it is this document, with an empty name. The finish() of
  /// a trial checks its own lines. Shared keys are known if any trial requests them, which only finish() of this
  /// document can check; it covers its trials too.
  /// @fails  data: [[trial]] is not an array of tables, or has more than kMaxTrials; a name is missing, used twice or
  ///         contains other characters than letters, digits, _ and - (it becomes part of file names).
  [[nodiscard]] Result<std::vector<Trial>> trials() const;

  /// @fails  data, with file, line and key: the first requested value that has the wrong type, is outside its range,
  ///         is rejected by the reader, or is missing without fallback; otherwise the first unknown key, with the
  ///         nearest known one.
  [[nodiscard]] Result<void> finish() const;

 private:
  explicit Document(std::shared_ptr<Reading> reading) : reading_(std::move(reading)) {}
  std::shared_ptr<Reading> reading_;
};

inline constexpr std::size_t kMaxTrials = 1000;

struct Trial {
  std::string name;
  Document document;
};

/// A table of a document; a missing table returns fallbacks. Fallbacks are in SI units, like the returned values, and
/// need not be in the range.
class Section {
 public:
  /// Words and their values.
  template <class Value>
  using Choices = std::initializer_list<std::pair<std::string_view, std::type_identity_t<Value>>>;

  /// Whether the table is in the file.
  [[nodiscard]] bool given() const;
  /// Whether the key is in the file; the key is known from then on.
  [[nodiscard]] bool has(std::string_view key) const;

  /// A finite number in SI units; integers are numbers.
  [[nodiscard]] double number(std::string_view key, double fallback, Range allowed = any()) const;
  [[nodiscard]] double required_number(std::string_view key, Range allowed = any()) const;
  [[nodiscard]] std::optional<double> optional_number(std::string_view key, Range allowed = any()) const;

  /// A whole number from low to high, never converted.
  template <std::integral Int>
  [[nodiscard]] Int integer(std::string_view key, Int fallback, std::type_identity_t<Int> low,
                            std::type_identity_t<Int> high) const {
    const auto value = find_integer(key, limit(low), limit(high), Need::optional);
    return value ? static_cast<Int>(*value) : fallback;
  }
  template <std::integral Int>
  [[nodiscard]] Int required_integer(std::string_view key, Int low, std::type_identity_t<Int> high) const {
    const auto value = find_integer(key, limit(low), limit(high), Need::required);
    return value ? static_cast<Int>(*value) : low;
  }

  [[nodiscard]] bool flag(std::string_view key, bool fallback) const;

  [[nodiscard]] std::string text(std::string_view key, std::string_view fallback) const;
  [[nodiscard]] std::string required_text(std::string_view key) const;

  /// One of a few words: s.choice("kind", {{"multisine", Kind::multisine}, {"pulses", Kind::pulses}}, Kind::pulses)
  template <class Value>
  [[nodiscard]] Value choice(std::string_view key, Choices<Value> options, Value fallback) const {
    return chosen(key, options, Need::optional).value_or(fallback);
  }
  /// s.required_choice<Kind>("kind", {...}); the first one if it is missing
  template <class Value>
  [[nodiscard]] Value required_choice(std::string_view key, Choices<Value> options) const {
    return chosen(key, options, Need::required).value_or(options.begin()->second);
  }

  /// One of the words of an enumeration: s.choice("phases", Phases::random)
  template <HasWords Enum>
  [[nodiscard]] Enum choice(std::string_view key, Enum fallback) const {
    const auto index = find_word(key, kWordList<Enum>, Need::optional);
    return index ? kWords<Enum>[static_cast<std::size_t>(*index)].value : fallback;
  }
  /// The first one if it is missing.
  template <HasWords Enum>
  [[nodiscard]] Enum required_choice(std::string_view key) const {
    const auto index = find_word(key, kWordList<Enum>, Need::required);
    return kWords<Enum>[index ? static_cast<std::size_t>(*index) : 0].value;
  }

  /// Some of a few words, each at most once: s.choices("axes", {{"x", Axis::x}, {"y", Axis::y}}, {Axis::x})
  template <class Value>
  [[nodiscard]] std::vector<Value> choices(std::string_view key, Choices<Value> options,
                                           std::vector<Value> fallback) const {
    std::vector<std::string_view> words;
    for (const auto& option : options) words.push_back(option.first);
    const auto indices = find_words(key, words);
    if (!indices) return fallback;
    std::vector<Value> values;
    for (const std::ptrdiff_t index : *indices) values.push_back((options.begin() + index)->second);
    return values;
  }

  /// [1.0, 2.0, ...] in SI units; `allowed` applies to each, `count` is their number (kAnyCount: any).
  static constexpr std::size_t kAnyCount = std::numeric_limits<std::size_t>::max();
  [[nodiscard]] std::vector<double> numbers(std::string_view key, std::vector<double> fallback, Range allowed = any(),
                                            std::size_t count = kAnyCount) const;
  [[nodiscard]] Eigen::Vector2d vector2(std::string_view key, const Eigen::Vector2d& fallback,
                                        Range allowed = any()) const;
  [[nodiscard]] Eigen::Vector2d required_vector2(std::string_view key, Range allowed = any()) const;
  /// [[a, b], [c, d]], rows first.
  [[nodiscard]] Eigen::Matrix2d matrix2(std::string_view key, const Eigen::Matrix2d& fallback,
                                        Range allowed = any()) const;
  [[nodiscard]] Eigen::Matrix2d required_matrix2(std::string_view key, Range allowed = any()) const;
  /// The same with three rows of three.
  [[nodiscard]] Eigen::Matrix3d matrix3(std::string_view key, const Eigen::Matrix3d& fallback) const;
  [[nodiscard]] Eigen::Matrix3d required_matrix3(std::string_view key) const;

  [[nodiscard]] Section section(std::string_view key) const;
  /// The table of this name belongs to another reader: its keys are not checked here.
  void leave_to_others(std::string_view key) const;
  /// The tables of [[key]], in the order of the file.
  [[nodiscard]] std::vector<Section> sections(std::string_view key) const;

  /// `former` is the former name of `now` and is still read: from here on it replaces `now` if that is missing.
  void rename(std::string_view former, std::string_view now);

  /// A problem that the reader finds: "above the Nyquist frequency 500 Hz"
  void reject(std::string_view key, std::string message, std::string remedy = "") const;
  /// The same as a value, with file, line and key, for a reader that stops here.
  [[nodiscard]] Error error(std::string_view key, std::string message, std::string remedy = "") const;

 private:
  friend class Document;
  enum class Need { optional, required };

  Section(std::shared_ptr<Reading> reading, std::string path, const Node* over, const Node* base)
      : reading_(std::move(reading)), path_(std::move(path)), over_(over), base_(base) {}

  template <std::integral Int>
  static std::int64_t limit(Int value) {
    constexpr auto kLargest = std::numeric_limits<std::int64_t>::max();
    return std::cmp_greater(value, kLargest) ? kLargest : static_cast<std::int64_t>(value);
  }
  template <class Value>
  std::optional<Value> chosen(std::string_view key, std::initializer_list<std::pair<std::string_view, Value>> options,
                              Need need) const {
    std::vector<std::string_view> words;
    for (const auto& option : options) words.push_back(option.first);
    const auto index = find_word(key, words, need);
    return index ? std::optional<Value>((options.begin() + *index)->second) : std::nullopt;
  }

  [[nodiscard]] const Node* find(std::string_view key, Need need) const;
  [[nodiscard]] std::optional<double> find_number(std::string_view key, Range allowed, Need need) const;
  [[nodiscard]] std::optional<std::int64_t> find_integer(std::string_view key, std::int64_t low, std::int64_t high,
                                                         Need need) const;
  [[nodiscard]] std::optional<std::string> find_text(std::string_view key, Need need) const;
  [[nodiscard]] std::optional<std::ptrdiff_t> find_word(std::string_view key, std::span<const std::string_view> words,
                                                        Need need) const;
  [[nodiscard]] std::optional<std::vector<std::ptrdiff_t>> find_words(std::string_view key,
                                                                      std::span<const std::string_view> words) const;
  [[nodiscard]] std::optional<std::vector<double>> find_numbers(std::string_view key, Range allowed, std::size_t count,
                                                                Need need) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> find_vector2(std::string_view key, Range allowed, Need need) const;
  template <int N>
  [[nodiscard]] std::optional<Eigen::Matrix<double, N, N>> find_matrix(std::string_view key, Range allowed,
                                                                       Need need) const;
  [[nodiscard]] std::optional<double> checked(std::string_view key, const Node& node, Range allowed,
                                              std::string_view place) const;
  [[nodiscard]] std::optional<std::vector<double>> checked_list(std::string_view key, const Node& node, Range allowed,
                                                                std::size_t count, std::string_view place) const;
  void wrong_type(std::string_view key, const Node& node, std::string_view requested,
                  std::string_view place = "") const;
  [[nodiscard]] Error error_at(std::string_view key, int line, std::string message, std::string remedy) const;
  [[nodiscard]] std::string full_name(std::string_view key) const;

  std::shared_ptr<Reading> reading_;
  std::string path_;                                        // "robot.link[2]"; "" for the root
  std::map<std::string, std::string, std::less<>> former_;  // the old name of a key
  const Node* over_;                                        // the table of a trial, or nullptr
  const Node* base_;                                        // the table of the file, or nullptr
};

}  // namespace mbk::config
