#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mbk/base/config/document.h"
#include "mbk/base/numeric/random.h"
#include "mbk/experiment/device/device.h"
#include "mbk/experiment/safety/trip.h"

/// The words in which tables/*.toml describe faults. What a fault does is a list of statements with ';' between them: a
/// verb and its words, or an assignment. Both may begin with "@k" or "@first..last", the ticks in which they act.
///
///   field = terms      a sum of terms: a number, nan, inf, true, false, off, on; or now, held or k, alone or as
///   "2*now":
///                      the value that it would have, the value at the first tick, and ticks since the fault began
///   hold CHANNEL AXIS              the reading of the first tick   (AXIS: 1, 2, both, any: by lot)
///   backwards CHANNEL AXIS         counts backwards from the first reading
///   read CHANNEL VALUE             one axis by lot reads that value
///   offset, drifts CHANNEL A..B    off by A to B, or by so much in each second, in a direction by lot
///   one_offset, one_drifts CHANNEL A..B   the same of one axis by lot
///   scale CHANNEL FACTOR
///
/// A CHANNEL is encoder, force or acceleration. "A..B" is drawn by lot, "A" is not. The tables belong to the program: a
/// statement that cannot be read throws, and a test reads them all.
namespace mbk::validation {

using Eigen::Vector2d;

inline constexpr double kTick = 1e-3;  ///< of the sessions in which faults come [s]

/// A number from a range.
struct Span {
  double least = 0.0, most = 0.0;
  [[nodiscard]] double drawn(numeric::Random& random) const {
    return least == most ? least : random.uniform(least, most);
  }
  [[nodiscard]] int drawn_whole(numeric::Random& random) const;
};

struct Statement {
  std::vector<std::string> words;
  int first = 0, last = -1;  ///< ticks in which it acts; last −1: for ever
  [[nodiscard]] const std::string& word(std::size_t i) const { return words.at(i); }
  [[nodiscard]] double number(std::size_t i) const { return span(i).least; }
  [[nodiscard]] Span span(std::size_t i) const;
  [[nodiscard]] bool is_assignment() const { return words.size() > 2 && words[1] == "="; }
  [[nodiscard]] bool acts(int k) const { return k >= first && (last < 0 || k <= last); }
};

[[nodiscard]] std::vector<Statement> statements_of(std::string_view text);

/// A unit vector by lot.
[[nodiscard]] Vector2d direction_by_lot(numeric::Random& random);
[[nodiscard]] Eigen::Index axis_by_lot(numeric::Random& random);

/// What a statement makes of a state, tick for tick.
template <class State>
using Change = std::function<void(State&, int k)>;

/// Draws by lot what a statement on a channel does to readings.   @returns  nothing for other verbs
[[nodiscard]] std::optional<std::function<Change<device::State>(numeric::Random&)>> channel_fault(const Statement& one);

/// A number that assignments can set.
template <class State>
struct Field {
  std::string_view name;
  double (*get)(const State&);
  void (*set)(State&, double);
};

template <class Number>
void set_number(Number& number, double value) {
  if constexpr (std::is_same_v<Number, bool>) {
    number = value != 0.0;
  } else if constexpr (std::is_unsigned_v<Number>) {
    number = static_cast<Number>(std::ceil(std::max(value, 0.0)));
  } else if constexpr (std::is_enum_v<Number>) {
    number = static_cast<Number>(static_cast<int>(value));
  } else {
    number = value;
  }
}

/// The member of a state, by its name in assignments.
#define MBK_FAULT_FIELD(State, name, member)                                                 \
  mbk::validation::Field<State> {                                                            \
    name, [](const State& state) { return static_cast<double>(state.member); },              \
        [](State& state, double value) { mbk::validation::set_number(state.member, value); } \
  }

namespace fault_words_detail {

struct Sum {
  double now = 0.0, held = 0.0, k = 0.0, constant = 0.0;
};
[[nodiscard]] Sum sum_of(const Statement& one);
[[noreturn]] void throw_unknown(const std::string& word);

}  // namespace fault_words_detail

template <class State>
Change<State> assignment(const Statement& one, std::span<const Field<State>> fields) {
  for (const Field<State>& field : fields) {
    if (field.name != one.word(0)) continue;
    return [field, one, sum = fault_words_detail::sum_of(one), held = std::optional<double>()](State& state,
                                                                                               int k) mutable {
      const double now = field.get(state);
      if (!held) held = now;
      if (one.acts(k)) field.set(state, sum.now * now + sum.held * *held + sum.k * k + sum.constant);
    };
  }
  fault_words_detail::throw_unknown(one.word(0));
}

/// A row's own words, and those that "+name" stands for.
[[nodiscard]] std::string with_words(std::string_view text, const config::Section& words);
/// "link-lost late"
[[nodiscard]] std::vector<safety::Reason> reasons_of(std::string_view text);

/// The tables, as CMake embeds them.
struct FaultTable {
  std::string_view name, text;
};
[[nodiscard]] config::Document fault_table(std::string_view name);
/// Throws where something in the table was not asked for, or could not be read.
void require_read(const config::Document& document);

}  // namespace mbk::validation
