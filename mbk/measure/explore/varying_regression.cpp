#include "mbk/measure/explore/varying_regression.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "mbk/base/dsp/autoregression.h"
#include "mbk/base/numeric/dense.h"

namespace mbk::explore {
namespace {

constexpr Index kCells = 48;
constexpr Index kEven[] = {2, 3, 4, 6, 8, 12, 16, 24};  ///< intervals at equal distances that are tried
constexpr Index kRowsOfVarying = 5;
constexpr Index kMaxOrder = 25;
constexpr int kMoves = 24;
constexpr std::size_t kMaxFirstKnots = 11;  ///< knots from which moving them begins
constexpr double kMaxCellShare = 0.5;       ///< of what a function's rows tell, in any direction
constexpr double kMinInformation = 0.03;  ///< of what all rows tell, in the direction of which a function's tell least

/// Whitened products of all columns φ_j(s) z_k on the finest basis, of one output.
struct Products {
  Matrix gram;    ///< J p × J p
  Vector moment;  ///< J p
  double power = 0;
  Index rows = 0;
  Index reach = 0;  ///< functions apart that still share a row
};

Products fine_products(const VaryingRows& rows, Index output, const SplineBasis& fine, const Vector& filter) {
  const Index p = rows.Z.cols(), order = filter.size() - 1, width = fine.degree + 1;
  Products all{Matrix::Zero(fine.size() * p, fine.size() * p), Vector::Zero(fine.size() * p), 0.0, 0, 0};
  std::vector<ActiveSplines> active;
  active.reserve(static_cast<std::size_t>(rows.s.size()));
  for (const double s : rows.s) active.push_back(active_splines(fine, s));
  Vector w;
  for (const RowRange& range : rows.ranges) {
    for (Index t = range.begin + order; t < range.end; ++t) {
      Index low = fine.size(), high = 0;
      for (Index lag = 0; lag <= order; ++lag) {
        const Index first = active[static_cast<std::size_t>(t - lag)].first;
        low = std::min(low, first);
        high = std::max(high, first + width);
      }
      w.setZero((high - low) * p);
      double y = 0.0;
      for (Index lag = 0; lag <= order; ++lag) {
        const ActiveSplines& at = active[static_cast<std::size_t>(t - lag)];
        for (Index j = 0; j < width; ++j) {
          w.segment((at.first - low + j) * p, p) += filter[lag] * at.value[j] * rows.Z.row(t - lag).transpose();
        }
        y += filter[lag] * rows.Y(t - lag, output);
      }
      all.gram.block(low * p, low * p, w.size(), w.size()).selfadjointView<Eigen::Lower>().rankUpdate(w);
      all.moment.segment(low * p, w.size()) += y * w;
      all.power += y * y;
      all.reach = std::max(all.reach, high - low);
      ++all.rows;
    }
  }
  all.gram.triangularView<Eigen::StrictlyUpper>() = all.gram.transpose();
  return all;
}

/// The products of a coarser basis, (T ⊗ I) G (T ⊗ I)ᵀ.
Products coarser(const Products& fine, const Matrix& T, Index p) {
  const Index J = T.rows(), F = T.cols();
  Products coarse{Matrix::Zero(J * p, J * p), Vector::Zero(J * p), fine.power, fine.rows, J};
  constexpr double kNothing = 1e-13;
  for (Index a = 0; a < J; ++a) {
    Matrix half = Matrix::Zero(p, F * p);  // Σ_k T_ak G_k·
    for (Index k = 0; k < F; ++k) {
      if (std::abs(T(a, k)) < kNothing) continue;
      const Index low = std::max<Index>(0, k - fine.reach), high = std::min(F, k + fine.reach + 1);
      half.middleCols(low * p, (high - low) * p) += T(a, k) * fine.gram.block(k * p, low * p, p, (high - low) * p);
      coarse.moment.segment(a * p, p) += T(a, k) * fine.moment.segment(k * p, p);
    }
    for (Index b = 0; b <= a; ++b) {
      auto block = coarse.gram.block(a * p, b * p, p, p);
      for (Index l = 0; l < F; ++l) {
        if (std::abs(T(b, l)) >= kNothing) block += T(b, l) * half.middleCols(l * p, p);
      }
      if (b < a) coarse.gram.block(b * p, a * p, p, p) = block.transpose();
    }
  }
  return coarse;
}

/// The same products with constants apart: of the last `varying` columns on all functions, and of constants.
struct SplitProducts {
  Products varying;
  Matrix border;  ///< J v × c
  Matrix corner;  ///< c × c
  Vector moment;  ///< c
};

SplitProducts split(const Products& all, Index p, Index varying) {
  const Index J = all.gram.rows() / p, constants = p - varying;
  SplitProducts parts{{Matrix(J * varying, J * varying), Vector(J * varying), all.power, all.rows, all.reach},
                      Matrix::Zero(J * varying, constants),
                      Matrix::Zero(constants, constants),
                      Vector::Zero(constants)};
  for (Index a = 0; a < J; ++a) {
    parts.varying.moment.segment(a * varying, varying) = all.moment.segment(a * p + constants, varying);
    parts.moment += all.moment.segment(a * p, constants);
    for (Index b = 0; b < J; ++b) {
      const auto block = all.gram.block(a * p, b * p, p, p);
      parts.varying.gram.block(a * varying, b * varying, varying, varying) = block.bottomRightCorner(varying, varying);
      parts.border.middleRows(a * varying, varying) += block.bottomLeftCorner(varying, constants);
      parts.corner += block.topLeftCorner(constants, constants);
    }
  }
  return parts;
}

/// The coefficients of all functions from those that are free: first the constants, then those of each function.
Matrix folding(Index J, Index p, Index varying) {
  const Index constants = p - varying;
  Matrix fold = Matrix::Zero(J * p, constants + J * varying);
  for (Index j = 0; j < J; ++j) {
    fold.block(j * p, 0, constants, constants).setIdentity();
    fold.block(j * p + constants, constants + j * varying, varying, varying).setIdentity();
  }
  return fold;
}

/// The residual's sum of squares; absent if the columns are linearly dependent.
std::optional<double> rest_of(const Matrix& gram, const Vector& moment, double power) {
  const Vector scale = gram.diagonal().cwiseMax(0.0).cwiseSqrt();
  if (!(scale.minCoeff() > 0.0)) return std::nullopt;
  const Vector unit = scale.cwiseInverse();
  Matrix scaled = unit.asDiagonal() * gram * unit.asDiagonal();
  constexpr double kRidge = 1e-11;
  scaled.diagonal().array() += kRidge;
  const numeric::Cholesky factor(scaled);
  if (!factor.positive_definite()) return std::nullopt;
  const Vector right = unit.cwiseProduct(moment);
  const double rest = power - right.dot(factor.solve(right));
  return rest > 0.0 ? std::optional(rest) : std::nullopt;
}

/// The residual's sum of squares of constants and of functions of a coarser basis.
std::optional<double> rest_of(const SplitProducts& fine, const Matrix& T, Index varying) {
  const Products own = coarser(fine.varying, T, varying);
  const Index constants = fine.corner.rows(), functions = own.gram.rows();
  Matrix gram(constants + functions, constants + functions);
  gram.topLeftCorner(constants, constants) = fine.corner;
  gram.bottomRightCorner(functions, functions) = own.gram;
  for (Index a = 0; a < T.rows(); ++a) {
    Matrix border = Matrix::Zero(varying, constants);
    for (Index k = 0; k < T.cols(); ++k) border += T(a, k) * fine.border.middleRows(k * varying, varying);
    gram.block(constants + a * varying, 0, varying, constants) = border;
  }
  gram.topRightCorner(constants, functions) = gram.bottomLeftCorner(functions, constants).transpose();
  Vector moment(constants + functions);
  moment << fine.moment, own.moment;
  return rest_of(gram, moment, own.power);
}

/// How much the rows on which a function lives tell of each combination of the columns that vary first, but for the
/// constant. Between pulses, or while the limb is moved along one line, they do not tell all coefficients, and BIC
/// would choose functions that follow what one model leaves of a single pulse.
class Excitation {
 public:
  /// @param varying  of the last columns
  Excitation(const VaryingRows& rows, const SplineBasis& fine, Index varying) {
    const Index columns = varying - 1;
    const Matrix Z = rows.Z.middleCols(rows.Z.cols() - varying, columns);
    const numeric::Cholesky root(Z.transpose() * Z / static_cast<double>(Z.rows()));
    if (!root.positive_definite()) return;
    const Matrix upper = root.upper();  // UᵀU
    const Matrix even = upper.transpose().triangularView<Eigen::Lower>().solve(Z.transpose());
    share_ = Vector::Zero(fine.size());
    const Index cells = fine.size() - fine.degree;
    cells_.assign(static_cast<std::size_t>(cells),
                  std::vector<Matrix>(static_cast<std::size_t>(fine.degree) + 1, Matrix::Zero(columns, columns)));
    for (Index t = 0; t < Z.rows(); ++t) {
      const ActiveSplines active = active_splines(fine, rows.s[t]);
      for (Index j = 0; j <= fine.degree; ++j) {
        share_[active.first + j] += active.value[j];
        cells_[static_cast<std::size_t>(active.first)][static_cast<std::size_t>(j)] +=
            active.value[j] * even.col(t) * even.col(t).transpose();
      }
    }
    constexpr double kAtRest = 0.1;  // of the mean motion, and of the cells
    Index resting = 0;
    for (const auto& cell : cells_) {
      double motion = 0.0;
      for (const Matrix& one : cell) motion += one.trace();
      resting += motion < kAtRest * static_cast<double>(columns * Z.rows()) / static_cast<double>(cells) ? 1 : 0;
    }
    pulses_ = static_cast<double>(resting) > kAtRest * static_cast<double>(cells);
  }

