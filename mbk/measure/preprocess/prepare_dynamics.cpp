#include "mbk/measure/preprocess/prepare_dynamics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/zero_phase.h"
#include "mbk/measure/preprocess/band.h"
#include "mbk/measure/preprocess/filters.h"
#include "mbk/measure/preprocess/joint_signals.h"
#include "mbk/measure/preprocess/joint_smoothing.h"
#include "mbk/measure/preprocess/recording_checks.h"
#include "mbk/measure/preprocess/trial_clock.h"
#include "mbk/measure/preprocess/windows.h"

namespace mbk::preprocess {
namespace {

/// The joints that bring the hand where it should be, from where they are: Newton's method.
robot::JointVector joints_at(const robot::Mechanism& mechanism, const robot::JointVector& near,
                             const robot::HandVector& hand) {
  robot::JointVector q = near;
  for (int pass = 0; pass < 8; ++pass) {
    const auto inverse = robot::hand_from_joints(mechanism, q);
    if (!inverse) return near;
    q += inverse->transpose() * (hand - mechanism.hand_position(q));
  }
  return q;
}

/// One cut after another, filtered and decimated.
class Maker {
 public:
  Maker(const JointSignals& signals, const robot::DynamicModel& model, const DynamicsOptions& options,
        const FilterPlan& filters, Hertz rate)
      : signals_(signals), model_(model), options_(options), filters_(filters), rate_(rate) {}

  Result<void> prepare() {
    if (!filters_.cutoff) return {};
    lowpass_ = MBK_TRY(dsp::butterworth_lowpass(kLowpassOrder, *filters_.cutoff, rate_));
    return {};
  }

  /// [τ τ̇ W₁ … W_n] of a cut, then W₁ … W_n of the instruments and of the smoothed motion where they are wanted.
  Result<Matrix> columns(const Cut& cut, PreparedDynamics& made) const {
    auto joints = MBK_TRY(smooth_joints(signals_, *model_.mechanism, cut, filters_.smoothing, rate_, model_.delay));
    still(joints.motion, made.stands);
    std::vector<Matrix> blocks = model_.regressors(joints.motion);
    if (options_.instruments) {
      auto motion = MBK_TRY(instrument_motion(cut, joints.motion, made));
      still(motion, made.stands);
      for (Matrix& block : model_.regressors(motion)) blocks.push_back(std::move(block));
      auto smooth = MBK_TRY(low_passed(joints.motion, made.smoothed_cutoff));
      for (Matrix& block : model_.regressors(smooth)) blocks.push_back(std::move(block));
    }
    const Index n = model_.mechanism->joints(), p = blocks.front().cols();
    Matrix all(joints.torque.rows(), 2 * n + static_cast<Index>(blocks.size()) * p);
    all.leftCols(n) = joints.torque;
    all.middleCols(n, n) = joints.torque_rate;
    for (std::size_t k = 0; k < blocks.size(); ++k) all.middleCols(2 * n + static_cast<Index>(k) * p, p) = blocks[k];
    return through(lowpass_, all);
  }

 private:
  Result<Matrix> through(const dsp::SectionCascade& filter, const Matrix& all) const {
    if (filter.empty()) return decimated(all);
    auto filtered = MBK_TRY(dsp::filter_zero_phase(filter, all, options_.signals.padding));
    return decimated(filtered);
  }

  [[nodiscard]] Matrix decimated(const Matrix& all) const {
    const Index rows = (all.rows() + filters_.every - 1) / filters_.every;
    return all(Eigen::seqN(0, rows, filters_.every), Eigen::all);
  }

  static void still(robot::JointMotion& motion, const std::vector<bool>& stands) {
    for (std::size_t joint = 0; joint < stands.size(); ++joint) {
      if (!stands[joint]) continue;
      const auto k = static_cast<Index>(joint);
      motion.position.col(k).setConstant(motion.position.col(k).mean());
      motion.velocity.col(k).setZero();
      motion.acceleration.col(k).setZero();
    }
  }

