#include "mbk/study/longitudinal/side_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "mbk/study/store/study_summary.h"

namespace mbk::longitudinal {
namespace {

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// What stands before and after a word that a text has once; nothing where it has it not, or again.
std::optional<std::pair<std::string, std::string>> around(const std::string& text, std::string_view word) {
  std::string low = text;
  for (char& c : low) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  std::optional<std::pair<std::string, std::string>> found;
  for (std::size_t at = low.find(word); at != std::string::npos; at = low.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at > 0 && is_letter(low[at - 1])) || (end < low.size() && is_letter(low[end]))) continue;
    if (found) return std::nullopt;
    found = {text.substr(0, at), text.substr(end)};
  }
  return found;
}

std::string trimmed(const std::string& text) {
  constexpr const char* kBetween = "-_ .,";
  const std::size_t begin = text.find_first_not_of(kBetween);
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(kBetween) + 1 - begin);
}

/// Left and right of one session.
struct BothSides {
  SessionResult left, right;
  [[nodiscard]] double difference() const { return left.mean - right.mean; }
  [[nodiscard]] std::vector<std::int64_t> recordings() const {
    std::vector<std::int64_t> all = left.recordings;
    all.insert(all.end(), right.recordings.begin(), right.recordings.end());
    return all;
  }
};
using SessionSides = std::map<std::int64_t, BothSides>;  ///< by session

std::map<std::int64_t, SessionSides> sides_of(const store::OutcomeColumns& columns, const store::OutcomeColumn& column,
                                              const SidePair& pair) {
  std::map<std::int64_t, SessionSides> all;
  const auto left = session_results(columns, column, pair.left), right = session_results(columns, column, pair.right);
  for (const auto& [person, sessions] : left) {
    const auto other = right.find(person);
    if (other == right.end()) continue;
    for (const auto& [session, one] : sessions) {
      const auto both = other->second.find(session);
      if (both != other->second.end()) all[person][session] = {one, both->second};
    }
  }
  return all;
}

/// How differences of all other people vary between sessions that are comparable with the recordings.
DetectableChange error_of_others(const std::map<std::int64_t, SessionSides>& people, std::int64_t participant,
                                 const store::OutcomeColumn& column, const StretchExtents& extents,
                                 const std::vector<std::int64_t>& own) {
  store::OutcomeColumns differences{{""}, {}, {{column.name, column.unit, {}, {}}}};
  for (const auto& [person, sessions] : people) {
    if (person == participant) continue;
    for (const auto& [session, both] : sessions) {
      if (!extents.comparable(column.name, both.recordings(), own)) continue;
      differences.trials.push_back({std::ssize(differences.trials) + 1, person, session, 1, 0});
      differences.outcomes.front().values.push_back(both.difference());
    }
  }
  const auto found = statistics::study_statistics(differences);
  if (!found || found->reliability.empty()) return {.why_unknown = "no other person has such results of both sides"};
  return detectable_change(found->reliability.front());
}

void judge_sides(SideDifference& one, const BothSides& sides, const DetectableChange& others) {
  one.why_unknown = others.why_unknown;
  if (others.known()) {
    one.basis = ErrorBasis::sessions;
    one.error = reliability::kPublishedNormal95 * std::sqrt(others.session + others.trial);
    one.error95 = {others.lower_factor * one.error, others.upper_factor * one.error};
    one.heavy_tails = others.heavy_tails;
    one.verdict = verdict_of(one.difference, one.error, one.error95);
    if (one.heavy_tails && one.verdict == ChangeVerdict::beyond_error) one.verdict = ChangeVerdict::uncertain;
    return;
  }
  const double error = std::hypot(sides.left.standard_error, sides.right.standard_error);
  if (!std::isfinite(error)) return;
  one.basis = ErrorBasis::recordings;
  one.error = reliability::kPublishedNormal95 * error;
}

}  // namespace

std::vector<SidePair> side_pairs(const std::vector<std::string>& conditions) {
  std::vector<SidePair> pairs;
  for (std::size_t left = 0; left < conditions.size(); ++left) {
    const auto stem = around(conditions[left], "left");
    if (!stem) continue;
    for (std::size_t right = 0; right < conditions.size(); ++right) {
      if (around(conditions[right], "right") != stem) continue;
      pairs.push_back({trimmed(trimmed(stem->first) + " " + trimmed(stem->second)), static_cast<int>(left),
                       static_cast<int>(right)});
      break;
    }
  }
  return pairs;
}

std::vector<SideDifference> side_differences(const store::OutcomeColumns& columns, std::int64_t participant,
                                             const std::set<std::int64_t>& controls, const StretchExtents& extents) {
  std::vector<SideDifference> all;
  for (const SidePair& pair : side_pairs(columns.conditions)) {
    for (const store::OutcomeColumn& column : columns.outcomes) {
      if (store::is_orientation(column.name)) continue;
      const auto people = sides_of(columns, column, pair);
      const auto own = people.find(participant);
      if (own == people.end()) continue;
      const auto& [session, sides] = *own->second.rbegin();
      SideDifference one{.left_condition = columns.conditions[static_cast<std::size_t>(pair.left)],
                         .right_condition = columns.conditions[static_cast<std::size_t>(pair.right)],
                         .outcome = column.name,
                         .unit = column.unit,
                         .session = session,
                         .left = sides.left.mean,
                         .right = sides.right.mean,
                         .difference = sides.difference()};
      const std::vector<std::int64_t> recordings = sides.recordings();
      one.why_not_comparable =
          extents.difference(column.name, sides.left.recordings, sides.right.recordings, "left ", "right ");
      if (!one.why_not_comparable.empty()) {
        all.push_back(std::move(one));
        continue;
      }
      judge_sides(one, sides, error_of_others(people, participant, column, extents, recordings));
      std::vector<double> values;
      int not_comparable = 0;
      for (const auto& [person, sessions] : people) {
        if (!controls.contains(person)) continue;
        const BothSides& last = sessions.rbegin()->second;
        if (extents.comparable(column.name, last.recordings(), recordings)) {
          values.push_back(last.difference());
        } else {
          ++not_comparable;
        }
      }
      one.normal = normal_range(values);
      one.normal.not_comparable = not_comparable;
      one.why_no_comparable_range = too_few_comparable(one.normal);
      one.range_verdict = verdict_of(one.difference, one.normal);
      all.push_back(std::move(one));
    }
  }
  return all;
}

}  // namespace mbk::longitudinal
