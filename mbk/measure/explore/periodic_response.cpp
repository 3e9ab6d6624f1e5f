#include "mbk/measure/explore/periodic_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "mbk/base/dsp/fourier.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/explore/alike.h"
#include "mbk/measure/explore/period.h"
#include "mbk/measure/explore/response_intervals.h"

namespace mbk::explore {
namespace {

using Cx = Eigen::MatrixXcd;
using CxVector = Eigen::VectorXcd;

/// Sizes of what is computed.
struct Sizes {
  Index outputs = 0, inputs = 0;
  Index period = 0;  ///< samples
  Index lines = 0;   ///< line k is column k − 1
  double sample_time = 0;
};

/// Spectra of the periods of one realisation: rows are outputs, inputs and, behind them, the reference.
struct Realisation {
  std::vector<Cx> periods;  ///< each signals×lines
};

/// Means over the periods and the covariance from one to the next.
struct Averages {
  Cx Y, U, R;                  ///< n_y×lines, n_u×lines, n_u×lines
  std::vector<Cx> covariance;  ///< of [y; u] of one period, at each line
  Index periods = 0;
};

Cx spectra_of(const ExplorationTrial& trial, Index begin, const Sizes& sizes, bool with_reference) {
  Cx spectra(sizes.outputs + sizes.inputs * (with_reference ? 2 : 1), sizes.lines);
  const auto transform = [&](const Matrix& signals, Index row) {
    const Cx X = dsp::fourier_transforms(signals.middleRows(begin, sizes.period));
    spectra.middleRows(row, X.cols()) = X.middleRows(1, sizes.lines).transpose() / static_cast<double>(sizes.period);
  };
  transform(trial.output, 0);
  transform(trial.input, sizes.outputs);
  if (with_reference) transform(trial.reference, sizes.outputs + sizes.inputs);
  return spectra;
}

/// The signal that distinguishes realisations: the reference, or the mean input.
Cx identity_of(const Realisation& one, const Sizes& sizes) {
  Cx mean = Cx::Zero(sizes.inputs, sizes.lines);
  for (const Cx& period : one.periods) mean += period.bottomRows(sizes.inputs);
  return mean / static_cast<double>(one.periods.size());
}

/// The shift τ in samples for which b e^{jωτ} is `a`, where there is one: at the largest of the circular correlation.
std::optional<Index> shift_between(const Cx& a, const Cx& b, const Sizes& sizes, double alike) {
  const double power = std::sqrt(a.squaredNorm() * b.squaredNorm());
  if (!(power > 0.0)) return std::nullopt;
  std::vector<std::pair<double, Index>> strongest;
  CxVector cross(sizes.lines);
  for (Index k = 0; k < sizes.lines; ++k) {
    cross[k] = a.col(k).dot(b.col(k));
    strongest.emplace_back(std::abs(cross[k]), k);
  }
  if (!(cross.cwiseAbs().sum() >= alike * power)) return std::nullopt;  // not even with the best phases
  constexpr std::size_t kUsed = 40;                                     // enough to find the shift
  const std::size_t used = std::min(kUsed, strongest.size());
  std::ranges::partial_sort(strongest, strongest.begin() + static_cast<std::ptrdiff_t>(used), std::greater<>());
  CxVector roots(sizes.period);
  for (Index i = 0; i < sizes.period; ++i) {
    roots[i] = std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(sizes.period));
  }
  double best = 0.0;
  Index shift = 0;
  for (Index tau = 0; tau < sizes.period; ++tau) {
    double sum = 0.0;
    for (std::size_t i = 0; i < used; ++i) {
      const Index k = strongest[i].second;
      sum += (cross[k] * roots[(k + 1) * tau % sizes.period]).real();
    }
    if (sum > best) {
      best = sum;
      shift = tau;
    }
  }
  double all = 0.0;
  for (Index k = 0; k < sizes.lines; ++k) all += (cross[k] * roots[(k + 1) * shift % sizes.period]).real();
  return all >= alike * power ? std::optional(shift) : std::nullopt;
}

/// Line by line times e^{jωτ}.
void turn(Cx& spectra, Index tau, Index period) {
  for (Index k = 0; k < spectra.cols(); ++k) {
    const double angle =
        2.0 * std::numbers::pi * static_cast<double>((k + 1) * tau % period) / static_cast<double>(period);
    spectra.col(k) *= std::polar(1.0, angle);
  }
}

Result<Index> period_of(std::span<const ExplorationTrial> trials, const PeriodicOptions& options, bool by_reference) {
  const ExplorationTrial& first = trials.front();
  if (options.period_s) {
    const double samples = *options.period_s / first.sample_time;
    const auto whole = static_cast<Index>(std::llround(samples));
    if (whole < 8) return bad_usage(fmt::format("a period of {:g} s has fewer than 8 samples", *options.period_s));
    if (std::abs(samples - static_cast<double>(whole)) > 1e-3) {
      return bad_usage(fmt::format("a period of {:g} s is not a whole number of samples at {:g} Hz", *options.period_s,
                                   1.0 / first.sample_time));
    }
    return whole;
  }
  const auto found = find_period(by_reference ? first.reference : first.input, by_reference);
  if (!found || *found < 8) {
    return bad_data(fmt::format("the {} is not periodic", by_reference ? "reference" : "input"),
                    "give its period with --period, or use --method welch or local-polynomial");
  }
  return *found;
}

std::vector<Realisation> realisations_of(std::span<const ExplorationTrial> trials, const Sizes& sizes,
                                         bool by_reference) {
  std::vector<Realisation> found;
  std::vector<Cx> identities;
  for (const ExplorationTrial& trial : trials) {
    std::vector<PeriodicPart> parts =
        by_reference ? periodic_parts(trial.reference, sizes.period) : std::vector<PeriodicPart>{{0, trial.samples()}};
    for (const PeriodicPart part : parts) {
      const Index count = (part.end - part.begin) / sizes.period;
      if (count < 1) continue;
      Realisation one;
      const Index begin = part.end - count * sizes.period;
      for (Index p = 0; p < count; ++p) {
        one.periods.push_back(spectra_of(trial, begin + p * sizes.period, sizes, by_reference));
      }
      const Cx identity = identity_of(one, sizes);
      const double alike = by_reference ? 1.0 - 1e-4 : 0.98;
      std::size_t same = identities.size();
      Index shift = 0;
      for (std::size_t k = 0; k < identities.size() && same == identities.size(); ++k) {
        const auto tau = shift_between(identities[k], identity, sizes, alike);
        if (!tau) continue;
        same = k;
        shift = *tau;
      }
      if (same == identities.size()) {
        identities.push_back(identity);
        found.push_back(std::move(one));
        continue;
      }
      for (Cx& period : one.periods) {
        turn(period, shift, sizes.period);
        found[same].periods.push_back(std::move(period));
      }
    }
  }
  return found;
}

Averages averages_of(const std::vector<Cx>& periods, const Sizes& sizes, bool by_reference) {
  Averages average;
  average.periods = static_cast<Index>(periods.size());
  Cx mean = Cx::Zero(periods.front().rows(), sizes.lines);
  for (const Cx& period : periods) mean += period;
  mean /= static_cast<double>(periods.size());
  const Index both = sizes.outputs + sizes.inputs;
  average.Y = mean.topRows(sizes.outputs);
  average.U = mean.middleRows(sizes.outputs, sizes.inputs);
  average.R = by_reference ? Cx(mean.bottomRows(sizes.inputs)) : average.U;
  average.covariance.assign(static_cast<std::size_t>(sizes.lines), Cx::Zero(both, both));
  if (periods.size() < 2) return average;
  for (const Cx& period : periods) {
    for (Index k = 0; k < sizes.lines; ++k) {
      const CxVector d = period.col(k).head(both) - mean.col(k).head(both);
      average.covariance[static_cast<std::size_t>(k)] += d * d.adjoint();
    }
  }
  for (Cx& C : average.covariance) C /= static_cast<double>(periods.size() - 1);
  return average;
}

/// Whether the first period differs from the others, by their spread, at the lines that are excited. At each, the
/// squared step over the spread has Fisher's distribution, whose probabilities Fisher's sum combines.
bool first_differs(const std::vector<Cx>& periods, const std::vector<Index>& lines, const Sizes& sizes) {
  const auto count = static_cast<Index>(periods.size());
  if (count < 3) return false;
  const auto others = static_cast<double>(count - 1);
  double sum = 0.0;
  int terms = 0;
  for (const Index k : lines) {
    for (Index i = 0; i < sizes.outputs; ++i) {
      std::complex<double> mean = 0.0;
      for (Index p = 1; p < count; ++p) mean += periods[static_cast<std::size_t>(p)](i, k) / others;
      double spread = 0.0;
      for (Index p = 1; p < count; ++p) spread += std::norm(periods[static_cast<std::size_t>(p)](i, k) - mean);
      const double freedom = others - 1.0;
      const double step = std::norm(periods.front()(i, k) - mean) / (1.0 + 1.0 / others);
      if (!(spread > 0.0)) continue;
      sum += 2.0 * freedom * std::log1p(step / spread);  // −2 ln P(F > step freedom/spread), F of 2 and 2·freedom
      terms += 2;
    }
  }
  return terms > 0 && sum > numeric::chi_square_quantile(0.999, terms);
}

/// Power of the means over the periods along each input, the greatest of all realisations: n_u×lines.
Matrix greatest_power(const std::vector<Averages>& averages, const Sizes& sizes) {
  Matrix power = Matrix::Zero(sizes.inputs, sizes.lines);
  for (const Averages& one : averages) power = power.cwiseMax(one.R.cwiseAbs2());
  return power;
}

/// Of the means over the periods along each input, the greatest of all realisations; infinite where one period shows
/// none.
Matrix greatest_noise(const std::vector<Averages>& averages, const Sizes& sizes) {
  Matrix noise = Matrix::Zero(sizes.inputs, sizes.lines);
  for (const Averages& one : averages) {
    for (Index k = 0; k < sizes.lines; ++k) {
      for (Index j = 0; j < sizes.inputs; ++j) {
        const Index at = sizes.outputs + j;
        const double here = one.periods > 1 ? one.covariance[static_cast<std::size_t>(k)](at, at).real() /
                                                  static_cast<double>(one.periods)
                                            : std::numeric_limits<double>::infinity();
        noise(j, k) = std::max(noise(j, k), here);
      }
    }
  }
  return noise;
}

/// What is at a line: nothing that stands out, too little power to say anything there, or a perturbation.
enum class Line { empty, weak, excited };

void raise(std::vector<Line>& lines, Index k, Line to) {
  Line& line = lines[static_cast<std::size_t>(k)];
  line = std::max(line, to);
}

/// Lines that a commanded signal holds: it is exact, so that the others are empty but for rounding.
void add_commanded(const Vector& power, std::vector<Line>& lines) {
  constexpr double kMin = 2e-4;  // of the greatest power: bent axes make lines of 1 % of the amplitude of theirs
  constexpr double kRounding = 1e-8;
  for (Index k = 0; k < power.size(); ++k) {
    if (!(power[k] > kRounding * power.maxCoeff())) continue;
    raise(lines, k, power[k] > kMin * power.maxCoeff() ? Line::excited : Line::weak);
  }
}

/// Lines that a measured signal was given, by its power alone: within the band that leaves 0.1 % of it below and above
/// (the last hundredth only where the lines stand above their noise and go on from those before), of odd lines alone
/// where the even ones hold less than 5 %, those above a twentieth of the amplitude that one in ten of their sixteen
/// neighbours exceeds: of every fourth line excited, the median would be that of an empty one. A resonance of what is
/// measured may take most of a line away; noise and distortion fill the empty ones. Lines beyond the band that stand
/// above their noise are weak.
/// @param noise  of the power, at each line
void add_measured(const Vector& power, const Vector& noise, std::vector<Line>& found) {
  constexpr double kBelow = 1e-3, kAbove = 1e-2, kFarAbove = 1e-3, kEven = 0.05, kMin = 0.05, kClear = 30.0,
                   kStep = 0.3;
  constexpr Index kNeighbours = 8;
  double even = 0.0;
  for (Index k = 1; k < power.size(); k += 2) even += power[k];
  const bool odd_alone = even < kEven * power.sum();
  std::vector<Index> lines;
  for (Index k = 0; k < power.size(); k += odd_alone ? 2 : 1) lines.push_back(k);
  double total = 0.0, sum = 0.0;
  for (const Index k : lines) total += power[k];
  std::vector<Index> band;
  for (const Index k : lines) {
    const double before = sum;
    sum += power[k];
    double largest = 0.0;  // of the band's last lines: what follows a sudden end is distortion
    for (std::size_t i = band.size() - std::min<std::size_t>(band.size(), kNeighbours); i < band.size(); ++i) {
      largest = std::max(largest, power[band[i]]);
    }
    const bool stands_out = power[k] > kClear * noise[k];
    const bool clear = stands_out && power[k] > kStep * kStep * largest && before < (1.0 - kFarAbove) * total;
    if (sum > kBelow * total && (clear || before < (1.0 - kAbove) * total)) {
      band.push_back(k);
    } else if (stands_out) {
      raise(found, k, Line::weak);
    }
  }
  for (std::size_t i = 0; i < band.size(); ++i) {
    std::vector<double> near;
    const std::size_t first = i > kNeighbours ? i - kNeighbours : 0;
    for (std::size_t l = first; l < std::min(band.size(), i + kNeighbours + 1); ++l) near.push_back(power[band[l]]);
    const auto high = near.begin() + static_cast<std::ptrdiff_t>(9 * near.size() / 10);
    std::ranges::nth_element(near, high);
    if (power[band[i]] > kMin * kMin * *high) raise(found, band[i], Line::excited);
  }
}

/// Lines at which some realisation is excited along some input.
/// @param weak  how many others are weak
std::vector<Index> excited_lines(const std::vector<Averages>& averages, const Sizes& sizes, bool by_reference,
                                 Index& weak) {
  const Matrix power = greatest_power(averages, sizes), noise = greatest_noise(averages, sizes);
  std::vector<Line> found(static_cast<std::size_t>(sizes.lines), Line::empty);
  for (Index j = 0; j < sizes.inputs; ++j) {
    by_reference ? add_commanded(power.row(j), found) : add_measured(power.row(j), noise.row(j), found);
  }
  weak = std::ranges::count(found, Line::weak);
  std::vector<Index> lines;
  for (Index k = 0; k < sizes.lines; ++k) {
    if (found[static_cast<std::size_t>(k)] == Line::excited) lines.push_back(k);
  }
  return lines;
}

/// Whether consecutive realisations have orthogonal references, n_u by n_u.
bool in_orthogonal_groups(const std::vector<Averages>& averages, const std::vector<Index>& lines, const Sizes& sizes) {
  const Index n = sizes.inputs, count = static_cast<Index>(averages.size());
  if (n < 2 || count % n != 0) return false;
  constexpr double kOrthogonal = 0.02;
  for (Index g = 0; g < count; g += n) {
    for (const Index k : lines) {
      Cx R(n, n);
      for (Index m = 0; m < n; ++m) R.col(m) = averages[static_cast<std::size_t>(g + m)].R.col(k);
      const Cx S = R * R.adjoint();
      for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j < i; ++j) {
          if (!(std::norm(S(i, j)) <= kOrthogonal * kOrthogonal * S(i, i).real() * S(j, j).real())) return false;
        }
      }
    }
  }
  return true;
}

