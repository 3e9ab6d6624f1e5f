#include "mbk/base/dsp/decimated_chain.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace mbk::dsp {
namespace {

using Complex = std::complex<double>;

/// |log p|·L up to which a block of L samples is short: ten blocks for each period of the cutoff, and a little more.
constexpr double kShort = 0.65;

Complex product(const Complex& a, const Complex& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// Polynomials of degree 0 … kMoments − 1 that are orthonormal on −(L − 1)/2 … (L − 1)/2: kMoments×L.
Matrix orthonormal_polynomials(Index length) {
  const double half = 0.5 * static_cast<double>(length - 1);
  const Eigen::RowVectorXd t = Eigen::RowVectorXd::LinSpaced(length, -half, half);
  Matrix shapes(static_cast<Index>(kMoments), length);
  Eigen::RowVectorXd p = Eigen::RowVectorXd::Ones(length), p_before = Eigen::RowVectorXd::Zero(length);
  double norm_before = 1.0;
  for (Index k = 0; k < shapes.rows(); ++k) {
    const double norm = p.squaredNorm();
    shapes.row(k) = p / std::sqrt(norm);
    const Eigen::RowVectorXd next = t.cwiseProduct(p) - (k > 0 ? norm / norm_before : 0.0) * p_before;
    p_before = p;
    p = next;
    norm_before = norm;
  }
  return shapes;
}

Index divided_up(Index a, Index b) {
  return a > 0 ? (a + b - 1) / b : 0;
}

/// Σ of complex weights times four real values.
class FourSum {
 public:
  void add(const Complex& weight, const Eigen::Array4d& values) {
    real_ += weight.real() * values;
    imaginary_ += weight.imag() * values;
  }
  [[nodiscard]] Eigen::Array<Complex, 4, 1> total() const {
    Eigen::Array<Complex, 4, 1> both;
    both.real() = real_;
    both.imag() = imaginary_;
    return both;
  }

 private:
  Eigen::Array4d real_ = Eigen::Array4d::Zero(), imaginary_ = real_;
};

}  // namespace

/// Upper half plane only; nothing where they lie too close together.
std::optional<std::vector<DecimatedChain::Mode>> DecimatedChain::modes_of(const SectionCascade& lowpass,
                                                                          double& kappa) {
  std::vector<Complex> poles;
  kappa = 1.0;
  for (const SecondOrderSection& s : lowpass) {
    const double discriminant = s.a1 * s.a1 / 4.0 - s.a2;
    const bool is_short = s.a2 == 0.0 && s.b2 == 0.0;
    if (is_short ? s.a1 == 0.0 : discriminant >= 0.0) return std::nullopt;
    kappa *= is_short ? s.b1 / s.a1 : s.b2 / s.a2;
    if (is_short) {
      poles.emplace_back(-s.a1, 0.0);
      continue;
    }
    const Complex upper(-s.a1 / 2.0, std::sqrt(-discriminant));
    poles.push_back(upper);
    poles.push_back(std::conj(upper));
  }
  constexpr double kApart = 0.2;  // of the largest distance from 1; poles of Butterworth's filter of order ten are 0.31
  double largest = 0.0;
  for (const Complex& p : poles) largest = std::max(largest, std::abs(1.0 - p));
  for (std::size_t i = 0; i < poles.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (std::abs(poles[i] - poles[j]) < kApart * largest) return std::nullopt;
    }
    if (std::abs(poles[i]) >= 1.0) return std::nullopt;
  }
  const auto response_at = [&](const Complex& x) {  // H at z⁻¹ = x
    Complex value = 1.0;
    for (const SecondOrderSection& s : lowpass) {
      value *= (s.b0 + x * (s.b1 + x * s.b2)) / (1.0 + x * (s.a1 + x * s.a2));
    }
    return value;
  };
  std::vector<Mode> modes;
  for (const Complex& p : poles) {
    if (p.imag() < 0.0) continue;
    Complex rho = 1.0;
    for (const SecondOrderSection& s : lowpass) rho *= s.b0 + (s.b1 + s.b2 / p) / p;
    for (const Complex& other : poles) {
      if (other != p) rho /= 1.0 - other / p;
    }
    modes.push_back({p, rho * response_at(p), rho, p.imag() > 0.0 ? 2.0 : 1.0});
  }
  std::ranges::stable_sort(modes, {}, [](const Mode& m) { return m.weight; });  // the real one first
  return modes;
}

