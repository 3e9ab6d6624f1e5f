#pragma once

#include "mbk/base/core/words.h"

namespace mbk {

/// Type of perturbation; it determines the analysed samples.
enum class Protocol {
  sinusoidal,   ///< the reference varies continuously: a multisine, or any other sustained perturbation
  underdamped,  ///< a piecewise-constant reference: pulses, each extracted separately
  free,         ///< no reference: the whole recording
};

/// `reference` reproduces the published procedure sample by sample; `default_mode` is mbk's own.
enum class Mode { default_mode, reference };

/// The two published procedures (Dyck 2013): chapter 3 takes the acceleration from the position, W = 101, 5 Hz;
/// chapter 5 takes it from the accelerometer, W = 151, 4.5 Hz.
enum class Procedure { chapter3, chapter5 };

[[nodiscard]] constexpr auto word_table(Protocol) {
  using enum Protocol;
  return std::to_array<Word<Protocol>>({{sinusoidal, "sinusoidal"}, {underdamped, "underdamped"}, {free, "free"}});
}

[[nodiscard]] constexpr auto word_table(Mode) {
  using enum Mode;
  return std::to_array<Word<Mode>>({{default_mode, "default"}, {reference, "reference"}});
}

[[nodiscard]] constexpr auto word_table(Procedure) {
  using enum Procedure;
  return std::to_array<Word<Procedure>>({{chapter3, "chapter3"}, {chapter5, "chapter5"}});
}

}  // namespace mbk