/// e eᴴ with e = vec of a matrix, column by column.
Cx outer(const Cx& matrix) {
  const CxVector e = matrix.reshaped();
  return e * e.adjoint();
}

Cx kronecker(const Cx& W, const Cx& C) {
  Cx product(W.rows() * C.rows(), W.cols() * C.cols());
  for (Index j = 0; j < W.rows(); ++j) {
    for (Index l = 0; l < W.cols(); ++l) product.block(j * C.rows(), l * C.cols(), C.rows(), C.cols()) = W(j, l) * C;
  }
  return product;
}

/// [I −G] C [I −G]ᴴ
Cx covariance_of_residual(const Cx& C, const Cx& G) {
  Cx T(G.rows(), G.rows() + G.cols());
  T << Cx::Identity(G.rows(), G.rows()), -G;
  return T * C * T.adjoint();
}

/// Lines beside those that are excited, between the first and the last of them, even or odd.
std::vector<Index> empty_lines(const std::vector<Index>& excited, bool even) {
  std::vector<Index> lines;
  for (std::size_t i = 0; i + 1 < excited.size(); ++i) {
    for (Index k = excited[i] + 1; k < excited[i + 1]; ++k) {
      if (((k + 1) % 2 == 0) == even) lines.push_back(k);
    }
  }
  return lines;
}