Result<std::optional<DecimatedChain>> DecimatedChain::plan(const FilterChain& chain, std::span<const int> derivatives,
                                                           Hertz rate, Index every) {
  DecimatedChain made;
  auto modes = modes_of(chain.lowpass, made.kappa_);
  if (!modes || modes->empty()) return std::nullopt;
  made.modes_ = std::move(*modes);
  made.every_ = every;
  made.half_ = chain.smoothing.half_window();
  made.padding_ = chain.padding;
  made.direct_ = made.kappa_ * OneWay::gain(chain.lowpass);
  if (!made.choose_blocks()) return std::nullopt;
  for (const int derivative : derivatives) {
    auto weights = MBK_TRY(savitzky_golay_weights(chain.smoothing, derivative));
    Smoothing& smoothing = made.smoothing_.emplace_back();
    smoothing.weights = weights * std::pow(rate.value, derivative);
    smoothing.parity = derivative % 2 == 0 ? 1.0 : -1.0;
    for (const Mode& mode : made.modes_) {
      std::vector<Complex>& U = smoothing.U.emplace_back();
      U.reserve(static_cast<std::size_t>(smoothing.weights.size()));
      Complex value = 0.0;
      for (Index j = smoothing.weights.size() - 1; j >= 0; --j) {
        U.push_back(value = product(mode.p, value) + smoothing.weights[j]);
      }
    }
  }
  const Matrix shapes = orthonormal_polynomials(made.filter_.length);
  made.prepare_blocks(shapes);
  made.prepare_rows(shapes);
  return made;
}

bool DecimatedChain::choose_blocks() {
  double fastest = 0.0;
  filter_.states = 0;
  for (const Mode& mode : modes_) {
    filter_.states += mode.weight > 1.0 ? 2 : 1;
    fastest = std::max(fastest, std::abs(std::log(mode.p)));
  }
  const bool one_real_at_most = (filter_.states % 2 == 0) == (modes_.front().weight > 1.0);
  if (filter_.states > kMaxModalStates || !one_real_at_most) return false;

  constexpr auto kShortest = static_cast<Index>(kMoments);
  const auto longest = static_cast<Index>(kShort / fastest);
  Index length = std::min(longest, every_);
  if (every_ <= longest) {
    rows_per_block_ = longest / every_;
    length = every_ * rows_per_block_;
  } else {
    while (length >= kShortest && every_ % length != 0) --length;
    if (length >= kShortest) blocks_per_row_ = every_ / length;
  }
  if (length < kShortest) return false;
  filter_.length = length;
  // A row stands in the middle of its part of the block.
  place_ = rows_per_block_ > 1 ? every_ / 2 : length / 2;
  first_ = -((length - ((half_ - place_) % length + length) % length) % length);
  before_ = divided_up(half_ - 1 - place_, length);
  after_ = std::max<Index>(0, divided_up(half_ + place_ + (rows_per_block_ - 1) * every_, length) - 1);
  return true;
}

void DecimatedChain::prepare_blocks(const Matrix& shapes) {
  const Index length = filter_.length, pairs = (length + 1) / 2;
  filter_.shapes.resize(static_cast<std::size_t>(divided_up(pairs, 4) * 4 * shapes.rows()));
  for (Index i = 0; i < pairs; ++i) {
    const double share = 2 * i + 1 == length ? 0.5 : 1.0;  // the centre is taken twice
    for (Index k = 0; k < shapes.rows(); ++k) {
      filter_.shapes[static_cast<std::size_t>((i / 4 * shapes.rows() + k) * 4 + i % 4)] =
          share * shapes(k, length - 1 - i);
    }
  }
  Matrix drive(static_cast<Index>(filter_.states), shapes.rows());
  Index state = 0;
  for (const Mode& mode : modes_) {
    const Complex log_p = std::log(mode.p), over_block = std::exp(static_cast<double>(length) * log_p);
    const Complex backwards = 1.0 / mode.p;
    Vector real(length), imaginary(length);  // p⁻ᵗ
    Complex value = std::exp(0.5 * static_cast<double>(length - 1) * log_p);
    for (Index i = 0; i < length; ++i, value = product(value, backwards)) {
      real[i] = value.real();
      imaginary[i] = value.imag();
    }
    drive.row(state++) = shapes * real;
    filter_.power.push_back(over_block.real());
    if (mode.weight == 1.0) continue;
    drive.row(state++) = shapes * imaginary;
    filter_.power.push_back(over_block.imag());
  }
  filter_.drive.assign(drive.data(), drive.data() + drive.size());
}

