#include "mbk/validate/robot_event.h"

#include <fmt/format.h>

#include "mbk/base/realtime/clock.h"

namespace mbk::validation {

using document::Fields;
using document::Json;

void describe(Fields<RobotTruth>& fields) {
  const auto six_digits = [](double RobotTruth::*member) {
    return [member](const RobotTruth& truth) { return Json::parse(fmt::format("{:.6g}", truth.*member)); };
  };
  fields.add("tick", &RobotTruth::ticks, "so far");
  fields.add("motors_on", &RobotTruth::motors_on, "tick of when the motors were first on; -1: never");
  fields.add("fault_began", &RobotTruth::fault_began, "tick; -1: never");
  fields.add("told_off", &RobotTruth::told_off,
             "tick of when the first command since then to switch the motors off reached the wire; -1: never");
  fields.add("torque_off", &RobotTruth::torque_off,
             "first tick without torque, and there has been none since; -1: never");
  fields.add("last_command", &RobotTruth::last_command, "tick of when one reached the wire; -1: never");
  const Json number = {{"type", "number"}};
  fields.add_as("speed_m_per_s", number, six_digits(&RobotTruth::speed),
                "largest of the hand since the fault began [m/s]");
  fields.add_as("force_N", number, six_digits(&RobotTruth::force), "largest at the handle since then [N]");
  fields.add("missed", &RobotTruth::missed, "ticks that its program was held up and had to make up for");
  fields.add("stalled", &RobotTruth::stalled, "of them, with the last stall");
}

namespace {

struct Listening {
  std::string address;
  std::uint16_t port;
};

void describe(Fields<Listening>& fields) {
  fields.type("Listening");
  fields.constant("event", "listening");
  fields.add("address", &Listening::address);
  fields.add("port", &Listening::port);
}

struct Event {
  std::string name;
  std::int64_t ns;
  RobotTruth truth;
};

void describe(Fields<Event>& fields) {
  fields.type("RobotTruth");
  fields.add("event", &Event::name, "what happened; the last one is \"end\"");
  fields.add("ns", &Event::ns, "monotonic time [ns]");
  fields.with(&Event::truth);
}

}  // namespace

std::string listening_line(const std::string& address, std::uint16_t port) {
  return document::compact(document::written(Listening{address, port})) + "\n";
}

std::string event_line(std::string_view event, const RobotTruth& truth) {
  return document::compact(document::written(Event{std::string(event), realtime::monotonic_ns(), truth})) + "\n";
}

void add_robot_event_schema(document::Schemas& schemas) {
  schemas["robot_event"] = document::schema_of_one<Listening, Event>(
      "Robot event",
      "A line of what `mbk_misbehaving_robot` prints: what truly happens. Ticks are of its own clock, 1 kHz, since the "
      "first greeting.");
}

}  // namespace mbk::validation
