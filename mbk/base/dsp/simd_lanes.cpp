#include "mbk/base/dsp/simd_lanes.h"

#include <algorithm>
#include <cmath>
#include <optional>
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
                                                   double* to) {
  const Vector4 subtract = four(less);
  Index i = 0;
  for (; i + 4 <= count; i += 4, to += 16) {
    Vector4 a = four(columns[0] + i), b = four(columns[1] + i), c = four(columns[2] + i), d = four(columns[3] + i);
    transpose(a, b, c, d);
    four(to) = a - subtract;
    four(to + 4) = b - subtract;
    four(to + 8) = c - subtract;
    four(to + 12) = d - subtract;
  }
  for (; i < count; ++i, to += 4) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) to[lane] = columns[lane][i] - less[lane];
  }
}
MBK_X86_64_V3 void interleave_v3(const double* const* columns, Index count, const double* less, double* to) {
  interleave_body(columns, count, less, to);
}

[[gnu::always_inline]] inline void separate_body(const double* from, Index count, const double* plus,
                                                 double* const* columns) {
  const Vector4 add = four(plus);
  Index i = 0;
  for (; i + 4 <= count; i += 4, from += 16) {
    Vector4 a = four(from) + add, b = four(from + 4) + add, c = four(from + 8) + add, d = four(from + 12) + add;
    transpose(a, b, c, d);
    four(columns[0] + i) = a;
    four(columns[1] + i) = b;
    four(columns[2] + i) = c;
    four(columns[3] + i) = d;
  }
  for (; i < count; ++i, from += 4) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) columns[lane][i] = from[lane] + plus[lane];
  }
}
void separate_any(const double* from, Index count, const double* plus, double* const* columns) {
  separate_body(from, count, plus, columns);
}
MBK_X86_64_V3 void separate_v3(const double* from, Index count, const double* plus, double* const* columns) {
  separate_body(from, count, plus, columns);
}

// ---- the low-pass, both ways ----

/// A section as s1 ← (b1 − a1 b0) u + s2 − a1 s1, s2 ← (b2 − a2 b0) u − a2 s1, y = b0 u + s1: transposed direct form II
/// with the output put in, so that each sample waits for one product only.
struct Section {
  double b0, c1, c2, a1, a2;
};
constexpr std::size_t kSectionsAtOnce = 4;

template <std::size_t Count>
struct State {
  Vector4 s1[Count], s2[Count];
};

template <std::size_t Count>
[[gnu::always_inline]] inline State<Count> settle(const Section* sections, Vector4 input) {
  State<Count> state;
  for (std::size_t k = 0; k < Count; ++k) {
    const Section& s = sections[k];
    // From s1 = c1 u + s2 − a1 s1 and s2 = c2 u − a2 s1.
    state.s1[k] = (s.c1 + s.c2) / (1.0 + s.a1 + s.a2) * input;
    state.s2[k] = s.c2 * input - s.a2 * state.s1[k];
    input = s.b0 * input + state.s1[k];
  }
  return state;
}

template <std::size_t Count>
[[gnu::always_inline]] inline Vector4 step(const Section* sections, State<Count>& state, Vector4 input) {
  for (std::size_t k = 0; k < Count; ++k) {
    const Section& s = sections[k];
    const Vector4 s1 = state.s1[k];
    state.s1[k] = s.c1 * input + state.s2[k] - s.a1 * s1;
    state.s2[k] = s.c2 * input - s.a2 * s1;
    input = s.b0 * input + s1;
  }
  return input;
}

/// One direction; `stride` is +4 or −4 doubles.
template <std::size_t Count>
[[gnu::always_inline]] inline void run_body(const Section* given, double* at, Index count, Index stride,
                                            const double* settled) {
  Section sections[Count];
  std::copy_n(given, Count, sections);
  State<Count> state = settle<Count>(sections, four(settled));
  for (Index i = 0; i < count; ++i, at += stride) four(at) = step<Count>(sections, state, four(at));
}
template <std::size_t Count>
void run(const Section* sections, double* at, Index count, Index stride, const double* settled) {
  run_body<Count>(sections, at, count, stride, settled);
}
template <std::size_t Count>
MBK_X86_64_V3 void run_v3(const Section* sections, double* at, Index count, Index stride, const double* settled) {
  run_body<Count>(sections, at, count, stride, settled);
}

