#include "mbk/base/dsp/simd_lanes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mbk/base/core/vector4.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors are passed between functions that are inlined always
#endif

namespace mbk::dsp {
namespace {

// ---- columns and rows ----

[[gnu::always_inline]] inline void transpose(Vector4& a, Vector4& b, Vector4& c, Vector4& d) {
  const Vector4 even_ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), odd_ab = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Vector4 even_cd = __builtin_shufflevector(c, d, 0, 4, 2, 6), odd_cd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(even_ab, even_cd, 0, 1, 4, 5);
  b = __builtin_shufflevector(odd_ab, odd_cd, 0, 1, 4, 5);
  c = __builtin_shufflevector(even_ab, even_cd, 2, 3, 6, 7);
  d = __builtin_shufflevector(odd_ab, odd_cd, 2, 3, 6, 7);
}

[[gnu::always_inline]] inline void interleave_body(const double* const* columns, Index count, const double* less,
                                                   double gain, double* to) {
  const Vector4 subtract = four(less);
  Index i = 0;
  for (; i + 4 <= count; i += 4, to += 16) {
    Vector4 a = four(columns[0] + i), b = four(columns[1] + i), c = four(columns[2] + i), d = four(columns[3] + i);
    transpose(a, b, c, d);
    four(to) = (a - subtract) * gain;
    four(to + 4) = (b - subtract) * gain;
    four(to + 8) = (c - subtract) * gain;
    four(to + 12) = (d - subtract) * gain;
  }
  for (; i < count; ++i, to += 4) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) to[lane] = (columns[lane][i] - less[lane]) * gain;
  }
}
void interleave_any(const double* const* columns, Index count, const double* less, double gain, double* to) {
  interleave_body(columns, count, less, gain, to);
}
MBK_X86_64_V3 void interleave_v3(const double* const* columns, Index count, const double* less, double gain,
                                 double* to) {
  interleave_body(columns, count, less, gain, to);
}

[[gnu::always_inline]] inline void separate_body(const double* from, Index width, Index count, double gain,
                                                 const double* plus, double* const* columns) {
  const Vector4 add = four(plus);
  Index i = 0;
  for (; i + 4 <= count; i += 4, from += 4 * width) {
    Vector4 a = four(from), b = four(from + width), c = four(from + 2 * width), d = four(from + 3 * width);
    a = a * gain + add;
    b = b * gain + add;
    c = c * gain + add;
    d = d * gain + add;
    transpose(a, b, c, d);
    four(columns[0] + i) = a;
    four(columns[1] + i) = b;
    four(columns[2] + i) = c;
    four(columns[3] + i) = d;
  }
  for (; i < count; ++i, from += width) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) columns[lane][i] = from[lane] * gain + plus[lane];
  }
}
void separate_any(const double* from, Index width, Index count, double gain, const double* plus,
                  double* const* columns) {
  separate_body(from, width, count, gain, plus, columns);
}
MBK_X86_64_V3 void separate_v3(const double* from, Index width, Index count, double gain, const double* plus,
                               double* const* columns) {
  separate_body(from, width, count, gain, plus, columns);
}

// ---- Savitzky–Golay by running sums ----

/// The four values at `row`, or beside them the four of the segment that runs at the same time, `apart` doubles on.
template <class Lanes>
[[gnu::always_inline]] inline typename Lanes::V block_row(const double* row, Index apart) {
  if constexpr (Lanes::kWidth == Eight::kWidth) {
    return __builtin_shufflevector(Vector4(four(row)), Vector4(four(row + apart)), 0, 1, 2, 3, 4, 5, 6, 7);
  } else {
    return four(row);
  }
}

/// What a row is made of: pieces of `size` values of the results, which lie derivative by derivative.
struct Pieces {
  const std::size_t* from;
  std::size_t count;
  bool pairs;  ///< of two values, else of one
};

[[gnu::always_inline]] inline void put(const double* results, const Pieces& pieces, double* to) {
  if (pieces.pairs) {
    for (std::size_t k = 0; k < pieces.count; ++k) std::copy_n(results + pieces.from[k], 2, to + 2 * k);
  } else {
    for (std::size_t k = 0; k < pieces.count; ++k) to[k] = results[pieces.from[k]];
  }
}