  /// @param T  of a basis, its functions as sums of those of the fine one
  [[nodiscard]] bool tells(const Matrix& T) const {
    if (cells_.empty()) return false;
    for (Index j = 0; j < T.rows(); ++j) {
      std::vector<Matrix> of_cells;
      Matrix own = Matrix::Zero(cells_.front().front().rows(), cells_.front().front().cols());
      for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
        Matrix here = Matrix::Zero(own.rows(), own.cols());
        for (std::size_t k = 0; k < cells_[cell].size(); ++k) {
          here += T(j, static_cast<Index>(cell + k)) * cells_[cell][k];
        }
        own += here;
        of_cells.push_back(std::move(here));
      }
      const double share = T.row(j).dot(share_);
      if (!(numeric::symmetric_eigenvalues(own).minCoeff() >= kMinInformation * share)) return false;
      if (T.rows() > 1 && pulses_ && rests_on_one_cell(own, of_cells)) return false;
    }
    return true;
  }

 private:
  /// Whether in some direction one cell tells more than the others together, as a single pulse does.
  static bool rests_on_one_cell(const Matrix& own, const std::vector<Matrix>& of_cells) {
    const numeric::Cholesky root(own);
    if (!root.positive_definite()) return true;
    const Matrix upper = root.upper();
    return std::ranges::any_of(of_cells, [&](const Matrix& here) {
      const Matrix half = upper.transpose().triangularView<Eigen::Lower>().solve(here);
      const Matrix part = upper.transpose().triangularView<Eigen::Lower>().solve(half.transpose());
      return numeric::symmetric_eigenvalues(part).maxCoeff() > kMaxCellShare;
    });
  }

