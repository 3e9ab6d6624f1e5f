#include "mbk/present/request/spring_request.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/calibration/spring_array.h"

namespace mbk::request {
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

constexpr const char* kExample = "write it as --spring k=120,l=90mm,anchor=565:183, in N/m and mm";

tl::unexpected<Error> bad_spring(const std::string& given, const std::string& what) {
  return bad_usage(fmt::format("--spring {}: {}", quoted(given), what), kExample);
}

Result<Spring> parse_spring(const std::string& given) {
  Spring spring;
  std::set<std::string_view> seen;
  for (const std::string_view part : split(given, ',')) {
    const std::size_t equals = part.find('=');
    const std::string_view key = part.substr(0, equals);
    if (equals == std::string_view::npos)
      return bad_spring(given, fmt::format("{} has no '='", quoted(std::string(part))));
    const std::string value(part.substr(equals + 1));
    if (!seen.insert(key).second) return bad_spring(given, fmt::format("'{}' occurs twice", key));
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

}  // namespace

const OptionTable<SpringFieldRequest>& spring_field_table() {
  using Request = SpringFieldRequest;
  static const auto kTable = [] {
    constexpr double kAny = 1e12;
    OptionTable<Request> table;
    table
        .add({.name = "--spring",
              .value = "k=K,l=L,anchor=X:Y[,hole=X:Y]",
              .help = "one spring: stiffness k in N/m, rest length l in mm, anchor and hole in mm; may be repeated",
              .excludes = "SCENARIO.toml",
              .repeats = true},
             &Request::springs)
        .add({"--radius", "MM", "radius, in mm, of the circle in which K is compared with the force (default: 30)",
              positive()},
             &Request::radius, kMillimetres)
        .add({"--start", "X:Y", "start of the search for the equilibrium, in mm"}, &Request::start)
        .add({"--rotation", "DEG", "rotation of the disc, in degrees anticlockwise (default: 0)", number_within(kAny)},
             &Request::rotation_deg)
        .add({"--grid-step", "MM",
              "also apply the published procedure on a grid with this step, in mm (0.15 in Dyck 2013)", positive()},
             &Request::grid_step, kMillimetres)
        .add({"--push", "", "springs shorter than their rest length push (default: they go slack)"}, &Request::push);
    return table;
  }();
  return kTable;
}

const OptionTable<SpringDesignRequest>& spring_design_table() {
  using Request = SpringDesignRequest;
  static const auto kTable = [] {
    OptionTable<Request> table;
    table.add({"--stiffness", "KXX,KYY,KS", "target stiffness kxx, kyy and ks, in N/m"}, &Request::stiffness)
        .add({"--at", "X:Y", "target equilibrium, in mm (default: centre of the frame)"}, &Request::at)
        .add({"--frame", "X:Y", "centre of the frame, in mm (default: 390:0)"}, &Request::frame)
        .add({.name = "--eye",
              .value = "X:Y",
              .help = "position of a screw eye, in mm; up to 12 (default: the published frame, 350 by 366 mm, corners "
                      "and middles "
                      "of the sides)",
              .repeats = true},
             &Request::eyes)
        .add({"--disc", "",
              "hang each spring in the facing hole of the published disc, 2.25 cm in diameter (default: all at its "
              "centre)"},
             &Request::disc)
        .add({"--spring-stiffness", "FROM:TO", "available spring constants, in N/m (default: 20:400)"},
             &Request::spring_stiffness)
        .add({"--spring-length", "FROM:TO", "available rest lengths, in mm (default: 60:160)"}, &Request::spring_length)
        .add(
            {"--travel", "MM", "radius, in mm, within which all springs stay in tension (default: 30)", positive()},
            [](auto& request) -> auto& { return request.options.travel; }, kMillimetres)
        .add(
            {"--min-extension", "MM", "minimum extension of each spring within that radius, in mm (default: 2)",
             not_negative()},
            [](auto& request) -> auto& { return request.options.min_extension; }, kMillimetres)
        .add(
            {"--max-springs", "N", "maximum number of springs (default: 8)", whole_number(3, 12)},
            [](auto& request) -> auto& { return request.options.max_springs; })
        .add(
            {"--payload", "KG", "mass, in kg, for which natural frequencies are reported", positive()},
            [](auto& request) -> auto& { return request.options.payload; });
    return table;
  }();
  return kTable;
}

Result<std::vector<Spring>> springs_of(const SpringFieldRequest& request) {
  std::vector<Spring> springs;
  for (const std::string& given : request.springs) {
    const auto spring = MBK_TRY(parse_spring(given));
    springs.push_back(spring);
  }
  return springs;
}

Result<SpringField> spring_field_of(const SpringFieldRequest& request, const std::vector<Spring>& springs) {
  Eigen::Vector2d start = calibration::centre_of_anchors(springs);
  if (!request.start.empty()) {
    start = MBK_TRY(parse_place("--start", request.start));
  }
  const auto array = MBK_TRY(calibration::SpringArray::create(
      springs, request.push ? calibration::Compression::push : calibration::Compression::slack));
  const double radius = request.radius, rotation = request.rotation_deg * std::numbers::pi / 180.0;
  auto field = calibration::spring_field(array, start, radius, rotation);
  if (field && request.grid_step) {
    const double step = *request.grid_step;
    const auto grid = MBK_TRY(calibration::grid_field(array, field->equilibrium, radius, step, rotation));
    field->grid = grid;
  }
  return field;
}

Result<calibration::SpringRequest> spring_design_of(const SpringDesignRequest& request) {
  calibration::SpringRequest design = request.options;
  const auto K = MBK_TRY(parse_stiffness(request.stiffness));
  design.K = K;
  const auto frame = MBK_TRY(parse_place("--frame", request.frame));
  design.equilibrium = frame;
  if (!request.at.empty()) {
    design.equilibrium = MBK_TRY(parse_place("--at", request.at));
  }
  design.eyes = calibration::frame_eyes(frame);
  if (!request.eyes.empty()) design.eyes.clear();
  for (const std::string& given : request.eyes) {
    const auto eye = MBK_TRY(parse_place("--eye", given));
    design.eyes.push_back(eye);
  }
  if (request.disc) {
    for (const Eigen::Vector2d& eye : design.eyes) design.holes.push_back(calibration::facing_hole(eye, frame));
  }
  const auto stiffness = MBK_TRY(parse_range("--spring-stiffness", request.spring_stiffness));
  design.stiffness = stiffness;
  const auto length = MBK_TRY(parse_range("--spring-length", request.spring_length));
  design.rest_length = {length.first / kMillimetres, length.second / kMillimetres};
  return design;
}

}  // namespace mbk::request