void run_sections(std::span<const Section> sections, double* at, Index count, Index stride, FourValues settled) {
  const bool v3 = has_x86_64_v3();
  for (std::size_t first = 0; first < sections.size(); first += kSectionsAtOnce) {
    const std::span<const Section> some = sections.subspan(first, std::min(kSectionsAtOnce, sections.size() - first));
    using Run = void (*)(const Section*, double*, Index, Index, const double*);
    static constexpr Run kRuns[][kSectionsAtOnce] = {{run<1>, run<2>, run<3>, run<4>},
                                                     {run_v3<1>, run_v3<2>, run_v3<3>, run_v3<4>}};
    kRuns[v3 ? 1 : 0][some.size() - 1](some.data(), at, count, stride, settled.data());
    for (const Section& s : some) {
      for (double& value : settled) value *= s.b0 + (s.c1 + s.c2) / (1.0 + s.a1 + s.a2);
    }
  }
}

// ---- Savitzky–Golay by running sums ----

/// Sums M_k over the window that begins at `row`, from nothing.
template <std::size_t Sums>
[[gnu::always_inline]] inline void start_sums(const RunningSums& f, const double* row, Vector4 (&sum)[Sums]) {
  for (Vector4& one : sum) one = Vector4{};
  const double* weight = f.binomial.data();
  for (Index j = 0; j <= 2 * f.half; ++j, weight += Sums, row += kLanes) {
    const Vector4 x = four(row);
    for (std::size_t k = 0; k < Sums; ++k) sum[k] += weight[k] * x;
  }
}

/// The same one sample later; `row` begins the window so far.
template <std::size_t Sums>
[[gnu::always_inline]] inline void move_sums(const double* enter, const double* leave, const double* row, Index window,
                                             Vector4 (&sum)[Sums]) {
  const Vector4 old = four(row), young = four(row + 4 * window);
  sum[0] += young - old;
  for (std::size_t k = 1; k < Sums; ++k) sum[k] += enter[k] * young - leave[k] * old - sum[k - 1];
}

/// Two lanes of one derivative beside two of another: the halves of a row that most outputs are made of.
struct Pairs {
  double* to;
  int halves;                                   ///< 2·(half of the sums for the first pair) + that for the second
  std::array<double, kLanes * kMaxSums> share;  ///< of each sum, four values: what it contributes to each lane
};

template <std::size_t Sums>
[[gnu::always_inline]] inline Vector4 combined(const double* share, const Vector4 (&sum)[Sums], int halves) {
  Vector4 value = {};
  switch (halves) {
    case 0:
      for (std::size_t k = 0; k < Sums; ++k) {
        value += four(share + kLanes * k) * __builtin_shufflevector(sum[k], sum[k], 0, 1, 0, 1);
      }
      break;
    case 1:
      for (std::size_t k = 0; k < Sums; ++k) value += four(share + kLanes * k) * sum[k];
      break;
    case 2:
      for (std::size_t k = 0; k < Sums; ++k) {
        value += four(share + kLanes * k) * __builtin_shufflevector(sum[k], sum[k], 2, 3, 0, 1);
      }
      break;
    default:
      for (std::size_t k = 0; k < Sums; ++k) {
        value += four(share + kLanes * k) * __builtin_shufflevector(sum[k], sum[k], 2, 3, 2, 3);
      }
  }
  return value;
}

template <std::size_t Sums>
[[gnu::always_inline]] inline void smooth_pairs_body(const RunningSums& f, const double* rows, Index count,
                                                     const Pairs* outputs, std::size_t groups) {
  const Index window = 2 * f.half + 1;
  const double* const leave = f.binomial.data();                                // C(−h, k)
  const double* const enter = leave + Sums * static_cast<std::size_t>(window);  // C(h + 1, k)
  for (Index begin = 0; begin < count; begin += f.half) {
    const Index end = std::min(count, begin + f.half);
    Vector4 sum[Sums];
    start_sums<Sums>(f, rows + 4 * begin, sum);
    for (Index i = begin;; ++i) {
      for (std::size_t g = 0; g < groups; ++g) {
        four(outputs[g].to + 4 * i) = combined<Sums>(outputs[g].share.data(), sum, outputs[g].halves);
      }
      if (i + 1 == end) break;
      move_sums<Sums>(enter, leave, rows + 4 * i, window, sum);
    }
  }
}
template <std::size_t Sums>
void smooth_pairs(const RunningSums& f, const double* rows, Index count, const Pairs* outputs, std::size_t groups) {
  smooth_pairs_body<Sums>(f, rows, count, outputs, groups);
}
template <std::size_t Sums>
MBK_X86_64_V3 void smooth_pairs_v3(const RunningSums& f, const double* rows, Index count, const Pairs* outputs,
                                   std::size_t groups) {
  smooth_pairs_body<Sums>(f, rows, count, outputs, groups);
}