  [[nodiscard]] Result<robot::JointMotion> instrument_motion(const Cut& cut, const robot::JointMotion& measured,
                                                             PreparedDynamics& made) const {
    const Index length = cut.end - cut.begin, n = model_.mechanism->joints();
    if (made.instrument_motion == InstrumentMotion::joint_reference) {
      return smooth_motion(signals_.joint_reference.middleRows(cut.begin, length), filters_.smoothing, rate_);
    }
    if (made.instrument_motion == InstrumentMotion::hand_reference) {
      Matrix joints(length, n);
      robot::JointVector near = signals_.position.row(cut.begin).transpose();
      for (Index i = 0; i < length; ++i) {
        near = joints_at(*model_.mechanism, near, signals_.hand_reference.row(cut.begin + i).transpose());
        joints.row(i) = near.transpose();
      }
      return smooth_motion(joints, filters_.smoothing, rate_);
    }
    return low_passed(measured, made.motion_cutoff);
  }

  [[nodiscard]] Result<robot::JointMotion> low_passed(robot::JointMotion motion, double cutoff) const {
    const auto lowpass = MBK_TRY(dsp::butterworth_lowpass(kLowpassOrder, Hertz(cutoff), rate_));
    for (Matrix* part : {&motion.position, &motion.velocity, &motion.acceleration}) {
      *part = MBK_TRY(dsp::filter_zero_phase(lowpass, *part, options_.signals.padding));
    }
    return motion;
  }

