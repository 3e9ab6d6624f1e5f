#include "mbk/files/recording/guess_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "mbk/files/recording/si_units.h"
#include "mbk/files/recording/time_names.h"

namespace mbk::recording {
namespace guess {

enum class Quantity { time, position, force, torque, reference, acceleration, other };

/// The meaning of a name.
struct Meaning {
  Quantity quantity = Quantity::other;
  char axis = ' ';                      ///< 'x', 'y', 'z', or ' ' if none is named
  Quantity in_space = Quantity::other;  ///< of a name that says little, as z alone, where x and y are there too
  std::string unit;                     ///< as a map writes it; "" if none is named
};

/// Words in small letters: "PosX_mm" is pos x mm, "Force-Y (N)" is force y n.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words;
  bool begins = true;
  char before = ' ';
  for (const char c : name) {
    const bool upper = c >= 'A' && c <= 'Z', letter = upper || (c >= 'a' && c <= 'z');
    const bool digit = c >= '0' && c <= '9';
    if (!letter && !digit) {
      begins = true;
    } else {
      const bool camel = upper && before >= 'a' && before <= 'z';
      if (begins || camel) words.emplace_back();
      words.back() += upper ? static_cast<char>(c - 'A' + 'a') : c;
      begins = false;
    }
    before = c;
  }
  return words;
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

bool begins_with_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::any_of(words, [&](std::string_view one) { return word.starts_with(one); });
}

/// @param first  whether it is the first word of its name: "a" alone is an acceleration in "a_x", a channel in "cellA"
Quantity quantity_of(std::string_view word, bool first) {
  if (is_one_of(word, {"t"}) ||
      begins_with_one_of(word, {"time", "zeit", "clock", "seconds", "tout", "elapsed", "stamp"}))
    return Quantity::time;
  if (begins_with_one_of(word, {"ref", "cmd", "command", "desired", "target", "setpoint", "xr", "yr", "soll"})) {
    return Quantity::reference;
  }
  if (is_one_of(word, {"f", "fx", "fy", "fz"}) ||
      begins_with_one_of(word, {"force", "kraft", "load", "cell", "reaction"})) {
    return Quantity::force;
  }
  if (begins_with_one_of(word, {"torque", "moment", "tau", "drehmoment"})) return Quantity::torque;
  if (is_one_of(word, {"ax", "ay", "az"}) || (first && word == "a") || begins_with_one_of(word, {"acc", "beschl"})) {
    return Quantity::acceleration;
  }
  if (begins_with_one_of(word, {"pos", "hand", "disp", "angle", "theta", "winkel", "weg", "encoder"}) ||
      is_one_of(word, {"x", "y", "px", "py"})) {
    return Quantity::position;
  }
  return Quantity::other;
}

/// "mm", "N", "ms" … as the last word of a name, or in its brackets.
std::string unit_in(std::string_view name) {
  const std::size_t open = name.find_last_of("([");
  const std::size_t begin = open != std::string_view::npos ? open + 1 : name.find_last_of("_ ") + 1;
  if (begin == 0 || begin >= name.size()) return "";
  std::string_view unit = name.substr(begin);
  while (!unit.empty() && (unit.back() == ')' || unit.back() == ']' || unit.back() == ' ')) unit.remove_suffix(1);
  const Unit* const known = find_unit(unit);
  return known == nullptr ? "" : std::string(known->name);
}

Meaning meaning_of(const std::string& name) {
  Meaning meaning;
  meaning.unit = unit_in(name);
  // The strongest word decides: "hand_force_x" is a force, "ref_pos_x" a reference.
  constexpr auto kStrongest = std::to_array({Quantity::reference, Quantity::acceleration, Quantity::torque,
                                             Quantity::force, Quantity::time, Quantity::position});
  const std::vector<std::string> words = words_of(name);
  for (const Quantity quantity : kStrongest) {
    const auto is_named_by = [&](const std::string& word) {
      return quantity_of(word, &word == &words.front()) == quantity;
    };
    if (std::ranges::none_of(words, is_named_by)) continue;
    meaning.quantity = quantity;
    break;
  }
  if (std::ranges::any_of(words, [](const std::string& word) { return begins_with_one_of(word, {"vel", "speed"}); })) {
    meaning.quantity = Quantity::other;
  } else if (meaning.quantity == Quantity::other) {
    const auto is_there = [&](const char* word) { return std::ranges::find(words, word) != words.end(); };
    meaning.in_space = is_there("z") || is_there("pz") ? Quantity::position
                       : is_there("zr")                ? Quantity::reference
                                                       : Quantity::other;
  }
  for (const std::string& word : words) {
    const bool short_word =
        word.size() == 1 || is_one_of(word, {"fx", "fy", "fz", "px", "py", "pz", "ax", "ay", "az", "xr", "yr", "zr"});
    if (!short_word) continue;
    for (const char c : word) {
      if (c == 'x' || c == 'y' || c == 'z') meaning.axis = c;
    }
  }
  return meaning;
}

/// The mean step of a signal that rises in nearly equal steps.
std::optional<double> even_step(const Vector& values) {
  if (values.size() < 3) return std::nullopt;
  const Vector steps = values.tail(values.size() - 1) - values.head(values.size() - 1);
  const double mean = steps.mean();
  constexpr double kAlike = 0.5;
  if (!(mean > 0.0) || !(steps.minCoeff() > 0.0)) return std::nullopt;
  return (steps.array() - mean).abs().maxCoeff() < kAlike * mean ? std::optional(mean) : std::nullopt;
}

/// One channel that was found.
struct Entry {
  std::string channel;
  std::size_t signal;
  std::string why;
};

class Guesser {
 public:
  explicit Guesser(const std::vector<FileSignal>& signals) : signals_(signals) {
    for (const FileSignal& signal : signals) meanings_.push_back(meaning_of(signal.name));
  }

