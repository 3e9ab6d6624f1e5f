#include "apps/mbk/options/spring_options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/units.h"

namespace mbk::app {
namespace {

constexpr double kLargestNumber = 1e9;

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t from = 0;;) {
    const std::size_t to = text.find(separator, from);
    parts.push_back(text.substr(from, to - from));
    if (to == std::string_view::npos) return parts;
    from = to + 1;
  }
}

/// The number that the whole text is, but for `unit` at its end.
std::optional<double> number(std::string_view text, std::string_view unit = "") {
  if (!unit.empty() && text.ends_with(unit)) text.remove_suffix(unit.size());
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(std::abs(value) < kLargestNumber))
    return std::nullopt;
  return value;
}

std::optional<std::pair<double, double>> two_numbers(std::string_view text) {
  const auto parts = split(text, ':');
  if (parts.size() != 2) return std::nullopt;
  const auto first = number(parts[0]), second = number(parts[1]);
  if (!first || !second) return std::nullopt;
  return std::pair{*first, *second};
}

constexpr const char* kExample = "write --spring k=120,l=90mm,anchor=565:183 with N/m and mm";

tl::unexpected<Error> bad_spring(const std::string& given, const std::string& what) {
  return bad_usage(fmt::format("--spring {}: {}", quoted(given), what), kExample);
}

}  // namespace

Result<Spring> parse_spring(const std::string& given) {
  Spring spring;
  std::set<std::string_view> seen;
  for (const std::string_view part : split(given, ',')) {
    const std::size_t equals = part.find('=');
    const std::string_view key = part.substr(0, equals);
    if (equals == std::string_view::npos)
      return bad_spring(given, fmt::format("{} has no '='", quoted(std::string(part))));
    const std::string value(part.substr(equals + 1));
    if (!seen.insert(key).second) return bad_spring(given, fmt::format("'{}' is there twice", key));
    const bool is_place = key == "anchor" || key == "hole";
    if (is_place) {
      const auto place = two_numbers(value);
      if (!place) return bad_spring(given, fmt::format("{} {} is not x:y in mm", key, quoted(value)));
      (key == "anchor" ? spring.anchor : spring.hole) = Eigen::Vector2d(place->first, place->second) / kMillimetres;
    } else if (key == "k") {
      const auto k = number(value, "N/m");
      if (!k || !(*k > 0.0))
        return bad_spring(given, fmt::format("k {} is not a positive number of N/m", quoted(value)));
      spring.stiffness = *k;
    } else if (key == "l") {
      const auto l = number(value, "mm");
      if (!l || !(*l >= 0.0)) return bad_spring(given, fmt::format("l {} is not a length in mm", quoted(value)));
      spring.rest_length = *l / kMillimetres;
    } else {
      return bad_spring(given, fmt::format("{} is not k, l, anchor or hole", quoted(std::string(key))));
    }
  }
  for (const char* const key : {"k", "l", "anchor"}) {
    if (!seen.contains(key)) return bad_spring(given, fmt::format("'{}' is missing", key));
  }
  return spring;
}

Result<Eigen::Vector2d> parse_place(const std::string& option, const std::string& given) {
  const auto place = two_numbers(given);
  if (!place) return bad_usage(fmt::format("{} {} is not x:y in mm", option, quoted(given)), "write it as 390:-20");
  return Eigen::Vector2d(place->first / kMillimetres, place->second / kMillimetres);
}

Result<std::pair<double, double>> parse_range(const std::string& option, const std::string& given) {
  const auto range = two_numbers(given);
  if (!range || !(range->first > 0.0) || !(range->second > range->first)) {
    return bad_usage(
        fmt::format("{} {} is not a range of two positive numbers, the lower one first", option, quoted(given)),
        "write it as 20:400");
  }
  return *range;
}

Result<Eigen::Matrix2d> parse_stiffness(const std::string& given) {
  const auto parts = split(given, ',');
  Eigen::Vector3d k;
  bool good = parts.size() == 3;
  for (std::size_t i = 0; good && i < 3; ++i) {
    const auto value = number(parts[i]);
    good = value.has_value();
    if (good) k[static_cast<Eigen::Index>(i)] = *value;
  }
  if (!good) {
    return bad_usage(fmt::format("--stiffness {} is not kxx,kyy,ks in N/m", quoted(given)),
                     "write it as 443.86,232.34,16.74");
  }
  return Eigen::Matrix2d{{k[0], k[2]}, {k[2], k[1]}};
}

}  // namespace mbk::app
