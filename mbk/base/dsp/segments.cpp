#include "mbk/base/dsp/segments.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "mbk/base/core/vector4.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors are passed between functions that are inlined always
#endif

namespace mbk::dsp {
namespace {

/// Rows and columns of products that fit the registers, with the rows of the left and one of the right beside them.
template <class Lanes>
constexpr int kTileLeft = Lanes::kWidth == Eight::kWidth ? 4 : 3;
constexpr int kTileRight = 4;

/// @param state  n rows of 16, then the last input    N is n, or 0: any up to kMaxStates
constexpr Index kMaxStates = 32;
template <class Lanes, int N>
[[gnu::always_inline]] inline void filter_body(const double* coefficients, Index states, double* state,
                                               const double* input, Index count, double* to, Index stride) {
  using V = typename Lanes::V;
  constexpr Index kAtOnce = 2;
  constexpr Index kCapacity = N > 0 ? N : kMaxStates;
  const Index n = N > 0 ? N : states;
  for (Index first = 0; first < kSegments; first += kAtOnce * Lanes::kWidth) {
    V x[kCapacity][kAtOnce], next[kCapacity][kAtOnce], last[kAtOnce];
    for (Index w = 0; w < kAtOnce; ++w) {
      const Index lane = first + w * Lanes::kWidth;
      for (Index r = 0; r < n; ++r) x[r][w] = Lanes::at(state + kSegments * r + lane);
      last[w] = Lanes::at(state + kSegments * n + lane);
    }
    for (Index i = 0; i < count; ++i) {
      V now[kAtOnce];
      for (Index w = 0; w < kAtOnce; ++w) now[w] = Lanes::at(input + kSegments * i + first + w * Lanes::kWidth);
      const double* c = coefficients;
      for (Index r = 0; r < n; ++r, c += n + 2) {
        for (Index w = 0; w < kAtOnce; ++w) {
          next[r][w] = c[n] * last[w];
          next[r][w] += c[n + 1] * now[w];
          for (Index k = 0; k < n; ++k) next[r][w] += c[k] * x[k][w];
          Lanes::at(to + r * stride + kSegments * i + first + w * Lanes::kWidth) = next[r][w];
        }
      }
      for (Index w = 0; w < kAtOnce; ++w) {
        for (Index r = 0; r < n; ++r) x[r][w] = next[r][w];
        last[w] = now[w];
      }
    }
    for (Index w = 0; w < kAtOnce; ++w) {
      const Index lane = first + w * Lanes::kWidth;
      for (Index r = 0; r < n; ++r) Lanes::at(state + kSegments * r + lane) = x[r][w];
      Lanes::at(state + kSegments * n + lane) = last[w];
    }
  }
}

/// `Count` rows of to = A [x; u], 16 columns; A is rows×(states + inputs), row by row.
/// @param stride  from one row of x and of `to` to the next
template <class Lanes, int Count>
[[gnu::always_inline]] inline void advance_rows(const double* A, Index states, Index inputs, const double* x,
                                                const double* u, double* to, Index stride) {
  using V = typename Lanes::V;
  constexpr Index kParts = kSegments / Lanes::kWidth;
  const Index across = states + inputs;
  V sum[Count][kParts] = {};
  for (Index k = 0; k < across; ++k) {
    const double* const from = k < states ? x + stride * k : u + kSegments * (k - states);
    for (Index w = 0; w < kParts; ++w) {
      const V value = Lanes::at(from + w * Lanes::kWidth);
      for (int r = 0; r < Count; ++r) sum[r][w] += A[r * across + k] * value;
    }
  }
  for (int r = 0; r < Count; ++r) {
    for (Index w = 0; w < kParts; ++w) Lanes::at(to + stride * r + w * Lanes::kWidth) = sum[r][w];
  }
}
template <class Lanes>
[[gnu::always_inline]] inline void advance_body(const double* A, Index states, Index inputs, const double* x,
                                                const double* u, double* to, Index stride) {
  constexpr int kRows = Lanes::kWidth == 8 ? 4 : 2;
  const Index across = states + inputs;
  Index r = 0;
  for (; r + kRows <= states; r += kRows) {
    advance_rows<Lanes, kRows>(A + r * across, states, inputs, x, u, to + stride * r, stride);
  }
  for (; r < states; ++r) advance_rows<Lanes, 1>(A + r * across, states, inputs, x, u, to + stride * r, stride);
}

template <class Lanes>
[[gnu::always_inline]] inline void combine_body(const double* weights, Index count, const double* from, Index stride,
                                                const double* plus, Index columns, double* to) {
  using V = typename Lanes::V;
  constexpr Index kParts = kSegments / Lanes::kWidth;
  for (Index c = 0; c < columns; c += kSegments) {
    V sum[kParts];
    for (Index w = 0; w < kParts; ++w) sum[w] = Lanes::at(plus + c + w * Lanes::kWidth);
    for (Index k = 0; k < count; ++k) {
      for (Index w = 0; w < kParts; ++w) sum[w] += weights[k] * Lanes::at(from + k * stride + c + w * Lanes::kWidth);
    }
    for (Index w = 0; w < kParts; ++w) Lanes::at(to + c + w * Lanes::kWidth) = sum[w];
  }
}

/// A tile of products; `sums` are eight doubles for each, rows `across` of them apart.
template <class Lanes, int Left, int Right>
[[gnu::always_inline]] inline void tile(Rows left, Rows right, Index columns, double* sums, Index across) {
  using V = typename Lanes::V;
  V sum[Left][Right];
  for (Index i = 0; i < Left; ++i) {
    for (Index j = 0; j < Right; ++j) sum[i][j] = Lanes::at(sums + 8 * (i * across + j));
  }
  const double *from_left[Left], *from_right[Right];
  for (Index i = 0; i < Left; ++i) from_left[i] = left.row(i);
  for (Index j = 0; j < Right; ++j) from_right[j] = right.row(j);
  for (Index c = 0, l = 0, r = 0; c < columns; c += kSegments, l += left.step, r += right.step) {
    for (Index lane = 0; lane < kSegments; lane += Lanes::kWidth) {
      V a[Left];
      for (Index i = 0; i < Left; ++i) {
        a[i] = Lanes::at(from_left[i] + l + lane);
        keep_in_register<Lanes>(a[i]);
      }
      for (Index j = 0; j < Right; ++j) {
        V b = Lanes::at(from_right[j] + r + lane);
        keep_in_register<Lanes>(b);
        for (Index i = 0; i < Left; ++i) sum[i][j] += a[i] * b;
      }
    }
  }
  for (Index i = 0; i < Left; ++i) {
    for (Index j = 0; j < Right; ++j) Lanes::at(sums + 8 * (i * across + j)) = sum[i][j];
  }
}
/// @param j  the first on the right; before it there are whole tiles
template <class Lanes, int Left>
[[gnu::always_inline]] inline void tiles_across(Rows left, Rows right, Index j, Index across, Index columns,
                                                double* sums) {
  for (; j + kTileRight <= across; j += kTileRight) {
    tile<Lanes, Left, kTileRight>(left, right.from_row(j), columns, sums + 8 * j, across);
  }
  const Rows rest = right.from_row(j);
  switch (across - j) {
    case 1:
      return tile<Lanes, Left, 1>(left, rest, columns, sums + 8 * j, across);
    case 2:
      return tile<Lanes, Left, 2>(left, rest, columns, sums + 8 * j, across);
    case 3:
      return tile<Lanes, Left, 3>(left, rest, columns, sums + 8 * j, across);
    default:
      return;
  }
}
/// @param upper  without tiles that have nothing on or above the diagonal
template <class Lanes>
[[gnu::always_inline]] inline void products_body(Rows left, Index down, Rows right, Index across, bool upper,
                                                 Index columns, double* sums) {
  constexpr int kTile = kTileLeft<Lanes>;
  const auto first = [&](Index i) { return upper ? i / kTileRight * kTileRight : 0; };
  Index i = 0;
  for (; i + kTile <= down; i += kTile) {
    tiles_across<Lanes, kTile>(left.from_row(i), right, first(i), across, columns, sums + 8 * i * across);
  }
  const Rows rest = left.from_row(i);
  double* const to = sums + 8 * i * across;
  switch (down - i) {
    case 1:
      return tiles_across<Lanes, 1>(rest, right, first(i), across, columns, to);
    case 2:
      return tiles_across<Lanes, 2>(rest, right, first(i), across, columns, to);
    case 3:
      return tiles_across<Lanes, 3>(rest, right, first(i), across, columns, to);
    default:
      return;
  }
}

/// @param sums  eight doubles for each row
template <class Lanes, int Count>
[[gnu::always_inline]] inline void squares_of(Rows rows, Index columns, double* sums) {
  constexpr Index kParts = kSegments / Lanes::kWidth;  // of a sum, which do not wait for each other
  typename Lanes::V sum[Count][kParts] = {};
  for (Index c = 0; c < columns; c += kSegments) {
    for (int i = 0; i < Count; ++i) {
      for (Index w = 0; w < kParts; ++w) {
        const typename Lanes::V a = Lanes::at(rows.data + i * rows.stride + c + w * Lanes::kWidth);
        sum[i][w] += a * a;
      }
    }
  }
  for (int i = 0; i < Count; ++i) {
    for (Index w = 0; w < kParts; ++w) Lanes::at(sums + 8 * i) += sum[i][w];
  }
}
template <class Lanes>
[[gnu::always_inline]] inline void squares_body(Rows rows, Index count, Index columns, double* sums) {
  constexpr int kAtOnce = 2;
  Index i = 0;
  for (; i + kAtOnce <= count; i += kAtOnce) {
    squares_of<Lanes, kAtOnce>({rows.row(i), rows.stride}, columns, sums + 8 * i);
  }
  for (; i < count; ++i) squares_of<Lanes, 1>({rows.row(i), rows.stride}, columns, sums + 8 * i);
}

// ---- for each kind of processor ----

using Filter = void (*)(const double*, Index, double*, const double*, Index, double*, Index);
constexpr int kMaxFixed = 8;

struct Loops {
  std::array<Filter, kMaxFixed + 1> filter;  ///< by the number of states; the first: of any number
  void (*advance)(const double*, Index, Index, const double*, const double*, double*, Index);
  void (*combine)(const double*, Index, const double*, Index, const double*, Index, double*);
  void (*products)(Rows, Index, Rows, Index, bool, Index, double*);
  void (*squares)(Rows, Index, Index, double*);
};

#define MBK_LOOPS(NAME, LANES, TARGET)                                                                              \
  struct NAME {                                                                                                     \
    template <int N>                                                                                                \
    TARGET static void filter(const double* coefficients, Index n, double* state, const double* input, Index count, \
                              double* to, Index stride) {                                                           \
      filter_body<LANES, N>(coefficients, n, state, input, count, to, stride);                                      \
    }                                                                                                               \
    TARGET static void advance(const double* A, Index states, Index inputs, const double* x, const double* u,       \
                               double* to, Index stride) {                                                          \
      advance_body<LANES>(A, states, inputs, x, u, to, stride);                                                     \
    }                                                                                                               \
    TARGET static void combine(const double* weights, Index count, const double* from, Index stride,                \
                               const double* plus, Index columns, double* to) {                                     \
      combine_body<LANES>(weights, count, from, stride, plus, columns, to);                                         \
    }                                                                                                               \
    TARGET static void products(Rows left, Index down, Rows right, Index across, bool upper, Index columns,         \
                                double* sums) {                                                                     \
      products_body<LANES>(left, down, right, across, upper, columns, sums);                                        \
    }                                                                                                               \
    TARGET static void squares(Rows rows, Index count, Index columns, double* sums) {                               \
      squares_body<LANES>(rows, count, columns, sums);                                                              \
    }                                                                                                               \
  };
MBK_LOOPS(Any, Four, )
MBK_LOOPS(V3, Four, MBK_X86_64_V3)
MBK_LOOPS(V4, Eight, MBK_X86_64_V4)
#undef MBK_LOOPS

template <class Kind, int... N>
constexpr Loops loops_of(std::integer_sequence<int, N...>) {
  return {{Kind::template filter<N>...}, Kind::advance, Kind::combine, Kind::products, Kind::squares};
}

const Loops& loops() {
  constexpr auto kNumbers = std::make_integer_sequence<int, kMaxFixed + 1>();
  static const Loops kChosen = has_x86_64_v4()   ? loops_of<V4>(kNumbers)
                               : has_x86_64_v3() ? loops_of<V3>(kNumbers)
                                                 : loops_of<Any>(kNumbers);
  return kChosen;
}

/// [Φᶜ, what each of the c + 1 samples adds], row by row.
std::vector<double> over_several(const HeldStep& system, const Matrix& power, Index count) {
  const Index n = system.transition.rows();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> all(n, n + count + 1);
  all.setZero();
  all.leftCols(n) = power;
  Eigen::Matrix<double, Eigen::Dynamic, 2> added(n, 2), next(n, 2);
  added << system.from_last, system.from_next;
  for (Index i = count; i > 0; --i) {
    all.middleCols(n + i - 1, 2) += added;
    next.noalias() = system.transition.lazyProduct(added);
    added.swap(next);
  }
  return {all.data(), all.data() + all.size()};
}

Matrix power_of(Matrix base, Index exponent) {
  Matrix power = Matrix::Identity(base.rows(), base.cols());
  for (; exponent > 0; exponent /= 2) {
    if (exponent % 2 == 1) power = power.lazyProduct(base).eval();
    if (exponent > 1) base = base.lazyProduct(base).eval();
  }
  return power;
}

double* values(std::vector<SampleBlock>& rows) {
  return rows.front().values.data();
}

double added_up(const PartialSums& parts) {
  return std::accumulate(parts.values.begin(), parts.values.end(), 0.0);
}

}  // namespace

Segments::Segments(const std::vector<const Vector*>& signals, Index overlap) {
  const Index samples = signals.front()->size();
  length_ = (samples + kSegments - 1) / kSegments;
  count_ = length_ + 1 + overlap;
  rows_ = std::make_unique_for_overwrite<SampleBlock[]>(signals.size() * static_cast<std::size_t>(count_));
  SampleBlock* row = rows_.get();
  for (const Vector* const signal : signals) {
    const Index full = std::max<Index>(0, samples - (kSegments - 1) * length_);  // rows that all segments have
    const double* from = signal->data();
    for (Index i = 0; i < full; ++i, ++row, ++from) {
      for (Index l = 0; l < kSegments; ++l) row->values[static_cast<std::size_t>(l)] = from[l * length_];
    }
    for (Index i = full; i < count_; ++i, ++row) {
      for (Index l = 0; l < kSegments; ++l) {
        const Index at = l * length_ + i;
        row->values[static_cast<std::size_t>(l)] = at < samples ? (*signal)[at] : 0.0;
      }
    }
  }
}

Index Segments::strides(Index samples) const {
  const Index missing = kSegments * length_ - samples;  // all of them in the last segment
  return std::max<Index>(0, length_ - missing) / kStride;
}

Rows Segments::strided(Index signal, Index stride) const {
  return {at(signal, kStride * stride), kSegments, kStride * kSegments};
}

Matrix states_at_starts(const HeldStep& system, const Segments& signals, Index input) {
  constexpr Index kAtOnce = 32;
  const Index n = system.transition.rows(), length = signals.length(), chunks = length / kAtOnce;
  const auto advance = loops().advance;
  std::vector<SampleBlock> x(static_cast<std::size_t>(n)), next = x;
  const Matrix over_chunk = power_of(system.transition, kAtOnce);
  const std::vector<double> chunk = over_several(system, over_chunk, kAtOnce);
  const std::vector<double> one = over_several(system, system.transition, 1);
  for (Index i = 0; i < length; std::swap(x, next)) {
    const bool whole = i + kAtOnce <= length;
    const Index count = whole ? kAtOnce : 1;
    advance((whole ? chunk : one).data(), n, count + 1, values(x), signals.row(input, i), values(next), kSegments);
    i += count;
  }
  const Matrix over_segment = power_of(over_chunk, chunks) * power_of(system.transition, length % kAtOnce);
  const Eigen::Map<const Matrix> added(values(x), kSegments, n);
  Matrix starts = Matrix::Zero(n, kSegments);
  for (Index l = 1; l < kSegments; ++l) {
    starts.col(l) = over_segment * starts.col(l - 1) + added.row(l - 1).transpose();
  }
  return starts;
}

Matrix free_at_starts(const Matrix& transition, const Vector& state, Index length) {
  const Matrix over_one = power_of(transition, length);
  Matrix starts(state.size(), kSegments);
  starts.col(0) = state;
  for (Index l = 1; l < kSegments; ++l) starts.col(l) = over_one * starts.col(l - 1);
  return starts;
}

HeldStep cascaded(const HeldStep& first, const HeldStep& second, const Vector& weights, double through) {
  const Index n = first.transition.rows();
  HeldStep both{Matrix::Zero(2 * n, 2 * n), Vector(2 * n), Vector(2 * n)};
  const Vector next_of_state = first.transition.transpose() * weights;
  both.transition.topLeftCorner(n, n) = first.transition;
  both.transition.bottomRightCorner(n, n) = second.transition;
  both.transition.bottomLeftCorner(n, n) =
      second.from_last * weights.transpose() + second.from_next * next_of_state.transpose();
  both.from_last << first.from_last, through * second.from_last + weights.dot(first.from_last) * second.from_next;
  both.from_next << first.from_next, (weights.dot(first.from_next) + through) * second.from_next;
  return both;
}

SegmentFilter::SegmentFilter(const HeldStep& filter, const Matrix& starts)
    : state_(static_cast<std::size_t>(starts.rows() + 1)), n_(starts.rows()) {
  for (Index r = 0; r < n_; ++r) {
    for (Index k = 0; k < n_; ++k) coefficients_.push_back(filter.transition(r, k));
    coefficients_.push_back(filter.from_last[r]);
    coefficients_.push_back(filter.from_next[r]);
    for (Index l = 0; l < kSegments; ++l)
      state_[static_cast<std::size_t>(r)].values[static_cast<std::size_t>(l)] = starts(r, l);
  }
}

void SegmentFilter::run(const double* input, Index count, Rows states) {
  Index i = 0;
  if (!begun_ && count > 0) {
    begun_ = true;
    for (Index r = 0; r < n_; ++r) std::ranges::copy(state_[static_cast<std::size_t>(r)].values, states.row(r));
    std::copy_n(input, kSegments, state_.back().values.data());
    i = 1;
  }
  const Filter filter = loops().filter[n_ <= kMaxFixed ? static_cast<std::size_t>(n_) : 0];
  filter(coefficients_.data(), n_, values(state_), input + kSegments * i, count - i, states.data + kSegments * i,
         states.stride);
}

namespace {

/// n×16, where it is held row by row.
std::vector<SampleBlock> rows_of(const Matrix& states) {
  std::vector<SampleBlock> rows(static_cast<std::size_t>(states.rows()));
  Eigen::Map<Matrix>(values(rows), kSegments, states.rows()) = states.transpose();
  return rows;
}

}  // namespace

StridedFilter::StridedFilter(const HeldStep& filter, const Matrix& starts)
    : coefficients_(over_several(filter, power_of(filter.transition, kStride), kStride)),
      state_(rows_of(starts)),
      n_(starts.rows()),
      inputs_(kStride + 1) {}

StridedFilter::StridedFilter(const Matrix& transition, const Matrix& starts)
    : state_(rows_of(starts)), n_(starts.rows()), inputs_(0) {
  const Matrix by_row = power_of(transition, kStride).transpose();
  coefficients_.assign(by_row.data(), by_row.data() + by_row.size());
}

void StridedFilter::run(const double* input, Index count, Rows states) {
  const auto advance = loops().advance;
  const Index last = kSegments * count;
  for (Index r = 0; r < n_; ++r) std::ranges::copy(state_[static_cast<std::size_t>(r)].values, states.row(r));
  for (Index c = 0; c < last; c += kSegments) {
    double* const now = states.data + c;
    advance(coefficients_.data(), n_, inputs_, now, input, now + kSegments, states.stride);
    if (inputs_ > 0) input += kStride * kSegments;
  }
  for (Index r = 0; r < n_; ++r) {
    std::copy_n(states.row(r) + last, kSegments, state_[static_cast<std::size_t>(r)].values.data());
  }
}

Matrix StridedFilter::state() const {
  return Eigen::Map<const Matrix>(state_.front().values.data(), kSegments, n_).transpose();
}

void combine(const Vector& weights, Rows from, const double* plus, Index columns, double* to) {
  loops().combine(weights.data(), weights.size(), from.data, from.stride, plus, columns, to);
}

void Products::add(Rows left, Rows right, Index columns) {
  if (sums_.empty()) return;
  loops().products(left, left_, right, right_, symmetric_, columns, sums_.front().values.data());
}

Matrix Products::total() const {
  Matrix total(left_, right_);
  for (Index i = 0; i < left_; ++i) {
    for (Index j = 0; j < right_; ++j) {
      const Index sum = symmetric_ && j < i ? j * right_ + i : i * right_ + j;
      total(i, j) = added_up(sums_[static_cast<std::size_t>(sum)]);
    }
  }
  return total;
}

void Squares::add(Rows rows, Index columns) {
  if (sums_.empty()) return;
  loops().squares(rows, std::ssize(sums_), columns, sums_.front().values.data());
}

Vector Squares::total() const {
  Vector total(std::ssize(sums_));
  for (Index i = 0; i < total.size(); ++i) total[i] = added_up(sums_[static_cast<std::size_t>(i)]);
  return total;
}

}  // namespace mbk::dsp