  ChannelGuess guess() {
    find_time();
    const bool two = has(Quantity::position, 'y') || count(Quantity::position) == 2;
    if (is_in_space()) {
      find_axes(3);
    } else {
      two ? find_axes(2) : find_one_axis();
    }
    return finished();
  }

 private:
  [[nodiscard]] bool has(Quantity quantity, char axis) const {
    return std::ranges::any_of(meanings_, [&](const Meaning& m) { return m.quantity == quantity && m.axis == axis; });
  }
  [[nodiscard]] std::ptrdiff_t count(Quantity quantity) const {
    return std::ranges::count(meanings_, quantity, &Meaning::quantity);
  }

  /// Whether position and force are named along x, y and z. Then z alone is a position.
  bool is_in_space() {
    const auto in_plane = [&](Quantity quantity) { return has(quantity, 'x') && has(quantity, 'y'); };
    const auto is_third = [](const Meaning& m) {
      return m.axis == 'z' && (m.quantity == Quantity::position || m.in_space == Quantity::position);
    };
    if (!in_plane(Quantity::position) || !in_plane(Quantity::force) || !has(Quantity::force, 'z')) return false;
    if (std::ranges::none_of(meanings_, is_third)) return false;
    for (Meaning& meaning : meanings_) {
      if (meaning.quantity == Quantity::other) meaning.quantity = meaning.in_space;
    }
    return true;
  }

  void add(const std::string& channel, std::size_t k, std::string why) {
    entries_.push_back({channel, k, std::move(why)});
  }

  void find_time() {
    for (std::size_t k = 0; k < signals_.size(); ++k) {
      if (meanings_[k].quantity == Quantity::time) return add("time", k, kByName);
    }
    std::optional<std::size_t> rises;
    for (std::size_t k = 0; k < signals_.size(); ++k) {
      if (!even_step(signals_[k].values)) continue;
      if (rises) return;  // ambiguous
      rises = k;
    }
    if (rises) add("time", *rises, "steps");
  }

  /// The k-th signal of that quantity and axis; of those without an axis the one at that place.
  [[nodiscard]] std::optional<std::size_t> find(Quantity quantity, char axis, int place) const {
    for (std::size_t k = 0; k < signals_.size(); ++k) {
      if (meanings_[k].quantity == quantity && meanings_[k].axis == axis) return k;
    }
    int seen = 0;
    for (std::size_t k = 0; k < signals_.size(); ++k) {
      const bool fits = meanings_[k].quantity == quantity && meanings_[k].axis == ' ';
      if (fits && seen++ == place) return k;
    }
    return std::nullopt;
  }

  void find_axes(int axes) {
    for (const auto& [quantity, names] : {std::pair(Quantity::position, std::array{"x", "y", "z"}),
                                          std::pair(Quantity::force, std::array{"Fx", "Fy", "Fz"}),
                                          std::pair(Quantity::reference, std::array{"xr", "yr", "zr"}),
                                          std::pair(Quantity::acceleration, std::array{"ax", "ay", "az"})}) {
      for (int axis = 0; axis < axes; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        if (const auto k = find(quantity, "xyz"[at], axis)) {
          add(names[at], *k, kByName);
        } else if (quantity == Quantity::position || quantity == Quantity::force) {
          missing_.emplace_back(names[at]);
        }
      }
    }
  }

