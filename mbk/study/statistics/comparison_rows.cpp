// Differences between conditions, groups and sessions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mbk/base/numeric/parallel.h"
#include "mbk/study/statistics/outcome_rows.h"

namespace mbk::statistics {
namespace {

using reliability::Pairing;

constexpr double kLevel = 0.05;
/// Above so many people no single one decides, and looking at each costs their square.
constexpr Index kMaxLeftOut = 1'000;

/// Which level each trial belongs to; −1: none.
struct Levels {
  std::vector<std::string> names;
  std::vector<int> of_trial;
};

Error no_level(const std::string& what, const std::string& name, const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& one : known) list += (list.empty() ? "" : ", ") + (one.empty() ? "''" : one);
  return {ErrorKind::usage, fmt::format("there is no {} '{}' with usable results", what, name),
          list.empty() ? "" : "choose one of: " + list, ""};
}

Result<Levels> levels_by_name(const std::vector<std::string>& requested, const std::vector<std::string>& known,
                              const std::vector<int>& of_trial, const std::string& what) {
  Levels levels;
  levels.names = requested.empty() ? known : requested;
  std::vector<int> place(known.size(), -1);
  for (std::size_t k = 0; k < levels.names.size(); ++k) {
    const auto found = std::ranges::find(known, levels.names[k]);
    if (found == known.end()) return tl::unexpected(no_level(what, levels.names[k], known));
    int& at = place[static_cast<std::size_t>(found - known.begin())];
    if (at >= 0) return bad_usage(fmt::format("{} '{}' is named twice", what, levels.names[k]), "name each once");
    at = static_cast<int>(k);
  }
  if (levels.names.size() < 2) {
    return bad_usage(fmt::format("there is only one {}, so nothing can be compared", what),
                     fmt::format("measure at least two {}s", what));
  }
  for (const int one : of_trial) levels.of_trial.push_back(one < 0 ? -1 : place[static_cast<std::size_t>(one)]);
  return levels;
}

Result<Levels> by_condition(const store::OutcomeColumns& columns, const std::vector<std::string>& requested) {
  std::vector<int> of_trial;
  for (const store::TrialRow& trial : columns.trials) of_trial.push_back(trial.condition);
  return levels_by_name(requested, columns.conditions, of_trial, "condition");
}

Result<Levels> by_session(const store::OutcomeColumns& columns, const std::vector<std::string>& requested) {
  std::map<std::int64_t, int> numbers;
  for (const store::TrialRow& trial : columns.trials) numbers.emplace(trial.session, 0);
  std::vector<std::string> known;
  for (auto& [number, at] : numbers) {
    at = static_cast<int>(known.size());
    known.push_back(fmt::format("{}", number));
  }
  std::vector<int> of_trial;
  for (const store::TrialRow& trial : columns.trials) of_trial.push_back(numbers[trial.session]);
  return levels_by_name(requested, known, of_trial, "session");
}

Result<Levels> by_group(const store::OutcomeColumns& columns, const std::vector<PeopleGroup>& groups,
                        const std::vector<std::string>& requested, std::vector<std::string>& notes) {
  if (groups.size() < 2) {
    return bad_usage("a comparison of groups needs two groups",
                     "assign the participants, as in --group patients=1-10 --group controls=11,12,15-20");
  }
  std::map<std::int64_t, int> group_of;
  std::vector<std::string> known;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    known.push_back(groups[k].name);
    for (const std::int64_t participant : groups[k].participants) {
      const auto [there, added] = group_of.emplace(participant, static_cast<int>(k));
      if (added || there->second == static_cast<int>(k)) continue;
      return bad_usage(fmt::format("participant {} is in two groups, {} and {}", participant,
                                   groups[static_cast<std::size_t>(there->second)].name, groups[k].name),
                       "assign each person to one group");
    }
  }
  std::vector<int> of_trial;
  std::set<std::int64_t> without, seen;
  for (const store::TrialRow& trial : columns.trials) {
    const auto found = group_of.find(trial.participant);
    of_trial.push_back(found == group_of.end() ? -1 : found->second);
    (found == group_of.end() ? without : seen).insert(trial.participant);
  }
  if (!without.empty()) {
    notes.push_back(fmt::format("not compared, because in no group: participant {}",
                                listed(std::vector<std::int64_t>(without.begin(), without.end()))));
  }
  std::vector<std::int64_t> absent;
  for (const auto& [participant, group] : group_of) {
    if (!seen.contains(participant)) absent.push_back(participant);
  }
  if (!absent.empty()) {
    notes.push_back(fmt::format("in a group, but without usable results: participant {}", listed(absent)));
  }
  return levels_by_name(requested, known, of_trial, "group");
}

/// One person at one level: the mean of their results, and its squared standard error by those of the results.
struct PersonMean {
  double mean = 0, known_variance = 0;
  int count = 0;
};

/// One person at both levels; a count of 0 where there is none.
struct PersonPair {
  std::int64_t participant = 0;
  std::array<PersonMean, 2> at;
};

