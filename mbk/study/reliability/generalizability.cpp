#include "mbk/study/reliability/generalizability.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/study/reliability/heavy_tails.h"

namespace mbk::reliability {
namespace rater_model {

using enum FacetTerm;

/// Above 0, so that what a residual of 0 leaves can still be inverted; of the variance of all values.
constexpr double kMinResidual = 1e-10;

/// The trials of one person, rater and session.
struct RatingCell {
  int rater = 0, session = 0;  // from 0
  int trials = 0;
  double mean = 0.0;
};

/// The cells of one person, and how the values of each term agree in them.
struct PersonCells {
  std::vector<RatingCell> cells;
  Vector means;                   // c
  std::map<FacetTerm, Matrix> B;  // c×c: Z Zᵀ of the terms within people
};

/// Values less their mean, over their standard deviation.
struct RatingDesign {
  std::vector<PersonCells> people;
  int raters = 0, sessions = 0, cells = 0, rows = 0;
  double squares_within = 0.0;  // of trials about the means of their cells
  double log_trials = 0.0;      // Σ ln n of the cells
  double mean = 0.0, scale = 1.0;
};

bool is_crossed(FacetTerm term) {
  return term == rater || term == session || term == rater_session;
}

/// Numbers from 0 for any numbers.
std::map<int, int> places_of_levels(const std::vector<int>& levels) {
  std::map<int, int> places;
  for (const int one : levels) places.emplace(one, 0);
  int next = 0;
  for (auto& [level, place] : places) place = next++;
  return places;
}

RatingDesign rating_design(const Ratings& ratings, bool by_session) {
  RatingDesign design;
  const Index N = ratings.values.size();
  design.rows = static_cast<int>(N);
  design.mean = ratings.values.mean();
  design.scale = std::sqrt((ratings.values.array() - design.mean).square().sum() / static_cast<double>(N - 1));
  const auto raters = places_of_levels(ratings.raters), sessions = places_of_levels(ratings.sessions);
  design.raters = static_cast<int>(raters.size());
  design.sessions = by_session ? static_cast<int>(sessions.size()) : 1;
  std::map<int, std::map<std::pair<int, int>, std::vector<double>>> people;
  for (Index i = 0; i < N; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const int session = by_session ? sessions.at(ratings.sessions[k]) : 0;
    people[ratings.participants[k]][{raters.at(ratings.raters[k]), session}].push_back(
        (ratings.values[i] - design.mean) / design.scale);
  }
  for (const auto& [participant_number, cells] : people) {
    PersonCells& person = design.people.emplace_back();
    for (const auto& [key, values] : cells) {
      RatingCell cell{key.first, key.second, static_cast<int>(values.size()), 0.0};
      for (const double value : values) cell.mean += value / static_cast<double>(cell.trials);
      for (const double value : values) design.squares_within += (value - cell.mean) * (value - cell.mean);
      design.log_trials += std::log(cell.trials);
      person.cells.push_back(cell);
    }
    const auto c = static_cast<Index>(person.cells.size());
    design.cells += static_cast<int>(c);
    person.means.resize(c);
    for (const FacetTerm term :
         {participant, participant_rater, participant_session, participant_rater_session, residual}) {
      person.B[term] = Matrix::Zero(c, c);
    }
    for (Index i = 0; i < c; ++i) {
      const RatingCell& one = person.cells[static_cast<std::size_t>(i)];
      person.means[i] = one.mean;
      person.B[residual](i, i) = 1.0 / one.trials;
      for (Index k = 0; k < c; ++k) {
        const RatingCell& other = person.cells[static_cast<std::size_t>(k)];
        const bool same_rater = one.rater == other.rater, same_session = one.session == other.session;
        person.B[participant](i, k) = 1.0;
        person.B[participant_rater](i, k) = same_rater ? 1.0 : 0.0;
        person.B[participant_session](i, k) = same_session ? 1.0 : 0.0;
        person.B[participant_rater_session](i, k) = same_rater && same_session ? 1.0 : 0.0;
      }
    }
  }
  return design;
}

/// −2 ln of the restricted likelihood of the cells' means and of the trials about them, its gradient g by the variances
/// and its expected second derivatives H_kl = tr(P V_k P V_l), P = V⁻¹ − V⁻¹1(1ᵀV⁻¹1)⁻¹1ᵀV⁻¹.
///
/// V = D + U G Uᵀ, D a block for each person and U the levels of raters, sessions and both, G their variances. With
/// T = [1 U] and S = diag(1, √G), the mean is an effect of infinite variance:
///   P = D⁻¹ − D⁻¹ T S K⁻¹ S Tᵀ D⁻¹,  K = diag(0, I) + S TᵀD⁻¹T S,  ln|V| + ln|1ᵀV⁻¹1| = ln|D| + ln|K|
struct RestrictedLikelihood {
  double deviance = 0.0;
  double mean = 0.0;
  Vector g;
  Matrix H;
};

class RaterLikelihood {
 public:
  RaterLikelihood(const RatingDesign& design, std::vector<FacetTerm> terms)
      : design_(design), terms_(std::move(terms)) {
    Index next = 1;
    for (const FacetTerm term : terms_) {
      if (!is_crossed(term)) continue;
      first_[term] = next;
      next += term == rater ? design.raters : term == session ? design.sessions : design.raters * design.sessions;
    }
    width_ = next;
    for (const PersonCells& person : design.people) {
      Matrix& T = T_.emplace_back(Matrix::Zero(std::ssize(person.cells), width_));
      for (Index i = 0; i < T.rows(); ++i) {
        const RatingCell& cell = person.cells[static_cast<std::size_t>(i)];
        T(i, 0) = 1.0;
        for (const auto& [term, first] : first_) {
          const int level = term == rater     ? cell.rater
                            : term == session ? cell.session
                                              : cell.rater * design.sessions + cell.session;
          T(i, first + level) = 1.0;
        }
      }
    }
  }