/// Everything that is known of a response once it is found at the lines `at`.
struct Found {
  std::vector<Index> at;
  std::vector<Cx> G;
};

/// G at line k between those that are known.
Cx between_lines(const Found& found, Index k) {
  const auto above = std::ranges::lower_bound(found.at, k);
  if (above == found.at.end()) return found.G.back();
  const auto upper = static_cast<std::size_t>(above - found.at.begin());
  if (found.at[upper] == k || upper == 0) return found.G[upper];
  const double share =
      static_cast<double>(k - found.at[upper - 1]) / static_cast<double>(found.at[upper] - found.at[upper - 1]);
  return (1.0 - share) * found.G[upper - 1] + share * found.G[upper];
}

/// What remains at an empty line, power by output: the output without G U, the output itself, and the noise of the
/// means of both.
struct EmptyLine {
  Vector corrected, uncorrected, noise, output_noise;
};

EmptyLine empty_line(const std::vector<Averages>& averages, const Found& found, Index k, Index outputs) {
  EmptyLine line{Vector::Zero(outputs), Vector::Zero(outputs), Vector::Zero(outputs), Vector::Zero(outputs)};
  const Cx G = between_lines(found, k);
  const auto count = static_cast<double>(averages.size());
  for (const Averages& one : averages) {
    const CxVector Y = one.Y.col(k);
    line.corrected += (Y - G * one.U.col(k)).cwiseAbs2() / count;
    line.uncorrected += Y.cwiseAbs2() / count;
    const Cx& C = one.covariance[static_cast<std::size_t>(k)];
    const double means = count * static_cast<double>(one.periods);
    line.noise += covariance_of_residual(C, G).diagonal().real() / means;
    line.output_noise += C.diagonal().head(outputs).real() / means;
  }
  return line;
}