/// At most `half` rows of one segment, or of two side by side, which lie `half` rows apart.
template <class Lanes, std::size_t Sums, std::size_t Derivatives>
[[gnu::always_inline]] inline void smooth_body(const RunningSums& f, const double* row, Index count,
                                               const Pieces& pieces, double* to, Index width) {
  using V = typename Lanes::V;
  constexpr auto kWidth = static_cast<std::size_t>(Lanes::kWidth);
  const Index window = 2 * f.half + 1, apart = 4 * f.half;
  const double* const leave = f.binomial.data();                                // C(−h, k)
  const double* const enter = leave + Sums * static_cast<std::size_t>(window);  // C(h + 1, k)
  double share[Derivatives][Sums];
  for (std::size_t d = 0; d < Derivatives; ++d) std::copy_n(f.shares.data() + d * Sums, Sums, share[d]);

  V sum[Sums] = {};
  const double* weight = f.binomial.data();
  for (Index j = 0; j < window; ++j, weight += Sums) {
    const V x = block_row<Lanes>(row + 4 * j, apart);
    for (std::size_t k = 0; k < Sums; ++k) sum[k] += weight[k] * x;
  }
  for (Index i = 0;; row += 4, to += width) {
    alignas(64) double results[Derivatives * kWidth];
    for (std::size_t d = 0; d < Derivatives; ++d) {
      V value = share[d][0] * sum[0];
      for (std::size_t k = 1; k < Sums; ++k) value += share[d][k] * sum[k];
      Lanes::at(results + kWidth * d) = value;
    }
    put(results, pieces, to);
    if constexpr (kWidth > kLanes) put(results + kLanes, pieces, to + width * f.half);
    if (++i == count) return;
    const V old = block_row<Lanes>(row, apart), young = block_row<Lanes>(row + 4 * window, apart);
    sum[0] += young - old;
    for (std::size_t k = 1; k < Sums; ++k) sum[k] += enter[k] * young - leave[k] * old - sum[k - 1];
  }
}
template <std::size_t Sums, std::size_t Derivatives>
void smooth_any(const RunningSums& f, const double* row, Index count, const Pieces& pieces, double* to, Index width) {
  smooth_body<Four, Sums, Derivatives>(f, row, count, pieces, to, width);
}
template <std::size_t Sums, std::size_t Derivatives>
MBK_X86_64_V3 void smooth_v3(const RunningSums& f, const double* row, Index count, const Pieces& pieces, double* to,
                             Index width) {
  smooth_body<Four, Sums, Derivatives>(f, row, count, pieces, to, width);
}
template <std::size_t Sums, std::size_t Derivatives>
MBK_X86_64_V4 void smooth_v4(const RunningSums& f, const double* row, Index count, const Pieces& pieces, double* to,
                             Index width) {
  smooth_body<Eight, Sums, Derivatives>(f, row, count, pieces, to, width);
}

// ---- every step-th sample ----

/// One row of results, or two at a time.
template <class Lanes, std::size_t Derivatives>
[[gnu::always_inline]] inline void correlate_body(const double* weights, Index window, const double* rows, Index step,
                                                  Index count, double* to) {
  using V = typename Lanes::V;
  constexpr Index kAtOnce = 4;  // sums that do not wait for each other
  constexpr Index kRows = Lanes::kWidth / static_cast<Index>(kLanes);
  constexpr std::size_t kResults = kLanes * Derivatives;
  for (Index i = 0; i + kRows <= count; i += kRows, rows += 4 * step * kRows, to += kResults * kRows) {
    V sum[Derivatives][kAtOnce] = {};
    Index j = 0;
    for (; j + kAtOnce <= window; j += kAtOnce) {
      for (Index a = 0; a < kAtOnce; ++a) {
        const V x = block_row<Lanes>(rows + 4 * (j + a), 4 * step);
        for (std::size_t d = 0; d < Derivatives; ++d) sum[d][a] += weights[static_cast<Index>(d) * window + j + a] * x;
      }
    }
    for (; j < window; ++j) {
      const V x = block_row<Lanes>(rows + 4 * j, 4 * step);
      for (std::size_t d = 0; d < Derivatives; ++d) sum[d][0] += weights[static_cast<Index>(d) * window + j] * x;
    }
    for (std::size_t d = 0; d < Derivatives; ++d) {
      alignas(64) double total[Lanes::kWidth];
      Lanes::at(total) = (sum[d][0] + sum[d][1]) + (sum[d][2] + sum[d][3]);
      for (Index r = 0; r < kRows; ++r) {
        std::copy_n(total + 4 * r, kLanes, to + kResults * static_cast<std::size_t>(r) + kLanes * d);
      }
    }
  }
}
template <std::size_t Derivatives>
void correlate_any(const double* weights, Index window, const double* rows, Index step, Index count, double* to) {
  correlate_body<Four, Derivatives>(weights, window, rows, step, count, to);
}
template <std::size_t Derivatives>
MBK_X86_64_V3 void correlate_v3(const double* weights, Index window, const double* rows, Index step, Index count,
                                double* to) {
  correlate_body<Four, Derivatives>(weights, window, rows, step, count, to);
}
template <std::size_t Derivatives>
MBK_X86_64_V4 void correlate_v4(const double* weights, Index window, const double* rows, Index step, Index count,
                                double* to) {
  correlate_body<Eight, Derivatives>(weights, window, rows, step, count, to);
}

