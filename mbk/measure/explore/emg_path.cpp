#include "mbk/measure/explore/emg_path.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/units.h"
#include "mbk/base/dsp/cross_spectrum.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::explore {
namespace {

constexpr double kEmgMemory = 0.5;      ///< [s]
constexpr double kSlowest = 20.0;       ///< [s]: what changes more slowly is drift
constexpr double kSlowestOfBand = 3.0;  ///< [s], below the bands of the coherence
constexpr double kSummedEmg = 0.1;      ///< [s], lags that are tested as one
constexpr Index kEmgFolds = 8;
constexpr Index kRowsPerEmgLag = 10;
constexpr double kChanceOfEmg = 0.001;
constexpr double kCoherenceSegment = 2.0;                       ///< [s]
constexpr std::array kBandEdges = {0.5, 2.0, 5.0, 10.0, 20.0};  ///< [Hz]
constexpr std::size_t kMinSegmentsPerInput = 3;                 ///< for a share that means something

Matrix beside(const Matrix& a, const Matrix& b) {
  Matrix both(std::max(a.rows(), b.rows()), a.cols() + b.cols());
  if (a.cols() > 0) both.leftCols(a.cols()) = a;
  if (b.cols() > 0) both.rightCols(b.cols()) = b;
  return both;
}

PathColumns beside(const PathColumns& a, const PathColumns& b) {
  return {beside(a.measured, b.measured), beside(a.explained, b.explained), beside(a.judged, b.judged)};
}

/// Columns less what cosines with periods of `slowest` seconds or more explain of them, and their means, piece by
/// piece: force that drifts, and EMG that grows with fatigue, would explain each other.
/// @param of    rows of `ranges` under each other
Matrix without_drift(const Matrix& of, const std::vector<RowRange>& ranges, const std::vector<RowRange>& pieces,
                     double slowest, double sample_time) {
  Matrix left = of;
  Index at = 0;
  std::size_t next = 0;
  for (const RowRange& piece : pieces) {
    std::vector<Index> rows;
    const Index begin = at;
    for (; next < ranges.size() && ranges[next].begin < piece.end; ++next) {
      for (Index row = ranges[next].begin; row < ranges[next].end; ++row) rows.push_back(row - piece.begin);
      at += ranges[next].size();
    }
    if (rows.empty()) continue;
    const auto length = static_cast<double>(rows.back() + 1 - rows.front());
    const auto cosines = static_cast<Index>(2.0 * length * sample_time / slowest);
    Matrix slow(static_cast<Index>(rows.size()), cosines + 1);
    for (Index k = 0; k < slow.cols(); ++k) {
      for (Index i = 0; i < slow.rows(); ++i) {
        const double phase = (static_cast<double>(rows[static_cast<std::size_t>(i)] - rows.front()) + 0.5) / length;
        slow(i, k) = std::cos(std::numbers::pi * static_cast<double>(k) * phase);
      }
    }
    auto part = left.middleRows(begin, slow.rows());
    part -= (slow * numeric::householder_solve(slow, Matrix(part))).eval();
  }
  return left;
}

/// Paths with EMG, as fitted to the rows that identify.
struct WithEmg {
  Index kept = 0;  ///< directions of the EMG
  LaggedFit fit;   ///< of the other paths, then those
};

class EmgFit {
 public:
  EmgFit(const LimbSignals& signals, const std::vector<RowRange>& rows, const std::vector<RowRange>& judged)
      : s_(signals),
        rows_(rows),
        judged_(judged),
        memory_(static_cast<Index>(std::floor(kEmgMemory / s_.sample_time + 1e-9))),
        Y_(fast(rows_of(s_.resistance, rows))),
        lags_(fast(lagged(s_.muscles, 0, memory_, rows))),
        directions_(principal_directions(lags_)),
        emg_(lags_ * directions_) {}

  EmgPath run(PathColumns intrinsic, PathColumns reflex) {
    EmgPath found = named();
    for (PathColumns* const path : {&intrinsic, &reflex}) {
      path->measured = fast(path->measured);
      path->explained = fast(path->explained);
    }
    const PathColumns others = beside(intrinsic, reflex);
    const Index coefficients = others.measured.cols() + lags_.cols();
    if (row_count(rows_) < kRowsPerEmgLag * coefficients) {
      found.why = fmt::format("{} muscles have {} coefficients, too many for {} rows of {:.3g} ms",
                              found.muscles.size(), coefficients, row_count(rows_), kMilliseconds * s_.sample_time);
      return found;
    }
    decide(others, found);
    const WithEmg all = with_emg(others);
    const WithEmg without_reflex = reflex.measured.cols() > 0 ? with_emg(intrinsic) : all;
    judge(intrinsic, without_reflex, others, all, found);
    if (found.explains) add_gains(others, found);
    add_coherence(found);
    return found;
  }