void DecimatedChain::prepare_rows(const Matrix& shapes) {
  const Index length = filter_.length, reach = (std::max(before_, after_) + 2) * length;
  std::vector<Vector> kernels;
  for (const Smoothing& smoothing : smoothing_) kernels.push_back(kernel(smoothing, reach));
  for (Index r = 0; r < rows_per_block_; ++r) {
    const Index at = place_ + r * every_;
    Row& row = rows_.emplace_back();
    for (Index block = -before_; block <= after_; ++block) {
      Matrix of_block(std::ssize(kernels), shapes.rows());
      for (Index d = 0; d < of_block.rows(); ++d) {  // λ = row − sample falls from sample to sample
        const Vector& kernel = kernels[static_cast<std::size_t>(d)];
        of_block.row(d) = shapes * kernel.segment(reach + at - (block + 1) * length + 1, length).reverse();
      }
      row.near.insert(row.near.end(), of_block.data(), of_block.data() + of_block.size());
    }
    const double middle = 0.5 * static_cast<double>(length - 1);
    row.back = weights_of_states(static_cast<double>(at + (before_ + 1) * length) - middle, false);
    row.ahead = weights_of_states(static_cast<double>((after_ + 1) * length - at) + middle, true);
  }
}

/// What the states of a block count in a row so many samples from its centre.
std::vector<double> DecimatedChain::weights_of_states(double distance, bool ahead) const {
  std::vector<double> weights;
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    const Mode& mode = modes_[m];
    const Complex power = mode.weight * mode.c * std::exp((distance - static_cast<double>(half_)) * std::log(mode.p));
    std::vector<double> imaginary;
    for (const Smoothing& smoothing : smoothing_) {
      const Complex weight = (ahead ? smoothing.parity : 1.0) * power * smoothing.U[m].back();
      weights.push_back(weight.real());
      imaginary.push_back(-weight.imag());
    }
    if (mode.weight > 1.0) weights.insert(weights.end(), imaginary.begin(), imaginary.end());
  }
  return weights;
}

/// g(λ), λ = −reach … reach.
Vector DecimatedChain::kernel(const Smoothing& smoothing, Index reach) const {
  const Index h = half_;
  // T(λ) = Σ_p c_p Σ_{j ≥ −λ} w_j p^(λ + j), and r(0) without the direct part.
  Vector T = Vector::Zero(2 * reach + 1);
  double centre = 0.0;
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    const Mode& mode = modes_[m];
    const Complex c = mode.weight * mode.c;
    centre += c.real();
    Complex value = 0.0;
    for (Index lambda = -h; lambda <= reach; ++lambda) {
      value = lambda <= h ? smoothing.U[m][static_cast<std::size_t>(lambda + h)] : product(mode.p, value);
      T[reach + lambda] += c.real() * value.real() - c.imag() * value.imag();
    }
  }
  Vector g = T + smoothing.parity * T.reverse();
  g.segment(reach - h, 2 * h + 1) -= smoothing.parity * (centre - direct_) * smoothing.weights;
  return g;
}

Index DecimatedChain::shortest() const {
  return 2 * half_ + 1 + padding_.samples + 4 * filter_.length;
}

/// Moments of blocks [first, end); those at the ends of the signal are filled up by reflection in a point, which leaves
/// no step in them.
void DecimatedChain::take_blocks(const FourColumns& columns, Index length, const FourValues& less, Index first,
                                 Index end, double* moments) const {
  const Index size = filter_.length, count = divided_up(length - first_, size);
  const auto row_of = [&](Index block) { return moments + 4 * static_cast<Index>(kMoments) * (block - first); };
  const auto take_padded = [&](Index block) {
    std::vector<double> padded(kLanes * static_cast<std::size_t>(size));
    FourColumns from{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      double* const value = padded.data() + static_cast<Index>(lane) * size;
      const double* const x = columns[lane];
      from[lane] = value;
      for (Index i = 0; i < size; ++i) {
        const Index t = first_ + block * size + i;
        value[i] = t < 0 ? 2.0 * x[0] - x[-t] : t < length ? x[t] : 2.0 * x[length - 1] - x[2 * length - 2 - t];
      }
    }
    take_moments(filter_, from, less, 1, row_of(block));
  };
  const Index inside = std::max<Index>(first, 1), outside = std::min(end, count - 1);
  if (first == 0) take_padded(0);
  FourColumns from = columns;
  for (const double*& column : from) column += first_ + inside * size;
  take_moments(filter_, from, less, outside - inside, row_of(inside));
  if (end == count) take_padded(count - 1);
}