/// The destinations as pairs, or nothing where one of them is made of other lanes.
std::optional<std::vector<Pairs>> as_pairs(const RunningSums& f, std::span<const Destination> destinations) {
  std::vector<Pairs> all;
  for (const auto& [to, from] : destinations) {
    const bool paired = from[0] % 2 == 0 && from[1] == from[0] + 1 && from[2] % 2 == 0 && from[3] == from[2] + 1;
    if (!paired) return std::nullopt;
    const auto half = [](std::size_t place) { return static_cast<int>(place % kLanes / 2); };
    Pairs& one = all.emplace_back(Pairs{to, 2 * half(from[0]) + half(from[2]), {}});
    for (std::size_t k = 0; k < f.sums; ++k) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        one.share[kLanes * k + lane] = f.shares[from[lane] / kLanes * f.sums + k];
      }
    }
  }
  return all;
}

template <std::size_t Sums, std::size_t Derivatives>
[[gnu::always_inline]] inline void smooth_body(const RunningSums& f, const double* rows, Index count,
                                               const Destination* destinations, std::size_t groups) {
  const Index window = 2 * f.half + 1;
  const double* const leaving = f.binomial.data();                                   // C(−h, k)
  const double* const entering = leaving + Sums * static_cast<std::size_t>(window);  // C(h + 1, k)
  double share[Derivatives][Sums];
  for (std::size_t d = 0; d < Derivatives; ++d) std::copy_n(f.shares.data() + d * Sums, Sums, share[d]);

  for (Index begin = 0; begin < count; begin += f.half) {
    const Index end = std::min(count, begin + f.half);
    Vector4 sum[Sums];
    start_sums<Sums>(f, rows + 4 * begin, sum);
    for (Index i = begin; i < end; ++i) {
      alignas(32) double result[Derivatives * kLanes];
      for (std::size_t d = 0; d < Derivatives; ++d) {
        Vector4 value = share[d][0] * sum[0];
        for (std::size_t k = 1; k < Sums; ++k) value += share[d][k] * sum[k];
        four(result + kLanes * d) = value;
      }
      for (std::size_t g = 0; g < groups; ++g) {
        const auto& from = destinations[g].from;
        four(destinations[g].to + 4 * i) = Vector4{result[from[0]], result[from[1]], result[from[2]], result[from[3]]};
      }
      if (i + 1 == end) break;
      move_sums<Sums>(entering, leaving, rows + 4 * i, window, sum);
    }
  }
}
template <std::size_t Sums, std::size_t Derivatives>
void smooth_any(const RunningSums& f, const double* rows, Index count, const Destination* to, std::size_t groups) {
  smooth_body<Sums, Derivatives>(f, rows, count, to, groups);
}
template <std::size_t Sums, std::size_t Derivatives>
MBK_X86_64_V3 void smooth_v3(const RunningSums& f, const double* rows, Index count, const Destination* to,
                             std::size_t groups) {
  smooth_body<Sums, Derivatives>(f, rows, count, to, groups);
}

// ---- every step-th sample ----

template <std::size_t Derivatives>
[[gnu::always_inline]] inline void correlate_body(const double* weights, Index window, const double* rows, Index step,
                                                  Index count, double* to) {
  constexpr Index kAtOnce = 4;  // sums that do not wait for each other
  for (Index i = 0; i < count; ++i, rows += 4 * step, to += kLanes * Derivatives) {
    Vector4 sum[Derivatives][kAtOnce] = {};
    Index j = 0;
    for (; j + kAtOnce <= window; j += kAtOnce) {
      for (Index a = 0; a < kAtOnce; ++a) {
        const Vector4 x = four(rows + 4 * (j + a));
        for (std::size_t d = 0; d < Derivatives; ++d) sum[d][a] += weights[static_cast<Index>(d) * window + j + a] * x;
      }
    }
    for (; j < window; ++j) {
      const Vector4 x = four(rows + 4 * j);
      for (std::size_t d = 0; d < Derivatives; ++d) sum[d][0] += weights[static_cast<Index>(d) * window + j] * x;
    }
    for (std::size_t d = 0; d < Derivatives; ++d) {
      four(to + kLanes * d) = (sum[d][0] + sum[d][1]) + (sum[d][2] + sum[d][3]);
    }
  }
}
template <std::size_t Derivatives>
void correlate_any(const double* weights, Index window, const double* rows, Index step, Index count, double* to) {
  correlate_body<Derivatives>(weights, window, rows, step, count, to);
}
template <std::size_t Derivatives>
MBK_X86_64_V3 void correlate_v3(const double* weights, Index window, const double* rows, Index step, Index count,
                                double* to) {
  correlate_body<Derivatives>(weights, window, rows, step, count, to);
}

