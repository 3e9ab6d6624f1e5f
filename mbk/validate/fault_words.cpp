#include "mbk/validate/fault_words.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "mbk/base/core/nan.h"

namespace mbk::validation {
namespace {

using device::State;
using numeric::Random;

std::vector<std::string> words_of(std::string_view text) {
  std::istringstream stream{std::string(text)};
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

double value_of_word(const std::string& word) {
  if (word == "true") return 1.0;
  if (word == "false") return 0.0;
  if (word == "off") return static_cast<double>(device::Motors::off);
  if (word == "on") return static_cast<double>(device::Motors::on);
  return std::stod(word);  // "nan" and "inf" too
}

Span span_of(const std::string& word) {
  const std::size_t dots = word.find("..");
  const double least = value_of_word(word.substr(0, dots));
  return {least, dots == std::string::npos ? least : value_of_word(word.substr(dots + 2))};
}

using Pair = Vector2d State::*;

Pair channel_of(const std::string& word) {
  if (word == "encoder") return &State::joint;
  if (word == "force") return &State::force;
  if (word == "acceleration") return &State::acceleration;
  fault_words_detail::throw_unknown(word);
}

/// −1: both.
Eigen::Index axis_of(const std::string& word, Random& random) {
  if (word == "any") return axis_by_lot(random);
  return word == "both" ? -1 : std::stoi(word) - 1;
}

double sign_by_lot(Random& random) {
  return random.below(2) == 0 ? 1.0 : -1.0;
}

/// Of one axis or of both; the reading of the first tick is `held`.
template <class Make>
Change<State> from_held(Pair pair, Eigen::Index axis, const Make& make) {
  return [=, held = std::optional<Vector2d>()](State& state, int) mutable {
    if (!held) held = state.*pair;
    for (Eigen::Index i = 0; i < 2; ++i) {
      if (axis < 0 || i == axis) (state.*pair)[i] = make((*held)[i], (state.*pair)[i]);
    }
  };
}

}  // namespace

namespace fault_words_detail {

void throw_unknown(const std::string& word) {
  throw std::invalid_argument("a table of faults holds the unknown word '" + word + "'");
}

Sum sum_of(const Statement& one) {
  Sum sum;
  for (std::size_t i = 2; i < one.words.size(); ++i) {
    const std::string& word = one.word(i);
    const std::size_t star = word.find('*');
    const std::string of = star == std::string::npos ? word : word.substr(star + 1);
    double* const part = of == "now" ? &sum.now : of == "held" ? &sum.held : of == "k" ? &sum.k : nullptr;
    if (part == nullptr) {
      sum.constant += value_of_word(word);
    } else {
      *part += star == std::string::npos ? 1.0 : value_of_word(word.substr(0, star));
    }
  }
  return sum;
}

}  // namespace fault_words_detail

int Span::drawn_whole(Random& random) const {
  const auto low = static_cast<int>(least), high = static_cast<int>(most);
  return low + static_cast<int>(random.below(static_cast<std::uint64_t>(high - low + 1)));
}

Span Statement::span(std::size_t i) const {
  return span_of(words.at(i));
}

std::vector<Statement> statements_of(std::string_view text) {
  std::vector<Statement> all;
  std::istringstream stream{std::string(text)};
  for (std::string part; std::getline(stream, part, ';');) {
    Statement one{words_of(part)};
    if (one.word(0).starts_with('@')) {
      const Span ticks = span_of(one.word(0).substr(1));
      one.first = static_cast<int>(ticks.least);
      one.last = static_cast<int>(ticks.most);
      one.words.erase(one.words.begin());
    }
    all.push_back(std::move(one));
  }
  return all;
}

Vector2d direction_by_lot(Random& random) {
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  return {std::cos(angle), std::sin(angle)};
}

Eigen::Index axis_by_lot(Random& random) {
  return static_cast<Eigen::Index>(random.below(2));
}

std::optional<std::function<Change<State>(Random&)>> channel_fault(const Statement& one) {
  using Make = std::function<Change<State>(Random&)>;
  const std::string& verb = one.word(0);
  constexpr std::array kVerbs = {"hold", "backwards", "read", "offset", "drifts", "one_offset", "one_drifts", "scale"};
  if (std::ranges::find(kVerbs, verb) == kVerbs.end()) return std::nullopt;
  const Pair pair = channel_of(one.word(1));
  if (verb == "hold" || verb == "backwards") {
    const double back = verb == "hold" ? 0.0 : 1.0;
    return Make([=, axis = one.word(2)](Random& random) {
      return from_held(pair, axis_of(axis, random),
                       [back](double held, double now) { return back == 0.0 ? held : 2.0 * held - now; });
    });
  }
  if (verb == "read") {
    return Make([=, value = one.number(2)](Random& random) -> Change<State> {
      return [=, axis = axis_by_lot(random)](State& state, int) { (state.*pair)[axis] = value; };
    });
  }
  if (verb == "scale") {
    return Make([=, factor = one.number(2)](Random&) -> Change<State> {
      return [=](State& state, int) { state.*pair *= factor; };
    });
  }
  const bool drifts = verb.ends_with("drifts");
  const Span span = one.span(2);
  if (verb.starts_with("one_")) {
    return Make([=](Random& random) -> Change<State> {
      const Eigen::Index axis = axis_by_lot(random);
      const double by = sign_by_lot(random) * span.drawn(random);
      return [=](State& state, int k) { (state.*pair)[axis] += drifts ? by * kTick * (k + 1) : by; };
    });
  }
  return Make([=](Random& random) -> Change<State> {
    const Vector2d by = span.drawn(random) * direction_by_lot(random);
    return [=](State& state, int k) { state.*pair += drifts ? Vector2d((k + 1) * kTick * by) : by; };
  });
}

std::string with_words(std::string_view text, const config::Section& words) {
  std::string all;
  for (const std::string& word : words_of(text)) {
    all += (all.empty() ? "" : " ") + (word.starts_with('+') ? words.required_text(word.substr(1)) : word);
  }
  return all;
}

void require_read(const config::Document& document) {
  if (const auto read = document.finish(); !read) throw std::invalid_argument(read.error().line());
}

std::vector<safety::Reason> reasons_of(std::string_view text) {
  std::vector<safety::Reason> reasons;
  for (const std::string& word : words_of(text)) {
    const auto reason = value_of<safety::Reason>(word);
    if (!reason) fault_words_detail::throw_unknown(word);
    reasons.push_back(*reason);
  }
  return reasons;
}

}  // namespace mbk::validation
