#include "mbk/simulate/laboratory/load_cell.h"

#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::laboratory {
namespace {

template <int Axes>
Result<void> check(const LoadCellOptions<Axes>& o) {
  if (auto ok = not_negative({{"white noise of the load cell", o.white_noise, "N"},
                              {"coloured noise of the load cell", o.coloured_noise, "N"},
                              {"random walk of the load cell", o.drift_walk, "N/√s"},
                              {"delay of the load cell", o.delay, "s"},
                              {"resolution of the load cell", o.resolution, "N"}});
      !ok) {
    return ok;
  }
  MBK_TRY(above_zero({{"bandwidth of the load cell's coloured noise", o.coloured_bandwidth.value, "Hz"}}));
  for (int i = 0; i < Axes; ++i) {
    std::vector<Choice> numbers;
    for (int k = 0; k < Axes; ++k) numbers.push_back({"gain of the load cell", o.gain(i, k), "N/N"});
    numbers.push_back({"offset of the load cell", o.offset[i], "N"});
    numbers.push_back({"drift of the load cell", o.drift_rate[i], "N/s"});
    MBK_TRY(finite(numbers));
  }
  return {};
}

}  // namespace

template <int Axes>
Result<LoadCell<Axes>> LoadCell<Axes>::create(const Options& options, double sample_time, std::uint64_t seed) {
  MBK_TRY(check(options));
  MBK_TRY(above_zero({{"sample time", sample_time, "s"}}));
  return LoadCell(options, sample_time, seed);
}

template <int Axes>
LoadCell<Axes>::LoadCell(const Options& o, double sample_time, std::uint64_t seed)
    : gain_error_(o.gain - AxisMatrix<Axes>::Identity()),
      offset_(o.offset),
      resolution_(o.resolution),
      delay_(o.delay),
      behind_(o.delay / sample_time),
      history_(static_cast<std::size_t>(std::ceil(behind_)) + 1, AxisVector<Axes>::Zero()),
      noise_(per_axis<Axes>([&](std::uint32_t axis) {
        return AxisNoise{
            WhiteNoise(o.white_noise, noise_stream(seed, NoiseSource::white_force, axis)),
            ColouredNoise(o.coloured_noise, o.coloured_bandwidth, sample_time,
                          noise_stream(seed, NoiseSource::coloured_force, axis)),
            Drift(o.drift_walk, o.drift_rate[axis], sample_time, noise_stream(seed, NoiseSource::force_drift, axis))};
      })) {}

template <int Axes>
AxisVector<Axes> LoadCell<Axes>::added(const AxisVector<Axes>& force) noexcept {
  const AxisVector<Axes> then = late(force);
  AxisVector<Axes> sum = gain_error_ * then + offset_ + (then - force);
  for (Eigen::Index i = 0; i < Axes; ++i) {
    AxisNoise& axis = noise_[static_cast<std::size_t>(i)];
    sum[i] += axis.drift.next() + axis.white.next() + axis.coloured.next();
    if (resolution_ > 0.0) sum[i] = resolution_ * std::round((force[i] + sum[i]) / resolution_) - force[i];
  }
  return sum;
}

template <int Axes>
AxisVector<Axes> LoadCell<Axes>::late(const AxisVector<Axes>& force) noexcept {
  if (!begun_) history_.assign(history_.size(), force);  // as it was before
  begun_ = true;
  history_[next_] = force;
  next_ = (next_ + 1) % history_.size();  // the oldest
  const double share = std::ceil(behind_) - behind_;
  return (1.0 - share) * history_[next_] + share * history_[(next_ + 1) % history_.size()];
}

template class LoadCell<1>;
template class LoadCell<2>;

}  // namespace mbk::laboratory
