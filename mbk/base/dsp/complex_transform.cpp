#include "mbk/base/dsp/complex_transform.h"

#include <algorithm>
#include <array>
#include <complex>
#include <cstddef>
#include <mutex>
#include <numbers>
#include <vector>

#include "mbk/base/core/vector4.h"

namespace mbk::dsp {
namespace {

/// e^(−2πj i/n), i = 0 … n − 1, each as a product of two: no more than 64 + n/64 sines.
std::vector<std::complex<double>> circle(Index n) {
  constexpr Index kFine = 64;
  const auto turn = [n](Index i) {
    return std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
  };
  std::vector<std::complex<double>> fine, all;
  for (Index i = 0; i < kFine; ++i) fine.push_back(turn(i));
  all.reserve(static_cast<std::size_t>(n));
  for (Index begin = 0; begin < n; begin += kFine) {
    const std::complex<double> coarse = turn(begin);
    for (Index i = begin; i < n && i < begin + kFine; ++i) {
      const std::complex<double> rest = fine[static_cast<std::size_t>(i - begin)];
      all.emplace_back(coarse.real() * rest.real() - coarse.imag() * rest.imag(),
                       coarse.real() * rest.imag() + coarse.imag() * rest.real());
    }
  }
  return all;
}

template <class V>
struct Value {
  V re, im;
  [[gnu::always_inline]] friend inline Value operator+(const Value& a, const Value& b) {
    return {a.re + b.re, a.im + b.im};
  }
  [[gnu::always_inline]] friend inline Value operator-(const Value& a, const Value& b) {
    return {a.re - b.re, a.im - b.im};
  }
  [[gnu::always_inline]] friend inline Value operator*(double gain, const Value& a) {
    return {gain * a.re, gain * a.im};
  }
};

/// a − j b and a + j b
template <class V>
[[gnu::always_inline]] inline void across(const Value<V>& a, const Value<V>& b, Value<V>& minus, Value<V>& plus) {
  minus = {a.re + b.im, a.im - b.re};
  plus = {a.re - b.im, a.im + b.re};
}

/// The transform of `Radix` values, in place.
template <int Radix, class V>
[[gnu::always_inline]] inline void butterfly(Value<V> (&a)[Radix]) {
  if constexpr (Radix == 2) {
    const Value<V> first = a[0];
    a[0] = first + a[1];
    a[1] = first - a[1];
  } else if constexpr (Radix == 3) {
    constexpr double kSine = 0.5 * std::numbers::sqrt3;
    const Value<V> sum = a[1] + a[2], middle = a[0] - 0.5 * sum, apart = kSine * (a[1] - a[2]);
    a[0] = a[0] + sum;
    across(middle, apart, a[1], a[2]);
  } else if constexpr (Radix == 4) {
    const Value<V> even = a[0] + a[2], even_apart = a[0] - a[2], odd = a[1] + a[3], odd_apart = a[1] - a[3];
    a[0] = even + odd;
    a[2] = even - odd;
    across(even_apart, odd_apart, a[1], a[3]);
  } else {
    static_assert(Radix == 5);
    // cos and sin of 2π/5 and 4π/5
    constexpr double kRoot5 = 2.2360679774997896964, kCos1 = 0.25 * (kRoot5 - 1.0), kCos2 = -0.25 * (kRoot5 + 1.0);
    constexpr double kSin1 = 0.95105651629515357212, kSin2 = 0.58778525229247312917;
    const Value<V> outer = a[1] + a[4], inner = a[2] + a[3], outer_apart = a[1] - a[4], inner_apart = a[2] - a[3];
    const Value<V> first = a[0] + kCos1 * outer + kCos2 * inner, second = a[0] + kCos2 * outer + kCos1 * inner;
    a[0] = a[0] + outer + inner;
    across(first, kSin1 * outer_apart + kSin2 * inner_apart, a[1], a[4]);
    across(second, kSin2 * outer_apart - kSin1 * inner_apart, a[2], a[3]);
  }
}

template <class V, class Turn>
[[gnu::always_inline]] inline Value<V> turned(const Value<V>& a, const Turn& re, const Turn& im) {
  return {a.re * re - a.im * im, a.re * im + a.im * re};
}

}  // namespace

/// What a transform of one length does, whatever its values are.
struct TransformPlan {
  struct Stage {
    Index radix;
    Index groups, stride;  ///< of the `radix`·groups·stride = n values
    Index turns;  ///< where e^(−2πj q k/(radix·groups)) begins: k = 1 … radix − 1, q = 0 … groups − 1
  };
  Index length;
  std::vector<Stage> stages;
  std::vector<double> turns_real, turns_imaginary;

