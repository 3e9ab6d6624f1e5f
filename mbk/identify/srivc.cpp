#include "mbk/identify/srivc.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/dsp/derivative_filter.h"
#include "mbk/identify/autoregression.h"
#include "mbk/numeric/least_squares.h"
#include "mbk/numeric/parallel.h"
#include "mbk/numeric/polynomial_roots.h"

namespace mbk::identify {
namespace {

constexpr Index kBlock = 256;
constexpr Index kMostPoles = 20;

double step_of(const SignalPair& pair, Index i) {
  return pair.step ? *pair.step : pair.time[i] - pair.time[i - 1];
}

/// The states of a filter over samples [begin, begin + count) of an experiment.
class Pass {
 public:
  Pass(const Vector& a, const SignalPair& pair, double scale) : filter_(a), pair_(pair), scale_(scale) {}
  void start_at(const Vector& state) { filter_.set_state(state); }

  /// @param input the samples of the block    @param states n rows, count columns
  void run(Index begin, Index count, const double* input, Eigen::Ref<Matrix, 0, Eigen::OuterStride<>> states) {
    Index i = 0;
    if (begin == 0) {
      states.col(0) = filter_.state();
      filter_.begin(input[0]);
      i = 1;
    }
    if (pair_.step) {
      if (count > i) filter_.run(scale_ * *pair_.step, input + i, count - i, states.middleCols(i, count - i));
      return;
    }
    for (; i < count; ++i) {
      filter_.run(scale_ * step_of(pair_, begin + i), input + i, 1, states.middleCols(i, 1));
    }
  }

 private:
  dsp::DerivativeFilter filter_;
  const SignalPair& pair_;
  double scale_;
};

/// A₀…, and the model in time scaled by `scale`, t′ = scale·t.
struct Iterate {
  double scale = 1.0;
  Vector a, b;
  std::vector<Vector> free;  ///< C and the offset, of each experiment

  void rescale() {
    const auto n = static_cast<double>(a.size());
    const double factor = std::pow(std::abs(a[0]), 1.0 / n);
    if (!(factor > 0.0) || !std::isfinite(factor)) return;
    for (Index k = 0; k < a.size(); ++k) a[k] /= std::pow(factor, n - static_cast<double>(k));
    for (Index k = 0; k < b.size(); ++k) b[k] /= std::pow(factor, n - static_cast<double>(k));
    for (Vector& c : free) {
      for (Index k = 0; k < a.size(); ++k) c[k] /= std::pow(factor, n - 1.0 - static_cast<double>(k));
    }
    scale *= factor;
  }
  [[nodiscard]] Vector theta() const {
    Vector both(a.size() + b.size());
    both << a, b;
    return both;
  }
  /// What the coefficients are to be multiplied with for time in seconds.
  [[nodiscard]] Vector to_seconds() const {
    const auto n = static_cast<double>(a.size());
    Vector factors(a.size() + b.size());
    for (Index k = 0; k < a.size(); ++k) factors[k] = std::pow(scale, n - static_cast<double>(k));
    for (Index k = 0; k < b.size(); ++k) factors[a.size() + k] = std::pow(scale, n - static_cast<double>(k));
    return factors;
  }
  [[nodiscard]] Vector physical() const { return theta().cwiseProduct(to_seconds()); }
};

/// Where the rows of a block stand.
struct Layout {
  Index n, q;                         ///< poles; coefficients of the numerator
  bool instruments, reference, free;  ///< present
  [[nodiscard]] Index x() const { return 0; }
  [[nodiscard]] Index z() const { return n + q; }  ///< of x̂; then those of u where they differ
  [[nodiscard]] Index z_size() const { return !instruments ? 0 : (reference ? n + q : n); }
  [[nodiscard]] Index free_at() const { return z() + z_size(); }
  [[nodiscard]] Index free_size() const { return free ? n + 1 : 0; }
  [[nodiscard]] Index e() const { return free_at() + free_size(); }
  [[nodiscard]] Index rows() const { return e() + 1; }
  /// Rows that are Z, in the order of [a, b].
  [[nodiscard]] std::vector<Index> z_rows() const {
    std::vector<Index> rows_of(static_cast<std::size_t>(n + q));
    for (Index k = 0; k < n + q; ++k) {
      rows_of[static_cast<std::size_t>(k)] = !instruments ? k : (k < n || reference ? z() + k : k);
    }
    return rows_of;
  }
};

/// One experiment's rows with the free motion projected out.
struct Reduced {
  Matrix M, S;                  ///< ZᵀX, ZᵀZ
  Vector g;                     ///< Zᵀe
  double ee = 0;                ///< eᵀe
  Matrix free_of_x, free_of_z;  ///< (NᵀN)⁺NᵀX, (NᵀN)⁺NᵀZ
  Vector free_of_e;             ///< (NᵀN)⁺Nᵀe
};

/// Pseudo-inverse of a Gram matrix, columns scaled to unit length.
Matrix pseudo_inverse(const Matrix& gram) {
  constexpr double kSmall = 1e-13;
  Vector scale = gram.diagonal().cwiseSqrt();
  for (double& s : scale) s = s > 0.0 ? 1.0 / s : 0.0;
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scale.asDiagonal() * gram * scale.asDiagonal());
  const double least = kSmall * std::max(eigen.eigenvalues().maxCoeff(), 0.0);
  Vector inverse = eigen.eigenvalues();
  for (double& value : inverse) value = value > least ? 1.0 / value : 0.0;
  return scale.asDiagonal() * eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose() *
         scale.asDiagonal();
}

Reduced reduce(const Matrix& gram, const Layout& at) {
  const Index p = at.n + at.q, f = at.free_size();
  const std::vector<Index> z = at.z_rows();
  Reduced r;
  r.M = gram(z, Eigen::seqN(0, p));
  r.S = gram(z, z);
  r.g = gram(z, at.e());
  r.ee = gram(at.e(), at.e());
  if (f == 0) return r;
  const auto free = Eigen::seqN(at.free_at(), f);
  const Matrix inverse = pseudo_inverse(gram(free, free));
  const Matrix NZ = gram(free, z), NX = gram(free, Eigen::seqN(0, p));
  const Vector Ne = gram(free, at.e());
  r.free_of_x = inverse * NX;
  r.free_of_z = inverse * NZ;
  r.free_of_e = inverse * Ne;
  r.M -= NZ.transpose() * r.free_of_x;
  r.S -= NZ.transpose() * r.free_of_z;
  r.g -= NZ.transpose() * r.free_of_e;
  r.ee -= Ne.dot(r.free_of_e);
  return r;
}

/// Everything that a pass over the data adds up.
struct Sums {
  Matrix M, S;
  Vector g, x_squares;
  double ee = 0;
  Index samples = 0;
  std::vector<Reduced> each;
};

class Fitter {
 public:
  Fitter(const std::vector<SignalPair>& experiments, const ContinuousFitOptions& options)
      : experiments_(experiments), options_(options), n_(options.poles), q_(options.zeros + 1) {}