  /// @param variances  of each term, ≥ 0; that of the residual > 0
  [[nodiscard]] RestrictedLikelihood at(const Vector& variances, bool with_derivatives) const {
    RestrictedLikelihood result;
    const auto count = static_cast<Index>(terms_.size());
    Vector S = Vector::Ones(width_), one = Vector::Ones(width_);
    one[0] = 0.0;
    double residual_variance = 0.0;
    for (Index k = 0; k < count; ++k) {
      const FacetTerm term = terms_[static_cast<std::size_t>(k)];
      if (is_crossed(term)) S.segment(first_.at(term), levels_of(term)).setConstant(std::sqrt(variances[k]));
      if (term == residual) residual_variance = variances[k];
    }
    std::vector<Matrix> inverses, W;
    std::vector<Vector> z;
    Matrix Q = Matrix::Zero(width_, width_);
    Vector b = Vector::Zero(width_);
    double quadratic = 0.0;
    for (std::size_t i = 0; i < design_.people.size(); ++i) {
      const PersonCells& person = design_.people[i];
      const Index c = person.means.size();
      Matrix D = Matrix::Zero(c, c);
      for (Index k = 0; k < count; ++k) {
        const FacetTerm term = terms_[static_cast<std::size_t>(k)];
        if (!is_crossed(term)) D += variances[k] * person.B.at(term);
      }
      const numeric::Cholesky factor(D);
      result.deviance += 2.0 * factor.upper().diagonal().array().log().sum();
      W.push_back(factor.solve(T_[i]));
      z.push_back(factor.solve(person.means));
      if (with_derivatives) inverses.push_back(factor.solve(Matrix(Matrix::Identity(c, c))));
      Q += T_[i].transpose() * W.back();
      b += T_[i].transpose() * z.back();
      quadratic += person.means.dot(z.back());
    }
    Matrix K = S.asDiagonal() * Q * S.asDiagonal();
    K.diagonal() += one;
    const numeric::Cholesky factor(K);
    const Vector Sb = S.cwiseProduct(b), x = factor.solve(Sb);
    const double within = design_.rows - design_.cells;
    result.deviance += 2.0 * factor.upper().diagonal().array().log().sum() + quadratic - Sb.dot(x);
    if (within > 0.0)
      result.deviance += within * std::log(residual_variance) + design_.squares_within / residual_variance;
    result.mean = x[0];
    if (!with_derivatives) return result;

    const Matrix kinv = factor.solve(Matrix(Matrix::Identity(width_, width_)));
    const Matrix SQ = S.asDiagonal() * Q;
    const Matrix TPT = Q - SQ.transpose() * kinv * SQ;
    const Vector TPy = b - SQ.transpose() * x;
    result.g = Vector::Zero(count);
    result.H = Matrix::Zero(count, count);
    std::vector<Matrix> sums(terms_.size(), Matrix::Zero(width_, width_));  // Σ AᵀBA of the terms within people
    for (std::size_t i = 0; i < design_.people.size(); ++i) {
      add_person(i, inverses[i], W[i] * S.asDiagonal(), z[i], W[i], kinv, SQ, x, sums, result);
    }
    for (Index k = 0; k < count; ++k) {
      const FacetTerm term = terms_[static_cast<std::size_t>(k)];
      if (!is_crossed(term)) {
        const Matrix left = kinv * sums[static_cast<std::size_t>(k)] * kinv;
        for (Index l = 0; l <= k; ++l) {
          if (is_crossed(terms_[static_cast<std::size_t>(l)])) continue;
          result.H(k, l) += left.cwiseProduct(sums[static_cast<std::size_t>(l)]).sum();
        }
        continue;
      }
      const Index first = first_.at(term), levels = levels_of(term);
      result.g[k] = TPT.diagonal().segment(first, levels).sum() - TPy.segment(first, levels).squaredNorm();
      for (Index l = 0; l <= k; ++l) {
        const FacetTerm other = terms_[static_cast<std::size_t>(l)];
        if (!is_crossed(other)) continue;
        result.H(k, l) += TPT.block(first, first_.at(other), levels, levels_of(other)).squaredNorm();
      }
    }
    for (Index k = 0; k < count; ++k) {
      if (terms_[static_cast<std::size_t>(k)] != residual) continue;
      result.g[k] += within / residual_variance - design_.squares_within / (residual_variance * residual_variance);
      result.H(k, k) += within / (residual_variance * residual_variance);
    }
    result.H = Matrix(result.H.selfadjointView<Eigen::Lower>());
    return result;
  }

