#include "mbk/base/config/key_unit.h"

#include <gtest/gtest.h>

#include <numbers>

namespace mbk::config {
namespace {

TEST(UnitOfKey, ConvertsToSiExactly) {
  EXPECT_EQ(unit_of_key("amplitude_mm").to_si(5.0), 0.005);
  EXPECT_EQ(unit_of_key("amplitude_mm").to_si(153.0), 0.153);
  EXPECT_EQ(unit_of_key("amplitude_m").to_si(0.005), 0.005);
  EXPECT_EQ(unit_of_key("orientation_deg").to_si(180.0), std::numbers::pi);
  EXPECT_EQ(unit_of_key("delay_ms").to_si(20.0), 0.02);
  EXPECT_EQ(unit_of_key("motor_g").to_si(250.0), 0.25);
  EXPECT_EQ(unit_of_key("overlap_percent").to_si(50.0), 0.5);
  EXPECT_EQ(unit_of_key("cutoff_hz").to_si(50.0), 50.0);
  EXPECT_EQ(unit_of_key("noise_uV").to_si(5.0), 5e-6);
}

TEST(UnitOfKey, ReadsQuotientsAndSquares) {
  EXPECT_EQ(unit_of_key("speed_mm_per_s").to_si(250.0), 0.25);
  EXPECT_EQ(unit_of_key("stiffness_N_per_mm").to_si(3.0), 3000.0);
  EXPECT_EQ(unit_of_key("stiffness_N_per_m").to_si(3.0), 3.0);
  EXPECT_EQ(unit_of_key("damping_Ns_per_m").to_si(3.0), 3.0);
  EXPECT_EQ(unit_of_key("speed_deg_per_s").to_si(180.0), std::numbers::pi);
  EXPECT_EQ(unit_of_key("acceleration_mm_per_s2").to_si(9810.0), 9.81);
  EXPECT_EQ(unit_of_key("rate_per_ms").to_si(2.0), 2000.0);
  EXPECT_EQ(unit_of_key("area_mm2").to_si(4e6), 4.0);
  EXPECT_EQ(unit_of_key("inertia_kg_m2").to_si(0.3), 0.3);
  EXPECT_EQ(unit_of_key("inertia_g_mm2").to_si(2e9), 2.0);
}

TEST(UnitOfKey, LeavesWhatItDoesNotKnow) {
  for (const char* key : {"", "_", "gain", "g", "mm", "percent", "noise_scale", "length_MM", "mass_KG", "rows_2", "per",
                          "_per_", "per_per", "a_per_"}) {
    EXPECT_EQ(unit_of_key(key).to_si(3.0), 3.0) << key;
  }
  EXPECT_EQ(unit_of_key("gain_mm_per_count").to_si(3.0), 0.003);  // each part stands for itself
}

}  // namespace
}  // namespace mbk::config
