#include "mbk/files/bids/run_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace mbk::recording {
namespace {

constexpr auto kEntities = std::to_array<std::string_view>({"sub", "ses", "task", "tracksys", "acq", "run"});
constexpr std::string_view kExample = "use the form sub-07_ses-2_task-reach_run-1";

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_label_letter(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

}  // namespace

std::string_view BidsName::label(std::string_view entity) const {
  const auto found = std::ranges::find(entities, entity, [](const auto& one) { return std::string_view(one.first); });
  return found == entities.end() ? std::string_view() : std::string_view(found->second);
}

std::string BidsName::text() const {
  std::string text;
  for (const auto& [entity, label] : entities) text += fmt::format("{}{}-{}", text.empty() ? "" : "_", entity, label);
  return text;
}

std::string BidsName::session() const {
  const std::string_view session = label("ses");
  return fmt::format("sub-{}{}", label("sub"), session.empty() ? "" : fmt::format("_ses-{}", session));
}

std::string BidsName::session_folder() const {
  const std::string_view session = label("ses");
  return fmt::format("sub-{}{}", label("sub"), session.empty() ? "" : fmt::format("/ses-{}", session));
}

Result<BidsName> parse_bids_name(std::string_view text) {
  BidsName given;
  for (std::string_view rest = text;;) {
    const std::size_t end = std::min(rest.find('_'), rest.size());
    const std::string_view part = rest.substr(0, end);
    const auto dash = part.find('-');
    const std::string_view entity = part.substr(0, std::min(dash, part.size()));
    if (dash == part.npos || std::ranges::find(kEntities, entity) == kEntities.end()) {
      return bad_usage(
          fmt::format("'{}' in '{}' does not begin with sub-, ses-, task-, tracksys-, acq- or run-", part, text),
          std::string(kExample));
    }
    const std::string_view label = part.substr(dash + 1);
    if (label.empty() || !std::ranges::all_of(label, is_label_letter)) {
      return bad_usage(
          fmt::format("the label '{}' of {} contains characters other than letters and digits", label, entity),
          std::string(kExample));
    }
    if (entity == "run" && !std::ranges::all_of(label, is_digit)) {
      return bad_usage(fmt::format("run '{}' is not a number", label), std::string(kExample));
    }
    if (!given.label(entity).empty()) {
      return bad_usage(fmt::format("{} appears twice in '{}'", entity, text), std::string(kExample));
    }
    given.entities.emplace_back(entity, label);
    if (end == rest.size()) break;
    rest.remove_prefix(end + 1);
  }
  if (given.label("tracksys").empty()) given.entities.emplace_back("tracksys", "robot");
  BidsName name;
  for (const std::string_view entity : kEntities) {
    if (const std::string_view label = given.label(entity); !label.empty()) name.entities.emplace_back(entity, label);
  }
  for (const std::string_view needed : {"sub", "task"}) {
    if (!name.label(needed).empty()) continue;
    return bad_usage(fmt::format("'{}' does not give the {}", text, needed == "sub" ? "participant" : "task"),
                     std::string(kExample));
  }
  return name;
}

}  // namespace mbk::recording