 private:
  [[nodiscard]] Index levels_of(FacetTerm term) const {
    return term == rater     ? design_.raters
           : term == session ? design_.sessions
                             : Index(design_.raters) * design_.sessions;
  }

  /// What one person adds to the derivatives, but for what pairs of people share (`sums`).
  void add_person(std::size_t i, const Matrix& inverse, const Matrix& A, const Vector& z, const Matrix& W,
                  const Matrix& kinv, const Matrix& SQ, const Vector& x, std::vector<Matrix>& sums,
                  RestrictedLikelihood& result) const {
    const PersonCells& person = design_.people[i];
    const auto count = static_cast<Index>(terms_.size());
    const Matrix E = A * kinv * A.transpose(), P = inverse - E, PT = W - A * (kinv * SQ);
    const Vector u = z - A * x;
    std::vector<Matrix> PB(terms_.size()), EB(terms_.size());
    for (Index k = 0; k < count; ++k) {
      const auto at_k = static_cast<std::size_t>(k);
      if (is_crossed(terms_[at_k])) continue;
      const Matrix& B = person.B.at(terms_[at_k]);
      PB[at_k] = P * B;
      EB[at_k] = E * B;
      sums[at_k] += A.transpose() * B * A;
      result.g[k] += PB[at_k].trace() - u.dot(B * u);
      const Matrix BPT = B * PT;
      for (Index l = 0; l < count; ++l) {
        const FacetTerm other = terms_[static_cast<std::size_t>(l)];
        if (is_crossed(other)) {
          const Index first = first_.at(other), levels = levels_of(other);
          const double sum = PT.middleCols(first, levels).cwiseProduct(BPT.middleCols(first, levels)).sum();
          result.H(std::max(k, l), std::min(k, l)) += sum;
        } else if (l <= k) {
          const auto at_l = static_cast<std::size_t>(l);
          result.H(k, l) +=
              PB[at_k].cwiseProduct(PB[at_l].transpose()).sum() - EB[at_k].cwiseProduct(EB[at_l].transpose()).sum();
        }
      }
    }
  }

