#pragma once

#include <array>
#include <cstddef>

#include "mbk/base/core/words.h"

/// @file
/// Four doubles at a time, for inner loops. A body is written once with these and compiled twice:
/// for every processor, and with MBK_X86_64_V3 for those that have AVX2 and fused multiply-add (x86-64-v3, 2013 and
/// later). Which one runs is decided where the program runs. Eight at a time are for MBK_X86_64_V4 (AVX-512).
namespace mbk {

typedef double Vector4 __attribute__((vector_size(32)));                            // NOLINT(modernize-use-using)
typedef double Unaligned4 __attribute__((vector_size(32), aligned(8), may_alias));  // NOLINT(modernize-use-using)
typedef double Vector8 __attribute__((vector_size(64)));                            // NOLINT(modernize-use-using)
typedef double Unaligned8 __attribute__((vector_size(64), aligned(8), may_alias));  // NOLINT(modernize-use-using)

#if defined(__x86_64__)
#define MBK_X86_64_V3 [[gnu::target("avx2,fma")]]
#define MBK_X86_64_V4 [[gnu::target("avx512f,avx512vl,avx512dq,avx512bw,avx2,fma")]]
#else
#define MBK_X86_64_V3
#define MBK_X86_64_V4
#endif

/// Which of the bodies run.
enum class Simd { any, v3, v4 };

[[nodiscard]] constexpr auto word_table(Simd) {
  using enum Simd;
  return std::to_array<Word<Simd>>({{any, "any"}, {v3, "v3"}, {v4, "v4"}});
}

/// What this processor has, or less where the environment variable MBK_SIMD asks for it: then processors of different
/// kinds compute the same to the last digit. What is no word of Simd counts as not there; `mbk` refuses it.
[[nodiscard]] Simd simd();

inline bool has_x86_64_v3() {
  return simd() >= Simd::v3;
}
inline bool has_x86_64_v4() {
  return simd() >= Simd::v4;
}

[[gnu::always_inline]] inline Unaligned4& four(double* at) {
  return *reinterpret_cast<Unaligned4*>(at);
}
[[gnu::always_inline]] inline const Unaligned4& four(const double* at) {
  return *reinterpret_cast<const Unaligned4*>(at);
}
[[gnu::always_inline]] inline Unaligned8& eight(double* at) {
  return *reinterpret_cast<Unaligned8*>(at);
}
[[gnu::always_inline]] inline const Unaligned8& eight(const double* at) {
  return *reinterpret_cast<const Unaligned8*>(at);
}

/// How many go together, for bodies that are written once for four and for eight.
struct Four {
  using V = Vector4;
  static constexpr std::ptrdiff_t kWidth = 4;
  [[gnu::always_inline]] static Unaligned4& at(double* p) { return four(p); }
  [[gnu::always_inline]] static const Unaligned4& at(const double* p) { return four(p); }
};
struct Eight {
  using V = Vector8;
  static constexpr std::ptrdiff_t kWidth = 8;
  [[gnu::always_inline]] static Unaligned8& at(double* p) { return eight(p); }
  [[gnu::always_inline]] static const Unaligned8& at(const double* p) { return eight(p); }
};

/// What is read once and used several times: the compiler would rather read it for each use.
template <class Lanes>
[[gnu::always_inline]] inline void keep_in_register([[maybe_unused]] typename Lanes::V& lanes) {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  if constexpr (Lanes::kWidth == Eight::kWidth) asm("" : "+v"(lanes));  // of eight, where there is such a register
#endif
}

}  // namespace mbk