  Result<ContinuousFit> run();

 private:
  struct Search {
    SearchStart start;
    Iterate at;
    Vector noise = Vector::Ones(1);
    double variance = std::numeric_limits<double>::infinity();
    Sums last;  ///< at the end
  };

  [[nodiscard]] Result<void> check() const;
  [[nodiscard]] std::vector<double> start_poles() const;
  [[nodiscard]] Search search(double pole) const;
  void iterate(Search& found) const;
  bool step(Search& found, double& change) const;

  /// Calls use(begin, count, rows) for the blocks of one experiment.
  template <class Use>
  void blocks(std::size_t experiment, const Iterate& at, const Layout& layout, const Vector& noise, Use&& use) const;
  [[nodiscard]] Sums sums(const Iterate& at, const Layout& layout, const Vector& noise) const;
  [[nodiscard]] std::vector<Vector> residuals(const Iterate& at) const;
  [[nodiscard]] Layout layout(bool instruments) const {
    return {n_, q_, instruments, instruments && options_.reference_instruments, options_.free_start};
  }
  void take_covariance(const Search& best, ContinuousFit& made) const;

  const std::vector<SignalPair>& experiments_;
  const ContinuousFitOptions& options_;
  Index n_, q_;
  std::vector<Vector> clean_input_;  ///< û, where the reference is the instrument
  double output_squares_ = 0;        ///< Σ(y − ȳ)²
  Index samples_ = 0;
};

template <class Use>
void Fitter::blocks(std::size_t experiment, const Iterate& at, const Layout& layout, const Vector& noise,
                    Use&& use) const {
  const SignalPair& pair = experiments_[experiment];
  const Index total = pair.time.size(), order = noise.size() - 1;
  Pass y(at.a, pair, at.scale), u(at.a, pair, at.scale), x(at.a, pair, at.scale), v(at.a, pair, at.scale),
      free(at.a, pair, at.scale);
  free.start_at(Vector::Unit(n_, n_ - 1));
  const Vector none = Vector::Zero(layout.free ? kBlock : 0);
  const Vector* const c = layout.free && experiment < at.free.size() ? &at.free[experiment] : nullptr;
  Matrix rows = Matrix::Zero(layout.rows(), order + kBlock), input(n_, kBlock), filtered;
  Vector clean(kBlock);
  for (Index begin = 0; begin < total; begin += kBlock) {
    const Index count = std::min(kBlock, total - begin);
    auto now = rows.middleCols(order, count);
    const auto from = [&](const Vector& signal) { return signal.data() + begin; };
    /// sᵏ/A, k = 0 … q − 1, of which the n-th is the signal itself less the others.
    const auto take_input = [&](Pass& pass, const double* signal, Index row) {
      pass.run(begin, count, signal, input.leftCols(count));
      now.middleRows(row, std::min(q_, n_)) = input.leftCols(count).topRows(std::min(q_, n_));
      if (q_ <= n_) return;
      now.row(row + n_) =
          Eigen::Map<const Eigen::RowVectorXd>(signal, count) - at.a.transpose() * input.leftCols(count);
    };
    y.run(begin, count, from(pair.output), now.topRows(n_));
    now.topRows(n_) = -now.topRows(n_);
    take_input(u, from(pair.input), n_);
    if (layout.free) {
      free.run(begin, count, none.data(), now.middleRows(layout.free_at(), n_));
      now.row(layout.free_at() + n_).setOnes();
    }
    now.row(layout.e()) = pair.output.segment(begin, count).transpose();
    if (at.b.size() > 0) {
      now.row(layout.e()).noalias() -= at.b.transpose() * now.middleRows(n_, q_);
      if (layout.instruments) {
        if (layout.reference) {
          take_input(v, from(clean_input_[experiment]), layout.z() + n_);
          clean.head(count).noalias() = now.middleRows(layout.z() + n_, q_).transpose() * at.b;
        } else {
          clean.head(count).noalias() = now.middleRows(n_, q_).transpose() * at.b;
          if (c != nullptr) {
            clean.head(count).noalias() += now.middleRows(layout.free_at(), n_).transpose() * c->head(n_);
          }
        }
        x.run(begin, count, clean.data(), now.middleRows(layout.z(), n_));
        now.middleRows(layout.z(), n_) = -now.middleRows(layout.z(), n_);
      }
    }
    if (order == 0) {
      use(begin, count, now);
      continue;
    }
    filtered = now;
    for (Index j = 1; j <= order; ++j) filtered += noise[j] * rows.middleCols(order - j, count);
    const Index skip = begin == 0 ? std::min(order, count) : 0;  // before there is a past
    use(begin + skip, count - skip, filtered.rightCols(count - skip));
    rows.leftCols(order) = rows.middleCols(count, order).eval();
  }
}

Sums Fitter::sums(const Iterate& at, const Layout& layout, const Vector& noise) const {
  const Index p = n_ + q_;
  Sums all{Matrix::Zero(p, p), Matrix::Zero(p, p), Vector::Zero(p), Vector::Zero(p), 0.0, 0, {}};
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    Matrix gram = Matrix::Zero(layout.rows(), layout.rows());
    blocks(k, at, layout, noise, [&](Index, Index count, const auto& rows) {
      gram.selfadjointView<Eigen::Lower>().rankUpdate(rows);
      all.samples += count;
    });
    gram = gram.selfadjointView<Eigen::Lower>();
    Reduced one = reduce(gram, layout);
    all.M += one.M;
    all.S += one.S;
    all.g += one.g;
    all.ee += one.ee;
    all.x_squares += gram.diagonal().head(p);
    all.each.push_back(std::move(one));
  }
  return all;
}