  explicit TransformPlan(Index of_length) : length(of_length) {
    Index rest = length, stride = 1, turns = 0;
    const auto add = [&](Index radix) {
      for (; rest % radix == 0; rest /= radix, stride *= radix) {
        stages.push_back({radix, rest / radix, stride, turns});
        turns += (radix - 1) * (rest / radix);
      }
    };
    for (const Index radix : {4, 5, 3, 2}) add(radix);  // fours first: from then on whole vectors are side by side
    Index prime = 7;
    while (rest > 1) {
      add(prime);
      prime += 2;
    }
    const std::vector<std::complex<double>> all = circle(length);
    turns_real.resize(static_cast<std::size_t>(turns));
    turns_imaginary.resize(static_cast<std::size_t>(turns));
    auto re = turns_real.begin(), im = turns_imaginary.begin();
    for (const Stage& stage : stages) {
      for (Index k = 1; k < stage.radix; ++k) {
        auto turn = all.begin();
        for (Index q = 0; q < stage.groups; ++q, turn += k * stage.stride) {
          *re++ = turn->real();
          *im++ = turn->imag();
        }
      }
    }
  }
};

namespace {

/// A plan that was made lately, or a new one: what a recording is asked takes few lengths, many times each.
std::shared_ptr<const TransformPlan> plan_of(Index length) {
  constexpr Index kLongest = 1 << 16;  // longer ones take long themselves, and much memory
  if (length > kLongest) return std::make_shared<const TransformPlan>(length);
  static std::mutex mutex;
  static std::array<std::shared_ptr<const TransformPlan>, 6> latest;
  {
    const std::scoped_lock lock(mutex);
    const auto found =
        std::ranges::find_if(latest, [length](const auto& plan) { return plan != nullptr && plan->length == length; });
    if (found != latest.end()) {
      std::rotate(latest.begin(), found, found + 1);
      return latest.front();
    }
  }
  auto made = std::make_shared<const TransformPlan>(length);
  const std::scoped_lock lock(mutex);
  std::ranges::rotate(latest, latest.end() - 1);
  latest.front() = made;
  return made;
}

}  // namespace

/// One pass over all values: y[t + s(p q + k)] = e^(−2πj q k/(p m)) Σ_i x[t + s(q + m i)] e^(−2πj i k/p), with radix p,
/// m groups and stride s.
struct TransformLoops {
  struct Pass {
    const double *re, *im;
    double *to_re, *to_im;
    const double *turns_re, *turns_im;
    Index groups, stride;
  };

  /// As many values of one group as V holds, which share their turns.
  template <int Radix, class V>
  [[gnu::always_inline]] static inline void one_group(const Pass& pass, Index q, Index t) {
    Value<V> a[Radix];
    for (Index i = 0; i < Radix; ++i) {
      const Index at = t + pass.stride * (q + pass.groups * i);
      get(pass.re + at, a[i].re);
      get(pass.im + at, a[i].im);
    }
    butterfly<Radix>(a);
    for (Index k = 0; k < Radix; ++k) {
      const Index turn = (k - 1) * pass.groups + q;
      if (k > 0) a[k] = turned(a[k], pass.turns_re[turn], pass.turns_im[turn]);
      const Index at = t + pass.stride * (Radix * q + k);
      put(a[k].re, pass.to_re + at);
      put(a[k].im, pass.to_im + at);
    }
  }

