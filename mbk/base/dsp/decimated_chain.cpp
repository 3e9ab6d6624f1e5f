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

/// The moments of all blocks and the states of both directions, with blocks of nothing on either side.
struct DecimatedChain::Blocks {
  Index before, count, after;
  Interleaved moments, back, ahead;

  Blocks(Index blocks_before, Index blocks, Index blocks_after, std::size_t states)
      : before(blocks_before + 1),
        count(blocks),
        after(blocks_after + 1),
        moments(before + count + after, 4 * kMoments),
        back(before + count + after, static_cast<Index>(4 * states)),
        ahead(before + count + after, static_cast<Index>(4 * states)) {
    for (Interleaved* const rows : {&moments, &back, &ahead}) {
      std::fill_n(rows->row(0), before * rows->width(), 0.0);
      std::fill_n(rows->row(before + count), after * rows->width(), 0.0);
    }
  }
};

/// Upper half plane only; nothing where they cannot be told apart.
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
  std::size_t states = 0;
  double fastest = 0.0;
  for (const Mode& mode : made.modes_) {
    states += mode.weight > 1.0 ? 2 : 1;
    fastest = std::max(fastest, std::abs(std::log(mode.p)));
  }
  if (states > kMaxModalStates || (states % 2 == 0) != (made.modes_.front().weight > 1.0)) return std::nullopt;

  const auto longest = static_cast<Index>(kShort / fastest);
  constexpr auto kShortest = static_cast<Index>(kMoments);
  Index length = std::min(longest, every);
  if (every <= longest) {
    made.rows_per_block_ = longest / every;
    length = every * made.rows_per_block_;
  } else {
    while (length >= kShortest && every % length != 0) --length;
    if (length > 0) made.blocks_per_row_ = every / length;
  }
  if (length < kShortest) return std::nullopt;

  made.every_ = every;
  made.half_ = chain.smoothing.half_window();
  made.padding_ = chain.padding;
  made.direct_ = made.kappa_ * OneWay::gain(chain.lowpass);
  const Index h = made.half_;
  for (const int derivative : derivatives) {
    auto weights = savitzky_golay_weights(chain.smoothing, derivative);
    if (!weights) return tl::unexpected(weights.error());
    Smoothing& smoothing = made.smoothing_.emplace_back();
    smoothing.weights = *weights * std::pow(rate.value, derivative);
    smoothing.parity = derivative % 2 == 0 ? 1.0 : -1.0;
    for (const Mode& mode : made.modes_) {
      std::vector<Complex>& U = smoothing.U.emplace_back();
      U.reserve(static_cast<std::size_t>(2 * h + 1));
      Complex value = 0.0;
      for (Index j = 2 * h; j >= 0; --j) U.push_back(value = product(mode.p, value) + smoothing.weights[j]);
    }
  }

  BlockFilter& filter = made.filter_;
  filter.length = length;
  filter.states = states;
  const Matrix shapes = orthonormal_polynomials(length);
  const Index pairs = (length + 1) / 2;
  filter.shapes.resize(static_cast<std::size_t>(divided_up(pairs, 4) * 4 * shapes.rows()));
  for (Index i = 0; i < pairs; ++i) {
    const double share = 2 * i + 1 == length ? 0.5 : 1.0;  // the centre is taken twice
    for (Index k = 0; k < shapes.rows(); ++k) {
      filter.shapes[static_cast<std::size_t>((i / 4 * shapes.rows() + k) * 4 + i % 4)] = share * shapes(k, length - 1 - i);
    }
  }
  Matrix drive(static_cast<Index>(states), shapes.rows());
  Index state = 0;
  for (const Mode& mode : made.modes_) {
    const Complex log_p = std::log(mode.p), over_block = std::exp(static_cast<double>(length) * log_p);
    Vector real(length), imaginary(length);  // p⁻ᵗ
    Complex value = std::exp(0.5 * static_cast<double>(length - 1) * log_p);
    for (Index i = 0; i < length; ++i, value /= mode.p) {
      real[i] = value.real();
      imaginary[i] = value.imag();
    }
    drive.row(state++) = shapes * real;
    filter.power.push_back(over_block.real());
    if (mode.weight == 1.0) continue;
    drive.row(state++) = shapes * imaginary;
    filter.power.push_back(over_block.imag());
  }
  filter.drive.assign(drive.data(), drive.data() + drive.size());

  // A row stands in the middle of its part of the block.
  const Index place = made.rows_per_block_ > 1 ? every / 2 : length / 2;
  made.first_ = -((length - ((h - place) % length + length) % length) % length);
  made.before_ = divided_up(h - 1 - place, length);
  made.after_ = std::max<Index>(0, divided_up(h + place + (made.rows_per_block_ - 1) * every, length) - 1);
  const Index reach = std::max((made.before_ + 1), (made.after_ + 1)) * length + length;
  std::vector<Vector> kernels;
  for (const Smoothing& smoothing : made.smoothing_) kernels.push_back(made.kernel(smoothing, reach));
  for (Index r = 0; r < made.rows_per_block_; ++r) {
    const Index at = place + r * every;
    std::vector<double>& weights = made.sums_.emplace_back();
    for (Index block = -made.before_; block <= made.after_; ++block) {
      Matrix of_block(shapes.rows(), std::ssize(kernels));
      for (Index d = 0; d < of_block.cols(); ++d) {  // λ = row − sample falls from sample to sample
        const Vector& kernel = kernels[static_cast<std::size_t>(d)];
        of_block.col(d) = shapes * kernel.segment(reach + at - block * length - (length - 1), length).reverse();
      }
      for (Index k = 0; k < shapes.rows(); ++k) weights.insert(weights.end(), of_block.row(k).begin(), of_block.row(k).end());
    }
    const double middle = 0.5 * static_cast<double>(length - 1);
    const double behind = static_cast<double>(at + (made.before_ + 1) * length) - middle;
    const double in_front = static_cast<double>((made.after_ + 1) * length - at) + middle;
    for (const bool ahead : {false, true}) {
      for (std::size_t m = 0; m < made.modes_.size(); ++m) {
        const Mode& mode = made.modes_[m];
        const Complex distance =
            mode.weight * mode.c * std::exp(((ahead ? in_front : behind) - static_cast<double>(h)) * std::log(mode.p));
        std::vector<double> imaginary;
        for (const Smoothing& smoothing : made.smoothing_) {
          const Complex weight = (ahead ? smoothing.parity : 1.0) * distance * smoothing.U[m].back();
          weights.push_back(weight.real());
          imaginary.push_back(-weight.imag());
        }
        if (mode.weight > 1.0) weights.insert(weights.end(), imaginary.begin(), imaginary.end());
      }
    }
  }
  return made;
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

