#include "mbk/model/robot_file/drive_keys.h"

#include <fmt/format.h>

#include <algorithm>

namespace mbk::robot_file {

using robot::DriveTerms;

const std::vector<DriveTerm>& drive_terms() {
  static const std::vector<DriveTerm> kAll = {
      {"motor_inertia", &DriveTerms::motor_inertia, "motor_inertia_kg_m2", "motor_inertia_kg"},
      {"viscous", &DriveTerms::viscous, "viscous_Nms_per_rad", "viscous_Ns_per_m"},
      {"coulomb", &DriveTerms::coulomb, "coulomb_Nm", "coulomb_N"},
      {"stribeck", &DriveTerms::stribeck, "stribeck_Nm", "stribeck_N"},
      {"cable", &DriveTerms::cable, "cable_Nm_per_rad", "cable_N_per_m"},
      {"offset", &DriveTerms::offset, "offset_Nm", "offset_N"}};
  return kAll;
}

DriveValues::DriveValues(const DriveTerms& requested, int joints)
    : terms(requested),
      values(Vector::Zero(joints * requested.per_joint())),
      stated(static_cast<std::size_t>(values.size()), false) {}

void DriveValues::set(bool DriveTerms::*term, int joint, double value) {
  if (!(terms.*term)) return;
  Index at = joint * terms.per_joint();
  for (const DriveTerm& one : drive_terms()) {
    if (one.requested == term) break;
    at += terms.*one.requested ? 1 : 0;
  }
  values[at] = value;
  stated[static_cast<std::size_t>(at)] = true;
}

DriveTerms read_terms(const config::Section& drive) {
  DriveTerms terms;
  if (!drive.has("terms")) return terms;
  using Part = bool DriveTerms::*;
  const std::vector<Part> requested = drive.choices<Part>("terms",
                                                          {{"motor_inertia", &DriveTerms::motor_inertia},
                                                           {"viscous", &DriveTerms::viscous},
                                                           {"coulomb", &DriveTerms::coulomb},
                                                           {"stribeck", &DriveTerms::stribeck},
                                                           {"cable", &DriveTerms::cable},
                                                           {"offset", &DriveTerms::offset}},
                                                          {});
  for (const DriveTerm& one : drive_terms())
    terms.*one.requested = std::ranges::find(requested, one.requested) != requested.end();
  return terms;
}

void read_velocities(const config::Section& drive, const robot::Mechanism& mechanism, DriveTerms& terms) {
  bool all_slide = true;
  for (int joint = 0; joint < mechanism.joints(); ++joint) all_slide = all_slide && mechanism.slides(joint);
  const char* unit = all_slide ? "m_per_s" : "rad_per_s";
  terms.smoothing = drive.number(fmt::format("smoothing_{}", unit), terms.smoothing, config::at_least(0));
  terms.stribeck_velocity =
      drive.number(fmt::format("stribeck_velocity_{}", unit), terms.stribeck_velocity, config::above(0));
}

void read_values(const config::Section& drive, const robot::Mechanism& mechanism,
                 const std::vector<std::string>& except, DriveValues& into) {
  for (const DriveTerm& term : drive_terms()) {
    if (std::ranges::find(except, term.word) != except.end()) continue;
    for (const bool sliding : {false, true}) {
      const char* key = sliding ? term.sliding_key : term.turning_key;
      std::vector<int> joints;
      for (int joint = 0; joint < mechanism.joints(); ++joint) {
        if (mechanism.slides(joint) == sliding) joints.push_back(joint);
      }
      if (joints.empty() || !drive.has(key)) continue;
      if (!(into.terms.*term.requested)) {
        drive.reject(key, fmt::format("\"{}\" is not among the drive terms", term.word),
                     fmt::format("add it to terms in [drive], or remove {}", key));
        continue;
      }
      const bool resists = term.requested == &DriveTerms::motor_inertia || term.requested == &DriveTerms::viscous ||
                           term.requested == &DriveTerms::coulomb;
      const std::vector<double> values = drive.numbers(key, std::vector<double>(joints.size()),
                                                       resists ? config::at_least(0) : config::any(), joints.size());
      for (std::size_t k = 0; k < joints.size(); ++k) into.set(term.requested, joints[k], values[k]);
    }
  }
}

}  // namespace mbk::robot_file