  /// The first value of four groups, where the stride is 1.
  template <int Radix>
  [[gnu::always_inline]] static inline void four_groups(const Pass& pass, Index q) {
    Value<Vector4> a[Radix];
    for (Index i = 0; i < Radix; ++i) {
      get(pass.re + q + pass.groups * i, a[i].re);
      get(pass.im + q + pass.groups * i, a[i].im);
    }
    butterfly<Radix>(a);
    for (Index k = 0; k < Radix; ++k) {
      const Index turn = (k - 1) * pass.groups + q;
      if (k > 0) {
        Vector4 re, im;  // not by reference: that would take them for aligned
        get(pass.turns_re + turn, re);
        get(pass.turns_im + turn, im);
        a[k] = turned(a[k], re, im);
      }
      for (Index lane = 0; lane < 4; ++lane) {
        pass.to_re[Radix * (q + lane) + k] = a[k].re[lane];
        pass.to_im[Radix * (q + lane) + k] = a[k].im[lane];
      }
    }
  }

  template <int Radix>
  [[gnu::always_inline]] static inline void pass_of(const Pass& pass) {
    Index q = 0;
    if (pass.stride == 1) {
      for (; q + 4 <= pass.groups; q += 4) four_groups<Radix>(pass, q);
    }
    for (; q < pass.groups; ++q) {
      Index t = 0;
      for (; t + 4 <= pass.stride; t += 4) one_group<Radix, Vector4>(pass, q, t);
      for (; t < pass.stride; ++t) one_group<Radix, double>(pass, q, t);
    }
  }

  [[gnu::always_inline]] static inline void pass_body(Index radix, const Pass& pass) {
    switch (radix) {
      case 2:
        return pass_of<2>(pass);
      case 3:
        return pass_of<3>(pass);
      case 4:
        return pass_of<4>(pass);
      default:
        return pass_of<5>(pass);
    }
  }
  static void pass_any(Index radix, const Pass& pass) { pass_body(radix, pass); }
  MBK_X86_64_V3 static void pass_v3(Index radix, const Pass& pass) { pass_body(radix, pass); }

  /// As `pass_of`, of any radix: by the sum of the definition.
  static void pass_plain(Index radix, const Pass& pass) {
    const std::vector<std::complex<double>> roots = circle(radix);
    for (Index q = 0; q < pass.groups; ++q) {
      for (Index k = 0; k < radix; ++k) {
        const Index turn = (k - 1) * pass.groups + q;
        for (Index t = 0; t < pass.stride; ++t) {
          Value<double> sum{0.0, 0.0};
          for (Index i = 0; i < radix; ++i) {
            const Index at = t + pass.stride * (q + pass.groups * i);
            const std::complex<double>& root = roots[static_cast<std::size_t>(i * k % radix)];
            sum = sum + turned(Value<double>{pass.re[at], pass.im[at]}, root.real(), root.imag());
          }
          if (k > 0) sum = turned(sum, pass.turns_re[turn], pass.turns_im[turn]);
          const Index at = t + pass.stride * (radix * q + k);
          pass.to_re[at] = sum.re;
          pass.to_im[at] = sum.im;
        }
      }
    }
  }

  static void run(ComplexTransform& transform) {
    const auto fast = has_x86_64_v3() ? pass_v3 : pass_any;
    const TransformPlan& plan = *transform.plan_;
    for (const TransformPlan::Stage& stage : plan.stages) {
      (stage.radix <= 5 ? fast : pass_plain)(
          stage.radix, {transform.real_.data(), transform.imaginary_.data(), transform.other_real_.data(),
                        transform.other_imaginary_.data(), plan.turns_real.data() + stage.turns,
                        plan.turns_imaginary.data() + stage.turns, stage.groups, stage.stride});
      transform.real_.swap(transform.other_real_);
      transform.imaginary_.swap(transform.other_imaginary_);
    }
  }

 private:
  [[gnu::always_inline]] static inline void get(const double* at, double& value) { value = *at; }
  [[gnu::always_inline]] static inline void get(const double* at, Vector4& value) { value = four(at); }
  [[gnu::always_inline]] static inline void put(double value, double* at) { *at = value; }
  [[gnu::always_inline]] static inline void put(const Vector4& value, double* at) { four(at) = value; }
};

ComplexTransform::ComplexTransform(Index length)
    : plan_(plan_of(length)),
      real_(length),
      imaginary_(length),
      other_real_(length),
      other_imaginary_(length),
      length_(length) {}

void ComplexTransform::run() {
  TransformLoops::run(*this);
}

}  // namespace mbk::dsp
