// The robot with an arm at its handle, moved from rest by the motor torques of a recording, for bench/simulation.py to
// compare with plain_closed_loop.py: no controller, no sensors, no file; with the energies, which are integrated with
// the motion.
//   bench_plant RECORDING.mat TURNS      of `mbk simulate bench/closed_loop.toml`
// Prints JSON: the seconds of each turn and the largest differences from the recording.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <vector>

#include "mbk/files/recording/read.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/quantity_channels.h"
#include "mbk/simulate/laboratory/closed_loop.h"
#include "mbk/simulate/participant/linear_limb.h"

namespace {

using mbk::laboratory::ClosedLoop;
using mbk::laboratory::Vector2d;

constexpr double kTick = 1e-3;

/// Of this process: what else the machine does leaves it alone.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The arm of closed_loop.toml.
mbk::Result<mbk::participant::LinearLimb> arm(const Vector2d& home) {
  mbk::impedance::Model model;
  model.M = (mbk::Matrix(2, 2) << 1.326, -0.935, -0.935, 1.883).finished();
  model.B = (mbk::Matrix(2, 2) << 5.76, -2.14, -2.14, 10.56).finished();
  model.K = (mbk::Matrix(2, 2) << 42.4, -28.6, -28.6, 125.3).finished();
  model.x0 = home;
  return mbk::participant::LinearLimb::create(model);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto recording = mbk::recording::read(argv[1], {});
  const Vector2d home(0.3, -0.05);
  auto limb = arm(home);
  if (!recording || !limb) return 3;
  const mbk::Columns place = mbk::channels_of(*recording, mbk::kPositionChannels, 2),
                     force = mbk::channels_of(*recording, mbk::kForceChannels, 2),
                     torque = mbk::channels_of(*recording, mbk::kTorqueChannels, 2);
  if (place.size() == 0 || force.size() == 0 || torque.size() == 0) return 3;

  std::vector<double> seconds;
  double away = 0.0, wrong = 0.0;
  for (int turn = 0; turn < std::atoi(argv[2]); ++turn) {
    ClosedLoop<2>::Options options;
    options.handle_mass = 0.194;
    auto loop = ClosedLoop<2>::create(options, home, *limb);
    if (!loop) return 3;
    const double begin = cpu_seconds();
    for (mbk::Index i = 0; i < place.rows(); ++i) {
      const auto& now = loop->hold(Vector2d(torque(i, 0), torque(i, 1)), kTick);
      away = std::max(away, (now.position - Vector2d(place(i, 0), place(i, 1))).norm());
      wrong = std::max(wrong, (now.force_hand_on_robot - Vector2d(force(i, 0), force(i, 1))).norm());
      loop->advance();
    }
    seconds.push_back(cpu_seconds() - begin);
  }
  fmt::print("{{\"seconds\": [{}], \"largest_distance_m\": {}, \"largest_force_difference_N\": {}}}\n",
             fmt::join(seconds, ", "), away, wrong);
  return 0;
}
