// What follows from the elements of matrices: their further numbers, and the distances between them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mbk/base/numeric/statistics.h"
#include "mbk/study/reliability/axial.h"
#include "mbk/study/statistics/outcome_rows.h"

namespace mbk::statistics {
namespace {

struct NamedMatrix {
  const char *letter, *quantity;
};
constexpr std::array kMatrices = {NamedMatrix{"M", "inertia"}, NamedMatrix{"B", "damping"},
                                  NamedMatrix{"K", "stiffness"}};

/// The four columns of a matrix, xx xy yx yy; nothing where one is missing.
using Elements = std::array<const store::OutcomeColumn*, 4>;

std::optional<Elements> elements_of(const store::OutcomeColumns& columns, const char* letter) {
  Elements elements{};
  std::size_t at = 0;
  for (const char* place : {"xx", "xy", "yx", "yy"}) {
    const auto found =
        std::ranges::find(columns.outcomes, fmt::format("{}_{}", letter, place), &store::OutcomeColumn::name);
    if (found == columns.outcomes.end()) return std::nullopt;
    elements.at(at++) = &*found;
  }
  return elements;
}

/// NaN where an element is missing.
Eigen::Matrix2d matrix_at(const Elements& elements, std::size_t trial) {
  Eigen::Matrix2d Z;
  Z << elements[0]->values[trial], elements[1]->values[trial], elements[2]->values[trial], elements[3]->values[trial];
  return Z;
}

bool is_positive_definite(const Eigen::Matrix2d& Z) {
  const double off = 0.5 * (Z(0, 1) + Z(1, 0));
  return Z(0, 0) > 0.0 && Z(0, 0) * Z(1, 1) - off * off > 1e-12 * Z(0, 0) * Z(1, 1);
}

Quartiles quartiles_of(Vector distances) {
  std::sort(distances.begin(), distances.end());
  return {static_cast<int>(distances.size()), numeric::quantile(distances, 0.25), numeric::quantile(distances, 0.5),
          numeric::quantile(distances, 0.75)};
}

/// P(a < b) + ½ P(a = b) of a pair drawn from both.
double chance_less(Vector a, Vector b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double sum = 0.0;
  for (const double one : b) {
    const auto [low, high] = std::equal_range(a.begin(), a.end(), one);
    sum += 0.5 * static_cast<double>((low - a.begin()) + (high - a.begin()));
  }
  return sum / (static_cast<double>(a.size()) * static_cast<double>(b.size()));
}

/// The mean matrix of each session of each person.
struct SessionMatrices {
  std::vector<std::vector<Matrix>> of_people;
  int sessions = 0, left_out = 0, people = 0;
};

SessionMatrices session_matrices(const store::OutcomeColumns& columns, const Elements& elements, int condition) {
  SessionMatrices result;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  int count = 0;
  std::int64_t participant = 0, session = 0, person_of_last = 0;
  const auto close = [&] {
    if (count == 0) return;
    const Eigen::Matrix2d mean = sum / count;
    sum.setZero();
    count = 0;
    if (!is_positive_definite(mean)) {
      ++result.left_out;
      return;
    }
    if (result.of_people.empty() || person_of_last != participant) result.of_people.emplace_back();
    person_of_last = participant;
    result.of_people.back().emplace_back(mean);
    ++result.sessions;
  };
  for (std::size_t k = 0; k < columns.trials.size(); ++k) {
    const store::TrialRow& trial = columns.trials[k];
    if (trial.condition != condition) continue;
    const Eigen::Matrix2d Z = matrix_at(elements, k);
    if (!Z.allFinite()) continue;
    if (trial.participant != participant || trial.session != session) close();
    participant = trial.participant;
    session = trial.session;
    sum += Z;
    ++count;
  }
  close();
  result.people = static_cast<int>(result.of_people.size());
  return result;
}

/// Distances between people are as many as half of their square.
constexpr int kMaxPeople = 500;

MatrixSpread spread_of(const SessionMatrices& matrices) {
  MatrixSpread spread;
  spread.participants = matrices.people;
  spread.sessions = matrices.sessions;
  spread.left_out = matrices.left_out;
  std::vector<std::vector<Matrix>> people = matrices.of_people;
  if (matrices.people > kMaxPeople) people.resize(kMaxPeople);
  const auto widths = reliability::width_spread(people);
  if (!widths) {
    spread.support = Support::no_variation;
    return spread;
  }
  spread.support = widths->support;
  if (spread.support != Support::enough) return spread;
  spread.within = quartiles_of(widths->within);
  spread.between = quartiles_of(widths->between);
  spread.closer = chance_less(widths->within, widths->between);
  if (!(widths->within.maxCoeff() > 0.0)) spread.support = Support::no_variation;
  return spread;
}

}  // namespace

void add_matrix_numbers(store::OutcomeColumns& columns) {
  std::vector<store::OutcomeColumn> added;
  for (const auto& [letter, quantity] : kMatrices) {
    const auto elements = elements_of(columns, letter);
    if (!elements) continue;
    const std::size_t first = added.size();
    for (const char* name : {"lambda_max", "lambda_min", "symmetric_xy", "antisymmetric"}) {
      added.push_back({fmt::format("{}_{}", quantity, name),
                       (*elements)[0]->unit,
                       std::vector<double>(columns.trials.size(), kNaN),
                       {}});
    }
    for (std::size_t k = 0; k < columns.trials.size(); ++k) {
      const Eigen::Matrix2d Z = matrix_at(*elements, k);
      if (!Z.allFinite()) continue;
      const double half = 0.5 * (Z(0, 0) + Z(1, 1)), off = 0.5 * (Z(0, 1) + Z(1, 0));
      const double radius = std::hypot(0.5 * (Z(0, 0) - Z(1, 1)), off);
      added[first].values[k] = half + radius;
      added[first + 1].values[k] = half - radius;
      added[first + 2].values[k] = off;
      added[first + 3].values[k] = 0.5 * (Z(0, 1) - Z(1, 0));
    }
  }
  for (store::OutcomeColumn& column : added) columns.outcomes.push_back(std::move(column));
}

std::vector<MatrixSpread> matrix_spreads(const store::OutcomeColumns& columns) {
  std::vector<MatrixSpread> spreads;
  for (std::size_t condition = 0; condition < columns.conditions.size(); ++condition) {
    for (const auto& [letter, quantity] : kMatrices) {
      const auto elements = elements_of(columns, letter);
      if (!elements) continue;
      const SessionMatrices matrices = session_matrices(columns, *elements, static_cast<int>(condition));
      if (matrices.sessions + matrices.left_out == 0) continue;
      MatrixSpread& spread = spreads.emplace_back(spread_of(matrices));
      spread.condition = columns.conditions[condition];
      spread.matrix = letter;
    }
  }
  return spreads;
}

}  // namespace mbk::statistics
