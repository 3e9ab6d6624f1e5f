// What follows from the elements of matrices: their further numbers, and the distances between them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/study/reliability/axial.h"
#include "mbk/study/statistics/outcome_rows.h"

namespace mbk::statistics {
namespace {

struct NamedMatrix {
  const char *letter, *quantity;
};
constexpr std::array kMatrices = {NamedMatrix{"M", "inertia"}, NamedMatrix{"B", "damping"},
                                  NamedMatrix{"K", "stiffness"}};

/// The columns of a matrix row by row: xx xy yx yy, or nine if any result has three axes; nothing where one is missing.
using Elements = std::vector<const store::OutcomeColumn*>;

Elements elements_of(const store::OutcomeColumns& columns, const char* letter) {
  const auto column = [&](char row, char col) -> const store::OutcomeColumn* {
    const auto found =
        std::ranges::find(columns.outcomes, fmt::format("{}_{}{}", letter, row, col), &store::OutcomeColumn::name);
    return found == columns.outcomes.end() ? nullptr : &*found;
  };
  const std::string_view axes = column('z', 'z') == nullptr ? "xy" : "xyz";
  Elements elements;
  for (const char row : axes) {
    for (const char col : axes) elements.push_back(column(row, col));
  }
  return std::ranges::find(elements, nullptr) == elements.end() ? elements : Elements();
}

/// NaN where an element is missing: of a study with three axes, a result with two has none.
Matrix matrix_at(const Elements& elements, std::size_t trial) {
  const Index n = elements.size() == 4 ? 2 : 3;
  Matrix Z(n, n);
  for (Index k = 0; k < n * n; ++k) Z(k / n, k % n) = elements[static_cast<std::size_t>(k)]->values[trial];
  return Z;
}

/// 1e-12 of the largest possible determinant is rounding.
bool is_positive_definite(const Matrix& Z) {
  if (Z.rows() == 2) {
    const double off = 0.5 * (Z(0, 1) + Z(1, 0));
    return Z(0, 0) > 0.0 && Z(0, 0) * Z(1, 1) - off * off > 1e-12 * Z(0, 0) * Z(1, 1);
  }
  const Vector eigenvalues = numeric::symmetric_eigenvalues(impedance::symmetric_part(Z));
  return eigenvalues.minCoeff() > 1e-12 * eigenvalues.cwiseAbs().maxCoeff();
}

/// Names of the numbers that follow from a matrix.
constexpr std::array kPlanarNumbers = {"lambda_max", "lambda_min", "symmetric_xy", "antisymmetric"};
constexpr std::array kSpatialNumbers = {"lambda_max",      "lambda_mid",      "lambda_min",
                                        "symmetric_xy",    "symmetric_xz",    "symmetric_yz",
                                        "antisymmetric_x", "antisymmetric_y", "antisymmetric_z"};

Vector numbers_of(const Matrix& Z) {
  if (Z.rows() == 2) {
    const double half = 0.5 * (Z(0, 0) + Z(1, 1)), off = 0.5 * (Z(0, 1) + Z(1, 0));
    const double radius = std::hypot(0.5 * (Z(0, 0) - Z(1, 1)), off);
    return Eigen::Vector4d(half + radius, half - radius, off, 0.5 * (Z(0, 1) - Z(1, 0)));
  }
  const Matrix S = impedance::symmetric_part(Z);
  Vector numbers(std::ssize(kSpatialNumbers));
  numbers << numeric::symmetric_eigenvalues(S).reverse(), S(0, 1), S(0, 2), S(1, 2), impedance::antisymmetric_vector(Z);
  return numbers;
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
  Matrix sum;
  int count = 0;
  std::int64_t participant = 0, session = 0, person_of_last = 0;
  const auto close = [&] {
    if (count == 0) return;
    const Matrix mean = sum / count;
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
    const Matrix Z = matrix_at(elements, k);
    if (!Z.allFinite()) continue;
    if (trial.participant != participant || trial.session != session) close();
    participant = trial.participant;
    session = trial.session;
    if (count == 0) {
      sum = Z;
    } else {
      sum += Z;
    }
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
    const Elements elements = elements_of(columns, letter);
    if (elements.empty()) continue;
    const std::size_t first = added.size();
    const auto names = elements.size() == 4 ? std::span<const char* const>(kPlanarNumbers)
                                            : std::span<const char* const>(kSpatialNumbers);
    for (const char* name : names) {
      added.push_back({fmt::format("{}_{}", quantity, name),
                       elements[0]->unit,
                       std::vector<double>(columns.trials.size(), kNaN),
                       {}});
    }
    for (std::size_t k = 0; k < columns.trials.size(); ++k) {
      const Matrix Z = matrix_at(elements, k);
      if (!Z.allFinite()) continue;
      const Vector numbers = numbers_of(Z);
      for (std::size_t i = 0; i < names.size(); ++i) added[first + i].values[k] = numbers[static_cast<Index>(i)];
    }
  }
  for (store::OutcomeColumn& column : added) columns.outcomes.push_back(std::move(column));
}

std::vector<MatrixSpread> matrix_spreads(const store::OutcomeColumns& columns) {
  std::vector<MatrixSpread> spreads;
  for (std::size_t condition = 0; condition < columns.conditions.size(); ++condition) {
    for (const auto& [letter, quantity] : kMatrices) {
      const Elements elements = elements_of(columns, letter);
      if (elements.empty()) continue;
      const SessionMatrices matrices = session_matrices(columns, elements, static_cast<int>(condition));
      if (matrices.sessions + matrices.left_out == 0) continue;
      MatrixSpread& spread = spreads.emplace_back(spread_of(matrices));
      spread.condition = columns.conditions[condition];
      spread.matrix = letter;
    }
  }
  return spreads;
}

}  // namespace mbk::statistics