  const RatingDesign& design_;
  std::vector<FacetTerm> terms_;
  Index width_ = 1;
  std::map<FacetTerm, Index> first_;  // of the columns of T that are a term's levels
  std::vector<Matrix> T_;
};

/// Of the terms, in this order, those whose covariance is no combination of that of the ones before.
std::vector<FacetTerm> identifiable(const RatingDesign& design, const std::vector<FacetTerm>& wished) {
  constexpr double kDependent = 1e-7;
  const Matrix H =
      RaterLikelihood(design, wished).at(Vector::Ones(std::ssize(wished)) / static_cast<double>(wished.size()), true).H;
  std::vector<FacetTerm> kept;
  std::vector<Index> places;
  for (Index k = 0; k < H.rows(); ++k) {
    double left = H(k, k);
    if (!places.empty()) {
      const Matrix among = H(places, places);
      const Vector with = H(places, k);
      left -= with.dot(numeric::Cholesky(among).solve(with));
    }
    if (!(left > kDependent * H(k, k))) continue;
    places.push_back(k);
    kept.push_back(wished[static_cast<std::size_t>(k)]);
  }
  std::ranges::sort(kept);
  return kept;
}

/// A⁻¹ b for the entries where `free` is true; 0 elsewhere.
Vector solved_among(const Matrix& A, const Vector& b, const std::vector<bool>& free) {
  std::vector<Index> places;
  for (Index k = 0; k < b.size(); ++k) {
    if (free[static_cast<std::size_t>(k)]) places.push_back(k);
  }
  Vector x = Vector::Zero(b.size());
  if (places.empty()) return x;
  const Matrix part = A(places, places);
  const Vector solved = numeric::Cholesky(part).solve(Vector(b(places)));
  x(places) = solved;
  return x;
}

/// The variances of the largest likelihood, by Fisher scoring; those at their bound move only inwards.
Vector maximised(const RaterLikelihood& likelihood, const std::vector<FacetTerm>& terms) {
  constexpr int kMaxSteps = 500, kMaxHalvings = 40;
  constexpr double kConverged = 1e-12;
  const auto count = std::ssize(terms);
  Vector least = Vector::Zero(count);
  least[count - 1] = kMinResidual;  // the residual is the last one
  Vector variances = Vector::Constant(count, 1.0 / static_cast<double>(count));
  RestrictedLikelihood now = likelihood.at(variances, true);
  for (int step = 0; step < kMaxSteps; ++step) {
    std::vector<bool> free(terms.size());
    for (Index k = 0; k < count; ++k) free[static_cast<std::size_t>(k)] = variances[k] > least[k] || now.g[k] < 0.0;
    Vector direction = solved_among(now.H, -now.g, free);
    const double decrease = -now.g.dot(direction);
    if (!(decrease > kConverged)) return variances;
    bool moved = false;
    for (int attempt = 0; attempt < 2 && !moved; ++attempt) {
      for (double size = 1.0, halvings = 0; halvings < kMaxHalvings && !moved; size *= 0.5, ++halvings) {
        const Vector next = (variances + size * direction).cwiseMax(least);
        if (next == variances) break;
        if (likelihood.at(next, false).deviance >= now.deviance) continue;
        variances = next;
        moved = true;
      }
      // Scoring that is cut at bounds may lead uphill; along the gradient, scaled, it does not.
      for (Index k = 0; k < count; ++k)
        direction[k] = free[static_cast<std::size_t>(k)] ? -now.g[k] / now.H(k, k) : 0.0;
    }
    if (!moved) return variances;
    now = likelihood.at(variances, true);
  }
  return variances;
}

/// What is pooled into a term that is in the model.
std::vector<FacetTerm> pooled_into(FacetTerm term, const std::vector<FacetTerm>& terms, const RaterModel& model) {
  const auto missing = [&](FacetTerm one) { return std::ranges::find(terms, one) == terms.end(); };
  std::vector<FacetTerm> pooled;
  const bool separate = model.session_facet == SessionFacet::separate;
  if (model.session_facet == SessionFacet::confounded) {
    if (term == rater) pooled = {session};
    if (term == participant_rater) pooled = {participant_session};
  }
  if (model.session_facet == SessionFacet::too_few && model.sessions < 2) {
    if (term == participant) pooled = {participant_session};
    if (term == rater) pooled = {rater_session};
    if (term == participant_rater) pooled = {participant_rater_session};
  }
  if (term == residual && missing(participant_rater)) pooled = {participant_rater};
  if (term == residual && separate && missing(participant_rater_session)) pooled = {participant_rater_session};
  if (term == participant_session && missing(session)) pooled = {session};
  const FacetTerm last = missing(participant_rater_session) ? residual : participant_rater_session;
  if (separate && term == last && missing(rater_session)) pooled.push_back(rater_session);
  return pooled;
}

/// Counts of people, and whether sessions and trials can be facets at all.
void count_design(const Ratings& ratings, RaterModel& model) {
  std::map<int, std::set<int>> raters, sessions;
  std::set<int> all_raters, all_sessions;
  for (std::size_t k = 0; k < ratings.participants.size(); ++k) {
    raters[ratings.participants[k]].insert(ratings.raters[k]);
    sessions[ratings.participants[k]].insert(ratings.sessions[k]);
    all_raters.insert(ratings.raters[k]);
    all_sessions.insert(ratings.sessions[k]);
  }
  const auto several = [](const auto& of_people) {
    return static_cast<int>(std::ranges::count_if(of_people, [](const auto& one) { return one.second.size() >= 2; }));
  };
  model.participants = static_cast<int>(raters.size());
  model.raters = static_cast<int>(all_raters.size());
  model.sessions = static_cast<int>(all_sessions.size());
  model.rows = static_cast<int>(ratings.values.size());
  model.repeated_participants = several(raters);
  if (several(sessions) >= kMinPeople) model.session_facet = SessionFacet::separate;
  if (model.repeated_participants < kMinPeople) model.support = Support::too_few_raters;
  if (model.participants < kMinPeople) model.support = Support::too_few_people;
}

/// The terms that the design tells of. Sessions that raters do not share are no facet; their cells are then joined.
std::vector<FacetTerm> terms_of(const Ratings& ratings, RatingDesign& design, RaterModel& model) {
  const auto wished = [&] {
    model.has_trials = design.rows - design.cells >= kMinPeople;
    std::vector<FacetTerm> terms = {residual, participant, rater};
    if (model.session_facet == SessionFacet::separate) {
      terms.insert(terms.end(), {participant_rater, participant_session, session, rater_session});
      if (model.has_trials) terms.push_back(participant_rater_session);
    } else if (model.has_trials) {
      terms.push_back(participant_rater);
    }
    return terms;
  };
  std::vector<FacetTerm> terms = identifiable(design, wished());
  const bool confounded =
      model.session_facet == SessionFacet::separate && std::ranges::find(terms, participant_session) == terms.end();
  if (!confounded) return terms;
  model.session_facet = SessionFacet::confounded;
  design = rating_design(ratings, false);
  return identifiable(design, wished());
}

/// Of each term, its share in the mean over a person's cells, averaged over people; 0 for what all people share.
Vector shares_of_person_mean(const RatingDesign& design, const std::vector<FacetTerm>& terms) {
  Vector shares = Vector::Zero(std::ssize(terms));
  for (const PersonCells& person : design.people) {
    const auto c = static_cast<double>(person.cells.size());
    for (Index k = 0; k < shares.size(); ++k) {
      const FacetTerm term = terms[static_cast<std::size_t>(k)];
      if (!is_crossed(term)) shares[k] += person.B.at(term).sum() / (c * c * static_cast<double>(design.people.size()));
    }
  }
  return shares;
}

/// By how much averaging divides the variance of a term.
double divisor(FacetTerm term, const Averaged& averaged) {
  const double R = averaged.raters, S = averaged.sessions;
  switch (term) {
    case participant:
      return 1.0;
    case rater:
    case participant_rater:
      return R;
    case session:
    case participant_session:
      return S;
    case rater_session:
    case participant_rater_session:
      return R * S;
    case residual:
      return R * S * averaged.trials;
  }
  return 1.0;
}

/// The weights of variances in an error.
template <class Counts>
Vector error_weights(const RaterModel& model, const Averaged& averaged, const Counts& counts) {
  Vector weights = Vector::Zero(std::ssize(model.variances));
  for (Index k = 0; k < weights.size(); ++k) {
    const FacetTerm term = model.variances[static_cast<std::size_t>(k)].term;
    if (term != participant && counts(term)) weights[k] = 1.0 / divisor(term, averaged);
  }
  return weights;
}

/// Satterthwaite's degrees of freedom of a variance cᵀσ².
double degrees_of(const RaterModel& model, const Vector& weights, double variance) {
  return 2.0 * variance * variance / weights.dot(model.covariance * weights);
}

AveragedError error_by(const RaterModel& model, const Vector& weights, const Vector& variances) {
  AveragedError error;
  const double variance = weights.dot(variances);
  error.sem = std::sqrt(variance);
  constexpr double kChange = kPublishedNormal95 * std::numbers::sqrt2;
  error.mdc95 = kChange * error.sem;
  if (!(variance > 0.0)) return error;
  const double degrees = degrees_of(model, weights, variance);
  const auto end = [&](double p) { return error.sem * std::sqrt(degrees / numeric::chi_square_quantile(p, degrees)); };
  error.sem95 = widened_for_tails(error.sem, {end(1.0 - kTail95), end(kTail95)});
  error.mdc95_interval = {kChange * error.sem95.first, kChange * error.sem95.second};
  return error;
}

/// σ_p²/(σ_p² + error) and its interval.
std::pair<double, Interval> coefficient_by(const RaterModel& model, const Vector& weights, const Vector& variances) {
  const double people = variances[0], error = weights.dot(variances);
  if (!(error > 0.0)) return {people > 0.0 ? 1.0 : kNaN, {kNaN, kNaN}};
  Vector beside = model.of_person_mean;  // what the means of people hold beside σ_p²
  beside[0] = 0.0;
  const double rest = beside.dot(variances), of_means = people + rest;
  const Vector expected = beside + people / error * weights;
  const double first = degrees_of(model, model.of_person_mean, of_means);
  const double second = degrees_of(model, expected, expected.dot(variances));
  const auto coefficient = [&](double F) {
    const double odds = std::max((of_means / F - rest) / error, 0.0);
    return odds / (1.0 + odds);
  };
  return {people / (people + error),
          {coefficient(numeric::f_quantile(1.0 - kTail95, first, second)),
           coefficient(1.0 / numeric::f_quantile(1.0 - kTail95, second, first))}};
}

}  // namespace rater_model

Result<RaterModel> fit_raters(const Ratings& ratings) {
  using namespace rater_model;
  const auto N = static_cast<std::size_t>(ratings.values.size());
  if (ratings.participants.size() != N || ratings.raters.size() != N || ratings.sessions.size() != N) {
    return bad_data("values, participants, raters and sessions have different lengths", "give one of each per row");
  }
  if (const Index at = first_non_finite(ratings.values); at >= 0) {
    return bad_data(fmt::format("value {} is not finite", at + 1), "leave out what is missing");
  }
  RaterModel model;
  count_design(ratings, model);
  if (model.support != Support::enough) return model;
  RatingDesign design = rating_design(ratings, model.session_facet == SessionFacet::separate);
  const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * ratings.values.cwiseAbs().maxCoeff();
  if (!(design.scale > rounding)) {
    model.support = Support::no_variation;
    return model;
  }
  const std::vector<FacetTerm> terms = terms_of(ratings, design, model);
  const RaterLikelihood likelihood(design, terms);
  const Vector variances = maximised(likelihood, terms);
  const RestrictedLikelihood fit = likelihood.at(variances, true);
  const double square = design.scale * design.scale;
  model.covariance = 2.0 * square * square * numeric::inverse(fit.H);
  model.mean = design.mean + design.scale * fit.mean;
  model.deviance = fit.deviance + design.log_trials +
                   static_cast<double>(design.rows - 1) * std::log(2.0 * std::numbers::pi * square);
  model.of_person_mean = shares_of_person_mean(design, terms);
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const auto i = static_cast<Index>(k);
    const double value = terms[k] == residual && variances[i] <= kMinResidual ? 0.0 : variances[i];
    model.variances.push_back(
        {terms[k], square * value, std::sqrt(model.covariance(i, i)), pooled_into(terms[k], terms, model)});
  }
  return model;
}