/// (ZᵀX)⁻¹ with both scaled to unit length; not finite where it is singular.
Vector solved(const Sums& sums) {
  const Vector x = sums.x_squares.cwiseSqrt().cwiseInverse(), z = sums.S.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix scaled = z.asDiagonal() * sums.M * x.asDiagonal();
  return x.asDiagonal() * scaled.colPivHouseholderQr().solve(z.asDiagonal() * sums.g);
}

/// Roots on the right half plane are reflected; false where there was one.
bool stabilise(Vector& a) {
  if (!a.allFinite()) return false;
  Vector monic(a.size() + 1);
  monic << a, 1.0;
  Eigen::VectorXcd roots = numeric::polynomial_roots(monic);
  bool stable = true;
  constexpr double kLeastDamping = 1e-7;  // of a root that is put back
  for (auto& root : roots) {
    if (root.real() < 0.0) continue;
    stable = false;
    root.real(-std::max(root.real(), kLeastDamping * std::abs(root)));
  }
  if (!stable) a = numeric::monic_from_roots(roots);
  return stable;
}

bool Fitter::step(Search& found, double& change) const {
  const bool first = found.at.b.size() == 0;
  const Layout rows = layout(!first);
  const Sums now = sums(found.at, rows, found.noise);
  const Vector delta = solved(now);
  if (!delta.allFinite()) return false;
  const Vector old = first ? Vector(Vector::Zero(n_ + q_)) : found.at.theta();
  for (std::size_t k = 0; k < experiments_.size() && options_.free_start; ++k) {
    found.at.free.resize(experiments_.size());
    found.at.free[k] = now.each[k].free_of_e - now.each[k].free_of_x * delta;
  }
  found.at.a += delta.head(n_);
  found.at.b = (first ? Vector(Vector::Zero(q_)) : found.at.b) + delta.tail(q_);
  found.start.stable = stabilise(found.at.a);
  if (!found.at.a.allFinite() || !found.at.b.allFinite()) return false;
  // A coefficient that noise leaves undecided is not asked to stand still beyond its own error.
  const double variance = now.ee / static_cast<double>(std::max<Index>(now.samples - n_ - q_, 1));
  const Vector least = now.S.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse().cwiseSqrt() *
                       std::sqrt(std::max(variance, 0.0));
  change = ((found.at.theta() - old).array().abs() / found.at.theta().array().abs().max(least.array())).maxCoeff();
  found.at.rescale();
  return std::isfinite(change);
}