  const JointSignals& signals_;
  const robot::DynamicModel& model_;
  const DynamicsOptions& options_;
  const FilterPlan& filters_;
  Hertz rate_;
  dsp::SectionCascade lowpass_;
};

/// Dry friction that holds a joint takes any value: what its motor does says nothing.
void leave_out_held_joints(PreparedDynamics& made) {
  for (std::size_t joint = 0; joint < made.stands.size(); ++joint) {
    if (!made.stands[joint]) continue;
    made.torque.col(static_cast<Index>(joint)).setZero();
    made.torque_rate.col(static_cast<Index>(joint)).setZero();
    for (auto* const part : {&made.regressors, &made.instruments, &made.smoothed}) {
      if (!part->empty()) (*part)[joint].setZero();
    }
    made.notes.push_back(fmt::format("joint {} stands still, held by friction: its torque is ignored", joint + 1));
  }
}

}  // namespace

Result<PreparedDynamics> prepare_dynamics(const Recording& recording, const Inspection& inspection,
                                          const robot::DynamicModel& model, const DynamicsOptions& options) {
  MBK_TRY(check_choices(options.signals));
  if (!(std::abs(model.delay) < 1.0)) {
    return bad_usage(fmt::format("a motor delay of {:g} s is not below 1 s", model.delay));
  }
  constexpr Index kMin = 100;
  if (recording.samples() < kMin || !(inspection.rate_hz > 0.0)) {
    return bad_data(fmt::format("{} samples cannot show a robot's dynamics", recording.samples()), "record longer");
  }
  const Hertz rate(inspection.rate_hz);
  const Clock clock(recording.time, rate);
  MBK_TRY(check_missing(clock, inspection.missing, options.signals.window));
  const auto signals = MBK_TRY(select_joint_signals(recording, *model.mechanism, false));

  PreparedDynamics made;
  made.sources = recording.sources;
  made.notes = recording.notes;
  made.warnings = recording.warnings;
  made.recording_rate = rate.value;
  made.recording_duration = inspection.duration + inspection.interval_median;
  const auto plan = MBK_TRY(default_windows(Protocol::free, {}, clock, options.signals.window));
  MBK_TRY(check_clock(clock, inspection, plan, made.warnings));
  MBK_TRY(check_joint_signals(signals, *model.mechanism, clock, plan, made.notes));
  made.stands = standing_joints(signals, plan);
  const auto band = MBK_TRY(excited_band(signals.position, plan.cuts, rate));
  Index shortest = recording.samples();
  for (const Cut& cut : plan.cuts) shortest = std::min(shortest, cut.end - cut.begin);
  FilterPlan filters = improved_filters(options.signals, band, rate, shortest);
  if (filters.cutoff && !options.signals.smoothing_window) {
    const auto smoothing =
        MBK_TRY(smoothing_of_joints(filters.smoothing, signals.position, plan.cuts, model.drive, rate));
    filters.smoothing = smoothing;
  }

  if (options.instruments) {
    made.instrument_motion = signals.joint_reference.size() > 0  ? InstrumentMotion::joint_reference
                             : signals.hand_reference.size() > 0 ? InstrumentMotion::hand_reference
                                                                 : InstrumentMotion::smoothed;
    if (options.motion_cutoff) made.instrument_motion = InstrumentMotion::smoothed;
    if (made.instrument_motion == InstrumentMotion::smoothed) {
      const auto top = MBK_TRY(band_top(signals.torque, plan.cuts, rate));
      made.motion_cutoff = options.motion_cutoff.value_or(Hertz(top.value / kPassed)).value;
    }
    const Hertz limit = filters.cutoff.value_or(Hertz(0.1 * rate.value));
    for (Index joint = 0; joint < signals.position.cols(); ++joint) {
      const auto top = MBK_TRY(motion_top(signals.position.col(joint), plan.cuts, rate, limit));
      // One for all joints: what shakes the links moves them against each other, and must not be let through by one
      // alone.
      made.smoothed_cutoff = joint == 0 ? top.value : std::min(made.smoothed_cutoff, top.value);
    }
  }
  Maker maker(signals, model, options, filters, rate);
  MBK_TRY(maker.prepare());
  std::vector<Matrix> pieces;
  Index total = 0;
  for (const Cut& cut : plan.cuts) {
    auto piece = MBK_TRY(maker.columns(cut, made));
    total += piece.rows();
    pieces.push_back(std::move(piece));
  }

  const Index n = model.mechanism->joints(), every = filters.every, lost = filters.smoothing.half_window();
  const auto p = static_cast<Index>(model.coefficients().size());
  Matrix all(total, pieces.front().cols());
  made.time.resize(total);
  Index row = 0;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Cut& cut = plan.cuts[k];
    const Index rows = pieces[k].rows(), first = cut.begin + lost;
    all.middleRows(row, rows) = pieces[k];
    made.time.segment(row, rows) = recording.time(Eigen::seqN(first, rows, every)).array() - recording.time[0];
    append_segments(cut, first, every, row, rows, made.segments);
    row += rows;
  }
  if (made.segments.empty()) return bad_data("no sample is left after filtering", "record longer");
  made.sample_time = static_cast<double>(every) / rate.value;
  made.torque = all.leftCols(n);
  made.torque_rate = all.middleCols(n, n);
  for (Index joint = 0; joint < n; ++joint) {
    made.regressors.emplace_back(all.middleCols(2 * n + joint * p, p));
    if (!options.instruments) continue;
    made.instruments.emplace_back(all.middleCols(2 * n + (n + joint) * p, p));
    made.smoothed.emplace_back(all.middleCols(2 * n + (2 * n + joint) * p, p));
  }
  if (model.drive.coulomb || model.drive.stribeck) leave_out_held_joints(made);

  Preparation& how = made.preparation;
  how.protocol_rule = "a robot without a limb";
  how.window_rule = plan.rule;
  how.from_s = made.time[made.segments.front().begin];
  how.to_s = made.time[made.segments.back().end - 1];
  how.split_s = plan.split_s;
  how.smoothing_order = filters.smoothing.order;
  how.smoothing_window = filters.smoothing.window;
  how.cutoff = filters.cutoff;
  how.cutoff_rule = filters.rule;
  how.band_low = band.low;
  how.band_high = band.high;
  how.every = every;
  return made;
}

}  // namespace mbk::preprocess
