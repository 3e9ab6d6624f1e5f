#include "tests/reference/quad_filters.h"

#include <quadmath.h>

#include <algorithm>
#include <cstddef>

namespace mbk::reference {
namespace {

using Size = std::size_t;

Quad pi() {
  return acosq(-1);
}

/// x with A x = b, by elimination with row exchanges.
Signal solve(std::vector<Signal> A, Signal b) {
  const Size n = b.size();
  for (Size k = 0; k < n; ++k) {
    Size pivot = k;
    for (Size i = k + 1; i < n; ++i) {
      if (fabsq(A[i][k]) > fabsq(A[pivot][k])) pivot = i;
    }
    std::swap(A[k], A[pivot]);
    std::swap(b[k], b[pivot]);
    for (Size i = k + 1; i < n; ++i) {
      const Quad factor = A[i][k] / A[k][k];
      for (Size j = k; j < n; ++j) A[i][j] -= factor * A[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (Size k = n; k-- > 0;) {
    for (Size j = k + 1; j < n; ++j) b[k] -= A[k][j] * b[j];
    b[k] /= A[k][k];
  }
  return b;
}

Signal product(const Signal& p, const Signal& q) {
  Signal r(p.size() + q.size() - 1, 0);
  for (Size i = 0; i < p.size(); ++i) {
    for (Size j = 0; j < q.size(); ++j) r[i + j] += p[i] * q[j];
  }
  return r;
}

/// One pass, transposed direct form II. The states that keep an input u constant at y = u (unit gain at zero
/// frequency) are z_k = u Σ_{j>k} (b_j − a_j).
Signal pass_from_steady_state(const Filter& filter, Signal x) {
  const Size order = filter.a.size() - 1;
  Signal z(order + 1, 0);
  for (Size k = order; k-- > 0;) z[k] = z[k + 1] + x.front() * (filter.b[k + 1] - filter.a[k + 1]);
  for (Quad& sample : x) {
    const Quad u = sample;
    const Quad y = filter.b[0] * u + z[0];
    for (Size k = 0; k < order; ++k) z[k] = filter.b[k + 1] * u - filter.a[k + 1] * y + z[k + 1];
    sample = y;
  }
  return x;
}

}  // namespace

Signal savitzky_golay_weights(int order, int window, int derivative, Quad T) {
  const int h = (window - 1) / 2;
  const Size n = static_cast<Size>(order) + 1;
  std::vector<Signal> A;
  for (int j = -h; j <= h; ++j) {
    Signal row(n, 1);
    for (Size k = 1; k < n; ++k) row[k] = row[k - 1] * j / h;
    A.push_back(row);
  }
  std::vector<Signal> normal(n, Signal(n, 0));
  for (const Signal& row : A) {
    for (Size i = 0; i < n; ++i) {
      for (Size k = 0; k < n; ++k) normal[i][k] += row[i] * row[k];
    }
  }
  Signal right(n, 0);
  right[static_cast<Size>(derivative)] = 1;
  for (int d = 1; d <= derivative; ++d) right[static_cast<Size>(derivative)] *= d / (h * T);
  const Signal q = solve(normal, right);
  Signal weights;
  for (const Signal& row : A) {
    Quad weight = 0;
    for (Size k = 0; k < n; ++k) weight += row[k] * q[k];
    weights.push_back(weight);
  }
  return weights;
}

Filter butterworth(int order, Quad cutoff_hz, Quad rate_hz) {
  const Quad K = tanq(pi() * cutoff_hz / rate_hz);
  // s = (1 − q)/(K (1 + q)), q = z⁻¹, in 1/[(s + 1) Π (s² + 2 cos θᵢ s + 1)], θᵢ = i π/order
  Filter filter{{K / (1 + K), K / (1 + K)}, {1, (K - 1) / (1 + K)}};
  for (int i = 1; i <= (order - 1) / 2; ++i) {
    const Quad damping = 2 * cosq(i * pi() / order) * K;
    const Quad a0 = 1 + damping + K * K;
    filter.b = product(filter.b, {K * K / a0, 2 * K * K / a0, K * K / a0});
    filter.a = product(filter.a, {1, 2 * (K * K - 1) / a0, (1 - damping + K * K) / a0});
  }
  return filter;
}

Quad squared_gain(const Filter& filter, Quad frequency_hz, Quad rate_hz) {
  const Quad omega = 2 * pi() * frequency_hz / rate_hz;
  const auto square = [omega](const Signal& p) {
    Quad real = 0, imaginary = 0;
    for (Size k = 0; k < p.size(); ++k) {
      real += p[k] * cosq(omega * static_cast<int>(k));
      imaginary -= p[k] * sinq(omega * static_cast<int>(k));
    }
    return real * real + imaginary * imaginary;
  };
  return square(filter.b) / square(filter.a);
}

Signal zero_phase(const Filter& filter, const Signal& signal) {
  const Size reach = 3 * (filter.a.size() - 1);
  const Size n = signal.size();
  Signal x;
  for (Size i = reach; i >= 1; --i) x.push_back(2 * signal[0] - signal[i]);
  x.insert(x.end(), signal.begin(), signal.end());
  for (Size i = 1; i <= reach; ++i) x.push_back(2 * signal[n - 1] - signal[n - 1 - i]);
  for (int direction = 0; direction < 2; ++direction) {
    x = pass_from_steady_state(filter, std::move(x));
    std::ranges::reverse(x);
  }
  const auto first = x.begin() + static_cast<std::ptrdiff_t>(reach);
  return {first, first + static_cast<std::ptrdiff_t>(n)};
}

std::vector<Signal> least_squares(std::vector<Signal> Z, std::vector<Signal> Y) {
  const Size columns = Z.size();
  for (Size k = 0; k < columns; ++k) {
    // Reflection I − 2 v vᵀ/vᵀv that clears column k below the diagonal.
    Signal v(Z[k].begin() + static_cast<std::ptrdiff_t>(k), Z[k].end());
    Quad norm2 = 0;
    for (const Quad value : v) norm2 += value * value;
    const Quad alpha = v[0] > 0 ? -sqrtq(norm2) : sqrtq(norm2);
    const Quad half_vv = norm2 - alpha * v[0];
    v[0] -= alpha;
    const auto reflect = [&](Signal& column) {
      Quad dot = 0;
      for (Size i = 0; i < v.size(); ++i) dot += v[i] * column[k + i];
      for (Size i = 0; i < v.size(); ++i) column[k + i] -= dot / half_vv * v[i];
    };
    for (Size j = k; j < columns; ++j) reflect(Z[j]);
    for (Signal& y : Y) reflect(y);
  }
  for (Signal& y : Y) {
    for (Size k = columns; k-- > 0;) {
      for (Size j = k + 1; j < columns; ++j) y[k] -= Z[j][k] * y[j];
      y[k] /= Z[k][k];
    }
    y.resize(columns);
  }
  return Y;
}

}  // namespace mbk::reference
