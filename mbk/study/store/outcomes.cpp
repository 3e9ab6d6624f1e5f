#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/study/store/store.h"

namespace mbk::store {
namespace {

using Json = nlohmann::json;

constexpr std::array kAxes = {"x", "y", "z"};

/// The numbers of a document under their names.
class OutcomeReader {
 public:
  explicit OutcomeReader(const Json& document) : document_(document) {}

  /// Of `mbk explore --only stretch` or `--only emg`.
  std::vector<Outcome> read_exploration() {
    const Json& directions = member(member(document_, "stretch"), "directions");
    for (std::size_t k = 0; k < directions.size(); ++k) read_stretches(directions[k]);
    const Json &emg = member(document_, "emg"), &channels = member(emg, "channels");
    for (std::size_t k = 0; k < channels.size(); ++k) read_muscle(channels[k], emg);
    return std::move(outcomes_);
  }

  std::vector<Outcome> read() {
    const Json& axes = member(document_, "axes");
    if (axes.is_number_integer() && (axes == 1 || axes == 3)) axes_ = axes.get<std::size_t>();
    for (const char* matrix : {"M", "B", "K"}) read_matrix(matrix);
    read_vector("x0", member(member(document_, "model"), "x0"), member(member(document_, "standard_error"), "x0"),
                unit_of("x0"));
    read_vector("VAF", member(member(document_, "fit"), "VAF"), Json(), "%");
    read_vector("RMSE", member(member(document_, "fit"), "RMSE"), Json(), unit_of("force"));
    for (const char* quantity : {"inertia", "damping", "stiffness"}) {
      read_ellipse(quantity);
      read_ellipsoid(quantity);
    }
    for (const char* quantity : {"inertia", "stiffness"}) {
      add(fmt::format("{}_zmean", quantity),
          axes_ == 3 ? member(member(member(document_, "antisymmetry_vectors"), quantity), "percent")
                     : member(member(member(document_, "antisymmetry"), quantity), "zmean_percent"),
          Json(), "%");
    }
    const Json& passivity = member(document_, "passivity");
    add("absorbed_energy", member(member(passivity, "trial"), "absorbed_J"), Json(), "J");
    add("min_passivity_index", member(passivity, "min_index"), Json(), unit_of("B"));
    add("excess_of_passivity", member(member(passivity, "eop"), "corrected"), Json(), unit_of("B"));
    return std::move(outcomes_);
  }

 private:
  static const Json& member(const Json& json, const char* name) {
    static const Json kNothing;
    const auto found = json.is_object() ? json.find(name) : json.end();
    return json.is_object() && found != json.end() ? *found : kNothing;
  }

  /// Stretches that increase the position, and those that decrease it, are outcomes of their own.
  void read_stretches(const Json& found) {
    const Json& direction = member(found, "direction");
    const char* const which = direction.is_number() && direction.get<double>() < 0.0 ? "decreasing" : "increasing";
    const bool turns = unit_of("K") == "N·m/rad";
    const auto add_value = [&](const char* name, const Json& value, const std::string& unit, double scale = 1.0) {
      const Json &number = member(value, "value"), &interval = member(value, "interval95");
      if (!number.is_number()) return;
      Json error;
      if (element(interval, 0).is_number() && element(interval, 1).is_number()) {
        error = scale * (interval[1].get<double>() - interval[0].get<double>()) / (2.0 * numeric::kNormal95);
      }
      add(fmt::format("stretch_{}_{}", which, name), scale * number.get<double>(), error, unit);
    };
    const double angle = turns ? kDegrees : kMillimetres;
    const char* const unit_of_angle = turns ? "°" : "mm";
    add_value("slope", member(found, "slope"), unit_of("B"));
    add_value("rise", member(found, "rise"), unit_of("B"));
    add_value("threshold", member(found, "reflex_threshold"), unit_of_angle, angle);
    const Json& speeds = member(found, "speeds");
    if (!speeds.is_array() || speeds.empty()) return;
    add_value("torque", member(speeds.back(), "mean_torque"), turns ? "N·m" : "N");
    add_value("catch", member(speeds.back(), "catch_angle"), unit_of_angle, angle);
    add_value("work", member(speeds.back(), "work"), "J");
  }

  /// Latency and ratios of a muscle, by direction of the perturbation.
  void read_muscle(const Json& channel, const Json& emg) {
    const Json &directions = member(channel, "directions"), &windows = member(emg, "windows");
    if (!member(channel, "name").is_string()) return;
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const std::string stem = fmt::format("{}_direction{}", channel["name"].get<std::string>(), k + 1);
      const Json& latency = member(member(directions[k], "latency"), "value_s");
      if (latency.is_number()) add(stem + "_latency", 1e3 * latency.get<double>(), Json(), "ms");
      const Json& responses = member(directions[k], "windows");
      for (std::size_t w = 0; w < responses.size(); ++w) {
        const Json& name = member(element(windows, w), "name");
        std::string word = name.is_string() ? name.get<std::string>() : fmt::format("window{}", w + 1);
        std::ranges::replace(word, ' ', '_');
        add(fmt::format("{}_{}", stem, word), member(responses[w], "ratio"), Json(), "");
      }
    }
  }

