#pragma once

/// Four doubles at a time, for inner loops. A body is written once with these and compiled twice:
/// for every processor, and with MBK_X86_64_V3 for those that have AVX2 and fused multiply-add (x86-64-v3, 2013 and
/// later). Which one runs is decided where the program runs.
namespace mbk {

typedef double Vector4 __attribute__((vector_size(32)));                            // NOLINT(modernize-use-using)
typedef double Unaligned4 __attribute__((vector_size(32), aligned(8), may_alias));  // NOLINT(modernize-use-using)

#if defined(__x86_64__)
#define MBK_X86_64_V3 [[gnu::target("avx2,fma")]]
inline bool has_x86_64_v3() {
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
}
#else
#define MBK_X86_64_V3
inline bool has_x86_64_v3() {
  return false;
}
#endif

[[gnu::always_inline]] inline Unaligned4& four(double* at) {
  return *reinterpret_cast<Unaligned4*>(at);
}
[[gnu::always_inline]] inline const Unaligned4& four(const double* at) {
  return *reinterpret_cast<const Unaligned4*>(at);
}

}  // namespace mbk
