#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/document/fields.h"
#include "mbk/base/realtime/machine.h"
#include "mbk/experiment/drivers/bridge_check.h"
#include "mbk/experiment/session/robot_check.h"

namespace mbk::session {

/// Results of `mbk robot check`; empty: not requested.
struct RobotCheckReport {
  struct Setup {
    std::string file, text;
    std::vector<Finding> findings;
    std::string live_text;
    std::optional<std::vector<Finding>> live;
  };
  struct Link {
    std::string address;
    drivers::BridgeCheckOptions options;
    drivers::BridgeReport report;
  };
  struct Timing {
    realtime::Machine machine;
    realtime::Lateness lateness;
    std::vector<Finding> findings;
  };
  std::optional<Setup> setup;
  std::optional<Link> link;
  std::optional<Timing> timing;

  [[nodiscard]] bool wrong() const;
  [[nodiscard]] bool incomplete() const;  ///< a rule of the link was not tested
};

[[nodiscard]] std::string text_of(const RobotCheckReport& report);

/// Schema "mbk.robot_check/1".
[[nodiscard]] std::string json_of(const RobotCheckReport& report);

void add_robot_check_schema(document::Schemas& schemas);

}  // namespace mbk::session
