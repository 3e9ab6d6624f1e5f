#include "mbk/measure/analyse/movement_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/dsp/fourier.h"
#include "mbk/base/dsp/savitzky_golay.h"

namespace mbk::analyse {
namespace {

constexpr double kTopFrequency = 10.0;  ///< [Hz]
constexpr double kAmplitude = 0.05;     ///< of the largest, above which the spectrum counts
constexpr int kPadding = 4;             ///< powers of two of zeros

Result<void> check_speed(const Vector& speed) {
  if (speed.size() < 3)
    return bad_data(fmt::format("{} samples are too few for a speed profile", speed.size()), "record longer");
  if (const Index bad = first_non_finite(speed); bad >= 0) {
    return bad_data(fmt::format("the speed is not a number at sample {}", bad + 1));
  }
  if (!(speed.maxCoeff() > speed.minCoeff())) {
    return bad_data("the speed is constant, so its smoothness is undefined",
                    "choose an interval in which the hand moves");
  }
  return {};
}

/// Mean angle of the force to the direction of motion, over the way.
std::optional<double> force_angle(const Matrix& force, const Matrix& position) {
  double sum = 0.0, way = 0.0;
  for (Index i = 0; i + 1 < position.rows(); ++i) {
    const Vector step = (position.row(i + 1) - position.row(i)).transpose();
    const Vector mean = 0.5 * (force.row(i) + force.row(i + 1)).transpose();
    const double length = step.norm(), strength = mean.norm();
    if (!(length > 0.0) || !(strength > 0.0)) continue;
    sum += length * std::acos(std::clamp(mean.dot(step) / (length * strength), -1.0, 1.0));
    way += length;
  }
  if (!(way > 0.0)) return std::nullopt;
  return sum / way;
}

}  // namespace

Result<double> spectral_arc_length(const Vector& speed, Hertz rate) {
  MBK_TRY(check_speed(speed));
  if (!(rate.value >= 2.0 * kTopFrequency)) {
    return bad_data(
        fmt::format("a sample rate of {:.4g} Hz is too low for a spectrum up to {:.0f} Hz", rate.value, kTopFrequency),
        "record at 20 Hz or more");
  }
  const int power = static_cast<int>(std::ceil(std::log2(static_cast<double>(speed.size())))) + kPadding;
  const Index n = Index{1} << power;
  Vector padded = Vector::Zero(n);
  padded.head(speed.size()) = speed;
  const Vector spectrum = dsp::fourier_transform(padded).cwiseAbs();
  const double spacing = rate.value / static_cast<double>(n), largest = spectrum.maxCoeff();
  Index first = -1, last = -1;
  for (Index k = 0; k < spectrum.size() && static_cast<double>(k) * spacing <= kTopFrequency; ++k) {
    if (spectrum[k] / largest < kAmplitude) continue;
    if (first < 0) first = k;
    last = k;
  }
  if (!(last > first)) return bad_data("the speed has no power below 10 Hz", "choose an interval with a movement");
  const double range = static_cast<double>(last - first);
  double length = 0.0;
  for (Index k = first; k < last; ++k) {
    const double rise = (spectrum[k + 1] - spectrum[k]) / largest;
    length += std::sqrt(1.0 / (range * range) + rise * rise);
  }
  return -length;
}

Result<double> log_dimensionless_jerk(const Vector& speed, Hertz rate) {
  MBK_TRY(check_speed(speed));
  const double T = 1.0 / rate.value, duration = T * static_cast<double>(speed.size());
  const double peak = speed.maxCoeff();
  double squares = 0.0;
  for (Index i = 0; i + 2 < speed.size(); ++i) {
    const double jerk = (speed[i + 2] - 2.0 * speed[i + 1] + speed[i]) / (T * T);
    squares += jerk * jerk;
  }
  if (!(squares > 0.0)) return bad_data("the acceleration is constant, so the jerk is zero");
  return -std::log(duration * duration * duration / (peak * peak) * squares * T);
}

int count_peaks(const Vector& speed, double share) {
  if (speed.size() == 0) return 0;
  const double fall = share * speed.maxCoeff();
  int peaks = 0;
  double top = speed[0], bottom = speed[0];
  bool rising = true;
  for (const double v : speed) {
    if (rising) {
      top = std::max(top, v);
      if (v <= top - fall) {
        ++peaks;
        rising = false;
        bottom = v;
      }
    } else {
      bottom = std::min(bottom, v);
      if (v >= bottom + fall) {
        rising = true;
        top = v;
      }
    }
  }
  return peaks + (rising && top > bottom + fall ? 1 : 0);
}

std::vector<numeric::RowRange> find_reaches(const Vector& speed, Hertz rate, const MovementOptions& options) {
  const double largest = speed.size() > 0 ? speed.maxCoeff() : 0.0;
  std::vector<numeric::RowRange> moving;
  for (Index i = 0; i < speed.size(); ++i) {
    if (!(speed[i] > options.rest_share * largest)) continue;
    const bool same = !moving.empty() && static_cast<double>(i - moving.back().end) / rate.value < options.min_pause_s;
    if (same) {
      moving.back().end = i + 1;
    } else {
      moving.push_back({i, i + 1});
    }
  }
  std::erase_if(moving, [&](const numeric::RowRange& range) {
    const bool cut = range.begin == 0 || range.end == speed.size();
    const bool brief = static_cast<double>(range.size()) / rate.value < options.min_reach_s;
    return cut || brief || speed.segment(range.begin, range.size()).maxCoeff() < options.peak_share * largest;
  });
  return moving;
}

Result<MovementQuality> movement_quality(const Matrix& position, const Matrix& force_hand_on_robot,
                                         const Matrix& target, Hertz rate, const MovementOptions& options) {
  if (!(options.cutoff_hz > 0.0) || !(options.cutoff_hz < 0.5 * rate.value)) {
    return bad_usage(
        fmt::format("a cutoff of {:.4g} Hz is not between 0 and half of {:.4g} Hz", options.cutoff_hz, rate.value));
  }
  if (!(options.rest_share > 0.0) || !(options.peak_share > options.rest_share) || !(options.peak_share < 1.0)) {
    return bad_usage("the shares of the maximum speed are not increasing between 0 and 1");
  }
  for (const Matrix* signals : {&position, &force_hand_on_robot, &target}) {
    for (Index k = 0; k < signals->cols(); ++k) {
      if (const Index bad = first_non_finite(signals->col(k)); bad >= 0) {
        return bad_data(fmt::format("a value is not a number at sample {}", bad + 1));
      }
    }
  }
  constexpr int kOrder = 4;
  const dsp::SavitzkyGolay filter{kOrder, dsp::savitzky_golay_window(kOrder, Hertz(options.cutoff_hz), rate)};
  const auto smooth = MBK_TRY(dsp::savitzky_golay(filter, 0, position, rate));
  const auto velocity = MBK_TRY(dsp::savitzky_golay(filter, 1, position, rate));
  const Vector speed = velocity.rowwise().norm();
  const double extent = (smooth.colwise().maxCoeff() - smooth.colwise().minCoeff()).norm();
  if (!(extent > 0.0)) return bad_data("the hand does not move", "record a movement");
  const Index lost = filter.half_window();

  MovementQuality found;
  found.axes = static_cast<int>(position.cols());
  found.rate_hz = rate.value;
  found.to_s = static_cast<double>(position.rows()) / rate.value;
  found.cutoff_hz = options.cutoff_hz;
  found.rest_speed = options.rest_share * speed.maxCoeff();
  for (const numeric::RowRange& range : find_reaches(speed, rate, options)) {
    const Vector own = speed.segment(range.begin, range.size());
    const Matrix way = smooth.middleRows(range.begin, range.size());
    Reach reach;
    reach.begin_s = static_cast<double>(range.begin + lost) / rate.value;
    reach.end_s = static_cast<double>(range.end + lost) / rate.value;
    const auto sparc = MBK_TRY(spectral_arc_length(own, rate));
    const auto ldlj = MBK_TRY(log_dimensionless_jerk(own, rate));
    reach.sparc = sparc;
    reach.ldlj = ldlj;
    reach.peaks = count_peaks(own);
    reach.mean_speed = own.mean();
    reach.peak_speed = own.maxCoeff();
    const Index last = way.rows() - 1;
    reach.path = (way.bottomRows(last) - way.topRows(last)).rowwise().norm().sum();
    reach.distance = (way.row(last) - way.row(0)).norm();
    constexpr double kReturned = 0.01;  // of the way: it ends where it began
    if (reach.distance > kReturned * reach.path) reach.path_ratio = reach.path / reach.distance;
    if (target.size() > 0) reach.endpoint_error = (way.row(last) - target.row(range.end - 1 + lost)).norm();
    if (force_hand_on_robot.size() > 0) {
      const Matrix force = force_hand_on_robot.middleRows(range.begin + lost, range.size());
      reach.robot_work =
          -0.5 *
          (force.topRows(last) + force.bottomRows(last)).cwiseProduct(way.bottomRows(last) - way.topRows(last)).sum();
      if (found.axes > 1) reach.force_angle = force_angle(force, way);
    }
    found.reaches.push_back(reach);
  }
  if (found.reaches.empty()) {
    return bad_data("no movement from rest to rest was found",
                    "record the hand at rest before and after a reach, or choose another interval");
  }
  return found;
}

}  // namespace mbk::analyse
