#pragma once

#include <array>
#include <span>

#include "mbk/base/core/words.h"

namespace mbk {

/// Quantities of a limb that are checked for plausibility.
enum class PlausibleQuantity { inertia, damping, stiffness, frequency, position, motion, speed, force, rate };

[[nodiscard]] constexpr auto word_table(PlausibleQuantity) {
  using enum PlausibleQuantity;
  return std::to_array<Word<PlausibleQuantity>>({{inertia, "inertia"},
                                                 {damping, "damping"},
                                                 {stiffness, "stiffness"},
                                                 {frequency, "frequency"},
                                                 {position, "position"},
                                                 {motion, "motion"},
                                                 {speed, "speed"},
                                                 {force, "force"},
                                                 {rate, "rate"}});
}

/// Plausible range and typical value of a quantity. SI units and radians.
struct PlausibleRange {
  PlausibleQuantity quantity;
  const char* unit;
  double low;      ///< 0: no limit
  double typical;  ///< within the range, on a logarithmic scale; used to rank explanations
  double high;
  const char* what;    ///< definition of the quantity
  const char* source;  ///< source of the limits
};

/// A hand at a robot, or its replacement: springs with a payload. Published endpoint impedances of arms are
/// 0.5–3 kg, 3–60 N·s/m and 15–1000 N/m; the limits are well outside these values, so that they include a soft or
/// braced arm, of a child or an athlete.
inline constexpr auto kHandRanges = std::to_array<PlausibleRange>({
    {PlausibleQuantity::inertia, "kg", 0.2, 1.6, 8.0, "mean singular value of M",
     "Tsuji et al. 1995 (Biol Cybern 72:475), Dyck 2013: 0.5-3 kg; payloads of spring rigs from 0.29 kg"},
    {PlausibleQuantity::damping, "N·s/m", 0.3, 10.0, 300.0, "mean singular value of B",
     "Tsuji et al. 1995, Perreault et al. 2004 (Exp Brain Res 157:507): 3-60 N·s/m; springs with bearings 1 N·s/m"},
    {PlausibleQuantity::stiffness, "N/m", 12.0, 120.0, 4000.0, "mean singular value of K",
     "Mussa-Ivaldi et al. 1985 (J Neurosci 5:2732), Gomi & Kawato 1997 (Biol Cybern 76:163), Dyck 2013: 15-1000 N/m; "
     "3-7 times the resting value with co-contraction"},
    {PlausibleQuantity::frequency, "Hz", 0.25, 1.5, 12.0, "sqrt(K/M)/2π of the mean singular values",
     "from the same models: 0.7-4 Hz; spring rigs up to 6.3 Hz"},
    {PlausibleQuantity::position, "m", 0.0, 0.3, 5.0, "distance of the mean position from the origin of its frame",
     "arm reach 0.7 m, robot reach 2 m, origin of the frame within the laboratory"},
    {PlausibleQuantity::motion, "m", 5e-5, 5e-3, 0.25, "standard deviation of the position, axis by axis",
     "perturbations of 1-20 mm (the five sources above); free reaches up to 0.6 m have 0.2 m"},
    {PlausibleQuantity::speed, "m/s", 3e-4, 0.05, 6.0, "speed that one sample in a thousand exceeds, axis by axis",
     "perturbations 0.01-1 m/s; fastest reaches 4 m/s"},
    {PlausibleQuantity::force, "N", 0.01, 1.5, 250.0, "standard deviation of the force, axis by axis",
     "perturbations of 0.3-50 N; noise of load cells from 0.01 N; maximal push about 300 N"},
    {PlausibleQuantity::rate, "Hz", 40.0, 1000.0, 1e5, "sampling rate",
     "a limb responds up to about 10 Hz; robots are controlled at 100 Hz to 10 kHz"},
});

/// One joint, from a finger to a hip.
inline constexpr auto kJointRanges = std::to_array<PlausibleRange>({
    {PlausibleQuantity::inertia, "kg·m²", 2e-5, 0.02, 3.0, "M",
     "from the finger (Hajian & Howe 1997, J Biomech Eng 119:109) over ankle and elbow (Kearney & Hunter 1990, Crit "
     "Rev "
     "Biomed Eng 18:55) to the leg about the hip"},
    {PlausibleQuantity::damping, "N·m·s/rad", 2e-4, 0.5, 40.0, "B", "the same"},
    {PlausibleQuantity::stiffness, "N·m/rad", 0.05, 30.0, 1500.0, "K",
     "the same; a contracted ankle reaches several hundred N·m/rad"},
    {PlausibleQuantity::frequency, "Hz", 0.25, 5.0, 40.0, "sqrt(K/M)/2π",
     "from the same models: elbow 1-4 Hz, ankle 5-20 Hz, finger higher"},
    {PlausibleQuantity::position, "rad", 0.0, 0.5, 6.4, "mean angle", "no joint turns by more than one revolution"},
    {PlausibleQuantity::motion, "rad", 2e-4, 0.02, 0.8, "standard deviation of the angle",
     "perturbations of 0.2-10°; isokinetic movement over 100° has 0.5 rad"},
    {PlausibleQuantity::speed, "rad/s", 1e-3, 1.0, 35.0, "speed that one sample in a thousand exceeds",
     "perturbations 0.05-5 rad/s; fastest voluntary movements of the arm 20-35 rad/s"},
    {PlausibleQuantity::force, "N·m", 1e-3, 1.5, 300.0, "standard deviation of the torque",
     "perturbations 0.01-20 N·m; maximal contraction of the knee about 250 N·m"},
    {PlausibleQuantity::rate, "Hz", 40.0, 1000.0, 1e5, "sampling rate",
     "a joint responds up to about 20 Hz; machines are controlled at 100 Hz to 10 kHz"},
});

}  // namespace mbk
