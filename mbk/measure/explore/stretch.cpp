#include "mbk/measure/explore/stretch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/units.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::explore {
namespace stretches {

constexpr double kSmoothing = 0.05;    ///< of velocity and acceleration [s]
constexpr double kConstant = 0.1;      ///< deviation of the speed on a plateau, relative
constexpr double kPlateauShare = 0.4;  ///< of the travel of a movement, at least
constexpr double kMinTravel = 0.15;    ///< of the range of the recording, at least
constexpr double kMinPlateau = 0.05;   ///< [s]
constexpr double kGap = 0.03;          ///< longest time off the plateau that does not end it [s]
constexpr double kSameSpeed = 1.1;     ///< ratio within which speeds are repetitions
constexpr double kMinRatio = 2.0;      ///< of the largest to the smallest speed, for a verdict
constexpr double kMinRange = 0.1;      ///< of the smallest travel, that all stretches have in common
constexpr Index kSamplesPerBin = 3, kMaxBins = 45;
constexpr double kOneSided = 0.975, kFamily = 0.05;
constexpr double kAtRest = 0.05;    ///< speed at rest relative to that of the movement
constexpr double kOtherAxis = 0.1;  ///< motion of another axis relative to that of the stretched one

struct Signal {
  Vector position, velocity, acceleration, torque;  ///< of one trial, with inertia subtracted from the torque
  double first_s = 0, sample_time = 0;
};

struct Move {
  int recording = 0, direction = 1;
  Index begin = 0, end = 0;  ///< the movement
  Index from = 0, to = 0;    ///< its plateau
  double speed = 0;
};

/// One stretch on the bins of the common range.
struct Course {
  Move move;
  Index group = 0;
  Vector torque;               ///< resisting, by bin
  double mean = 0;             ///< resisting, over the samples in the range
  double early = 0, late = 0;  ///< first and last third of the stretch
};

Index samples_of(double seconds, double sample_time) {
  return std::max<Index>(static_cast<Index>(std::lround(seconds / sample_time)), 1);
}

Result<Signal> signal_of(const ExplorationTrial& trial, Index axis, double inertia) {
  const Index half = std::max<Index>(samples_of(0.5 * kSmoothing, trial.sample_time), 2);
  const dsp::SavitzkyGolay filter{2, static_cast<int>(2 * half + 1)};
  const Hertz rate(1.0 / trial.sample_time);
  const Matrix position = trial.input.col(axis);
  const auto velocity = MBK_TRY(dsp::savitzky_golay(filter, 1, position, rate));
  const auto acceleration = MBK_TRY(dsp::savitzky_golay(filter, 2, position, rate));
  Signal signal;
  const Index n = velocity.rows();
  signal.position = position.col(0).segment(half, n);
  signal.velocity = velocity.col(0);
  signal.acceleration = acceleration.col(0);
  signal.torque = trial.output.col(axis).segment(half, n) - inertia * signal.acceleration;
  signal.sample_time = trial.sample_time;
  signal.first_s = trial.from_s + static_cast<double>(half) * trial.sample_time;
  return signal;
}

/// The speed that the movement has most of the time: the median of those above half of the highest.
double usual_speed(const Vector& speed) {
  const double half = 0.5 * speed.maxCoeff();
  std::vector<double> fast;
  for (const double one : speed) {
    if (one >= half) fast.push_back(one);
  }
  return numeric::median(std::move(fast));
}

/// Longest part of a movement with constant velocity, if it is long enough.
bool find_plateau(const Signal& signal, Move& move) {
  const Vector speed = signal.velocity.segment(move.begin, move.end - move.begin).cwiseAbs();
  const double usual = usual_speed(speed);
  const Index gap = samples_of(kGap, signal.sample_time);
  Index first = -1, last = -1;
  const auto keep = [&] {
    if (first >= 0 && last - first > move.to - move.from) {
      move.from = move.begin + first;
      move.to = move.begin + last + 1;
    }
  };
  move.from = move.to = move.begin;
  for (Index i = 0; i < speed.size(); ++i) {
    if (std::abs(speed[i] - usual) > kConstant * usual) continue;
    if (first >= 0 && i - last > gap) {
      keep();
      first = -1;
    }
    if (first < 0) first = i;
    last = i;
  }
  keep();
  const Index samples = move.to - move.from;
  if (samples < std::max<Index>(samples_of(kMinPlateau, signal.sample_time), 2 * kSamplesPerBin)) return false;
  const double travel = std::abs(signal.position[move.end - 1] - signal.position[move.begin]);
  const double held = std::abs(signal.position[move.to - 1] - signal.position[move.from]);
  move.speed = held / (static_cast<double>(samples - 1) * signal.sample_time);
  return held >= kPlateauShare * travel;
}

std::vector<Move> moves_of(const Signal& signal, int recording) {
  std::vector<Move> moves;
  const double range = signal.position.maxCoeff() - signal.position.minCoeff();
  const Index n = signal.velocity.size();
  for (Index begin = 0; begin < n;) {
    const bool up = signal.velocity[begin] > 0.0;
    Index end = begin + 1;
    while (end < n && (signal.velocity[end] > 0.0) == up) ++end;
    if (std::abs(signal.position[end - 1] - signal.position[begin]) >= kMinTravel * range && range > 0.0) {
      Move move{.recording = recording, .direction = up ? 1 : -1, .begin = begin, .end = end};
      if (find_plateau(signal, move)) moves.push_back(move);
    }
    begin = end;
  }
  return moves;
}

/// An estimate with its standard error and degrees of freedom; 0 of them: no error is known.
struct Estimated {
  double value = 0, error = 0, freedom = 0;
  [[nodiscard]] double reach(double quantile) const {
    return freedom > 0.0 ? numeric::student_quantile(quantile, freedom) * error : kInfinity;
  }
  [[nodiscard]] bool positive(double quantile) const { return freedom > 0.0 && value - reach(quantile) > 0.0; }
  [[nodiscard]] StretchValue shown() const {
    StretchValue shown{value, std::nullopt};
    if (freedom > 0.0) shown.interval95 = Interval(value - reach(kOneSided), value + reach(kOneSided));
    return shown;
  }
};

/// Of independent estimates: a + sign b, with Welch and Satterthwaite's degrees of freedom.
Estimated combined(const Estimated& a, const Estimated& b, double sign) {
  Estimated sum{a.value + sign * b.value, std::hypot(a.error, b.error), 0.0};
  if (a.freedom > 0.0 && b.freedom > 0.0 && sum.error > 0.0) {
    sum.freedom = std::pow(sum.error, 4) / (std::pow(a.error, 4) / a.freedom + std::pow(b.error, 4) / b.freedom);
  } else if (a.freedom > 0.0 && b.freedom > 0.0) {
    sum.freedom = std::min(a.freedom, b.freedom);
  }
  return sum;
}

Estimated mean_of(const std::vector<double>& values) {
  const Vector all = Vector::Map(values.data(), static_cast<Index>(values.size()));
  const auto n = static_cast<double>(all.size());
  return {all.mean(), std::sqrt(numeric::variance(all) / n), n - 1.0};
}

/// Values that vary with speed: repetitions, or the means of recordings.
struct Units {
  Vector speed;
  std::vector<Index> group;
  bool by_recording = false;
  [[nodiscard]] std::string basis() const;
  [[nodiscard]] bool repeated() const;
};

bool Units::repeated() const {
  std::vector<int> count;
  for (const Index g : group) {
    count.resize(std::max(count.size(), static_cast<std::size_t>(g) + 1));
    ++count[static_cast<std::size_t>(g)];
  }
  return std::ranges::all_of(count, [](int one) { return one >= 2; });
}

std::string Units::basis() const {
  if (repeated()) {
    return by_recording ? "the scatter between recordings of the same speed"
                        : "the scatter between repetitions of the same speed";
  }
  if (group.size() < 3) return "nothing: three speeds or repetitions of each are needed";
  return fmt::format("the scatter of {} about a straight line over speed, as no speed was repeated{}",
                     by_recording ? "the recordings" : "the stretches",
                     by_recording ? " in another recording: what makes torque nonlinear in speed widens it, and so do "
                                    "offsets between recordings"
                                  : ": what makes torque nonlinear in speed widens it");
}

/// Slope of values over speed by least squares.
Estimated slope_over(const Units& units, const Vector& values) {
  const Vector centred = units.speed.array() - units.speed.mean();
  const Vector weight = centred / centred.squaredNorm();
  Estimated slope{weight.dot(values), 0.0, 0.0};
  const Index n = values.size();
  if (!units.repeated()) {
    if (n < 3) return slope;
    const Vector residual = (values.array() - values.mean()).matrix() - slope.value * centred;
    slope.freedom = static_cast<double>(n - 2);
    slope.error = std::sqrt(residual.squaredNorm() / slope.freedom) * weight.norm();
    return slope;
  }
  double variance = 0.0, fourth = 0.0;
  const Index groups = *std::ranges::max_element(units.group) + 1;
  for (Index g = 0; g < groups; ++g) {
    std::vector<double> here;
    double squared = 0.0;
    for (Index i = 0; i < n; ++i) {
      if (units.group[static_cast<std::size_t>(i)] != g) continue;
      here.push_back(values[i]);
      squared += weight[i] * weight[i];
    }
    const double share = squared * numeric::variance(Vector::Map(here.data(), static_cast<Index>(here.size())));
    variance += share;
    fourth += share * share / (static_cast<double>(here.size()) - 1.0);
  }
  slope.error = std::sqrt(variance);
  slope.freedom = fourth > 0.0 ? variance * variance / fourth : static_cast<double>(n - groups);
  return slope;
}

/// Curves that are flat, rise along a line and are flat again: normalised, by bin, with where they start.
struct RiseShapes {
  Matrix shapes;  ///< candidates × bins
  Vector start;
};

/// @param along  centres of the bins in the direction of the stretch, increasing
RiseShapes rise_shapes(const Vector& along) {
  const Index bins = along.size(), places = 2 * bins;
  const double bin = along[1] - along[0], begin = along[0] - 0.5 * bin, step = 0.5 * bin;
  std::vector<std::pair<double, double>> candidates;
  for (Index i = 2; i < places - 4; ++i) {
    for (Index j = i + 4; j <= places; ++j) {
      candidates.emplace_back(begin + step * static_cast<double>(i), begin + step * static_cast<double>(j));
    }
  }
  RiseShapes made{Matrix(static_cast<Index>(candidates.size()), bins), Vector(static_cast<Index>(candidates.size()))};
  for (Index k = 0; k < made.start.size(); ++k) {
    const auto [from, to] = candidates[static_cast<std::size_t>(k)];
    Vector shape = along.cwiseMax(from).cwiseMin(to);
    shape.array() -= shape.mean();
    made.shapes.row(k) = shape.transpose() / shape.norm();
    made.start[k] = from;
  }
  return made;
}

double rise_start(const RiseShapes& shapes, const Vector& excess) {
  Index best = 0;
  (shapes.shapes * excess).maxCoeff(&best);
  return shapes.start[best];
}

/// All that one direction is estimated from.
struct Side {
  int direction = 1;
  std::vector<Course> courses;
  std::vector<double> speed;  ///< of the groups, increasing
  Interval range;
  bool accelerates = false;  ///< the range reaches beyond the plateaus of velocity
  Index bins = 0;
  [[nodiscard]] Vector centres() const {
    Vector at(bins);
    for (Index i = 0; i < bins; ++i) {
      at[i] = range.first + (range.second - range.first) * (static_cast<double>(i) + 0.5) / static_cast<double>(bins);
    }
    return at;
  }
  [[nodiscard]] std::vector<const Course*> of_group(Index group) const {
    std::vector<const Course*> found;
    for (const Course& one : courses) {
      if (one.group == group) found.push_back(&one);
    }
    return found;
  }
  [[nodiscard]] Vector passive_without(Index left_out) const {
    Vector sum = Vector::Zero(bins);
    Index count = 0, k = 0;
    for (const Course* one : of_group(0)) {
      if (k++ == left_out) continue;
      sum += one->torque;
      ++count;
    }
    return sum / static_cast<double>(count);
  }
};

/// Resisting torque of a movement by bin of position; false if a bin is empty.
bool fill_bins(const Signal& signal, const Move& move, bool whole, const Side& side, int direction, Course& course) {
  const Index from = whole ? move.begin : move.from, to = whole ? move.end : move.to;
  Vector sum = Vector::Zero(side.bins), count = Vector::Zero(side.bins);
  const double per_bin = static_cast<double>(side.bins) / (side.range.second - side.range.first);
  for (Index i = from; i < to; ++i) {
    if (signal.position[i] < side.range.first || signal.position[i] > side.range.second) continue;
    const auto place = static_cast<Index>((signal.position[i] - side.range.first) * per_bin);
    const Index bin = std::min(place, side.bins - 1);
    sum[bin] += direction * signal.torque[i];
    count[bin] += 1.0;
  }
  if (count.minCoeff() < 1.0) return false;
  course.torque = sum.cwiseQuotient(count);
  course.mean = sum.sum() / count.sum();
  const Index third = side.bins / 3;
  course.early = direction > 0 ? course.torque.head(third).mean() : course.torque.tail(third).mean();
  course.late = direction > 0 ? course.torque.tail(third).mean() : course.torque.head(third).mean();
  return true;
}

/// Common range, bins and courses of the movements in one direction; no courses where there is nothing in common.
Side side_of(int direction, const std::vector<Move>& moves, const std::vector<Signal>& signals,
             const StretchOptions& options) {
  Side side;
  side.direction = direction;
  const bool whole = options.from.has_value() || options.to.has_value();
  double low = -kInfinity, high = kInfinity, travel = kInfinity, constant_low = -kInfinity, constant_high = kInfinity;
  std::vector<Move> here;
  for (const Move& move : moves) {
    if (move.direction != direction) continue;
    here.push_back(move);
    const Vector& position = signals[static_cast<std::size_t>(move.recording)].position;
    const double a = position[whole ? move.begin : move.from], b = position[(whole ? move.end : move.to) - 1];
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
    constant_low = std::max(constant_low, std::min(position[move.from], position[move.to - 1]));
    constant_high = std::min(constant_high, std::max(position[move.from], position[move.to - 1]));
    travel = std::min(travel, std::abs(position[move.end - 1] - position[move.begin]));
  }
  if (options.from) low = std::max(low, *options.from);
  if (options.to) high = std::min(high, *options.to);
  if (here.empty() || !(high - low > kMinRange * travel)) return side;
  side.range = {low, high};
  constexpr double kBeyond = 0.02;  // of the range
  side.accelerates = std::max(constant_low - low, high - constant_high) > kBeyond * (high - low);
  double fastest = 0.0;
  for (const Move& move : here) {
    fastest = std::max(fastest, move.speed * signals[static_cast<std::size_t>(move.recording)].sample_time);
  }
  const auto bins = static_cast<Index>((high - low) / (static_cast<double>(kSamplesPerBin) * fastest));
  side.bins = 3 * (std::min(bins, kMaxBins) / 3);
  if (side.bins < 9) return side;
  std::ranges::sort(here, {}, &Move::speed);
  double first = 0.0;
  for (const Move& move : here) {
    Course course;
    course.move = move;
    if (!fill_bins(signals[static_cast<std::size_t>(move.recording)], move, whole, side, direction, course)) continue;
    if (side.speed.empty() || move.speed > kSameSpeed * first) {
      first = move.speed;
      side.speed.push_back(0.0);
    }
    course.group = static_cast<Index>(side.speed.size()) - 1;
    side.courses.push_back(std::move(course));
  }
  for (Index g = 0; g < static_cast<Index>(side.speed.size()); ++g) {
    double sum = 0.0;
    const auto all = side.of_group(g);
    for (const Course* one : all) sum += one->move.speed;
    side.speed[static_cast<std::size_t>(g)] = sum / static_cast<double>(all.size());
  }
  return side;
}

/// Repetitions, or recordings where each of several holds one speed: then its offset is part of every repetition.
Units units_of(const Side& side, std::vector<std::vector<const Course*>>& members) {
  std::map<int, std::vector<const Course*>> recordings;
  for (const Course& one : side.courses) recordings[one.move.recording].push_back(&one);
  Units units;
  units.by_recording = recordings.size() > 1 && std::ranges::all_of(recordings, [](const auto& entry) {
                         return std::ranges::all_of(entry.second, [&](const Course* one) {
                           return one->group == entry.second.front()->group;
                         });
                       });
  if (units.by_recording) {
    for (auto& entry : recordings) members.push_back(entry.second);
  } else {
    for (const Course& one : side.courses) members.push_back({&one});
  }
  units.speed.resize(static_cast<Index>(members.size()));
  for (std::size_t k = 0; k < members.size(); ++k) {
    double sum = 0.0;
    for (const Course* one : members[k]) sum += one->move.speed;
    units.speed[static_cast<Index>(k)] = sum / static_cast<double>(members[k].size());
    units.group.push_back(members[k].front()->group);
  }
  return units;
}

template <class Value>
Vector unit_values(const std::vector<std::vector<const Course*>>& members, const Value& value) {
  Vector values(static_cast<Index>(members.size()));
  for (std::size_t k = 0; k < members.size(); ++k) {
    double sum = 0.0;
    for (const Course* one : members[k]) sum += value(*one);
    values[static_cast<Index>(k)] = sum / static_cast<double>(members[k].size());
  }
  return values;
}

double contrast(const Course& one) {
  return one.late - one.early;
}
double strict_contrast(const Course& one) {
  return one.late - 2.0 * one.early;
}

template <class Value>
Estimated group_mean(const std::vector<const Course*>& courses, const Value& value) {
  std::vector<double> values;
  for (const Course* one : courses) values.push_back(value(*one));
  return mean_of(values);
}

/// The slopes of both contrasts over speed, and the verdict.
void judge(const Side& side, const StretchOptions& options, bool sign_reversed, StretchDirection& found) {
  std::vector<std::vector<const Course*>> members;
  const Units units = units_of(side, members);
  if (side.speed.size() < 2) {
    found.slope.value = found.rise.value = kNaN;
    found.interval_basis = "nothing: there is one speed only";
    found.verdict_reason = "two speeds are needed, three without repetitions";
    return;
  }
  const Estimated slope = slope_over(units, unit_values(members, [](const Course& one) { return one.mean; }));
  const Estimated rise = slope_over(units, unit_values(members, contrast));
  const Estimated strict = slope_over(units, unit_values(members, strict_contrast));
  found.slope = slope.shown();
  found.rise = rise.shown();
  found.interval_basis = units.basis();
  if (sign_reversed) {
    found.verdict_reason = "the torque has the sign of the machine on the limb";
  } else if (side.speed.back() < kMinRatio * side.speed.front()) {
    found.verdict_reason = "the fastest speed is less than twice the slowest";
  } else if (!(slope.freedom > 0.0)) {
    found.verdict_reason = "there are too few stretches for an interval";
  } else if (Estimated{-slope.value, slope.error, slope.freedom}.positive(kOneSided)) {
    found.verdict_reason =
        "the torque falls with speed, which no passive limb does: its sign may be reversed, its offset may drift, or "
        "the person helps";
  } else if (side.accelerates) {
    found.verdict_reason = "the analysed angles contain acceleration, whose torque looks like an effect of speed";
  } else if (rise.positive(kOneSided) && strict.positive(kOneSided)) {
    found.verdict = VelocityDependence::velocity_dependent;
    found.verdict_reason =
        "torque rises within the stretch, more so at higher speed, and more than a passive "
        "viscosity that doubles over the stretch would make it";
  } else if (options.viscosity && slope.value - slope.reach(kOneSided) > *options.viscosity) {
    found.verdict = VelocityDependence::velocity_dependent;
    found.verdict_reason = "the slope over speed is above the given passive viscosity";
  } else {
    found.verdict = VelocityDependence::not_shown;
    found.verdict_reason = slope.positive(kOneSided)
                               ? "torque rises with speed, but not later in the stretch more than earlier, as passive "
                                 "viscosity or a reflex over the whole range would make it"
                               : "no rise of the torque with speed is shown beyond passive viscosity";
  }
}

/// Catch of one speed against the slowest, and the angle of each repetition.
std::vector<double> find_catch(const Side& side, Index group, bool judged, const RiseShapes& shapes,
                               StretchSpeed& speed) {
  const auto fast = side.of_group(group), slow = side.of_group(0);
  if (!judged || fast.size() < 2 || slow.size() < 2) return {};
  const double quantile = 1.0 - kFamily / static_cast<double>(side.speed.size() - 1);
  const bool rises =
      combined(group_mean(fast, contrast), group_mean(slow, contrast), -1.0).positive(quantile) &&
      combined(group_mean(fast, strict_contrast), group_mean(slow, strict_contrast), -1.0).positive(quantile);
  speed.catch_finding = rises ? CatchFinding::found : CatchFinding::none;
  if (!rises) return {};
  const auto along = [&](const Vector& excess) -> Vector {
    return side.direction > 0 ? excess : Vector(excess.reverse());
  };
  const auto starts = [&](const Vector& passive) {
    std::vector<double> angles;
    for (const Course* one : fast) angles.push_back(side.direction * rise_start(shapes, along(one->torque - passive)));
    return angles;
  };
  const std::vector<double> angles = starts(side.passive_without(-1));
  const Estimated repetitions = mean_of(angles);
  std::vector<double> without;
  for (Index k = 0; k < static_cast<Index>(slow.size()); ++k) {
    without.push_back(mean_of(starts(side.passive_without(k))).value);
  }
  const auto n = static_cast<double>(slow.size());
  const Estimated curve{0.0, (n - 1.0) * mean_of(without).error, n - 1.0};
  speed.catch_angle = combined(repetitions, curve, 1.0).shown();
  return angles;
}

/// The catch angles over speed, extrapolated to rest.
void extrapolate_threshold(const std::vector<double>& speeds, const std::vector<double>& angles, int found_at,
                           StretchDirection& found) {
  if (found_at < 3) {
    found.threshold_note = fmt::format("a catch at {} speeds; the threshold needs three or more", found_at);
    return;
  }
  const Vector v = Vector::Map(speeds.data(), static_cast<Index>(speeds.size()));
  const Vector y = Vector::Map(angles.data(), static_cast<Index>(angles.size()));
  const Vector centred = v.array() - v.mean();
  const double slope = centred.dot(y) / centred.squaredNorm();
  const double at_rest = y.mean() - slope * v.mean();
  found.reflex_threshold = StretchValue{at_rest, std::nullopt};  // errors of the model exceed the scatter
  found.threshold_shift = slope;
  const bool outside = at_rest < found.range.first || at_rest > found.range.second;
  found.threshold_note = fmt::format(
      "extrapolated from the torque at {} speeds, without an interval: a reflex in the slowest stretches and the "
      "rounded rise of torque move it, in simulation by 4.5° towards the start; use the onset of EMG{}",
      found_at, outside ? "; it is outside the analysed angles" : "");
}

/// What the limb absorbs in each stretch that is followed by a return at the same speed, by group.
std::map<Index, std::vector<double>> loops(const Side& side, const std::vector<Move>& moves,
                                           const std::vector<Signal>& signals, bool whole) {
  std::map<Index, std::vector<double>> work;
  for (const Course& one : side.courses) {
    const Move* back = nullptr;
    for (const Move& move : moves) {
      if (move.recording == one.move.recording && move.begin >= one.move.end && (!back || move.begin < back->begin)) {
        back = &move;
      }
    }
    if (!back || back->direction == side.direction) continue;
    if (std::max(back->speed, one.move.speed) > kSameSpeed * std::min(back->speed, one.move.speed)) continue;
    Course returned;
    const Signal& signal = signals[static_cast<std::size_t>(one.move.recording)];
    if (!fill_bins(signal, *back, whole, side, side.direction, returned)) continue;
    work[one.group].push_back((one.torque - returned.torque).mean() * (side.range.second - side.range.first));
  }
  return work;
}

/// First sample of a movement, up to its plateau, from which on it is never slower than a share of its speed.
Index left_rest(const Signal& signal, const Move& move) {
  Index i = move.from;
  while (i > move.begin && move.direction * signal.velocity[i - 1] > kAtRest * move.speed) --i;
  return i;
}

/// Likewise the last one.
Index came_to_rest(const Signal& signal, const Move& move) {
  Index i = move.to - 1;
  while (i + 1 < move.end && move.direction * signal.velocity[i + 1] > kAtRest * move.speed) ++i;
  return i;
}

StretchDirection described(const Side& side, const std::vector<Move>& moves, const std::vector<Signal>& signals,
                           const StretchOptions& options, bool sign_reversed) {
  StretchDirection found;
  found.direction = side.direction;
  found.range = side.range;
  found.angle = side.centres();
  found.passive = side.passive_without(-1);
  judge(side, options, sign_reversed, found);
  const Vector along = side.direction > 0 ? found.angle : Vector(-found.angle.reverse());
  const RiseShapes shapes = rise_shapes(along);
  auto work = loops(side, moves, signals, options.from || options.to);
  std::vector<double> speeds, angles;
  int found_at = 0;
  for (Index g = 0; g < static_cast<Index>(side.speed.size()); ++g) {
    const auto here = side.of_group(g);
    StretchSpeed speed;
    speed.speed = side.speed[static_cast<std::size_t>(g)];
    speed.repetitions = static_cast<int>(here.size());
    speed.mean_torque = group_mean(here, [](const Course& one) { return one.mean; }).shown();
    if (g > 0) {
      speed.excess = Vector::Zero(side.bins);
      for (const Course* one : here) speed.excess += (one->torque - found.passive) / static_cast<double>(here.size());
      const bool judged = found.verdict != VelocityDependence::cannot_be_judged;
      for (const double angle : find_catch(side, g, judged, shapes, speed)) {
        angles.push_back(angle);
        speeds.push_back(speed.speed);
      }
      if (speed.catch_angle) ++found_at;
    }
    if (const auto all = work.find(g); all != work.end()) speed.work = mean_of(all->second).shown();
    found.speeds.push_back(std::move(speed));
  }
  extrapolate_threshold(speeds, angles, found_at, found);
  for (const Course& one : side.courses) {
    const Signal& signal = signals[static_cast<std::size_t>(one.move.recording)];
    const auto time = [&](Index sample) { return signal.first_s + static_cast<double>(sample) * signal.sample_time; };
    found.stretches.push_back({one.move.recording, time(one.move.from), time(one.move.to),
                               signal.position[one.move.from], signal.position[one.move.to - 1], one.move.speed,
                               one.mean, time(left_rest(signal, one.move)), time(came_to_rest(signal, one.move))});
  }
  std::ranges::sort(found.stretches, {},
                    [](const StretchMovement& one) { return std::pair(one.recording, one.from_s); });
  return found;
}

/// Inertia of the faster movements: torque on 1, θ, θ², velocity and acceleration of each, mean over movements.
std::optional<StretchValue> found_inertia(const std::vector<Move>& moves, const std::vector<Signal>& signals,
                                          double subtracted) {
  double fastest = 0.0;
  for (const Move& move : moves) fastest = std::max(fastest, move.speed);
  std::vector<double> values;
  for (const Move& move : moves) {
    const Index n = move.end - move.begin;
    if (move.speed < 0.5 * fastest || n < 30) continue;
    const Signal& signal = signals[static_cast<std::size_t>(move.recording)];
    const auto part = Eigen::seqN(move.begin, n);
    Matrix Z(n, 5);
    const Vector position = signal.position(part);
    Z << Vector::Ones(n), position, position.cwiseAbs2(), signal.velocity(part), signal.acceleration(part);
    const auto fit = numeric::fit_least_squares(Z, Matrix(signal.torque(part)));
    if (fit && fit->rank == 5) values.push_back(fit->coefficients(4, 0) + subtracted);
  }
  if (values.size() < 2) return std::nullopt;
  return mean_of(values).shown();
}

Index stretched_axis(std::span<const ExplorationTrial> trials, std::vector<std::string>& limits) {
  const Index axes = trials.front().axes;
  Vector range = Vector::Zero(axes);
  for (const ExplorationTrial& trial : trials) {
    const Vector here = (trial.input.colwise().maxCoeff() - trial.input.colwise().minCoeff()).transpose();
    range = range.cwiseMax(here);
  }
  Index axis = 0;
  range.maxCoeff(&axis);
  for (Index k = 0; k < axes; ++k) {
    if (k != axis && range[k] > kOtherAxis * range[axis]) {
      limits.push_back(fmt::format("axis {} moved too, by up to {:.0f} % of the stretch; its effect is not separated",
                                   k + 1, 100.0 * range[k] / range[axis]));
    }
  }
  return axis;
}

/// Whether each recording holds its speeds in rising or in falling order, several times each.
bool in_order(const StretchDirection& found) {
  bool rises = true, falls = true, repeats = false;
  for (std::size_t k = 1; k < found.stretches.size(); ++k) {
    const StretchMovement &before = found.stretches[k - 1], &now = found.stretches[k];
    if (before.recording != now.recording) continue;
    rises = rises && now.speed > before.speed / kSameSpeed;
    falls = falls && now.speed < before.speed * kSameSpeed;
    repeats = repeats || std::abs(now.speed - before.speed) < (kSameSpeed - 1.0) * before.speed;
  }
  return repeats && rises != falls;
}

void add_limits(const StretchEstimate& found, std::size_t recordings, const StretchOptions& options,
                std::vector<std::string>& limits) {
  limits.push_back(
      "the offset of the torque, gravity and elasticity are part of the passive curve and are not separated: the level "
      "of the passive torque is not a measure of tone");
  if (recordings > 1) {
    limits.push_back(
        "an offset of the torque that differs between recordings cannot be distinguished from an effect of "
        "speed where each recording holds one speed");
  }
  limits.push_back(
      options.inertia > 0.0 ? "inertia was subtracted as given"
      : options.from || options.to
          ? "inertia was not subtracted: angles outside the plateaus of velocity contain its torque"
          : "inertia was not subtracted; on the plateaus of velocity the speed varies by up to 10 %, so that "
            "some of its torque remains at high speeds");
  for (const StretchDirection& one : found.directions) {
    if (one.speeds.size() > 1 &&
        std::ranges::any_of(one.speeds, [](const StretchSpeed& speed) { return speed.repetitions < 2; })) {
      limits.push_back(
          "speeds with one stretch only: a catch cannot be judged there; repeat each speed, five times or "
          "more");
      break;
    }
  }
  if (std::ranges::any_of(found.directions, in_order)) {
    limits.emplace_back(
        "the speeds follow each other in order: a drift of the torque's offset looks like an effect of speed, and the "
        "interval of the slope does not contain it; mix the order");
  }
  limits.emplace_back(kTorqueAlone);
  limits.emplace_back("a reflex that acts during the slowest stretch is part of the passive curve");
}

}  // namespace stretches

