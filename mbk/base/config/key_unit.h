#pragma once

#include <string_view>

namespace mbk::config {

/// The unit that a key ends with. SI value = value · multiply / divide; two factors, so that 5 mm is exactly 0.005 m.
struct KeyUnit {
  double multiply = 1.0;
  double divide = 1.0;

  [[nodiscard]] double to_si(double value) const { return value * multiply / divide; }
};

/// "amplitude_mm" → m, "orientation_deg" → rad, "speed_mm_per_s" → m/s, "inertia_kg_m2" → kg·m², "overlap_percent" →
/// fraction. The unit is the last word of the key, or NUMERATOR_per_DENOMINATOR; a 2 behind a unit is its square, and
/// the unit before a square counts as its factor. Known are m, cm, mm, um; rad, mrad, deg; s, ms, us; Hz, hz, kHz, khz;
/// kg, g; N, kN, mN; Nm, Nmm, mNm; Ns, Nms; V, mV, A, mA; percent. Case counts, a key that is a unit alone has none
/// ("g"), and any other word has the factor 1. Hertz stays hertz.
[[nodiscard]] KeyUnit unit_of_key(std::string_view key);

}  // namespace mbk::config
