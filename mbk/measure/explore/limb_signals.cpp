#include "mbk/measure/explore/limb_signals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/core/units.h"
#include "mbk/base/dsp/decimate.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/explore/lagged_regression.h"

namespace mbk::explore {
namespace {

constexpr double kRowsPerBand = 2.5;          ///< rate over kResponseBand
constexpr double kBack = 1.0, kAhead = 0.05;  ///< what of the reference explains the motion of an instant [s]
constexpr Index kRowsPerLag = 10;
constexpr Index kEnds = 12;         ///< rows at each end of a trial that the low-pass made of what it added there
constexpr double kExplained = 0.5;  ///< share of the motion that the reference must explain to stand for it
constexpr dsp::SavitzkyGolay kStencil{.order = 8, .window = 9};

/// [x ẋ ẍ −F r e] of one trial behind the low-pass.
Result<Matrix> filtered(const ExplorationTrial& trial, Index every) {
  const Hertz rate(1.0 / trial.sample_time);
  const auto velocity = MBK_TRY(dsp::savitzky_golay(kStencil, 1, trial.input, rate));
  const auto acceleration = MBK_TRY(dsp::savitzky_golay(kStencil, 2, trial.input, rate));
  const Index n = trial.axes, lost = kStencil.half_window(), rows = velocity.rows();
  const auto optional = [&](const Matrix& signals) {
    return signals.size() > 0 ? Matrix(signals.middleRows(lost, rows)) : Matrix(rows, 0);
  };
  Matrix all(rows, 4 * n + trial.reference.cols() + trial.muscles.cols());
  all << trial.input.middleRows(lost, rows), velocity, acceleration, trial.output.middleRows(lost, rows),
      optional(trial.reference), optional(trial.muscles);
  return dsp::decimate(all, rate, every);
}

/// What the reference explains of the motion, piece by piece.
void explain(const Matrix& reference, LimbSignals& signals) {
  const Index n = signals.axes;
  const Index ahead = std::llround(kAhead / signals.sample_time), most = row_count(signals.pieces) / (kRowsPerLag * n);
  const Index back = std::min<Index>(std::llround(kBack / signals.sample_time), most);
  const auto usable = rows_inside(signals.pieces, signals.pieces, back, ahead);
  const Index total = row_count(usable), half = total / 2;
  if (total < kRowsPerLag * 2 * n * (back + ahead + 1)) return;
  const Matrix X = centred(lagged(reference, -ahead, back, usable));
  Matrix motion(signals.position.rows(), 3 * n);
  motion << signals.position, signals.velocity, signals.acceleration;
  const Matrix Y = centred(rows_of(motion, usable));
  const auto response = [&](Index from, Index count) {
    const auto part = X.middleRows(from, count);
    Matrix gram = numeric::gram_of({part});
    constexpr double kRidge = 1e-9;
    gram.diagonal().array() += kRidge * gram.trace() / static_cast<double>(gram.rows());
    return Matrix(numeric::PivotedCholesky(gram).solve(numeric::products_of(part, Y.middleRows(from, count))));
  };
  Matrix explained(total, 3 * n);
  explained.topRows(half) = X.topRows(half) * response(half, total - half);
  explained.bottomRows(total - half) = X.bottomRows(total - half) * response(0, half);
  signals.explained_share.resize(n);
  for (Index axis = 0; axis < n; ++axis) {
    signals.explained_share[axis] =
        1.0 - numeric::variance(Y.col(axis) - explained.col(axis)) / numeric::variance(Y.col(axis));
  }
  if (!(signals.explained_share.minCoeff() >= kExplained)) return;
  signals.explained = motion;  // at the ends of a piece, where the reference is not known long enough
  Index at = 0;
  for (const RowRange& range : usable) {
    signals.explained.middleRows(range.begin, range.size()) = explained.middleRows(at, range.size());
    at += range.size();
  }
  signals.identification = rows_inside(signals.identification, signals.pieces, back, ahead);
}

}  // namespace

Result<LimbSignals> limb_signals(std::span<const ExplorationTrial> trials) {
  if (trials.empty()) return bad_usage("no trial was given");
  LimbSignals signals;
  signals.axes = trials.front().axes;
  const double step = trials.front().sample_time;
  signals.every =
      std::max<Index>(1, static_cast<Index>(std::floor(1.0 / (step * kRowsPerBand * kResponseBand) + 1e-9)));
  signals.sample_time = step * static_cast<double>(signals.every);
  const Index n = signals.axes;
  bool referenced = true;
  std::vector<Matrix> parts;
  Index total = 0;
  for (const ExplorationTrial& trial : trials) {
    if (trial.axes != signals.axes) return bad_data("trials of one axis and of two cannot be explored together");
    if (std::abs(trial.sample_time - step) > 1e-9 * step) {
      return bad_data(
          fmt::format("one trial is sampled at {:.6g} Hz, another at {:.6g} Hz", 1.0 / step, 1.0 / trial.sample_time),
          "resample them to one rate with --resample");
    }
    referenced = referenced && trial.reference.size() > 0;
  }
  for (const ExplorationTrial& trial : trials) {
    auto part = MBK_TRY(filtered(trial, signals.every));
    const Index ends = signals.every > 1 ? kEnds : 0;
    if (part.rows() <= 2 * ends) return bad_data("a trial is too short for the low-pass filter", "record longer");
    signals.first_sample = kStencil.half_window() + ends * signals.every;
    part = part.middleRows(ends, part.rows() - 2 * ends).eval();
    const Index rows = part.rows();
    const Index split = std::clamp<Index>(trial.split / signals.every - ends, 0, rows);
    signals.pieces.push_back({total, total + rows});
    if (split > 0) signals.identification.push_back({total, total + split});
    if (split < rows) signals.validation.push_back({total + split, total + rows});
    total += rows;
    parts.push_back(std::move(part));
  }
  signals.position.resize(total, n);
  signals.velocity.resize(total, n);
  signals.acceleration.resize(total, n);
  signals.resistance.resize(total, n);
  Matrix reference(referenced ? total : 0, n);
  const Index muscles = trials.front().muscles.cols();
  signals.muscles.resize(total, muscles);
  signals.muscle_names = trials.front().muscle_names;
  signals.muscle_units = trials.front().muscle_units;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const RowRange& piece = signals.pieces[k];
    const auto rows = Eigen::seqN(piece.begin, piece.size());
    signals.position(rows, Eigen::all) = parts[k].leftCols(n);
    signals.velocity(rows, Eigen::all) = parts[k].middleCols(n, n);
    signals.acceleration(rows, Eigen::all) = parts[k].middleCols(2 * n, n);
    signals.resistance(rows, Eigen::all) = parts[k].middleCols(3 * n, n);
    if (referenced) reference(rows, Eigen::all) = parts[k].middleCols(4 * n, n);
    signals.muscles(rows, Eigen::all) = parts[k].rightCols(muscles);
  }
  signals.position = centred(signals.position);
  if (referenced) explain(reference, signals);
  return signals;
}

}  // namespace mbk::explore
