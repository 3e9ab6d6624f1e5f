#include "mbk/base/dsp/block_moments.h"

#include <algorithm>
#include <utility>

#include "mbk/base/core/vector4.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors are passed between functions that are inlined always
#endif

namespace mbk::dsp {
namespace {

/// The sums of the values of each of four.
[[gnu::always_inline]] inline Vector4 sums_of(const Vector4& a, const Vector4& b, const Vector4& c, const Vector4& d) {
  const Vector4 ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Vector4 cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/// Moments of one signal, before their four parts are added up.
struct MomentParts {
  Vector4 of[kMoments] = {};
  /// Samples that are equally far from the centre go together.
  [[gnu::always_inline]] void add(const double* older_at, const double* newer_at, const double* shape, double twice) {
    const Vector4 older = four(older_at), backwards = four(newer_at);
    const Vector4 newer = __builtin_shufflevector(backwards, backwards, 3, 2, 1, 0);
    const Vector4 even = (newer + older) - twice, odd = newer - older;
    for (std::size_t k = 0; k < kMoments; ++k) of[k] += four(shape + 4 * k) * (k % 2 == 0 ? even : odd);
  }
};

[[gnu::always_inline]] inline void take_moments_body(const BlockFilter& f, const double* const* columns,
                                                     const double* less, Index blocks, double* moments) {
  constexpr Index kLine = 8, kAhead = 128 * kLine;
  const Index length = f.length, pairs = (length + 1) / 2;
  const double *const x0 = columns[0], *const x1 = columns[1], *const x2 = columns[2], *const x3 = columns[3];
  const double less0 = 2.0 * less[0], less1 = 2.0 * less[1], less2 = 2.0 * less[2], less3 = 2.0 * less[3];
  for (Index b = 0; b < blocks; ++b, moments += 4 * kMoments) {
    MomentParts parts0, parts1, parts2, parts3;
    const double* shape = f.shapes.data();
    const Index begin = b * length;
    // Processors look ahead within a page, and along fewer columns.
    for (Index i = begin; i < begin + length; i += kLine) {
      for (const double* const x : {x0, x1, x2, x3}) __builtin_prefetch(x + i + kAhead);
    }
    for (Index i = begin, j = begin + length - 4; i < begin + pairs; i += 4, j -= 4, shape += 4 * kMoments) {
      parts0.add(x0 + i, x0 + j, shape, less0);
      parts1.add(x1 + i, x1 + j, shape, less1);
      parts2.add(x2 + i, x2 + j, shape, less2);
      parts3.add(x3 + i, x3 + j, shape, less3);
    }
    for (std::size_t k = 0; k < kMoments; ++k) {
      four(moments + 4 * k) = sums_of(parts0.of[k], parts1.of[k], parts2.of[k], parts3.of[k]);
    }
  }
}

/// @param states of the first block to be taken    @param step from one block to the next, 1 or −1
template <std::size_t States>
[[gnu::always_inline]] inline void advance_modes_body(const BlockFilter& f, double parity, Index step, Index blocks,
                                                      const double* moments, double* states) {
  double drive[kMoments][States], power[States];
  for (std::size_t k = 0; k < kMoments; ++k) {
    for (std::size_t s = 0; s < States; ++s) drive[k][s] = (k % 2 == 0 ? 1.0 : parity) * f.drive[k * States + s];
  }
  std::copy_n(f.power.data(), States, power);
  Vector4 x[States];
  for (std::size_t s = 0; s < States; ++s) x[s] = four(states - 4 * static_cast<Index>(States) * step + 4 * s);
  for (Index b = 0; b < blocks; ++b) {
    for (std::size_t s = States % 2; s < States; s += 2) {
      const Vector4 real = x[s], imaginary = x[s + 1];
      x[s] = power[s] * real - power[s + 1] * imaginary;
      x[s + 1] = power[s] * imaginary + power[s + 1] * real;
    }
    if constexpr (States % 2 == 1) x[0] *= power[0];
    for (std::size_t s = 0; s < States; ++s) {
      Vector4 added = drive[0][s] * four(moments);
      for (std::size_t k = 1; k < kMoments; ++k) added += drive[k][s] * four(moments + 4 * k);
      four(states + 4 * s) = x[s] += added;
    }
    moments += 4 * static_cast<Index>(kMoments) * step;
    states += 4 * static_cast<Index>(States) * step;
  }
}

/// Several sums at a time share a weight that has been read.
template <std::size_t Derivatives, Index AtOnce>
[[gnu::always_inline]] inline void weighted_body(const double* weight, const Terms& terms, Sums how, double* to,
                                                 Index apart) {
  Vector4 sum[AtOnce][Derivatives] = {};
  const double* at = terms.at;
  for (Index term = 0; term < terms.count; ++term, at += 4, weight += Derivatives) {
    for (Index a = 0; a < AtOnce; ++a) {
      const Vector4 value = four(at + a * terms.apart);
      for (std::size_t d = 0; d < Derivatives; ++d) sum[a][d] += weight[d] * value;
    }
  }
  for (Index a = 0; a < AtOnce; ++a) {
    for (std::size_t d = 0; d < Derivatives; ++d) {
      double* const result = to + a * apart + static_cast<Index>(4 * d);
      four(result) = how == Sums::added ? four(result) + sum[a][d] : sum[a][d];
    }
  }
}
template <std::size_t Derivatives>
[[gnu::always_inline]] inline void weighted_sums_body(const double* weights, Terms terms, Index sums, Sums how,
                                                      double* to, Index apart) {
  constexpr Index kAtOnce = 4;
  Index i = 0;
  for (; i + kAtOnce <= sums; i += kAtOnce, terms.at += kAtOnce * terms.apart, to += kAtOnce * apart) {
    weighted_body<Derivatives, kAtOnce>(weights, terms, how, to, apart);
  }
  for (; i < sums; ++i, terms.at += terms.apart, to += apart) {
    weighted_body<Derivatives, 1>(weights, terms, how, to, apart);
  }
}

// ---- for each kind of processor; those with AVX-512 have twice the registers for the same four values ----

#define MBK_BLOCK_LOOPS(NAME, TARGET)                                                                             \
  struct NAME {                                                                                                   \
    TARGET static void take_moments(const BlockFilter& f, const double* const* columns, const double* less,       \
                                    Index blocks, double* moments) {                                              \
      take_moments_body(f, columns, less, blocks, moments);                                                       \
    }                                                                                                             \
    template <std::size_t States>                                                                                 \
    TARGET static void advance_modes(const BlockFilter& f, double parity, Index step, Index blocks,               \
                                     const double* moments, double* states) {                                     \
      advance_modes_body<States>(f, parity, step, blocks, moments, states);                                       \
    }                                                                                                             \
    template <std::size_t Derivatives>                                                                            \
    TARGET static void weighted_sums(const double* weights, const Terms& terms, Index sums, Sums how, double* to, \
                                     Index apart) {                                                               \
      weighted_sums_body<Derivatives>(weights, terms, sums, how, to, apart);                                      \
    }                                                                                                             \
  };
MBK_BLOCK_LOOPS(BlockAny, )
MBK_BLOCK_LOOPS(BlockV3, MBK_X86_64_V3)
MBK_BLOCK_LOOPS(BlockV4, MBK_X86_64_V4)
#undef MBK_BLOCK_LOOPS

struct BlockLoops {
  using Advance = void (*)(const BlockFilter&, double, Index, Index, const double*, double*);
  using WeightedSums = void (*)(const double*, const Terms&, Index, Sums, double*, Index);
  void (*take_moments)(const BlockFilter&, const double* const*, const double*, Index, double*);
  std::array<Advance, kMaxModalStates> advance_modes;  ///< by the number of states, less one
  std::array<WeightedSums, kMaxDerivatives> weighted_sums;
};
template <class Kind, std::size_t... S, std::size_t... D>
constexpr BlockLoops block_loops_of(std::index_sequence<S...>, std::index_sequence<D...>) {
  return {Kind::take_moments, {Kind::template advance_modes<S + 1>...}, {Kind::template weighted_sums<D + 1>...}};
}
const BlockLoops& block_loops() {
  constexpr auto kStates = std::make_index_sequence<kMaxModalStates>();
  constexpr auto kDerivatives = std::make_index_sequence<kMaxDerivatives>();
  static const BlockLoops kChosen = has_x86_64_v4()   ? block_loops_of<BlockV4>(kStates, kDerivatives)
                                    : has_x86_64_v3() ? block_loops_of<BlockV3>(kStates, kDerivatives)
                                                      : block_loops_of<BlockAny>(kStates, kDerivatives);
  return kChosen;
}

}  // namespace

void take_moments(const BlockFilter& filter, const FourColumns& columns, const FourValues& less, Index blocks,
                  double* moments) {
  block_loops().take_moments(filter, columns.data(), less.data(), blocks, moments);
}

void advance_modes(const BlockFilter& filter, Looking way, Index blocks, const double* moments, double* states) {
  const bool back = way == Looking::back;
  const Index first = back ? 0 : blocks - 1;
  block_loops().advance_modes[filter.states - 1](filter, back ? 1.0 : -1.0, back ? 1 : -1, blocks,
                                                 moments + 4 * static_cast<Index>(kMoments) * first,
                                                 states + 4 * static_cast<Index>(filter.states) * first);
}

void weighted_sums(const std::vector<double>& weights, std::size_t derivatives, const Terms& terms, Index sums,
                   Sums how, double* to, Index apart) {
  block_loops().weighted_sums[derivatives - 1](weights.data(), terms, sums, how, to, apart);
}

}  // namespace mbk::dsp
