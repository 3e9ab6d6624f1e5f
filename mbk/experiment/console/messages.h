#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/document/fields.h"
#include "mbk/experiment/console/command.h"
#include "mbk/experiment/console/console.h"
#include "mbk/experiment/console/live_estimate.h"
#include "mbk/experiment/console/outbox.h"
#include "mbk/experiment/console/texts.h"

/// What the console and its pages tell each other as text: schemas console and console_command. For the sources of this
/// project only.
namespace mbk::console {

void describe(document::Fields<Console>& fields);  // the state of the session
void describe(document::Fields<Texts>& fields);
void describe(document::Fields<Command>& fields);

/// The trials that were begun.
struct PerformedTrials {
  std::vector<const PerformedTrial*> attempts;
};
void describe(document::Fields<PerformedTrials>& fields);

/// M, B, K of the trial that runs; null where it begins.
struct NewestEstimate {
  const LiveEstimate::Estimate* estimate = nullptr;
};
void describe(document::Fields<NewestEstimate>& fields);

/// What one page may do.
struct You {
  std::string_view control;
  bool may_control = false;
  std::uint64_t dropped_frames = 0;
};
void describe(document::Fields<You>& fields);

/// Why what a page asked for was not done.
struct Refused {
  std::string why;
};
void describe(document::Fields<Refused>& fields);

/// As it is sent to pages.
template <document::Described T>
[[nodiscard]] Message message(const T& value) {
  return std::make_shared<std::string>(document::compact(document::written(value)));
}

/// Adds the schemas of both directions.
void add_schemas(document::Schemas& schemas);

}  // namespace mbk::console
