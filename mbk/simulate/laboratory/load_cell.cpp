#include "mbk/simulate/laboratory/load_cell.h"

#include "mbk/base/core/option_limits.h"

namespace mbk::laboratory {
namespace {

template <int Axes>
Result<void> check(const LoadCellOptions<Axes>& o) {
  if (auto ok = not_negative({{"white noise of the load cell", o.white_noise, "N"},
                              {"coloured noise of the load cell", o.coloured_noise, "N"},
                              {"random walk of the load cell", o.drift_walk, "N/√s"}});
      !ok) {
    return ok;
  }
  if (auto ok = above_zero({{"bandwidth of the load cell's coloured noise", o.coloured_bandwidth.value, "Hz"}}); !ok) {
    return ok;
  }
  for (int i = 0; i < Axes; ++i) {
    std::vector<Choice> numbers;
    for (int k = 0; k < Axes; ++k) numbers.push_back({"gain of the load cell", o.gain(i, k), "N/N"});
    numbers.push_back({"offset of the load cell", o.offset[i], "N"});
    numbers.push_back({"drift of the load cell", o.drift_rate[i], "N/s"});
    if (auto ok = finite(numbers); !ok) return ok;
  }
  return {};
}

}  // namespace

template <int Axes>
Result<LoadCell<Axes>> LoadCell<Axes>::create(const Options& options, double sample_time, std::uint64_t seed) {
  if (auto ok = check(options); !ok) return tl::unexpected(ok.error());
  if (auto ok = above_zero({{"sample time", sample_time, "s"}}); !ok) return tl::unexpected(ok.error());
  return LoadCell(options, sample_time, seed);
}

template <int Axes>
LoadCell<Axes>::LoadCell(const Options& o, double sample_time, std::uint64_t seed)
    : gain_error_(o.gain - AxisMatrix<Axes>::Identity()),
      offset_(o.offset),
      noise_(per_axis<Axes>([&](std::uint32_t axis) {
        return AxisNoise{
            WhiteNoise(o.white_noise, noise_stream(seed, NoiseSource::white_force, axis)),
            ColouredNoise(o.coloured_noise, o.coloured_bandwidth, sample_time,
                          noise_stream(seed, NoiseSource::coloured_force, axis)),
            Drift(o.drift_walk, o.drift_rate[axis], sample_time, noise_stream(seed, NoiseSource::force_drift, axis))};
      })) {}

template <int Axes>
AxisVector<Axes> LoadCell<Axes>::added(const AxisVector<Axes>& force) noexcept {
  AxisVector<Axes> sum = gain_error_ * force + offset_;
  for (Eigen::Index i = 0; i < Axes; ++i) {
    AxisNoise& axis = noise_[static_cast<std::size_t>(i)];
    sum[i] += axis.drift.next() + axis.white.next() + axis.coloured.next();
  }
  return sum;
}

template class LoadCell<1>;
template class LoadCell<2>;

}  // namespace mbk::laboratory
