#include "mbk/present/report/ranges_text.h"

#include <fmt/format.h>

#include <span>

#include "mbk/model/trial/plausible_ranges.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

std::string family(std::string_view heading, std::span<const PlausibleRange> ranges) {
  std::string text = fmt::format("{}\n", heading);
  std::vector<std::vector<std::string>> rows;
  for (const PlausibleRange& range : ranges) {
    const std::string low = range.low > 0.0 ? fmt::format("{:g}", range.low) : "0";
    rows.push_back({"  " + std::string(word_of(range.quantity)),
                    fmt::format("{} to {:g} {}", low, range.high, range.unit), range.what});
  }
  text += table(rows);
  for (const PlausibleRange& range : ranges) {
    text += paragraph(fmt::format("    {}: ", word_of(range.quantity)), range.source);
  }
  return text;
}

}  // namespace

std::string ranges_text() {
  return family("A hand on a robot, or springs with a payload instead:", kHandRanges) + "\n" +
         family("One joint, from a finger to a hip:", kJointRanges) + "\n" +
         paragraph("",
                   "A result outside a range is not usable. Disable a range with --ignore-range NAME (left column).");
}

}  // namespace mbk::report