/// Until the coefficients stand still.
void Fitter::iterate(Search& found) const {
  constexpr double kRounding = 1e-11;
  double change = std::numeric_limits<double>::infinity(), least = change;
  bool settled = false;
  found.start.converged = false;
  for (int pass = 0; pass < options_.most_iterations; ++pass) {
    ++found.start.iterations;
    if (!step(found, change)) return;
    if (settled && change >= 0.5 * least) break;
    settled = settled || (change < options_.tolerance && found.start.stable);
    least = std::min(least, change);
    if (settled && (!options_.refine || change < kRounding)) break;
  }
  found.start.converged = settled && found.start.stable && change < options_.tolerance;
}

Fitter::Search Fitter::search(double pole) const {
  Search found;
  found.start.pole = pole;
  found.at.scale = pole;
  found.at.a = numeric::monic_from_roots(Eigen::VectorXcd::Constant(n_, -1.0));
  double change = 0.0;
  found.start.iterations = 1;
  if (!step(found, change)) return found;
  iterate(found);
  if (!found.at.a.allFinite() || !found.at.b.allFinite()) return found;
  // With a noise model: what is left is modelled, and the fit repeated, until neither changes.
  constexpr int kMostNoisePasses = 30;
  for (int pass = 0; options_.most_noise_order > 0 && found.start.converged && pass < kMostNoisePasses; ++pass) {
    const Vector before = found.at.physical();
    found.noise = autoregression(residuals(found.at), options_.most_noise_order);
    iterate(found);
    const Vector after = found.at.physical();
    if (((after - before).array().abs() <= options_.tolerance * after.array().abs()).all()) break;
  }
  found.last = sums(found.at, layout(true), found.noise);
  found.variance = found.last.ee / static_cast<double>(std::max<Index>(found.last.samples - n_ - q_, 1));
  double squares = found.last.ee;
  if (found.noise.size() > 1) {
    squares = 0.0;
    for (const Vector& e : residuals(found.at)) squares += e.squaredNorm();
  }
  found.start.fit = 1.0 - squares / output_squares_;
  return found;
}

std::vector<Vector> Fitter::residuals(const Iterate& at) const {
  std::vector<Vector> all;
  const Layout rows = layout(false);
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    Vector e(experiments_[k].time.size());
    Matrix gram = Matrix::Zero(rows.rows(), rows.rows());
    Matrix free(rows.free_size(), e.size());
    blocks(k, at, rows, Vector::Ones(1), [&](Index begin, Index count, const auto& block) {
      gram.selfadjointView<Eigen::Lower>().rankUpdate(block);
      e.segment(begin, count) = block.row(rows.e()).transpose();
      free.middleCols(begin, count) = block.middleRows(rows.free_at(), rows.free_size());
    });
    gram = gram.selfadjointView<Eigen::Lower>();
    if (rows.free) e -= free.transpose() * reduce(gram, rows).free_of_e;
    all.push_back(std::move(e));
  }
  return all;
}