/// @param filled samples beyond the end with which its block was filled up
DecimatedChain::End DecimatedChain::end_of(const FourColumns& columns, Index length, const FourValues& less, bool last,
                                           Index filled) const {
  const Index window = 2 * half_ + 1, pad = padding_.samples, count = window + pad;
  const auto derivatives = smoothing_.size();
  End end(count);
  FourColumns from = columns;
  if (last) {
    for (const double*& column : from) column += length - count;
  }
  interleave(from, count, less, 1.0, end.samples.row(0));
  if (last) {
    for (Index i = 0, j = count - 1; i < j; ++i, --j) {
      std::swap_ranges(end.samples.row(i), end.samples.row(i) + kLanes, end.samples.row(j));
    }
  }
  // Derivatives change their sign with the direction.
  std::vector<double> weights;
  for (const Smoothing& one : smoothing_) {
    const Vector directed = (last ? one.parity : 1.0) * one.weights;
    weights.insert(weights.end(), directed.begin(), directed.end());
  }
  end.smoothed.resize(4 * derivatives * static_cast<std::size_t>(pad + 1));
  correlate_every(weights, derivatives, end.samples.row(0), 1, pad + 1, end.smoothed.data());

  for (std::size_t d = 0; d < derivatives; ++d) {
    for (std::size_t m = 0; m < modes_.size(); ++m) {
      const Complex p = modes_[m].p;
      const std::vector<Complex>& U = smoothing_[d].U[m];
      FourSum padded, beyond, seen;
      Complex power = 1.0;
      for (Index i = 1; i <= pad; ++i) padded.add(power = product(power, p), extended(end, d, i));
      // Before the start it has been constant for ever; behind the end nothing counts yet.
      if (!last) padded.add(power * p / (1.0 - p), extended(end, d, pad));
      power = U.back();
      for (Index i = 1; i <= filled; ++i) beyond.add(power = product(power, p), 2.0 * end.sample(0) - end.sample(i));
      for (Index t = 0; t < 2 * half_; ++t) seen.add(U[static_cast<std::size_t>(2 * half_ - t - 1)], end.sample(t));
      const double parity = last ? smoothing_[d].parity : 1.0;
      end.missing.emplace_back(padded.total() - parity * (beyond.total() + p * seen.total()));
    }
  }
  return end;
}

/// The i-th smoothed row beyond the end.
Eigen::Array4d DecimatedChain::extended(const End& end, std::size_t derivative, Index i) const {
  const auto row = [&](Index k) {
    return Eigen::Map<const Eigen::Array4d>(end.smoothed.data() +
                                            kLanes * (smoothing_.size() * static_cast<std::size_t>(k) + derivative));
  };
  switch (padding_.extension) {
    case Extension::odd:
      return 2.0 * row(0) - row(i);
    case Extension::even:
      return row(i);
    case Extension::constant:
      break;
  }
  return row(0);
}

/// Adds Σ_p A_p p^(offset + k·every) to row k, counted from the first row or from the last one backwards.
void DecimatedChain::add_modes(const std::vector<FourComplex>& amplitudes, Index offset, bool backwards, Index rows,
                               double* values) const {
  constexpr double kNothing = 1e-14;
  const auto width = static_cast<Index>(kLanes * smoothing_.size());
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    const Mode& mode = modes_[m];
    const Complex log_p = std::log(mode.p), step = std::exp(static_cast<double>(every_) * log_p);
    Complex power = std::exp(static_cast<double>(offset) * log_p);
    const auto lasting = static_cast<Index>(std::log(kNothing) / (static_cast<double>(every_) * log_p.real())) + 1;
    for (Index k = 0; k < std::min(rows, lasting); ++k, power = product(power, step)) {
      double* const to = values + width * (backwards ? rows - 1 - k : k);
      for (std::size_t d = 0; d < smoothing_.size(); ++d) {
        const FourComplex& amplitude = amplitudes[d * modes_.size() + m];
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
          const Complex& one = amplitude[static_cast<Index>(lane)];
          to[kLanes * d + lane] += power.real() * one.real() - power.imag() * one.imag();
        }
      }
    }
  }
}