 private:
  [[nodiscard]] Index muscles() const { return s_.muscles.cols(); }
  [[nodiscard]] Matrix fast(const Matrix& columns) const {
    return without_drift(columns, rows_, s_.pieces, kSlowest, s_.sample_time);
  }

  [[nodiscard]] EmgPath named() const {
    EmgPath found;
    found.memory = s_.sample_time * static_cast<double>(memory_);
    for (Index k = 0; k < muscles(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      found.muscles.push_back({s_.muscle_names[at], s_.muscle_units[at], {}});
    }
    return found;
  }

  void decide(const PathColumns& others, EmgPath& found) const {
    const Index base = others.explained.cols();
    const auto wide = std::max<Index>(1, std::llround(kSummedEmg / s_.sample_time));
    found.p_value = chance_of_no_part(beside(others.explained, summed_lags(lags_, memory_ + 1, wide)), base, Y_, rows_);
    const Matrix errors = cross_validated_errors(beside(others.explained, emg_), Y_, base, kEmgFolds);
    Index best = 0;
    errors.colwise().mean().minCoeff(&best);
    found.explains = predicts_better(errors.col(best), errors.col(0)) && found.p_value < kChanceOfEmg;
    if (found.explains && follows(others)) {
      found.explains = false;
      found.why =
          "EMG of the following 0.5 s predicts the force better than that of the 0.5 s before, so it follows the "
          "force and does not cause it, or its clock is wrong";
      return;
    }
    found.why = fmt::format(
        "with EMG the paths predict {:.2f} % of the force, without it {:.2f} % (cross-validated); {} for EMG that adds "
        "nothing",
        100.0 * (1.0 - errors.col(best).mean()), 100.0 * (1.0 - errors.col(0).mean()), chance_text(found.p_value));
  }

  /// Whether the EMG after the force predicts it better than that before, by two standard errors.
  [[nodiscard]] bool follows(const PathColumns& others) const {
    const auto inside = rows_inside(rows_, s_.pieces, memory_, memory_);
    std::vector<Index> kept;  // places of these rows among those that identify
    Index at = 0;
    std::size_t next = 0;
    for (const RowRange& range : rows_) {
      for (Index row = range.begin; row < range.end; ++row, ++at) {
        while (next < inside.size() && row >= inside[next].end) ++next;
        if (next < inside.size() && row >= inside[next].begin) kept.push_back(at);
      }
    }
    if (kept.empty()) return false;
    const Matrix Y = centred(Y_(kept, Eigen::all)), base = centred(others.explained(kept, Eigen::all));
    const auto errors = [&](Index first, Index last) {
      const Matrix lags =
          without_drift(lagged(s_.muscles, first, last, inside), inside, s_.pieces, kSlowest, s_.sample_time);
      const Matrix all =
          cross_validated_errors(beside(base, lags * principal_directions(lags)), Y, base.cols(), kEmgFolds);
      Index best = 0;
      all.colwise().mean().minCoeff(&best);
      return Vector(all.col(best));
    };
    return predicts_better(errors(-memory_, 0), errors(0, memory_));
  }

  /// The other paths and as many directions of the EMG as predict best, at least one.
  [[nodiscard]] WithEmg with_emg(const PathColumns& others) const {
    const Index base = others.explained.cols();
    const Matrix errors = cross_validated_errors(beside(others.explained, emg_), Y_, base + 1, kEmgFolds);
    WithEmg with;
    errors.colwise().mean().minCoeff(&with.kept);
    ++with.kept;
    const Matrix kept = emg_.leftCols(with.kept);
    with.fit = fit_lagged(beside(others.measured, kept), beside(others.explained, kept), Y_, rows_);
    return with;
  }

  void judge(const PathColumns& intrinsic, const WithEmg& without_reflex, const PathColumns& others, const WithEmg& all,
             EmgPath& found) const {
    if (row_count(judged_) < 2) return;
    const Matrix force = rows_of(s_.resistance, judged_), lags = lagged(s_.muscles, 0, memory_, judged_);
    const auto emg_force = [&](const WithEmg& with) {
      return Matrix(lags * (directions_.leftCols(with.kept) * with.fit.coefficients.bottomRows(with.kept)));
    };
    const auto force_of = [&](const PathColumns& paths, const WithEmg& with) {
      return Matrix(paths.judged * with.fit.coefficients.topRows(paths.judged.cols()) + emg_force(with));
    };
    const Matrix third = emg_force(all), two = force_of(intrinsic, without_reflex), three = force_of(others, all);
    for (Index axis = 0; axis < s_.axes; ++axis) {
      const auto judged = [&](const Matrix& predicted) {
        const AccountedFor one =
            accounted_for(force.col(axis), force.col(axis) - predicted.col(axis), judged_, s_.sample_time);
        return ExplainedForce{one.percent, one.half_width, one.rmse};
      };
      found.shares.push_back({judged(two), judged(three), judged(third)});
    }
  }

  /// From a fit with all lags, none of them chosen, as the gain of a reflex; with the sign of F_h.
  void add_gains(const PathColumns& others, EmgPath& found) const {
    const LaggedFit fit = fit_lagged(beside(others.measured, emg_), beside(others.explained, emg_), Y_, rows_);
    const Index r = emg_.cols();
    for (Index k = 0; k < muscles(); ++k) {
      const Vector sum = directions_.middleRows(k * (memory_ + 1), memory_ + 1).colwise().sum().transpose();
      for (Index axis = 0; axis < s_.axes; ++axis) {
        const Matrix C = fit.covariance[static_cast<std::size_t>(axis)].bottomRightCorner(r, r);
        found.muscles[static_cast<std::size_t>(k)].gain.push_back(
            {-sum.dot(fit.coefficients.col(axis).tail(r)),
             numeric::kNormal95 * std::sqrt(std::max(0.0, sum.dot(C * sum)))});
      }
    }
  }

  void add_coherence(EmgPath& found) const {
    const Index n = s_.axes, m = muscles();
    std::vector<Matrix> pieces;
    for (const RowRange& piece : s_.pieces) {
      const auto rows = Eigen::seqN(piece.begin, piece.size());
      const Matrix all =
          beside(beside(s_.position(rows, Eigen::all), s_.muscles(rows, Eigen::all)), s_.resistance(rows, Eigen::all));
      pieces.push_back(without_drift(all, {piece}, {piece}, kSlowestOfBand, s_.sample_time));
    }
    const Index segment = 2 * static_cast<Index>(std::llround(0.5 * kCoherenceSegment / s_.sample_time));
    const auto spectra = dsp::cross_spectra(pieces, Hertz(1.0 / s_.sample_time), segment);
    const auto inputs = static_cast<double>(n + m);
    if (!spectra || spectra->independent_segments < static_cast<double>(kMinSegmentsPerInput) * inputs) return;
    dsp::CrossSpectra of_motion = *spectra;
    std::vector<Index> kept;
    for (Index k = 0; k < n; ++k) kept.push_back(k);
    for (Index k = 0; k < n; ++k) kept.push_back(n + m + k);
    for (Eigen::MatrixXcd& S : of_motion.density) S = Eigen::MatrixXcd(S(kept, kept));
    const Matrix motion = dsp::multiple_coherence(of_motion, n), both = dsp::multiple_coherence(*spectra, n + m);
    const double K = spectra->independent_segments;
    const auto corrected = [K](double coherence, double signals) {  // NaN stays
      return std::fmax(std::isnan(coherence) ? kNaN : 0.0, 1.0 - (1.0 - coherence) * K / (K - signals));
    };
    for (std::size_t b = 0; b + 1 < kBandEdges.size(); ++b) {
      CoherenceBand band{kBandEdges[b], kBandEdges[b + 1], Vector::Zero(n), Vector::Zero(n)};
      Vector power = Vector::Zero(n);
      for (Index line = 0; line < spectra->frequency.size(); ++line) {
        if (spectra->frequency[line] < band.from_hz || spectra->frequency[line] >= band.to_hz) continue;
        for (Index axis = 0; axis < n; ++axis) {
          const double density = spectra->density[static_cast<std::size_t>(line)](n + m + axis, n + m + axis).real();
          power[axis] += density;
          band.motion[axis] += density * corrected(motion(line, axis), static_cast<double>(n));
          band.motion_and_emg[axis] += density * corrected(both(line, axis), inputs);
        }
      }
      if (!(power.minCoeff() > 0.0)) continue;
      band.motion = band.motion.cwiseQuotient(power);
      band.motion_and_emg = band.motion_and_emg.cwiseQuotient(power);
      if (band.motion.allFinite() && band.motion_and_emg.allFinite()) found.coherence.push_back(std::move(band));
    }
  }

  const LimbSignals& s_;
  const std::vector<RowRange>&rows_, &judged_;
  Index memory_;  ///< last lag
  Matrix Y_;
  Matrix lags_, directions_, emg_;  ///< rows×(m·lags), (m·lags)×r, rows×r
};

}  // namespace

EmgPath emg_path(const LimbSignals& signals, const std::vector<RowRange>& rows, const std::vector<RowRange>& judged,
                 const PathColumns& intrinsic, const PathColumns& reflex) {
  return EmgFit(signals, rows, judged).run(intrinsic, reflex);
}

}  // namespace mbk::explore