/// Stirling numbers of the second kind times k!: jᵐ = Σ_k S(m, k) k! C(j, k).
double power_in_binomials(int m, int k) {
  if (m == 0 || k == 0) return m == k ? 1.0 : 0.0;
  return static_cast<double>(k) * (power_in_binomials(m - 1, k) + power_in_binomials(m - 1, k - 1));
}

}  // namespace

void interleave(const FourColumns& columns, Index count, const FourValues& less, double gain, double* to) {
  (has_x86_64_v3() ? interleave_v3 : interleave_any)(columns.data(), count, less.data(), gain, to);
}

void separate(const double* from, Index width, Index count, double gain, const FourValues& plus,
              const std::array<double*, kLanes>& columns) {
  if (std::ranges::find(columns, nullptr) == columns.end()) {
    (has_x86_64_v3() ? separate_v3 : separate_any)(from, width, count, gain, plus.data(), columns.data());
    return;
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (columns[lane] == nullptr) continue;
    const double* value = from + lane;
    for (Index i = 0; i < count; ++i, value += width) columns[lane][i] = *value * gain + plus[lane];
  }
}

// ---- the low-pass ----

struct OneWayLoops {
  using Section = OneWay::Section;

  /// @param state  of the lanes of this part; `width` doubles from one of its rows to the next    @param stride doubles
  template <class Lanes, std::size_t Count, bool Short>
  [[gnu::always_inline]] static void body(const Section* given, double* state, Index width, double* at, Index count,
                                          Index stride) {
    using V = typename Lanes::V;
    Section sections[Count];
    std::copy_n(given, Count, sections);
    V w1[Count], w2[Count];
    for (std::size_t k = 0; k < Count; ++k) {
      w1[k] = Lanes::at(state + 2 * static_cast<Index>(k) * width);
      w2[k] = Lanes::at(state + (2 * static_cast<Index>(k) + 1) * width);
    }
    for (Index i = 0; i < count; ++i, at += stride) {
      V value = Lanes::at(at);
      for (std::size_t k = 0; k < Count; ++k) {
        const Section& s = sections[k];
        if (Short && k == 0) {
          const V w = value - s.a1 * w1[k];
          value = w + s.n1 * w1[k];
          w1[k] = w;
        } else {
          const V w = value - s.a2 * w2[k] - s.a1 * w1[k];
          value = w + s.n1 * w1[k] + s.n2 * w2[k];
          w2[k] = w1[k];
          w1[k] = w;
        }
      }
      Lanes::at(at) = value;
    }
    for (std::size_t k = 0; k < Count; ++k) {
      Lanes::at(state + 2 * static_cast<Index>(k) * width) = w1[k];
      Lanes::at(state + (2 * static_cast<Index>(k) + 1) * width) = w2[k];
    }
  }
  template <std::size_t Count, bool Short>
  static void any(const Section* sections, double* state, Index width, double* at, Index count, Index stride) {
    body<Four, Count, Short>(sections, state, width, at, count, stride);
  }
  template <std::size_t Count, bool Short>
  MBK_X86_64_V3 static void v3(const Section* sections, double* state, Index width, double* at, Index count,
                               Index stride) {
    body<Four, Count, Short>(sections, state, width, at, count, stride);
  }
  template <std::size_t Count, bool Short>
  MBK_X86_64_V4 static void v4(const Section* sections, double* state, Index width, double* at, Index count,
                               Index stride) {
    body<Eight, Count, Short>(sections, state, width, at, count, stride);
  }
};