Result<void> Fitter::check() const {
  if (n_ < 1 || n_ > kMostPoles) return bad_usage(fmt::format("{} poles are not between 1 and {}", n_, kMostPoles));
  if (q_ < 1 || q_ > n_ + 1) {
    return bad_usage(
        fmt::format("{} zeros beside {} poles: a model may have as many zeros as poles, not more", q_ - 1, n_));
  }
  if (experiments_.empty()) return bad_usage("no experiment to fit");
  for (const double pole : options_.start_poles) {
    if (!(pole > 0.0) || !std::isfinite(pole))
      return bad_usage(fmt::format("start pole {} rad/s is not above 0", pole));
  }
  Index samples = 0;
  for (const SignalPair& pair : experiments_) {
    samples += pair.time.size();
    for (const Vector* signal : {&pair.time, &pair.input, &pair.output}) {
      if (signal->size() != pair.time.size()) return bad_usage("time, input and output differ in length");
      if (const Index bad = first_non_finite(*signal); bad >= 0) {
        return bad_data(fmt::format("sample {} of a signal is not a finite number", bad + 1),
                        "cut it out by --from and --to");
      }
    }
    if (!pair.step && (options_.most_noise_order > 0 || options_.reference_instruments)) {
      return bad_usage("a noise model and the closed-loop variant need an even clock", "take --method srivc");
    }
    if (options_.reference_instruments && pair.reference.size() != pair.time.size()) {
      return bad_usage("the closed-loop variant needs the reference", "name it: --reference NAME");
    }
  }
  const Index unknown = n_ + q_ + (options_.free_start ? (n_ + 1) * static_cast<Index>(experiments_.size()) : 0);
  if (samples < 2 * unknown + 10) {
    return bad_data(fmt::format("{} samples are too few for {} unknowns", samples, unknown),
                    "record longer, or take fewer poles");
  }
  return {};
}

/// From a few periods in the record to a third of the Nyquist frequency, evenly in the logarithm.
std::vector<double> Fitter::start_poles() const {
  std::vector<double> poles = options_.start_poles;
  if (options_.only_given_starts && !poles.empty()) return poles;
  double step = 0.0, duration = 0.0;
  for (const SignalPair& pair : experiments_) {
    const double length = pair.time[pair.time.size() - 1] - pair.time[0];
    duration = std::max(duration, length);
    step = std::max(step, length / static_cast<double>(pair.time.size() - 1));
  }
  constexpr int kStarts = 6;
  constexpr double kReach = 300.0;
  const double high = std::numbers::pi / step / 3.0, low = std::max(8.0 * std::numbers::pi / duration, high / kReach);
  for (int k = 0; k < kStarts; ++k) {
    poles.push_back(high * std::pow(std::min(low / high, 1.0), static_cast<double>(k) / (kStarts - 1)));
  }
  return poles;
}

void Fitter::take_covariance(const Search& best, ContinuousFit& made) const {
  const Layout rows = layout(true);
  const Sums& last = best.last;
  const Index p = n_ + q_;
  const Matrix bread =
      options_.reference_instruments ? Matrix(last.M.inverse()) : Matrix(last.S.ldlt().solve(Matrix::Identity(p, p)));
  made.white_covariance = made.variance * bread * last.S * bread.transpose();
  made.covariance = made.white_covariance;
  if (options_.hac_lag_s > 0.0) {
    const std::vector<Index> z = rows.z_rows();
    std::vector<numeric::RowRange> ranges;
    Matrix scores(p, last.samples);
    Index at = 0;
    double step = 0.0;
    for (std::size_t k = 0; k < experiments_.size(); ++k) {
      const Reduced& one = last.each[k];
      const Index begin = at;
      const Vector& time = experiments_[k].time;
      step = std::max(step, (time[time.size() - 1] - time[0]) / static_cast<double>(time.size() - 1));
      blocks(k, best.at, rows, best.noise, [&](Index, Index count, const auto& block) {
        Eigen::RowVectorXd e = block.row(rows.e());
        Matrix instruments = block(z, Eigen::all);
        if (rows.free) {
          const auto free = block.middleRows(rows.free_at(), rows.free_size());
          e -= one.free_of_e.transpose() * free;
          instruments -= one.free_of_z.transpose() * free;
        }
        scores.middleCols(at, count) = instruments * e.asDiagonal();
        at += count;
      });
      ranges.push_back({begin, at});
    }
    const Index lags = std::min(static_cast<Index>(std::llround(options_.hac_lag_s / step)), last.samples / 10);
    const Matrix middle = numeric::long_run_covariance(p, ranges, lags, [&](const numeric::RowRange& range) {
      return Matrix(scores.middleCols(range.begin, range.size()));
    });
    const double widening = numeric::newey_west_widening(static_cast<double>(lags) / static_cast<double>(last.samples));
    made.covariance = widening * widening * bread * middle * bread.transpose();
  }
  const Vector physical = best.at.to_seconds();
  made.a = best.at.a.cwiseProduct(physical.head(n_));
  made.b = best.at.b.cwiseProduct(physical.tail(q_));
  made.covariance = physical.asDiagonal() * made.covariance * physical.asDiagonal();
  made.white_covariance = physical.asDiagonal() * made.white_covariance * physical.asDiagonal();
}

