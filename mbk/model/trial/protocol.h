#pragma once

#include <string_view>

namespace mbk {

/// How the limb was perturbed; it decides which samples count.
enum class Protocol {
  sinusoidal,   ///< the reference varies continuously: a multisine, or any other lasting perturbation
  underdamped,  ///< the reference is constant but for steps: pulses, each cut out by itself
  free,         ///< no reference: the whole recording
};

/// `reference` reproduces the published procedure sample for sample; `improved` is mbk's default.
enum class Mode { improved, reference };

/// The two published procedures (Dyck 2013): chapter 3 takes the acceleration from the position, W = 101, 5 Hz;
/// chapter 5 takes it from the accelerometer, W = 151, 4.5 Hz.
enum class Procedure { chapter3, chapter5 };

[[nodiscard]] constexpr std::string_view text(Protocol protocol) {
  switch (protocol) {
    case Protocol::sinusoidal:
      return "sinusoidal";
    case Protocol::underdamped:
      return "underdamped";
    case Protocol::free:
      return "free";
  }
  return "unknown";
}

[[nodiscard]] constexpr std::string_view text(Mode mode) {
  return mode == Mode::improved ? "default" : "reference";
}

[[nodiscard]] constexpr std::string_view text(Procedure procedure) {
  return procedure == Procedure::chapter3 ? "chapter3" : "chapter5";
}

}  // namespace mbk