std::vector<PersonPair> person_pairs(const OutcomeRows& rows, const Levels& levels, int first) {
  std::vector<PersonPair> pairs;
  for (const OutcomeRow& row : rows.rows) {
    if (pairs.empty() || pairs.back().participant != row.participant) pairs.push_back({row.participant, {}});
    PersonMean& person = pairs.back().at.at(levels.of_trial[row.trial] == first ? 0 : 1);
    person.mean += row.value;
    person.known_variance += row.standard_error * row.standard_error;
    ++person.count;
  }
  for (PersonPair& pair : pairs) {
    for (PersonMean& person : pair.at) {
      if (person.count == 0) continue;
      person.mean /= person.count;
      person.known_variance /= double(person.count) * person.count;
    }
  }
  return pairs;
}

/// Values of people at both levels: pairs where there are any, else two samples.
struct Samples {
  Pairing pairing = Pairing::unpaired;
  Vector first, second;
  std::vector<std::int64_t> first_people, second_people;
  int left_out = 0;
};

Samples samples_of(const std::vector<PersonPair>& pairs) {
  const auto has_both = [](const PersonPair& pair) { return pair.at[0].count > 0 && pair.at[1].count > 0; };
  Samples samples;
  const bool paired = std::ranges::any_of(pairs, has_both);
  samples.pairing = paired ? Pairing::paired : Pairing::unpaired;
  std::vector<double> first, second;
  for (const PersonPair& pair : pairs) {
    if (paired && !has_both(pair)) {
      ++samples.left_out;
      continue;
    }
    if (pair.at[0].count > 0) {
      first.push_back(pair.at[0].mean);
      samples.first_people.push_back(pair.participant);
    }
    if (pair.at[1].count > 0) {
      second.push_back(pair.at[1].mean);
      samples.second_people.push_back(pair.participant);
    }
  }
  samples.first = as_vector(first);
  samples.second = as_vector(second);
  return samples;
}

/// One value of each person at each level, so that what differs between people in the difference itself is part of the
/// residual, as in a paired test: single trials would be taken for as many people.
std::optional<MixedDifference> mixed_difference(const std::vector<PersonPair>& pairs, bool weighted,
                                                std::vector<std::string>& notes) {
  reliability::Measurements m;
  std::vector<double> values, level, known;
  for (const PersonPair& pair : pairs) {
    for (int k = 0; k < 2; ++k) {
      const PersonMean& person = pair.at.at(static_cast<std::size_t>(k));
      if (person.count == 0) continue;
      values.push_back(person.mean);
      level.push_back(k);
      known.push_back(person.known_variance);
      m.participants.push_back(static_cast<int>(pair.participant));
      m.sessions.push_back(k);
    }
  }
  m.values = as_vector(values);
  m.fixed.resize(m.values.size(), 2);
  m.fixed << Vector::Ones(m.values.size()), as_vector(level);
  m.names = {"mean", "difference"};
  if (weighted) m.known_variance = as_vector(known);
  const auto model = reliability::fit_mixed_model(m);
  if (!model) {
    notes.push_back("no mixed model: " + model.error().message);
    return std::nullopt;
  }
  MixedDifference result;
  result.weighted = weighted;
  result.participants = model->participants;
  result.difference = model->effects[1];
  if (model->participant.present) result.participant = model->participant.value;
  result.residual = model->residual.value;
  return result;
}

Vector without(const Vector& values, Index at) {
  Vector others(values.size() - 1);
  others << values.head(at), values.tail(values.size() - 1 - at);
  return others;
}

/// The person without whom p is largest.
std::optional<Influence> influence_on_p(const Samples& samples) {
  if (samples.first.size() + samples.second.size() > kMaxLeftOut) return {};
  std::optional<Influence> most;
  const auto take = [&](std::int64_t participant, double p) {
    if (std::isfinite(p) && (!most || p > most->without)) most = {participant, p};
  };
  const bool paired = samples.pairing == Pairing::paired;
  for (Index i = 0; i < samples.first.size(); ++i) {
    take(samples.first_people[static_cast<std::size_t>(i)],
         reliability::difference_p(without(samples.first, i), paired ? without(samples.second, i) : samples.second,
                                   samples.pairing));
  }
  for (Index i = 0; !paired && i < samples.second.size(); ++i) {
    take(samples.second_people[static_cast<std::size_t>(i)],
         reliability::difference_p(samples.first, without(samples.second, i), samples.pairing));
  }
  return most;
}

void compare_one(const OutcomeRows& rows, const Levels& levels, int first, std::uint64_t seed,
                 OutcomeComparison& result) {
  result.axial = rows.axial;
  if (!rows.trusted) {
    result.verdict = DifferenceVerdict::no_variation;
    result.notes.emplace_back("orientations are more than 45° from their mean axis and cannot be treated as numbers");
    result.difference.support = result.permutation.support = Support::no_variation;
    result.difference.value = result.difference.p = result.permutation.p = kNaN;
    return;
  }
  const std::vector<PersonPair> pairs = person_pairs(rows, levels, first);
  const Samples samples = samples_of(pairs);
  result.left_out = samples.left_out;
  if (samples.first.size() > 0) result.first_mean = samples.first.mean();
  if (samples.second.size() > 0) result.second_mean = samples.second.mean();
  result.first_values = samples.first;
  result.second_values = samples.second;
  // Finite numbers, and pairs: neither can fail.
  if (auto difference = reliability::difference(samples.first, samples.second, samples.pairing)) {
    result.difference = *difference;
  }
  if (auto permutation =
          reliability::permutation_test(samples.first, samples.second, samples.pairing, {.seed = seed})) {
    result.permutation = *permutation;
  }
  if (result.difference.support == Support::too_few_people) return;
  result.mixed_model = mixed_difference(pairs, all_known(rows.rows), result.notes);
  result.influence = influence_on_p(samples);
}