void DecimatedChain::take_blocks(const FourColumns& columns, Index length, const FourValues& less, Blocks& to) const {
  const Index size = filter_.length;
  const auto take = [&](const FourColumns& from, const FourValues& reference, Index block, Index count) {
    const Index at = to.before + block;
    take_moments(filter_, from, reference, count, to.moments.row(at), to.back.row(at), to.ahead.row(at));
  };
  // The blocks at the ends are filled up by reflection in the point, which leaves no step in them.
  std::vector<double> padded(kLanes * static_cast<std::size_t>(size));
  const auto take_padded = [&](Index block) {
    FourColumns from{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      double* const value = padded.data() + static_cast<Index>(lane) * size;
      const double* const x = columns[lane];
      from[lane] = value;
      for (Index i = 0; i < size; ++i) {
        const Index t = first_ + block * size + i;
        const double inside = t < 0 ? 2.0 * x[0] - x[-t] : t < length ? x[t] : 2.0 * x[length - 1] - x[2 * length - 2 - t];
        value[i] = inside - less[lane];
      }
    }
    take(from, {}, block, 1);
  };
  FourColumns from = columns;
  for (const double*& column : from) column += first_ + size;
  take_padded(0);
  take(from, less, 1, to.count - 2);
  take_padded(to.count - 1);
  sweep(filter_, to.count, to.back.row(to.before), to.ahead.row(to.before));
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
    for (Index i = 0, j = count - 1; i < j; ++i, --j) std::swap_ranges(end.samples.row(i), end.samples.row(i) + 4, end.samples.row(j));
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
    return Eigen::Map<const Eigen::Array4d>(
        end.smoothed.data() + kLanes * (smoothing_.size() * static_cast<std::size_t>(k) + derivative));
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

/// Σ_{t ≤ n − 1} p^(n − 1 − t) x[t] with n rows of smoothed samples.
DecimatedChain::FourComplex DecimatedChain::sum_up_to(Index n, std::size_t mode, const FourColumns& columns,
                                                      const FourValues& less, const Blocks& blocks) const {
  std::size_t state = 0;
  for (std::size_t m = 0; m < mode; ++m) state += modes_[m].weight > 1.0 ? 2 : 1;
  const Mode& of = modes_[mode];
  const Index block = (n - first_) / filter_.length - 1, next = first_ + (block + 1) * filter_.length;
  const double* const back = blocks.back.row(blocks.before + block) + kLanes * state;
  const double from_centre = static_cast<double>(n - next) + 0.5 * static_cast<double>(filter_.length - 1);
  const Complex power = std::exp(from_centre * std::log(of.p));
  FourComplex sum = FourComplex::Zero();
  for (Index t = next; t < n; ++t) {
    sum *= of.p;
    for (std::size_t lane = 0; lane < kLanes; ++lane) sum[static_cast<Index>(lane)] += columns[lane][t] - less[lane];
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    sum[static_cast<Index>(lane)] += power * Complex(back[lane], of.weight > 1.0 ? back[kLanes + lane] : 0.0);
  }
  return sum;
}

/// What the rows behind the end add: those of the padding, and that the way back begins at rest,
///   Σ_p ρ_p p^(N − i) (f[N] p/(1 − p) − Σ_q ρ_q F_q pq/(1 − pq))
/// with N the last padded row, F_q = Σ_{m ≤ N} q^(N − m) s[m], and f[N] = Σ_q ρ_q F_q + κ s[N] of the way there.
std::vector<DecimatedChain::FourComplex> DecimatedChain::behind_end(const End& start, const End& end,
                                                                    const FourColumns& columns, Index length,
                                                                    const FourValues& less,
                                                                    const Blocks& blocks) const {
  const Index n = length - 2 * half_, pad = padding_.samples;
  std::vector<FourComplex> sums(modes_.size()), amplitudes;
  for (std::size_t m = 0; m < modes_.size(); ++m) sums[m] = sum_up_to(n, m, columns, less, blocks);
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

void DecimatedChain::run(const FourColumns& columns, Index length, const FourValues& less, double* values) const {
  const Index rows = (length - 2 * half_ - 1) / every_ + 1, size = filter_.length;
  const Index count = divided_up(length - first_, size);
  Blocks blocks(before_, count, after_, filter_.states);
  take_blocks(columns, length, less, blocks);
  const auto width = static_cast<Index>(kLanes * smoothing_.size());
  for (Index r = 0; r < rows_per_block_; ++r) {
    const Index at = blocks.before + (half_ + r * every_ - first_) / size;
    const auto terms = [&](const Interleaved& of, Index first, Index many) {
      return Terms{of.row(first), many * of.width() / static_cast<Index>(kLanes), blocks_per_row_ * of.width()};
    };
    weighted_sums(sums_[static_cast<std::size_t>(r)], smoothing_.size(),
                  {terms(blocks.moments, at - before_, before_ + 1 + after_), terms(blocks.back, at - before_ - 1, 1),
                   terms(blocks.ahead, at + after_ + 1, 1)},
                  divided_up(rows - r, rows_per_block_), values + width * r, width * rows_per_block_);
  }
  const End start = end_of(columns, length, less, false, -first_);
  const End end = end_of(columns, length, less, true, first_ + count * size - length);
  std::vector<FourComplex> before_start;
  for (std::size_t k = 0; k < start.missing.size(); ++k) {
    const Mode& mode = modes_[k % modes_.size()];
    before_start.emplace_back(mode.weight * mode.c * start.missing[k]);
  }
  add_modes(before_start, 0, false, rows, values);
  add_modes(behind_end(start, end, columns, length, less, blocks), length - 2 * half_ - 1 - (rows - 1) * every_, true,
            rows, values);
}

}  // namespace mbk::dsp