Result<ContinuousFit> Fitter::run() {
  if (auto ok = check(); !ok) return tl::unexpected(ok.error());
  double input_squares = 0.0;
  for (const SignalPair& pair : experiments_) {
    output_squares_ += (pair.output.array() - pair.output.mean()).square().sum();
    input_squares += (pair.input.array() - pair.input.mean()).square().sum();
    samples_ += pair.time.size();
    if (options_.reference_instruments) clean_input_.push_back(explained_by_past(pair.reference, pair.input));
  }
  if (!(output_squares_ > 0.0)) return bad_data("the output is constant", "check --output");
  if (!(input_squares > 0.0)) return bad_data("the input is constant", "check --input");

  const std::vector<double> poles = start_poles();
  std::vector<Search> searches(poles.size());
  const auto ran = numeric::parallel_for(static_cast<int>(poles.size()), options_.threads, [&](int i) -> Result<void> {
    const auto k = static_cast<std::size_t>(i);
    searches[k] = search(poles[k]);
    return {};
  });
  if (!ran) return tl::unexpected(ran.error());
  const auto better = [](const Search& a, const Search& b) {
    if (a.start.converged != b.start.converged) return a.start.converged;
    return a.variance < b.variance;
  };
  const Search& best = *std::ranges::min_element(searches, better);
  ContinuousFit made;
  made.samples = samples_;
  for (const Search& one : searches) made.starts.push_back(one.start);
  made.converged = best.start.converged;
  made.stable = best.start.stable;
  made.variance = best.variance;
  made.fit = best.start.fit;
  made.noise = best.noise;
  if (std::isfinite(best.variance)) {
    take_covariance(best, made);
    made.residuals = residuals(best.at);
  }
  return made;
}

}  // namespace

Result<ContinuousFit> fit_continuous(const std::vector<SignalPair>& experiments, const ContinuousFitOptions& options) {
  return Fitter(experiments, options).run();
}

Vector simulate_continuous(const Vector& a, const Vector& b, const SignalPair& experiment) {
  const Index n = a.size(), total = experiment.time.size();
  Iterate at{1.0, a, b, {}};
  at.rescale();
  Pass pass(at.a, experiment, at.scale);
  Matrix states(n, kBlock);
  Vector response(total);
  for (Index begin = 0; begin < total; begin += kBlock) {
    const Index count = std::min(kBlock, total - begin);
    pass.run(begin, count, experiment.input.data() + begin, states.leftCols(count));
    auto now = response.segment(begin, count);
    const Index q = std::min(at.b.size(), n);
    now = states.leftCols(count).topRows(q).transpose() * at.b.head(q);
    if (at.b.size() > n) {
      now += at.b[n] * (experiment.input.segment(begin, count) - states.leftCols(count).transpose() * at.a);
    }
  }
  return response;
}

Vector without_free_motion(const Vector& a, const SignalPair& experiment, const Vector& residual) {
  const Index n = a.size(), total = experiment.time.size();
  Iterate at{1.0, a, Vector::Zero(1), {}};
  at.rescale();
  Pass pass(at.a, experiment, at.scale);
  pass.start_at(Vector::Unit(n, n - 1));
  Matrix free(n + 1, total);
  const Vector none = Vector::Zero(total);
  pass.run(0, total, none.data(), free.topRows(n));
  free.row(n).setOnes();
  const Matrix gram = free * free.transpose();
  return residual - free.transpose() * (pseudo_inverse(gram) * (free * residual));
}

}  // namespace mbk::identify