  Vector share_;         ///< Σ φ_k(s_t)
  bool pulses_ = false;  ///< the hand rests in between
  /// Σ φ_k(s_t) z zᵀ over each cell, of the functions that live there, in coordinates in which the mean of z zᵀ is I.
  std::vector<std::vector<Matrix>> cells_;
};

/// Compares bases.
class Chooser {
 public:
  /// @param least  number of last columns that vary
  Chooser(const VaryingRows& rows, const std::vector<Vector>& noise, int degree, Index least)
      : p_(rows.Z.cols()), fine_(even_splines(kCells, degree)), excitation_(rows, fine_, least) {
    for (Index i = 0; i < rows.Y.cols(); ++i) {
      fine_products_.push_back(fine_products(rows, i, fine_, noise[static_cast<std::size_t>(i)]));
    }
  }

  [[nodiscard]] ChosenSplines choose(const std::vector<Index>& varying) const {
    ChosenSplines chosen;
    chosen.model = {{0, {}}, p_};
    chosen.bic = chosen.bic_constant = bic(chosen.model.basis, 0, {p_}).front();
    chosen.bic_last = chosen.bic;
    std::vector<SplineBasis> candidates;
    for (int degree = 1; degree <= fine_.degree; ++degree) candidates.push_back({degree, {}});
    for (const Index intervals : kEven) candidates.push_back(even_splines(intervals, fine_.degree));
    std::vector<Index> all = varying;
    all.push_back(1);
    ChosenSplines few = chosen;
    for (const SplineBasis& basis : candidates) {
      const std::vector<double> found = bic(basis, 0, all);
      for (std::size_t k = 0; k < varying.size(); ++k) {
        take({basis, varying[k]}, found[k], chosen);
        if (basis.knots.size() <= kMaxFirstKnots) take({basis, varying[k]}, found[k], few);
      }
      chosen.bic_last = std::min(chosen.bic_last, found.back());
    }
    if (few.model.basis.degree == fine_.degree) {
      const SplineBasis basis = few.model.basis;
      few.bic = bic(basis, static_cast<Index>(basis.knots.size()), {few.model.varying}).front();
      refine(few, varying);
      take(few.model, few.bic, chosen);
    }
    return chosen;
  }