/// Σ_{t < n} p^(n − 1 − t) x[t] of each mode.
/// @param states  that look back, of the last block that ends before n
std::vector<DecimatedChain::FourComplex> DecimatedChain::sums_before(Index n, const double* states,
                                                                     const FourColumns& columns,
                                                                     const FourValues& less) const {
  const Index next = first_ + last_block_before(n) * filter_.length + filter_.length;
  const double from_centre = static_cast<double>(n - next) + 0.5 * static_cast<double>(filter_.length - 1);
  std::vector<FourComplex> sums;
  for (const Mode& mode : modes_) {
    const Complex power = std::exp(from_centre * std::log(mode.p));
    FourComplex& sum = sums.emplace_back(FourComplex::Zero());
    for (Index t = next; t < n; ++t) {
      sum *= mode.p;
      for (std::size_t lane = 0; lane < kLanes; ++lane) sum[static_cast<Index>(lane)] += columns[lane][t] - less[lane];
    }
    const bool complex = mode.weight > 1.0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      sum[static_cast<Index>(lane)] += power * Complex(states[lane], complex ? states[kLanes + lane] : 0.0);
    }
    states += complex ? 2 * kLanes : kLanes;
  }
  return sums;
}

/// What the rows behind the end add: those of the padding, and that the way back begins at rest,
///   Σ_p ρ_p p^(N − i) (f[N] p/(1 − p) − Σ_q ρ_q F_q pq/(1 − pq))
/// with N the last padded row, F_q = Σ_{m ≤ N} q^(N − m) s[m], and f[N] = Σ_q ρ_q F_q + κ s[N] of the way there.
std::vector<DecimatedChain::FourComplex> DecimatedChain::behind_end(const End& start, const End& end, Index n,
                                                                    const std::vector<FourComplex>& sums) const {
  const Index pad = padding_.samples;
  std::vector<FourComplex> amplitudes;
  for (std::size_t d = 0; d < smoothing_.size(); ++d) {
    const std::size_t first = d * modes_.size();
    std::vector<FourComplex> F = sums;
    FourComplex f = (kappa_ * extended(end, d, pad)).cast<Complex>();
    for (std::size_t q = 0; q < modes_.size(); ++q) {
      const std::vector<Complex>& U = smoothing_[d].U[q];
      const Complex log_p = std::log(modes_[q].p);
      FourSum latest, padded;
      for (Index t = 0; t < 2 * half_; ++t) latest.add(U[static_cast<std::size_t>(t)], end.sample(t));
      Complex power = 1.0;
      for (Index i = pad; i >= 1; --i, power = product(power, modes_[q].p)) padded.add(power, extended(end, d, i));
      F[q] = U.back() * F[q] + latest.total() + std::exp(static_cast<double>(n - 1) * log_p) * start.missing[first + q];
      F[q] = power * F[q] + padded.total();
      f += modes_[q].weight * (modes_[q].rho * F[q]).real().cast<Complex>();
    }
    for (std::size_t m = 0; m < modes_.size(); ++m) {
      const Complex p = modes_[m].p;
      FourComplex rest = f * (p / (1.0 - p));
      for (std::size_t q = 0; q < modes_.size(); ++q) {
        for (const bool conjugate : {false, true}) {
          if (conjugate && modes_[q].weight == 1.0) continue;
          const Complex pole = conjugate ? std::conj(modes_[q].p) : modes_[q].p;
          const Complex rho = conjugate ? std::conj(modes_[q].rho) : modes_[q].rho;
          const Complex factor = rho * p * pole / (1.0 - p * pole);
          rest -= factor * (conjugate ? FourComplex(F[q].conjugate()) : F[q]);
        }
      }
      const Complex over_padding = std::exp(static_cast<double>(pad) * std::log(p));
      amplitudes.push_back(modes_[m].weight *
                           (modes_[m].c * end.missing[first + m] + modes_[m].rho * over_padding * rest));
    }
  }
  return amplitudes;
}