namespace {

constexpr std::size_t kSectionsAtOnce = 4;
using OneWayRun = void (*)(const OneWayLoops::Section*, double*, Index, double*, Index, Index);
using OneWayRuns = std::array<std::array<OneWayRun, 2>, kSectionsAtOnce>;  // by sections, whether the first is short
constexpr OneWayRuns kOneWayAny = {{{OneWayLoops::any<1, false>, OneWayLoops::any<1, true>},
                                    {OneWayLoops::any<2, false>, OneWayLoops::any<2, true>},
                                    {OneWayLoops::any<3, false>, OneWayLoops::any<3, true>},
                                    {OneWayLoops::any<4, false>, OneWayLoops::any<4, true>}}};
constexpr OneWayRuns kOneWayV3 = {{{OneWayLoops::v3<1, false>, OneWayLoops::v3<1, true>},
                                   {OneWayLoops::v3<2, false>, OneWayLoops::v3<2, true>},
                                   {OneWayLoops::v3<3, false>, OneWayLoops::v3<3, true>},
                                   {OneWayLoops::v3<4, false>, OneWayLoops::v3<4, true>}}};
constexpr OneWayRuns kOneWayV4 = {{{OneWayLoops::v4<1, false>, OneWayLoops::v4<1, true>},
                                   {OneWayLoops::v4<2, false>, OneWayLoops::v4<2, true>},
                                   {OneWayLoops::v4<3, false>, OneWayLoops::v4<3, true>},
                                   {OneWayLoops::v4<4, false>, OneWayLoops::v4<4, true>}}};

bool is_short(const SecondOrderSection& s) {
  return s.a2 == 0.0 && s.b2 == 0.0;
}

}  // namespace

bool OneWay::can_run(const SectionCascade& filter) {
  return std::ranges::none_of(filter, [](const SecondOrderSection& s) { return s.b0 == 0.0; });
}

double OneWay::gain(const SectionCascade& filter) {
  double gain = 1.0;
  for (const SecondOrderSection& s : filter) gain *= s.b0;
  return gain;
}

OneWay::OneWay(const SectionCascade& filter, Index width)
    : state_(2 * filter.size() * static_cast<std::size_t>(width)), width_(width) {
  for (const bool now_short : {true, false}) {
    for (const SecondOrderSection& s : filter) {
      if (is_short(s) == now_short) sections_.push_back({s.a1, s.a2, s.b1 / s.b0, s.b2 / s.b0});
    }
    if (now_short) first_is_short_ = !sections_.empty();
  }
}

void OneWay::settle(const double* row) {
  for (Index lane = 0; lane < width_; ++lane) {
    double value = row[lane];
    double* state = state_.data() + lane;
    for (const Section& s : sections_) {
      const double w = value / (1.0 + s.a1 + s.a2);
      state[0] = state[width_] = w;
      value = w * (1.0 + s.n1 + s.n2);
      state += 2 * width_;
    }
  }
}

void OneWay::run(double* at, Index count, Index step) {
  for (std::size_t first = 0; first < sections_.size(); first += kSectionsAtOnce) {
    const std::size_t some = std::min(kSectionsAtOnce, sections_.size() - first);
    const std::size_t is_first_short = first == 0 && first_is_short_ ? 1 : 0;
    double* const state = state_.data() + 2 * static_cast<Index>(first) * width_;
    for (Index lane = 0; lane < width_;) {
      const bool eight = has_x86_64_v4() && lane + 8 <= width_;
      const OneWayRuns& runs = eight ? kOneWayV4 : has_x86_64_v3() ? kOneWayV3 : kOneWayAny;
      runs[some - 1][is_first_short](sections_.data() + first, state + lane, width_, at + lane, count, step * width_);
      lane += eight ? 8 : 4;
    }
  }
}

// ---- running sums ----

bool has_running_sums(const SavitzkyGolay& filter) {
  constexpr int kShortest = 31;  // shorter ones are as quick directly, and lose digits
  return filter.window >= kShortest && (filter.order == 2 || filter.order == 4 || filter.order == 6);
}

