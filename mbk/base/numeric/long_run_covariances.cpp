#include "mbk/base/numeric/long_run_covariances.h"

#include <algorithm>
#include <array>

#include "mbk/base/core/vector4.h"

namespace mbk::numeric {
namespace {

constexpr Index kTogether = 512;  // rows whose windows stay in the caches
constexpr Index kApart = 8;       // more from one column to the next: at a power of two all would share a few lines
constexpr std::array<double, kTogether> kNothing{};

/// v becomes [v₀, v₀ + v₁, …] + sum, and sum the last of these.
[[gnu::always_inline]] inline void run_up(Vector4& v, Vector4& sum) {
  const Vector4 zero{};
  v += __builtin_shufflevector(v, zero, 4, 0, 1, 2);
  v += __builtin_shufflevector(v, zero, 4, 5, 0, 1);
  v += sum;
  sum = __builtin_shufflevector(v, v, 3, 3, 3, 3);
}
[[gnu::always_inline]] inline void run_up(Vector8& v, Vector8& sum) {
  const Vector8 zero{};
  v += __builtin_shufflevector(v, zero, 8, 0, 1, 2, 3, 4, 5, 6);
  v += __builtin_shufflevector(v, zero, 8, 9, 0, 1, 2, 3, 4, 5);
  v += __builtin_shufflevector(v, zero, 8, 9, 10, 11, 0, 1, 2, 3);
  v += sum;
  sum = __builtin_shufflevector(v, v, 7, 7, 7, 7, 7, 7, 7, 7);
}

/// A window that moves along one column of scores.
struct Moving {
  const double *left, *right;            ///< factors of what enters
  const double *left_left, *right_left;  ///< and of what leaves
  double sum;                            ///< before the first row
  double* to;
};

/// sum += enters − leaves, row by row; several columns, none of which waits for another.
template <class Lanes, std::size_t Count>
[[gnu::always_inline]] inline void move_together(Moving* columns, Index rows) {
  typename Lanes::V sum[Count];
  for (std::size_t j = 0; j < Count; ++j) sum[j] = columns[j].sum + typename Lanes::V{};
  Index t = 0;
  for (; t + Lanes::kWidth <= rows; t += Lanes::kWidth) {
    for (std::size_t j = 0; j < Count; ++j) {
      const Moving& one = columns[j];
      typename Lanes::V window = Lanes::at(one.left + t) * Lanes::at(one.right + t) -
                                 Lanes::at(one.left_left + t) * Lanes::at(one.right_left + t);
      run_up(window, sum[j]);
      Lanes::at(one.to + t) = window;
    }
  }
  for (std::size_t j = 0; j < Count; ++j) {
    Moving& one = columns[j];
    one.sum = sum[j][0];
    for (Index i = t; i < rows; ++i) {
      one.to[i] = one.sum += one.left[i] * one.right[i] - one.left_left[i] * one.right_left[i];
    }
  }
}

template <class Lanes>
[[gnu::always_inline]] inline void move_body(Moving* columns, std::size_t count, Index rows) {
  std::size_t j = 0;
  for (; j + 4 <= count; j += 4) move_together<Lanes, 4>(columns + j, rows);
  for (; j < count; ++j) move_together<Lanes, 1>(columns + j, rows);
}
void move_any(Moving* columns, std::size_t count, Index rows) {
  move_body<Four>(columns, count, rows);
}
MBK_X86_64_V3 void move_v3(Moving* columns, std::size_t count, Index rows) {
  move_body<Four>(columns, count, rows);
}
MBK_X86_64_V4 void move_v4(Moving* columns, std::size_t count, Index rows) {
  move_body<Eight>(columns, count, rows);
}

/// Sums of the scores of a range over windows [t − lags, t], clipped to the range, and the products of these sums.
class Windows {
 public:
  Windows(Index kinds, Index k, Index lags)
      : k_(k),
        before_(lags + 1),
        windows_(kTogether + kApart, kinds * k),
        moving_(static_cast<std::size_t>(kinds * k)) {
    for (Index kind = 0; kind < kinds; ++kind) grams_.emplace_back(k);
  }