/// Calls use(r, first, end) for the r-th row of a block: its rows [first, end) in blocks [begin, behind), counted
/// without the other rows of a block.
template <class Use>
void DecimatedChain::for_rows(Index begin, Index behind, Index rows, Use&& use) const {
  for (Index r = 0; r < rows_per_block_; ++r) {
    const Index at = block_of(r), all = divided_up(rows - r, rows_per_block_);
    const Index first = divided_up(begin - at, blocks_per_row_);
    const Index end = std::min(all, divided_up(behind - at, blocks_per_row_));
    if (first < end) use(r, first, end);
  }
}

void DecimatedChain::run(const FourColumns& columns, Index length, const FourValues& less, double* values) const {
  constexpr Index kChunk = 64;  // blocks that stay in the first cache
  const Index n = length - 2 * half_, rows = (n - 1) / every_ + 1, count = divided_up(length - first_, filter_.length);
  const auto width = static_cast<Index>(kLanes * smoothing_.size());
  const auto states = static_cast<Index>(filter_.states);
  const auto sum = [&](const std::vector<double>& weights, const Terms& terms, Sums how, Index r, Index first,
                       Index end) {
    weighted_sums(weights, smoothing_.size(), terms, end - first, how, values + width * (rows_per_block_ * first + r),
                  width * rows_per_block_);
  };
  // Before the first block and behind the last there is nothing.
  Interleaved moments(before_ + count + after_ + 1, 4 * kMoments);
  std::fill_n(moments.row(0), before_ * moments.width(), 0.0);
  std::fill_n(moments.row(before_ + count), (after_ + 1) * moments.width(), 0.0);

  // In order: what is near to a row, as soon as it is there, and what is before it.
  const Index past = before_ + 1 + after_, whole = last_block_before(n);
  Interleaved back(past + kChunk, 4 * states);
  std::fill_n(back.row(0), past * back.width(), 0.0);
  std::vector<double> at_end(static_cast<std::size_t>(back.width()));
  for (Index begin = 0, ready = 0; begin < count; begin += kChunk) {
    const Index some = std::min(kChunk, count - begin);
    take_blocks(columns, length, less, begin, begin + some, moments.row(before_ + begin));
    advance_modes(filter_, Looking::back, some, moments.row(before_ + begin), back.row(past));
    if (whole >= begin && whole < begin + some) {
      std::copy_n(back.row(past + whole - begin), back.width(), at_end.data());
    }
    const Index soon = begin + some == count ? count : begin + some - after_;
    for_rows(ready, soon, rows, [&](Index r, Index first, Index end) {
      const Index block = block_of(r) + blocks_per_row_ * first;
      const Row& row = rows_[static_cast<std::size_t>(r)];
      sum(row.near, {moments.row(block), past * static_cast<Index>(kMoments), blocks_per_row_ * moments.width()},
          Sums::written, r, first, end);
      sum(row.back, {back.row(past + block - before_ - 1 - begin), states, blocks_per_row_ * back.width()}, Sums::added,
          r, first, end);
    });
    ready = soon;
    std::copy_n(back.row(some), past * back.width(), back.row(0));
  }

  const End start = end_of(columns, length, less, false, -first_);
  const End end = end_of(columns, length, less, true, first_ + count * filter_.length - length);
  std::vector<FourComplex> before_start;
  for (std::size_t k = 0; k < start.missing.size(); ++k) {
    const Mode& mode = modes_[k % modes_.size()];
    before_start.emplace_back(mode.weight * mode.c * start.missing[k]);
  }
  add_modes(before_start, 0, false, rows, values);
  add_modes(behind_end(start, end, n, sums_before(n, at_end.data(), columns, less)), n - 1 - (rows - 1) * every_, true,
            rows, values);

  // Against the order: what is behind a row.
  Interleaved ahead(kChunk + 1, 4 * states);
  std::fill_n(ahead.row(0), ahead.width(), 0.0);
  for (Index behind = count; behind > 0;) {
    const Index begin = std::max<Index>(0, behind - kChunk), some = behind - begin;
    std::copy_n(ahead.row(0), ahead.width(), ahead.row(some));
    advance_modes(filter_, Looking::ahead, some, moments.row(before_ + begin + after_ + 1), ahead.row(0));
    for_rows(begin, behind, rows, [&](Index r, Index first, Index last) {
      const Index block = block_of(r) + blocks_per_row_ * first;
      sum(rows_[static_cast<std::size_t>(r)].ahead, {ahead.row(block - begin), states, blocks_per_row_ * ahead.width()},
          Sums::added, r, first, last);
    });
    behind = begin;
  }
}

}  // namespace mbk::dsp