/// Stirling numbers of the second kind times k!: jᵐ = Σ_k S(m, k) k! C(j, k).
double power_in_binomials(int m, int k) {
  if (m == 0 || k == 0) return m == k ? 1.0 : 0.0;
  return static_cast<double>(k) * (power_in_binomials(m - 1, k) + power_in_binomials(m - 1, k - 1));
}

}  // namespace

void interleave(const std::array<const double*, kLanes>& columns, Index count, const FourValues& less, double* to) {
  if (has_x86_64_v3()) {
    interleave_v3(columns.data(), count, less.data(), to);
  } else {
    interleave_body(columns.data(), count, less.data(), to);
  }
}

void separate(const double* from, Index count, const FourValues& plus, const std::array<double*, kLanes>& columns) {
  if (std::ranges::find(columns, nullptr) == columns.end()) {
    (has_x86_64_v3() ? separate_v3 : separate_any)(from, count, plus.data(), columns.data());
    return;
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (columns[lane] == nullptr) continue;
    for (Index i = 0; i < count; ++i) columns[lane][i] = from[4 * i + static_cast<Index>(lane)] + plus[lane];
  }
}

void filter_both_ways(const SectionCascade& filter, double* rows, Index count, const FourValues& settled) {
  std::vector<Section> sections;
  for (const SecondOrderSection& s : filter) {
    sections.push_back({s.b0, s.b1 - s.a1 * s.b0, s.b2 - s.a2 * s.b0, s.a1, s.a2});
  }
  run_sections(sections, rows, count, 4, settled);
  double* const last = rows + 4 * (count - 1);
  FourValues end{};
  std::copy_n(last, kLanes, end.begin());
  run_sections(sections, last, count, -4, end);
}

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
    const auto weights = savitzky_golay_polynomial(filter, derivative);
    if (!weights) return tl::unexpected(weights.error());
    for (int k = 0; k <= order; ++k) {
      double share = 0.0;
      for (int m = order; m >= k; --m) share += weights->powers[m] * power_in_binomials(m, k);
      f.shares.push_back(share * std::pow(rate, derivative));
    }
  }
  return f;
}

void smooth(const RunningSums& f, const double* rows, Index count, std::span<const Destination> destinations) {
  const std::size_t order = f.sums / 2 - 1;
  if (const auto pairs = as_pairs(f, destinations)) {
    using SmoothPairs = void (*)(const RunningSums&, const double*, Index, const Pairs*, std::size_t);
    static constexpr SmoothPairs kPairs[2][3] = {{smooth_pairs<3>, smooth_pairs<5>, smooth_pairs<7>},
                                                 {smooth_pairs_v3<3>, smooth_pairs_v3<5>, smooth_pairs_v3<7>}};
    return kPairs[has_x86_64_v3() ? 1 : 0][order](f, rows, count, pairs->data(), pairs->size());
  }
  using Smooth = void (*)(const RunningSums&, const double*, Index, const Destination*, std::size_t);
  static constexpr Smooth kSmooth[2][3][kMaxDerivatives] = {{{smooth_any<3, 1>, smooth_any<3, 2>, smooth_any<3, 3>},
                                                             {smooth_any<5, 1>, smooth_any<5, 2>, smooth_any<5, 3>},
                                                             {smooth_any<7, 1>, smooth_any<7, 2>, smooth_any<7, 3>}},
                                                            {{smooth_v3<3, 1>, smooth_v3<3, 2>, smooth_v3<3, 3>},
                                                             {smooth_v3<5, 1>, smooth_v3<5, 2>, smooth_v3<5, 3>},
                                                             {smooth_v3<7, 1>, smooth_v3<7, 2>, smooth_v3<7, 3>}}};
  const std::size_t derivatives = f.shares.size() / f.sums;
  kSmooth[has_x86_64_v3() ? 1 : 0][order][derivatives - 1](f, rows, count, destinations.data(), destinations.size());
}

void correlate_every(std::span<const double> weights, std::size_t derivatives, const double* rows, Index step,
                     Index count, double* to) {
  using Correlate = void (*)(const double*, Index, const double*, Index, Index, double*);
  static constexpr Correlate kCorrelate[2][kMaxDerivatives] = {{correlate_any<1>, correlate_any<2>, correlate_any<3>},
                                                               {correlate_v3<1>, correlate_v3<2>, correlate_v3<3>}};
  const auto window = static_cast<Index>(weights.size() / derivatives);
  kCorrelate[has_x86_64_v3() ? 1 : 0][derivatives - 1](weights.data(), window, rows, step, count, to);
}

}  // namespace mbk::dsp