void judge(OutcomeComparison& one) {
  if (one.difference.support == Support::no_variation || one.permutation.support == Support::no_variation) {
    one.verdict = DifferenceVerdict::no_variation;
  } else if (one.difference.support != Support::enough || one.permutation.support != Support::enough) {
    one.verdict = DifferenceVerdict::too_few_people;
  } else {
    one.verdict = one.p_holm <= kLevel ? DifferenceVerdict::differs : DifferenceVerdict::not_shown;
  }
  if (one.verdict != DifferenceVerdict::differs) return;
  if (one.influence && one.influence->without > kLevel) {
    one.notes.push_back(fmt::format("the difference depends on participant {}: without them p is {:.2g}",
                                    one.influence->participant, one.influence->without));
  }
  if (one.permutation.p > kLevel) {
    one.notes.push_back(
        fmt::format("a permutation test does not confirm it (p {:.2g}); check the single values", one.permutation.p));
  }
}

void adjust(std::vector<OutcomeComparison>& outcomes, int& tests) {
  std::vector<double> p;
  std::vector<OutcomeComparison*> tested;
  for (OutcomeComparison& one : outcomes) {
    if (!std::isfinite(one.difference.p)) continue;
    p.push_back(one.difference.p);
    tested.push_back(&one);
  }
  tests = static_cast<int>(p.size());
  const auto holm = reliability::holm(as_vector(p)), hochberg = reliability::benjamini_hochberg(as_vector(p));
  for (std::size_t k = 0; holm && hochberg && k < tested.size(); ++k) {
    tested[k]->p_holm = (*holm)[static_cast<Index>(k)];
    tested[k]->p_benjamini_hochberg = (*hochberg)[static_cast<Index>(k)];
  }
  for (OutcomeComparison& one : outcomes) judge(one);
}

}  // namespace

Result<Comparison> compared(const store::OutcomeColumns& columns,
                            const std::vector<const store::OutcomeColumn*>& chosen, const StatisticsOptions& options,
                            std::vector<std::string>& notes) {
  const Comparing& how = *options.comparing;
  const auto levels = MBK_TRY(how.by == ComparedBy::condition ? by_condition(columns, how.levels)
                              : how.by == ComparedBy::session ? by_session(columns, how.levels)
                                                              : by_group(columns, options.groups, how.levels, notes));
  Comparison comparison;
  comparison.by = how.by;
  comparison.levels = levels.names;
  struct Task {
    const store::OutcomeColumn* column;
    int condition, first, second;
  };
  std::vector<Task> tasks;
  const int strata = how.by == ComparedBy::condition ? 1 : static_cast<int>(columns.conditions.size());
  const int count = static_cast<int>(levels.names.size());
  for (int condition = 0; condition < strata; ++condition) {
    for (int first = 0; first < count; ++first) {
      for (int second = first + 1; second < count; ++second) {
        for (const store::OutcomeColumn* column : chosen) {
          tasks.push_back({column, how.by == ComparedBy::condition ? -1 : condition, first, second});
        }
      }
    }
  }
  std::vector<OutcomeComparison> outcomes(tasks.size());
  MBK_TRY(numeric::parallel_for(static_cast<int>(tasks.size()), options.threads, [&](int k) -> Result<void> {
    const auto [column, condition, first, second] = tasks[static_cast<std::size_t>(k)];
    std::vector<bool> keep(columns.trials.size());
    for (std::size_t i = 0; i < keep.size(); ++i) {
      keep[i] = levels.of_trial[i] == first || levels.of_trial[i] == second;
    }
    OutcomeComparison& one = outcomes[static_cast<std::size_t>(k)];
    one.condition = condition < 0 ? "" : columns.conditions[static_cast<std::size_t>(condition)];
    one.first = levels.names[static_cast<std::size_t>(first)];
    one.second = levels.names[static_cast<std::size_t>(second)];
    one.outcome = column->name;
    one.unit = column->unit;
    compare_one(rows_of(columns, *column, condition, keep), levels, first, options.seed, one);
    return {};
  }));
  // What neither level has is no test.
  std::erase_if(outcomes, [](const OutcomeComparison& one) {
    return one.difference.first_count + one.difference.second_count == 0 && one.notes.empty();
  });
  comparison.outcomes = std::move(outcomes);
  adjust(comparison.outcomes, comparison.tests);
  return comparison;
}

}  // namespace mbk::statistics