std::optional<Distortion> distortion_at(const std::vector<Index>& lines, const std::vector<Averages>& averages,
                                        const Found& found, const Sizes& sizes) {
  constexpr std::size_t kMinLines = 3;  // fewer do not show a level
  if (lines.size() < kMinLines) return std::nullopt;
  Vector scale = Vector::Zero(sizes.outputs);
  for (const Averages& one : averages) {
    for (const Index k : found.at) scale += one.Y.col(k).cwiseAbs2();
  }
  scale /= static_cast<double>(averages.size() * found.at.size());
  double corrected = 0.0, uncorrected = 0.0, noise = 0.0, output_noise = 0.0, freedom = 0.0;
  for (const Averages& one : averages) freedom += 2.0 * static_cast<double>(one.periods - 1);
  for (const Index k : lines) {
    const EmptyLine line = empty_line(averages, found, k, sizes.outputs);
    corrected += line.corrected.cwiseQuotient(scale).sum();
    uncorrected += line.uncorrected.cwiseQuotient(scale).sum();
    noise += line.noise.cwiseQuotient(scale).sum();
    output_noise += line.output_noise.cwiseQuotient(scale).sum();
  }
  const double terms = static_cast<double>(lines.size()) * static_cast<double>(sizes.outputs);
  const auto root = [&](double sum) { return std::sqrt(sum / terms); };
  Distortion distortion;
  distortion.lines = static_cast<Index>(lines.size());
  distortion.relative = root(corrected);
  distortion.uncorrected = root(uncorrected);
  distortion.residual_noise = root(noise);
  distortion.noise = root(output_noise);
  const double unit = std::sqrt(scale.sum() / static_cast<double>(sizes.outputs));
  distortion.output_amplitude = unit;
  const double above = 2.0 * terms * static_cast<double>(averages.size()), below = terms * freedom;
  const auto probability = [&](double of) {
    return of > 0.0 ? numeric::f_probability_above(corrected / of, above, below) : 0.0;
  };
  distortion.p = probability(output_noise);
  distortion.residual_p = probability(noise);
  return distortion;
}

