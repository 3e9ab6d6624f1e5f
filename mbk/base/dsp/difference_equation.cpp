#include "mbk/base/dsp/difference_equation.h"

#include <algorithm>
#include <array>

namespace mbk::dsp {
namespace {

/// y[k] ← y[k] − Σ a_j y[k − j] from k on, the newest last, as it is waited for.   N: their count, or 0: any
template <int N>
void feed_back(const Vector& a, Index k, Vector& y) {
  const Index n = N > 0 ? N : a.size() - 1;
  for (; k < y.size(); ++k) {
    double sum = y[k];
    for (Index j = n; j > 0; --j) sum -= a[j] * y[k - j];
    y[k] = sum;
  }
}

}  // namespace

Vector difference_equation(const Vector& b, const Vector& a, const Vector& u) {
  const Index n = a.size() - 1, m = b.size() - 1, total = u.size();
  Vector y = b[0] * u;
  for (Index j = 1; j <= std::min(m, total - 1); ++j) y.tail(total - j) += b[j] * u.head(total - j);
  for (Index k = 1; k < std::min(n, total); ++k) {
    for (Index j = k; j > 0; --j) y[k] -= a[j] * y[k - j];
  }
  constexpr std::array kFeedBack = {&feed_back<0>, &feed_back<1>, &feed_back<2>, &feed_back<3>, &feed_back<4>,
                                    &feed_back<5>, &feed_back<6>, &feed_back<7>, &feed_back<8>};
  if (n > 0) kFeedBack[static_cast<std::size_t>(n < std::ssize(kFeedBack) ? n : 0)](a, n, y);
  return y;
}

}  // namespace mbk::dsp