  void find_one_axis() {
    const auto first = [&](std::initializer_list<Quantity> quantities) -> std::optional<std::size_t> {
      for (const Quantity quantity : quantities) {
        for (std::size_t k = 0; k < signals_.size(); ++k) {
          if (meanings_[k].quantity == quantity) return k;
        }
      }
      return std::nullopt;
    };
    for (const auto& [name, k] :
         {std::pair("x", first({Quantity::position})), std::pair("F", first({Quantity::force, Quantity::torque})),
          std::pair("xr", first({Quantity::reference})), std::pair("a", first({Quantity::acceleration}))}) {
      if (k) {
        add(name, *k, kByName);
      } else if (name == std::string_view("x") || name == std::string_view("F")) {
        missing_.emplace_back(name);
      }
    }
  }

  /// The unit that the size of the numbers suggests; "" if none.
  [[nodiscard]] std::string unit_by_size(const Entry& entry) const {
    constexpr double kSlow = 0.2, kFar = 3.0;
    const Vector& values = signals_[entry.signal].values;
    if (entry.channel == "time") {
      const Unit* const unit = values.size() > 0 ? unit_since_1970(values[0]) : nullptr;
      if (unit != nullptr) return std::string(unit->name);
      const auto step = even_step(values);
      return step && *step > kSlow ? "ms" : "";
    }
    if (entry.channel != "x" && entry.channel != "y" && entry.channel != "z") return "";
    return values.size() > 0 && (values.array() - values.mean()).abs().maxCoeff() > kFar ? "mm" : "";
  }

  [[nodiscard]] ChannelGuess finished() const {
    ChannelGuess guess;
    guess.missing = missing_;
    for (const Entry& entry : entries_) {
      GuessedChannel one{"", entry.channel, entry.signal, meanings_[entry.signal].unit, false, entry.why};
      if (one.unit.empty()) {
        one.unit = unit_by_size(entry);
        one.unit_by_size = !one.unit.empty();
      }
      one.entry =
          fmt::format("{}={}{}{}", one.channel, signals_[entry.signal].source, one.unit.empty() ? "" : ":", one.unit);
      guess.map += (guess.map.empty() ? "" : ",") + one.entry;
      guess.channels.push_back(std::move(one));
    }
    return guess;
  }

  static constexpr const char* kByName = "name";
  const std::vector<FileSignal>& signals_;
  std::vector<Meaning> meanings_;
  std::vector<Entry> entries_;
  std::vector<std::string> missing_;
};

/// Whether a map can contain the name unchanged.
bool is_plain(std::string_view name) {
  return !name.empty() && name.find_first_of(",=:*+-@[]'\"\\ ") == std::string_view::npos &&
         name.find_first_not_of("0123456789") != std::string_view::npos;
}

}  // namespace guess

std::vector<FileSignal> signals_of(const Contents& contents) {
  std::vector<FileSignal> signals;
  for (std::size_t k = 0; k < contents.arrays.size(); ++k) {
    const Array& array = contents.arrays[k];
    if (array.obstacle || array.values.size() == 0) continue;
    const std::string name =
        array.unit.empty() || array.name.empty() ? array.name : array.name + " (" + array.unit + ")";
    const Index rows = array.values.rows(), columns = array.values.cols();
    if (contents.table) {
      signals.push_back({std::to_string(k + 1), name, array.values.reshaped()});
    } else if (!guess::is_plain(array.name)) {
      continue;
    } else if (rows == 1 || columns == 1) {
      if (array.values.size() > 1) signals.push_back({array.name, name, array.values.reshaped()});
    } else {
      const bool tall = rows > columns;
      for (Index i = 0; i < std::min(rows, columns); ++i) {
        const Vector values = tall ? Vector(array.values.col(i)) : Vector(array.values.row(i).transpose());
        signals.push_back({fmt::format("{}[{}]", array.name, i + 1), "", values});
      }
    }
  }
  return signals;
}

ChannelGuess guess_channels(const std::vector<FileSignal>& signals) {
  return guess::Guesser(signals).guess();
}

}  // namespace mbk::recording
