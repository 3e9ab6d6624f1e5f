#include "mbk/measure/identify/srivc.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "mbk/base/dsp/autoregression.h"
#include "mbk/base/dsp/derivative_filter.h"
#include "mbk/base/dsp/segments.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/base/numeric/polynomial_roots.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/identify/explained_by_past.h"

namespace mbk::identify {
namespace {

constexpr Index kSteps = 24;  // of all segments in a block: what fits the nearest cache
constexpr Index kBlock = kSteps * dsp::kSegments;
constexpr Index kMaxPoles = 20;

double step_of(const SignalPair& pair, Index i) {
  return pair.step ? *pair.step : pair.time[i] - pair.time[i - 1];
}

/// The states of a filter over samples [begin, begin + count) of an experiment.
class Pass {
 public:
  Pass(const Vector& a, const SignalPair& pair, double scale, const Vector& start, double sign = 1.0,
       std::optional<double> held = {})
      : filter_(a, held), pair_(pair), scale_(scale), sign_(sign) {
    filter_.set_state(start);
  }

  /// @param input the next `count` samples    @param states n rows, count columns
  void run(const double* input, Index count, Eigen::Ref<Matrix, 0, Eigen::OuterStride<>> states) {
    Index i = 0;
    if (next_ == 0) {
      states.col(0) = filter_.state();
      filter_.begin(input[0]);
      i = 1;
    }
    if (pair_.step) {
      if (count > i) filter_.run(scale_ * *pair_.step, input + i, count - i, states.middleCols(i, count - i));
    } else {
      for (; i < count; ++i) filter_.run(scale_ * step_of(pair_, next_ + i), input + i, 1, states.middleCols(i, 1));
    }
    next_ += count;
  }
  void run(const double* input, Index count, dsp::Rows to) {
    Matrix states(filter_.order(), count);
    run(input, count, states);
    for (Index r = 0; r < states.rows(); ++r) Eigen::Map<Eigen::RowVectorXd>(to.row(r), count) = sign_ * states.row(r);
  }

 private:
  dsp::DerivativeFilter filter_;
  const SignalPair& pair_;
  double scale_, sign_;
  Index next_ = 0;
};

/// The model in time scaled by `scale`, t′ = scale·t.
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

/// Where the rows of a block stand: [those of Z that X has not | u | ∂x̂/∂τ | e | free motion | −y].
/// Without the rows of the output there is no ZᵀX.
struct Layout {
  Index n, q;                         ///< poles; coefficients of the numerator
  bool instruments, reference, free;  ///< present
  Index input = 0;                    ///< which signal is taken for u: kInput or kCleanInput
  bool delay = false;                 ///< τ is a parameter, too, behind a and b; q ≤ n
  bool output = true;                 ///< filtered, too; not needed for ZᵀZ of instruments
  [[nodiscard]] Index of_input() const { return delay ? q + 1 : q; }
  [[nodiscard]] Index parameters() const { return n + of_input(); }
  [[nodiscard]] Index z_size() const { return !instruments ? 0 : (reference ? parameters() : n); }
  [[nodiscard]] Index u() const { return z_size(); }
  [[nodiscard]] Index e() const { return u() + of_input(); }
  [[nodiscard]] Index free_at() const { return e() + 1; }
  [[nodiscard]] Index free_size() const { return free ? n + 1 : 0; }
  [[nodiscard]] Index y() const { return free_at() + free_size(); }
  [[nodiscard]] Index rows() const { return y() + (output ? n : 0); }
  /// All states of the filtered input are written, before what follows them.
  [[nodiscard]] Index written() const { return std::max(rows(), u() + n); }
  /// Rows that are X, in the order of [a, b, τ].
  [[nodiscard]] std::vector<Index> x_rows() const {
    std::vector<Index> rows_of;
    for (Index k = 0; k < parameters(); ++k) rows_of.push_back(k < n ? y() + k : u() + k - n);
    return rows_of;
  }
  [[nodiscard]] std::vector<Index> z_rows() const {
    std::vector<Index> rows_of = x_rows();
    for (Index k = 0; k < z_size(); ++k) rows_of[static_cast<std::size_t>(k)] = k;
    return rows_of;
  }
};

/// Rows of doubles that inner loops can take.
class Table {
 public:
  Table(Index rows, Index columns)
      : stride_(columns + dsp::kSegments),  // not a power of two, for the cache's sake
        values_(static_cast<std::size_t>(rows * stride_ / dsp::kSegments)) {}
  [[nodiscard]] dsp::Rows from(Index column) { return {values_.data()->values.data() + column, stride_}; }

 private:
  Index stride_;
  std::vector<dsp::SampleBlock> values_;
};

/// Columns of a block: samples that follow each other, or those of all segments at one step after another.
struct Block {
  dsp::Rows rows;
  Index columns;           ///< a multiple of 16
  Index first;             ///< step, of each segment
  Index segments, length;  ///< length: from one segment to the next
  Index samples;           ///< in the record

  /// Not below `samples`: none.
  [[nodiscard]] Index sample(Index column) const { return column % segments * length + first + column / segments; }
  void skip(Index steps) {
    rows.data += steps * segments;
    columns -= steps * segments;
    first += steps;
  }
  [[nodiscard]] auto matrix(Index row_count) const {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const RowMajor, 0, Eigen::OuterStride<>>(rows.data, row_count, columns,
                                                               Eigen::OuterStride<>(rows.stride));
  }
  /// One row, sample by sample, to where it belongs.
  void scatter(Index row, Vector& to) const {
    const double* const from = rows.row(row);
    for (Index l = 0; l < segments; ++l) {
      const Index begin = l * length + first, count = std::min(columns / segments, samples - begin);
      for (Index i = 0; i < count; ++i) to[begin + i] = from[i * segments + l];
    }
  }
  /// Columns that are no samples become zero.
  void clear_beyond(Index row_count) const {
    if (sample(columns - 1) < samples) return;
    for (Index c = 0; c < columns; ++c) {
      if (sample(c) < samples) continue;
      for (Index r = 0; r < row_count; ++r) rows.row(r)[c] = 0.0;
    }
  }
};

/// Which signal of a record's segments is which.
constexpr Index kInput = 0, kOutput = 1, kCleanInput = 2;

/// What runs through the segments of a record, with the states at one step of each segment.
struct Courses {
  dsp::HeldStep filter, of_input;
  dsp::HeldStep to_x;  ///< of x̂'s source and, below it, what −x̂_f has of that
  Matrix free_to_x;    ///< the same of the free motion
  Matrix source, input, output, free;
  Index step = 0;