Result<RunningSums> running_sums(const SavitzkyGolay& filter, std::span<const int> derivatives, double rate) {
  RunningSums f;
  f.half = filter.half_window();
  const int order = filter.order;
  f.sums = static_cast<std::size_t>(order) + 1;
  for (Index j = -f.half; j <= f.half + 1; ++j) {
    double binomial = 1.0;
    for (int k = 0; k <= order; ++k) {
      f.binomial.push_back(binomial);
      binomial *= static_cast<double>(j - k) / static_cast<double>(k + 1);
    }
  }
  for (const int derivative : derivatives) {
    const auto weights = MBK_TRY(savitzky_golay_polynomial(filter, derivative));
    for (int k = 0; k <= order; ++k) {
      double share = 0.0;
      for (int m = order; m >= k; --m) share += weights.powers[m] * power_in_binomials(m, k);
      f.shares.push_back(share * std::pow(rate, derivative));
    }
  }
  return f;
}

void smooth(const RunningSums& f, const double* rows, Index count, std::span<const std::size_t> picks, double* to) {
  using Smooth = void (*)(const RunningSums&, const double*, Index, const Pieces&, double*, Index);
  static constexpr Smooth kSmooth[3][3][kMaxDerivatives] = {{{smooth_any<3, 1>, smooth_any<3, 2>, smooth_any<3, 3>},
                                                             {smooth_any<5, 1>, smooth_any<5, 2>, smooth_any<5, 3>},
                                                             {smooth_any<7, 1>, smooth_any<7, 2>, smooth_any<7, 3>}},
                                                            {{smooth_v3<3, 1>, smooth_v3<3, 2>, smooth_v3<3, 3>},
                                                             {smooth_v3<5, 1>, smooth_v3<5, 2>, smooth_v3<5, 3>},
                                                             {smooth_v3<7, 1>, smooth_v3<7, 2>, smooth_v3<7, 3>}},
                                                            {{smooth_v4<3, 1>, smooth_v4<3, 2>, smooth_v4<3, 3>},
                                                             {smooth_v4<5, 1>, smooth_v4<5, 2>, smooth_v4<5, 3>},
                                                             {smooth_v4<7, 1>, smooth_v4<7, 2>, smooth_v4<7, 3>}}};
  const std::size_t order = f.sums / 2 - 1, derivative = f.shares.size() / f.sums - 1;
  const auto width = static_cast<Index>(picks.size());
  bool pairs = true;
  for (std::size_t k = 0; k < picks.size(); k += 2) {
    pairs = pairs && picks[k] % 2 == 0 && picks[k + 1] == picks[k] + 1;
  }
  const auto run = [&](std::size_t kind, std::size_t block_row, Index first, Index length) {
    std::array<std::size_t, kLanes * kMaxDerivatives> from{};
    Pieces pieces{from.data(), 0, pairs};
    for (std::size_t k = 0; k < picks.size(); k += pairs ? 2 : 1) {
      from[pieces.count++] = block_row * (picks[k] / kLanes * kLanes) + picks[k] % kLanes;
    }
    kSmooth[kind][order][derivative](f, rows + 4 * first, length, pieces, to + width * first, width);
  };
  Index i = 0;
  if (has_x86_64_v4()) {
    for (; i + 2 * f.half <= count; i += 2 * f.half) run(2, 2, i, f.half);
  }
  for (; i < count; i += f.half) run(has_x86_64_v3() ? 1 : 0, 1, i, std::min(f.half, count - i));
}

void correlate_every(std::span<const double> weights, std::size_t derivatives, const double* rows, Index step,
                     Index count, double* to) {
  using Correlate = void (*)(const double*, Index, const double*, Index, Index, double*);
  static constexpr Correlate kCorrelate[3][kMaxDerivatives] = {{correlate_any<1>, correlate_any<2>, correlate_any<3>},
                                                               {correlate_v3<1>, correlate_v3<2>, correlate_v3<3>},
                                                               {correlate_v4<1>, correlate_v4<2>, correlate_v4<3>}};
  const auto window = static_cast<Index>(weights.size() / derivatives);
  const auto run = [&](std::size_t kind, Index first, Index rows_of_results) {
    kCorrelate[kind][derivatives - 1](weights.data(), window, rows + 4 * step * first, step, rows_of_results,
                                      to + static_cast<Index>(kLanes * derivatives) * first);
  };
  const Index twos = has_x86_64_v4() ? count / 2 * 2 : 0;
  run(2, 0, twos);
  run(has_x86_64_v3() ? 1 : 0, twos, count - twos);
}

}  // namespace mbk::dsp
