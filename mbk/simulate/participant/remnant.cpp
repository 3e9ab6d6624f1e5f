#include "mbk/simulate/participant/remnant.h"

#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::participant {

template <int Axes>
Result<Remnant<Axes>> Remnant<Axes>::create(const Options& options, double sample_time, std::uint64_t seed,
                                            std::uint32_t stream) {
  MBK_TRY(above_zero({{"sample time", sample_time, "s"}, {"cutoff of noise", options.cutoff.value, "Hz"}}));
  if (auto ok = not_negative({{"floor of noise", options.floor, ""}, {"noise per force", options.per_force, ""}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  return Remnant(options, std::exp(-RadPerSec(options.cutoff).value * sample_time), numeric::Random(seed, stream));
}

template <int Axes>
Remnant<Axes>::Remnant(const Options& options, double memory, numeric::Random random)
    : options_(options), memory_(memory), random_(random), shape_(draw()) {}

template <int Axes>
auto Remnant<Axes>::draw() -> Force {
  Force values;
  for (int axis = 0; axis < Axes; ++axis) values[axis] = random_.normal();
  return values;
}

template <int Axes>
auto Remnant<Axes>::step(double voluntary_force) -> Force {
  shape_ = memory_ * shape_ + std::sqrt(1.0 - memory_ * memory_) * draw();
  return (options_.floor + options_.per_force * voluntary_force) * shape_;
}

template class Remnant<1>;
template class Remnant<2>;

}  // namespace mbk::participant