Result<StretchEstimate> stretch(std::span<const ExplorationTrial> trials, const StretchOptions& options,
                                std::vector<Warning>& warnings) {
  using namespace stretches;
  if (options.from && options.to && !(*options.from < *options.to)) {
    return bad_usage("the analysed angles of the stretch are an empty range", "give the smaller one as the start");
  }
  if (trials.empty()) return bad_usage("no recording was given");
  for (const ExplorationTrial& trial : trials) {
    if (trial.axes != trials.front().axes)
      return bad_data("the recordings have different axes", "explore them separately");
  }
  StretchEstimate found;
  found.inertia = options.inertia;
  found.axis = static_cast<int>(stretched_axis(trials, found.limits));
  std::vector<Signal> signals;
  std::vector<Move> moves;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    auto signal = MBK_TRY(signal_of(trials[k], found.axis, options.inertia));
    for (const Move& move : moves_of(signal, static_cast<int>(k))) moves.push_back(move);
    signals.push_back(std::move(signal));
  }
  if (moves.size() < 2) {
    return bad_data(
        fmt::format("{} movement{} with constant velocity found", moves.size(), moves.size() == 1 ? "" : "s"),
        "record stretches at two constant speeds or more, several times each");
  }
  for (const Signal& one : signals) {
    const double low = one.position.minCoeff(), high = one.position.maxCoeff();
    if (trials.front().motion != Motion::rotation || high - low <= 2.0 * std::numbers::pi) continue;
    return bad_data(fmt::format("the position ranges from {:.4g} to {:.4g} rad, as no joint does", low, high),
                    "if it is in degrees, state it: --channels x=NAME:deg");
  }
  found.inertia_found = found_inertia(moves, signals, options.inertia);
  const bool reversed =
      found.inertia_found && found.inertia_found->interval95 && found.inertia_found->interval95->second < 0.0;
  if (reversed) {
    warnings.push_back(
        {WarningCode::force_sign_reversed,
         fmt::format("the inertia in the acceleration phases is negative, {:.2g} kg·m²", found.inertia_found->value),
         "put a minus before the torque in --channels, as in F=-torque"});
    found.usable = false;
  }
  for (const int direction : {moves.front().direction, -moves.front().direction}) {
    const Side side = side_of(direction, moves, signals, options);
    if (side.courses.size() < 2) {
      if (std::ranges::count(moves, direction, &Move::direction) > 1) {
        found.limits.push_back(fmt::format("movements with {} angle have no angles in common at constant velocity",
                                           direction > 0 ? "increasing" : "decreasing"));
      }
      continue;
    }
    found.directions.push_back(described(side, moves, signals, options, reversed));
  }
  for (const StretchDirection& one : found.directions) {
    if (reversed || !one.slope.interval95 || !(one.slope.interval95->second < 0.0)) continue;
    warnings.push_back({WarningCode::force_sign_reversed,
                        fmt::format("the torque that resists falls with speed, by {:.2g} N·m·s/rad [{:.2g}, {:.2g}], "
                                    "as that of no passive limb does",
                                    one.slope.value, one.slope.interval95->first, one.slope.interval95->second),
                        "check the sign of the torque in --channels, a drift of its offset, and whether the person "
                        "helped"});
    found.usable = false;
  }
  if (found.directions.empty()) {
    return bad_data(
        "the stretches have no angles in common at which their velocity is constant, in at least 27 samples",
        "stretch further, accelerate faster, sample faster, or leave out the fastest recordings");
  }
  std::ranges::stable_sort(found.directions, std::greater(),
                           [](const StretchDirection& one) { return one.speeds.size(); });
  add_limits(found, trials.size(), options, found.limits);
  return found;
}

}  // namespace mbk::explore
