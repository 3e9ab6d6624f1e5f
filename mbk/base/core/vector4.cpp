#include "mbk/base/core/vector4.h"

#include <algorithm>
#include <cstdlib>

namespace mbk {
namespace {

Simd of_this_processor() {
#if defined(__x86_64__)
  const auto all = [](auto... has) { return ((has != 0) && ...); };
  if (!all(__builtin_cpu_supports("avx2"), __builtin_cpu_supports("fma"))) return Simd::any;
  return all(__builtin_cpu_supports("avx512f"), __builtin_cpu_supports("avx512vl"), __builtin_cpu_supports("avx512dq"),
             __builtin_cpu_supports("avx512bw"))
             ? Simd::v4
             : Simd::v3;
#else
  return Simd::any;
#endif
}

Simd chosen() {
  const char* const asked = std::getenv("MBK_SIMD");
  const Simd here = of_this_processor();
  return asked == nullptr ? here : std::min(here, value_of<Simd>(asked).value_or(here));
}

}  // namespace

Simd simd() {
  static const Simd kChosen = chosen();
  return kChosen;
}

}  // namespace mbk