/// Variance of the odd distortion near line k, from the empty odd lines next to it; on the diagonal, output by output.
Cx odd_distortion_near(Index k, const std::vector<Index>& odd, const std::vector<EmptyLine>& known, Index outputs) {
  constexpr std::size_t kNeighbours = 6;
  std::vector<std::pair<Index, std::size_t>> near;
  for (std::size_t i = 0; i < odd.size(); ++i) near.emplace_back(std::abs(odd[i] - k), i);
  const std::size_t count = std::min(kNeighbours, near.size());
  std::ranges::partial_sort(near, near.begin() + static_cast<std::ptrdiff_t>(count));
  Vector level = Vector::Zero(outputs);
  for (std::size_t i = 0; i < count; ++i) level += known[near[i].second].corrected - known[near[i].second].noise;
  return (level / static_cast<double>(count)).cwiseMax(0.0).cast<std::complex<double>>().asDiagonal();
}

}  // namespace

Result<FrequencyResponseEstimate> periodic_response(std::span<const ExplorationTrial> trials,
                                                    const PeriodicOptions& options) {
  MBK_TRY(check_alike(trials));
  const bool by_reference = all_have_reference(trials);
  const auto period = MBK_TRY(period_of(trials, options, by_reference));
  const ExplorationTrial& first = trials.front();
  Sizes sizes{first.output.cols(), first.input.cols(), period, 0, first.sample_time};
  const double period_s = static_cast<double>(period) * first.sample_time;
  sizes.lines = std::min<Index>((period - 1) / 2,
                                static_cast<Index>(std::floor(options.max_frequency_hz * period_s * (1.0 + 1e-12))));
  if (sizes.lines < 1) {
    return bad_usage(
        fmt::format("no line of a period of {:g} s lies below {:g} Hz", period_s, options.max_frequency_hz),
        "choose a higher --max-frequency");
  }

  std::vector<Realisation> realisations = realisations_of(trials, sizes, by_reference);
  const auto count = static_cast<Index>(realisations.size());
  if (count == 0)
    return bad_data(fmt::format("there are no two consecutive periods of {:g} s", period_s), "record longer");
  if (count < sizes.inputs) {
    return bad_data(fmt::format("{} trial{} cannot separate {} inputs at one frequency",
                                count == 1 ? std::string("one") : fmt::format("{}", count), count == 1 ? "" : "s",
                                sizes.inputs == 2 ? std::string("the two") : fmt::format("{}", sizes.inputs)),
                    "record several trials with different phases, or use --method welch or local-polynomial");
  }
  PeriodicFacts facts;
  facts.period_s = period_s;
  facts.period_found = !options.period_s;
  facts.realisations = count;
  std::vector<Averages> averages;
  const auto average_all = [&] {
    averages.clear();
    facts.periods = std::numeric_limits<Index>::max();
    for (const Realisation& one : realisations) {
      averages.push_back(averages_of(one.periods, sizes, by_reference));
      facts.periods = std::min(facts.periods, averages.back().periods);
    }
  };
  average_all();
  const std::vector<Index> excited = excited_lines(averages, sizes, by_reference, facts.weak_lines);
  facts.skipped_lines = facts.weak_lines;
  for (Realisation& one : realisations) {
    if (!first_differs(one.periods, excited, sizes)) continue;
    one.periods.erase(one.periods.begin());
    ++facts.dropped_periods;
  }
  if (facts.dropped_periods > 0) average_all();
  facts.orthogonal = in_orthogonal_groups(averages, excited, sizes);
  facts.odd = std::ranges::all_of(excited, [](Index k) { return (k + 1) % 2 == 1; });

  const Index group = facts.orthogonal ? sizes.inputs : 1;
  const double groups = static_cast<double>(count / group),
               lost = facts.orthogonal ? 1.0 : static_cast<double>(sizes.inputs);
  const bool robust = groups - lost >= 1.0 && !options.without_realisations;
  double noise_freedom = 0.0;
  for (const Averages& one : averages) noise_freedom += static_cast<double>(one.periods - 1);
  if (!robust && !(noise_freedom >= 1.0)) {
    return bad_data("one period of each realisation shows no noise", "record two periods or more");
  }

  Found known;
  std::vector<Cx> inverses;
  for (const Index k : excited) {
    Cx A = Cx::Zero(sizes.inputs, sizes.inputs), B = Cx::Zero(sizes.outputs, sizes.inputs);
    Vector input_power = Vector::Zero(sizes.inputs), reference_power = input_power;
    for (const Averages& one : averages) {
      A += one.U.col(k) * one.R.col(k).adjoint();
      B += one.Y.col(k) * one.R.col(k).adjoint();
      input_power += one.U.col(k).cwiseAbs2();
      reference_power += one.R.col(k).cwiseAbs2();
    }
    constexpr double kSmallest = 1e-3;  // singular value of the directions, of unit vectors
    Cx unit = input_power.cwiseSqrt().cwiseInverse().asDiagonal() * A *
              reference_power.cwiseSqrt().cwiseInverse().asDiagonal();
    if (!unit.allFinite() || numeric::complex_singular_values(unit)[sizes.inputs - 1] < kSmallest) {
      ++facts.skipped_lines;
      continue;
    }
    inverses.push_back(numeric::complex_inverse(A));
    known.at.push_back(k);
    known.G.push_back(B * inverses.back());
  }
  if (known.at.empty()) {
    return bad_data("the inputs are not excited in all directions at any line",
                    "record trials with different phases of the axes, or use --method welch or local-polynomial");
  }

  FrequencyResponseEstimate found;
  found.method = robust ? FrequencyResponseMethod::robust : FrequencyResponseMethod::fast;
  found.by_reference = by_reference;
  found.inputs = first.input_labels;
  found.outputs = first.output_labels;
  found.averages = static_cast<double>(count);
  const auto lines = static_cast<Index>(known.at.size());
  found.frequency.resize(lines);
  found.degrees_of_freedom.resize(lines);
  found.response = known.G;
  found.multiple_coherence.resize(lines, sizes.outputs);

  std::vector<Index> odd = facts.odd ? empty_lines(excited, false) : std::vector<Index>();
  std::vector<EmptyLine> odd_known;
  if (noise_freedom >= 1.0 && facts.odd) {
    facts.even = distortion_at(empty_lines(excited, true), averages, known, sizes);
    facts.odd_lines = distortion_at(odd, averages, known, sizes);
    if (!facts.odd_lines) odd.clear();
    for (const Index k : odd) odd_known.push_back(empty_line(averages, known, k, sizes.outputs));
  }
  double total_sum = 0.0, noise_sum = 0.0, noise_squares = 0.0;
  for (Index i = 0; i < lines; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Index k = known.at[at];
    const Cx &G = known.G[at], &A_inverse = inverses[at];
    const Index entries = G.size();
    found.frequency[i] = static_cast<double>(k + 1) / period_s;
    Cx noise = Cx::Zero(entries, entries), total = noise, weights = Cx::Zero(sizes.inputs, sizes.inputs), sum;
    Vector explained = Vector::Zero(sizes.outputs), rest = explained;
    for (Index m = 0; m < count; ++m) {
      const Averages& one = averages[static_cast<std::size_t>(m)];
      const Cx row = one.R.col(k).adjoint() * A_inverse;
      const Cx C = covariance_of_residual(one.covariance[static_cast<std::size_t>(k)], G);
      const Cx W = row.transpose() * row.conjugate();
      noise += kronecker(W, C) / static_cast<double>(one.periods);
      weights += W;
      const CxVector V = one.Y.col(k) - G * one.U.col(k);
      sum = m % group == 0 ? Cx(V * row) : Cx(sum + V * row);
      if (m % group == group - 1) total += outer(sum);
      explained += (G * one.U.col(k)).cwiseAbs2();
      rest += V.cwiseAbs2() * (robust ? groups / (groups - lost) : 0.0);
      // rest is of the mean over the periods; of a single one it has the noise of one
      rest += C.diagonal().real() * (robust ? 1.0 - 1.0 / static_cast<double>(one.periods) : 1.0);
    }
    total *= robust ? groups / (groups - lost) : 0.0;
    found.noise_covariance.push_back(noise);
    if (robust) {
      found.covariance.push_back(total);
      found.degrees_of_freedom[i] = groups - lost;
    } else {
      Cx covariance = noise;
      if (!odd_known.empty()) {
        covariance += kronecker(weights, odd_distortion_near(k, odd, odd_known, sizes.outputs));
      }
      found.covariance.push_back(std::move(covariance));
      found.degrees_of_freedom[i] = noise_freedom;
    }
    found.multiple_coherence.row(i) = explained.cwiseQuotient(explained + rest).transpose();
    total_sum += total.trace().real();
    noise_sum += noise.trace().real();
    for (Index e = 0; e < entries; ++e) noise_squares += std::norm(noise(e, e));
  }
  if (noise_freedom < 1.0) found.noise_covariance.clear();
  if (robust && noise_freedom >= 1.0 && noise_sum > 0.0) {
    facts.total_over_noise = total_sum / noise_sum;
    const double terms = noise_sum * noise_sum / noise_squares;  // as many of equal weight (Satterthwaite)
    facts.total_over_noise_p = numeric::f_probability_above(*facts.total_over_noise, 2.0 * terms * (groups - lost),
                                                            2.0 * terms * noise_freedom);
  }
  if (robust) {
    found.assumes = "independent, identically distributed errors of realisations: noise and distortion together";
  } else if (!odd_known.empty()) {
    found.assumes = "noise as it varies between periods, and odd distortion as at the empty odd lines";
  } else {
    found.assumes = "noise as it varies between periods; they do not include distortion that repeats in every period";
  }
  found.periodic = facts;
  add_intervals(found);
  return found;
}

}  // namespace mbk::explore
