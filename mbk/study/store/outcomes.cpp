#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mbk/study/store/store.h"

namespace mbk::store {
namespace {

using Json = nlohmann::json;

constexpr std::array kAxes = {"x", "y", "z"};

/// The numbers of a document under their names.
class OutcomeReader {
 public:
  explicit OutcomeReader(const Json& document) : document_(document) {}

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
  if (!json.is_object() || !json.contains("model")) {
    return bad_data("the file is not a result of 'mbk measure --json'", "give a file of schema mbk.result/2");
  }
  return OutcomeReader(json).read();
}

}  // namespace mbk::store