  [[nodiscard]] bool free_is_known() const { return free.rows() > filter.transition.rows(); }
  /// −x̂_f.
  [[nodiscard]] Matrix of_x() const {
    const Index n = filter.transition.rows();
    return free_is_known() ? Matrix(source.bottomRows(n) + free.bottomRows(n)) : Matrix(source.bottomRows(n));
  }
};

dsp::HeldStep negative(const dsp::HeldStep& step) {
  return {step.transition, -step.from_last, -step.from_next};
}

/// One experiment's rows with the free motion projected out.
struct Reduced {
  Matrix M, S;                  ///< ZᵀX (0 without the output), ZᵀZ (a step of the search needs its diagonal only)
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
  const auto [values, vectors] = numeric::symmetric_eigen(scale.asDiagonal() * gram * scale.asDiagonal());
  const double least = kSmall * std::max(values.maxCoeff(), 0.0);
  Vector inverse = values;
  for (double& value : inverse) value = value > least ? 1.0 / value : 0.0;
  return scale.asDiagonal() * vectors * inverse.asDiagonal() * vectors.transpose() * scale.asDiagonal();
}

Reduced reduce(const Matrix& gram, const Layout& at) {
  const Index f = at.free_size();
  const std::vector<Index> x = at.x_rows(), z = at.z_rows();
  Reduced r;
  r.M = at.output ? Matrix(gram(z, x)) : Matrix::Zero(at.parameters(), at.parameters());
  r.S = gram(z, z);
  r.g = gram(z, at.e());
  r.ee = gram(at.e(), at.e());
  if (f == 0) return r;
  const auto free = Eigen::seqN(at.free_at(), f);
  const Matrix inverse = pseudo_inverse(gram(free, free));
  const Matrix NZ = gram(free, z), NX = at.output ? Matrix(gram(free, x)) : Matrix::Zero(f, at.parameters());
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
  Vector g;
  double ee = 0;
  Index samples = 0;
  std::vector<Reduced> each;
};

/// n + 1 rows: the motions that a state at the first sample leaves, and an offset.
Matrix free_motion(const Iterate& at, const SignalPair& pair) {
  const Index n = at.a.size(), total = pair.time.size();
  Pass pass(at.a, pair, at.scale, Vector::Unit(n, n - 1));
  Matrix free(n + 1, total);
  const Vector none = Vector::Zero(total);
  pass.run(none.data(), total, free.topRows(n));
  free.row(n).setOnes();
  return free;
}

/// Products of the samples of all strides: of the input's eight, then the output's.
struct Strided {
  Index strides;
  Matrix products{2 * dsp::kStride, 2 * dsp::kStride};

  Strided(const dsp::Segments& segments, Index samples) : strides(segments.strides(samples)) {
    const dsp::Rows input = segments.strided(kInput, 0), output = segments.strided(kOutput, 0);
    auto of_input = dsp::Products::among(dsp::kStride, dsp::kStride), of_output = of_input;
    dsp::Products of_both(dsp::kStride, dsp::kStride);
    of_input.add(input, input, dsp::kSegments * strides);
    of_both.add(input, output, dsp::kSegments * strides);
    of_output.add(output, output, dsp::kSegments * strides);
    products << of_input.total(), of_both.total(), of_both.total().transpose(), of_output.total();
  }
};

/// What the rows at a sample of a stride are made of, and where it stands: states at the stride's first sample, and its
/// samples.
struct StrideLayout {
  Index u, x;                  ///< u_f; −x̂_f without what the free motion adds
  Index free, free_in_x, one;  ///< the free motion, what it adds to −x̂_f where that is known, and 1
  Index y;                     ///< −y_f, the last of the states
  Index input, output, size;   ///< samples

  StrideLayout(const Layout& layout, Index n, bool known)
      : u(0),
        x(n),
        free(layout.instruments ? 2 * n : n),
        free_in_x(free + n),
        one(free + (layout.free ? n : 0) + (known ? n : 0)),
        y(one + (layout.free ? 1 : 0)),
        input(y + n),
        output(input + dsp::kStride),
        size(output + dsp::kStride) {}
};

class Fitter {
 public:
  Fitter(const std::vector<SignalPair>& experiments, const ContinuousFitOptions& options)
      : experiments_(experiments), options_(options), n_(options.poles), q_(options.zeros + 1) {}

  [[nodiscard]] Result<void> check();
  Result<ContinuousFit> run();

 private:
  struct Search {
    SearchStart start;
    Iterate at;
    Vector noise = Vector::Ones(1);
    int unstable_in_a_row = 0;      ///< passes
    bool from_clean_input = false;  ///< û is taken for u
    double variance = std::numeric_limits<double>::infinity(), rank = variance;
    Sums last;                      ///< at the end
    std::vector<Vector> residuals;  ///< y − x̂ of each experiment
  };

  /// What a step of the search needs, or a covariance: the whole of ZᵀZ. On the way sums may lose some digits, as those
  /// over strides do where signals stand far from zero.
  enum class For { step_on_the_way, step, covariance };

