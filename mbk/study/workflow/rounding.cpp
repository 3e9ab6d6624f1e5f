#include "mbk/study/workflow/rounding.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace mbk::workflow {
namespace {

constexpr double kRelative = 1e-6, kAbsolute = 1e-9;

/// @param scale  magnitude of what stands beside them
bool equal_but_for_rounding(const nlohmann::json& a, const nlohmann::json& b, double scale = 0.0) {
  if (a.is_number() && b.is_number()) {
    const auto x = a.get<double>(), y = b.get<double>();
    return std::abs(x - y) <= std::max(kAbsolute, kRelative * std::max({scale, std::abs(x), std::abs(y)}));
  }
  if (a.type() != b.type() || a.size() != b.size()) return false;
  if (a.is_object()) {
    for (const auto& [key, value] : a.items()) {
      const auto found = b.find(key);
      if (found == b.end() || !equal_but_for_rounding(value, *found)) return false;
    }
    return true;
  }
  if (a.is_array()) {
    for (const auto& one : a) {
      if (one.is_number()) scale = std::max(scale, std::abs(one.get<double>()));
    }
    return std::equal(a.begin(), a.end(), b.begin(),
                      [&](const auto& x, const auto& y) { return equal_but_for_rounding(x, y, scale); });
  }
  return a == b;
}

}  // namespace

bool same_but_for_rounding(const std::string& one, const std::string& other) {
  const auto a = nlohmann::json::parse(one, nullptr, false), b = nlohmann::json::parse(other, nullptr, false);
  return !a.is_discarded() && !b.is_discarded() && equal_but_for_rounding(a, b);
}

}  // namespace mbk::workflow
