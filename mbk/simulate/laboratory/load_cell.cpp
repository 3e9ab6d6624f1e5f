#include "mbk/simulate/laboratory/load_cell.h"

#include "mbk/base/core/option_limits.h"

namespace mbk::laboratory {
namespace {

Result<void> check(const LoadCellOptions& o) {
  if (auto ok = not_negative({{"white noise of the load cell", o.white_noise, "N"},
                              {"coloured noise of the load cell", o.coloured_noise, "N"},
                              {"random walk of the load cell", o.drift_walk, "N/√s"}});
      !ok) {
    return ok;
  }
  if (auto ok = above_zero({{"bandwidth of the load cell's coloured noise", o.coloured_bandwidth.value, "Hz"}}); !ok) {
    return ok;
  }
  for (int i = 0; i < 2; ++i) {
    if (auto ok = finite({{"gain of the load cell", o.gain(i, 0), "N/N"},
                          {"gain of the load cell", o.gain(i, 1), "N/N"},
                          {"offset of the load cell", o.offset[i], "N"},
                          {"drift of the load cell", o.drift_rate[i], "N/s"}});
        !ok) {
      return ok;
    }
  }
  return {};
}

}  // namespace

Result<LoadCell> LoadCell::create(const LoadCellOptions& options, double sample_time, std::uint64_t seed) {
  if (auto ok = check(options); !ok) return tl::unexpected(ok.error());
  if (auto ok = above_zero({{"sample time", sample_time, "s"}}); !ok) return tl::unexpected(ok.error());
  return LoadCell(options, sample_time, seed);
}

LoadCell::LoadCell(const LoadCellOptions& o, double sample_time, std::uint64_t seed)
    : gain_error_(o.gain - Eigen::Matrix2d::Identity()),
      offset_(o.offset),
      axes_{axis(o, sample_time, seed, 0), axis(o, sample_time, seed, 1)} {}

LoadCell::Axis LoadCell::axis(const LoadCellOptions& o, double sample_time, std::uint64_t seed, std::uint32_t number) {
  return {WhiteNoise(o.white_noise, noise_stream(seed, NoiseSource::white_force, number)),
          ColouredNoise(o.coloured_noise, o.coloured_bandwidth, sample_time,
                        noise_stream(seed, NoiseSource::coloured_force, number)),
          Drift(o.drift_walk, o.drift_rate[number], sample_time, noise_stream(seed, NoiseSource::force_drift, number))};
}

Eigen::Vector2d LoadCell::added(const Eigen::Vector2d& force) noexcept {
  Eigen::Vector2d sum = gain_error_ * force + offset_;
  for (Eigen::Index i = 0; i < 2; ++i) {
    Axis& axis = axes_[static_cast<std::size_t>(i)];
    sum[i] += axis.drift.next() + axis.white.next() + axis.coloured.next();
  }
  return sum;
}

}  // namespace mbk::laboratory
