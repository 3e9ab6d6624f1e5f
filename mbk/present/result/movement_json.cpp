#include "mbk/present/result/movement_json.h"

#include <numbers>

#include "mbk/present/result/described.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;

void describe(Fields<Reach>& fields) {
  fields.type("Reach", "One movement from rest to rest.");
  fields.add("begin_s", &Reach::begin_s, "from the first sample of the recording [s]");
  fields.add("end_s", &Reach::end_s, "[s]");
  fields.add("sparc", &Reach::sparc, "spectral arc length of the speed");
  fields.add("ldlj", &Reach::ldlj, "log dimensionless jerk");
  fields.add("peaks", &Reach::peaks, "number of peaks of the speed");
  fields.add("mean_speed", &Reach::mean_speed, "[m/s or rad/s]");
  fields.add("peak_speed", &Reach::peak_speed, "[m/s or rad/s]");
  fields.add("path", &Reach::path, "path length [m or rad]");
  fields.add("distance", &Reach::distance, "straight-line distance from begin to end [m or rad]");
  fields.add_or_null("path_ratio", &Reach::path_ratio, "path/distance; null if the hand returns to its start");
  fields.add_or_null("endpoint_error", &Reach::endpoint_error,
                     "distance from the reference at the end [m or rad]; null without a reference");
  fields.add_or_null("robot_work_J", &Reach::robot_work, "work of the robot on the hand; null without a force");
  fields.add_or_null(
      "force_angle_deg",
      [](const Reach& reach) -> std::optional<double> {
        if (!reach.force_angle) return std::nullopt;
        return 180.0 / std::numbers::pi * *reach.force_angle;
      },
      "mean angle of the force of the hand to its motion; null without a force or with one axis");
}

void describe(Fields<MovementQuality>& fields) {
  using From = const MovementQuality&;
  fields.type("MovementRecording");
  fields.add(
      "file", [](From one) { return one.source.path; }, "path, as given");
  fields.add(
      "sha256", [](From one) { return one.source.sha256; },
      "SHA-256 of the file, in hexadecimal; empty if it was not a file");
  fields.add(
      "format", [](From one) { return one.source.format; }, "empty if unknown");
  fields.add("axes", &MovementQuality::axes);
  fields.add("rate_hz", &MovementQuality::rate_hz, "sample rate [Hz]");
  fields.add("from_s", &MovementQuality::from_s, "start of the analysed interval [s]");
  fields.add("to_s", &MovementQuality::to_s, "its end [s]");
  fields.add("cutoff_hz", &MovementQuality::cutoff_hz, "cutoff frequency of the filter for the speed [Hz]");
  fields.add("rest_speed", &MovementQuality::rest_speed, "below it the hand is at rest [m/s or rad/s]");
  fields.add_unless_empty(
      "trial", [](From one) { return one.source.trial; },
      "trial within the file; absent if the file contains one only");
  fields.add("reaches", &MovementQuality::reaches);
  fields.add("notes", &MovementQuality::notes);
  fields.add("warnings", &MovementQuality::warnings);
}

namespace result {
namespace {

struct Movement {
  std::vector<MovementQuality> recordings;
};

void describe(Fields<Movement>& fields) {
  fields.type("Movement", "Output of `mbk movement --json`: reaches of recordings and their quality. SI units.");
  fields.header("mbk.movement/1");
  fields.add("recordings", &Movement::recordings);
}

}  // namespace

std::string to_json(std::span<const MovementQuality> all) {
  return document::document(Movement{{all.begin(), all.end()}});
}

void add_movement_schema(document::Schemas& schemas) {
  schemas["movement"] = document::schema_of<Movement>();
}

}  // namespace result
}  // namespace mbk