 private:
  void take(VaryingModel model, double bic, ChosenSplines& chosen) const {
    if (!(bic < chosen.bic)) return;
    if (!excitation_.tells(in_finer_splines(model.basis, fine_))) {
      chosen.bic_refused = std::min(chosen.bic_refused, bic);
      return;
    }
    chosen.bic = bic;
    chosen.model = std::move(model);
  }

  /// For each number of last columns that vary.   @param placed  knots whose places were chosen
  [[nodiscard]] std::vector<double> bic(const SplineBasis& basis, Index placed,
                                        const std::vector<Index>& varying) const {
    const Matrix T = in_finer_splines(basis, fine_);
    std::vector<double> all(varying.size(),
                            static_cast<double>(placed) * std::log(static_cast<double>(fine_products_.front().rows)));
    for (const Products& fine : fine_products_) {
      const auto rows = static_cast<double>(fine.rows);
      std::optional<Products> own;
      for (std::size_t k = 0; k < varying.size(); ++k) {
        const Index count = p_ + (T.rows() - 1) * varying[k];
        if (count * kRowsOfVarying > fine.rows || !std::isfinite(all[k])) {
          all[k] = std::numeric_limits<double>::infinity();
          continue;
        }
        if (!own) own = coarser(fine, T, p_);
        const Matrix fold = folding(T.rows(), p_, varying[k]);
        const auto rest = rest_of(fold.transpose() * own->gram * fold, fold.transpose() * own->moment, own->power);
        all[k] = rest ? all[k] + rows * std::log(*rest / rows) + static_cast<double>(count) * std::log(rows)
                      : std::numeric_limits<double>::infinity();
      }
    }
    return all;
  }

  /// As bic(), of one number of columns, which `parts` were split for.
  [[nodiscard]] double bic_of(const SplineBasis& basis, Index varying, const std::vector<SplitProducts>& parts) const {
    const Matrix T = in_finer_splines(basis, fine_);
    const auto rows = static_cast<double>(parts.front().varying.rows);
    const Index count = p_ + (T.rows() - 1) * varying;
    if (count * kRowsOfVarying > parts.front().varying.rows) return std::numeric_limits<double>::infinity();
    double sum = static_cast<double>(basis.knots.size()) * std::log(rows);
    for (const SplitProducts& one : parts) {
      const auto rest = rest_of(one, T, varying);
      if (!rest) return std::numeric_limits<double>::infinity();
      const auto own = static_cast<double>(one.varying.rows);
      sum += own * std::log(*rest / own) + static_cast<double>(count) * std::log(own);
    }
    return sum;
  }

  /// One knot or three neighbours more, or one less, whichever gains most; then other columns on the same knots.
  void refine(ChosenSplines& chosen, const std::vector<Index>& varying) const {
    std::vector<SplitProducts> parts;
    for (const Products& fine : fine_products_) parts.push_back(split(fine, p_, chosen.model.varying));
    for (int move = 0; move < kMoves; ++move) {
      ChosenSplines next = chosen;
      const auto consider = [&](std::vector<double> knots) {
        std::ranges::sort(knots);
        const VaryingModel model{{fine_.degree, std::move(knots)}, chosen.model.varying};
        take(model, bic_of(model.basis, model.varying, parts), next);
      };
      const std::vector<double>& knots = chosen.model.basis.knots;
      const auto has = [&](double knot) { return std::ranges::count(knots, knot) > 0; };
      for (std::size_t first = 0; first < fine_.knots.size(); ++first) {
        std::vector<double> more = knots;
        for (const std::size_t count : {1, 2, 3}) {  // a step takes three
          const std::size_t next_one = first + count - 1;
          if (next_one >= fine_.knots.size() || has(fine_.knots[next_one])) break;
          more.push_back(fine_.knots[next_one]);
          if (count != 2) consider(more);
        }
      }
      for (std::size_t k = 0; k < knots.size(); ++k) {
        std::vector<double> fewer = knots;
        fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
        consider(std::move(fewer));
      }
      if (!(next.bic < chosen.bic)) break;
      chosen = std::move(next);
    }
    const SplineBasis basis = chosen.model.basis;
    const std::vector<double> found = bic(basis, static_cast<Index>(basis.knots.size()), varying);
    for (std::size_t k = 0; k < varying.size(); ++k) take({basis, varying[k]}, found[k], chosen);
  }

