#include "mbk/experiment/protocol/device_plan.h"

#include <Eigen/LU>
#include <array>

namespace mbk::protocol {
namespace {

using config::above;
using config::between;
using config::Section;
using device::Wiring;
using Eigen::Vector2d;

constexpr double kTurn = 6.283185307179586;
constexpr int kMaxLatency = 100;  // ticks

Vector2d read_signs(const Section& s, const char* key) {
  const Vector2d signs = s.vector2(key, {1.0, 1.0});
  if ((signs.cwiseAbs().array() != 1.0).any()) s.reject(key, "a sign is neither 1 nor -1", "write [1, -1]");
  return signs;
}

Eigen::Matrix2d read_gain(const Section& s, const char* key, const Eigen::Matrix2d& fallback) {
  const Eigen::Matrix2d gain = s.matrix2(key, fallback);
  if (gain.determinant() == 0.0) s.reject(key, "different forces or accelerations would give the same reading");
  return gain;
}

Wiring::Frame read_frame(const Section& s, const char* key) {
  return s.choice(key, Wiring::Frame::base);
}

void read_wiring(const Section& s, DevicePlan& plan) {
  Wiring& w = plan.fittings.wiring;
  plan.counts = s.has("counts_per_turn");
  const Vector2d turn = plan.counts ? s.required_vector2("counts_per_turn", above(0)) : Vector2d(kTurn, kTurn);
  w.radians_per_count = read_signs(s, "encoder_sign").cwiseProduct((kTurn * turn.cwiseInverse()));
  w.count_offset = s.vector2("count_offset", w.count_offset);
  w.force_gain = read_gain(s, "force_gain_N_per_unit", w.force_gain);
  w.force_offset = s.vector2("force_offset", w.force_offset);
  w.force_frame = read_frame(s, "force_frame");
  plan.force_step = s.optional_number("force_step", above(0));
  w.acceleration_gain = read_gain(s, "acceleration_gain_per_unit", w.acceleration_gain);
  w.acceleration_offset = s.vector2("acceleration_offset", w.acceleration_offset);
  w.acceleration_frame = read_frame(s, "acceleration_frame");
  const Vector2d torque = s.vector2("torque_per_command_Nm", {1.0, 1.0}, above(0));
  const Vector2d gear = s.vector2("gear", {1.0, 1.0}, above(0));
  w.torque_per_command = read_signs(s, "motor_sign").cwiseProduct(torque).cwiseProduct(gear);
}

}  // namespace

DevicePlan read_device(const Section& s, const std::filesystem::path& folder) {
  enum class Kind { simulated, udp, plugin };
  DevicePlan plan;
  const auto kind =
      s.choice("kind", {{"simulated", Kind::simulated}, {"udp", Kind::udp}, {"plugin", Kind::plugin}}, Kind::simulated);
  if (kind == Kind::simulated) {
    if (s.has("wiring")) {
      s.reject("wiring", "a simulated robot has no wiring", "name the robot, as kind = \"udp\", or remove the table");
    }
    return plan;
  }
  const auto read_watchdog = [&](double fallback) { return s.number("watchdog_ms", fallback, between(1, 10'000)); };
  if (kind == Kind::udp) {
    drivers::UdpOptions udp;
    udp.address = s.text("address", udp.address);
    udp.port = s.integer("port", udp.port, 1, 65'535);
    udp.local_port = s.integer("local_port", udp.local_port, 0, 65'535);
    udp.watchdog = read_watchdog(udp.watchdog);
    udp.answer_within = s.number("answer_within_s", udp.answer_within, between(0.001, 10));
    udp.lock_step = s.flag("lock_step", udp.lock_step);
    plan.kind = udp;
  } else {
    drivers::PluginOptions plugin;
    plugin.library = folder / s.required_text("library");
    plugin.settings = s.text("settings", "");
    plugin.watchdog = read_watchdog(plugin.watchdog);
    plan.kind = plugin;
  }
  plan.fittings.has_force = s.flag("has_force", true);
  plan.fittings.has_acceleration = s.flag("has_acceleration", true);
  plan.fittings.force_latency = s.integer("force_latency_ticks", 0, 0, kMaxLatency);
  read_wiring(s.section("wiring"), plan);
  return plan;
}

}  // namespace mbk::protocol