Result<Generalizability> generalizability(const RaterModel& model, const Averaged& averaged) {
  using namespace rater_model;
  if (averaged.raters < 1 || averaged.sessions < 1 || averaged.trials < 1) {
    return bad_usage("a mean is over at least one rater, session and trial", "give numbers from 1");
  }
  Generalizability result;
  result.averaged = averaged;
  result.support = model.support;
  const bool separate = model.session_facet == SessionFacet::separate;
  if (result.support == Support::enough && averaged.trials > 1 && !model.has_trials) {
    result.support = Support::too_few_trials;
  }
  if (result.support == Support::enough && averaged.sessions > 1 && !separate) {
    result.support = Support::too_few_sessions;
  }
  if (result.support != Support::enough) return result;
  Vector variances(std::ssize(model.variances));
  for (Index k = 0; k < variances.size(); ++k) variances[k] = model.variances[static_cast<std::size_t>(k)].value;
  const Vector relative = error_weights(model, averaged, [](FacetTerm term) { return !is_crossed(term); });
  const Vector absolute = error_weights(model, averaged, [](FacetTerm) { return true; });
  std::tie(result.relative, result.relative95) = coefficient_by(model, relative, variances);
  std::tie(result.absolute, result.absolute95) = coefficient_by(model, absolute, variances);
  result.relative_error = error_by(model, relative, variances);
  result.absolute_error = error_by(model, absolute, variances);
  if (!separate) return result;
  const auto changes = [](FacetTerm term) { return term != rater && term != participant_rater; };
  result.same_raters = error_by(model, error_weights(model, averaged, changes), variances);
  return result;
}

}  // namespace mbk::reliability