  Index p_;
  SplineBasis fine_;
  Excitation excitation_;
  std::vector<Products> fine_products_;
};

}  // namespace

Matrix varying_columns(const Matrix& Z, const SplineBasis& basis, const Vector& s) {
  const Index p = Z.cols();
  Matrix columns = Matrix::Zero(Z.rows(), basis.size() * p);
  for (Index t = 0; t < Z.rows(); ++t) {
    const ActiveSplines active = active_splines(basis, s[t]);
    for (Index j = 0; j <= basis.degree; ++j) {
      columns.row(t).segment((active.first + j) * p, p) = active.value[j] * Z.row(t);
    }
  }
  return columns;
}

std::vector<Vector> noise_of(const VaryingRows& rows, const VaryingModel& model) {
  const Matrix Z =
      varying_columns(rows.Z, model.basis, rows.s) * folding(model.basis.size(), rows.Z.cols(), model.varying);
  const Matrix residual = rows.Y - Z * numeric::PivotedQr(Z).solve(rows.Y);
  std::vector<Vector> noise;
  for (Index i = 0; i < rows.Y.cols(); ++i) {
    std::vector<Vector> pieces;
    Index shortest = residual.rows();
    for (const RowRange& range : rows.ranges) {
      const Vector piece = residual.col(i).segment(range.begin, range.size());
      pieces.push_back(piece);
      shortest = std::min(shortest, range.size());
    }
    noise.push_back(dsp::autoregression(pieces, std::min(kMaxOrder, shortest / 3)));
  }
  return noise;
}

ChosenSplines choose_splines(const VaryingRows& rows, const std::vector<Vector>& noise,
                             const std::vector<Index>& varying) {
  ChosenSplines cubic = Chooser(rows, noise, 3, varying.front()).choose(varying);
  if (cubic.model.basis.size() == 1) return cubic;
  ChosenSplines straight = Chooser(rows, noise, 1, varying.front()).choose(varying);
  ChosenSplines& best = straight.bic < cubic.bic ? straight : cubic;
  best.bic_last = std::min(cubic.bic_last, straight.bic_last);
  return best;
}

VaryingFit fit_varying(const VaryingRows& rows, const VaryingModel& model, const std::vector<Vector>& noise) {
  const Matrix fold = folding(model.basis.size(), rows.Z.cols(), model.varying);
  const Matrix Z = varying_columns(rows.Z, model.basis, rows.s) * fold,
               R = varying_columns(rows.R, model.basis, rows.s) * fold;
  const Index p = Z.cols(), q = rows.Y.cols();
  VaryingFit fit;
  fit.coefficients.resize(fold.rows(), q);
  for (Index i = 0; i < q; ++i) {
    const Vector& filter = noise[static_cast<std::size_t>(i)];
    Matrix Zw = whitened(Z, filter, rows.ranges), Rw = whitened(R, filter, rows.ranges);
    const Vector scale = Zw.colwise().norm().cwiseInverse();
    Zw *= scale.asDiagonal();
    Rw *= scale.asDiagonal();
    const Vector y = whitened(rows.Y.col(i), filter, rows.ranges);
    const Matrix bread = numeric::inverse(Rw.transpose() * Zw);
    const Vector theta = bread * (Rw.transpose() * y);
    const Vector residual = y - Zw * theta;
    const auto count = static_cast<double>(Zw.rows());
    fit.freedom = count - static_cast<double>(p);
    const Matrix half = (residual.asDiagonal() * Rw) * bread.transpose() * scale.asDiagonal() * fold.transpose();
    fit.coefficients.col(i) = fold * scale.cwiseProduct(theta);
    fit.covariance.push_back(count / fit.freedom * (half.transpose() * half));
  }
  return fit;
}

}  // namespace mbk::explore