  [[nodiscard]] std::vector<double> start_poles() const;
  [[nodiscard]] Search search(double pole) const;
  void iterate(Search& found) const;
  bool step(Search& found, double& change, For use) const;
  /// Whether a step on the way is any cheaper.
  [[nodiscard]] bool goes_by_strides(const Search& found) const {
    for (std::size_t k = 0; k < strided_.size() && found.noise.size() == 1; ++k) {
      if (strides_pay(k, layout(true))) return true;
    }
    return false;
  }

  template <class Filter>
  struct Filters {
    Filter u;
    std::optional<Filter> y, clean_u, free, x;
  };
  /// The samples of a block.
  struct Inputs {
    const double *input, *output, *clean_input;
  };
  /// Fills the rows of a block.   @param free_weights of the free motion in x̂, or nullptr
  template <class Filter>
  void fill(Filters<Filter>& filters, const Inputs& from, Index count, Index columns, const Iterate& at,
            const Layout& layout, const Vector* free_weights, dsp::Rows now) const;
  /// Calls use(block) for the blocks of one experiment.
  template <class Use>
  void blocks(std::size_t experiment, const Iterate& at, const Layout& layout, const Vector& noise, Use&& use) const;
  /// States of the filters at the first sample of each segment.
  [[nodiscard]] Courses courses(std::size_t experiment, const Iterate& at, const Layout& layout) const;
  template <class Use>
  void blocks_of_segments(std::size_t experiment, const Iterate& at, const Layout& layout, const Vector& noise,
                          const Courses& from_here, Use&& use) const;
  /// Whether there are so many strides that what each row is made of costs less than the rows.
  [[nodiscard]] bool strides_pay(std::size_t experiment, const Layout& layout) const {
    constexpr Index kStridesForEach = 4;  // column of what a row is made of, by counts of instructions
    return experiment < strided_.size() &&
           strided_[experiment].strides >= kStridesForEach * StrideLayout(layout, n_, layout.free).size;
  }
  /// Products of rows, without the rows: moves on by all whole strides, and returns what they add.
  [[nodiscard]] Matrix products_of_strides(std::size_t experiment, const Iterate& at, const Layout& layout,
                                           Courses& from_here) const;
  /// The same from the products of states at the first sample of each stride and of samples.
  /// @param products  of all that StrideLayout has
  [[nodiscard]] Matrix over_stride(const Iterate& at, const Layout& layout, const Vector* free_weights,
                                   const Courses& steps, const Matrix& products) const;
  template <class Use>
  void blocks_of_uneven(std::size_t experiment, const Iterate& at, const Layout& layout, Use&& use) const;
  [[nodiscard]] static const Vector* free_weights(const Iterate& at, const Layout& layout, std::size_t experiment) {
    return layout.free && experiment < at.free.size() ? &at.free[experiment] : nullptr;
  }
  /// @param residuals  y − x̂ of each experiment, where it is not nullptr; without a noise model only
  [[nodiscard]] Sums sums(const Iterate& at, const Layout& layout, const Vector& noise, For use,
                          std::vector<Vector>* residuals = nullptr) const;
  [[nodiscard]] std::vector<Vector> residuals(const Iterate& at) const {
    std::vector<Vector> all;
    static_cast<void>(sums(at, layout(false), Vector::Ones(1), For::step, &all));
    return all;
  }
  [[nodiscard]] Layout layout(bool instruments) const {
    return {n_, q_, instruments, instruments && options_.reference_instruments, options_.free_start};
  }
  /// What the covariance is made of: instruments, and τ where it was found from the same data.
  [[nodiscard]] Layout layout_of_covariance() const {
    Layout all = layout(true);
    all.delay = options_.delay_found && q_ <= n_;
    all.output = all.reference || all.delay;  // (ZᵀX)⁻¹ is the bread of a closed loop, and moves a delay
    return all;
  }
  [[nodiscard]] Layout layout_of_clean_input(bool instruments) const {
    return {n_, q_, instruments, false, options_.free_start, kCleanInput};
  }
  void take_covariance(const Search& best, ContinuousFit& made) const;

