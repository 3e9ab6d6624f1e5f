#pragma once

#include <string>
#include <vector>

#include "apps/mbk/terminal/command.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/recording.h"

namespace mbk::app {

/// Where an impedance is said.
enum class Domain { hand, joint };

[[nodiscard]] constexpr auto word_table(Domain) {
  using enum Domain;
  return std::to_array<Word<Domain>>({{hand, "hand"}, {joint, "joint"}});
}

/// From a model at the hand to what it means.
struct AnalyseArguments {
  Domain domain = Domain::hand;
  std::string arm;

  [[nodiscard]] bool operator==(const AnalyseArguments&) const = default;
};

/// Adds --domain and --arm.
void add_analyse_options(Command command, AnalyseArguments& arguments);

/// With --arm the recording's metadata hold that arm.
void add_arm(const AnalyseArguments& arguments, Recording& recording);

}  // namespace mbk::app