  void begin_range() {
    for (Moving& one : moving_) one.sum = 0.0;
  }

  /// @param rows  of the windows    @param first  row of the products    @param size  of the range
  void move(const RowRange& rows, const ScoreProducts& products, Index first, Index size) {
    for (Index t = rows.begin; t < rows.end;) {
      Index end = std::min(t + kTogether, rows.end);
      for (const Index edge : {before_, size}) {
        if (t < edge) end = std::min(end, edge);
      }
      for (std::size_t j = 0; j < moving_.size(); ++j) {
        Moving& one = moving_[j];
        const auto factor = [&](const double* column, Index row) {
          return row >= 0 && row < size ? column + (row - first) : kNothing.data();
        };
        one = {factor(products.left[j], t),
               factor(products.right[j], t),
               factor(products.left[j], t - before_),
               factor(products.right[j], t - before_),
               one.sum,
               windows_.col(static_cast<Index>(j)).data()};
      }
      const auto run = has_x86_64_v4() ? move_v4 : has_x86_64_v3() ? move_v3 : move_any;
      run(moving_.data(), moving_.size(), end - t);
      for (Index kind = 0; kind < std::ssize(grams_); ++kind) {
        grams_[static_cast<std::size_t>(kind)].add(windows_.block(0, kind * k_, end - t, k_));
      }
      t = end;
    }
  }

  [[nodiscard]] std::vector<Matrix> covariances() const {
    std::vector<Matrix> omegas;
    for (const GramSum& one : grams_) omegas.emplace_back(one.gram() / static_cast<double>(before_));
    return omegas;
  }

 private:
  Index k_, before_;
  Matrix windows_;
  std::vector<Moving> moving_;
  std::vector<GramSum> grams_;
};

/// Behind so many rows the `lags` + 1 that are asked for again cost little.
Index rows_at_once(Index lags) {
  constexpr Index kAtLeast = 1024;
  return std::max(kAtLeast, 4 * (lags + 1));
}

}  // namespace

std::vector<Matrix> long_run_covariances(Index kinds, Index k, const std::vector<RowRange>& ranges, Index lags,
                                         const std::function<ScoreProducts(const RowRange&)>& products_of) {
  Windows windows(kinds, k, lags);
  const Index step = rows_at_once(lags);
  for (const RowRange& range : ranges) {
    windows.begin_range();
    const Index size = range.size();
    for (Index t = 0; size > 0 && t < size + lags; t += step) {
      const Index end = std::min(t + step, size + lags), first = std::max<Index>(0, t - (lags + 1));
      windows.move({t, end}, products_of({range.begin + first, range.begin + std::min(end, size)}), first, size);
    }
  }
  return windows.covariances();
}

Matrix long_run_covariance(Index k, const std::vector<RowRange>& ranges, Index lags,
                           const std::function<Matrix(const RowRange&)>& scores_of) {
  const Index rows = rows_at_once(lags) + lags + 1;
  Matrix scores(rows, k);
  const Vector one = Vector::Ones(rows);
  RowRange there;
  const auto products_of = [&](const RowRange& requested) {
    const bool goes_on = there.begin <= requested.begin && requested.begin < there.end;
    const Index kept = goes_on ? there.end - requested.begin : 0;
    if (kept > 0) scores.topRows(kept) = scores.middleRows(requested.begin - there.begin, kept).eval();
    if (requested.size() > kept) {
      scores.middleRows(kept, requested.size() - kept) = scores_of({requested.begin + kept, requested.end});
    }
    there = requested;
    ScoreProducts products;
    for (Index j = 0; j < k; ++j) {
      products.left.push_back(scores.col(j).data());
      products.right.push_back(one.data());
    }
    return products;
  };
  return long_run_covariances(1, k, ranges, lags, products_of).front();
}

}  // namespace mbk::numeric
