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

/// Samples that are equally far from the centre go together; two signals at a time, so that the sums stay in registers.
[[gnu::always_inline]] inline void moments_body(const BlockFilter& f, const double* const* columns, const double* less,
                                                Index first_block, Index blocks, double* moments) {
  constexpr std::size_t kAtOnce = 2;
  const Index length = f.length, pairs = (length + 1) / 2;
  for (Index b = first_block; b < first_block + blocks; ++b, moments += 4 * kMoments) {
    Vector4 sum[kLanes][kMoments];
    for (std::size_t first = 0; first < kLanes; first += kAtOnce) {
      Vector4 part[kAtOnce][kMoments] = {};
      const double* shape = f.shapes.data();
      for (Index i = 0; i < pairs; i += 4, shape += 4 * kMoments) {
        for (std::size_t c = 0; c < kAtOnce; ++c) {
          const double* const x = columns[first + c] + b * length;
          const Vector4 older = four(x + i), towards_older = four(x + length - 4 - i);
          const Vector4 newer = __builtin_shufflevector(towards_older, towards_older, 3, 2, 1, 0);
          const Vector4 even = (newer + older) - 2.0 * less[first + c], odd = newer - older;
          for (std::size_t k = 0; k < kMoments; ++k) part[c][k] += four(shape + 4 * k) * (k % 2 == 0 ? even : odd);
        }
      }
      for (std::size_t c = 0; c < kAtOnce; ++c) std::copy_n(part[c], kMoments, sum[first + c]);
    }
    for (std::size_t k = 0; k < kMoments; ++k) {
      four(moments + 4 * k) = sums_of(sum[0][k], sum[1][k], sum[2][k], sum[3][k]);
    }
  }
}

template <std::size_t States>
[[gnu::always_inline]] inline void drive_body(const BlockFilter& f, Index blocks, const double* moments, double* back,
                                              double* ahead) {
  double drive[kMoments][States];
  for (std::size_t k = 0; k < kMoments; ++k) std::copy_n(f.drive.data() + k * States, States, drive[k]);
  for (Index b = 0; b < blocks; ++b, moments += 4 * kMoments, back += 4 * States, ahead += 4 * States) {
    for (std::size_t s = 0; s < States; ++s) {
      const Vector4 even = drive[0][s] * four(moments) + drive[2][s] * four(moments + 8);
      const Vector4 odd = drive[1][s] * four(moments + 4) + drive[3][s] * four(moments + 12);
      four(back + 4 * s) = even + odd;
      four(ahead + 4 * s) = even - odd;
    }
  }
}

/// First the moments of some blocks, which stay in the first cache, then what they add to the states.
template <std::size_t States>
[[gnu::always_inline]] inline void take_moments_body(const BlockFilter& f, const double* const* columns,
                                                     const double* less, Index blocks, double* moments, double* back,
                                                     double* ahead) {
  constexpr Index kAtOnce = 32;
  for (Index b = 0; b < blocks; b += kAtOnce) {
    const Index some = std::min(kAtOnce, blocks - b);
    double* const now = moments + 4 * static_cast<Index>(kMoments) * b;
    constexpr Index kState = 4 * static_cast<Index>(States);
    moments_body(f, columns, less, b, some, now);
    drive_body<States>(f, some, now, back + kState * b, ahead + kState * b);
  }
}

/// to += pᴸ from
template <std::size_t States>
[[gnu::always_inline]] inline void advance_modes(const double* power, const double* from, double* to) {
  if constexpr (States % 2 == 1) four(to) += power[0] * four(from);
  for (std::size_t s = States % 2; s < States; s += 2) {
    const Vector4 real = four(from + 4 * s), imaginary = four(from + 4 * s + 4);
    four(to + 4 * s) += power[s] * real - power[s + 1] * imaginary;
    four(to + 4 * s + 4) += power[s] * imaginary + power[s + 1] * real;
  }
}
template <std::size_t States>
[[gnu::always_inline]] inline void sweep_body(const BlockFilter& f, Index blocks, double* back, double* ahead) {
  constexpr Index kRow = 4 * States;
  double power[States];
  std::copy_n(f.power.data(), States, power);
  for (Index b = 1; b < blocks; ++b) {
    advance_modes<States>(power, back + kRow * (b - 1), back + kRow * b);
    advance_modes<States>(power, ahead + kRow * (blocks - b), ahead + kRow * (blocks - b - 1));
  }
}