  const std::vector<SignalPair>& experiments_;
  const ContinuousFitOptions& options_;
  Index n_, q_;
  std::vector<dsp::Segments> stretched_;
  std::vector<Strided> strided_;  ///< up to the first uneven clock; none with instruments from the reference
  double output_squares_ = 0;     ///< Σ(y − ȳ)²
  Index samples_ = 0;
};

template <class Filter>
void Fitter::fill(Filters<Filter>& filters, const Inputs& from, Index count, Index columns, const Iterate& at,
                  const Layout& layout, const Vector* free_weights, dsp::Rows now) const {
  static const std::vector<dsp::SampleBlock> kNone(kSteps);
  const double* const none = kNone.data()->values.data();
  /// sᵏ/A, k = 0 … q − 1, of which the n-th is the signal itself less the others, and −sB/A behind them. Where q is
  /// less than n, rows that follow are written, too, and only then get what belongs there.
  const auto take_input = [&](Filter& filter, const double* signal, dsp::Rows to) {
    filter.run(signal, count, to);
    if (layout.of_input() > n_) dsp::combine(-at.a, to, signal, columns, to.row(n_));
    if (layout.delay) dsp::combine(-at.b, to.from_row(1), none, columns, to.row(q_));
  };
  const dsp::Rows u = now.from_row(layout.u()), free = now.from_row(layout.free_at());
  if (filters.clean_u) take_input(*filters.clean_u, from.clean_input, now.from_row(n_));
  take_input(filters.u, from.input, u);
  if (filters.y) filters.y->run(from.output, count, now.from_row(layout.y()));
  if (filters.free) {
    filters.free->run(none, count, free);
    std::fill_n(free.row(n_), columns, 1.0);
  }
  dsp::combine(-at.b, u, from.output, columns, now.row(layout.e()));
  if (!filters.x) return;
  alignas(64) std::array<double, kBlock> clean;
  dsp::combine(at.b, layout.reference ? now.from_row(n_) : u, none, columns, clean.data());
  if (free_weights != nullptr) dsp::combine(free_weights->head(n_), free, clean.data(), columns, clean.data());
  filters.x->run(clean.data(), count, now);
}

Courses Fitter::courses(std::size_t experiment, const Iterate& at, const Layout& layout) const {
  const SignalPair& pair = experiments_[experiment];
  const dsp::Segments& signals = stretched_[experiment];
  const Vector* const c = layout.reference ? nullptr : free_weights(at, layout, experiment);
  Courses all;
  all.filter = dsp::held_step(at.a, at.scale * *pair.step);
  all.of_input = pair.held ? dsp::held_step(at.a, at.scale * *pair.step, pair.held) : all.filter;
  all.to_x = all.of_input;
  all.free_to_x = all.filter.transition;
  if (layout.instruments) {
    const double through = q_ > n_ ? at.b[n_] : 0.0;
    Vector weights = -through * at.a;
    weights.head(std::min(q_, n_)) += at.b.head(std::min(q_, n_));
    all.to_x = dsp::cascaded(all.of_input, all.filter, -weights, -through);
    if (c != nullptr) all.free_to_x = dsp::cascaded(all.filter, all.filter, -c->head(n_), 0.0).transition;
  }
  all.source = dsp::states_at_starts(all.to_x, signals, layout.reference ? kCleanInput : layout.input);
  if (layout.reference) all.input = dsp::states_at_starts(all.of_input, signals, kInput);
  if (layout.output) all.output = dsp::states_at_starts(negative(all.filter), signals, kOutput);
  if (layout.free) {
    all.free = dsp::free_at_starts(all.free_to_x, Vector::Unit(all.free_to_x.rows(), n_ - 1), signals.length());
  }
  return all;
}

template <class Use>
void Fitter::blocks_of_segments(std::size_t experiment, const Iterate& at, const Layout& layout, const Vector& noise,
                                const Courses& from_here, Use&& use) const {
  const SignalPair& pair = experiments_[experiment];
  const dsp::Segments& signals = stretched_[experiment];
  const Vector* const c = layout.reference ? nullptr : free_weights(at, layout, experiment);
  const Index order = noise.size() - 1, length = signals.length(), past = order * dsp::kSegments;
  const dsp::SegmentFilter source(from_here.of_input, from_here.source.topRows(n_));
  Filters<dsp::SegmentFilter> filters{source, {}, {}, {}, {}};
  if (layout.output) filters.y.emplace(negative(from_here.filter), from_here.output);
  if (layout.reference) {
    filters.u = dsp::SegmentFilter(from_here.of_input, from_here.input);
    filters.clean_u = source;
  }
  if (layout.free) filters.free.emplace(from_here.filter, from_here.free.topRows(n_));
  if (layout.instruments) filters.x.emplace(negative(from_here.filter), from_here.of_x());
  Table table(layout.written(), past + kBlock), filtered(layout.rows(), kBlock);
  const dsp::Rows now = table.from(past);
  for (Index begin = from_here.step; begin < length + order; begin += kSteps) {
    const Index steps = std::min(kSteps, length + order - begin), columns = steps * dsp::kSegments;
    const Inputs from{signals.row(layout.input, begin), signals.row(kOutput, begin),
                      layout.reference ? signals.row(kCleanInput, begin) : nullptr};
    fill(filters, from, steps, columns, at, layout, c, now);
    Block block{now, columns, begin, dsp::kSegments, length, pair.time.size()};
    if (order > 0) {
      block.rows = filtered.from(0);
      for (Index r = 0; r < layout.rows(); ++r) {
        double* const row = now.row(r);
        dsp::combine(noise.tail(order), {row - dsp::kSegments, -dsp::kSegments}, row, columns, block.rows.row(r));
        std::copy_n(row + columns - past, past, row - past);
      }
      // Before there is a past; in all segments but the first these samples are the last of the one before.
      block.skip(std::clamp<Index>(order - begin, 0, steps));
    }
    if (block.columns == 0) continue;
    block.clear_beyond(layout.rows());
    use(block);
  }
}

/// Each row at sample j of a stride is linear in the states at its first sample and in the samples up to j. So its
/// products follow from those of these states and samples, which are there once for eight samples.
Matrix Fitter::products_of_strides(std::size_t experiment, const Iterate& at, const Layout& layout,
                                   Courses& from_here) const {
  constexpr Index kAtOnce = 16;
  const dsp::Segments& signals = stretched_[experiment];
  const Strided& strided = strided_[experiment];
  const StrideLayout base(layout, n_, from_here.free_is_known());
  dsp::StridedFilter source(from_here.to_x, from_here.source), output(negative(from_here.filter), from_here.output);
  std::optional<dsp::StridedFilter> free;
  if (layout.free) free.emplace(from_here.free_to_x, from_here.free);

  Table table(base.input, (kAtOnce + 1) * dsp::kSegments);
  const dsp::Rows states = table.from(0), y = states.from_row(base.y);
  if (layout.free) std::fill_n(states.row(base.one), kAtOnce * dsp::kSegments, 1.0);
  // Products of −y_f and y are needed where there are no instruments.
  const Index left = layout.instruments ? base.y : base.input;
  auto among = dsp::Products::among(left, base.input);
  dsp::Products with_input(base.input, dsp::kStride), with_output(left, dsp::kStride);
  const Index all = strided.strides;
  for (Index k = 0; k < all; k += kAtOnce) {
    const Index count = std::min(kAtOnce, all - k), columns = count * dsp::kSegments;
    source.run(signals.row(kInput, k * dsp::kStride), count, states);
    output.run(signals.row(kOutput, k * dsp::kStride), count, y);
    if (free) free->run(nullptr, count, states.from_row(base.free));
    among.add(states, states, columns);
    with_input.add(states, signals.strided(kInput, k), columns);
    with_output.add(states, signals.strided(kOutput, k), columns);
  }
  from_here.step = all * dsp::kStride;
  from_here.source = source.state();
  from_here.output = output.state();
  if (free) from_here.free = free->state();

  Matrix products = Matrix::Zero(base.size, base.size);
  products.topLeftCorner(left, base.input) = among.total();
  products.block(0, base.input, base.input, dsp::kStride) = with_input.total();
  products.block(0, base.output, left, dsp::kStride) = with_output.total();
  products.bottomRightCorner(2 * dsp::kStride, 2 * dsp::kStride) = strided.products;
  products.triangularView<Eigen::StrictlyLower>() = products.transpose();
  return over_stride(at, layout, free_weights(at, layout, experiment), from_here, products);
}

Matrix Fitter::over_stride(const Iterate& at, const Layout& layout, const Vector* free_weights, const Courses& steps,
                           const Matrix& products) const {
  const StrideLayout base(layout, n_, steps.free_is_known());
  const dsp::HeldStep of_output = negative(steps.filter);
  Matrix x = Matrix::Zero(n_, base.size), u = x, free = x, y = x, next = x;
  u.middleCols(base.u, n_).setIdentity();
  y.middleCols(base.y, n_).setIdentity();
  if (layout.instruments) x.middleCols(base.x, n_).setIdentity();
  if (layout.free) free.middleCols(base.free, n_).setIdentity();
  if (steps.free_is_known()) x.middleCols(base.free_in_x, n_).setIdentity();
  const auto step = [&](const Matrix& transition, Matrix& states) {
    next.noalias() = transition.lazyProduct(states);
    states.swap(next);
  };
  const auto step_with = [&](const dsp::HeldStep& by, Index samples, Matrix& states) {
    step(by.transition, states);
    states.col(samples - 1) += by.from_last;
    states.col(samples) += by.from_next;
  };
  const Index left = layout.instruments ? layout.y() : layout.rows();
  const Index columns = (base.size + dsp::kSegments - 1) / dsp::kSegments * dsp::kSegments;
  Table of_bases(base.size, columns), times_products(left, dsp::kStride * columns);
  Table of_rows(layout.rows(), dsp::kStride * columns), none(1, columns);
  for (Index k = 0; k < base.size; ++k) std::ranges::copy(products.col(k), of_bases.from(0).row(k));
  Matrix rows = Matrix::Zero(layout.rows(), base.size);
  Vector weights(base.size);
  Eigen::RowVectorXd modelled = Eigen::RowVectorXd::Zero(base.size), clean, last;  // B/A u; x̂
  for (Index j = 0; j < dsp::kStride; ++j) {
    if (j > 0) {
      step_with(steps.of_input, base.input + j, u);
      step_with(of_output, base.output + j, y);
      if (layout.free) step(steps.filter.transition, free);
    }
    auto input = rows.middleRows(layout.u(), q_);
    input.topRows(std::min(q_, n_)) = u.topRows(std::min(q_, n_));
    if (q_ > n_) {
      input.row(n_) = -at.a.transpose() * u;
      input(n_, base.input + j) += 1.0;
    }
    if (at.b.size() > 0) modelled = at.b.transpose() * input;
    rows.row(layout.e()) = -modelled;
    rows(layout.e(), base.output + j) += 1.0;
    rows.middleRows(layout.y(), n_) = y;
    if (layout.free) {
      rows.middleRows(layout.free_at(), n_) = free;
      rows(layout.free_at() + n_, base.one) = 1.0;
    }
    if (layout.instruments) {
      last.swap(clean);
      clean = modelled;
      if (free_weights != nullptr) clean += free_weights->head(n_).transpose() * free;
      if (j > 0) {
        step(of_output.transition, x);
        x += of_output.from_last * last + of_output.from_next * clean;
      }
      rows.topRows(n_) = x;
    }
    const dsp::Rows here = of_rows.from(j * columns), product = times_products.from(j * columns);
    for (Index r = 0; r < layout.rows(); ++r) {
      weights = rows.row(r);
      std::ranges::copy(weights, here.row(r));
      if (r < left) dsp::combine(weights, of_bases.from(0), none.from(0).row(0), columns, product.row(r));
    }
  }
  dsp::Products sums(left, layout.rows());
  sums.add(times_products.from(0), of_rows.from(0), dsp::kStride * columns);
  Matrix gram = Matrix::Zero(layout.rows(), layout.rows());
  gram.topRows(left) = sums.total();
  if (layout.instruments) gram.block(layout.e(), layout.y(), 1, n_).setZero();  // not all of it was added up
  gram.bottomLeftCorner(layout.rows() - left, left) = gram.topRightCorner(left, layout.rows() - left).transpose();
  return gram;
}

template <class Use>
void Fitter::blocks_of_uneven(std::size_t experiment, const Iterate& at, const Layout& layout, Use&& use) const {
  const SignalPair& pair = experiments_[experiment];
  const Vector rest = Vector::Zero(n_);
  Filters<Pass> filters{Pass(at.a, pair, at.scale, rest, 1.0, pair.held), {}, {}, {}, {}};
  if (layout.output) filters.y.emplace(at.a, pair, at.scale, rest, -1.0);
  if (layout.free) filters.free.emplace(at.a, pair, at.scale, Vector::Unit(n_, n_ - 1));
  if (layout.instruments) filters.x.emplace(at.a, pair, at.scale, rest, -1.0);
  Table table(layout.written(), kBlock), signals(2, kBlock);
  double* const input = signals.from(0).row(0);
  double* const output = signals.from(0).row(1);
  for (Index begin = 0; begin < pair.time.size(); begin += kBlock) {
    const Index count = std::min(kBlock, pair.time.size() - begin);
    const Index columns = (count + dsp::kSegments - 1) / dsp::kSegments * dsp::kSegments;
    std::copy_n(pair.input.data() + begin, count, input);
    std::copy_n(pair.output.data() + begin, count, output);
    fill(filters, {input, output, nullptr}, count, columns, at, layout, free_weights(at, layout, experiment),
         table.from(0));
    const Block block{table.from(0), columns, begin, 1, 0, pair.time.size()};
    block.clear_beyond(layout.rows());
    use(block);
  }
}

template <class Use>
void Fitter::blocks(std::size_t experiment, const Iterate& at, const Layout& layout, const Vector& noise,
                    Use&& use) const {
  if (experiments_[experiment].step) {
    blocks_of_segments(experiment, at, layout, noise, courses(experiment, at, layout), use);
  } else {
    blocks_of_uneven(experiment, at, layout, use);
  }
}

Sums Fitter::sums(const Iterate& at, const Layout& layout, const Vector& noise, For use,
                  std::vector<Vector>* residuals) const {
  const Index p = layout.parameters(), u = layout.u(), y = layout.y(), rows = layout.rows();
  const Index own = layout.instruments ? 0 : y, own_size = layout.instruments ? layout.z_size() : n_;
  Sums all{Matrix::Zero(p, p), Matrix::Zero(p, p), Vector::Zero(p), 0.0, 0, {}};
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    // [Z u e free]ᵀ[u e free −y], and ZᵀZ of what is not in u. Of e beside instruments the square is enough.
    const bool diagonal = layout.instruments && use != For::covariance;
    const Index left = layout.instruments && !layout.free ? layout.e() : y;
    dsp::Products across(left, rows - u);
    auto within = dsp::Products::among(diagonal ? 0 : own_size, own_size);
    dsp::Squares of_e(1), of_own(diagonal ? own_size : 0);
    Vector e(residuals == nullptr ? 0 : experiments_[k].time.size());
    Matrix gram = Matrix::Zero(rows, rows);
    const auto add = [&](const Block& block) {
      across.add(block.rows, block.rows.from_row(u), block.columns);
      of_e.add(block.rows.from_row(layout.e()), block.columns);
      within.add(block.rows.from_row(own), block.rows.from_row(own), block.columns);
      of_own.add(block.rows.from_row(own), block.columns);
      if (residuals != nullptr) block.scatter(layout.e(), e);
    };
    Matrix strides = Matrix::Zero(rows, rows);
    if (use == For::step_on_the_way && noise.size() == 1 && strides_pay(k, layout)) {
      Courses from_here = courses(k, at, layout);
      strides = products_of_strides(k, at, layout, from_here);
      blocks_of_segments(k, at, layout, noise, from_here, add);
    } else {
      blocks(k, at, layout, noise, add);
    }
    gram.block(0, u, left, rows - u) = across.total();
    gram.block(u, 0, rows - u, left) = across.total().transpose();
    gram(layout.e(), layout.e()) = of_e.total()[0];
    if (diagonal) {
      gram.diagonal().segment(own, own_size) = of_own.total();
    } else {
      gram.block(own, own, own_size, own_size) = within.total();
    }
    gram += strides;
    Reduced one = reduce(gram, layout);
    if (residuals != nullptr) {
      if (layout.free) e -= free_motion(at, experiments_[k]).transpose() * one.free_of_e;
      residuals->push_back(std::move(e));
    }
    all.M += one.M;
    all.S += one.S;
    all.g += one.g;
    all.ee += one.ee;
    all.samples += std::max<Index>(experiments_[k].time.size() - noise.size() + 1, 0);
    all.each.push_back(std::move(one));
  }
  return all;
}

/// (ZᵀX)⁻¹Zᵀe, rows and columns scaled to unit length; not finite where it is singular.
Vector solved(const Sums& sums) {
  const Vector z = sums.S.diagonal().cwiseSqrt().cwiseInverse();
  Matrix scaled = z.asDiagonal() * sums.M;
  const Vector x = scaled.colwise().norm().cwiseInverse();
  scaled = scaled * x.asDiagonal();
  return x.asDiagonal() * numeric::PivotedQr(scaled).solve(z.asDiagonal() * sums.g);
}

/// Roots on the right half plane are reflected, to no less than a damping ratio; false where there was one.
/// @param growth  the largest real part of one, 0 without
bool stabilise(Vector& a, double min_damping, double& growth) {
  growth = 0.0;
  if (!a.allFinite()) return false;
  Vector monic(a.size() + 1);
  monic << a, 1.0;
  Eigen::VectorXcd roots = numeric::polynomial_roots(monic);
  bool stable = true;
  for (auto& root : roots) {
    if (root.real() < 0.0) continue;
    stable = false;
    growth = std::max(growth, root.real());
    root.real(-std::max(root.real(), min_damping * std::abs(root)));
  }
  if (!stable) a = numeric::monic_from_roots(roots);
  return stable;
}

bool Fitter::step(Search& found, double& change, For use) const {
  const bool first = found.at.b.size() == 0;
  const Layout rows = found.from_clean_input ? layout_of_clean_input(!first) : layout(!first);
  const Sums now = sums(found.at, rows, found.noise, use);
  const Vector delta = solved(now);
  if (!delta.allFinite()) return false;
  const Vector old = first ? Vector(Vector::Zero(n_ + q_)) : found.at.theta();
  for (std::size_t k = 0; k < experiments_.size() && options_.free_start; ++k) {
    found.at.free.resize(experiments_.size());
    found.at.free[k] = now.each[k].free_of_e - now.each[k].free_of_x * delta;
  }
  found.at.a += delta.head(n_);
  found.at.b = (first ? Vector(Vector::Zero(q_)) : found.at.b) + delta.tail(q_);
  // A root that keeps coming back from the right half plane would be put to the same place for ever: the error has its
  // least on the axis there. Far from it the search finds another way.
  constexpr int kPatience = 8;
  constexpr double kReflected = 1e-7, kMovedAway = 0.1;
  const bool stuck = found.unstable_in_a_row > 0 && found.unstable_in_a_row % kPatience == 0;
  found.start.stable = stabilise(found.at.a, stuck ? kMovedAway : kReflected, found.start.growth);
  found.start.growth *= found.at.scale;
  found.unstable_in_a_row = found.start.stable ? 0 : found.unstable_in_a_row + 1;
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
  constexpr double kFar = std::numeric_limits<double>::infinity();
  double change = kFar, least = kFar;
  bool settled = false;
  For use = goes_by_strides(found) ? For::step_on_the_way : For::step;
  found.start.converged = false;
  for (int pass = 0; pass < options_.max_iterations; ++pass) {
    ++found.start.iterations;
    if (!step(found, change, use)) return;
    const bool rests = settled && change >= 0.5 * least && change < options_.tolerance;
    settled = settled || (change < options_.tolerance && found.start.stable);
    least = std::min(least, change);
    if (!rests && !(settled && (!options_.refine || change < kRounding))) continue;
    if (use == For::step || !options_.refine) break;
    use = For::step;
    least = kFar;
    settled = false;
  }
  found.start.converged = settled && found.start.stable && change < options_.tolerance;
}

Fitter::Search Fitter::search(double pole) const {
  Search found;
  found.start.pole = pole;
  found.from_clean_input = options_.reference_instruments;
  // Filters so slow that they leave nothing but a free motion of the record determine nothing; faster ones do.
  constexpr int kMaxDoublings = 20;
  bool begun = false;
  for (int k = 0; !begun && k < kMaxDoublings; ++k) {
    found.at = {std::ldexp(pole, k), numeric::monic_from_roots(Eigen::VectorXcd::Constant(n_, -1.0)), {}, {}};
    double change = 0.0;
    ++found.start.iterations;
    begun = step(found, change, For::step_on_the_way);
  }
  if (!begun) return found;
  // In a closed loop first with û for u (two stages, Van den Hof & Schrama 1993): that is a fit without any loop, whose
  // error has one least. The equations of the instruments have other solutions, too, where the noise is strong.
  if (found.from_clean_input) {
    iterate(found);
    found.from_clean_input = false;
    if (!found.at.a.allFinite() || !found.at.b.allFinite()) return found;
  }
  iterate(found);
  if (!found.at.a.allFinite() || !found.at.b.allFinite()) return found;
  // With a noise model: what is left is modelled, and the fit repeated, until neither changes.
  constexpr int kMaxNoisePasses = 30;
  for (int pass = 0; options_.max_noise_order > 0 && found.start.converged && pass < kMaxNoisePasses; ++pass) {
    const Vector before = found.at.physical();
    found.noise = dsp::autoregression(residuals(found.at), options_.max_noise_order);
    iterate(found);
    const Vector after = found.at.physical();
    if (((after - before).array().abs() <= options_.tolerance * after.array().abs()).all()) break;
  }
  const bool white = found.noise.size() == 1;
  found.last = sums(found.at, layout_of_covariance(), found.noise, For::covariance, white ? &found.residuals : nullptr);
  found.variance = found.last.ee / static_cast<double>(std::max<Index>(found.last.samples - n_ - q_, 1));
  found.rank = found.variance;
  // With the loop's noise in u the least error is not the truth's.
  if (options_.reference_instruments)
    found.rank = sums(found.at, layout_of_clean_input(false), Vector::Ones(1), For::step).ee;
  double squares = found.last.ee;
  if (!white) {
    found.residuals = residuals(found.at);
    squares = 0.0;
    for (const Vector& e : found.residuals) squares += e.squaredNorm();
  }
  found.start.fit = 1.0 - squares / output_squares_;
  return found;
}

Result<void> Fitter::check() {
  if (n_ < 1 || n_ > kMaxPoles) return bad_usage(fmt::format("{} poles are not between 1 and {}", n_, kMaxPoles));
  if (q_ < 1 || q_ > n_ + 1) {
    return bad_usage(fmt::format("{} zero{} exceed{} the {} pole{} of the model", q_ - 1, q_ == 2 ? "" : "s",
                                 q_ == 2 ? "s" : "", n_, n_ == 1 ? "" : "s"));
  }
  if (experiments_.empty()) return bad_usage("no experiment was given");
  for (const double pole : options_.start_poles) {
    if (!(pole > 0.0) || !std::isfinite(pole))
      return bad_usage(fmt::format("the start pole of {} rad/s is not above 0", pole));
  }
  double input_squares = 0.0;
  const auto squares = [](const Vector& x) { return numeric::variance(x) * static_cast<double>(x.size() - 1); };
  for (const SignalPair& pair : experiments_) {
    samples_ += pair.time.size();
    const double of_input = squares(pair.input), of_output = squares(pair.output);
    input_squares += of_input;
    output_squares_ += of_output;
    for (const auto& [signal, sum] : {std::pair(&pair.time, pair.time.sum()), std::pair(&pair.input, of_input),
                                      std::pair(&pair.output, of_output)}) {
      if (signal->size() != pair.time.size()) return bad_usage("time, input and output differ in length");
      if (std::isfinite(sum)) continue;
      if (const Index bad = first_non_finite(*signal); bad >= 0) {
        return bad_data(fmt::format("sample {} of a signal is not a finite number", bad + 1),
                        "exclude it with --from and --to");
      }
    }
    if (!pair.step && (options_.max_noise_order > 0 || options_.reference_instruments)) {
      return bad_usage("a noise model and the closed-loop variant need uniform sampling", "use --method srivc");
    }
    if (options_.reference_instruments && pair.reference.size() != pair.time.size()) {
      return bad_usage("the closed-loop variant needs the reference", "name it with --reference NAME");
    }
  }
  const Index unknown = n_ + q_ + (options_.free_start ? (n_ + 1) * static_cast<Index>(experiments_.size()) : 0);
  if (samples_ < 2 * unknown + 10) {
    return bad_data(fmt::format("{} samples are too few for {} unknowns", samples_, unknown),
                    "record longer, or use fewer poles");
  }
  if (!(output_squares_ > 0.0)) return bad_data("the output is constant", "check --output");
  if (!(input_squares > 0.0)) return bad_data("the input is constant", "check --input");
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
  const Layout rows = layout_of_covariance();
  const Sums& last = best.last;
  const Index p = rows.parameters();
  const Matrix bread = options_.reference_instruments ? numeric::inverse(last.M)
                                                      : numeric::PivotedCholesky(last.S).solve(Matrix::Identity(p, p));
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
      const Index order = best.noise.size() - 1;
      blocks(k, best.at, rows, best.noise, [&](const Block& block) {
        const auto all = block.matrix(rows.rows());
        Eigen::RowVectorXd e = all.row(rows.e());
        Matrix instruments = all(z, Eigen::all);
        if (rows.free) {
          const auto free = all.middleRows(rows.free_at(), rows.free_size());
          e -= one.free_of_e.transpose() * free;
          instruments -= one.free_of_z.transpose() * free;
        }
        instruments = instruments * e.asDiagonal();
        for (Index c = 0; c < block.columns; ++c) {
          if (block.sample(c) < block.samples) scores.col(begin + block.sample(c) - order) = instruments.col(c);
        }
      });
      at += std::max<Index>(time.size() - order, 0);
      ranges.push_back({begin, at});
    }
    const Index lags = std::min(static_cast<Index>(std::llround(options_.hac_lag_s / step)), last.samples / 10);
    const Matrix middle = numeric::long_run_covariance(p, ranges, lags, [&](const numeric::RowRange& range) {
      return Matrix(scores.middleCols(range.begin, range.size()).transpose());
    });
    const double widening = numeric::newey_west_widening(static_cast<double>(lags) / static_cast<double>(last.samples));
    made.covariance = widening * widening * bread * middle * bread.transpose();
  }
  const Vector physical = best.at.to_seconds();
  made.a = best.at.a.cwiseProduct(physical.head(n_));
  made.b = best.at.b.cwiseProduct(physical.tail(q_));
  if (rows.delay) {
    const double scale = best.at.scale;
    made.delay_variance = made.covariance(p - 1, p - 1) / (scale * scale);
    made.delay_correction = solved(last)[p - 1] / scale;
  }
  const auto of_model = [&](const Matrix& all) -> Matrix {
    return physical.asDiagonal() * all.topLeftCorner(n_ + q_, n_ + q_) * physical.asDiagonal();
  };
  made.covariance = of_model(made.covariance);
  made.white_covariance = of_model(made.white_covariance);
}