  static const Json& element(const Json& json, std::size_t at) {
    static const Json kNothing;
    return json.is_array() && at < json.size() ? json[at] : kNothing;
  }

  std::string unit_of(const char* name) const {
    const Json& unit = member(member(document_, "units"), name);
    return unit.is_string() ? unit.get<std::string>() : "";
  }

  /// What is undefined (null) or not finite is no number.
  void add(std::string name, const Json& value, const Json& standard_error, std::string unit) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) return;
    Outcome outcome{std::move(name), value.get<double>(), std::nullopt, std::move(unit)};
    if (standard_error.is_number() && std::isfinite(standard_error.get<double>())) {
      outcome.standard_error = standard_error.get<double>();
    }
    outcomes_.push_back(std::move(outcome));
  }

  void read_matrix(const char* name) {
    const Json& values = member(member(document_, "model"), name);
    const Json& errors = member(member(document_, "standard_error"), name);
    for (std::size_t i = 0; i < axes_; ++i) {
      for (std::size_t k = 0; k < axes_; ++k) {
        add(axes_ == 1 ? name : fmt::format("{}_{}{}", name, kAxes.at(i), kAxes.at(k)), element(element(values, i), k),
            element(element(errors, i), k), unit_of(name));
      }
    }
  }

  void read_vector(const char* name, const Json& values, const Json& errors, const std::string& unit) {
    for (std::size_t i = 0; i < axes_; ++i) {
      add(axes_ == 1 ? name : fmt::format("{}_{}", name, kAxes.at(i)), element(values, i), element(errors, i), unit);
    }
  }

  void read_ellipse(const char* quantity) {
    const Json& ellipse = member(member(document_, "ellipses"), quantity);
    add(fmt::format("{}_area", quantity), member(ellipse, "area"), Json(), power(unit_of_matrix(quantity), "²"));
    add(fmt::format("{}_shape", quantity), member(ellipse, "shape"), Json(), "");
    if (has_orientation(member(member(ellipse, "interval95"), "orientation_deg"))) {
      add(fmt::format("{}_orientation", quantity), member(ellipse, "orientation_deg"), Json(), "°");
    }
  }

  void read_ellipsoid(const char* quantity) {
    const Json& ellipsoid = member(member(document_, "ellipsoids"), quantity);
    add(fmt::format("{}_ellipsoid_volume", quantity), member(ellipsoid, "volume"), Json(),
        power(unit_of_matrix(quantity), "³"));
    add(fmt::format("{}_ellipsoid_shape", quantity), member(ellipsoid, "shape"), Json(), "");
  }

  std::string unit_of_matrix(const char* quantity) const {
    return unit_of(*quantity == 'i' ? "M" : *quantity == 'd' ? "B" : "K");
  }

  /// An ellipse that may be round has none: its interval holds every angle, and a mean over trials would take in
  /// chance.
  static bool has_orientation(const Json& interval) {
    constexpr double kEvery = 180.0 - 1e-6;  // [°]
    const Json &low = element(interval, 0), &high = element(interval, 1);
    return !(low.is_number() && high.is_number() && high.get<double>() - low.get<double>() >= kEvery);
  }

  static std::string power(const std::string& unit, const char* exponent) {
    if (unit.find_first_of("/") == std::string::npos && unit.find("·") == std::string::npos) return unit + exponent;
    return fmt::format("({}){}", unit, exponent);
  }

  const Json& document_;
  std::size_t axes_ = 2;
  std::vector<Outcome> outcomes_;
};

/// Where the list ends that begins with the bracket there; npos: nowhere.
std::size_t end_of_list(std::string_view json, std::size_t at) {
  int depth = 0;
  for (; at < json.size(); ++at) {
    const char c = json[at];
    if (c == '"') {
      while (++at < json.size() && json[at] != '"') at += json[at] == '\\' ? 1 : 0;
    } else if (c == '[') {
      ++depth;
    } else if (c == ']' && --depth == 0) {
      return at + 1;
    }
  }
  return std::string_view::npos;
}

/// A document without the curves of its models, which are most of it and hold no outcome. Within a text its quotes
/// would be escaped, so that what is found is a member.
std::string without_models(std::string_view document) {
  constexpr std::string_view kMember = R"("models":)";
  std::string without;
  while (true) {
    const std::size_t begin = document.find(kMember);
    const std::size_t list = begin == std::string_view::npos ? begin : begin + kMember.size();
    const std::size_t end = list < document.size() && document[list] == '[' ? end_of_list(document, list) : list;
    without += document.substr(0, end == std::string_view::npos ? end : list);
    if (end == std::string_view::npos) return without;
    if (end > list) without += "[]";
    document.remove_prefix(end);
  }
}

}  // namespace

Result<std::vector<Outcome>> outcomes_of(std::string_view document) {
  const Json json = Json::parse(without_models(document), nullptr, false);
  if (json.is_object() && (json.contains("stretch") || json.contains("emg"))) {
    return OutcomeReader(json).read_exploration();
  }
  if (!json.is_object() || !json.contains("model")) {
    return bad_data("the file is not a result of 'mbk measure --json'", "give a file of schema mbk.result/2");
  }
  return OutcomeReader(json).read();
}

}  // namespace mbk::store