/// Several sums at a time share a weight that has been read.
template <std::size_t Derivatives, Index AtOnce>
[[gnu::always_inline]] inline void weighted_sums_body(const double* weight, const Terms* terms, double* to,
                                                      Index apart) {
  Vector4 sum[AtOnce][Derivatives] = {};
  for (const Terms* part = terms; part < terms + 3; ++part) {
    const double* at = part->at;
    for (Index term = 0; term < part->count; ++term, at += 4, weight += Derivatives) {
      for (Index a = 0; a < AtOnce; ++a) {
        const Vector4 value = four(at + a * part->apart);
        for (std::size_t d = 0; d < Derivatives; ++d) sum[a][d] += weight[d] * value;
      }
    }
  }
  for (Index a = 0; a < AtOnce; ++a) {
    for (std::size_t d = 0; d < Derivatives; ++d) four(to + a * apart + static_cast<Index>(4 * d)) = sum[a][d];
  }
}
template <std::size_t Derivatives>
[[gnu::always_inline]] inline void all_sums_body(const double* weights, std::array<Terms, 3> terms, Index sums,
                                                 double* to, Index apart) {
  constexpr Index kAtOnce = 4;
  const auto go_on = [&](Index by) [[gnu::always_inline]] {
    for (Terms& part : terms) part.at += by * part.apart;
    to += by * apart;
  };
  Index i = 0;
  for (; i + kAtOnce <= sums; i += kAtOnce) {
    weighted_sums_body<Derivatives, kAtOnce>(weights, terms.data(), to, apart);
    go_on(kAtOnce);
  }
  for (; i < sums; ++i) {
    weighted_sums_body<Derivatives, 1>(weights, terms.data(), to, apart);
    go_on(1);
  }
}

// ---- for each kind of processor; those with AVX-512 have twice the registers for the same four values ----

#define MBK_BLOCK_LOOPS(NAME, TARGET)                                                                                 \
  struct NAME {                                                                                                       \
    template <std::size_t States>                                                                                     \
    TARGET static void take_moments(const BlockFilter& f, const double* const* columns, const double* less,           \
                                    Index blocks, double* moments, double* back, double* ahead) {                     \
      take_moments_body<States>(f, columns, less, blocks, moments, back, ahead);                                      \
    }                                                                                                                 \
    template <std::size_t States>                                                                                     \
    TARGET static void sweep(const BlockFilter& f, Index blocks, double* back, double* ahead) {                       \
      sweep_body<States>(f, blocks, back, ahead);                                                                     \
    }                                                                                                                 \
    template <std::size_t Derivatives>                                                                                \
    TARGET static void sums(const double* weights, const std::array<Terms, 3>& terms, Index count, double* to,        \
                            Index apart) {                                                                            \
      all_sums_body<Derivatives>(weights, terms, count, to, apart);                                                   \
    }                                                                                                                 \
  };
MBK_BLOCK_LOOPS(BlockAny, )
MBK_BLOCK_LOOPS(BlockV3, MBK_X86_64_V3)
MBK_BLOCK_LOOPS(BlockV4, MBK_X86_64_V4)
#undef MBK_BLOCK_LOOPS

struct BlockLoops {
  using TakeMoments = void (*)(const BlockFilter&, const double* const*, const double*, Index, double*, double*,
                               double*);
  using Sweep = void (*)(const BlockFilter&, Index, double*, double*);
  using Sums = void (*)(const double*, const std::array<Terms, 3>&, Index, double*, Index);
  std::array<TakeMoments, kMaxModalStates> take_moments;  ///< by the number of states, less one
  std::array<Sweep, kMaxModalStates> sweep;
  std::array<Sums, kMaxDerivatives> sums;
};
template <class Kind, std::size_t... S, std::size_t... D>
constexpr BlockLoops block_loops_of(std::index_sequence<S...>, std::index_sequence<D...>) {
  return {{Kind::template take_moments<S + 1>...}, {Kind::template sweep<S + 1>...}, {Kind::template sums<D + 1>...}};
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
                  double* moments, double* back, double* ahead) {
  block_loops().take_moments[filter.states - 1](filter, columns.data(), less.data(), blocks, moments, back, ahead);
}

void sweep(const BlockFilter& filter, Index blocks, double* back, double* ahead) {
  block_loops().sweep[filter.states - 1](filter, blocks, back, ahead);
}

void weighted_sums(const std::vector<double>& weights, std::size_t derivatives, const std::array<Terms, 3>& terms,
                   Index sums, double* to, Index apart) {
  block_loops().sums[derivatives - 1](weights.data(), terms, sums, to, apart);
}

}  // namespace mbk::dsp