Result<ContinuousFit> Fitter::run() {
  MBK_TRY(check());
  for (const SignalPair& pair : experiments_) {
    if (!pair.step) {
      stretched_.emplace_back();
      continue;
    }
    std::vector<const Vector*> signals = {&pair.input, &pair.output};
    Vector clean;  // û
    if (options_.reference_instruments) {
      clean = explained_by_past(pair.reference, pair.input);
      signals.push_back(&clean);
    }
    stretched_.emplace_back(signals, options_.max_noise_order);
    if (!options_.reference_instruments && strided_.size() + 1 == stretched_.size()) {
      strided_.emplace_back(stretched_.back(), pair.time.size());
    }
  }

  const std::vector<double> poles = start_poles();
  std::vector<Search> searches(poles.size());
  MBK_TRY(numeric::parallel_for(static_cast<int>(poles.size()), options_.threads, [&](int i) -> Result<void> {
    const auto k = static_cast<std::size_t>(i);
    searches[k] = search(poles[k]);
    return {};
  }));
  const auto better = [](const Search& a, const Search& b) {
    if (a.start.converged != b.start.converged) return a.start.converged;
    return a.rank < b.rank;
  };
  Search& best = *std::ranges::min_element(searches, better);
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
    made.residuals = std::move(best.residuals);
  }
  return made;
}

}  // namespace

Result<ContinuousFit> fit_continuous(const std::vector<SignalPair>& experiments, const ContinuousFitOptions& options) {
  return Fitter(experiments, options).run();
}

Result<void> check_experiments(const std::vector<SignalPair>& experiments, const ContinuousFitOptions& options) {
  return Fitter(experiments, options).check();
}

Vector simulate_continuous(const Vector& a, const Vector& b, const SignalPair& experiment) {
  const Index n = a.size(), total = experiment.time.size();
  Iterate at{1.0, a, b, {}};
  at.rescale();
  Pass pass(at.a, experiment, at.scale, Vector::Zero(n), 1.0, experiment.held);
  Matrix states(n, kBlock);
  Vector response(total);
  for (Index begin = 0; begin < total; begin += kBlock) {
    const Index count = std::min(kBlock, total - begin);
    pass.run(experiment.input.data() + begin, count, states.leftCols(count));
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
  Iterate at{1.0, a, Vector::Zero(1), {}};
  at.rescale();
  const Matrix free = free_motion(at, experiment);
  const Matrix gram = free * free.transpose();
  return residual - free.transpose() * (pseudo_inverse(gram) * (free * residual));
}

}  // namespace mbk::identify
